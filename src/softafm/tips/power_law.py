"""A profile that rises as a power of the radius."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from softafm.checks.validate import check_finite, check_positive
from softafm.compiled.formulas import Term
from softafm.tips.tip import Tip, check_height

_LARGEST = 50.0


@dataclass(frozen=True)
class PowerLawTip(Tip):
    """Profile g(r) = height·(r/radius)^n: a paraboloid for n = 2, ever flatter for larger n.

    Parameters
    ----------
    exponent
        Exponent n, 2 to 50.
    height
        Height of the profile at ``radius``, m.
    radius
        Radius at which it is that high, m.

    Raises
    ------
    ValueError
        If the exponent is out of range or a length is not a finite number above zero.

    Notes
    -----
    Below n = 2 the curvature at the apex would be infinite, and so would be the first pressure
    there; a ``Cone`` or a ``Hyperboloid`` is sharp with an apex that exists.

    References
    ----------
    L. A. Galin, *Prikl. Mat. Mekh.* 10, 425 (1946), and I. N. Sneddon, *Int. J. Eng. Sci.* 3, 47
    (1965): its elastic indentation.
    """

    kind: ClassVar[str] = "power-law"
    exponent: float
    height: float
    radius: float

    def __post_init__(self) -> None:
        exponent = check_finite("exponent", self.exponent, "")
        if not 2 <= exponent <= _LARGEST:
            raise ValueError(
                f"exponent = {exponent:g}: must be from 2 to {_LARGEST:g} (below 2 the apex would "
                "be infinitely sharp: take a Cone or a Hyperboloid; for more take a FlatPunch)"
            )
        object.__setattr__(self, "exponent", exponent)
        object.__setattr__(self, "height", check_positive("height", self.height, "m"))
        object.__setattr__(self, "radius", check_positive("radius", self.radius, "m"))

    @property
    def term(self) -> Term:
        """g(r) = height·(r/radius)^n."""
        return Term(_height, (self.exponent, self.height, self.radius))

    def radius_at(self, height: float) -> float:
        """Radius at which the profile reaches ``height`` (m), m."""
        return self.radius * (check_height(height) / self.height) ** (1 / self.exponent)


def _height(r: np.ndarray, n: float, height: float, radius: float) -> np.ndarray:
    return height * (r / radius) ** n
