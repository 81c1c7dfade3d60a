"""What the benchmarks share: reference cases and their errors, clocks that take turns, tables."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import json
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from rich.console import Console
from rich.table import Table

import softafm as sa
from softafm import solvers

DATA = Path(__file__).parents[1] / "tests" / "data"
REPLACED = {"ps-tap-gap+0.5nm": {"dissipation": 3.62e-21}}
"""Reference numbers computed anew (tests/data/README.md)."""

R, W, Z0 = 100e-9, 0.05, 0.3e-9
"""Tip radius, work of adhesion and equilibrium gap of the contacts of a given Tabor number."""


@cache
def reference_cases() -> dict[str, dict]:
    """Converged results of independent solvers by name (see tests/data/README.md)."""
    cases = json.loads((DATA / "cases.json").read_text(encoding="utf-8"))
    for case in cases:
        for name, value in REPLACED.get(case["name"], {}).items():
            case["expected"][name]["value"] = value
    return {case["name"]: case for case in cases}


def contact_of(inputs: dict) -> sa.Contact:
    """The contact of a reference case, always the same object: it keeps what it has worked out."""
    return _contact(*(inputs[name] for name in _CONTACT))


_CONTACT = "radius", "E0", "E_inf", "tau", "poisson", "hamaker", "z0"


@cache
def _contact(radius, E0, E_inf, creep_time, poisson, hamaker, z0) -> sa.Contact:
    solid = sa.StandardLinearSolid(E0, E_inf, creep_time, poisson)
    return sa.Contact(sa.Paraboloid(radius), solid, sa.LennardJones(hamaker, z0))


def run(case: dict, tolerance: float = 1e-2, solver=None):
    """Run a reference case; returns the dataset."""
    inputs, contact = case["inputs"], contact_of(case["inputs"])
    options = {"tolerance": tolerance, "solver": solver}
    if case["kind"] == "tapping_cycle":
        tap = inputs["amplitude"], inputs["mean_height"], inputs["frequency"]
        return sa.tapping_cycle(contact, *tap, **options)
    motion = sa.Triangle(inputs["start"], inputs["turn"], inputs["speed"])
    if case["kind"] == "force_spectroscopy":
        lever = sa.Cantilever(inputs["stiffness"])
        return sa.force_spectroscopy(contact, lever, motion, **options)
    return sa.force_distance(contact, motion, **options)


def expected(case: dict) -> dict[str, float]:
    """Converged observables of a reference case."""
    return {name: entry["value"] for name, entry in case["expected"].items()}


def errors(case: dict, result, converged) -> dict[str, float]:
    """Deviations in per cent of each observable's scale, by name.

    The scale is the largest |force|, and for energies the larger of the value and |force|·z0, or
    for taps 2 % of |force|·amplitude.
    """
    inputs, found = case["inputs"], {}
    force = max(abs(float(converged["force_max"])), abs(float(converged["force_min"])))
    for name in case["expected"]:
        value, scale = float(converged[name]), force
        if name == "loop_energy":
            scale = max(abs(value), force * inputs["z0"])
        elif not name.startswith("force"):
            scale = max(abs(value), 0.02 * force * inputs["amplitude"])
        found[name] = 100 * (float(result[name]) - value) / scale
    return found


def of_its_value(result, converged, names: Iterable[str]) -> dict[str, float]:
    """Deviations in per cent of the values themselves, by name."""
    return {name: 100 * (float(result[name]) / float(converged[name]) - 1) for name in names}


def worst(found: dict[str, float]) -> float:
    """The largest error, without its sign."""
    return max(map(abs, found.values()))


def describe_worst(found: dict[str, float]) -> str:
    """The largest of errors by name, as text."""
    name, error = max(found.items(), key=lambda pair: abs(pair[1]))
    return f"{error:+.3f} % {name}"


def jkr_like(tabor: float) -> float:
    """Modulus of a sample that gives the tip of radius ``R`` this Tabor number, Pa."""
    return float(np.sqrt(R * W**2 / (tabor * Z0) ** 3))


def elastic_contact(tabor: float) -> sa.Contact:
    """A contact of this Tabor number on an elastic sample."""
    law = sa.LennardJones.from_work_of_adhesion(W, Z0)
    return sa.Contact(sa.Paraboloid(R), sa.Elastic(jkr_like(tabor), 0.0), law)


def soft_contact(tabor: float) -> tuple[sa.Contact, sa.Triangle]:
    """A contact of this relaxed Tabor number, E0/E_inf = 20, and its ramp, as in soft-tabor-30.

    The ramp starts at 1.5 times the height of elastic jump-in, 2.641 μ^(3/7) z0, and turns at a
    depth of (3π²/4)^(1/3) μ z0.
    """
    modulus = jkr_like(tabor)
    solid = sa.StandardLinearSolid(20 * modulus, modulus, 3e-5, 0.0)
    law = sa.LennardJones.from_work_of_adhesion(W, Z0)
    start = 1.5 * 2.641 * tabor ** (3 / 7) * Z0
    turn = -((0.75 * np.pi**2) ** (1 / 3)) * tabor * Z0
    return sa.Contact(sa.Paraboloid(R), solid, law), sa.Triangle(start, turn, 1e-6)


def setup_A(iteration_tolerance: float) -> solvers.Attard:
    """The iterative setup of the paper, its kernel kept as a matrix, its relaxation chosen anew."""
    return solvers.Attard(
        nodes=70, domain=12e-9, steps=10_000, stepper=solvers.AdamsBashforth(2),
        iteration_tolerance=iteration_tolerance,
    )  # fmt: skip


def setup_E() -> solvers.EnhancedAttard:
    """The setup that the paper recommends: 25 functions, 70 nodes, 10 000 steps."""
    return solvers.EnhancedAttard(functions=25, nodes=70, domain=12e-9, steps=10_000)


def timed(work: Callable, at_least: float = 0.3) -> tuple[Any, float]:
    """Return a result and the least time of three runs or more, s, after a warm-up."""
    work()
    times: list[float] = []
    while len(times) < 3 or (sum(times) < at_least and len(times) < 30):
        started = perf_counter()
        result = work()
        times.append(perf_counter() - started)
    return result, min(times)


class Timing(NamedTuple):
    """A result; least time from call to dataset; least and typical time in the solver; all s."""

    result: Any
    least: float
    solver: float
    typical: float


def take_turns(runs: dict[Any, Callable], rounds: int) -> dict[Any, Timing]:
    """Run all in turn, after a warm-up.

    Turns of at least 50 ms keep ratios honest on a machine whose speed changes from minute to
    minute. Ratios want typical times, medians over rounds of the mean of a turn: of many short runs
    the least is luckier than of few long ones.
    """
    results = {key: work() for key, work in runs.items()}
    whole: dict[Any, list[float]] = {key: [] for key in runs}
    inside: dict[Any, list[float]] = {key: [] for key in runs}
    means: dict[Any, list[float]] = {key: [] for key in runs}
    for _ in range(rounds):
        for key, work in runs.items():
            turn, turn_ends = [], perf_counter() + 0.05
            while perf_counter() < turn_ends:
                started = perf_counter()
                results[key] = work()
                whole[key].append(perf_counter() - started)
                turn.append(float(results[key].attrs.get("solver_wall_time", whole[key][-1])))
            inside[key] += turn
            means[key].append(float(np.mean(turn)))
    return {
        key: Timing(results[key], min(whole[key]), min(inside[key]), float(np.median(means[key])))
        for key in runs
    }


def clock(seconds: float) -> str:
    """A time as text, s or ms."""
    return f"{seconds:.2f} s" if seconds >= 1 else f"{1e3 * seconds:.1f} ms"


def show(title: str, headings: dict[str, str], rows: Iterable[Iterable], width: int = 140) -> None:
    """Print a table; headings by their justification."""
    table = Table(title=title, title_justify="left")
    for heading, justify in headings.items():
        table.add_column(heading, justify=justify)
    for row in rows:
        table.add_row(*map(str, row))
    Console(width=width).print(table)
