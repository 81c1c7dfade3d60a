"""The memory with which a cycle ends as it began.

Over one cycle the memory y_m fades by e^(−T/τ_m) and gains what the cycle loads, Δ_m. If every
cycle loaded it alike, it would settle at

    Φ_m(y) = Δ_m / (1 − e^(−T/τ_m)).

The periodic memory is the fixed point y = Φ(y): one cycle finds it where the contact hardly feels
its own memory, however slow the creep, and Anderson's mixing of a few past cycles finds it where it
does (Walker and Ni 2011, SIAM Journal on Numerical Analysis 49, 1715).
"""

from itertools import pairwise

import numpy as np

_DEPTH = 4
_FAR, _PACE = 3.0, 0.3


class Mixing:
    """Anderson's: seeks the trial that misses nothing from the latest ones, as if all were linear.

    ``weights`` count the elements of misses, (elements, 1).
    """

    def __init__(self, weights: np.ndarray):
        self._weights = weights
        self._trials: list[np.ndarray] = []
        self._misses: list[np.ndarray] = []

    def forget(self) -> None:
        """Begin anew."""
        self._trials.clear()
        self._misses.clear()

    def next_trial(self, trial: np.ndarray, miss: np.ndarray) -> np.ndarray:
        """Note what a trial missed; return the next one.

        It moves from where the recent misses would combine to the least.
        """
        self._trials.append(trial)
        self._misses.append(miss)
        del self._trials[: -_DEPTH - 1], self._misses[: -_DEPTH - 1]
        steps = [b - a for a, b in pairwise(self._trials)]
        changes = [b - a for a, b in pairwise(self._misses)]
        if not steps:
            return trial + miss
        columns = np.stack([(self._weights * change).ravel() for change in changes], axis=1)
        shares = np.linalg.lstsq(columns, (self._weights * miss).ravel(), rcond=1e-6)[0]
        mixed = trial + miss
        for share, step, change in zip(shares, steps, changes, strict=True):
            mixed = mixed - share * (step + change)
        return mixed


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
        self._gaining = -np.expm1(-period / np.asarray(retardation_times))[:, None]
        self._compliances = np.asarray(compliances)[:, None]
        self._mixing = Mixing(self._compliances)

    def next_start(self, start: np.ndarray, gained: np.ndarray) -> tuple[np.ndarray, float]:
        """Return the memory to start the next cycle with, and how far the last start was off, m.

        ``start`` is y_m at the start of a cycle, ``gained`` its Δ_m, shape (elements, nodes), in
        Pa·m. The distance is that of the displacement Σ J_m y_m, largest over the nodes.
        """
        miss = gained / self._gaining - start
        off = float(np.abs(np.sum(self._compliances * miss, axis=0)).max(initial=0.0))
        if off > _FAR * self._unit:
            self._mixing.forget()
            self._pace = min(1.1 * self._pace, _PACE) if off < self._last else 0.5 * self._pace
            self._last = off
            return start + self._pace * miss, off
        return self._mixing.next_trial(start, miss), off
