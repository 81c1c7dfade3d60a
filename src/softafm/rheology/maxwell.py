"""Samples built from springs with dashpots behind them: a Prony series of the modulus."""

import warnings
from dataclasses import dataclass
from functools import cached_property
from math import fsum
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.validate import check_finite, check_poisson_ratio, check_positive
from softafm.errors import AccuracyWarning
from softafm.rheology.compliance import CreepCompliance
from softafm.rheology.dma import measure_misfit, warn_of_misfit
from softafm.rheology.interconversion import prony_to_chain
from softafm.rheology.lists import check_count, check_positives
from softafm.rheology.prony_fit import fit_prony
from softafm.rheology.solid import Solid

_ROUND_OFF, _NONE_LEFT = 1e-12, 1e-6
"""E_inf/E0 that counts as zero, and what is too little to have been meant."""


@dataclass(frozen=True)
class Maxwell(Solid):
    """Spring and dashpot in a row: a fluid, E(t) = E0 exp(−t/λ), 1/E(t) = (1 + t/λ)/E0.

    Parameters
    ----------
    E0
        Short-term Young's modulus, Pa.
    relaxation_time
        Stress-relaxation time λ, s; the viscosity in extension is E0·λ.
    poisson
        Poisson's ratio, in (-1, 0.5]; constant, so the sample also flows in volume unless it
        is 0.5.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    kind: ClassVar[str] = "maxwell"
    E0: float
    relaxation_time: float
    poisson: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "E0", check_positive("E0", self.E0, "Pa"))
        time = check_positive("relaxation_time", self.relaxation_time, "s")
        object.__setattr__(self, "relaxation_time", time)
        object.__setattr__(self, "poisson", check_poisson_ratio(self.poisson))

    @classmethod
    def from_viscosity(cls, E0: float, viscosity: float, poisson: float) -> "Maxwell":
        """Build from the viscosity in uniaxial extension: λ = η_E/E0.

        Parameters
        ----------
        viscosity
            Viscosity η_E in uniaxial *extension*, Pa s: 2(1 + ν) times that in shear, Trouton's 3η
            at ν = 0.5.
        """
        E0, viscosity = (
            check_positive("E0", E0, "Pa"),
            check_positive("viscosity", viscosity, "Pa s"),
        )
        return cls(E0, viscosity / E0, poisson)

    @classmethod
    def from_shear(cls, G0: float, viscosity: float, poisson: float) -> "Maxwell":
        """Build from what is known in shear: E0 = 2(1 + ν)G0, λ = η/G0.

        Parameters
        ----------
        G0
            Short-term shear modulus, Pa.
        viscosity
            Viscosity η in *shear*, Pa s.
        """
        G0, viscosity = (
            check_positive("G0", G0, "Pa"),
            check_positive("viscosity", viscosity, "Pa s"),
        )
        return cls(2 * (1 + check_poisson_ratio(poisson)) * G0, viscosity / G0, poisson)

    @property
    def compliance(self) -> CreepCompliance:
        """No element, but steady flow: φ = 1/(E0 λ)."""
        spring = 1 / self.E0
        return CreepCompliance(spring, np.zeros(0), np.zeros(0), spring / self.relaxation_time)


@dataclass(frozen=True)
class GeneralizedMaxwell(Solid):
    """Prony series of the relaxation modulus, E(t) = E_inf + Σ E_k exp(−t/λ_k).

    Parameters
    ----------
    E_inf
        Long-term Young's modulus, Pa; zero if the sample flows.
    moduli
        Young's moduli E_k, Pa; zeros count for nothing.
    relaxation_times
        Stress-relaxation times λ_k, s, as many as moduli and in any order; terms of equal times
        are added.
    poisson
        Poisson's ratio, in (-1, 0.5].

    Raises
    ------
    ValueError
        If a value is out of range, the numbers of moduli and times differ, or all moduli are zero.
    """

    kind: ClassVar[str] = "generalized-maxwell"
    E_inf: float
    moduli: tuple[float, ...]
    relaxation_times: tuple[float, ...]
    poisson: float

    def __post_init__(self) -> None:
        E_inf = check_finite("E_inf", self.E_inf, "Pa")
        if E_inf < 0:
            raise ValueError(f"E_inf = {E_inf:g} Pa: must be positive, or 0 if the sample flows")
        moduli = check_positives("moduli", self.moduli, "Pa", zeros=True)
        times = check_positives("relaxation_times", self.relaxation_times, "s")
        check_count("relaxation_times", times, "moduli", moduli)
        if E_inf == 0 and not any(moduli):
            raise ValueError("moduli has no entry above 0 Pa: must have one where E_inf = 0 Pa")
        object.__setattr__(self, "E_inf", E_inf)
        object.__setattr__(self, "moduli", moduli)
        object.__setattr__(self, "relaxation_times", times)
        object.__setattr__(self, "poisson", check_poisson_ratio(self.poisson))

    @classmethod
    def from_shear(
        cls, G_inf: float, shear_moduli: ArrayLike, relaxation_times: ArrayLike, poisson: float
    ) -> "GeneralizedMaxwell":
        """Build from shear moduli at constant Poisson's ratio: E = 2(1 + ν)G.

        Parameters
        ----------
        G_inf
            Long-term shear modulus, Pa; zero if the sample flows.
        shear_moduli
            Shear moduli G_k, Pa; zeros count for nothing.
        """
        factor = 2 * (1 + check_poisson_ratio(poisson))
        G_inf = check_finite("G_inf", G_inf, "Pa")
        if G_inf < 0:
            raise ValueError(f"G_inf = {G_inf:g} Pa: must be positive, or 0 if the sample flows")
        shear_moduli = check_positives("shear_moduli", shear_moduli, "Pa", zeros=True)
        times = check_positives("relaxation_times", relaxation_times, "s")
        return cls(factor * G_inf, tuple(factor * G for G in shear_moduli), times, poisson)

    @classmethod
    def from_ratios(
        cls, E0: float, ratios: ArrayLike, relaxation_times: ArrayLike, poisson: float
    ) -> "GeneralizedMaxwell":
        """Build from a normalised series, E_k = ratio_k·E0, E_inf = (1 − Σ ratios)·E0.

        Finite-element programs state materials so. Ratios that add up to 1 leave no E_inf, and warn
        (``AccuracyWarning``): some fitting programs normalise those of every solid so.

        Parameters
        ----------
        E0
            Short-term Young's modulus, Pa.
        ratios
            E_k/E0, no unit, of which the sum is at most 1; it flows if the sum is 1.
        """
        E0 = check_positive("E0", E0, "Pa")
        ratios = check_positives("ratios", ratios, "", zeros=True)
        rest = 1 - fsum(ratios)
        if rest < -_ROUND_OFF:
            raise ValueError(
                f"ratios add up to {fsum(ratios):.10g}: must add up to at most 1, "
                "for what remains is E_inf/E0"
            )
        E_inf = E0 * rest if rest > _ROUND_OFF else 0.0
        if rest < _NONE_LEFT:
            warnings.warn(
                f"ratios add up to {fsum(ratios):.10g}, which leaves E_inf = {E_inf:g} Pa, a "
                "liquid. Programs that normalise ratios to 1 make one of every solid. State it by "
                "moduli and E_inf, which is 0 Pa if it flows indeed",
                AccuracyWarning,
                stacklevel=2,
            )
        times = check_positives("relaxation_times", relaxation_times, "s")
        return cls(E_inf, tuple(E0 * ratio for ratio in ratios), times, poisson)

    @classmethod
    def from_dma(
        cls,
        frequency: ArrayLike,
        storage: ArrayLike,
        loss: ArrayLike,
        poisson: float,
        per_decade: float = 2,
    ) -> "GeneralizedMaxwell":
        """Fit measured Young's moduli by a series of as few terms as their noise tells apart.

        The misfit stays with the sample, as ``dma_misfit``; one above 10 % gives
        an ``AccuracyWarning``. Beyond the measured frequencies the fit is an extrapolation.

        Parameters
        ----------
        frequency
            Measured frequencies, Hz, in any order.
        storage, loss
            Storage and loss modulus, Pa, as many.
        per_decade
            Relaxation times a decade, at most, from which the fit begins; 0.5 to 10.

        Raises
        ------
        ValueError
            If the data are not such, or no linear passive solid can have them.

        References
        ----------
        ``softafm.rheology.prony_fit`` tells the method.
        """
        sample = cls(*fit_prony(frequency, storage, loss, per_decade), poisson)
        object.__setattr__(sample, "dma_misfit", measure_misfit(sample, frequency, storage, loss))
        warn_of_misfit(sample, frequency, storage, loss)
        return sample

    @cached_property
    def compliance(self) -> CreepCompliance:
        """The exact creep compliance of the series."""
        return CreepCompliance(*prony_to_chain(self.E_inf, self.moduli, self.relaxation_times))
