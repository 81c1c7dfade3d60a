"""Tables for people: what a run found, and what an experiment is before it runs."""

from typing import TYPE_CHECKING, Any

import numpy as np
from rich.table import Table

from softafm.motions import lowest_height
from softafm.solvers.energy import Energy, cohesive_lengths_crossed
from softafm.units import readable

if TYPE_CHECKING:
    from xarray import Dataset

    from softafm.config import Experiment


def observables(dataset: "Dataset") -> Table:
    """Return a table of every scalar of a result, and of the number of elastic jumps."""
    table = _table(str(dataset.attrs.get("mode", "result")))
    for name, variable in dataset.data_vars.items():
        if variable.ndim == 0 and np.issubdtype(variable.dtype, np.number):
            value = readable(float(variable), variable.attrs.get("units", ""))
            table.add_row(str(name), value, str(variable.attrs.get("long_name", "")))
    if "jump_time" in dataset:
        table.add_row("jumps", str(dataset["jump_time"].size), "elastic instabilities crossed")
    return table


def regime(experiment: "Experiment") -> Table:
    """Return a table of the numbers that say how a contact will behave and what it will cost."""
    contact, motion = experiment.contact, experiment.motion
    first, last = float(motion.breaks[0]), float(motion.breaks[-1])
    lowest = lowest_height(motion)
    radius = contact.contact_radius(lowest)

    table = _table(f"{experiment.mode}, before any run")
    for when, tabor in (("fast", contact.tabor_instantaneous), ("slow", contact.tabor_relaxed)):
        table.add_row(f"Tabor number, {when}", f"{tabor:.3g}", _tabor_in_words(tabor))
    for when, length in (
        ("fast", contact.cohesive_length_instantaneous),
        ("slow", contact.cohesive_length),
    ):
        table.add_row(f"cohesive length, {when}", readable(length, "m"), "tension zone at the edge")
    work = readable(contact.surface.work_of_adhesion, "J/m²")
    table.add_row("work of adhesion", work, "per area, to part the surfaces")
    carried = experiment.cantilever is not None
    where = "above the undeformed surface" + (", lever unbent" if carried else "")
    table.add_row("lowest tip height", readable(lowest, "m"), where)
    jkr = "JKR, slow, at the lowest height" if radius else "none is expected to last"
    table.add_row("contact radius", readable(radius, "m"), jkr)
    if carried:
        _add_lever(table, experiment, radius)
    table.add_row("time of the motion", readable(last - first, "s"), "")
    for creep_time in map(float, contact.sample.reduced_compliance.retardation_times):
        words = _creep_in_words(creep_time / (last - first))
        table.add_row("creep time", readable(creep_time, "s"), words)
    solver: Any = Energy() if experiment.solver is None else experiment.solver
    if solver.adaptive:
        crossed = cohesive_lengths_crossed(contact, motion)
        reason = f"the edge crosses at most {crossed:.2g} cohesive lengths"
    else:
        reason = f"{solver.steps} steps of {solver.nodes} nodes"
    cost = _cost_in_words(solver.expected_seconds(contact, motion))
    table.add_row("expected cost", cost, reason)
    return table


def _add_lever(table: Table, experiment: "Experiment", radius: float) -> None:
    """Compare the lever with what pulls it in and with what it presses on."""
    contact, lever = experiment.contact, experiment.cantilever.stiffness
    table.add_row("lever stiffness", readable(lever, "N/m"), "")
    attraction = contact.steepest_attraction
    words = "softer, the lever snaps in" if lever < attraction else "the lever is stiffer"
    table.add_row("steepest attraction", readable(attraction, "N/m"), f"undeformed; {words}")
    if radius:
        stiffness = 2 * radius / contact.sample.reduced_compliance.relaxed
        share = stiffness / (stiffness + lever)
        words = f"2·E·a, slow; lever bends by {share:.0%} of the way"
        table.add_row("contact stiffness", readable(stiffness, "N/m"), words)


def _table(title: str) -> Table:
    table = Table(title=title, title_justify="left", show_header=False, box=None)
    table.add_column(no_wrap=True)
    table.add_column(justify="right", no_wrap=True)
    table.add_column(style="dim")
    return table


def _tabor_in_words(tabor: float) -> str:
    if tabor < 0.1:
        return "stiff (DMT): adhesion acts around a Hertz contact"
    if tabor <= 5:
        return "between stiff (DMT) and soft (JKR)"
    return "soft (JKR): adhesion acts at the edge"


def _creep_in_words(share: float) -> str:
    if share < 1e-3:
        return f"{share:.2g} of the motion: nearly relaxed"
    if share > 1e2:
        return f"{share:.2g} motions: nearly elastic, at the short-time modulus"
    return f"{share:.2g} of the motion: viscoelastic"


def _cost_in_words(seconds: float) -> str:
    if seconds < 1:
        return "under 1 s"
    if seconds < 60:
        return "seconds"
    return "minutes" if seconds < 3600 else "hours"
