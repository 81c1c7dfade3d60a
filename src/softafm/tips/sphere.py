"""A sphere."""

from dataclasses import dataclass
from typing import ClassVar

from softafm.checks.validate import check_positive
from softafm.compiled.formulas import Term
from softafm.tips.arc import JOIN, SLOPE, arc_and_flank
from softafm.tips.tip import Tip


@dataclass(frozen=True)
class Sphere(Tip):
    """Sphere, g(r) = R − √(R² − r²) to a polar angle of 80°, and the tangent cone beyond.

    Parameters
    ----------
    radius
        Radius R of the sphere, m.

    Raises
    ------
    ValueError
        If the radius is not a finite number above zero.

    Notes
    -----
    The cone, from r = 0.985 R on, continues the profile where that of a sphere ends. No contact
    should be wider.

    References
    ----------
    I. N. Sneddon, *Int. J. Eng. Sci.* 3, 47 (1965): its elastic indentation.
    """

    kind: ClassVar[str] = "sphere"
    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", check_positive("radius", self.radius, "m"))

    @property
    def term(self) -> Term:
        """g(r) = R − √(R² − r²), then straight."""
        return Term(arc_and_flank, (0.0, self.radius, JOIN * self.radius, SLOPE))

    @property
    def joints(self) -> tuple[float, ...]:
        """Radius at which the sphere ends, m."""
        return (JOIN * self.radius,)
