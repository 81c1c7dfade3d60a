"""What touches: tip, sample and the law between them, and the scales that follow."""

from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING, Protocol

import numpy as np

from softafm.rheology import ReducedCompliance

if TYPE_CHECKING:
    from softafm.compiled import CompiledFunction


class Tip(Protocol):
    """What a contact and its solver ask of a tip, e.g. ``Paraboloid``."""

    @property
    def kind(self) -> str:
        """Name of the shape, kept with every result."""

    @property
    def radius(self) -> float:
        """Radius of curvature at the apex, m."""

    def profile(self, r):
        """Height of the tip surface above its apex at radial coordinate ``r``, m."""

    @property
    def compiled_profile(self) -> "tuple[CompiledFunction, np.ndarray]":
        """The profile for solvers, and its parameters (see ``softafm.compiled.PROFILE``)."""


class Sample(Protocol):
    """What a contact and its solver ask of a sample, e.g. ``StandardLinearSolid``."""

    @property
    def kind(self) -> str:
        """Name of the rheology, kept with every result."""

    @property
    def reduced_compliance(self) -> ReducedCompliance:
        """Creep compliance with the factor 1 − ν² inside, 1/Pa."""


class Surface(Protocol):
    """What a contact and its solver ask of a law between two surfaces, e.g. ``LennardJones``."""

    @property
    def kind(self) -> str:
        """Name of the law, kept with every result."""

    @property
    def work_of_adhesion(self) -> float:
        """Work per area to separate the surfaces from the equilibrium gap, J/m²."""

    @property
    def equilibrium_gap(self) -> float:
        """Gap of zero pressure, m."""

    @property
    def gap_of_largest_tension(self) -> float:
        """Gap where the attraction is strongest, m."""

    def pressure(self, gap):
        """Pressure at ``gap`` (m), positive = repulsive, Pa."""

    def potential(self, gap):
        """Interaction energy per area Φ at ``gap`` (m), J/m²; Φ' = −p."""

    @property
    def compiled_pressure(self) -> "tuple[CompiledFunction, CompiledFunction, np.ndarray]":
        """p and Φ for solvers, and their parameters (see ``softafm.compiled``)."""


@dataclass(frozen=True)
class Contact:
    """A rigid tip above a viscoelastic half-space with a surface law between them.

    Parameters
    ----------
    tip
        Shape of the tip, e.g. ``Paraboloid``.
    sample
        Rheology of the half-space, e.g. ``StandardLinearSolid``.
    surface
        Pressure against gap, e.g. ``LennardJones``.
    """

    tip: Tip
    sample: Sample
    surface: Surface

    @property
    def _modulus_instantaneous(self) -> float:
        return 1 / self.sample.reduced_compliance.instantaneous

    @property
    def _modulus_relaxed(self) -> float:
        return 1 / self.sample.reduced_compliance.relaxed

    def _tabor(self, modulus: float) -> float:
        W, z0 = self.surface.work_of_adhesion, self.surface.equilibrium_gap
        return (self.tip.radius * W**2 / (modulus**2 * z0**3)) ** (1 / 3)

    @property
    def tabor_instantaneous(self) -> float:
        """Tabor number μ = (R W²/(E² z0³))^(1/3) with the short-term reduced modulus."""
        return self._tabor(self._modulus_instantaneous)

    @property
    def tabor_relaxed(self) -> float:
        """Tabor number μ = (R W²/(E² z0³))^(1/3) with the long-term reduced modulus.

        Below about 0.1 adhesion acts outside a Hertz contact (DMT), above about 5 inside it (JKR).
        """
        return self._tabor(self._modulus_relaxed)

    def _cohesive_length(self, modulus: float) -> float:
        return modulus * self.surface.equilibrium_gap**2 / self.surface.work_of_adhesion

    @property
    def cohesive_length(self) -> float:
        """Width ℓ = E z0²/W of the tension zone at the relaxed contact edge, m."""
        return self._cohesive_length(self._modulus_relaxed)

    @property
    def cohesive_length_instantaneous(self) -> float:
        """Width ℓ = E z0²/W of the tension zone at the short-term modulus, m."""
        return self._cohesive_length(self._modulus_instantaneous)

    @property
    def steepest_attraction(self) -> float:
        """Largest slope of the attraction on the flat surface, 2πR·max(−p), N/m.

        By Derjaguin F = 2πRΦ(h0), so dF/dh0 = −2πRp(h0). A lever softer than this snaps in.
        """
        tension = -float(self.surface.pressure(self.surface.gap_of_largest_tension))
        return 2 * pi * self.tip.radius * tension

    def contact_radius(self, tip_height: float) -> float:
        """Radius of the relaxed contact expected at a tip height (m, negative = indented), m.

        The stable branch of JKR (Johnson, Kendall and Roberts 1971),
        −h0 = a²/R − sqrt(2πaW/E_inf); zero where no contact exists. With a = s²·a_c, where a_c is
        the smallest stable radius, s⁴ − 4s + R·h0/a_c² = 0 and s ≥ 1.
        """
        R, W = self.tip.radius, self.surface.work_of_adhesion
        smallest = (pi * R**2 * W / (8 * self._modulus_relaxed)) ** (1 / 3)
        height = R * tip_height / smallest**2
        if height > 3:
            return 0.0
        return smallest * max(1.0, float(np.roots([1, 0, 0, -4, height]).real.max())) ** 2
