"""A flat-ended cylinder."""

from dataclasses import dataclass
from typing import ClassVar

from softafm.checks.validate import check_positive
from softafm.compiled.formulas import Term
from softafm.tips.arc import JOIN, SLOPE, arc_and_flank
from softafm.tips.tip import Tip


@dataclass(frozen=True)
class FlatPunch(Tip):
    """Flat-ended cylinder whose edge is rounded by a quarter of a circle.

    Parameters
    ----------
    radius
        Radius a of the cylinder, m.
    edge_radius
        Radius ρ of the rounding, m, at most a; the end is flat to r = a − ρ.

    Raises
    ------
    ValueError
        If either is not a finite number above zero, or the edge is rounder than the cylinder.

    Notes
    -----
    The rounding is followed to a slope of 80°, and its tangent beyond, as profiles are heights over
    the radius and cannot be vertical.

    References
    ----------
    I. N. Sneddon, *Int. J. Eng. Sci.* 3, 47 (1965): indentation by a sharp-edged punch. M.
    Ciavarella, D. A. Hills and G. Monno, *Proc. Inst. Mech. Eng. C* 212, 319 (1998): by a rounded
    one.
    """

    kind: ClassVar[str] = "flat-punch"
    radius: float
    edge_radius: float

    def __post_init__(self) -> None:
        radius = check_positive("radius", self.radius, "m")
        edge = check_positive("edge_radius", self.edge_radius, "m")
        if edge > radius:
            raise ValueError(
                f"edge_radius = {edge:g} m: must be at most radius = {radius:g} m (equal to it, "
                "the punch is a sphere)"
            )
        object.__setattr__(self, "radius", radius)
        object.__setattr__(self, "edge_radius", edge)

    @property
    def _flat(self) -> float:
        return self.radius - self.edge_radius

    @property
    def term(self) -> Term:
        """g(r) = ρ − √(ρ² − (r − a + ρ)²) beyond r = a − ρ, then straight."""
        return Term(arc_and_flank, (self._flat, self.edge_radius, JOIN * self.edge_radius, SLOPE))

    @property
    def joints(self) -> tuple[float, ...]:
        """Radii at which the rounding starts and ends, m."""
        return self._flat, self._flat + JOIN * self.edge_radius
