"""Observables of taps of one amplitude over their closest approach, from few taps."""

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from softafm.errors import DivergedError
from softafm.instrument.oscillator import Drive

_MOST_SAMPLES = 80
_AWAY, _HEIGHT = 10.0, 0.3
"""Of an excess, and of the rise along d over a unit: what may be missed, with 1, in tolerances."""
_DOUBT = 0.25
"""Part of that by which two interpolations differ where a tap decides."""
_INNER, _DEEPER = (0.75, 0.3, -0.4, -1.1, -2.0), 1.5
"""Closest approaches where the sample is met, in units, and the ratio of those that follow."""
_SPENT, _TOO_MUCH = 0.1, 1.2
"""Excess of a repelled tap deep in the sample, and repulsion over the force of the drive, beyond
which nothing is sought."""
_FAILURES = 2
"""Taps in a row without a result, beyond which nothing is sought either."""

Tap = Callable[[float, float], ArrayLike]


class TapLine:
    """Interpolates observables of taps of one amplitude, m: monotone cubics along d.

    Parameters
    ----------
    tap
        Function of amplitude and closest approach, m, that returns the observables of a tap.
        Taps at which it raises ``DivergedError`` are done without.
    drive
        Drive of the lever. Sampling along d is refined until the excess of the force needed is met
        within ``accuracy``.
    amplitude
        Amplitude of the taps, m.
    unit
        Length over which taps change along d: the equilibrium gap, m.
    """

    def __init__(self, tap: Tap, drive: Drive, amplitude: float, unit: float, accuracy: float):
        self._tap, self._drive, self._accuracy = tap, drive, accuracy
        self.amplitude, self._unit = amplitude, unit
        self._samples: dict[float, np.ndarray] = {}
        self.failures: dict[float, DivergedError] = {}
        self.cut = False
        """Whether taps failed before the drive was spent."""

    @property
    def taps(self) -> int:
        """Number of taps so far."""
        return len(self._samples) + len(self.failures)

    @property
    def tried(self) -> list[float]:
        """Closest approaches of all taps, m."""
        return [*self._samples, *self.failures]

    @property
    def approaches(self) -> list[float]:
        """Closest approaches of the taps that have a result, m, from near to far."""
        return sorted(self._samples)

    @property
    def excesses(self) -> list[float]:
        """Excess of the force needed at these approaches."""
        return [self._excess(self._samples[approach]) for approach in self.approaches]

    def excess_at(self, approach: float) -> float:
        """Excess of the force needed by a tap, which is run; NaN if it fails."""
        return self._excess(self._samples[approach]) if self._try(approach) else np.nan

    def explore(self, farthest: float, deepest: float) -> Iterator[int]:
        """Sample the line from afar down to where the drive is spent, yielding after each tap."""
        for approach in np.geomspace(farthest, self._unit, 5).tolist():
            self._try(approach)
            yield self.taps
        yield from self._descend(deepest)
        if len(self._samples) < 2 and self.failures:
            raise next(iter(self.failures.values()))
        yield from self._refine()
        self._finish()

    def find_support(self, approach: float) -> list[float]:
        """Approaches of the taps next to an approach: one with a result on either side at least."""
        known = np.array(self.approaches)
        at = np.clip(np.searchsorted(known, approach), 1, known.size - 1)
        low, high = known[at - 1 : at + 1].tolist()
        return [low, high, *(each for each in self.failures if low < each < high)]

    def interpolate(self, approach: np.ndarray, pair: bool) -> np.ndarray:
        """Observables over √A, (*shape, 7), or a ``pair``: virial and dissipation.

        NaN beyond the far end; beyond the near one straight on.
        """
        interpolant, slope = self._pair if pair else self._all
        deeper = np.minimum(approach - self.nearest, 0.0)
        return interpolant(np.maximum(approach, self.nearest)) + deeper[..., None] * slope

    def _try(self, approach: float) -> bool:
        """Whether a tap has a result; it is run if it has not been."""
        if approach in self.failures:
            return False
        if approach not in self._samples:
            try:
                values = np.asarray(self._tap(self.amplitude, approach))
            except DivergedError as error:
                self.failures[approach] = error
                return False
            self._samples[approach] = values / np.sqrt(self.amplitude)
        return True

    def _descend(self, deepest: float) -> Iterator[int]:
        """Go down until the drive is spent, the sample too deep, or taps fail."""
        failed, approaches = 0, self._unit * np.array(_INNER)
        while approaches[-1] > deepest:
            approaches = np.append(approaches, max(_DEEPER * approaches[-1], deepest))
        for i, approach in enumerate(approaches.tolist()):
            found = self._try(approach)
            yield self.taps
            failed = 0 if found else failed + 1
            deep = i + 1 >= len(_INNER)
            self.cut = failed == _FAILURES
            if self.cut or (found and self._is_spent(self._samples[approach], deep)):
                return

    def _is_spent(self, sample: np.ndarray, deep: bool) -> bool:
        """Whether a tap needs more than the drive, and all deeper ones ever more."""
        virial, dissipation = np.sqrt(self.amplitude) * sample[:2]
        push = self._drive.components(self.amplitude, virial, dissipation)[0]
        if virial >= 0:
            return False
        too_much = push > _TOO_MUCH * self._drive.force
        return bool(too_much or (deep and self._excess(sample) > _SPENT))

    def _refine(self) -> Iterator[int]:
        """Halve intervals while their middles are not met by interpolation."""
        intervals = list(pairwise(self.approaches))
        while intervals and self.taps < _MOST_SAMPLES:
            missed = []
            for low, high, expected in self._find_doubtful(np.array(intervals)):
                middle = (low + high) / 2
                found = self.excess_at(middle)
                yield self.taps
                off = abs(found - expected)
                if off > self._allow(low, high, found) and high - low > 1e-3 * self._unit:
                    missed += [(low, middle), (middle, high)]
            intervals = missed

    def _find_doubtful(self, intervals: np.ndarray) -> list[tuple[float, float, float]]:
        """Intervals in whose middle two interpolations differ, and the excess expected there."""
        from scipy.interpolate import Akima1DInterpolator

        approaches, values = self._table(2)
        middles = intervals.mean(axis=1)
        other = Akima1DInterpolator(approaches, values, method="makima")
        doubtful = []
        for (low, high), one, two in zip(
            intervals.tolist(), self._interpolant(2)(middles), other(middles), strict=True
        ):
            expected = self._excess(one)
            off = abs(self._excess(two) - expected)
            if off > _DOUBT * self._allow(low, high, expected):
                doubtful.append((low, high, expected))
        return doubtful

    def _allow(self, low: float, high: float, excess: float) -> float:
        """By how much an excess between two samples may be missed.

        More is allowed where no solution is near, or in force what is little in height.
        """
        one, other = (self._excess(self._samples[end]) for end in (low, high))
        steep = _HEIGHT * self._unit / (high - low) * abs(other - one)
        return self._accuracy * max(1 + _AWAY * abs(excess), steep)

    def _excess(self, sample: np.ndarray) -> float:
        values = np.sqrt(self.amplitude) * sample[:2]
        return float(self._drive.excess(self.amplitude, *values))

    def _table(self, columns: int | None = None) -> tuple[list[float], np.ndarray]:
        approaches = self.approaches
        return approaches, np.array([self._samples[each][:columns] for each in approaches])

    def _interpolant(self, columns: int | None = None) -> Any:
        from scipy.interpolate import PchipInterpolator

        return PchipInterpolator(*self._table(columns), extrapolate=False)

    def _finish(self) -> None:
        self.nearest = self.approaches[0]
        self._pair, self._all = (
            (interpolant, interpolant.derivative()(self.nearest))
            for interpolant in (self._interpolant(2), self._interpolant())
        )
