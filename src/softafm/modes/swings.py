"""What modes with a lever that has inertia share: their solver, and passing its cycles."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from softafm.checks.callers import warn_caller
from softafm.errors import AccuracyWarning
from softafm.modes.parts import Settings
from softafm.modes.start import choose_solver
from softafm.progress import make_reporter
from softafm.solvers.energy import Energy
from softafm.solvers.solver import Solver

if TYPE_CHECKING:
    from softafm.solvers.energy.swinging import Swinging

_BALANCED, _LAST = 10.0, 20
"""Tolerances, in the work of the drive, by which the energy of the last cycles may be amiss."""


def choose_energy(given: Solver | None) -> Energy:
    """Return the solver of a run, ``Energy()`` for None; ValueError if it is another one."""
    solver = choose_solver(given)
    if not isinstance(solver, Energy):
        raise ValueError(
            f"solver = '{solver.kind}': cannot carry a lever with inertia; leave it out, or take "
            "'energy'"
        )
    return solver


def pass_all(
    run: "Swinging", passing: Iterator[int], cycles: int, name: str, settings: Settings
) -> tuple[dict[str, np.ndarray], tuple[AccuracyWarning, ...]]:
    """Return what is observed of all cycles, called by a ``name``, and what was warned of.

    An interrupt (Ctrl-C) ends them; those so far count.
    """
    warned: list[AccuracyWarning] = []
    with make_reporter(settings.progress) as report:
        try:
            for done in passing:
                if report is not None:
                    report(done / cycles, f"{name} {done} of {cycles}")
        except KeyboardInterrupt:
            if not run.done:
                raise
            warned.append(AccuracyWarning(f"interrupted after {run.done} of {cycles} {name}s"))
    values = run.observe()
    warned += [*run.list_doubts(), *_doubt_balance(values, settings.tolerance)]
    for warning in warned:
        warn_caller(warning)
    return values, tuple(warned)


def _doubt_balance(values: dict[str, np.ndarray], tolerance: float) -> tuple[AccuracyWarning, ...]:
    """Return what to warn of where the sample takes another energy than the tip loses."""
    taken = values["viscous_loss"] + values["jump_loss"]
    fed = np.abs(values["drive_work"]).max()
    off = float(np.median((values["dissipation"] - taken)[-_LAST:])) / fed if fed > 0 else 0.0
    if abs(off) <= _BALANCED * tolerance:
        return ()
    text = (
        f"energy is not balanced: in the last cycles {off:.2g} of the work of the drive goes into "
        "the contact and is found neither in its dashpots nor in its jumps; lower the tolerance"
    )
    return (AccuracyWarning(text, abs(off)),)
