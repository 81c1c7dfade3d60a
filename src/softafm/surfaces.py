"""Laws of the pressure between two surfaces against the gap that separates them."""

from dataclasses import dataclass
from math import pi
from typing import ClassVar

import numpy as np

from softafm._validate import positive


@dataclass(frozen=True)
class LennardJones:
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

    def __post_init__(self):
        object.__setattr__(self, "hamaker", positive("hamaker", self.hamaker, "J"))
        object.__setattr__(self, "z0", positive("z0", self.z0, "m"))

    @classmethod
    def from_work_of_adhesion(cls, W: float, z0: float) -> "LennardJones":
        """Build the law from its work of adhesion W = H/(16πz0²), J/m², and z0, m."""
        W = positive("W", W, "J/m²")
        z0 = positive("z0", z0, "m")
        return cls(hamaker=16 * pi * z0**2 * W, z0=z0)

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

    def pressure(self, gap):
        """Pressure at ``gap`` (m), positive = repulsive, Pa."""
        h = np.asarray(gap, float)
        return self.hamaker / (6 * pi * h**3) * ((self.z0 / h) ** 6 - 1)

    def potential(self, gap):
        """Interaction energy per area Φ at ``gap`` (m), J/m²; Φ' = −p, Φ(z0) = −W."""
        h = np.asarray(gap, float)
        return self.hamaker / (12 * pi * h**2) * ((self.z0 / h) ** 6 / 4 - 1)

    @property
    def compiled_pressure(self):
        """Compiled p(h) and dp/dh with their parameters (see ``softafm.compiled``)."""
        from softafm.kernels import lennard_jones_potential, lennard_jones_pressure

        return lennard_jones_pressure, lennard_jones_potential, np.array([self.hamaker, self.z0])
