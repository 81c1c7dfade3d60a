"""Creep compliance as a chain of Kelvin-Voigt elements: what solvers take."""

from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.validate import positive

LONG = 1e6
"""Retardation time of the mode that stands for steady flow, in durations of the experiment."""


class ReducedCompliance(NamedTuple):
    """Creep compliance of a half-space under a rigid tip: instantaneous part, modes and flow.

    ``instantaneous`` in 1/Pa; ``modes`` in 1/Pa and ``retardation_times`` in s, both of shape (m,);
    ``fluidity``, the rate of steady flow under constant load, in 1/(Pa s), zero for a solid:
    J(t) = J_g + Σ J_m (1 − exp(−t/τ_m)) + φ t.
    """

    instantaneous: float
    modes: np.ndarray
    retardation_times: np.ndarray
    fluidity: float = 0.0

    def at(self, time: ArrayLike) -> np.ndarray:
        """Creep compliance at ``time`` (s) after a step of load, 1/Pa."""
        t = np.asarray(time, float)[..., None]
        creep = np.sum(self.modes * -np.expm1(-t / self.retardation_times), axis=-1)
        return self.instantaneous + creep + self.fluidity * t[..., 0]

    def complex_at(self, angular_frequency: ArrayLike) -> np.ndarray:
        """Complex compliance J_g + Σ J_m/(1 + iωτ_m) + φ/(iω) at ω > 0 (rad/s), 1/Pa."""
        s = 1j * np.asarray(angular_frequency, float)[..., None]
        modes = np.sum(self.modes / (1 + s * self.retardation_times), axis=-1)
        return self.instantaneous + modes + self.fluidity / s[..., 0]

    @property
    def relaxed(self) -> float:
        """Creep compliance after infinite time, 1/Pa; infinite where the sample flows."""
        if self.fluidity > 0:
            return inf
        return self.instantaneous + float(np.sum(self.modes))

    def chain(self, duration: float) -> "ReducedCompliance":
        """Return the compliance with modes only, for experiments up to ``duration`` (s).

        Steady flow becomes a mode of retardation time 10⁶ durations and of the same initial rate:
        its creep is low by t/(2·10⁶ durations), at most 5e-7 of it.
        """
        if self.fluidity == 0:
            return self
        time = LONG * positive("duration", duration, "s")
        return ReducedCompliance(
            self.instantaneous,
            np.append(self.modes, self.fluidity * time),
            np.append(self.retardation_times, time),
        )
