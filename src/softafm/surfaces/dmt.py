"""Van der Waals attraction down to a stiff contact, as Derjaguin, Muller and Toporov take it."""

from dataclasses import dataclass, replace
from math import pi
from typing import ClassVar

from softafm.checks.validate import check_between, check_positive
from softafm.compiled.formulas import Term
from softafm.surfaces.attraction import attraction
from softafm.surfaces.law import SurfaceLaw
from softafm.surfaces.limits import check_length
from softafm.surfaces.repulsion import exponential

_WALLS = 0.02, 0.25


@dataclass(frozen=True)
class DMT(SurfaceLaw):
    """Van der Waals attraction down to contact, p(h) = H/(6πz0³)·(exp(−(h−z0)/λ) − (z0/h)³).

    The hard contact of DMT theory is a stiff exponential wall, λ = wall·z0. Inside z0 the
    attraction goes on as its own osculating parabola, 1 + 3y + 6y² with y = 1 − h/z0, instead of
    diverging: the law repels, ever more, at all smaller gaps, negative ones too.

    Parameters
    ----------
    hamaker
        Hamaker constant H, J.
    z0
        Equilibrium gap, where the pressure vanishes, m.
    wall
        Decay length of the wall over z0, 0.02 to 0.25; contact is harder the smaller it is.

    Raises
    ------
    ValueError
        If a value is out of range.

    References
    ----------
    B. V. Derjaguin, V. M. Muller and Y. P. Toporov, *J. Colloid Interface Sci.* 53, 314 (1975).
    """

    kind: ClassVar[str] = "dmt"
    overlaps: ClassVar[bool] = True
    hamaker: float
    z0: float
    wall: float = 0.1

    def __post_init__(self) -> None:
        object.__setattr__(self, "hamaker", check_positive("hamaker", self.hamaker, "J"))
        object.__setattr__(self, "z0", check_length("z0", self.z0))
        object.__setattr__(self, "wall", check_between("wall", self.wall, "", *_WALLS))

    @classmethod
    def from_work_of_adhesion(cls, W: float, z0: float, wall: float = 0.1) -> "DMT":
        """Build the law from its work of adhesion, W = H/(12πz0²)·(1 − 2·wall).

        Parameters
        ----------
        W
            Work per area to part the surfaces, J/m².
        """
        W, z0 = check_positive("W", W, "J/m²"), check_length("z0", z0)
        share = 1 - 2 * check_between("wall", wall, "", *_WALLS)
        return cls(12 * pi * z0**2 * W / share, z0, wall)

    @property
    def work_of_adhesion(self) -> float:
        """H/(12πz0²)·(1 − 2·wall), J/m²."""
        return self.hamaker / (12 * pi * self.z0**2) * (1 - 2 * self.wall)

    @property
    def equilibrium_gap(self) -> float:
        """Gap of zero pressure, z0, m."""
        return self.z0

    def stretched(self, factor: float) -> "DMT":
        """Return the law with all its lengths times ``factor``, of the same work of adhesion."""
        factor = check_positive("factor", factor, "")
        return replace(self, hamaker=factor**2 * self.hamaker, z0=factor * self.z0)

    @property
    def terms(self) -> tuple[Term, Term]:
        """The attraction and the wall."""
        contact = self.hamaker / (6 * pi * self.z0**3)
        return (
            Term(attraction, (self.hamaker, self.z0)),
            Term(exponential, (contact, self.z0, self.wall * self.z0)),
        )
