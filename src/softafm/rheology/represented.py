"""Samples of a continuous spectrum, represented by few elements over the times of an experiment."""

from abc import abstractmethod
from functools import cached_property
from math import pi

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.deprecated import Renamed
from softafm.checks.validate import check_finite
from softafm.rheology.compliance import CreepCompliance
from softafm.rheology.lists import check_points
from softafm.rheology.series import Response, Series, find_fewest_elements
from softafm.rheology.solid import Solid


def check_exponent(value: float) -> float:
    """Return ``value`` if it lies between those of a spring, 0, and of a dashpot, 1."""
    number = check_finite("exponent", value, "")
    if not 0 < number < 1:
        raise ValueError(f"exponent = {number:g}: must be above 0 (elastic) and below 1 (viscous)")
    return number


class Represented(Solid):
    """A sample known exactly, of which solvers take a chain that keeps ``error`` over ``window``.

    Creep, relaxation and moduli are those of the chain; ``exact_`` ones are of the law itself.
    """

    window: tuple[float, float]
    error: float

    @property
    @abstractmethod
    def _response(self) -> Response:
        """The law, with times in units of the shortest of the window."""

    @property
    @abstractmethod
    def _scale(self) -> float:
        """The unit of its uniaxial compliance, 1/Pa."""

    @cached_property
    def _series(self) -> Series:
        return find_fewest_elements(self._response, self.window, self.error)

    @property
    def represented_error(self) -> float:
        """Largest relative error of the chain in the window, of creep and complex compliance."""
        return self._series.error

    @property
    def element_count(self) -> int:
        """Number of elements that a solver carries, steady flow included."""
        chain = self._series.compliance
        return chain.elements.size + (chain.fluidity > 0)

    mode_count = Renamed("element_count", "0.2.0 of 2026-11-30", "0.4.0")

    @cached_property
    def compliance(self) -> CreepCompliance:
        """The chain that stands for the law."""
        time, chain = self.window[0], self._series.compliance
        return CreepCompliance(
            self._scale * chain.instantaneous,
            self._scale * chain.elements,
            time * chain.retardation_times,
            self._scale * chain.fluidity / time,
        )

    def exact_creep_compliance(self, time: ArrayLike) -> np.ndarray:
        """Uniaxial creep compliance of the law itself at ``time`` > 0 (s), 1/Pa."""
        return self._scale * self._response.creep(check_points("time", time, "s") / self.window[0])

    def exact_complex_compliance(self, frequency: ArrayLike) -> np.ndarray:
        """Uniaxial complex compliance of the law itself at ``frequency`` > 0 (Hz), 1/Pa."""
        angular = 2 * pi * check_points("frequency", frequency, "Hz")
        return self._scale * self._response.complex_compliance(angular * self.window[0])
