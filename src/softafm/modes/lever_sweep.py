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
_SOONEST, _LATEST, _INSTANTS, _LAST = 1e-2, 1e3, 200, 20
"""Times, in Q, between which a drifting lever is looked at, how often, and at how many instants it
must stand still at the end."""
_MARGIN, _AMPLITUDES = 0.1, 600
"""How far the amplitude may go beyond an end of the range on the way, relative to it, and at how
many amplitudes taps are interpolated for that."""
_ERROR = 1e-4
"""Error of a drift, relative to the highest amplitude and in rad."""
_CLOSE = 2e-3
"""Distance from a solution, relative to its amplitude, at which the lever has arrived."""


class State(NamedTuple):
    """Where a lever is: amplitude, m, phase, degrees, and its ``solution`` by index, −1 for none.

    ``steady`` is whether it stays there, ``outside`` the end by which it left the range, or None.
    """

    amplitude: float = np.nan
    phase: float = np.nan
    solution: int = -1
    steady: bool = False
    outside: int | None = None

    @property
    def recorded(self) -> float:
        """Amplitude that is recorded, m: NaN of a lever that does not stay where it is."""
        return self.amplitude if self.steady else np.nan


def sweep_lever(curve: AmplitudeCurve, heights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What is recorded at mean heights, m, that fall, and then on the way back.

    Two arrays, (9, n), in the order of ``heights``: amplitude, phase and observables, NaN where
    they are not known. The lever comes from amplitudes above the range of the curve, and turns at
    the last height at which it is known.
    """
    sweep = LeverSweep(curve, heights)
    down = sweep.follow(range(heights.size), State(outside=HIGH))
    up, known = {}, [row for row, state in down.items() if state.steady]
    if known:
        up = sweep.follow(range(known[-1], -1, -1), down[known[-1]])
    return _record(curve, heights, down), _record(curve, heights, up)


def _record(curve: AmplitudeCurve, heights: np.ndarray, states: dict[int, State]) -> np.ndarray:
    """Amplitude, phase and observables of a lever at heights, m, (9, n); NaN where it is lost."""
    unknown = State()
    amplitude = np.array([states.get(row, unknown).recorded for row in range(heights.size)])
    values = curve.observables(amplitude, heights - amplitude)
    return np.vstack([amplitude, curve.drive.phase(amplitude, *values[:2]), values])


class LeverSweep:
    """Follows a lever from height to height, m, on the solutions of a curve."""

    def __init__(self, curve: AmplitudeCurve, heights: np.ndarray):
        self._curve, self._heights = curve, heights
        self.found = curve.at_heights(heights)
        ends = np.array([[curve.lowest], [curve.highest]])
        self._weak = curve.is_too_weak(ends, heights)
        cuts = np.searchsorted(self.found.row, np.arange(1, heights.size))
        self._rows = [rows.tolist() for rows in np.split(np.arange(self.found.row.size), cuts)]
        self._amplitude = self.found.amplitude.tolist()  # quicker one by one than from an array

    def at(self, solution: int) -> State:
        """State of a lever at a solution."""
        return State(self._amplitude[solution], float(self.found.phase[solution]), solution, True)

    def follow(self, way: Iterable[int], state: State) -> dict[int, State]:
        """States of the lever by row.

        Parameters
        ----------
        way
            Rows in the order in which they are passed.
        state
            That of the lever in the first row, or before it.
        """
        states: dict[int, State] = {}
        before = None
        for row in way:
            if state.outside is not None:
                state = self._enter(state.outside, before, row)
            elif before is not None:
                state = self._keep(state.solution, before, row) or self._drift(state, row)
            states[row], before = state, row
        return states

    def _enter(self, end: int, before: int | None, row: int) -> State:
        """State in a row of a lever that left the range by an end.

        It comes back with a stable solution that enters there.
        """
        here = self._rows[row]
        if here:
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
        if row is None or other is None or not self._rows[other]:
            return None
        nearest = self._nearest(solution, other)
        return nearest if self._nearest(nearest, row) == solution else None

    def _nearest(self, solution: int, row: int) -> int:
        """Index of the solution of a row whose amplitude is the nearest to that of another."""
        amplitude = self._amplitude
        return min(self._rows[row], key=lambda each: abs(amplitude[each] - amplitude[solution]))

    def _drift(self, state: State, row: int) -> State:
        """State at which a lever arrives if it is left alone at the height of a row."""
        amplitudes, phase = self._path(state, self._heights[row])
        low, high = self._curve.lowest, self._curve.highest
        beyond = (amplitudes < (1 - _MARGIN) * low) | (amplitudes > (1 + _MARGIN) * high)
        amplitude = float(amplitudes[beyond.argmax()] if beyond.any() else amplitudes[-1])
        if amplitude < low or amplitude > high:
            return State(outside=LOW if amplitude < low else HIGH)
        close = _CLOSE * amplitude
        for solution in self._rows[row]:
            if abs(self._amplitude[solution] - amplitude) < close and self.found.stable[solution]:
                return self.at(solution)
        return State(amplitude, phase, steady=bool(np.ptp(amplitudes[-_LAST:]) < close))

    def _path(self, state: State, height: float) -> tuple[np.ndarray, float]:
        """Amplitudes on the way of a drift, m, and the phase at its end."""
        from scipy.integrate import odeint

        curve, drive = self._curve, self._curve.drive
        low, high = (1 - 2 * _MARGIN) * curve.lowest, (1 + 2 * _MARGIN) * curve.highest
        amplitudes = np.linspace(low, high, _AMPLITUDES)
        in_phase, behind = drive.components(amplitudes, *curve.tapped(amplitudes, height))
        needed = in_phase + 1j * behind

        def rates(y: np.ndarray, time: float) -> tuple[float, float]:
            share, phase = y.tolist()
            amplitude = min(max(share * high, low), high)
            grows, turns = drive.drift(amplitude, phase, np.interp(amplitude, amplitudes, needed))
            return grows / high, turns

        start = state.amplitude / high, np.radians(state.phase)
        instants = drive.quality_factor * np.geomspace(_SOONEST, _LATEST, _INSTANTS)
        instants[0] = 0.0
        path = odeint(rates, start, instants, rtol=_ERROR, atol=_ERROR, mxstep=100_000)
        return path[:, 0] * high, float(np.degrees(path[-1, 1]))
