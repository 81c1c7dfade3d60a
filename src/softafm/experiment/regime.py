"""What an experiment is before it runs, and what it will cost: numbers, and a table for people."""

from math import isfinite, log10
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from rich.table import Table

from softafm.draw.summary import misfit_in_words, regularised_in_words, slowed_in_words, table_of
from softafm.instrument.motions import lowest_height
from softafm.modes.approach import deepest_tap, drive_of
from softafm.modes.start import regularised
from softafm.results.datasets import edge_slowed
from softafm.rheology.represented import Represented
from softafm.solvers.energy import Energy, cohesive_lengths_crossed
from softafm.tips import Paraboloid
from softafm.units.quantities import readable

if TYPE_CHECKING:
    from softafm.contact import Contact
    from softafm.experiment.config import Experiment
    from softafm.instrument.oscillator import Drive

_TAPS, _CHECKED, _TENTH = 130, 4, 2.8
"""By experience: taps of an approach curve, runs that one with its check is worth, and one with a
tenth of the tolerance."""
_USUAL = 1e-2
"""Tolerance for which solvers tell what to expect."""
_FLOWS = "flows"
_SOFT, _ADVISED = 30, 8
"""Tabor number from which on another is advised."""
_FEW = 4
"""Creep times up to which each has a row of its own."""


class Row(NamedTuple):
    """A number with its unit, as text, and what it means."""

    name: str
    value: str
    words: str


class _Case(NamedTuple):
    """What comes in touch, and how: of an approach curve its deepest tap."""

    contact: "Contact"
    motion: Any
    drive: "Drive | None"


def regime(experiment: "Experiment") -> Table:
    """Return a table of the numbers that say how a contact will behave and what it will cost."""
    table = table_of(f"{experiment.mode}, before any run")
    for row in rows(experiment):
        table.add_row(*row)
    return table


def rows(experiment: "Experiment") -> list[Row]:
    """Return the rows of that table."""
    case = _case(experiment)
    contact, motion, drive = case
    first, last = float(motion.breaks[0]), float(motion.breaks[-1])
    lowest = lowest_height(motion)
    radius = contact.contact_radius(lowest)

    found: list[Row] = []
    _add_tip(found, contact)
    _add_adhesion(found, contact)
    _add_regularisation(found, experiment, contact)
    carried = experiment.cantilever is not None and drive is None
    where = "above the undeformed surface" + (", lever unbent" if carried else "")
    where = "of a tap: Hertz against the drive" if drive else where
    found.append(Row("lowest tip height", readable(lowest, "m"), where))
    theory = "JKR" if contact.adhesive else "without adhesion"
    expected = f"{theory}, {_slow(contact)}, at the lowest height"
    words = expected if radius else "none is expected to last"
    found.append(Row("contact radius", readable(radius, "m"), words))
    if carried:
        _add_lever(found, contact, experiment.cantilever.stiffness, radius)
    if drive:
        _add_drive(found, drive)
    whole = "tap" if drive else "motion"
    found.append(Row(f"time of the {whole}", readable(last - first, "s"), ""))
    _add_sample(found, contact, last - first, whole)
    cost = _cost_in_words(_seconds(experiment, case))
    found.append(Row("expected cost", cost, _cost_of(experiment, case)))
    return found


def expected_seconds(experiment: "Experiment") -> float:
    """Return the order of magnitude of a run, s on one core."""
    return _seconds(experiment, _case(experiment))


def _case(experiment: "Experiment") -> _Case:
    contact = regularised(experiment.contact, experiment.regularise)
    motion = experiment.motion
    if experiment.mode != "approach-curve":
        return _Case(contact, motion, None)
    drive, frequency = drive_of(
        experiment.cantilever, motion.free_amplitude, motion.drive_frequency
    )
    amplitudes = motion.free_amplitude * np.array(motion.amplitude_ratio)
    return _Case(contact, deepest_tap(contact, drive, frequency, amplitudes), drive)


def _solver(experiment: "Experiment") -> Any:
    return Energy() if experiment.solver is None else experiment.solver


def _seconds(experiment: "Experiment", case: _Case) -> float:
    runs = (_TAPS if case.drive else 1) * (_CHECKED if experiment.check else 1)
    solver = _solver(experiment)
    if solver.adaptive:
        runs *= _TENTH ** log10(_USUAL / experiment.tolerance)
    return runs * solver.expected_seconds(case.contact, case.motion)


def _cost_of(experiment: "Experiment", case: _Case) -> str:
    """Tell what a run costs its time for."""
    solver = _solver(experiment)
    if not solver.adaptive:
        reason = f"{solver.steps} steps of {solver.nodes} nodes"
    elif case.contact.adhesive:
        crossed = cohesive_lengths_crossed(case.contact, case.motion)
        reason = f"the edge crosses at most {crossed:.2g} cohesive lengths"
    else:
        reason = "no tension zone to resolve"
    reason = f"some {_TAPS} taps; {reason}" if case.drive else reason
    return f"{reason}; with a check" if experiment.check else reason


def _add_tip(found: list[Row], contact: "Contact") -> None:
    """Tell the radius that counts."""
    name, words = "effective radius", f"of the {contact.tip.kind}, where it is one reach high"
    if isinstance(contact.tip, Paraboloid):
        name, words = "tip radius", contact.tip.kind
    found.append(Row(name, readable(contact.effective_radius, "m"), words))


def _add_adhesion(found: list[Row], contact: "Contact") -> None:
    """Tell how soft the contact is for its adhesion, and how wide the tension zone."""
    law = contact.surface
    work = readable(law.work_of_adhesion, "J/m²")
    if not contact.adhesive:
        found.append(Row("work of adhesion", work, f"{law.kind}: no adhesion"))
        return
    for when, tabor in (("fast", contact.tabor_instantaneous), ("slow", contact.tabor_relaxed)):
        value = f"{tabor:.3g}" if isfinite(tabor) else _FLOWS
        found.append(Row(f"Tabor number, {when}", value, _tabor_in_words(tabor)))
    for when, length in (
        ("fast", contact.cohesive_length_instantaneous),
        ("slow", contact.cohesive_length),
    ):
        value = readable(length, "m") if length else _FLOWS
        found.append(Row(f"cohesive length, {when}", value, "tension zone at the edge"))
    found.append(Row("work of adhesion", work, f"{law.kind}: per area, to part the surfaces"))


def _add_regularisation(found: list[Row], experiment: "Experiment", contact: "Contact") -> None:
    """Tell what became of a soft contact, or what could."""
    given = experiment.contact
    if experiment.regularise is not None:
        length = contact.surface.range
        words = regularised_in_words(given.tabor_softened, given.surface.range, length)
        words += slowed_in_words(edge_slowed(given, length))
        found.append(Row("range", readable(length, "m"), words))
    elif given.tabor_softened > _SOFT:
        length = given.surface.range * given.tabor_softened / _ADVISED
        try:
            length = given.regularised(_ADVISED).surface.range
            words = "would enlarge the range from {} to {}"
        except ValueError:
            words = "is not possible with this law, whose range is {}; one of {} would do"
        words = words.format(readable(given.surface.range, "m"), readable(length, "m"))
        words += slowed_in_words(edge_slowed(given, length))
        found.append(Row("regularise", f"{_ADVISED:g}", words))


def _add_sample(found: list[Row], contact: "Contact", duration: float, whole: str) -> None:
    """Tell how much the sample softens in the motion (s), and how."""
    sample = contact.rheology
    creep = sample.compliance
    times = creep.retardation_times
    fast, late = (readable(1 / float(sample.creep_compliance(t)), "Pa") for t in (0, duration))
    softer = f"; {late} after the {whole}" if times.size or creep.fluidity else ""
    found.append(Row("Young's modulus", fast, sample.kind + softer))
    if sample.dma_misfit:
        found.append(Row(*misfit_in_words(*sample.dma_misfit)))
    if isinstance(sample, Represented):
        ends = " to ".join(readable(time, "s") for time in sample.window)
        words = f"to {100 * sample.represented_error:.2g} %, from {ends}"
        if duration > sample.window[1]:
            words += f"; the {whole} outlasts it: enlarge the window"
        elif duration < sample.window[0]:
            words += f"; the {whole} ends before: shift the window"
        found.append(Row("represented by", _elements(sample.element_count), words))
    elif times.size > _FEW:
        share = float(creep.elements @ -np.expm1(-duration / times) / creep.elements.sum())
        ends = f"{readable(times.min(), 's')} to {readable(times.max(), 's')}"
        words = f"{ends}; {share:.2g} of their creep in the {whole}"
        found.append(Row("creep times", _elements(times.size), words))
    else:
        for time in map(float, times):
            words = _creep_in_words(time / duration, whole)
            found.append(Row("creep time", readable(time, "s"), words))
    if creep.fluidity:
        viscosity = 1 / creep.fluidity
        shear = viscosity / (2 * (1 + sample.poisson))
        words = f"in tension, {readable(shear, 'Pa')} s in shear; flow without end"
        words = "of the elements, beyond the window" if isinstance(sample, Represented) else words
        found.append(Row("viscosity", f"{readable(viscosity, 'Pa')} s", words))


def _elements(count: int) -> str:
    return "1 element" if count == 1 else f"{count} elements"


def _slow(contact: "Contact") -> str:
    """Tell which modulus stands for the long run."""
    if contact.body.compliance.fluidity:
        return f"at {readable(contact.softened_modulus, 'Pa')} as flow sets in"
    return "slow"


def _add_lever(found: list[Row], contact: "Contact", lever: float, radius: float) -> None:
    """Compare the lever, N/m, with what pulls it in and with what it presses on."""
    found.append(Row("lever stiffness", readable(lever, "N/m"), ""))
    attraction = contact.steepest_attraction
    words = "softer, the lever snaps in" if lever < attraction else "the lever is stiffer"
    words = words if contact.surface.attracts else "the law only repels"
    found.append(Row("steepest attraction", readable(attraction, "N/m"), f"undeformed; {words}"))
    if radius:
        stiffness = 2 * radius * contact.softened_modulus * contact.body.hardening(radius)
        share = stiffness / (stiffness + lever)
        words = f"2·E·a, {_slow(contact)}; lever bends by {share:.0%} of the way"
        found.append(Row("contact stiffness", readable(stiffness, "N/m"), words))


def _add_drive(found: list[Row], drive: "Drive") -> None:
    """Tell what drives the lever, and what that can hold and feed."""
    found.append(Row("lever stiffness", readable(drive.stiffness, "N/m"), ""))
    words = f"driven at {drive.detuning:.4g} of the resonance, Q = {drive.quality_factor:.4g}"
    found.append(Row("free amplitude", readable(drive.free_amplitude, "m"), words))
    found.append(Row("force of the drive", readable(drive.force, "N"), "amplitude, on the tip"))
    most = readable(drive.most_dissipation, "J")
    found.append(Row("largest dissipation", most, "that the drive can feed, a cycle"))


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
