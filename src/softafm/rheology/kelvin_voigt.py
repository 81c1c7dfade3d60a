"""Solids built from springs with dashpots beside them."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from softafm.checks.validate import check_poisson_ratio, check_positive
from softafm.rheology.compliance import CreepCompliance
from softafm.rheology.lists import check_count, check_positives
from softafm.rheology.solid import Solid

STIFF = 1e6
"""Instantaneous modulus of a Kelvin-Voigt solid, in moduli of its spring."""


@dataclass(frozen=True)
class KelvinVoigt(Solid):
    """Spring and dashpot side by side, 1/E(t) = (1 − exp(−t/τ))/E.

    It has no instantaneous response, which the contact problem needs to have shapes at all: a
    spring of 10⁶ E stands in series, so compliances are high by 1e-6/E, and what happens faster
    than about 1e-6 τ is not that of the ideal solid. Its relaxation modulus E + Eτ δ(t) becomes
    E + 10⁶ E exp(−10⁶ t/τ), nearly: ``relaxation_modulus`` is E from 3e-5 τ on.

    Parameters
    ----------
    E
        Young's modulus of the spring, Pa.
    creep_time
        Creep (retardation) time τ = η/E, s.
    poisson
        Poisson's ratio, in (-1, 0.5].

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    kind: ClassVar[str] = "kelvin-voigt"
    E: float
    creep_time: float
    poisson: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "E", check_positive("E", self.E, "Pa"))
        object.__setattr__(self, "creep_time", check_positive("creep_time", self.creep_time, "s"))
        object.__setattr__(self, "poisson", check_poisson_ratio(self.poisson))

    @classmethod
    def from_viscosity(cls, E: float, viscosity: float, poisson: float) -> "KelvinVoigt":
        """Build from the viscosity of the dashpot: τ = η/E.

        Parameters
        ----------
        viscosity
            Viscosity η in uniaxial extension, Pa s.
        """
        E, viscosity = check_positive("E", E, "Pa"), check_positive("viscosity", viscosity, "Pa s")
        return cls(E, viscosity / E, poisson)

    @classmethod
    def from_shear(cls, G: float, viscosity: float, poisson: float) -> "KelvinVoigt":
        """Build from what is known in shear: E = 2(1 + ν)G, τ = η/G.

        Parameters
        ----------
        G
            Shear modulus of the spring, Pa.
        viscosity
            Viscosity η in shear, Pa s.
        """
        G, viscosity = check_positive("G", G, "Pa"), check_positive("viscosity", viscosity, "Pa s")
        return cls(2 * (1 + check_poisson_ratio(poisson)) * G, viscosity / G, poisson)

    @property
    def compliance(self) -> CreepCompliance:
        """One element, J_1 = 1/E, and an instantaneous part of 1e-6 of it."""
        element = 1 / self.E
        return CreepCompliance(element / STIFF, np.array([element]), np.array([self.creep_time]))


@dataclass(frozen=True)
class GeneralizedKelvinVoigt(Solid):
    """Chain of Kelvin-Voigt elements, 1/E(t) = 1/E0 + Σ J_m (1 − exp(−t/τ_m)).

    Parameters
    ----------
    E0
        Short-term Young's modulus, Pa.
    compliances
        Uniaxial compliances J_m, 1/Pa, without the factor 1 − ν².
    retardation_times
        Times τ_m, s, as many as compliances.
    poisson
        Poisson's ratio, in (-1, 0.5].

    Raises
    ------
    ValueError
        If a value is out of range or the numbers of compliances and times differ.
    """

    kind: ClassVar[str] = "generalized-kelvin-voigt"
    E0: float
    compliances: tuple[float, ...]
    retardation_times: tuple[float, ...]
    poisson: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "E0", check_positive("E0", self.E0, "Pa"))
        object.__setattr__(self, "poisson", check_poisson_ratio(self.poisson))
        compliances = check_positives("compliances", self.compliances, "1/Pa")
        times = check_positives("retardation_times", self.retardation_times, "s")
        object.__setattr__(self, "compliances", compliances)
        object.__setattr__(self, "retardation_times", times)
        check_count("retardation_times", times, "compliances", compliances)

    @property
    def compliance(self) -> CreepCompliance:
        """The chain itself."""
        return CreepCompliance(
            1 / self.E0,
            np.array(self.compliances, float),
            np.array(self.retardation_times, float),
        )
