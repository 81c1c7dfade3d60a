"""Tapping: the tip oscillates with given amplitude about a given mean height."""

from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from softafm.contact import Contact
from softafm.instrument.motions import Sine
from softafm.modes.mode import Mode
from softafm.modes.parts import Layout
from softafm.modes.perform import perform
from softafm.modes.regularise import Regularise
from softafm.modes.scales import tap_scales
from softafm.progress import Progress
from softafm.results.content import observables
from softafm.solvers.history import History
from softafm.solvers.solver import Solver

if TYPE_CHECKING:
    from xarray import Dataset


def tapping_cycle(
    contact: Contact,
    amplitude: float,
    mean_height: float,
    frequency: float,
    cycles: int | Literal["steady"] = "steady",
    *,
    solver: Solver | None = None,
    tolerance: float = 1e-2,
    profiles: bool = False,
    progress: bool | Progress | None = None,
    check: bool = False,
    regularise: Regularise = "auto",
) -> "Dataset":
    """Cycles of h0 = mean_height + amplitude·cos(2πft) from the top, the surface flat at first.

    Parameters
    ----------
    contact
        Tip, sample and surface law.
    amplitude, mean_height
        Amplitude and mean height of the tip, m.
    frequency
        Frequency f, Hz.
    cycles
        Number of cycles from a surface flat and relaxed, or ``"steady"``: cycles repeat, with the
        sample's memory accelerated towards a periodic one, until it ends a cycle as it began it.
    solver, tolerance, profiles, progress, check, regularise
        As for ``force_distance``.

    Returns
    -------
    xarray.Dataset
        The curves of ``force_distance`` over all cycles, or the steady one; ``cycles_run`` says how
        many it took. Scalars of the last cycle: ``virial`` (mean of F·(h0 − mean height); Rajabifar
        et al. 2021, equation 30), ``dissipation`` (−∮F dh0, equation 29), ``force_max``,
        ``force_min``, ``force_min_approach``, ``force_mean``, ``contact_time``, ``indentation``;
        ``cycle_virial`` and ``cycle_dissipation`` of every cycle. All SI.

    Raises
    ------
    ValueError
        If the tip starts inside the surface or an argument is out of range.
    DivergedError
        If the solver cannot continue.
    """
    return perform(
        MODE, contact, Sine(mean_height, amplitude, frequency, cycles), solver=solver,
        tolerance=tolerance, profiles=profiles, progress=progress, check=check,
        regularise=regularise,
    )  # fmt: skip


def observe_taps(contact: Contact, motion: Sine, history: History) -> dict[str, Any]:
    """Return the scalars of the last cycle, and virial and dissipation of each."""
    period = 1 / motion.frequency
    tops = period * np.arange(motion.periods + 1)

    force = history.force

    def weigh(time: np.ndarray) -> np.ndarray:
        return (motion.height(time) - motion.mean_height) / period

    virial = np.array([history.integrate(force, weigh, a, b) for a, b in pairwise(tops)])
    dissipation = np.array([history.energies(a, b).best for a, b in pairwise(tops)])
    start, stop = tops[-2], tops[-1]
    last = history.time >= start
    axis_gap = history.tip_height - history.axis_deformation
    return {
        "virial": virial[-1],
        "dissipation": dissipation[-1],
        "cycles_run": history.diagnostics.get("cycles", motion.periods),
        "cycle_virial": virial,
        "cycle_dissipation": dissipation,
        "force_max": history.extreme(force, 1, start),
        "force_min": history.extreme(force, -1, start),
        "force_min_approach": history.extreme(force, -1, start, start + period / 2),
        "force_mean": history.integrate(force, np.ones_like, start, stop) / period,
        "contact_time": measure_time_below(history.time[last], axis_gap[last], contact.edge_gap),
        "indentation": max(0.0, -history.axis_deformation[last].min()),
        "viscous_loss": history.energies(start, stop).viscous,
    }


def measure_time_below(time: np.ndarray, values: np.ndarray, level: float) -> float:
    """Time during which ``values``, linear between instants, stay below ``level``."""
    below = values < level
    a, b = values[:-1], values[1:]
    crossing = below[:-1] != below[1:]
    part = np.where(crossing, (level - a) / np.where(crossing, b - a, 1.0), 0.0)
    share = np.where(below[:-1], np.where(below[1:], 1.0, part), np.where(below[1:], 1 - part, 0.0))
    return float(np.sum(np.diff(time) * share))


MODE = Mode(
    name="tapping-cycle",
    function=tapping_cycle,
    motions={"sine": Sine},
    observables={
        **observables("virial", "dissipation", "force_max", "force_min", "force_min_approach"),
        **observables("force_mean", "contact_time", "indentation", "viscous_loss", "cycles_run"),
        **observables("cycle_virial", "cycle_dissipation", over=("cycle",)),
    },
    observe=observe_taps,
    scales=lambda given, result: tap_scales(
        given.contact, given.motion.amplitude, given.motion.frequency, result
    ),
    figure=Layout(
        title=(
            ("virial", "virial"),
            ("dissipation", "dissipation"),
            ("force_max", "peak force"),
        )
    ),
    other_names="tapping am amplitudemodulation",
)
