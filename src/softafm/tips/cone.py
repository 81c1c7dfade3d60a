"""A cone with a rounded apex."""

from dataclasses import dataclass
from typing import ClassVar

from softafm.checks.validate import check_positive
from softafm.compiled.formulas import Term
from softafm.tips.angles import check_half_angle
from softafm.tips.arc import arc_and_flank, flank
from softafm.tips.tip import Tip


@dataclass(frozen=True)
class Cone(Tip):
    """Cone whose apex is the cap of a sphere that touches it.

    Parameters
    ----------
    half_angle
        Angle α between axis and flank, rad: 0 < α < π/2.
    apex_radius
        Radius R of the cap, m; it meets the flank at r = R cos α.

    Raises
    ------
    ValueError
        If the angle is out of range or the radius is not a finite number above zero.

    References
    ----------
    I. N. Sneddon, *Int. J. Eng. Sci.* 3, 47 (1965): elastic indentation by a sharp cone. D. Maugis
    and M. Barquins, *J. Phys. D* 16, 1843 (1983): adhesion of cones and of other punches.
    """

    kind: ClassVar[str] = "cone"
    half_angle: float
    apex_radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "half_angle", check_half_angle(self.half_angle))
        object.__setattr__(
            self, "apex_radius", check_positive("apex_radius", self.apex_radius, "m")
        )

    @property
    def term(self) -> Term:
        """g(r) = R − √(R² − r²) to r = R cos α, then straight with slope cot α."""
        join, slope = flank(self.half_angle)
        return Term(arc_and_flank, (0.0, self.apex_radius, join * self.apex_radius, slope))

    @property
    def joints(self) -> tuple[float, ...]:
        """Radius at which the cap meets the flank, m."""
        return (flank(self.half_angle)[0] * self.apex_radius,)
