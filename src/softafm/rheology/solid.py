"""What every linear viscoelastic sample has in common."""

from abc import ABC, abstractmethod
from functools import cached_property
from math import pi
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from softafm.rheology.compliance import ReducedCompliance
from softafm.rheology.interconversion import chain_to_prony
from softafm.rheology.lists import samples


class Solid(ABC):
    """A sample: creep, relaxation, storage and loss modulus follow from its reduced compliance."""

    kind: ClassVar[str]
    poisson: float
    dma_misfit: tuple[float, float] | None = None
    """Largest and root mean square relative misfit to the measured moduli it was fitted to."""

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
        """E_inf/(1 − ν²), Pa; zero if the sample flows."""
        return 1 / self.reduced_compliance.relaxed

    @cached_property
    def _prony(self) -> tuple[float, np.ndarray, np.ndarray]:
        """E_inf, moduli and relaxation times of the reduced modulus."""
        return chain_to_prony(*self.reduced_compliance)

    def creep_compliance(self, time: ArrayLike) -> np.ndarray:
        """Uniaxial creep compliance 1/E(t) at ``time`` ≥ 0 (s) after a step of stress, 1/Pa."""
        return self.reduced_compliance.at(samples("time", time, "s", 0)) / (1 - self.poisson**2)

    def relaxation_modulus(self, time: ArrayLike) -> np.ndarray:
        """Young's relaxation modulus at ``time`` ≥ 0 (s) after a step of strain, Pa."""
        t = samples("time", time, "s", 0)[..., None]
        E_inf, moduli, times = self._prony
        return (1 - self.poisson**2) * (E_inf + np.sum(moduli * np.exp(-t / times), axis=-1))

    def storage_modulus(self, frequency: ArrayLike) -> np.ndarray:
        """Young's storage modulus E' at ``frequency`` > 0 (Hz), Pa."""
        return self._complex_modulus(frequency).real

    def loss_modulus(self, frequency: ArrayLike) -> np.ndarray:
        """Young's loss modulus E'' at ``frequency`` > 0 (Hz), Pa."""
        return self._complex_modulus(frequency).imag

    def _complex_modulus(self, frequency: ArrayLike) -> np.ndarray:
        angular = 2 * pi * samples("frequency", frequency, "Hz")
        return (1 - self.poisson**2) / self.reduced_compliance.complex_at(angular)
