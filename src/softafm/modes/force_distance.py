"""Force-distance curves: the tip height is prescribed."""

from typing import TYPE_CHECKING, Any

import numpy as np

from softafm.contact import Contact
from softafm.instrument.motion import Motion
from softafm.instrument.motions import Sine, Trajectory, Triangle
from softafm.modes.mode import Mode
from softafm.modes.parts import Layout
from softafm.modes.perform import perform
from softafm.modes.regularise import Regularise
from softafm.progress import Progress
from softafm.results.content import RAMPED, observables
from softafm.solvers.history import History
from softafm.solvers.solver import Solver

if TYPE_CHECKING:
    from xarray import Dataset


def force_distance(
    contact: Contact,
    motion: Motion,
    *,
    solver: Solver | None = None,
    tolerance: float = 1e-2,
    profiles: bool = False,
    progress: bool | Progress | None = None,
    check: bool = False,
    regularise: Regularise = "auto",
) -> "Dataset":
    """Force on a tip that is moved through ``motion`` above a surface flat and relaxed at first.

    Parameters
    ----------
    contact
        Tip, sample and surface law.
    motion
        ``Triangle``, ``Sine`` or ``Trajectory``.
    solver
        A solver of ``softafm.solvers``; ``Energy()`` by default.
    tolerance
        Target relative error of the reported observables, 1e-5 to 0.1.
    profiles
        Keep surface deformation, gap and pressure over (time, r).
    progress
        None, True for a bar, or a callable (fraction, message).
    check
        Repeat the run at a tenth of the tolerance, or with twice the steps and nodes of a solver of
        fixed steps, and state the differences in the attributes ``check_...``. One above the
        tolerance raises ``AccuracyWarning``.
    regularise
        Tabor number, 0.1 to 1000, to which that of a softer contact is lowered by enlarging the
        range of the surface law at fixed work of adhesion (``Contact.regularised``). What adhesion
        a viscoelastic sample has at a speed depends on the range: ``softafm docs soft`` tells what
        to do. The law as it was given stays in the attribute ``experiment``. ``"auto"`` changes
        nothing up to a Tabor number of 1000; beyond it, where the solver may not succeed, the
        contact is regularised to 500, and a second run at 250 estimates the error, of which
        ``AccuracyWarning`` tells. None always keeps the law, and warns beforehand.

    Returns
    -------
    xarray.Dataset
        Over ``time``: ``tip_height``, ``force``, ``contact_radius``, ``axis_deformation``,
        ``viscous_power``. Scalars ``force_max``, ``force_min``, ``force_min_approach`` (before the
        lowest tip height), ``loop_energy`` (−∮F dh0), ``viscous_loss``. ``jump_time`` and
        ``jump_energy`` of elastic jumps. All SI.

    Raises
    ------
    ValueError
        If the tip starts inside the surface or an argument is out of range.
    DivergedError
        If the solver cannot continue.
    """
    return perform(
        MODE, contact, motion, solver=solver, tolerance=tolerance, profiles=profiles,
        progress=progress, check=check, regularise=regularise,
    )  # fmt: skip


def observe_ramp(contact: Contact, motion: Any, history: History) -> dict[str, Any]:
    """Return the scalars of a force curve."""
    return measure_ramp(history, history.tip_height)


def measure_ramp(history: History, path: np.ndarray) -> dict[str, Any]:
    """Return the scalars of a force curve; ``path`` (n,), m, is the motion as carried out."""
    force, energies = history.force, history.energies()
    lowest = history.time[np.argmin(path)]
    return {
        "force_max": history.extreme(force, 1),
        "force_min": history.extreme(force, -1),
        "force_min_approach": history.extreme(force, -1, stop=lowest),
        "loop_energy": energies.best,
        "viscous_loss": energies.viscous,
    }


MOTIONS = {"triangle": Triangle, "sine": Sine, "trajectory": Trajectory}
"""Motions of the tip, or of the base of its lever, by shape."""

MODE = Mode(
    name="force-distance",
    function=force_distance,
    motions=MOTIONS,
    observables=observables(*RAMPED),
    observe=observe_ramp,
    figure=Layout((("tip_height", "force"),), cropped=False),
    other_names="forcecurve fd indentation",
)
