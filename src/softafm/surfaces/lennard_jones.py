"""The Lennard-Jones law between half-spaces."""

from dataclasses import dataclass, replace
from math import pi
from typing import ClassVar

import numpy as np

from softafm.checks.validate import check_positive
from softafm.compiled.formulas import Term
from softafm.surfaces.law import SurfaceLaw


@dataclass(frozen=True)
class LennardJones(SurfaceLaw):
    """Lennard-Jones pressure between half-spaces, p(h) = H/(6πh³)·((z0/h)⁶ − 1).

    Parameters
    ----------
    hamaker
        Hamaker constant H, J.
    z0
        Equilibrium gap, where the pressure vanishes, m.

    Raises
    ------
    ValueError
        If either is not a finite number above zero.

    References
    ----------
    Rajabifar et al. 2021, equations (5) and (6).
    """

    kind: ClassVar[str] = "lennard-jones"
    hamaker: float
    z0: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "hamaker", check_positive("hamaker", self.hamaker, "J"))
        object.__setattr__(self, "z0", check_positive("z0", self.z0, "m"))

    @classmethod
    def from_work_of_adhesion(cls, W: float, z0: float) -> "LennardJones":
        """Build the law from its work of adhesion, W = H/(16πz0²).

        Parameters
        ----------
        W
            Work per area to part the surfaces, J/m².
        """
        W = check_positive("W", W, "J/m²")
        z0 = check_positive("z0", z0, "m")
        return cls(hamaker=16 * pi * z0**2 * W, z0=z0)

    @property
    def attracts(self) -> bool:
        """True."""
        return True

    @property
    def sharpness(self) -> float:
        """1: other laws are compared with this one."""
        return 1.0

    @property
    def work_of_adhesion(self) -> float:
        """Work per area to separate the surfaces from z0 to infinity, J/m²."""
        return self.hamaker / (16 * pi * self.z0**2)

    @property
    def equilibrium_gap(self) -> float:
        """Gap of zero pressure, m."""
        return self.z0

    @property
    def gap_of_largest_tension(self) -> float:
        """Gap where the attraction is strongest, 3^(1/6)·z0, m."""
        return 3 ** (1 / 6) * self.z0

    @property
    def range(self) -> float:
        """The equilibrium gap z0, m."""
        return self.z0

    @property
    def width_of_well(self) -> float:
        """The same: there is no barrier."""
        return self.z0

    def stretched(self, factor: float) -> "LennardJones":
        """Return the law with all its lengths times ``factor``, of the same work of adhesion."""
        factor = check_positive("factor", factor, "")
        return replace(self, hamaker=factor**2 * self.hamaker, z0=factor * self.z0)

    @property
    def terms(self) -> tuple[Term]:
        """p(h) = H/(6πh³)·((z0/h)⁶ − 1), Φ(h) = H/(12πh²)·((z0/h)⁶/4 − 1)."""
        return (Term(_lennard_jones, (self.hamaker, self.z0)),)


def _lennard_jones(h: np.ndarray, H: float, z0: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    inverse = 1 / h
    attraction = H / (6 * pi) * inverse * inverse * inverse
    ratio = z0 * inverse
    cube = ratio * ratio * ratio
    repulsion = attraction * cube * cube
    slope = (3 * attraction - 9 * repulsion) * inverse
    return repulsion - attraction, slope, 0.5 * h * (0.25 * repulsion - attraction)
