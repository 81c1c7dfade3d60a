"""Observables of taps over amplitude and closest approach, from few taps.

A tap is determined by its amplitude A and by d = Z − A, the height of its lowest point. Along d the
observables change steeply, along A slowly, nearly as √A. So they are sampled on a few lines of
constant A, along d as densely as needed, and interpolated: by monotone cubics in d, and in between
lines by a polynomial in ln A.
"""

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from softafm.results.content import TAPPED

OBSERVABLES = TAPPED
_LINES = 5
_MOST_SAMPLES = 80
_AWAY, _HEIGHT = 3.0, 0.3
"""Of an excess, and of the rise along d over a unit: what may be missed, with 1, in tolerances."""
_FARTHEST, _DEEPEST = 500.0, 3000.0


class TapMap:
    """Interpolates observables of taps of ``lowest`` to ``highest`` amplitude, m.

    Parameters
    ----------
    tap
        Function of amplitude and closest approach, m, that returns the ``OBSERVABLES``.
    excess
        Function of amplitude, virial and dissipation whose zeros matter. Sampling along d is
        refined until it is met within ``accuracy``.
    unit
        Length over which taps change along d: the equilibrium gap, m.
    """

    def __init__(
        self,
        tap: Callable[[float, float], ArrayLike],
        excess: Callable[..., Any],
        lowest: float,
        highest: float,
        unit: float,
        accuracy: float,
    ):
        self._tap, self._excess, self._accuracy = tap, excess, accuracy
        self.lowest, self.highest, self.unit = lowest, highest, unit
        lines = _LINES if highest > 1.01 * lowest else 1
        nodes = np.cos(np.pi * (np.arange(lines) + 0.5) / lines)[::-1]
        nodes = nodes / nodes[-1] if lines > 1 else np.zeros(1)
        middle, half = np.log(highest * lowest) / 2, np.log(highest / lowest) / 2
        self._logs = middle + half * nodes
        self._samples: list[dict[float, np.ndarray]] = [{} for _ in range(lines)]
        self.taps = 0

    def explore(self) -> Iterator[int]:
        """Sample all lines, yielding the number of taps so far after each."""
        self.farthest, self.nearest = self._far_end(), self._deep_end()
        outer = np.geomspace(self.farthest, self.unit, 5)
        start = np.concatenate([np.linspace(self.nearest, self.unit, 8), outer[-2::-1]])
        for line in range(self._logs.size):
            for approach in start:
                self._sample(line, approach)
                yield self.taps
            yield from self._refine(line, start)
        self._both = [self._interpolant(line, slice(0, 2)) for line in range(self._logs.size)]
        self._all = [self._interpolant(line) for line in range(self._logs.size)]

    def virial_and_dissipation(self, amplitude: ArrayLike, approach: ArrayLike) -> np.ndarray:
        """V and E, J, at amplitudes and closest approaches, m: shape (2, *broadcast)."""
        return self._combine(self._both, amplitude, approach)

    def observables(self, amplitude: ArrayLike, approach: ArrayLike) -> np.ndarray:
        """All ``OBSERVABLES`` at amplitudes and closest approaches, m: shape (7, *broadcast)."""
        return self._combine(self._all, amplitude, approach)

    def excess_slope(self, amplitude: float, approach: float) -> float:
        """Slope of the excess along d, 1/m."""
        step = 1e-2 * self.unit
        far, near = (
            self._excess(amplitude, *self.virial_and_dissipation(amplitude, approach + s))
            for s in (step, -step)
        )
        return float(far - near) / (2 * step)

    def _combine(
        self, interpolants: list[Any], amplitude: ArrayLike, approach: ArrayLike
    ) -> np.ndarray:
        """Lagrange's polynomial in ln A through the lines, times √A."""
        amplitude, approach = np.broadcast_arrays(amplitude, approach)
        log, total = np.log(amplitude), np.zeros(1)
        for line, interpolant in enumerate(interpolants):
            weight = np.sqrt(amplitude)
            for other in np.delete(self._logs, line):
                weight = weight * (log - other) / (self._logs[line] - other)
            total = total + weight[..., None] * interpolant(approach)
        return np.moveaxis(total, -1, 0)

    def _sample(self, line: int, approach: float) -> np.ndarray:
        """Observables over √A at a point of a line."""
        known = self._samples[line]
        if approach not in known:
            amplitude = float(np.exp(self._logs[line]))
            known[approach] = np.asarray(self._tap(amplitude, approach)) / np.sqrt(amplitude)
            self.taps += 1
        return known[approach]

    def _excess_at(self, line: int, sample: np.ndarray) -> float:
        amplitude = np.exp(self._logs[line])
        return float(self._excess(amplitude, *(np.sqrt(amplitude) * sample[:2])))

    def _far_end(self) -> float:
        """Approach at which the largest amplitude hardly feels the surface."""
        top = self._logs.size - 1
        free = self._excess_at(top, np.zeros(2))
        approach = 4 * self.unit
        while approach < _FARTHEST * self.unit:
            if abs(self._excess_at(top, self._sample(top, approach)) - free) < 0.1 * abs(free):
                break
            approach *= 2
        return approach

    def _deep_end(self) -> float:
        """Approach beyond which every line needs more than the drive, and ever more."""
        deep = -2 * self.unit
        for line in range(self._logs.size):
            while deep > -_DEEPEST * self.unit:
                sample = self._sample(line, deep)
                if sample[0] < 0 and self._excess_at(line, sample) > 0.1:
                    break
                deep *= 1.5
        return deep

    def _interpolant(self, line: int, which: slice = slice(None)) -> Any:
        from scipy.interpolate import PchipInterpolator

        approaches = sorted(self._samples[line])
        values = [self._samples[line][approach][which] for approach in approaches]
        return PchipInterpolator(approaches, values, extrapolate=False)

    def _refine(self, line: int, start: np.ndarray) -> Iterator[int]:
        """Halve intervals of a line while their middles are not met by interpolation."""
        intervals = list(pairwise(start))
        while intervals and len(self._samples[line]) < _MOST_SAMPLES:
            interpolant, missed = self._interpolant(line), []
            for low, high in intervals:
                middle = (low + high) / 2
                expected = self._excess_at(line, interpolant(middle))
                found = self._excess_at(line, self._sample(line, middle))
                yield self.taps
                one, other = (self._excess_at(line, self._sample(line, end)) for end in (low, high))
                rise = abs(other - one)
                width = abs(high - low)
                # More is allowed where no solution is near, or in force what is little in height.
                allowed = max(1 + _AWAY * abs(found), _HEIGHT * self.unit / width * rise)
                if abs(found - expected) > self._accuracy * allowed and width > 1e-3 * self.unit:
                    missed += [(low, middle), (middle, high)]
            intervals = missed
