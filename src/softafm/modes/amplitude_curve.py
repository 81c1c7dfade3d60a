"""All pairs of amplitude and height that a driven lever can have, and those that it takes."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from softafm.instrument.oscillator import Drive
from softafm.modes.tap_map import TapMap
from softafm.results.content import BRANCHES

_AMPLITUDES = 400


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
        self._taps, self.drive = taps, drive

    def at_amplitudes(
        self, amplitudes: np.ndarray, corrections: Sequence[tuple[int, float, float]] = ()
    ) -> Solutions:
        """All solutions of given amplitudes, m, shape (n,).

        Parameters
        ----------
        corrections
            Row, closest approach, m, and what is missing in the excess there, and less and less up
            to a unit away.
        """

        def excess(row: np.ndarray, approach: np.ndarray) -> np.ndarray:
            row = np.asarray(row, int)
            values = self.excess(amplitudes[row], approach)
            for where, place, missing in corrections:
                share = np.maximum(0.0, 1 - np.abs(approach - place) / self._taps.unit)
                values = values + missing * share * (row == where)
            return values

        row, approach = _find_zeros(excess, np.arange(amplitudes.size), self._taps.grid)
        step = 1e-3 * np.minimum(amplitudes[row], self._taps.unit)
        return self._solutions(row, amplitudes[row], approach, step)

    def find_grazing(self, amplitudes: np.ndarray, excess: float) -> list[tuple[int, float]]:
        """Rows of amplitudes, m, and closest approaches, m, where two solutions may nearly meet.

        There the excess has an extremum along the approach of less than ``excess``.
        """
        grid = self._taps.grid
        values = self.excess(amplitudes[:, None], grid[None, :])
        before, here, after = values[:, :-2], values[:, 1:-1], values[:, 2:]
        turns = (here - before) * (after - here) < 0
        row, column = np.nonzero(turns & (np.abs(here) < excess))
        return list(zip(row.tolist(), grid[column + 1].tolist(), strict=True))

    def at_heights(self, heights: np.ndarray) -> Solutions:
        """All solutions at given mean heights, m, shape (n,), within the amplitudes of the map."""
        amplitudes = np.linspace(self.lowest, self.highest, _AMPLITUDES)
        row, amplitude = _find_zeros(lambda z, a: self.excess(a, z - a), heights, amplitudes)
        # Across the interval in which they were found: finer ripples of the map do not count.
        step = (amplitudes[1] - amplitudes[0]) / 2
        return self._solutions(row, amplitude, heights[row] - amplitude, step)

    def observables(self, amplitude: ArrayLike, approach: ArrayLike) -> np.ndarray:
        """Observables at amplitudes and closest approaches, m, shape (7, n)."""
        return self._taps.observables(amplitude, approach)

    @property
    def lowest(self) -> float:
        """Lowest amplitude at which solutions are sought, m: a little below that of the map."""
        return self._taps.lowest - self._span

    @property
    def highest(self) -> float:
        """Highest amplitude at which solutions are sought, m: a little above that of the map."""
        return self._taps.highest + self._span

    @property
    def _span(self) -> float:
        return 1e-3 * (self._taps.highest - self._taps.lowest)

    def tapped(self, amplitude: ArrayLike, height: ArrayLike) -> np.ndarray:
        """V and E, J, at amplitudes and mean heights, m: shape (2, *broadcast).

        Beyond the closest approaches of the map they are those at its ends.
        """
        approach = np.subtract(height, amplitude)
        within = np.clip(approach, self._taps.nearest_at(amplitude), self._taps.farthest)
        return self._taps.virial_and_dissipation(amplitude, within)

    def is_too_weak(self, amplitude: np.ndarray, height: np.ndarray) -> np.ndarray:
        """Whether the drive cannot hold amplitudes at mean heights, m."""
        return self.drive.excess(amplitude, *self.tapped(amplitude, height)) > 0

    def excess(self, amplitude: ArrayLike, approach: ArrayLike) -> np.ndarray:
        """Excess of the force needed; NaN where no taps were run."""
        values = self._taps.virial_and_dissipation(amplitude, approach)
        deeper = np.less(approach, self._taps.nearest_at(amplitude))
        return np.where(deeper, np.nan, self.drive.excess(amplitude, *values))

    def _solutions(
        self, row: np.ndarray, amplitude: np.ndarray, approach: np.ndarray, step: Any
    ) -> Solutions:
        """Phase and stability; the slopes are those at fixed height, where d falls as A rises."""
        more, less = (
            self._taps.virial_and_dissipation(amplitude + s, approach - s) for s in (step, -step)
        )
        values = self._taps.virial_and_dissipation(amplitude, approach)
        stable = self.drive.stable(amplitude, *values, *(more - less) / (2 * step))
        return Solutions(row, amplitude, approach, self.drive.phase(amplitude, *values), stable)


def _find_zeros(
    function: Callable[[Any, Any], Any], rows: np.ndarray, points: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Zeros of function(row, point) between neighbours of ``points``, for every row at once.

    Returns the indices of the rows and the zeros, to 1e-9 of the mean distance of neighbours;
    values of NaN have none.
    """
    from scipy.optimize.elementwise import find_root

    values = function(rows[:, None], points[None, :])
    row, column = np.nonzero(values[:, :-1] * values[:, 1:] < 0)
    bracket = points[column], points[column + 1]
    close = {"xatol": 1e-9 * np.abs(np.diff(points)).mean(), "xrtol": 0.0}
    found = find_root(lambda x, y: function(y, x), bracket, args=(rows[row],), tolerances=close)
    return row, found.x
