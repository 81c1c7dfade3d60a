"""What all modes begin with: checks, and a run of the solver."""

from dataclasses import replace
from typing import Any

from softafm.checks.callers import warn_caller
from softafm.checks.kinds import refuse_other
from softafm.checks.validate import check_tolerance
from softafm.contact import Contact
from softafm.errors import AccuracyWarning
from softafm.instrument.agreement import check_motion
from softafm.instrument.cantilever import Cantilever
from softafm.instrument.motion import Motion, find_setpoint, is_steady, list_doubts
from softafm.progress import Progress, make_reporter
from softafm.solvers.energy import Energy
from softafm.solvers.history import History
from softafm.solvers.own import solve
from softafm.solvers.solver import Solver, check_solver


def carry(
    contact: Contact,
    motion: Motion,
    solver: Solver | None,
    tolerance: float,
    profiles: bool,
    progress: bool | Progress | None,
    **options: Any,
) -> tuple[Solver, float, History]:
    """Carry a contact through a motion; return the solver, the tolerance and the history.

    ``solver`` None stands for ``Energy()``. ``options`` go to the solver.
    """
    tolerance, solver = check_tolerance(tolerance), choose_solver(solver)
    check_motion(motion)
    refuse_start_inside(contact, motion)
    if is_steady(motion):
        refuse_flow(contact, "cycles = 'steady'", "give a number of cycles")
    refuse_unable(solver, motion)
    doubted = [AccuracyWarning(text) for text in list_doubts(motion)]
    doubts = (*doubt_window(contact, motion), *doubted)
    for warning in doubts:
        warn_caller(warning)
    with make_reporter(progress) as report:
        history = solve(
            solver, contact, motion,
            tolerance=tolerance, profiles=profiles, progress=report, **options,
        )  # fmt: skip
    return solver, tolerance, replace(history, warnings=(*doubts, *history.warnings))


def choose_solver(solver: Solver | None) -> Solver:
    """Return the solver of a run, ``Energy()`` for None; ValueError if it is not one."""
    if solver is None:
        return Energy()
    check_solver(solver)
    return solver


def doubt_window(contact: Contact, motion: Motion) -> tuple[AccuracyWarning, ...]:
    """Return what is to be warned of if a motion is longer than a sample's window, or nothing.

    Such a sample has a ``window``, the times (s) over which a chain represents it.
    """
    shortest, longest = getattr(contact.rheology, "window", (0.0, float("inf")))
    duration = float(motion.breaks[-1] - motion.breaks[0])
    if duration <= longest:
        return ()
    text = (
        f"the motion lasts {duration:.3g} s, but the sample '{contact.rheology.kind}' is "
        f"represented over window = ({shortest:g}, {longest:g}) s only: what it remembers for "
        f"longer is wrong; enlarge the window to {duration:.3g} s"
    )
    return (AccuracyWarning(text, duration / longest),)


def refuse_other_than_cantilever(cantilever: Any) -> None:
    """Raise ValueError if it is not a ``Cantilever``."""
    refuse_other("cantilever", cantilever, Cantilever, "a softafm.Cantilever")


def refuse_start_inside(contact: Contact, motion: Motion) -> None:
    """Raise ValueError if the tip starts below the equilibrium gap, inside the surface.

    A steady oscillation may: there the start is forgotten.
    """
    if is_steady(motion):
        return
    start = float(motion.height(motion.breaks[0]))
    gap, name = contact.edge_gap, "gap at which the surfaces touch"
    if contact.pulled:
        gap, name = contact.surface.equilibrium_gap, "equilibrium gap"
    if start <= gap:
        raise ValueError(
            f"start height = {start:g} m: must be above the {name}, {gap:g} m "
            "(the tip would start inside the surface)"
        )


def refuse_flow(contact: Contact, what: str, remedy: str) -> None:
    """Raise ValueError if the sample flows, so that no cycle is like the one before.

    ``what`` needs a steady cycle; ``remedy`` is what to do instead.
    """
    if contact.body.compliance.fluidity > 0:
        raise ValueError(
            f"{what}: the sample '{contact.sample.kind}' flows, so that the tip sinks deeper with "
            f"every cycle; {remedy}"
        )


def refuse_tapped_flow(contact: Contact) -> None:
    """Raise ValueError if a lever is to keep its amplitude on a sample that flows."""
    remedy = "take tapping_cycle with a number of cycles, or force_distance"
    refuse_flow(contact, "no height goes with an amplitude", remedy)


def refuse_unable(solver: Solver | None, motion: Motion) -> None:
    """Raise ValueError if a solver of fixed steps is to turn at a force."""
    if solver is None or solver.adaptive:
        return
    force = find_setpoint(motion)
    if force is not None:
        raise ValueError(
            f"setpoint_force = {force:g} N: the solver '{solver.kind}' must know the motion "
            "beforehand; leave it out, or use the solver 'energy'"
        )
