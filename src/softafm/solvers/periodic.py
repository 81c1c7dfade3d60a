"""The memory with which a cycle ends as it began.

Over one cycle the memory y_m fades by e^(−T/τ_m) and gains what the cycle loads, Δ_m. If every
cycle loaded it alike, it would settle at

    Φ_m(y) = Δ_m / (1 − e^(−T/τ_m)).

The periodic memory is the fixed point y = Φ(y): one cycle finds it where the contact hardly feels
its own memory, however slow the creep, and Anderson's mixing of a few past cycles finds it where it
does (Walker and Ni 2011, SIAM Journal on Numerical Analysis 49, 1715).
"""

import numpy as np

_DEPTH = 4
_FAR, _PACE = 3.0, 0.3
_SLOW, _STALLS, _TIGHT = 0.7, 2, 0.1
"""Part of the least miss that counts as progress, cycles without it, and part of the miss
within which starts enclose the periodic memory as well as they can."""


class PeriodicMemory:
    """Seeks the periodic memory from what cycles make of trial ones.

    Parameters
    ----------
    period
        Of the motion, s.
    compliances, retardation_times
        J_m, 1/Pa, and τ_m, s, shape (elements,).
    unit
        Length over which contacts change, m. A start that is off by more than three is moved only
        part of the way, and not mixed: far off, a cycle tells little of the periodic memory.
    """

    def __init__(
        self, period: float, compliances: np.ndarray, retardation_times: np.ndarray, unit: float
    ):
        self._unit, self._pace, self._last = unit, _PACE, np.inf
        self._node: int | None = None
        self._low, self._high = -np.inf, np.inf
        self._stalls, self._least = 0, np.inf
        self._gaining = -np.expm1(-period / np.asarray(retardation_times))[:, None]
        self._compliances = np.asarray(compliances)[:, None]
        self._trials: list[np.ndarray] = []
        self._misses: list[np.ndarray] = []

    def next_start(self, start: np.ndarray, gained: np.ndarray) -> tuple[np.ndarray, float]:
        """Return the memory to start the next cycle with, and how far the last start was off, m.

        ``start`` is y_m at the start of a cycle, ``gained`` its Δ_m, shape (elements, nodes), in
        Pa·m. The distance is that of the displacement Σ J_m y_m, largest over the nodes.
        """
        miss = gained / self._gaining - start
        shape = self._displace(miss)
        off = float(np.abs(shape).max(initial=0.0))
        if self._node is None:
            self._node = int(np.abs(shape).argmax())
            self._sign = float(np.sign(shape[self._node]))
        self._enclose(start, start + miss)
        self._stalls = 0 if off < _SLOW * self._least else self._stalls + 1
        self._least = min(self._least, off)
        enclosed = np.isfinite(self._high - self._low)
        if enclosed and self._stalls >= _STALLS:
            return self._halve(start, miss, off), off
        if off > _FAR * self._unit:
            self._trials.clear()
            self._misses.clear()
            self._pace = min(1.1 * self._pace, _PACE) if off < self._last else 0.5 * self._pace
            self._last = off
            return start + self._pace * miss, off
        self._trials.append(start)
        self._misses.append(miss)
        del self._trials[: -_DEPTH - 1], self._misses[: -_DEPTH - 1]
        return self._mix(), off

    def _displace(self, memory: np.ndarray) -> np.ndarray:
        return np.asarray(np.sum(self._compliances * memory, axis=0))

    def _size(self, memory: np.ndarray) -> float:
        """Displacement, m, where the first cycle moved the surface most, and that way."""
        return self._sign * float(self._displace(memory)[self._node])

    def _enclose(self, start: np.ndarray, loaded: np.ndarray) -> None:
        """Keep the largest start that loads more than itself, and the smallest that loads less."""
        size = self._size(start)
        if self._size(loaded) > size:
            self._low, self._load = size, loaded
            self._high = self._high if self._high > size else np.inf
        else:
            self._high = size
            self._low = self._low if self._low < size else -np.inf

    def _halve(self, start: np.ndarray, miss: np.ndarray, off: float) -> np.ndarray:
        """Go half the way between starts that load too much and too little.

        Where these are the same, what is left is of another shape: mix, and enclose anew.
        """
        self._trials = [*self._trials, start][-_DEPTH:]
        self._misses = [*self._misses, miss][-_DEPTH:]
        if self._high - self._low < _TIGHT * off:
            self._low, self._high = -np.inf, np.inf
            step = self._mix() - start
            longest = float(np.abs(self._displace(step)).max())
            return start + min(1.0, _PACE * off / longest) * step
        return self._load * ((self._low + self._high) / 2 / self._size(self._load))

    def _mix(self) -> np.ndarray:
        """Move from where the recent misses, seen as linear, would combine to the least."""
        trial, miss = self._trials[-1], self._misses[-1]
        steps = [b - a for a, b in zip(self._trials[:-1], self._trials[1:], strict=True)]
        changes = [b - a for a, b in zip(self._misses[:-1], self._misses[1:], strict=True)]
        if not steps:
            return trial + miss
        columns = np.stack([(self._compliances * change).ravel() for change in changes], axis=1)
        wanted = (self._compliances * miss).ravel()
        shares = np.linalg.lstsq(columns, wanted, rcond=1e-6)[0]
        mixed = trial + miss
        for share, step, change in zip(shares, steps, changes, strict=True):
            mixed = mixed - share * (step + change)
        return mixed
