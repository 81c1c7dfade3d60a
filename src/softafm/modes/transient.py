"""Tapping with a lever that moves with its inertia, cycle by cycle from the start."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np

from softafm.checks.refusals import show
from softafm.checks.validate import check_choice, check_finite, check_tolerance, check_whole
from softafm.compiled.announce import announce_compilation
from softafm.contact import Contact
from softafm.instrument.agreement import check_motion
from softafm.instrument.cantilever import Cantilever
from softafm.instrument.drive import Drive
from softafm.instrument.motion import Motion, is_steady
from softafm.instrument.motions import Sine, Still, find_lowest_height
from softafm.instrument.resonator import Resonator, check_drives
from softafm.modes.mode import Mode
from softafm.modes.parts import Axes, Foreseen, Inputs, Layout, Outcome, Row, Settings
from softafm.modes.perform import perform
from softafm.modes.regularise import Regularise
from softafm.modes.scales import Scales, tap_scales
from softafm.modes.start import refuse_start_inside
from softafm.modes.swings import choose_energy, pass_all
from softafm.progress import Progress
from softafm.results.content import Labelled, observables
from softafm.results.datasets import describe
from softafm.solvers.solver import Solver
from softafm.units.quantities import LENGTH, write_quantity

if TYPE_CHECKING:
    from xarray import Dataset

    from softafm.solvers.energy.swinging import Swinging

_CYCLES = 1500
_MOST_CYCLES = 1_000_000
_LEAST_AMPLITUDE = 1e-3
"""Free amplitude, in gaps at which the surfaces touch, below which errors of a step exceed it."""
_FASTEST_BASE = 0.1
"""Speed of the base, in that of the tip, up to which its inertia is nothing to the lever."""
_PER_CYCLE = ("virial", "dissipation", "force_mean", "force_max", "force_min", "viscous_loss")
_OF_LEVER = ("drive_work", "damping", "jump_loss", "mean_deflection", "base_height", "cycle_end")


@dataclass(frozen=True)
class Transient:
    """What ``tapping_transient`` takes besides contact, cantilever and drive.

    Parameters
    ----------
    base
        Height of the base: that of the tip on an unbent lever above the undeformed surface.
    cycles
        Number of cycles of the first drive.
    keep
        Whether the curves over time are kept of the ``"last"`` cycle, of ``"all"`` or of
        ``"none"``.
    start
        Whether the lever starts at ``"rest"`` or is ``"swinging"`` as it does far away.
    """

    kind: ClassVar[str] = "transient"
    base: Annotated[float, LENGTH]
    cycles: int | None = _CYCLES
    keep: Literal["last", "all", "none"] = "last"
    start: Literal["rest", "swinging"] = "rest"


def tapping_transient(
    contact: Contact,
    cantilever: Cantilever,
    drive: Drive | Sequence[Drive],
    base: float | Motion,
    cycles: int | None = None,
    keep: Literal["last", "all", "none"] = "last",
    *,
    start: Literal["rest", "swinging"] = "rest",
    solver: Solver | None = None,
    tolerance: float = 1e-2,
    progress: bool | Progress | None = None,
    check: bool = False,
    regularise: Regularise = "auto",
) -> "Dataset":
    """Cycles of a driven lever that moves with its inertia above a surface flat at first.

    Nothing is assumed of how the tip moves: each eigenmode obeys m q̈ + (mω/Q) q̇ + k q = F + D,
    with the force F of the contact at every instant. The lever finds its amplitude in some Q cycles
    (``softafm.solvers.energy``, ``softafm docs afm``).

    Parameters
    ----------
    contact
        Tip, sample and surface law.
    cantilever
        With quality factor and frequency, and perhaps ``higher_modes``.
    drive
        What drives it, or a list, such as of the two drives of bimodal tapping; the first one sets
        the cycles.
    base
        Height of the base, which is that of the tip on an unbent lever, m; or a slow motion of it,
        such as a ``Triangle``, for what an approach and a retract record. Its own inertia is left
        out.
    cycles
        Number of cycles: 1500 by default, and all that a motion lasts.
    keep
        Whether the curves over time are kept of the ``"last"`` cycle, of ``"all"`` or of
        ``"none"``; one cycle has some 200 instants.
    start
        Whether the lever is at ``"rest"`` at first, or is ``"swinging"`` as it does far away.
    solver
        ``softafm.solvers.Energy``, with other options than by default.
    tolerance, progress, check, regularise
        As for ``force_distance``.

    Returns
    -------
    xarray.Dataset
        Over (``cycle``, ``eigenmode``): ``amplitude`` and ``phase`` (degrees behind the drive's
        force) of each mode at the frequency of the drive that is nearest to it, else of the first.
        Over ``cycle``: ``virial``, ``dissipation`` (−∮F dh0), ``force_mean``, ``force_max``,
        ``force_min``, ``viscous_loss`` and ``jump_loss`` in the sample, ``drive_work``, ``damping``
        (in the lever), ``mean_deflection``, ``base_height`` (at mid-cycle) and ``cycle_end``. Over
        (``cycle``, ``harmonic``): ``harmonic_amplitude`` of the deflection, of the first ten
        harmonics of the first drive. Over ``time``, of the cycles kept: ``tip_height``,
        ``deflection``, ``force``, ``contact_radius``, ``axis_deformation`` and ``viscous_power``.
        All SI but the phase.

        An interrupt (Ctrl-C) ends the run; the cycles so far are returned, with an
        ``AccuracyWarning``.

    Raises
    ------
    ValueError
        If an argument is out of range, the tip starts inside the surface, or the cantilever lacks
        quality factor or frequency.
    DivergedError
        If the solver cannot continue.
    """
    return perform(
        MODE, contact, Transient(base, cycles, keep, start), cantilever,  # type: ignore[arg-type]
        tables={"drive": drive}, solver=solver, tolerance=tolerance, progress=progress, check=check,
        regularise=regularise,
    )  # fmt: skip


def make_lever(inputs: Inputs) -> Resonator:
    """Return the lever of a run; ValueError if it, its drives or its start are none such."""
    modes = inputs.cantilever.eigenmodes
    drives = check_drives(inputs.tables["drive"], modes)
    start = check_choice("start", inputs.motion.start, ("rest", "swinging"))
    least = _LEAST_AMPLITUDE * inputs.contact.edge_gap
    for drive in drives:
        if drive.free_amplitude < least:
            raise ValueError(
                f"free_amplitude = {drive.free_amplitude:g} m: must be at least {least:.2g} m, a "
                "thousandth of the gap at which the surfaces touch"
            )
    return Resonator(modes, drives, start == "swinging")


def make_base(inputs: Inputs, lever: Resonator) -> tuple[Motion, int]:
    """Return the motion of the base, shaken if a drive shakes it, and the number of cycles."""
    given, cycles = inputs.motion.base, inputs.motion.cycles
    if cycles is not None:
        check_whole("cycles", cycles, 1, _MOST_CYCLES)
    frequency = lever.drives[0].frequency
    shaken = [drive for drive in lever.drives if drive.by == "base"]
    if not hasattr(given, "breaks"):
        count = _CYCLES if cycles is None else cycles
        rest = check_finite("base", given, "m")
        base: Motion = Still(rest, count / frequency)
        refuse_start_inside(inputs.contact, base)
        if len(shaken) > 1:
            raise ValueError("drive: only one of several can be by = 'base'")
        if shaken:
            amplitude = lever.find_shaking(shaken[0])
            periods = max(1, round(count * shaken[0].frequency / frequency))
            return Sine(rest, amplitude, shaken[0].frequency, periods), count
        return base, count
    check_motion(given)
    refuse_start_inside(inputs.contact, given)
    if is_steady(given) or shaken:
        what = "repeats itself" if is_steady(given) else "moves besides a drive by = 'base'"
        raise ValueError(
            f"base = {show(given)}: {what}; must be a height in m, or a motion that ends, with "
            "drives by = 'tip'"
        )
    fastest = _FASTEST_BASE * 2 * np.pi * frequency * lever.drives[0].free_amplitude
    if given.top_speed > fastest:
        raise ValueError(
            f"base: moves at up to {given.top_speed:g} m/s; must be slower than {fastest:.2g} m/s, "
            "a tenth of the tip's speed"
        )
    whole = int(float(given.breaks[-1] - given.breaks[0]) * frequency * (1 + 1e-9))
    if whole < 1:
        raise ValueError(f"base: lasts less than a cycle, {1 / frequency:.3g} s; must last longer")
    return given, whole if cycles is None else min(cycles, whole)


def _liken(base: Motion, lever: Resonator) -> Sine:
    """Return the prescribed tap that the cycles are like at most."""
    amplitude = sum(drive.free_amplitude for drive in lever.drives)
    fastest = max(drive.frequency * drive.free_amplitude for drive in lever.drives)
    frequency = lever.drives[0].frequency
    amplitude = max(amplitude, fastest / frequency)
    return Sine(find_lowest_height(base), amplitude, frequency, "steady")


def _simulate(inputs: Inputs, settings: Settings) -> Outcome:
    """Carry surface and lever from cycle to cycle."""
    tolerance, solver = check_tolerance(settings.tolerance), choose_energy(settings.solver)
    keep = check_choice("keep", inputs.motion.keep, ("last", "all", "none"))
    lever = make_lever(inputs)
    base, cycles = make_base(inputs, lever)
    started = perf_counter()
    with announce_compilation("a lever with inertia"):
        from softafm.solvers.energy.swinging import Swinging

        run = Swinging(solver, inputs.contact, lever, base, _liken(base, lever), tolerance)
    first = float(base.breaks[0])
    ends = first + np.arange(1, cycles + 1) / lever.drives[0].frequency
    kept = {"last": cycles - 1, "all": 0, "none": cycles}[keep]
    values, warned = pass_all(run, run.pass_cycles(ends, kept), cycles, "cycle", settings)
    data, coordinates = _tabulate(values, run, base, ends[: run.done])
    motion = {"kind": "transient", "base": _describe(inputs.motion.base), "cycles": run.done}
    motion |= {"keep": keep, "start": inputs.motion.start}
    drives = [describe(drive) for drive in lever.drives]
    drive = drives[0] if len(drives) == 1 else {"kind": "drives", "drives": drives}
    parts = {**inputs.parts, "motion": motion, "drive": drive}
    diagnostics = {"attempted_steps": run.tries, "wall_time": perf_counter() - started}
    return Outcome(parts, solver, tolerance, data, coordinates, warned, diagnostics)


def _describe(base: Any) -> Any:
    """Return the base as results describe it."""
    if not hasattr(base, "breaks"):
        return float(base)
    return describe(base)


def _tabulate(
    values: dict[str, np.ndarray], run: "Swinging", base: Motion, ends: np.ndarray
) -> tuple[dict[str, Labelled], dict[str, Labelled]]:
    """Return the observables, and the curves that were kept, as variables and coordinates."""
    data: dict[str, Labelled] = {}
    over = {"amplitude": "eigenmode", "phase": "eigenmode", "harmonic_amplitude": "harmonic"}
    for name, each in values.items():
        data[name] = (("cycle", over[name]) if name in over else ("cycle",), each)
    data["cycle_end"] = (("cycle",), ends)
    middle = 0.5 * (ends + np.append(base.breaks[0], ends[:-1]))
    data["base_height"] = (("cycle",), np.asarray(base.height(middle)))
    coordinates: dict[str, Labelled] = {
        "eigenmode": ("eigenmode", np.arange(1, values["amplitude"].shape[1] + 1)),
        "harmonic": ("harmonic", np.arange(1, values["harmonic_amplitude"].shape[1] + 1)),
    }
    curves = run.collect_curves()
    if curves is not None:
        coordinates["time"] = ("time", curves.pop("time"))
        data |= {name: (("time",), each) for name, each in curves.items()}
    return data, coordinates


def _scale(inputs: Inputs, result: "Dataset") -> Scales:
    """Return the scales of taps of the free amplitude."""
    drive = check_drives(inputs.tables["drive"], inputs.cantilever.eigenmodes)[0]
    return tap_scales(inputs.contact, drive.free_amplitude, drive.frequency, result)


def _foresee(inputs: Inputs) -> Foreseen:
    """Return the tap that the cycles are like at most, and how long the lever rings."""
    lever = make_lever(inputs)
    base, cycles = make_base(inputs, lever)
    first, drive = lever.modes[0], lever.drives[0]
    ringing = first.quality_factor / (np.pi * first.frequency)
    memory = f"of the amplitude: {ringing * drive.frequency:.3g} cycles of the drive"
    force = float(np.abs(lever.find_forces(drive)).max())
    rows = (
        Row("eigenmodes", str(len(lever.modes)), f"the first of Q = {first.quality_factor:g}"),
        Row("free amplitude", write_quantity(drive.free_amplitude, "m"), f"by the {drive.by}"),
        Row("force of the drive", write_quantity(force, "N"), "amplitude, largest on a mode"),
        Row("memory of the lever", write_quantity(ringing, "s"), memory),
    )
    likened = _liken(base, lever)
    deepest = replace(likened, mean_height=likened.mean_height, cycles=1)
    return Foreseen(deepest, cycles, "cycle", "of the free amplitude; the sample keeps it up", rows)


MODE = Mode(
    name="tapping-transient",
    function=tapping_transient,
    motions={"transient": Transient},
    tables={"drive": Drive},
    observables={
        **observables(*_PER_CYCLE, *_OF_LEVER, over=("cycle",)),
        **observables("amplitude", "phase", over=("cycle", "eigenmode")),
        **observables("harmonic_amplitude", over=("cycle", "harmonic")),
        **observables("eigenmode", over=("eigenmode",)),
        **observables("harmonic", over=("harmonic",)),
    },
    simulate=_simulate,
    lever="resonator",
    scales=_scale,
    foresee=_foresee,
    axes=Axes(
        ("cycle",),
        lambda transient: (np.arange(1, (transient.cycles or _CYCLES) + 1),),
        ("cycles",),
    ),
    figure=Layout(
        panels=(("cycle_end", "amplitude"), ("cycle_end", "phase"), ("cycle_end", "force_max")),
        cropped=False,
    ),
    diagnostics=("solver_attempted_steps",),
    other_names="transient ringing dynamic bimodal inertia amtransient",
)
