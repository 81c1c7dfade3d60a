"""All pairs of amplitude and height that a driven lever can have, and those that it takes."""

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np

from softafm.instrument.oscillator import Drive
from softafm.modes.tap_map import TapMap
from softafm.results.content import BRANCHES

_APPROACHES, _AMPLITUDES = 2000, 400


class Solutions(NamedTuple):
    """Amplitudes and closest approaches, m, that go together, by the ``row`` they were asked for.

    Arrays of one length, from far to near in every row; ``phase`` in degrees.
    """

    row: np.ndarray
    amplitude: np.ndarray
    approach: np.ndarray
    phase: np.ndarray
    stable: np.ndarray

    @property
    def branch(self) -> list[str]:
        """Branch of each. Of two stable ones in a row the farther is attractive, the nearer
        repulsive; one alone by its phase, over or below 90°."""
        attractive, unstable, repulsive = BRANCHES
        names = np.where(self.phase > 90, attractive, repulsive)
        for row in np.unique(self.row):
            stable = np.flatnonzero((self.row == row) & self.stable)
            if stable.size > 1:
                names[stable[0]], names[stable[-1]] = attractive, repulsive
        return np.where(self.stable, names, unstable).tolist()


class AmplitudeCurve:
    """The solutions of the amplitude equation over a map of taps.

    Parameters
    ----------
    taps
        A ``TapMap`` that has been explored.
    drive
        The ``softafm.instrument.oscillator.Drive`` of the lever.
    """

    def __init__(self, taps: TapMap, drive: Drive):
        self._taps, self._drive = taps, drive

    def at_amplitudes(self, amplitudes: np.ndarray) -> Solutions:
        """All solutions of given amplitudes, m, shape (n,)."""
        approaches = np.linspace(self._taps.farthest, self._taps.nearest, _APPROACHES)
        row, approach = _find_zeros(lambda a, d: self._excess(a, d), amplitudes, approaches)
        return self._solutions(row, amplitudes[row], approach)

    def at_heights(self, heights: np.ndarray) -> Solutions:
        """All solutions at given mean heights, m, shape (n,), within the amplitudes of the map."""
        span = 1e-3 * (self._taps.highest - self._taps.lowest)
        amplitudes = np.linspace(self._taps.lowest - span, self._taps.highest + span, _AMPLITUDES)
        row, amplitude = _find_zeros(lambda z, a: self._excess(a, z - a), heights, amplitudes)
        return self._solutions(row, amplitude, heights[row] - amplitude)

    def observables(self, solutions: Solutions) -> np.ndarray:
        """Observables of solutions, shape (7, n)."""
        return self._taps.observables(solutions.amplitude, solutions.approach)

    def swept(self, heights: np.ndarray) -> tuple[np.ndarray, ...]:
        """What is recorded at heights, m, passed one after the other, and then all the way back.

        Two arrays: amplitude, phase and observables, (9, n) in the order of ``heights``. The lever
        keeps to its branch while that attracts, and then jumps to the nearest amplitude that does.
        NaN where there is none.
        """
        found = self.at_heights(heights)
        columns = np.vstack([found.amplitude, found.phase, self.observables(found)])
        there = range(heights.size)
        return tuple(_follow(columns, found, way) for way in (there, reversed(there)))

    def _excess(self, amplitude: np.ndarray, approach: np.ndarray) -> np.ndarray:
        values = self._taps.virial_and_dissipation(amplitude, approach)
        return self._drive.excess(amplitude, *values)

    def _solutions(self, row: np.ndarray, amplitude: np.ndarray, approach: np.ndarray) -> Solutions:
        """Phase and stability; the slopes are those at fixed height, where d falls as A rises."""
        step = 1e-3 * np.minimum(amplitude, self._taps.unit)
        more, less = (
            self._taps.virial_and_dissipation(amplitude + s, approach - s) for s in (step, -step)
        )
        values = self._taps.virial_and_dissipation(amplitude, approach)
        stable = self._drive.stable(amplitude, *values, *(more - less) / (2 * step))
        return Solutions(row, amplitude, approach, self._drive.phase(amplitude, *values), stable)


def _follow(columns: np.ndarray, found: Solutions, way: Iterable[int]) -> np.ndarray:
    """Return the column of ``columns`` (m, solutions) that a lever takes in each row of ``found``.

    ``way`` is the order in which the rows, all of them, are passed.
    """
    values = np.full((len(columns), len(rows := list(way))), np.nan)
    last = None
    for row in rows:
        choices = np.flatnonzero((found.row == row) & found.stable)
        if choices.size:
            wanted = found.amplitude[choices].max() if last is None else last
            nearest = choices[np.argmin(np.abs(found.amplitude[choices] - wanted))]
            last, values[:, row] = found.amplitude[nearest], columns[:, nearest]
    return values


def _find_zeros(
    function: Callable[[Any, Any], Any], rows: np.ndarray, points: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Zeros of function(row, point) between neighbours of ``points``, for every row at once.

    Returns the indices of the rows and the zeros, to 1e-9 of the distance of neighbours; values of
    NaN have none.
    """
    from scipy.optimize.elementwise import find_root

    values = function(rows[:, None], points[None, :])
    row, column = np.nonzero(values[:, :-1] * values[:, 1:] < 0)
    bracket = points[column], points[column + 1]
    close = {"xatol": 1e-9 * np.abs(np.diff(points)).max(), "xrtol": 0.0}
    found = find_root(lambda x, y: function(y, x), bracket, args=(rows[row],), tolerances=close)
    return row, found.x
