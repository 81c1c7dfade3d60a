"""What a driven lever does while its base comes down slowly, and goes up again.

It keeps to a solution while that attracts. Where the solution ends, amplitude and phase drift
(``Drive.drift``) until another one attracts them, or the amplitude leaves the range that is known.
From there nothing is known of the lever until a solution enters the range at the same end.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from softafm.modes.amplitude_curve import AmplitudeCurve

LOW, HIGH = 0, 1
"""Ends of the range of amplitudes."""
_DURATION, _INSTANTS = 100, 200
"""For how many times Q a lever may drift, and how often it is looked at."""
_MARGIN, _AMPLITUDES = 0.1, 600
"""How far the amplitude may go beyond an end of the range on the way, relative to it, and at how
many amplitudes taps are interpolated for that."""
_CLOSE = 2e-3
"""Distance from a solution, relative to its amplitude, at which the lever has arrived."""


class State(NamedTuple):
    """Where a lever is: its ``solution`` by index, or, between solutions, −1.

    ``outside`` is the end by which it left the range, or None.
    """

    amplitude: float = np.nan
    phase: float = np.nan
    solution: int = -1
    outside: int | None = None


def sweep_lever(curve: AmplitudeCurve, heights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What is recorded at mean heights, m, that fall, and then on the way back.

    Two arrays, (9, n), in the order of ``heights``: amplitude, phase and observables, NaN where
    they are not known. The lever comes from amplitudes above the range of the curve, and turns at
    the last height at which it is known.
    """
    sweep = LeverSweep(curve, heights)
    down = sweep.follow(range(heights.size), State(outside=HIGH))
    up, known = np.full(heights.size, -1), np.flatnonzero(down >= 0)
    if known.size:
        up = sweep.follow(range(known[-1], -1, -1), sweep.at(down[known[-1]]))
    found = sweep.found
    columns = np.vstack([found.amplitude, found.phase, curve.observables(found)])
    columns = np.hstack([columns, np.full((len(columns), 1), np.nan)])  # for the index −1
    return columns[:, down], columns[:, up]


class LeverSweep:
    """Follows a lever from height to height, m, on the solutions of a curve."""

    def __init__(self, curve: AmplitudeCurve, heights: np.ndarray):
        self._curve, self._heights = curve, heights
        self.found = curve.at_heights(heights)
        ends = np.array([[curve.lowest], [curve.highest]])
        self._weak = curve.is_too_weak(ends, heights)
        cuts = np.searchsorted(self.found.row, np.arange(1, heights.size))
        self._rows = np.split(np.arange(self.found.row.size), cuts)

    def at(self, solution: int) -> State:
        """State of a lever at a solution."""
        return State(self.found.amplitude[solution], self.found.phase[solution], int(solution))

    def follow(self, way: Iterable[int], state: State) -> np.ndarray:
        """Index of the solution taken in each row, −1 where none is known or the way does not go.

        Parameters
        ----------
        way
            Rows in the order in which they are passed.
        state
            That of the lever in the first row, or before it.
        """
        taken = np.full(self._heights.size, -1)
        before = None
        for row in way:
            if state.outside is not None:
                state = self._enter(state.outside, before, row)
            elif state.solution not in self._rows[row]:
                state = self._keep(state.solution, before, row) or self._drift(state, row)
            taken[row], before = state.solution, row
        return taken

    def _enter(self, end: int, before: int | None, row: int) -> State:
        """State in a row of a lever that left the range by an end.

        It comes back with a stable solution that enters there.
        """
        here = self._rows[row]
        if here.size:
            entered = here[-1] if end == HIGH else here[0]
            inside = self._weak[end, row] == (end == HIGH)
            if inside and self.found.stable[entered] and self._pair(entered, row, before) is None:
                return self.at(entered)
        return State(outside=end)

    def _keep(self, solution: int, before: int | None, row: int) -> State | None:
        """State in a row of a lever that keeps to its solution, or None if that has ended."""
        kept = None if solution < 0 else self._pair(solution, before, row)
        return None if kept is None or not self.found.stable[kept] else self.at(kept)

    def _pair(self, solution: int, row: int | None, other: int | None) -> int | None:
        """Index in another row of the solution that is one with that of a row, if there is one.

        Those of neighbouring heights are one if they are the nearest to each other.
        """
        if row is None or other is None or not self._rows[other].size:
            return None
        nearest = self._nearest(solution, other)
        return nearest if self._nearest(nearest, row) == solution else None

    def _nearest(self, solution: int, row: int) -> int:
        """Index of the solution of a row whose amplitude is the nearest to that of another."""
        there, amplitude = self._rows[row], self.found.amplitude
        return int(there[np.argmin(np.abs(amplitude[there] - amplitude[solution]))])

    def _drift(self, state: State, row: int) -> State:
        """State at which a lever arrives if it is left alone at the height of a row."""
        amplitude, phase, gone = self._drift_to(state, self._heights[row])
        if gone is not None:
            return State(outside=gone)
        here = self._rows[row][self.found.stable[self._rows[row]]]
        if here.size:
            off = np.abs(self.found.amplitude[here] - amplitude)
            if off.min() < _CLOSE * amplitude:
                return self.at(here[off.argmin()])
        if amplitude < self._curve.lowest or amplitude > self._curve.highest:
            return State(outside=LOW if amplitude < self._curve.lowest else HIGH)
        return State(amplitude, phase)

    def _drift_to(self, state: State, height: float) -> tuple[float, float, int | None]:
        """Amplitude and phase at the end of a drift, and the end by which it left what is known."""
        from scipy.integrate import odeint

        curve, drive = self._curve, self._curve.drive
        low, high = (1 - _MARGIN) * curve.lowest, (1 + _MARGIN) * curve.highest
        amplitudes = np.linspace(low, high, _AMPLITUDES)
        in_phase, behind = drive.components(amplitudes, *curve.tapped(amplitudes, height))
        needed = in_phase + 1j * behind

        def rates(y: np.ndarray, time: float) -> tuple[float, float]:
            share, phase = y.tolist()
            amplitude = min(max(share * high, low), high)
            grows, turns = drive.drift(amplitude, phase, np.interp(amplitude, amplitudes, needed))
            return grows / high, turns

        start = state.amplitude / high, np.radians(state.phase)
        instants = np.linspace(0, _DURATION * drive.quality_factor, _INSTANTS)
        path = odeint(rates, start, instants, mxstep=100_000)
        outside = np.flatnonzero((path[:, 0] * high < low) | (path[:, 0] > 1))
        gone = None if not outside.size else HIGH if path[outside[0], 0] > 1 else LOW
        return path[-1, 0] * high, np.degrees(path[-1, 1]), gone
