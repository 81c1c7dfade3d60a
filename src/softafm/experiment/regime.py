"""What an experiment is before it runs, and what it will cost."""

from collections.abc import Sequence
from math import isfinite, log10
from typing import TYPE_CHECKING, Any

import numpy as np

from softafm.draw.summary import describe_misfit, describe_regularisation, describe_slowing
from softafm.experiment.run import Source, make_experiment
from softafm.experiment.scales import Regime
from softafm.instrument.motion import is_steady
from softafm.instrument.motions import find_lowest_height
from softafm.modes import MODES, Foreseen, Row
from softafm.modes.parting import (
    estimate_parting_height,
    estimate_work_at_speed,
    round_up,
)
from softafm.modes.regularise import choose_tabor, is_beyond, regularise_contact
from softafm.results.datasets import compute_edge_slowing
from softafm.rheology.represented import Represented
from softafm.solvers.energy import Energy, count_cohesive_lengths
from softafm.tips import Paraboloid
from softafm.units.quantities import write_quantity

if TYPE_CHECKING:
    from softafm.contact import Contact
    from softafm.experiment.config import Experiment
    from softafm.instrument.motion import Motion

_CHECKED, _TENTH = 4, 2.8
"""By experience: runs that one with its check is worth, and one with a tenth of the tolerance."""
_USUAL = 1e-2
"""Tolerance for which solvers state what to expect."""
_FLOWS = "flows"
_FEW = 4
"""Creep times up to which each has a row of its own."""


def regime(experiment: Source, overrides: Sequence[str] = ()) -> Regime:
    """Return the numbers that say how a contact will behave and what a run of it will cost.

    Parameters
    ----------
    experiment, overrides
        As ``softafm.run`` takes them. Nothing is run.

    Returns
    -------
    Regime
        Tabor numbers, cohesive lengths, depth and cost by name; ``print`` shows them as a table
        with what each means, as ``softafm info`` does.

    Raises
    ------
    ConfigError
        As ``softafm.run``.
    """
    known = make_experiment(experiment, overrides)
    contact, case = _make_case(known)
    lowest = find_lowest_height(case.motion)
    return Regime(
        mode=known.mode,
        contact=contact,
        lowest_height=lowest,
        contact_radius=contact.contact_radius(lowest),
        duration=float(case.motion.breaks[-1] - case.motion.breaks[0]),
        expected_seconds=estimate_seconds(known),
        rows=tuple(list_rows(known)),
    )


def list_rows(experiment: "Experiment") -> list[Row]:
    """Return the rows of that table."""
    contact, case = _make_case(experiment)
    motion = case.motion
    duration = float(motion.breaks[-1] - motion.breaks[0])
    lowest = find_lowest_height(motion)
    radius = contact.contact_radius(lowest)

    found: list[Row] = []
    _add_tip(found, contact)
    _add_adhesion(found, contact)
    _add_regularisation(found, experiment, contact)
    bends = MODES[experiment.mode].lever == "stiffness"
    where = "above the undeformed surface" + (", lever unbent" if bends else "")
    found.append(Row("lowest tip height", write_quantity(lowest, "m"), case.depth or where))
    theory = "JKR" if contact.adhesive else "without adhesion"
    expected = f"{theory}, {_name_slow_modulus(contact)}, at the lowest height"
    words = expected if radius else "none is expected to last"
    found.append(Row("contact radius", write_quantity(radius, "m"), words))
    if bends:
        _add_lever(found, contact, experiment.cantilever.stiffness, radius)
    _add_end(found, contact, motion, experiment.cantilever.stiffness if bends else None)
    found += case.rows
    found.append(Row(f"time of the {case.noun}", write_quantity(duration, "s"), ""))
    _add_sample(found, contact, duration, case.noun)
    cost = _describe_cost(estimate_seconds(experiment))
    found.append(Row("expected cost", cost, _reason_of_cost(experiment, contact, case)))
    return found


def estimate_seconds(experiment: "Experiment") -> float:
    """Return the order of magnitude of a run, s on one core."""
    contact, case = _make_case(experiment)
    runs = case.runs * (_CHECKED if experiment.check else 1)
    if experiment.regularise == "auto" and contact is not experiment.contact:
        runs += case.runs
    solver = _choose_solver(experiment)
    if solver.adaptive:
        runs *= _TENTH ** log10(_USUAL / experiment.tolerance)
    return runs * solver.expected_seconds(contact, case.motion)


def _make_case(experiment: "Experiment") -> tuple["Contact", Foreseen]:
    """Return what comes in touch, and how."""
    mode = MODES[experiment.mode]
    contact = regularise_contact(experiment.contact, experiment.regularise, mode, experiment.motion)
    return contact, mode.expect(experiment.inputs._replace(contact=contact))


def _choose_solver(experiment: "Experiment") -> Any:
    return Energy() if experiment.solver is None else experiment.solver


def _reason_of_cost(experiment: "Experiment", contact: "Contact", case: Foreseen) -> str:
    """Return what a run costs its time for."""
    solver = _choose_solver(experiment)
    if not solver.adaptive:
        reason = f"{solver.steps} steps of {solver.nodes} nodes"
    elif contact.adhesive:
        crossed = count_cohesive_lengths(contact, case.motion)
        reason = f"the edge crosses at most {crossed:.2g} cohesive lengths"
    else:
        reason = "no tension zone to resolve"
    reason = f"some {case.runs} {case.noun}s; {reason}" if case.runs > 1 else reason
    return f"{reason}; with a check" if experiment.check else reason


def _add_tip(found: list[Row], contact: "Contact") -> None:
    """Show the radius that counts."""
    name, words = "effective radius", f"of the {contact.tip.kind}, where it is one reach high"
    if isinstance(contact.tip, Paraboloid):
        name, words = "tip radius", contact.tip.kind
    found.append(Row(name, write_quantity(contact.effective_radius, "m"), words))


def _add_adhesion(found: list[Row], contact: "Contact") -> None:
    """Show how soft the contact is for its adhesion, and how wide the tension zone."""
    law = contact.surface
    work = write_quantity(law.work_of_adhesion, "J/m²")
    if not contact.adhesive:
        found.append(Row("work of adhesion", work, f"{law.kind}: no adhesion"))
        return
    for when, tabor in (("fast", contact.tabor_instantaneous), ("slow", contact.tabor_relaxed)):
        value = f"{tabor:.3g}" if isfinite(tabor) else _FLOWS
        found.append(Row(f"Tabor number, {when}", value, _describe_tabor(tabor)))
    for when, length in (
        ("fast", contact.cohesive_length_instantaneous),
        ("slow", contact.cohesive_length),
    ):
        value = write_quantity(length, "m") if length else _FLOWS
        found.append(Row(f"cohesive length, {when}", value, "tension zone at the edge"))
    found.append(Row("work of adhesion", work, f"{law.kind}: per area, to part the surfaces"))


def _add_regularisation(found: list[Row], experiment: "Experiment", contact: "Contact") -> None:
    """Show what becomes of a soft contact, or that it stays as it is."""
    given, regularise = experiment.contact, experiment.regularise
    mode, motion = MODES[experiment.mode], experiment.motion
    if choose_tabor(given, regularise, mode, motion) is not None:
        length = contact.surface.range
        words = describe_regularisation(given.tabor_softened, given.surface.range, length)
        words += describe_slowing(compute_edge_slowing(given, length))
        words += "; a second run estimates the error" if regularise == "auto" else ""
        found.append(Row("range", write_quantity(length, "m"), words))
    elif is_beyond(given, mode, motion):
        words = f"the law stays: beyond a Tabor number of {given.largest_tabor:g} the run may fail"
        found.append(Row("range", write_quantity(given.surface.range, "m"), words))


def _add_sample(found: list[Row], contact: "Contact", duration: float, whole: str) -> None:
    """Show how much the sample softens in the motion (s), and how."""
    sample = contact.rheology
    creep = sample.compliance
    times = creep.retardation_times
    fast, late = (
        write_quantity(1 / float(sample.creep_compliance(t)), "Pa") for t in (0, duration)
    )
    softer = f"; {late} after the {whole}" if times.size or creep.fluidity else ""
    found.append(Row("Young's modulus", fast, sample.kind + softer))
    if sample.dma_misfit:
        found.append(Row(*describe_misfit(*sample.dma_misfit)))
    if isinstance(sample, Represented):
        ends = " to ".join(write_quantity(time, "s") for time in sample.window)
        words = f"to {100 * sample.represented_error:.2g} %, from {ends}"
        if duration > sample.window[1]:
            words += f"; the {whole} outlasts it: enlarge the window"
        elif duration < sample.window[0]:
            words += f"; the {whole} ends before: shift the window"
        found.append(Row("represented by", _elements(sample.element_count), words))
    elif times.size > _FEW:
        share = float(creep.elements @ -np.expm1(-duration / times) / creep.elements.sum())
        ends = f"{write_quantity(times.min(), 's')} to {write_quantity(times.max(), 's')}"
        words = f"{ends}; {share:.2g} of their creep in the {whole}"
        found.append(Row("creep times", _elements(times.size), words))
    else:
        for time in map(float, times):
            words = _describe_creep(time / duration, whole)
            found.append(Row("creep time", write_quantity(time, "s"), words))
    if creep.fluidity:
        viscosity = 1 / creep.fluidity
        shear = viscosity / (2 * (1 + sample.poisson))
        words = f"in tension, {write_quantity(shear, 'Pa')} s in shear; flow without end"
        words = "of the elements, beyond the window" if isinstance(sample, Represented) else words
        found.append(Row("viscosity", f"{write_quantity(viscosity, 'Pa')} s", words))


def _elements(count: int) -> str:
    return "1 element" if count == 1 else f"{count} elements"


def _name_slow_modulus(contact: "Contact") -> str:
    """Return the name of the modulus that stands for the long run."""
    if contact.body.compliance.fluidity:
        return f"at {write_quantity(contact.softened_modulus, 'Pa')} as flow sets in"
    return "slow"


def _add_lever(found: list[Row], contact: "Contact", lever: float, radius: float) -> None:
    """Compare the lever, N/m, with what pulls it in and with what it presses on."""
    found.append(Row("lever stiffness", write_quantity(lever, "N/m"), ""))
    attraction = contact.steepest_attraction
    words = "softer, the lever snaps in" if lever < attraction else "the lever is stiffer"
    words = words if contact.surface.attracts else "the law only repels"
    found.append(
        Row("steepest attraction", write_quantity(attraction, "N/m"), f"undeformed; {words}")
    )
    if radius:
        stiffness = 2 * radius * contact.softened_modulus * contact.body.hardening(radius)
        share = stiffness / (stiffness + lever)
        words = f"2·E·a, {_name_slow_modulus(contact)}; lever bends by {share:.0%} of the way"
        found.append(Row("contact stiffness", write_quantity(stiffness, "N/m"), words))


def _add_end(
    found: list[Row], contact: "Contact", motion: "Motion", stiffness: float | None
) -> None:
    """Show that a motion is over before the tip has parted."""
    height = float(motion.height(motion.breaks[-1]))
    if not contact.adhesive or is_steady(motion) or find_lowest_height(motion) >= contact.reach:
        return
    work = estimate_work_at_speed(contact, motion.top_speed)
    parted = estimate_parting_height(contact, work, stiffness)
    if height < parted:
        words = f"the tip parts at about {write_quantity(round_up(parted), 'm')}: start there"
        found.append(Row("end of the motion", write_quantity(height, "m"), words))


def _describe_tabor(tabor: float) -> str:
    if tabor < 0.1:
        return "stiff (DMT): adhesion acts around a Hertz contact"
    if tabor <= 5:
        return "between stiff (DMT) and soft (JKR)"
    return "soft (JKR): adhesion acts at the edge"


def _describe_creep(share: float, whole: str) -> str:
    if share < 1e-3:
        return f"{share:.2g} of the {whole}: nearly relaxed"
    if share > 1e2:
        return f"{share:.2g} {whole}s: nearly elastic, at the short-time modulus"
    return f"{share:.2g} of the {whole}: viscoelastic"


def _describe_cost(seconds: float) -> str:
    if seconds < 1:
        return "under 1 s"
    if seconds < 60:
        return "seconds"
    return "minutes" if seconds < 3600 else "hours"
