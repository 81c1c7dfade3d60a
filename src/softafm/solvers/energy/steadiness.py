"""When cycles of the energy solver count as steady, and when they never will be."""

from itertools import pairwise

import numpy as np

from softafm.solvers.energy.tuning import STAGNANT, STEADY, SURELY_STEADY


class Steadiness:
    """Watches cycles: by how much each misses its own start, and whether its forces change.

    ``allowed`` is how far off a start may be, in gaps of the contact edge: how well a memory can be
    found is limited by the errors of a cycle.
    """

    def __init__(self, strictness: float):
        self.allowed = STEADY * strictness**0.5
        self._change_allowed = 5e-3 * strictness
        self._misses: list[float] = []
        self._forces = self._before = np.full(3, np.nan)

    def note(self, records: np.ndarray, miss: float) -> None:
        """Note a cycle by its records and by how far off it began, in gaps."""
        self._misses.append(miss)
        self._before, self._forces = self._forces, _sum_up(records)

    @property
    def reached(self) -> bool:
        """Whether the last cycle is steady."""
        last = self._misses[-3:]
        if last[-1] > self.allowed:
            return False
        # What still changes after such cycles, but for good, are their errors.
        errors = len(last) == 3 and max(last) <= self.allowed and last[-1] > 0.5 * last[0]
        return last[-1] < SURELY_STEADY or self._forces_stay() or errors

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
        first = next((i for i, miss in enumerate(self._misses) if miss < 1), len(self._misses))
        small = self._misses[first:]
        rises = sum(later > earlier for earlier, later in pairwise(small))
        return float(np.median(small[-STAGNANT:])) if rises > 2 else 0.0

    def _forces_stay(self) -> bool:
        """Whether forces of two cycles differ by less than half the tolerance of themselves."""
        least = 0.01 * np.abs(self._forces).max()
        allowed = self._change_allowed * np.fmax(np.abs(self._forces), least)
        return bool((np.abs(self._forces - self._before) <= allowed).all())


def _sum_up(records: np.ndarray) -> np.ndarray:
    """Return the largest, smallest and mean force of a cycle, N."""
    force, time = records["force"], records["time"]
    mean = np.diff(time) @ (force[1:] + force[:-1]) / 2 / (time[-1] - time[0])
    return np.array([force.max(), force.min(), mean])
