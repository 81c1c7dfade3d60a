"""What the scripts of the paper's study share: its samples, runs that may fail, tables and figures.

Rajabifar, Wagner and Raman 2021 is "the paper"; its setups A to G are those of its Table 2.
"""

import csv
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np
from matplotlib.figure import Figure

import softafm as sa
from softafm import solvers

OUTPUT = Path(__file__).parents[1] / "paper-output"

LDPE = sa.Contact(
    sa.Paraboloid(radius=10e-9),
    sa.StandardLinearSolid(E0=2e9, E_inf=0.1e9, creep_time=1e-7, poisson=0.49),
    sa.LennardJones(hamaker=1e-19, z0=0.25e-9),
)
"""The paper's polyethylene (its Table 1)."""

DEEP_TAP = sa.Sine(mean_height=42.82e-9, amplitude=49.6e-9, frequency=278e3, cycles=1)
"""A tap at A0 = 62 nm and setpoint 0.8, as in the paper's Figs. 5 to 7; it crosses a fold."""

DOMAIN = 12e-9
"""Radius of the computational domain of that tap, m."""


def setup(letter: str, **options):
    """The solver of one of the setups A to G, with two-step Adams-Bashforth unless told otherwise."""
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

    @property
    def completed(self) -> bool:
        return self.ending == "completed"


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
                f"{why} at {last * 1e6:.3f} us", bool(caught),
            )  # fmt: skip
        seconds = perf_counter() - started
    scalars = {str(name): float(v) for name, v in result.data_vars.items() if v.ndim == 0}
    return Outcome(
        result["time"].values, result["tip_height"].values, result["force"].values,
        scalars, seconds, "completed", bool(caught),
    )  # fmt: skip


def tap(contact: sa.Contact, motion: sa.Sine, solver=None, **options) -> Outcome:
    """One tapping cycle."""
    at = motion.amplitude, motion.mean_height, motion.frequency
    return attempt(lambda: sa.tapping_cycle(contact, *at, solver=solver, **options))


def force_curve(contact: sa.Contact, motion, solver=None, **options) -> Outcome:
    """One force-distance curve."""
    return attempt(lambda: sa.force_distance(contact, motion, solver=solver, **options))


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
    """Write a figure to the output folder."""
    OUTPUT.mkdir(exist_ok=True)
    path = OUTPUT / f"{name}.png"
    figure.savefig(path, dpi=120, bbox_inches="tight")
    return path
