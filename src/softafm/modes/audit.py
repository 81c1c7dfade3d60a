"""The audit of a run: whether energy is balanced, signs and bounds hold, and the tip has parted."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

from softafm.errors import AccuracyWarning
from softafm.instrument.motion import is_steady
from softafm.modes.parting import (
    estimate_parting_height,
    estimate_work_at_speed,
    find_apparent_work,
    round_up,
)
from softafm.solvers.energies import Energies
from softafm.tips import Paraboloid
from softafm.units.quantities import write_quantity

if TYPE_CHECKING:
    from softafm.contact import Contact
    from softafm.solvers.history import History

_SHARE_OF_WAY = 0.01
"""Part of the largest force times the way of the tip below which an energy counts as none: of taps
2 % of force times amplitude."""
_IN_AND_OUT, _FARTHER = 2, 1.05
"""Jumps of a usual loop, and how much farther than JKR's a contact may reach."""
_FASTER = 1.5
"""How much more than so far a contact that is still pulled may come to bear."""
_GAPS = np.geomspace(1e-2, 1e3, 101)
"""Gaps beyond equilibrium, in the range of a law, at which a second well may lie."""
_REMEDY = "run it at a tighter tolerance, or with check = True"


@dataclass(frozen=True)
class Audit:
    """What an audit found.

    Attributes
    ----------
    energies
        Where the energy of the motion went.
    imbalance
        Work that nothing accounts for, as a part of its scale; None if what is stored is not known,
        as in a sample that flows.
    lowest_force
        Force below which nothing holds a tip like this, N; None if there is no such bound.
    in_contact
        Whether the tip, which came from afar, is in contact at the end.
    problems
        What is wrong: each a sentence and what to do.
    """

    energies: Energies
    imbalance: float | None
    lowest_force: float | None
    in_contact: bool
    problems: tuple[AccuracyWarning, ...]

    def write(self) -> str:
        """Return it as JSON, as results keep it in their attribute ``audit``."""
        found: dict[str, Any] = {
            "passed": not self.problems,
            "work": self.energies.work,
            "viscous_loss": self.energies.viscous,
            "jump_energy": self.energies.jumps,
            "energy_stored": self.energies.stored,
            "imbalance": self.imbalance,
            "lowest_force": self.lowest_force,
            "in_contact_at_end": self.in_contact,
            "problems": [str(problem) for problem in self.problems],
        }
        return json.dumps(found)


def write_audits(audits: Sequence[Audit]) -> str:
    """Return the audits of many runs as one, JSON: how many failed, and the largest imbalance."""
    imbalances = [each.imbalance for each in audits if each.imbalance is not None]
    failed = sum(bool(each.problems) for each in audits)
    found = {
        "passed": not failed,
        "runs": len(audits),
        "failed_runs": failed,
        "imbalance": max(imbalances, key=abs, default=None),
    }
    return json.dumps(found)


def audit(
    contact: "Contact", history: "History", tolerance: float, stiffness: float | None = None
) -> Audit:
    """Audit a run of some ``tolerance``, with a lever of a ``stiffness``, N/m, or none."""
    energies = history.energies()
    lowest = _bound_force(contact)
    imbalance = None
    # A sample that flows keeps its dent, whose energy beyond the mesh is not known.
    if energies.spent is not None and contact.body.compliance.fluidity == 0:
        imbalance = energies.imbalance / _find_scale(contact, history, energies)
    edge = history.contact_radius
    in_contact = bool(edge[-1] > 0 and edge[0] == 0)
    problems = (
        *_doubt_balance(energies, imbalance, tolerance),
        *_doubt_signs(contact, history, energies),
        *_doubt_force(contact, history, lowest, tolerance),
        *_doubt_tail(contact, history),
        *(_doubt_end(contact, history, stiffness) if in_contact else ()),
    )
    return Audit(energies, imbalance, lowest, in_contact, problems)


def _find_scale(contact: "Contact", history: "History", energies: Energies) -> float:
    """Return the energy against which the imbalance counts, J."""
    force = float(np.abs(history.force).max())
    length = max(contact.reach, _SHARE_OF_WAY * float(np.ptp(history.tip_height)))
    return max(abs(energies.work), abs(energies.spent or 0.0), force * length) or 1.0


def _bound_force(contact: "Contact") -> float | None:
    """Return −2πRW of a paraboloid, N, and of a viscoelastic sample E0/E_inf times that.

    Derjaguin's force on a rigid sample is the largest of an elastic one; a contact that is loaded
    slowly and pulled fast bears at most the ratio of the moduli more.
    """
    creep = contact.body.compliance
    if not isinstance(contact.tip, Paraboloid) or not contact.adhesive or creep.fluidity > 0:
        return None
    ratio = creep.relaxed / creep.instantaneous
    return -2 * pi * contact.tip.radius * contact.surface.work_of_adhesion * ratio


def _doubt_balance(
    energies: Energies, imbalance: float | None, tolerance: float
) -> Iterator[AccuracyWarning]:
    if imbalance is None or energies.balanced or abs(imbalance) <= tolerance:
        return
    parts = (
        (energies.work, "of work was done"),
        (energies.viscous, "went into dashpots"),
        (energies.jumps, "into jumps"),
        (energies.stored or 0.0, "is stored at the end"),
    )
    sums = ", ".join(f"{write_quantity(value, 'J')} {words}" for value, words in parts)
    yield AccuracyWarning(
        f"audit: energy is not balanced: {sums}, which differ by {100 * abs(imbalance):.2g} % of "
        f"their scale; {_REMEDY}",
        abs(imbalance),
    )


def _doubt_signs(
    contact: "Contact", history: "History", energies: Energies
) -> Iterator[AccuracyWarning]:
    """Yield what no passive sample does: give energy."""
    for name, values in (
        ("viscous_power", history.viscous_power),
        ("jump_energy", history.jump_energy),
    ):
        least, most = float(values.min(initial=0.0)), float(np.abs(values).max(initial=0.0))
        if least < -1e-3 * most or not np.isfinite(values).all():
            worst = write_quantity(least, "W" if name == "viscous_power" else "J")
            text = f"audit: {name} goes down to {worst}, though a passive sample gives no energy"
            yield AccuracyWarning(f"{text}; {_REMEDY}", abs(least))
    closed = energies.stored is None or abs(energies.stored) <= energies.spent_error
    if closed and energies.best < -3 * energies.work_error and history.contact_radius[-1] == 0:
        lost = write_quantity(energies.best, "J")
        text = f"audit: the loss is {lost}, though a passive sample gives no energy"
        yield AccuracyWarning(f"{text}; {_REMEDY}", abs(energies.best))


def _doubt_force(
    contact: "Contact", history: "History", lowest: float | None, tolerance: float
) -> Iterator[AccuracyWarning]:
    found = float(history.force.min())
    if lowest is None or found >= (1 + tolerance) * lowest:
        return
    law = contact.surface
    deepest = -float(law.potential(law.equilibrium_gap + contact.reach * _GAPS).min())
    lowest *= max(1.0, deepest / law.work_of_adhesion)  # of a second well, beyond a barrier
    if found < (1 + tolerance) * lowest:
        yield AccuracyWarning(
            f"audit: the force goes down to {write_quantity(found, 'N')}, and nothing holds this "
            f"tip with more than {write_quantity(-lowest, 'N')}, 2πRW times E0/E_inf; {_REMEDY}",
            found / lowest,
        )


def _doubt_tail(contact: "Contact", history: "History") -> Iterator[AccuracyWarning]:
    """Yield that an elastic contact lasts where none can, as an edge that catches on nodes does.

    One that falls in and out once cannot have: the others are worth the look.
    """
    if not contact.adhesive or history.viscous_power.any() or history.jump_time.size <= _IN_AND_OUT:
        return
    highest = float(history.tip_height[history.contact_radius > 0].max(initial=-np.inf))
    parted = estimate_parting_height(contact, contact.surface.work_of_adhesion)
    if highest > _FARTHER * parted:
        yield AccuracyWarning(
            f"audit: the tip stays in contact up to {write_quantity(highest, 'm')}, and an elastic "
            f"contact like this parts at {write_quantity(parted, 'm')} at the latest: its edge has "
            "caught on the nodes; try regularise=8",
            highest / parted,
        )


def _doubt_end(
    contact: "Contact", history: "History", stiffness: float | None
) -> Iterator[AccuracyWarning]:
    """Yield that a motion is back where it began, but the tip is not free."""
    motion = history.motion
    first, last = (float(motion.height(time)) for time in (history.time[0], history.time[-1]))
    if is_steady(motion) or abs(last - first) > 1e-6 * abs(first):
        return
    radius, height = float(history.contact_radius[-1]), float(history.tip_height[-1])
    work = max(
        find_apparent_work(contact, radius, height),
        estimate_work_at_speed(contact, motion.top_speed),
    )
    parted = estimate_parting_height(contact, _FASTER * work, stiffness)
    enough = round_up(max(parted, 1.1 * last))
    yield AccuracyWarning(
        f"audit: the tip is still in contact at the end, at {write_quantity(last, 'm')} under "
        f"{write_quantity(float(history.force[-1]), 'N')}: the loop is not closed, its energy "
        "includes what is stored, and the smallest force may be yet to come; let the motion start "
        f"and end at {write_quantity(enough, 'm')} or higher",
        enough,
    )
