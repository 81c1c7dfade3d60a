"""The Morse law."""

from dataclasses import dataclass, field, replace
from math import log
from typing import ClassVar

import numpy as np

from softafm.checks.validate import check_positive
from softafm.compiled.formulas import Term
from softafm.surfaces.law import SurfaceLaw
from softafm.surfaces.limits import check_length


@dataclass(frozen=True)
class Morse(SurfaceLaw):
    """Morse potential per area, Φ(h) = W·(e^(−2x) − 2e^(−x)) with x = (h − z0)/decay.

    Parameters
    ----------
    work_of_adhesion
        Work of adhesion W, J/m².
    z0
        Equilibrium gap, where the pressure vanishes, m.
    decay
        Length over which the attraction falls e-fold, m.

    Raises
    ------
    ValueError
        If a value is out of range.

    References
    ----------
    P. M. Morse, *Phys. Rev.* 34, 57 (1929), for the atoms of a molecule.
    """

    kind: ClassVar[str] = "morse"
    overlaps: ClassVar[bool] = True
    work_of_adhesion: float = field()  # without a default, whatever the base class has
    z0: float
    decay: float

    def __post_init__(self) -> None:
        W = check_positive("work_of_adhesion", self.work_of_adhesion, "J/m²")
        object.__setattr__(self, "work_of_adhesion", W)
        object.__setattr__(self, "z0", check_length("z0", self.z0))
        object.__setattr__(self, "decay", check_length("decay", self.decay))

    @property
    def equilibrium_gap(self) -> float:
        """Gap of zero pressure, z0, m."""
        return self.z0

    @property
    def gap_of_largest_tension(self) -> float:
        """Gap where the attraction is strongest, z0 + ln(2)·decay, m."""
        return self.z0 + log(2) * self.decay

    def stretched(self, factor: float) -> "Morse":
        """Return the law with all its lengths times ``factor``, of the same work of adhesion."""
        factor = check_positive("factor", factor, "")
        return replace(self, z0=factor * self.z0, decay=factor * self.decay)

    @property
    def terms(self) -> tuple[Term]:
        """p(h) = 2W/decay·(e^(−2x) − e^(−x))."""
        return (Term(_morse, (self.work_of_adhesion, self.z0, self.decay)),)


def _morse(
    h: np.ndarray, W: float, z0: float, decay: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    far = np.exp((z0 - h) / decay)
    rate = 2 / decay * W * far
    return rate * (far - 1), rate / decay * (1 - 2 * far), W * far * (far - 2)
