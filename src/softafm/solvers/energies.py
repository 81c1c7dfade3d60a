"""Where the energy of a motion goes: into dashpots, jumps, and what is stored at its end."""

from math import hypot, isfinite, isnan, nan
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from softafm.instrument.motion import is_steady

if TYPE_CHECKING:
    from softafm.solvers.history import History

_INTEGRAL, _WORK, _STEPS = 0.1, 2e-3, 5e-5
"""Errors of the work: in differences of two rules of integration, in itself, and in the largest
force times the way, for what happens between two steps. Elastic ramps and taps without a jump do no
work: of the first 40 such of ``benchmarks/contacts.py`` nine in ten are off by less than the first.
"""
_VISCOUS, _JUMPS, _STORED = 2e-3, 0.05, 1e-2
"""Errors of where it goes, each in itself."""
_AGREE = 3.0
"""How many errors apart the two sides of a balance may be."""
_ROUNDING = 1e-6
"""Part of what is lost below which what is stored is due to rounding."""


class Energies(NamedTuple):
    """Energies of a motion, or of a part of it, J.

    Attributes
    ----------
    work
        Done by what moves, −∮F dh, as the force has it.
    viscous, jumps
        Taken by the dashpots, and released by elastic jumps.
    stored
        Held by sample, surface forces and lever at the end more than at the start; None if that is
        not known.
    work_error, spent_error
        What ``work`` and the sum of the others may be off by.
    """

    work: float
    viscous: float
    jumps: float
    stored: float | None
    work_error: float
    spent_error: float

    @property
    def spent(self) -> float | None:
        """Sum of where the work went, J; None if what is stored is not known."""
        return None if self.stored is None else self.viscous + self.jumps + self.stored

    @property
    def imbalance(self) -> float:
        """Work of which nothing tells where it went, J; 0 if what is stored is not known."""
        return 0.0 if self.spent is None else self.work - self.spent

    @property
    def balanced(self) -> bool:
        """Whether both sides agree within their errors; not if what is stored is not known."""
        if self.spent is None or not isfinite(self.imbalance):
            return False
        return abs(self.imbalance) <= _AGREE * hypot(self.work_error, self.spent_error)

    @property
    def best(self) -> float:
        """The work, J, by both sides if they agree, each counting by its error.

        The integral of a force that goes to and fro on nearly the same curve is a small difference
        of large numbers, while what dashpots and jumps take is known to a part of itself.
        """
        if self.spent == 0 and self.spent_error == 0:  # nothing that could take any
            return 0.0
        if not self.balanced or self.spent is None:
            return self.work
        ours, theirs = self.spent_error**2, self.work_error**2
        return (self.work * ours + self.spent * theirs) / (ours + theirs)


def measure_energies(history: "History", start: float, stop: float) -> Energies:
    """Return where the energy of a history went between two times, s."""
    slack = 1e-9 * (stop - start)
    inside = slice(*map(int, history.time.searchsorted([start - slack, stop + slack])))
    motion = history.motion
    work, curved = history.compare_rules(history.force, motion.velocity, start, stop)
    viscous = history.integrate_power(start, stop)
    jumped = (history.jump_time > start) & (history.jump_time <= stop)
    jumps = float(history.jump_energy[jumped].sum())
    height = motion.height(history.time[inside])
    way, largest = np.ptp(height), np.abs(history.force[inside]).max()
    back = abs(height[-1] - height[0]) <= 1e-9 * way
    stored = _find_stored(history, inside, bool(back), bool(jumped.any()))
    if stored is not None and abs(stored) < _ROUNDING * (viscous + jumps):
        stored = 0.0
    spent_error = _VISCOUS * abs(viscous) + _JUMPS * abs(jumps) + _STORED * abs(stored or 0.0)
    work_error = hypot(_INTEGRAL * curved, _WORK * work, _STEPS * largest * way)
    return Energies(-work, viscous, jumps, stored, work_error, spent_error)


def _find_stored(history: "History", inside: slice, back: bool, jumped: bool) -> float | None:
    """Return the energy stored between the instants ``inside``, J, if it is known.

    A steady cycle ends as it began, and so does an elastic contact that is ``back`` where it was,
    and not caught on another branch.
    """
    before, after = (
        history.diagnostics.get(f"stored_energy_{end}", nan) for end in ("start", "end")
    )
    if isnan(before) or isnan(after):
        return None
    edge = history.contact_radius[inside]
    free = not jumped or edge[0] == edge[-1] == 0
    if is_steady(history.motion) or (back and free and not history.viscous_power.any()):
        return 0.0
    if edge.size == history.time.size:
        return after - before
    if history.stored_energy is None:
        return None
    before, after = history.stored_energy[inside][[0, -1]]
    return None if isnan(after - before) else float(after - before)
