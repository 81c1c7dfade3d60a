"""A paraboloid of revolution."""

from dataclasses import dataclass
from math import sqrt
from typing import ClassVar

import numpy as np

from softafm.checks.validate import check_positive
from softafm.compiled.formulas import Term
from softafm.tips.tip import Tip, check_height


@dataclass(frozen=True)
class Paraboloid(Tip):
    """Paraboloid of revolution, g(r) = r²/2R: a sphere near its apex.

    Parameters
    ----------
    radius
        Radius of curvature R at the apex, m.

    Raises
    ------
    ValueError
        If the radius is not a finite number above zero.

    Notes
    -----
    Stands for a sphere while the contact radius is well below R (g is 3 % low at r = R/3).
    """

    kind: ClassVar[str] = "paraboloid"
    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", check_positive("radius", self.radius, "m"))

    @property
    def term(self) -> Term:
        """g(r) = r²/2R."""
        return Term(_height, (self.radius,))

    def radius_at(self, height: float) -> float:
        """Radius at which the profile reaches ``height`` (m), m."""
        return sqrt(2 * self.radius * check_height(height))


def _height(r: np.ndarray, R: float) -> np.ndarray:
    return r * r / (2 * R)
