"""Linear viscoelastic samples, each stated by its creep compliance.

Every solid is written as a generalised Kelvin-Voigt chain,
1/E(t) = 1/E0 + Σ J_m (1 − exp(−t/τ_m)), in uniaxial compliance; the contact problem needs it times
1 − ν² (Rajabifar et al. 2021, equations 4 and 9).
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from softafm._validate import poisson_ratio, positive


class ReducedCompliance(NamedTuple):
    """Creep compliance of a half-space under a rigid tip: instantaneous part and modes.

    ``instantaneous`` in 1/Pa; ``modes`` in 1/Pa and ``retardation_times`` in s, both of shape (m,).
    """

    instantaneous: float
    modes: np.ndarray
    retardation_times: np.ndarray

    def at(self, time):
        """Creep compliance at ``time`` (s) after a step of load, 1/Pa."""
        t = np.asarray(time, float)[..., None]
        return self.instantaneous + np.sum(
            self.modes * -np.expm1(-t / self.retardation_times), axis=-1
        )

    @property
    def relaxed(self) -> float:
        """Creep compliance after infinite time, 1/Pa."""
        return self.instantaneous + float(np.sum(self.modes))


class _Solid(ABC):
    """What every sample derives from its reduced compliance."""

    @property
    @abstractmethod
    def reduced_compliance(self) -> ReducedCompliance:
        """Creep compliance of a half-space of this solid, 1/Pa and s."""

    @property
    def reduced_modulus_instantaneous(self) -> float:
        """E0/(1 − ν²), Pa."""
        return 1 / self.reduced_compliance.instantaneous

    @property
    def reduced_modulus_relaxed(self) -> float:
        """E_inf/(1 − ν²), Pa."""
        return 1 / self.reduced_compliance.relaxed


@dataclass(frozen=True)
class Elastic(_Solid):
    """Elastic half-space.

    Parameters
    ----------
    E
        Young's modulus, Pa.
    poisson
        Poisson's ratio, in (-1, 0.5].

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    kind: ClassVar[str] = "elastic"
    E: float
    poisson: float

    def __post_init__(self):
        object.__setattr__(self, "E", positive("E", self.E, "Pa"))
        object.__setattr__(self, "poisson", poisson_ratio(self.poisson))

    @property
    def reduced_compliance(self) -> ReducedCompliance:
        """(1 − ν²)/E, without modes."""
        return ReducedCompliance((1 - self.poisson**2) / self.E, np.zeros(0), np.zeros(0))


@dataclass(frozen=True)
class StandardLinearSolid(_Solid):
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

    def __post_init__(self):
        object.__setattr__(self, "E0", positive("E0", self.E0, "Pa"))
        object.__setattr__(self, "E_inf", positive("E_inf", self.E_inf, "Pa"))
        object.__setattr__(self, "creep_time", positive("creep_time", self.creep_time, "s"))
        object.__setattr__(self, "poisson", poisson_ratio(self.poisson))
        if self.E_inf > self.E0:
            raise ValueError(
                f"E_inf = {self.E_inf:g} Pa: must be at most E0 = {self.E0:g} Pa "
                "(a solid softens as it relaxes)"
            )

    @classmethod
    def from_relaxation_time(
        cls, E0: float, E_inf: float, relaxation_time: float, poisson: float
    ) -> "StandardLinearSolid":
        """Build from the stress-relaxation time τ_σ (s): τ = τ_σ·E0/E_inf."""
        relaxation_time = positive("relaxation_time", relaxation_time, "s")
        E0, E_inf = positive("E0", E0, "Pa"), positive("E_inf", E_inf, "Pa")
        return cls(E0, E_inf, relaxation_time * E0 / E_inf, poisson)

    @classmethod
    def from_shear(
        cls, G0: float, G_inf: float, creep_time: float, poisson: float
    ) -> "StandardLinearSolid":
        """Build from shear moduli (Pa) at constant Poisson's ratio: E = 2(1 + ν)G."""
        G0, G_inf = positive("G0", G0, "Pa"), positive("G_inf", G_inf, "Pa")
        factor = 2 * (1 + poisson_ratio(poisson))
        return cls(factor * G0, factor * G_inf, creep_time, poisson)

    @property
    def reduced_compliance(self) -> ReducedCompliance:
        """One mode, J_1 = (1 − ν²)(1/E_inf − 1/E0); none when the moduli are equal."""
        factor = 1 - self.poisson**2
        if self.E_inf == self.E0:
            return ReducedCompliance(factor / self.E0, np.zeros(0), np.zeros(0))
        mode = factor * (1 / self.E_inf - 1 / self.E0)
        return ReducedCompliance(factor / self.E0, np.array([mode]), np.array([self.creep_time]))


@dataclass(frozen=True)
class GeneralizedKelvinVoigt(_Solid):
    """Chain of Kelvin-Voigt elements, 1/E(t) = 1/E0 + Σ J_m (1 − exp(−t/τ_m)).

    Parameters
    ----------
    E0
        Short-term Young's modulus, Pa.
    compliances
        Uniaxial compliances J_m, 1/Pa; the factor 1 − ν² is applied inside.
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

    def __post_init__(self):
        def all_positive(name, values, unit):
            if isinstance(values, str) or not hasattr(values, "__iter__"):
                raise ValueError(f"{name} = {values!r}: must be a list of numbers in {unit}")
            return tuple(positive(f"{name}[{i}]", v, unit) for i, v in enumerate(values))

        object.__setattr__(self, "E0", positive("E0", self.E0, "Pa"))
        object.__setattr__(self, "poisson", poisson_ratio(self.poisson))
        compliances = all_positive("compliances", self.compliances, "1/Pa")
        times = all_positive("retardation_times", self.retardation_times, "s")
        object.__setattr__(self, "compliances", compliances)
        object.__setattr__(self, "retardation_times", times)
        if len(compliances) != len(times):
            raise ValueError(
                f"retardation_times has {len(times)} entries: must have as many as "
                f"compliances, {len(compliances)}"
            )

    @property
    def reduced_compliance(self) -> ReducedCompliance:
        """(1 − ν²) times the uniaxial chain."""
        factor = 1 - self.poisson**2
        return ReducedCompliance(
            factor / self.E0,
            factor * np.array(self.compliances, float),
            np.array(self.retardation_times, float),
        )
