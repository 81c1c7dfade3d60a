"""When cycles of the energy solver count as steady, and when they never will be."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from softafm.solvers.energy.tuning import STAGNANT, STEADY, SURELY_STEADY

_FEWEST = 4
"""Cycles that tell by how much observables scatter."""


_LOSS, _LEAST_VIRIAL, _LEAST_LOSS = 4, 4e-4, 1e-6
"""Where the loss is among observables; energies that count, in largest forces times amplitudes."""


class _Sums(NamedTuple):
    """Observables of a cycle, (5,), the fifth its loss, and the least that each is counted by."""

    values: np.ndarray
    least: np.ndarray


class Steadiness:
    """Watches cycles: by how much each misses its own start, and whether observables change.

    ``allowed`` is how far off a start may be, in gaps of the contact edge: how well a memory can be
    found is limited by the errors of a cycle.
    """

    def __init__(self, strictness: float):
        self.allowed = STEADY * strictness**0.5
        self._surely = SURELY_STEADY * strictness
        self._change_allowed = 1e-3 * strictness
        self._misses: list[float] = []
        self._sums: list[_Sums] = []

    def note(self, records: np.ndarray, miss: float) -> None:
        """Note a cycle by its records and by how far off it began, in gaps."""
        self._misses.append(miss)
        self._sums.append(_sum_up(records))

    @property
    def reached(self) -> bool:
        """Whether the last cycle is steady."""
        last = self._misses[-3:]
        if last[-1] > self.allowed:
            return False
        # What still changes after such cycles, but for good, are their errors.
        errors = len(last) == 3 and max(last) <= self.allowed and last[-1] > 0.5 * last[0]
        errors = errors and not last[0] > last[1] > last[2]
        alone = len(self._misses) == 1 or last[-1] == 0  # nothing is remembered
        return errors or (last[-1] < self._surely if alone else self._stays())

    @property
    def stagnates(self) -> bool:
        """Whether misses are small and fall no more: what is left are errors of a cycle."""
        if len(self._misses) < 2 * STAGNANT or self._misses[-1] > 1:
            return False
        before, recent = self._misses[-2 * STAGNANT : -STAGNANT], self._misses[-STAGNANT:]
        return min(recent) > 0.5 * min(before)

    @property
    def scatter(self) -> float:
        """How far off cycles are that do not settle, in gaps, even if one is near by chance; or 0.

        The misses of cycles that settle fall, once they are small, but for one or two.
        """
        small = self._misses[self._first_small :]
        rises = sum(later > earlier for earlier, later in pairwise(small))
        return float(np.median(small[-STAGNANT:])) if rises > 2 else 0.0

    @property
    def spread(self) -> float:
        """By how much observables differ between the last cycles that begin nearly alike.

        Relative to themselves; infinite of too few cycles to tell.
        """
        last = self._sums[self._first_small :][-STAGNANT:]
        if len(last) < _FEWEST:
            return np.inf
        values = np.array([each.values for each in last])
        return float((np.ptp(values, axis=0) / np.fmax(np.abs(values[-1]), last[-1].least)).max())

    @property
    def _first_small(self) -> int:
        return next((i for i, miss in enumerate(self._misses) if miss < 1), len(self._misses))

    def _stays(self) -> bool:
        """Whether observables are within a tenth of the tolerance of what a steady cycle has.

        They are as far off as the last start, by how they have answered to other starts.
        """
        (now, least), pairs = self._sums[-1], list(pairwise(self._sums))[-3:]
        changes = [np.abs(after.values - before.values) for before, after in pairs]
        misses = np.fmax(self._misses[:-1], 1e-12)[-3:]
        answers = [change / miss for change, miss in zip(changes, misses, strict=True)]
        off = np.max(answers, axis=0) * self._misses[-1]
        off[_LOSS] = changes[-1][_LOSS]  # which depends on the lag that the cycle before has left
        return bool((off <= self._change_allowed * np.fmax(np.abs(now), least)).all())


def _sum_up(records: np.ndarray) -> _Sums:
    """Return largest, smallest and mean force, virial and loss of a cycle."""
    force, time, height = records["force"], records["time"], records["height"]
    shares = np.diff(time, prepend=time[0]) + np.diff(time, append=time[-1])
    shares /= shares.sum()
    swing = height - (height.max() + height.min()) / 2
    lost = records["lost"].sum() + records["jump"].sum()
    values = [force.max(), force.min(), shares @ force, shares @ (force * swing), lost]
    largest = np.abs(force).max()
    work = largest * swing.max()
    least = [*(3 * [0.01 * largest]), _LEAST_VIRIAL * work, _LEAST_LOSS * work]
    return _Sums(np.array(values), np.array(least))
