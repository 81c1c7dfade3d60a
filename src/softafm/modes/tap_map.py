"""Observables of taps over amplitude and closest approach, from few taps.

A tap is determined by its amplitude A and by d = Z − A, the height of its lowest point. Along d the
observables change steeply, along A slowly, nearly as √A. So they are sampled on a few lines of
constant A, along d as densely as needed, and interpolated: by monotone cubics in d, and in between
lines by a polynomial in ln A.
"""

from collections.abc import Callable

import numpy as np

OBSERVABLES = (
    "virial", "dissipation", "force_mean", "force_max", "force_min", "contact_time", "indentation",
)  # fmt: skip
_LINES = 5
_MOST_SAMPLES = 80
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
        self, tap: Callable, excess: Callable, lowest: float, highest: float, unit: float,
        accuracy: float,
    ):  # fmt: skip
        self._tap, self._excess, self._unit, self._accuracy = tap, excess, unit, accuracy
        lines = _LINES if highest > 1.01 * lowest else 1
        nodes = np.cos(np.pi * (np.arange(lines) + 0.5) / lines)[::-1]
        nodes = nodes / nodes[-1] if lines > 1 else np.zeros(1)
        middle, half = np.log(highest * lowest) / 2, np.log(highest / lowest) / 2
        self._logs = middle + half * nodes
        self._samples: list[dict[float, np.ndarray]] = [{} for _ in range(lines)]
        self.taps = 0

    def explore(self):
        """Sample all lines, yielding the number of taps after each."""
        far = self._far_end()
        deep = self._deep_end()
        start = np.sign(deep) * np.inf
        start = np.concatenate(
            [np.geomspace(far, self._unit, 5), np.linspace(self._unit, deep, 8)[1:]]
        )
        for line in range(self._logs.size):
            for approach in start:
                self._sample(line, approach)
                yield self.taps
            yield from self._refine(line, np.sort(start))
        self.nearest_approach, self.farthest_approach = deep, far
        self._interpolants = [self._interpolant(line) for line in range(self._logs.size)]

    def __call__(self, amplitude, approach, count: int = len(OBSERVABLES)) -> np.ndarray:
        """Return the first ``count`` observables at amplitudes and approaches of equal shape, m.

        Shape (count, *that of the arguments).
        """
        amplitude, approach = np.broadcast_arrays(amplitude, approach)
        log = np.log(amplitude)
        total = np.zeros((*amplitude.shape, count))
        for line, interpolant in enumerate(self._interpolants):
            others = np.delete(self._logs, line)
            weight = np.prod(
                [(log - other) / (self._logs[line] - other) for other in others], axis=0
            )
            total += np.multiply.outer(np.ones(count), weight).T.reshape(total.shape) * interpolant(
                approach
            )[..., :count]
        return np.moveaxis(total * np.sqrt(amplitude)[..., None], -1, 0)

    def _sample(self, line: int, approach: float) -> np.ndarray:
        """Observables over √A at a point of a line."""
        known = self._samples[line]
        if approach not in known:
            amplitude = float(np.exp(self._logs[line]))
            known[approach] = np.asarray(self._tap(amplitude, approach)) / np.sqrt(amplitude)
            self.taps += 1
        return known[approach]

    def _excess_at(self, line: int, sample) -> float:
        amplitude = np.exp(self._logs[line])
        return float(self._excess(amplitude, *(np.sqrt(amplitude) * sample[:2])))

    def _far_end(self) -> float:
        """Approach at which the largest amplitude hardly feels the surface."""
        top = self._logs.size - 1
        free = self._excess_at(top, np.zeros(2))
        approach = 4 * self._unit
        while approach < _FARTHEST * self._unit:
            if abs(self._excess_at(top, self._sample(top, approach)) - free) < 0.1 * abs(free):
                break
            approach *= 2
        return approach

    def _deep_end(self) -> float:
        """Approach beyond which every line needs more than the drive, and ever more."""
        deep = -2 * self._unit
        for line in range(self._logs.size):
            lowest_possible = -1.8 * np.exp(self._logs[line])
            while deep > max(-_DEEPEST * self._unit, lowest_possible):
                sample = self._sample(line, deep)
                if sample[0] < 0 and self._excess_at(line, sample) > 0.1:
                    break
                deep *= 1.5
        return float(max(deep, -1.8 * np.exp(self._logs[0])))

    def _interpolant(self, line: int):
        from scipy.interpolate import PchipInterpolator

        approaches = np.array(sorted(self._samples[line]))
        return PchipInterpolator(approaches, [self._samples[line][d] for d in approaches])

    def _refine(self, line: int, start):
        """Halve intervals of a line while their middles are not met by interpolation."""
        intervals = list(zip(start[:-1], start[1:], strict=True))
        while intervals and len(self._samples[line]) < _MOST_SAMPLES:
            interpolant, missed = self._interpolant(line), []
            for low, high in intervals:
                middle = (low + high) / 2
                expected = self._excess_at(line, interpolant(middle))
                found = self._excess_at(line, self._sample(line, middle))
                yield self.taps
                if abs(found - expected) > self._accuracy and high - low > 1e-3 * self._unit:
                    missed += [(low, middle), (middle, high)]
            intervals = missed
