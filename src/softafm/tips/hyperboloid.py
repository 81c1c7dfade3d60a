"""A hyperboloid of revolution."""

from dataclasses import dataclass
from math import sqrt, tan
from typing import ClassVar

import numpy as np

from softafm.checks.validate import check_positive
from softafm.compiled.formulas import Term
from softafm.tips.angles import check_half_angle
from softafm.tips.tip import Tip, check_height


@dataclass(frozen=True)
class Hyperboloid(Tip):
    """Hyperboloid, g(r) = R cot²α (√(1 + (r tan α/R)²) − 1): round apex, smooth way to a cone.

    Parameters
    ----------
    radius
        Radius of curvature R at the apex, m.
    half_angle
        Angle α between axis and asymptote, rad: 0 < α < π/2.

    Raises
    ------
    ValueError
        If the radius is not a finite number above zero or the angle is out of range.

    References
    ----------
    Y. Sun, B. Akhremitchev and G. C. Walker, *Langmuir* 20, 5837 (2004): its adhesive contact.
    """

    kind: ClassVar[str] = "hyperboloid"
    radius: float
    half_angle: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", check_positive("radius", self.radius, "m"))
        object.__setattr__(self, "half_angle", check_half_angle(self.half_angle))

    @property
    def term(self) -> Term:
        """g(r) = (r²/R)/(√(1 + (r/b)²) + 1), b = R cot α: the same without a difference."""
        return Term(_height, (self.radius, self.radius / tan(self.half_angle)))

    def radius_at(self, height: float) -> float:
        """Radius at which the profile reaches ``height`` (m), m."""
        height = check_height(height)
        return sqrt(height * (2 * self.radius + height * tan(self.half_angle) ** 2))


def _height(r: np.ndarray, R: float, b: float) -> np.ndarray:
    ratio = r / b
    return r * r / R / (np.sqrt(1 + ratio * ratio) + 1)
