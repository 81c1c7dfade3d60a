"""What touches: tip, sample and the law between them, and the scales that follow."""

from dataclasses import dataclass
from math import pi, sqrt

from scipy.optimize import brentq

from softafm.rheology import Elastic, GeneralizedKelvinVoigt, StandardLinearSolid
from softafm.surfaces import LennardJones
from softafm.tips import Paraboloid


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

    tip: Paraboloid
    sample: Elastic | StandardLinearSolid | GeneralizedKelvinVoigt
    surface: LennardJones

    def _tabor(self, modulus: float) -> float:
        W, z0 = self.surface.work_of_adhesion, self.surface.equilibrium_gap
        return (self.tip.radius * W**2 / (modulus**2 * z0**3)) ** (1 / 3)

    @property
    def tabor_instantaneous(self) -> float:
        """Tabor number μ = (R W²/(E² z0³))^(1/3) with the short-term reduced modulus."""
        return self._tabor(self.sample.reduced_modulus_instantaneous)

    @property
    def tabor_relaxed(self) -> float:
        """Tabor number μ = (R W²/(E² z0³))^(1/3) with the long-term reduced modulus.

        Below about 0.1 adhesion acts outside a Hertz contact (DMT), above about 5 inside it (JKR).
        """
        return self._tabor(self.sample.reduced_modulus_relaxed)

    def _cohesive_length(self, modulus: float) -> float:
        return modulus * self.surface.equilibrium_gap**2 / self.surface.work_of_adhesion

    @property
    def cohesive_length(self) -> float:
        """Width ℓ = E z0²/W of the tension zone at the relaxed contact edge, m."""
        return self._cohesive_length(self.sample.reduced_modulus_relaxed)

    @property
    def cohesive_length_instantaneous(self) -> float:
        """Width ℓ = E z0²/W of the tension zone at the short-term modulus, m."""
        return self._cohesive_length(self.sample.reduced_modulus_instantaneous)

    def contact_radius(self, tip_height: float) -> float:
        """Radius of the relaxed contact expected at a tip height (m, negative = indented), m.

        The stable branch of JKR (Johnson, Kendall and Roberts 1971),
        −h0 = a²/R − sqrt(2πaW/E_inf); zero where no contact exists.
        """
        R = self.tip.radius
        pull = 2 * pi * self.surface.work_of_adhesion / self.sample.reduced_modulus_relaxed
        smallest = (R * sqrt(pull) / 4) ** (2 / 3)

        def excess(a: float) -> float:
            return a**2 / R - sqrt(pull * a) + tip_height

        if excess(smallest) > 0:
            return 0.0
        largest = sqrt(R * (abs(tip_height) + 1e3 * smallest**2 / R))
        return float(brentq(excess, smallest, max(largest, 10 * smallest)))
