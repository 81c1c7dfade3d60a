"""Amplitude modulation: the heights that go with an amplitude, and which of them a lever takes.

Rajabifar et al. 2021, equations (29) to (32), and their general form off resonance.
"""

import json
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.callers import warn_caller
from softafm.checks.gathering import Placed, collect_warnings, gather
from softafm.checks.validate import check_positive, check_tolerance
from softafm.contact import Contact
from softafm.errors import AccuracyWarning, DivergedError
from softafm.instrument.cantilever import Cantilever
from softafm.instrument.motions import Sine
from softafm.instrument.oscillator import Drive
from softafm.modes.amplitude_curve import BRANCHES, AmplitudeCurve, Solutions
from softafm.modes.audit import Audit, audit, write_audits
from softafm.modes.confirm import Confirmed, confirm_solutions, solve_amplitudes
from softafm.modes.driven import (
    AmplitudeSweep,
    doubt_sine,
    estimate_deepest_tap,
    make_drive,
    ratios_of,
    refuse_gain,
    refuse_unsteady,
)
from softafm.modes.lever_sweep import sweep_lever
from softafm.modes.mode import Mode
from softafm.modes.parts import Axes, Foreseen, Inputs, Outcome, Row, Settings
from softafm.modes.perform import perform
from softafm.modes.regularise import Regularise
from softafm.modes.scales import Scales, tap_scales
from softafm.modes.start import choose_solver, refuse_tapped_flow
from softafm.modes.tap_map import OBSERVABLES, TapMap
from softafm.modes.tapping import observe_taps
from softafm.progress import Progress, make_reporter
from softafm.results.content import DIRECTIONS, Labelled, observables
from softafm.solvers.energy import Energy
from softafm.solvers.own import solve
from softafm.solvers.solver import Solver
from softafm.units.quantities import write_quantity

if TYPE_CHECKING:
    from xarray import Dataset

_HEIGHTS = 241
_PRECISE = 0.1
"""Tolerance, in that which is asked for, of taps that tell whether two solutions exist."""
_MOST_STEPS = 10_000
"""Steps of a tap at a tolerance of 1e-2, beyond which it counts as failed."""
_TAPS = 80
"""How many taps an approach curve takes, by experience."""


def approach_curve(
    contact: Contact,
    cantilever: Cantilever,
    free_amplitude: float,
    amplitude_ratio: ArrayLike,
    *,
    drive_frequency: float | None = None,
    solver: Solver | None = None,
    tolerance: float = 1e-2,
    progress: bool | Progress | None = None,
    check: bool = False,
    regularise: Regularise = "auto",
) -> "Dataset":
    """Heights of a tapping lever for given amplitudes, and what it records on approach and retract.

    The tip oscillates about the mean height Z with amplitude A, in a steady cycle each, and the
    drive stays what it is. Where several heights belong to one amplitude all are found, and which
    of them attract follows from the slow drift of amplitude and phase
    (``softafm.instrument.oscillator``).

    Parameters
    ----------
    contact
        Tip, sample and surface law.
    cantilever
        With quality factor and frequency.
    free_amplitude
        Amplitude A0 away from the sample, m.
    amplitude_ratio
        Amplitudes A/A0, each between 0 and 1, shape (n,).
    drive_frequency
        Frequency of the drive, Hz; that of the cantilever by default.
    solver, tolerance, progress, check, regularise
        As for ``force_distance``.

    Returns
    -------
    xarray.Dataset
        Over (``branch``, ``amplitude_ratio``), branch in attractive, unstable and repulsive, NaN
        where there is no solution (of two stable ones the farther is attractive; one alone is if
        its phase is above 90°):
        ``mean_height`` Z, ``phase`` (degrees behind the drive), ``virial``, ``dissipation``,
        ``force_mean``, ``force_max``, ``force_min``, ``contact_time``, ``indentation``. Over
        ``sweep_height``, what an instrument records while Z comes down (``approach_...``) and goes
        up again (``retract_...``): ``amplitude``, ``phase`` and the same observables; NaN where
        the amplitude leaves the range of ``amplitude_ratio``. The retract starts from the last
        height at which the approach is known. All SI but the phase.

    Raises
    ------
    ValueError
        If an argument is out of range or the cantilever lacks quality factor or frequency.
    DivergedError
        If the solver cannot continue.
    """
    return perform(
        MODE, contact, AmplitudeSweep(free_amplitude, amplitude_ratio, drive_frequency), cantilever,
        solver=solver, tolerance=tolerance, progress=progress, check=check, regularise=regularise,
    )  # fmt: skip


def _simulate(inputs: Inputs, settings: Settings) -> Outcome:
    """Sample taps, and find the solutions and the sweep of the height on them."""
    contact, sweep = inputs.contact, inputs.motion
    tolerance, solver = check_tolerance(settings.tolerance), choose_solver(settings.solver)
    refuse_tapped_flow(contact)
    ratios = ratios_of(sweep.amplitude_ratio)
    free_amplitude = check_positive("free_amplitude", sweep.free_amplitude, "m")
    drive, frequency = make_drive(inputs.cantilever, free_amplitude, sweep.drive_frequency)

    bounded = _bound_steps(solver, tolerance)
    doubts: list[Placed] = []
    audits: dict[tuple[float, float], Audit | None] = {}

    def tap(amplitude: float, approach: float, tolerance: float = tolerance) -> np.ndarray:
        warned: list[AccuracyWarning] = []
        place = amplitude, approach
        try:
            with collect_warnings(warned):
                motion = Sine(amplitude + approach, amplitude, frequency, "steady")
                history = solve(bounded, contact, motion, tolerance=tolerance)
            found = audit(contact, history, tolerance)
            refuse_unsteady(warned)
            refuse_gain(found.energies, drive, amplitude, tolerance)
        except DivergedError as error:
            audits[place] = None
            doubts.append((place, AccuracyWarning(f"a tap has no result: {error}")))
            raise
        audits[place] = found
        doubts.extend((place, warning) for warning in (*warned, *found.problems))
        values = observe_taps(contact, motion, history)
        return np.array([values[name] for name in OBSERVABLES])

    taps = TapMap(
        tap, drive, ratios.min() * free_amplitude, ratios.max() * free_amplitude,
        contact.reach, tolerance,
    )  # fmt: skip
    with make_reporter(settings.progress) as report:
        for done in taps.explore():
            if report is not None:
                report(1 - np.exp(-done / 80), f"{done} taps")
    curve = AmplitudeCurve(taps, drive)
    found, grazing = solve_amplitudes(
        curve, ratios * free_amplitude,
        partial(tap, tolerance=max(_PRECISE * tolerance, 1e-5)), contact.reach, tolerance,
    )  # fmt: skip
    heights = found.amplitude + found.approach
    if heights.size:
        heights = np.linspace(heights.max(), heights.min(), _HEIGHTS)
    confirmed = confirm_solutions(found, taps, tap, drive, tolerance)
    found = found._replace(
        approach=confirmed.approach, phase=drive.phase(found.amplitude, *confirmed.observables[:2])
    )
    decisive = _find_decisive(taps, found, audits)
    doubts = [each for each in doubts if each[0] in decisive]
    warned = [
        *gather(doubts, len(decisive), "decisive taps", _describe_place),
        *gather(grazing, ratios.size, "amplitudes", _describe_place),
        *_collect_warnings(drive, taps, found, confirmed),
    ]
    for warning in warned:
        warn_caller(warning)
    motion = {
        "kind": "approach-curve",
        "free_amplitude": free_amplitude,
        "amplitude_ratio": ratios.tolist(),
        "drive_frequency": frequency,
    }
    parts = {**inputs.parts, "motion": motion}
    data, coordinates = _tabulate(ratios, found, confirmed.observables)
    coordinates["sweep_height"] = ("sweep_height", heights)
    names = ("amplitude", "phase", *OBSERVABLES)
    for direction, swept in zip(DIRECTIONS, sweep_lever(curve, heights), strict=True):
        for name, row in zip(names, swept, strict=True):
            data[f"{direction}_{name}"] = ("sweep_height", row)
    return Outcome(
        parts, solver, tolerance, data, coordinates, tuple(warned), {"taps": len(audits)},
        write_audits([each for place in decisive if (each := audits.get(place)) is not None]),
    )  # fmt: skip


def _bound_steps(solver: Solver, tolerance: float) -> Solver:
    """Return a solver that gives up on taps that take far more steps than others."""
    if not isinstance(solver, Energy):
        return solver
    most = int(_MOST_STEPS * max(1e-2 / tolerance, 1.0) ** 0.5)
    return replace(solver, most_steps=min(solver.most_steps, most))


def _find_decisive(
    taps: TapMap, found: Solutions, tapped: Iterable[tuple[float, float]]
) -> set[tuple[float, float]]:
    """Return amplitudes and closest approaches of the taps that solutions rest on.

    These are the taps next to them on the map and those that confirm them; all if there is none.
    """
    mapped = {(line.amplitude, each) for line in taps.lines for each in line.tried}
    places = zip(found.amplitude.tolist(), found.approach.tolist(), strict=True)
    near = {each for place in places for each in taps.find_support(*place)}
    return near | (set(tapped) - mapped) if near else mapped


def _describe_place(tap: tuple[float, float]) -> str:
    amplitude, approach = tap
    height = write_quantity(amplitude + approach, "m")
    return f"amplitude {write_quantity(amplitude, 'm')} and mean height {height}"


def _collect_warnings(
    drive: Drive, taps: TapMap, found: Solutions, confirmed: Confirmed
) -> Iterator[AccuracyWarning]:
    """Yield warnings of solutions that are missing, too many, or do not hold when they are run."""
    cut = [line for line in taps.lines if line.cut]
    if cut:
        highest = max(cut, key=lambda line: line.nearest)
        yield AccuracyWarning(
            f"{len(cut)} of {len(taps.lines)} amplitudes have no taps below a height, the first of "
            f"{write_quantity(highest.amplitude, 'm')} below "
            f"{write_quantity(highest.amplitude + highest.nearest, 'm')}, where the drive could go "
            f"on: solutions may be missing; {next(iter(highest.failures.values()))}"
        )
    if found.amplitude.size == 0:
        yield AccuracyWarning("no height goes with any of the amplitudes: there is nothing to plot")
        return
    doubtful = doubt_sine(drive, found.amplitude, *confirmed.observables[:2])
    if doubtful is not None:
        yield doubtful
    yield from gather(
        confirmed.wrong, confirmed.solutions, "solutions that were run", _describe_place
    )
    labels = list(zip(found.row, found.branch, strict=True))
    for branch in ("attractive", "repulsive"):
        if any(labels.count((row, branch)) > 1 for row in set(found.row)):
            yield AccuracyWarning(
                f"one amplitude has several stable {branch} solutions: mean_height holds the "
                "farthest, approach_... and retract_... take all into account"
            )


def _tabulate(
    ratios: np.ndarray, found: Solutions, values: np.ndarray
) -> tuple[dict[str, Labelled], dict[str, Labelled]]:
    """Return the solutions, of observables (7, n), as variables and coordinates of the dataset."""
    names = ("mean_height", "phase", *OBSERVABLES)
    table = np.full((len(names), len(BRANCHES), ratios.size), np.nan)
    columns = np.vstack([found.amplitude + found.approach, found.phase, values])
    branch = found.branch
    for i in np.argsort(found.approach):  # the farthest last
        table[:, BRANCHES.index(branch[i]), found.row[i]] = columns[:, i]
    data: dict[str, Labelled] = {
        name: (("branch", "amplitude_ratio"), values)
        for name, values in zip(names, table, strict=True)
    }
    coordinates: dict[str, Labelled] = {
        "branch": ("branch", list(BRANCHES)),
        "amplitude_ratio": ("amplitude_ratio", ratios),
    }
    return data, coordinates


def _scale(inputs: Inputs, result: "Dataset") -> Scales:
    """Return the scales of taps of all amplitudes; heights count by the reach of the contact."""
    contact, sweep = inputs.contact, inputs.motion
    amplitudes = ratios_of(sweep.amplitude_ratio) * sweep.free_amplitude
    frequency = json.loads(result.attrs["experiment"])["motion"]["drive_frequency"]
    scales = tap_scales(contact, amplitudes, frequency, result)
    return replace(scales, fixed={**scales.fixed, "mean_height": contact.reach})


def _foresee(inputs: Inputs) -> Foreseen:
    """Return the tap that goes deepest, and what drives the lever and can be fed by that."""
    contact, sweep = inputs.contact, inputs.motion
    drive, frequency = make_drive(inputs.cantilever, sweep.free_amplitude, sweep.drive_frequency)
    amplitudes = sweep.free_amplitude * np.array(sweep.amplitude_ratio)
    words = f"driven at {drive.detuning:.4g} of the resonance, Q = {drive.quality_factor:.4g}"
    most = write_quantity(drive.most_dissipation, "J")
    rows = (
        Row("lever stiffness", write_quantity(drive.stiffness, "N/m"), ""),
        Row("free amplitude", write_quantity(drive.free_amplitude, "m"), words),
        Row("force of the drive", write_quantity(drive.force, "N"), "amplitude, on the tip"),
        Row("largest dissipation", most, "that the drive can feed, a cycle"),
    )
    deepest = estimate_deepest_tap(contact, drive, frequency, amplitudes)
    return Foreseen(deepest, _TAPS, "tap", "of a tap: Hertz against the drive", rows)


MODE = Mode(
    name="approach-curve",
    function=approach_curve,
    motions={"sine": AmplitudeSweep},
    observables={
        **observables("mean_height", "phase", *OBSERVABLES, over=("branch", "amplitude_ratio")),
        **{
            name: each
            for direction in DIRECTIONS
            for name, each in observables(
                *(f"{direction}_{name}" for name in ("amplitude", "phase", *OBSERVABLES)),
                over=("sweep_height",),
            ).items()
        },
    },
    simulate=_simulate,
    lever="resonator",
    steady=True,
    scales=_scale,
    foresee=_foresee,
    axes=Axes(
        ("branch", "amplitude_ratio"),
        lambda sweep: (BRANCHES, sweep.amplitude_ratio),
        ("amplitude_ratio", "first_ratio", "last_ratio", "points"),
    ),
    diagnostics=("solver_taps",),
    inputs={"free_amplitude": "m"},
    gaps=True,
    other_names="apd amplitudecurve dynamicspectroscopy",
)
