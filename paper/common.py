"""What the scripts of the paper's study share: its samples, runs that may fail, tables and figures.

Rajabifar et al. 2021 is "the paper"; its setups A to G are those of its Table 2.
"""

import csv
import json
import warnings
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import numpy as np
import rich
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image
from rich.box import SIMPLE_HEAD
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

import softafm as sa
from softafm import solvers
from softafm.draw.results import COLOURS
from softafm.units.quantities import write_quantity

ROOT = Path(__file__).parents[1]
OUTPUT = ROOT / "paper-output"

SETUP_COLOURS = dict(zip("CDEFGBA", (*COLOURS[:5], COLOURS[6], COLOURS[5]), strict=True))
"""One colour a setup, the same in all figures."""

LDPE = sa.Contact(
    sa.Paraboloid(radius=10e-9),
    sa.StandardLinearSolid(E0=2e9, E_inf=0.1e9, creep_time=1e-7, poisson=0.49),
    sa.LennardJones(hamaker=1e-19, z0=0.25e-9),
)
"""The paper's polyethylene (its Table 1)."""

DEEP_TAP = sa.Sine(mean_height=42.82e-9, amplitude=49.6e-9, frequency=278e3, cycles=1)
"""A tap at A0 = 62 nm and setpoint 0.8, as in the paper's Figs. 5 to 7; it crosses a fold."""

END = {"marker": "X", "markersize": 8, "markeredgecolor": "white", "linestyle": "none"}
END_ENTRY = Line2D([], [], color="0.2", label="stopped", **END)
"""Mark in figures, and its entry in a legend, of where a run stopped."""

DOMAIN = 12e-9
"""Radius of the computational domain of that tap, m."""


class TapCase(NamedTuple):
    """A tap of the tests' reference cases and its converged observables."""

    contact: sa.Contact
    motion: sa.Sine
    converged: dict[str, float]


def tap_case(name: str) -> TapCase:
    """Look up one cycle of tapping in ``tests/data/cases.json``."""
    cases = json.loads((ROOT / "tests" / "data" / "cases.json").read_text(encoding="utf-8"))
    case = next(case for case in cases if case["name"] == name)
    given = case["inputs"]
    contact = sa.Contact(
        sa.Paraboloid(given["radius"]),
        sa.StandardLinearSolid(given["E0"], given["E_inf"], given["tau"], given["poisson"]),
        sa.LennardJones(given["hamaker"], given["z0"]),
    )
    motion = sa.Sine(given["mean_height"], given["amplitude"], given["frequency"], cycles=1)
    return TapCase(contact, motion, {k: v["value"] for k, v in case["expected"].items()})


def setup(letter: str, **options):
    """The solver of one of the setups A to G, with two-step Adams-Bashforth by default."""
    options = {"stepper": solvers.AdamsBashforth(2), **options}
    if letter in "AB":
        return solvers.Attard(method="iterative" if letter == "A" else "explicit", **options)
    return solvers.EnhancedAttard(
        basis="bessel" if letter == "G" else "cosine",
        expand="gap" if letter in "DF" else "deformation",
        orthogonal=letter in "EFG",
        **options,
    )


@dataclass(frozen=True)
class Outcome:
    """A run to its end or to where it stopped: curves in SI, observables by name."""

    time: np.ndarray
    tip_height: np.ndarray
    force: np.ndarray
    observables: dict[str, float]
    seconds: float
    ending: str
    """``"completed"``, or why and where it stopped."""
    warned: bool
    attributes: dict = field(default_factory=dict)
    """Attributes of the result, such as ``solver_steps``; none of a run that stopped."""
    jump_time: np.ndarray = field(default_factory=lambda: np.empty(0))
    jump_energy: np.ndarray = field(default_factory=lambda: np.empty(0))

    @property
    def completed(self) -> bool:
        return self.ending == "completed"

    def error(self, name: str, converged: dict[str, float]) -> float:
        """Deviation of an observable in per cent; NaN of a run that stopped."""
        return 100 * (self.observables.get(name, np.nan) / converged[name] - 1)


def attempt(run: Callable) -> Outcome:
    """Run a mode of softafm; a solver that diverges leaves the curves up to there."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", sa.AccuracyWarning)
        started = perf_counter()
        try:
            result = run()
        except sa.DivergedError as error:
            past = error.history
            last = past.time[-1] if past.time.size else 0.0
            why = "no convergence" if "converge" in str(error) else "blew up"
            return Outcome(
                past.time, past.tip_height, past.force, {}, perf_counter() - started,
                f"{why} at {write_quantity(last, 's')}", bool(caught),
            )  # fmt: skip
        seconds = perf_counter() - started
    scalars = {str(name): float(v) for name, v in result.data_vars.items() if v.ndim == 0}
    return Outcome(
        result["time"].values, result["tip_height"].values, result["force"].values,
        scalars, seconds, "completed", bool(caught), dict(result.attrs),
        result["jump_time"].values, result["jump_energy"].values,
    )  # fmt: skip


def tap(contact: sa.Contact, motion: sa.Sine, solver=None, **options) -> Outcome:
    """Taps, as many as the motion has."""
    at = motion.amplitude, motion.mean_height, motion.frequency, motion.cycles
    return attempt(lambda: sa.tapping_cycle(contact, *at, solver=solver, **options))


def converged_tap(contact: sa.Contact, motion: sa.Sine) -> dict[str, float]:
    """Observables of a tap from the default solver at a tolerance of 1e-4."""
    return tap(contact, motion, tolerance=1e-4).observables


def force_curve(contact: sa.Contact, motion, solver=None, **options) -> Outcome:
    """One force-distance curve."""
    return attempt(lambda: sa.force_distance(contact, motion, solver=solver, **options))


def spectrum(contact: sa.Contact, stiffness: float, motion, solver=None, **options) -> Outcome:
    """One force curve with a lever."""
    lever = sa.Cantilever(stiffness)
    return attempt(lambda: sa.force_spectroscopy(contact, lever, motion, solver=solver, **options))


def tracked(jobs: Iterable, progress: Callable | None, message: Callable) -> Iterator:
    """Yield jobs, telling the fraction done and ``message(job)`` before each."""
    jobs = list(jobs)
    for done, job in enumerate(jobs):
        if progress is not None:
            progress(done / len(jobs), message(job))
        yield job
    if progress is not None:
        progress(1.0, "done")


def run(*scripts: Callable) -> None:
    """Run the ``main`` of scripts one after the other, with a live bar for each."""
    columns = "{task.fields[name]:16}", BarColumn(30), TimeElapsedColumn(), "{task.description}"
    columns = [TextColumn(c) if isinstance(c, str) else c for c in columns]
    bars = Progress(*columns, refresh_per_second=2)
    with bars:
        for script in scripts:
            bar = bars.add_task("", total=1.0, name=Path(script.__code__.co_filename).stem)
            script(lambda done, doing, bar=bar: bars.update(bar, completed=done, description=doing))
    rich.print(f"Tables and figures are in {OUTPUT}")


def warm_up() -> None:
    """Load or compile the solvers, so that the time of no run includes it."""
    tap(LDPE, DEEP_TAP, tolerance=0.1)
    tap(LDPE, DEEP_TAP, setup("B", steps=10))


def show(title: str, header: Iterable[str], rows: Iterable[Iterable]) -> None:
    """Print a table; floats with three digits."""
    style = {"box": SIMPLE_HEAD, "show_edge": False, "pad_edge": False, "title_justify": "left",
             "padding": (0, 1, 0, 0)}  # fmt: skip
    table = Table(*header, title=title, **style)
    for row in rows:
        table.add_row(*(f"{x:.3g}" if isinstance(x, float) else str(x) for x in row))
    rich.print(table)


def report(name: str, title: str, header: Iterable[str], rows: Iterable[Iterable]) -> None:
    """Write a table to the output folder and print it."""
    rows = list(rows)
    write_csv(name, header, rows)
    show(title, header, rows)


def panels(rows: int, columns: int, height: float, **options) -> tuple[Figure, np.ndarray]:
    """A figure 9 inches wide with a flat array of axes whose ticks point inwards."""
    figure = Figure(figsize=(9.0, height), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False, **options).ravel()
    for ax in axes:
        ax.tick_params(which="both", direction="in", top=True, right=True)
    return figure, axes


def curve(ax, run: Outcome, x: np.ndarray, y: np.ndarray, **style) -> None:
    """Draw a curve of a run, with a cross at its end if the run stopped."""
    ax.plot(x, y, **style)
    if not run.completed:
        ax.plot(x[-1:], y[-1:], color=style["color"], zorder=5, **END)


def zoom(ax, place: tuple, xlim: tuple, ylim: tuple) -> None:
    """Repeat the curves of a panel, magnified, in an inset at ``place`` (panel fractions)."""
    inset = ax.inset_axes(place, xlim=xlim, ylim=ylim)
    inset.tick_params(which="both", direction="in", top=True, right=True, labelsize=8)
    for line in ax.get_lines():
        copy = Line2D(*line.get_data())
        copy.update_from(line)
        size = min(6, line.get_markersize())
        copy.set(transform=inset.transData, clip_path=inset.patch, markersize=size)
        inset.add_line(copy)
    ax.indicate_inset_zoom(inset, edgecolor="0.6")


def write_csv(name: str, header: Iterable[str], rows: Iterable[Iterable]) -> Path:
    """Write a table to the output folder; floats with six digits."""
    OUTPUT.mkdir(exist_ok=True)
    path = OUTPUT / f"{name}.csv"
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(header)
        for row in rows:
            table.writerow(f"{x:.6g}" if isinstance(x, float) else x for x in row)
    return path


def save_figure(figure: Figure, name: str) -> Path:
    """Write a figure, in 64 colours, to the output folder."""
    OUTPUT.mkdir(exist_ok=True)
    path = OUTPUT / f"{name}.png"
    figure.savefig(path, dpi=120, bbox_inches="tight")
    with Image.open(path) as picture:
        small = picture.convert("RGB").quantize(64)
    small.save(path, optimize=True)
    return path
