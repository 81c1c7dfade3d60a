"""The solid of one creep time between two moduli."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from softafm.checks.validate import check_poisson_ratio, check_positive
from softafm.rheology.compliance import CreepCompliance
from softafm.rheology.solid import Solid


@dataclass(frozen=True)
class StandardLinearSolid(Solid):
    """Standard linear solid, 1/E(t) = 1/E_inf + (1/E0 − 1/E_inf)·exp(−t/τ).

    Parameters
    ----------
    E0, E_inf
        Short- and long-term Young's modulus, Pa; E_inf ≤ E0.
    creep_time
        Creep (retardation) time τ, s. Not the stress-relaxation time: see
        ``from_relaxation_time``.
    poisson
        Poisson's ratio, in (-1, 0.5].

    Raises
    ------
    ValueError
        If a value is out of range or E_inf > E0.

    References
    ----------
    Rajabifar et al. 2021, equation (4).
    """

    kind: ClassVar[str] = "standard-linear-solid"
    E0: float
    E_inf: float
    creep_time: float
    poisson: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "E0", check_positive("E0", self.E0, "Pa"))
        object.__setattr__(self, "E_inf", check_positive("E_inf", self.E_inf, "Pa"))
        object.__setattr__(self, "creep_time", check_positive("creep_time", self.creep_time, "s"))
        object.__setattr__(self, "poisson", check_poisson_ratio(self.poisson))
        if self.E_inf > self.E0:
            raise ValueError(
                f"E_inf = {self.E_inf:g} Pa: must be at most E0 = {self.E0:g} Pa "
                "(a solid softens as it relaxes)"
            )

    @classmethod
    def from_relaxation_time(
        cls, E0: float, E_inf: float, relaxation_time: float, poisson: float
    ) -> "StandardLinearSolid":
        """Build from the stress-relaxation time: τ = τ_σ·E0/E_inf.

        Parameters
        ----------
        relaxation_time
            Stress-relaxation time τ_σ at constant strain, s; shorter than the creep time.
        """
        relaxation_time = check_positive("relaxation_time", relaxation_time, "s")
        E0, E_inf = check_positive("E0", E0, "Pa"), check_positive("E_inf", E_inf, "Pa")
        return cls(E0, E_inf, relaxation_time * E0 / E_inf, poisson)

    @classmethod
    def from_shear(
        cls, G0: float, G_inf: float, creep_time: float, poisson: float
    ) -> "StandardLinearSolid":
        """Build from shear moduli at constant Poisson's ratio: E = 2(1 + ν)G.

        Parameters
        ----------
        G0, G_inf
            Short- and long-term shear modulus, Pa; G_inf ≤ G0.
        """
        G0, G_inf = check_positive("G0", G0, "Pa"), check_positive("G_inf", G_inf, "Pa")
        factor = 2 * (1 + check_poisson_ratio(poisson))
        return cls(factor * G0, factor * G_inf, creep_time, poisson)

    @property
    def compliance(self) -> CreepCompliance:
        """One element, J_1 = 1/E_inf − 1/E0; none when the moduli are equal."""
        if self.E_inf == self.E0:
            return CreepCompliance(1 / self.E0, np.zeros(0), np.zeros(0))
        element = 1 / self.E_inf - 1 / self.E0
        return CreepCompliance(1 / self.E0, np.array([element]), np.array([self.creep_time]))
