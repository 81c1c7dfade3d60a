"""What every linear viscoelastic sample has in common."""

from abc import ABC, abstractmethod
from functools import cached_property
from math import pi
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.kinds import REDUCED
from softafm.rheology.compliance import CreepCompliance
from softafm.rheology.interconversion import chain_to_prony
from softafm.rheology.lists import check_points


class Solid(ABC):
    """A sample: relaxation, storage and loss modulus follow from its creep compliance."""

    kind: ClassVar[str]
    poisson: float
    dma_misfit: tuple[float, float] | None = None
    """Largest and root mean square relative misfit to the measured moduli it was fitted to."""

    def __init_subclass__(cls, **arguments: Any) -> None:
        super().__init_subclass__(**arguments)
        if "reduced_compliance" in vars(cls) and "compliance" not in vars(cls):
            raise TypeError(f"class {cls.__name__}: {REDUCED}")

    @property
    @abstractmethod
    def compliance(self) -> CreepCompliance:
        """Creep compliance under uniaxial stress, without the factor 1 − ν², in 1/Pa and s."""

    @property
    def reduced_modulus_instantaneous(self) -> float:
        """E0/(1 − ν²), Pa."""
        return 1 / ((1 - self.poisson**2) * self.compliance.instantaneous)

    @property
    def reduced_modulus_relaxed(self) -> float:
        """E_inf/(1 − ν²), Pa; zero if the sample flows."""
        return 1 / ((1 - self.poisson**2) * self.compliance.relaxed)

    @cached_property
    def _prony(self) -> tuple[float, np.ndarray, np.ndarray]:
        """E_inf, moduli and relaxation times."""
        return chain_to_prony(*self.compliance)

    def creep_compliance(self, time: ArrayLike) -> np.ndarray:
        """Uniaxial creep compliance 1/E(t) at ``time`` ≥ 0 (s) after a step of stress, 1/Pa."""
        return self.compliance.at(check_points("time", time, "s", 0))

    def relaxation_modulus(self, time: ArrayLike) -> np.ndarray:
        """Young's relaxation modulus at ``time`` ≥ 0 (s) after a step of strain, Pa."""
        t = check_points("time", time, "s", 0)[..., None]
        E_inf, moduli, times = self._prony
        return E_inf + np.sum(moduli * np.exp(-t / times), axis=-1)

    def storage_modulus(self, frequency: ArrayLike) -> np.ndarray:
        """Young's storage modulus E' at ``frequency`` > 0 (Hz), Pa."""
        return self._complex_modulus(frequency).real

    def loss_modulus(self, frequency: ArrayLike) -> np.ndarray:
        """Young's loss modulus E'' at ``frequency`` > 0 (Hz), Pa."""
        return self._complex_modulus(frequency).imag

    def _complex_modulus(self, frequency: ArrayLike) -> np.ndarray:
        angular = 2 * pi * check_points("frequency", frequency, "Hz")
        return 1 / self.compliance.complex_at(angular)
