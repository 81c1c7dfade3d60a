"""A table for people: what an experiment is before it runs, and what it will cost."""

from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.table import Table

from softafm.modes.approach import deepest_tap, drive_of
from softafm.modes.start import regularised
from softafm.motions import lowest_height
from softafm.results import edge_slowed
from softafm.rheology.represented import Represented
from softafm.solvers.energy import Energy, cohesive_lengths_crossed
from softafm.summary import regularised_in_words, slowed_in_words, table_of
from softafm.tips import Paraboloid
from softafm.units import readable

if TYPE_CHECKING:
    from softafm.config import Experiment
    from softafm.contact import Contact
    from softafm.oscillator import Drive

_TAPS, _CHECKED = 130, 4
"""Taps of an approach curve, and runs that one with its check is worth, by experience."""
_FLOWS = "flows"
_SOFT, _ADVISED = 30, 8
"""Tabor number from which on another is advised."""
_FEW = 4
"""Creep times up to which each has a row of its own."""


def regime(experiment: "Experiment") -> Table:
    """Return a table of the numbers that say how a contact will behave and what it will cost."""
    contact = regularised(experiment.contact, experiment.regularise)
    motion = experiment.motion
    tapping = experiment.mode == "approach-curve"
    if tapping:
        drive, frequency = drive_of(
            experiment.cantilever, motion.free_amplitude, motion.drive_frequency
        )
        amplitudes = motion.free_amplitude * np.array(motion.amplitude_ratio)
        motion = deepest_tap(contact, drive, frequency, amplitudes)
    first, last = float(motion.breaks[0]), float(motion.breaks[-1])
    lowest = lowest_height(motion)
    radius = contact.contact_radius(lowest)

    table = table_of(f"{experiment.mode}, before any run")
    _add_tip(table, contact)
    _add_adhesion(table, contact)
    _add_regularisation(table, experiment, contact)
    carried = experiment.cantilever is not None and not tapping
    where = "above the undeformed surface" + (", lever unbent" if carried else "")
    where = "of a tap: Hertz against the drive" if tapping else where
    table.add_row("lowest tip height", readable(lowest, "m"), where)
    theory = "JKR" if contact.adhesive else "without adhesion"
    expected = f"{theory}, {_slow(contact)}, at the lowest height"
    words = expected if radius else "none is expected to last"
    table.add_row("contact radius", readable(radius, "m"), words)
    if carried:
        _add_lever(table, contact, experiment.cantilever.stiffness, radius)
    if tapping:
        _add_drive(table, experiment, drive)
    whole = "tap" if tapping else "motion"
    table.add_row(f"time of the {whole}", readable(last - first, "s"), "")
    _add_sample(table, contact, last - first, whole)
    solver: Any = Energy() if experiment.solver is None else experiment.solver
    if solver.adaptive:
        crossed = cohesive_lengths_crossed(contact, motion)
        reason = f"the edge crosses at most {crossed:.2g} cohesive lengths"
        reason = reason if contact.adhesive else "no tension zone to resolve"
    else:
        reason = f"{solver.steps} steps of {solver.nodes} nodes"
    runs = _TAPS if tapping else 1
    reason = f"some {_TAPS} taps; {reason}" if tapping else reason
    if experiment.check:
        runs *= _CHECKED
        reason += "; with a check"
    cost = _cost_in_words(runs * solver.expected_seconds(contact, motion))
    table.add_row("expected cost", cost, reason)
    return table


def _add_tip(table: Table, contact: "Contact") -> None:
    """Tell the radius that counts."""
    name, words = "effective radius", f"of the {contact.tip.kind}, where it is one reach high"
    if isinstance(contact.tip, Paraboloid):
        name, words = "tip radius", contact.tip.kind
    table.add_row(name, readable(contact.effective_radius, "m"), words)


def _add_adhesion(table: Table, contact: "Contact") -> None:
    """Tell how soft the contact is for its adhesion, and how wide the tension zone."""
    law = contact.surface
    work = readable(law.work_of_adhesion, "J/m²")
    if not contact.adhesive:
        table.add_row("work of adhesion", work, f"{law.kind}: no adhesion")
        return
    for when, tabor in (("fast", contact.tabor_instantaneous), ("slow", contact.tabor_relaxed)):
        value = f"{tabor:.3g}" if isfinite(tabor) else _FLOWS
        table.add_row(f"Tabor number, {when}", value, _tabor_in_words(tabor))
    for when, length in (
        ("fast", contact.cohesive_length_instantaneous),
        ("slow", contact.cohesive_length),
    ):
        value = readable(length, "m") if length else _FLOWS
        table.add_row(f"cohesive length, {when}", value, "tension zone at the edge")
    table.add_row("work of adhesion", work, f"{law.kind}: per area, to part the surfaces")


def _add_regularisation(table: Table, experiment: "Experiment", contact: "Contact") -> None:
    """Tell what became of a soft contact, or what could."""
    given = experiment.contact
    if experiment.regularise is not None:
        length = contact.surface.range
        words = regularised_in_words(given.tabor_softened, given.surface.range, length)
        words += slowed_in_words(edge_slowed(given, length))
        table.add_row("range", readable(length, "m"), words)
    elif given.tabor_softened > _SOFT:
        length = given.surface.range * given.tabor_softened / _ADVISED
        try:
            length = given.regularised(_ADVISED).surface.range
            words = "would enlarge the range from {} to {}"
        except ValueError:
            words = "is not possible with this law, whose range is {}; one of {} would do"
        words = words.format(readable(given.surface.range, "m"), readable(length, "m"))
        words += slowed_in_words(edge_slowed(given, length))
        table.add_row("regularise", f"{_ADVISED:g}", words)


def _add_sample(table: Table, contact: "Contact", duration: float, whole: str) -> None:
    """Tell how much the sample softens in the motion (s), and how."""
    sample = contact.sample
    creep = sample.reduced_compliance
    times = creep.retardation_times
    fast, late = (readable(1 / float(sample.creep_compliance(t)), "Pa") for t in (0, duration))
    softer = f"; {late} after the {whole}" if times.size or creep.fluidity else ""
    table.add_row("Young's modulus", fast, sample.kind + softer)
    if isinstance(sample, Represented):
        ends = " to ".join(readable(time, "s") for time in sample.window)
        words = f"to {100 * sample.represented_error:.2g} %, from {ends}"
        if duration > sample.window[1]:
            words += f"; the {whole} outlasts it: enlarge the window"
        elif duration < sample.window[0]:
            words += f"; the {whole} ends before: shift the window"
        table.add_row("represented by", _modes(sample.mode_count), words)
    elif times.size > _FEW:
        share = float(creep.modes @ -np.expm1(-duration / times) / creep.modes.sum())
        ends = f"{readable(times.min(), 's')} to {readable(times.max(), 's')}"
        words = f"{ends}; {share:.2g} of their creep in the {whole}"
        table.add_row("creep times", _modes(times.size), words)
    else:
        for time in map(float, times):
            words = _creep_in_words(time / duration, whole)
            table.add_row("creep time", readable(time, "s"), words)
    if creep.fluidity:
        viscosity = (1 - sample.poisson**2) / creep.fluidity
        shear = viscosity / (2 * (1 + sample.poisson))
        words = f"in tension, {readable(shear, 'Pa')} s in shear; flow without end"
        words = "of the modes, beyond the window" if isinstance(sample, Represented) else words
        table.add_row("viscosity", f"{readable(viscosity, 'Pa')} s", words)


def _modes(count: int) -> str:
    return "1 mode" if count == 1 else f"{count} modes"


def _slow(contact: "Contact") -> str:
    """Tell which modulus stands for the long run."""
    if contact.sample.reduced_compliance.fluidity:
        return f"at {readable(contact.softened_modulus, 'Pa')} as flow sets in"
    return "slow"


def _add_lever(table: Table, contact: "Contact", lever: float, radius: float) -> None:
    """Compare the lever, N/m, with what pulls it in and with what it presses on."""
    table.add_row("lever stiffness", readable(lever, "N/m"), "")
    attraction = contact.steepest_attraction
    words = "softer, the lever snaps in" if lever < attraction else "the lever is stiffer"
    words = words if contact.surface.attracts else "the law only repels"
    table.add_row("steepest attraction", readable(attraction, "N/m"), f"undeformed; {words}")
    if radius:
        stiffness = 2 * radius * contact.softened_modulus
        share = stiffness / (stiffness + lever)
        words = f"2·E·a, {_slow(contact)}; lever bends by {share:.0%} of the way"
        table.add_row("contact stiffness", readable(stiffness, "N/m"), words)


def _add_drive(table: Table, experiment: "Experiment", drive: "Drive") -> None:
    """Tell what drives the lever, and what that can hold and feed."""
    table.add_row("lever stiffness", readable(drive.stiffness, "N/m"), "")
    words = f"driven at {drive.detuning:.4g} of the resonance, Q = {drive.quality_factor:.4g}"
    table.add_row("free amplitude", readable(drive.free_amplitude, "m"), words)
    table.add_row("force of the drive", readable(drive.force, "N"), "amplitude, on the tip")
    most = readable(drive.most_dissipation, "J")
    table.add_row("largest dissipation", most, "that the drive can feed, a cycle")


def _tabor_in_words(tabor: float) -> str:
    if tabor < 0.1:
        return "stiff (DMT): adhesion acts around a Hertz contact"
    if tabor <= 5:
        return "between stiff (DMT) and soft (JKR)"
    return "soft (JKR): adhesion acts at the edge"


def _creep_in_words(share: float, whole: str) -> str:
    if share < 1e-3:
        return f"{share:.2g} of the {whole}: nearly relaxed"
    if share > 1e2:
        return f"{share:.2g} {whole}s: nearly elastic, at the short-time modulus"
    return f"{share:.2g} of the {whole}: viscoelastic"


def _cost_in_words(seconds: float) -> str:
    if seconds < 1:
        return "under 1 s"
    if seconds < 60:
        return "seconds"
    return "minutes" if seconds < 3600 else "hours"
