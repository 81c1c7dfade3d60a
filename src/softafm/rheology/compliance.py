"""Creep compliance as a chain of Kelvin-Voigt elements: what solvers take."""

from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.validate import check_positive

LONG = 1e6
"""Retardation time of the element that stands for steady flow, in durations of the experiment."""


class CreepCompliance(NamedTuple):
    """Creep compliance of a chain: an instantaneous part, elements and flow.

    ``instantaneous`` in 1/Pa; ``elements`` in 1/Pa and ``retardation_times`` in s, both of shape
    (m,); ``fluidity``, the rate of steady flow under constant load, in 1/(Pa s), zero for a solid:
    J(t) = J_g + Σ J_m (1 − exp(−t/τ_m)) + φ t.
    """

    instantaneous: float
    elements: np.ndarray
    retardation_times: np.ndarray
    fluidity: float = 0.0

    def at(self, time: ArrayLike) -> np.ndarray:
        """Creep compliance at ``time`` (s) after a step of load, 1/Pa."""
        t = np.asarray(time, float)[..., None]
        creep = np.sum(self.elements * -np.expm1(-t / self.retardation_times), axis=-1)
        return self.instantaneous + creep + self.fluidity * t[..., 0]

    def complex_at(self, angular_frequency: ArrayLike) -> np.ndarray:
        """Complex compliance J_g + Σ J_m/(1 + iωτ_m) + φ/(iω) at ω > 0 (rad/s), 1/Pa."""
        s = 1j * np.asarray(angular_frequency, float)[..., None]
        elements = np.sum(self.elements / (1 + s * self.retardation_times), axis=-1)
        return self.instantaneous + elements + self.fluidity / s[..., 0]

    @property
    def relaxed(self) -> float:
        """Creep compliance after infinite time, 1/Pa; infinite where the sample flows."""
        if self.fluidity > 0:
            return inf
        return self.instantaneous + float(np.sum(self.elements))

    def scaled(self, factor: float) -> "CreepCompliance":
        """Return ``factor`` times the compliance, of the same times."""
        return CreepCompliance(
            factor * self.instantaneous,
            factor * np.asarray(self.elements, float),
            np.asarray(self.retardation_times, float),
            factor * self.fluidity,
        )

    def without_faster(self, time: float) -> "CreepCompliance":
        """Return the compliance with all creep faster than a time, s, taken for instantaneous."""
        times = np.asarray(self.retardation_times, float)
        fast = times < time
        return CreepCompliance(
            self.instantaneous + float(np.sum(np.asarray(self.elements, float)[fast])),
            np.asarray(self.elements, float)[~fast],
            times[~fast],
            self.fluidity,
        )

    def chain(self, duration: float) -> "CreepCompliance":
        """Return the compliance with elements only, for experiments up to ``duration`` (s).

        Steady flow becomes an element of retardation time 10⁶ durations and of the same initial
        rate: its creep is low by t/(2·10⁶ durations), at most 5e-7 of it.
        """
        if self.fluidity == 0:
            return self
        time = LONG * check_positive("duration", duration, "s")
        return CreepCompliance(
            self.instantaneous,
            np.append(self.elements, self.fluidity * time),
            np.append(self.retardation_times, time),
        )
