"""Peak force tapping: the base swings far below resonance, and the lever rings."""

from collections.abc import Iterator
from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np

from softafm.checks.callers import warn_caller
from softafm.checks.validate import check_finite, check_positive, check_tolerance, check_whole
from softafm.compiled.announce import announce_compilation
from softafm.contact import Contact
from softafm.errors import AccuracyWarning
from softafm.instrument.cantilever import Cantilever
from softafm.instrument.motions import Sine
from softafm.instrument.resonator import Resonator, shake
from softafm.modes.mode import Mode
from softafm.modes.parts import Foreseen, Inputs, Layout, Outcome, Row, Settings
from softafm.modes.perform import perform
from softafm.modes.regularise import Regularise
from softafm.modes.start import refuse_start_inside
from softafm.modes.swings import choose_energy, pass_all
from softafm.progress import Progress
from softafm.results.content import Labelled, observables
from softafm.solvers.energy import Energy
from softafm.solvers.solver import Solver
from softafm.units.quantities import FORCE, FREQUENCY, LENGTH, write_quantity

if TYPE_CHECKING:
    from xarray import Dataset

    from softafm.solvers.energy.swinging import Swinging

_MOST_PERIODS = 10_000
_PART = 0.1
"""Bend of the lever to which a peak force is held, in tolerances of that by the force."""
_SLOW = 0.2
"""Frequency of the base, in that of the first eigenmode, up to which the tip follows it."""
_PER_PERIOD = ("force_max", "force_min", "force_mean", "dissipation", "viscous_loss", "jump_loss")
_OF_LEVER = ("drive_work", "damping", "mean_deflection")
_OVER_TIME = ("base_height", "deflection", "apparent_force")
_HISTORY = ("tip_height", "force", "contact_radius", "axis_deformation", "viscous_power")


@dataclass(frozen=True)
class PeakForce:
    """What ``peak_force_tapping`` takes besides contact and cantilever.

    Parameters
    ----------
    amplitude
        Amplitude of the base.
    frequency
        Frequency of the base, far below the resonance.
    mean_height
        Mean height of the base: of the tip on an unbent lever; or else
    peak_force
        the largest force of a period, which a feedback is to keep by the mean height.
    periods
        Number of periods.
    """

    kind: ClassVar[str] = "peak-force"
    amplitude: Annotated[float, LENGTH]
    frequency: Annotated[float, FREQUENCY]
    mean_height: Annotated[float, LENGTH] | None = None
    peak_force: Annotated[float, FORCE] | None = None
    periods: int = 3


def peak_force_tapping(
    contact: Contact,
    cantilever: Cantilever,
    amplitude: float,
    frequency: float,
    mean_height: float | None = None,
    peak_force: float | None = None,
    periods: int = 3,
    *,
    solver: Solver | None = None,
    tolerance: float = 1e-2,
    progress: bool | Progress | None = None,
    check: bool = False,
    regularise: Regularise = "auto",
) -> "Dataset":
    """Periods of a base that swings far below resonance, Z = mean_height + amplitude·cos(2πft).

    The lever moves with its inertia: it overshoots as the tip snaps in, and rings after pull-off.
    It begins at rest at the top, above a surface flat at first.

    Parameters
    ----------
    contact
        Tip, sample and surface law.
    cantilever
        With quality factor and frequency, and perhaps ``higher_modes``.
    amplitude, frequency
        Those of the base, m and Hz; at most a fifth of the resonance frequency.
    mean_height
        Mean height of the base, m; leave it out for a peak force.
    peak_force
        Largest force of the last period, N, which the mean height is found for.
    periods
        Number of periods.
    solver, tolerance, progress, check, regularise
        As for ``tapping_transient``.

    Returns
    -------
    xarray.Dataset
        Over ``time``: ``force``, ``tip_height``, ``base_height``, ``deflection``,
        ``apparent_force`` (stiffness times deflection, which an instrument takes for the force),
        ``contact_radius``, ``axis_deformation`` and ``viscous_power``. Over ``cycle``, the period:
        ``force_max``, ``force_min``, ``force_mean``, ``dissipation`` (−∮F dh0), ``viscous_loss``
        and ``jump_loss`` in the sample, ``drive_work`` of the base, ``damping`` in the lever and
        ``mean_deflection``. Further ``mean_height``, and ``jump_time`` and ``jump_energy``.

    Raises
    ------
    ValueError
        If an argument is out of range, neither or both of mean height and peak force are given, or
        the peak force is not reached by a base that starts above the surface.
    DivergedError
        If the solver cannot continue.
    """
    motion = PeakForce(amplitude, frequency, mean_height, peak_force, periods)
    return perform(
        MODE, contact, motion, cantilever, solver=solver, tolerance=tolerance, progress=progress,
        check=check, regularise=regularise,
    )  # fmt: skip


class _Swung:
    """Runs of one contact and lever whose base swings about one height or another."""

    def __init__(self, solver: Energy, inputs: Inputs, tolerance: float):
        motion = inputs.motion
        self.solver, self.contact, self.tolerance = solver, inputs.contact, tolerance
        self.amplitude = check_positive("amplitude", motion.amplitude, "m")
        self.frequency = check_positive("frequency", motion.frequency, "Hz")
        self.periods = check_whole("periods", motion.periods, 1, _MOST_PERIODS)
        modes = inputs.cantilever.eigenmodes
        slowest = _SLOW * modes[0].frequency
        if self.frequency > slowest:
            raise ValueError(
                f"frequency = {self.frequency:g} Hz: must be at most {slowest:g} Hz, a fifth of "
                "the resonance frequency; tapping_transient drives levers near resonance"
            )
        swing = shake(Resonator(modes), self.frequency, self.amplitude)
        self.lever = Resonator(modes, (swing,), True)

    def run(self, mean_height: float, periods: int) -> "tuple[Swinging, Iterator[int]]":
        """Return a run, and what carries it from period to period."""
        from softafm.solvers.energy.swinging import Swinging

        base = Sine(mean_height, self.amplitude, self.frequency, periods)
        refuse_start_inside(self.contact, base)
        likeness = Sine(mean_height, self.amplitude, self.frequency, "steady")
        run = Swinging(self.solver, self.contact, self.lever, base, likeness, self.tolerance)
        ends = np.arange(1, periods + 1) / self.frequency
        return run, run.pass_cycles(ends, 0)

    def find_height(self, force: float) -> float:
        """Return the mean height at which the last of two periods has this peak force, m."""
        from scipy.optimize import brentq

        stiffness = 1 / sum(1 / mode.stiffness for mode in self.lever.modes)
        lowest = 1.001 * self.contact.edge_gap - self.amplitude
        found: dict[float, float] = {}

        def miss(height: float) -> float:
            if height not in found:
                run, periods = self.run(height, min(self.periods, 2))
                for _ in periods:
                    pass
                found[height] = float(run.observe()["force_max"][-1]) - force
            return found[height]

        high, down = self.amplitude + self.contact.reach, force / stiffness
        while miss(low := max(high - 2 * down, lowest)) < 0 and low > lowest:
            down *= 2
        if not miss(low) >= 0 > miss(high):
            raise ValueError(
                f"peak_force = {force:g} N: is not reached; mean heights from {low:.4g} m, the "
                f"lowest tried, give at most {force + miss(low):.3g} N; take a larger amplitude, a "
                "stiffer lever or another peak force"
            )
        return float(brentq(miss, low, high, xtol=_PART * self.tolerance * force / stiffness))


def _simulate(inputs: Inputs, settings: Settings) -> Outcome:
    """Find the mean height, and carry surface and lever from period to period."""
    tolerance, solver = check_tolerance(settings.tolerance), choose_energy(settings.solver)
    given = inputs.motion
    if (given.mean_height is None) == (given.peak_force is None):
        raise ValueError("mean_height, peak_force: give one of them, and leave the other out")
    swung = _Swung(solver, inputs, tolerance)
    started = perf_counter()
    with announce_compilation("a lever with inertia"):
        if given.peak_force is None:
            height = check_finite("mean_height", given.mean_height, "m")
        else:
            height = swung.find_height(check_positive("peak_force", given.peak_force, "N"))
        run, passing = swung.run(height, swung.periods)
        values, warned = pass_all(run, passing, swung.periods, "period", settings)
    if given.peak_force is not None:
        warned += _doubt_peak(values["force_max"], given.peak_force, tolerance)
    data, coordinates = _tabulate(values, run, height)
    diagnostics = {"attempted_steps": run.tries, "wall_time": perf_counter() - started}
    return Outcome(inputs.parts, solver, tolerance, data, coordinates, warned, diagnostics)


def _doubt_peak(
    reached: np.ndarray, wanted: float, tolerance: float
) -> tuple[AccuracyWarning, ...]:
    """Return what to warn of where the last peak is not the one that the height was found for."""
    off = abs(float(reached[-1]) / wanted - 1)
    if off <= tolerance:
        return ()
    warning = AccuracyWarning(
        f"peak_force: the last period has {write_quantity(float(reached[-1]), 'N')} where "
        f"{write_quantity(wanted, 'N')} were asked for: periods differ, as the lever still rings "
        "when the tip comes down again; take a lower frequency or quality factor",
        off,
    )
    warn_caller(warning)
    return (warning,)


def _tabulate(
    values: dict[str, np.ndarray], run: "Swinging", height: float
) -> tuple[dict[str, Labelled], dict[str, Labelled]]:
    """Return what is observed of the periods done, as variables and coordinates."""
    curves = run.collect_curves()
    assert curves is not None
    time = curves.pop("time")
    stiffness = 1 / sum(1 / mode.stiffness for mode in run.resonator.modes)
    curves["base_height"] = curves["tip_height"] - curves["deflection"]
    curves["apparent_force"] = stiffness * curves["deflection"]
    data: dict[str, Labelled] = {name: (("time",), curves[name]) for name in curves}
    data |= {name: (("cycle",), values[name]) for name in (*_PER_PERIOD, *_OF_LEVER)}
    jumps, energies = run.collect_jumps()
    data |= {"jump_time": (("jump",), jumps), "jump_energy": (("jump",), energies)}
    data["mean_height"] = ((), height)
    return data, {"time": ("time", time)}


def _foresee(inputs: Inputs) -> Foreseen:
    """Return the swing of the base, and how the lever rings."""
    motion, first = inputs.motion, inputs.cantilever.eigenmodes[0]
    height, depth = motion.mean_height, ""
    if height is None:
        height = motion.amplitude - (motion.peak_force or 0.0) / first.stiffness
        depth = "of the base, where the lever bends by the peak force"
    ringing = first.quality_factor / (np.pi * first.frequency)
    share = f"{ringing * motion.frequency:.2g} of the period; of its amplitude after pull-off"
    rows = (
        Row("periods of the lever", f"{first.frequency / motion.frequency:.4g}", "in one"),
        Row("memory of the lever", write_quantity(ringing, "s"), share),
    )
    base = Sine(height, motion.amplitude, motion.frequency, 1)
    return Foreseen(base, motion.periods, "period", depth, rows)


MODE = Mode(
    name="peak-force",
    function=peak_force_tapping,
    motions={"peak-force": PeakForce},
    observables={
        **observables(*_HISTORY, *_OVER_TIME, over=("time",)),
        **observables(*_PER_PERIOD, *_OF_LEVER, over=("cycle",)),
        **observables("jump_time", "jump_energy", over=("jump",)),
        **observables("mean_height"),
    },
    simulate=_simulate,
    lever="resonator",
    foresee=_foresee,
    figure=Layout(
        panels=(("time", "force"), ("time", "deflection"), ("base_height", "apparent_force")),
    ),
    diagnostics=("solver_attempted_steps",),
    other_names="peakforce pft peakforcetapping pulsedforce jumping",
)
