"""Observables of taps over amplitude and closest approach, from few taps.

A tap is determined by its amplitude A and by d = Z − A, the height of its lowest point. Along d the
observables change steeply, along A slowly, nearly as √A. So they are sampled on a few lines of
constant A, along d as densely as needed (``tap_line``), and interpolated in between lines by a
polynomial in ln A.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from softafm.instrument.oscillator import Drive
from softafm.modes.tap_line import Tap, TapLine
from softafm.results.content import TAPPED

OBSERVABLES = TAPPED
_LINES = 5
_FARTHEST = 500.0
"""Units up to which the far end is sought."""
_DEEPEST, _CUT = 4500.0, 10.0
"""Units down to which solutions are sought, and from which taps of one amplitude that fail are not
tried with another."""
_FREE = 0.1
"""Part of the free excess that a tap may be off at the far end."""
_PARTS = 12
"""Points between neighbouring taps at which solutions are sought."""


class TapMap:
    """Interpolates observables of taps of ``lowest`` to ``highest`` amplitude, m.

    Parameters
    ----------
    tap, drive, unit, accuracy
        As for ``TapLine``.
    """

    def __init__(
        self, tap: Tap, drive: Drive, lowest: float, highest: float, unit: float, accuracy: float
    ):
        self._drive = drive
        self.lowest, self.highest, self.unit = lowest, highest, unit
        lines = _LINES if highest > 1.01 * lowest else 1
        nodes = np.cos(np.pi * (np.arange(lines) + 0.5) / lines)[::-1]
        nodes = nodes / nodes[-1] if lines > 1 else np.zeros(1)
        middle, half = np.log(highest * lowest) / 2, np.log(highest / lowest) / 2
        self._logs = middle + half * nodes
        amplitudes = np.exp(self._logs).tolist()
        self.lines = [TapLine(tap, drive, each, unit, accuracy) for each in amplitudes]

    @property
    def taps(self) -> int:
        """Number of taps so far."""
        return sum(line.taps for line in self.lines)

    def explore(self) -> Iterator[int]:
        """Sample all lines, yielding the number of taps so far after each.

        Raises ``DivergedError`` if no tap of a line has a result.
        """
        self.farthest = self._find_far_end()
        deepest = -_DEEPEST * self.unit
        for line in self.lines:
            for _ in line.explore(self.farthest, deepest):
                yield self.taps
            if line.cut and line.nearest < -_CUT * self.unit:
                deepest = max(deepest, line.nearest)

    def virial_and_dissipation(self, amplitude: ArrayLike, approach: ArrayLike) -> np.ndarray:
        """V and E, J, at amplitudes and closest approaches, m: shape (2, *broadcast)."""
        return self._combine(amplitude, approach, pair=True)

    def observables(self, amplitude: ArrayLike, approach: ArrayLike) -> np.ndarray:
        """All ``OBSERVABLES`` at amplitudes and closest approaches, m: shape (7, *broadcast)."""
        return self._combine(amplitude, approach, pair=False)

    def nearest_at(self, amplitude: ArrayLike) -> np.ndarray:
        """Closest approach, m, down to which amplitudes, m, were sampled on lines next to them."""
        ends = np.array([line.nearest for line in self.lines])
        return ends[self._lines_about(amplitude)].min(axis=0)

    def find_support(self, amplitude: float, approach: float) -> list[tuple[float, float]]:
        """Amplitudes and closest approaches of the taps next to a point, m."""
        lines = {int(i) for i in self._lines_about(amplitude)}
        return [
            (self.lines[i].amplitude, each)
            for i in lines
            for each in self.lines[i].find_support(approach)
        ]

    def _lines_about(self, amplitude: ArrayLike) -> np.ndarray:
        """Indices of the lines below and above amplitudes, shape (2, *shape)."""
        above = np.searchsorted(self._logs, np.log(amplitude))
        return np.clip([above - 1, above], 0, self._logs.size - 1)

    @property
    def grid(self) -> np.ndarray:
        """Closest approaches, m, dense where taps are, from far to near."""
        every = np.unique([each for line in self.lines for each in line.approaches])
        steps = np.arange(_PARTS) / _PARTS
        between = (every[:-1, None] + steps * np.diff(every)[:, None]).ravel()
        return np.append(between, every[-1])[::-1]

    def find_slopes(self, amplitude: float, approach: float) -> tuple[float, np.ndarray]:
        """Slopes along d of the excess, 1/m, and of the observables, per m, (7,).

        Beyond the farthest taps there is nothing: there they are taken from nearer ones.
        """
        step = 1e-2 * self.unit
        far, near = (self.observables(amplitude, approach + each) for each in (step, -step))
        if not np.isfinite(far).all():
            far, near = (self.observables(amplitude, approach + each) for each in (0.0, -2 * step))
        outer, inner = (float(self._drive.excess(amplitude, *each[:2])) for each in (far, near))
        return (outer - inner) / (2 * step), (far - near) / (2 * step)

    def _combine(self, amplitude: ArrayLike, approach: ArrayLike, pair: bool) -> np.ndarray:
        """Lagrange's polynomial in ln A through the lines, times √A."""
        amplitude, approach = np.broadcast_arrays(amplitude, approach)
        log, total = np.log(amplitude), np.zeros(1)
        for i, line in enumerate(self.lines):
            weight = np.sqrt(amplitude)
            for other in np.delete(self._logs, i):
                weight = weight * (log - other) / (self._logs[i] - other)
            total = total + weight[..., None] * line.interpolate(approach, pair)
        return np.moveaxis(total, -1, 0)

    def _find_far_end(self) -> float:
        """Approach at which the largest amplitude hardly feels the surface."""
        top = self.lines[-1]
        free = float(self._drive.excess(top.amplitude, 0.0, 0.0))
        approach = 4 * self.unit
        while approach < _FARTHEST * self.unit:
            if abs(top.excess_at(approach) - free) < _FREE * abs(free):
                break
            approach *= 2
        return approach
