"""The targets of softafm and how far they are met: one table, ``make bench``, in under two minutes.

A row is one piece of work with the accuracy reached beside its time, the least of several runs.
Ratios are of typical solver times of runs that took turns in this very process. A second table sets
the time of some runs against that of the dense factorisations in them, which no implicit solver of
this kind can avoid.

    python benchmarks/table.py
"""

import multiprocessing
import os
import platform
import warnings
from collections.abc import Iterator
from time import perf_counter
from timeit import repeat
from typing import NamedTuple
from unittest.mock import patch

import common
import modes
import numpy as np

import softafm as sa
from softafm.bodies.kernel import influence
from softafm.bodies.mesh import unit_mesh
from softafm.compiled.dense import factorise
from softafm.solvers.energy import run as energy_run

TAP = "ldpe-tap-setpoint-0.8"
VIRIAL_AND_LOSS = ("virial", "dissipation")
FORTRAN = 80e-3
"""Time of a tapping cycle in the Fortran program VEDA 2.2.1 with 25 functions, 70 nodes and 2000
Runge-Kutta steps, s: a given figure, not measured here."""

LOOSEST = 0.1
"""The loosest tolerance that modes accept."""

LADDER = (1e-2, 1e-3, 1e-4)
LADDER_CASES = (
    "attard-triangle-2um/s", "attard-triangle-halved-1um/s", TAP, "smooth-tap",
    "ldpe-tap-repulsive", "ldpe-tap-attractive", "ps-tap-gap-1.0nm", "elastic-tabor-1.0",
    "elastic-tabor-3.0", "ldpe-spectroscopy-k2.0", "soft-tabor-5",
)  # fmt: skip
CYCLES, BATCHES = 1000, 5


class Row(NamedTuple):
    """A line of the table; ``reached`` is None where nothing is aimed at."""

    work: str
    time: str
    accuracy: str
    target: str = ""
    reached: bool | None = None

    def cells(self):
        return *self[:4], {True: "yes", False: "NO", None: ""}[self.reached]


def tap_rows() -> Iterator[Row]:
    """One tap on polyethylene in the default solver and in the setups E and A of the paper."""
    case = common.reference_cases()[TAP]
    runs = {
        "default, tolerance 0.01": lambda: common.run(case, 1e-2),
        f"default, tolerance {LOOSEST:g}": lambda: common.run(case, LOOSEST),
        "setup E": lambda: common.run(case, solver=common.setup_E()),
        "setup A, iterated to 1e-2": lambda: common.run(case, solver=common.setup_A(1e-2)),
        "setup A, iterated to 1e-6": lambda: common.run(case, solver=common.setup_A(1e-6)),
    }
    found = common.take_turns(runs, 9)
    errors = {
        key: common.of_its_value(timing.result, common.expected(case), VIRIAL_AND_LOSS)
        for key, timing in found.items()
    }
    for key, timing in found.items():
        yield Row(f"{TAP}, {key}", common.clock(timing.typical), both(errors[key]))
    setup_e, *setups_a = list(runs)[2:]
    for setup, target in [(setup_e, 100), *((a, 10_000) for a in setups_a)]:
        for default in list(runs)[:2]:
            ratio = found[setup].typical / found[default].typical
            good = ratio >= target and common.worst(errors[default]) <= 1
            yield Row(
                f"  {setup} / {default}", f"{ratio:.0f} x", both(errors[default]),
                f"{target} x", good,
            )  # fmt: skip
    for default in list(runs)[:2]:
        whole = found[default].least
        good = whole <= FORTRAN / 50 and common.worst(errors[default]) <= 1
        work = f"  Fortran, 80 ms as given / {default}"
        note = f"{common.clock(whole)} from call to dataset"
        yield Row(work, f"{FORTRAN / whole:.0f} x", note, "50 x", good)


def both(errors: dict[str, float]) -> str:
    """Errors of V and E as text."""
    return f"V {errors['virial']:+.2f} %, E {errors['dissipation']:+.2f} %"


def approach_row() -> Row:
    """The approach curve on polystyrene."""
    result, seconds = common.timed(lambda: modes.approach_curve(modes.RATIOS, 1e-2))
    errors, off, wrong = modes.approach_misses(1e-2)
    worst = common.describe_worst(errors)
    accuracy = f"{wrong} solutions missing or wrong, Z {1e12 * off:.1f} pm, {worst}"
    work = f"PS approach curve, 31 ratios, {result.attrs['solver_taps']} taps"
    return Row(work, common.clock(seconds), accuracy, "0.3 s", seconds <= 0.3 and wrong == 0)


def spectroscopy_row() -> Row:
    """The force curve with the stiffer lever."""
    case = common.reference_cases()["ldpe-spectroscopy-k28.1"]
    result, seconds = common.timed(lambda: common.run(case))
    error = common.errors(case, result, common.expected(case))["loop_energy"]
    work = "LDPE force spectroscopy, k = 28.1 N/m"
    good = seconds <= 0.03 and abs(error) <= 1
    return Row(work, common.clock(seconds), f"loop energy {error:+.2f} %", "0.03 s", good)


def ladder_row() -> Row:
    """How much more work an error ten times smaller takes, over several cases together.

    Work is time in the solver, errors are against runs at 1e-5. One slope for all cases from the
    ends of their ladders: Σ ln(time ratio) over Σ ln(error ratio).
    """
    dearer, better, middle = 0.0, 0.0, []
    for name in LADDER_CASES:
        case = common.reference_cases()[name]
        runs = {t: (lambda case=case, t=t: common.run(case, t)) for t in LADDER}
        found = common.take_turns(runs, 5)
        exact = common.run(case, 1e-5)
        errors = [common.worst(common.errors(case, found[t].result, exact)) for t in LADDER]
        dearer += np.log(found[LADDER[-1]].typical / found[LADDER[0]].typical)
        better += np.log(errors[0] / errors[-1])
        middle.append(errors)
    factor = 10 ** (dearer / better)
    medians = ", ".join(f"{error:.2g}" for error in np.median(middle, axis=0))
    accuracy = f"median {medians} % at 1e-2, 1e-3, 1e-4"
    work = f"work for 10 times smaller error, {len(LADDER_CASES)} cases"
    return Row(work, f"{factor:.2f} x", accuracy, "at most 4 x", bool(factor <= 4))


def scaling_row() -> Row:
    """Independent cycles shared out to two processes.

    In batches that take turns, of which the fastest counts. Bare arithmetic of the same kind tells
    what the machine, perhaps busy with other things, has to give.
    """
    heights = np.random.default_rng(0).permutation(np.linspace(42e-9, 45e-9, CYCLES))
    batches = [(tap_at, batch.tolist(), 5) for batch in np.split(heights, BATCHES)]
    arithmetic = factorisations, [400] * 80, 2
    least = {(kind, workers): np.inf for kind in "ca" for workers in (1, 2)}
    spawn = multiprocessing.get_context("spawn")
    with spawn.Pool(1) as one, spawn.Pool(2) as two:
        for pool in (one, two):
            pool.map(tap_at, [43e-9] * 8, 1)
        for batch in batches:
            for kind, (function, arguments, chunk) in (("c", batch), ("a", arithmetic)):
                for workers, pool in ((1, one), (2, two)):
                    started = perf_counter()
                    pool.map(function, arguments, chunk)
                    seconds = perf_counter() - started
                    least[kind, workers] = min(least[kind, workers], seconds)
    gain, bare = (least[kind, 1] / least[kind, 2] for kind in "ca")
    work = f"{CYCLES} cycles, 2 warm processes against 1"
    note = f"in {common.clock(BATCHES * least['c', 2])}; bare arithmetic gains {bare:.2f} x"
    return Row(work, f"{gain:.2f} x", note, "1.9 x", bool(gain >= 1.9))


def tap_at(mean_height: float) -> float:
    """Dissipation of a cycle on polyethylene about this height."""
    inputs = common.reference_cases()[TAP]["inputs"]
    contact = common.contact_of(inputs)
    tap = sa.tapping_cycle(contact, inputs["amplitude"], mean_height, inputs["frequency"])
    return float(tap["dissipation"])


def factorisations(count: int) -> float:
    """Work of the same kind that touches hardly any memory; returns nothing of interest."""
    matrix = spd(60)
    work = np.empty_like(matrix)
    for _ in range(count):
        work[:] = matrix
        factorise(work, len(work))
    return float(work[-1, -1])


def tabor_rows() -> Iterator[Row]:
    """Contacts of growing Tabor number."""
    cases = common.reference_cases()
    for name, target in {"soft-tabor-5": 0, "soft-tabor-10": 0, "soft-tabor-20": 0,
                         "soft-tabor-30": 1.0}.items():  # fmt: skip
        result, seconds = common.timed(lambda name=name: common.run(cases[name]))
        found = common.errors(cases[name], result, common.expected(cases[name]))
        good = seconds <= target and common.worst(found) <= 1 if target else None
        wanted = f"{target:g} s" if target else ""
        yield Row(name, common.clock(seconds), common.describe_worst(found), wanted, good)
    contact, ramp = common.soft_contact(100)
    started = perf_counter()
    result = sa.force_distance(contact, ramp)
    seconds = perf_counter() - started
    finer = sa.force_distance(contact, ramp, tolerance=3e-3)
    names = ("force_max", "force_min", "loop_energy")
    found = common.of_its_value(result, finer, names)
    accuracy = f"{common.describe_worst(found)}, against tolerance 3e-3"
    good = seconds <= 5 and common.worst(found) <= 1
    yield Row("soft Tabor 100, E0/E_inf = 20", common.clock(seconds), accuracy, "5 s", good)
    started = perf_counter()
    result = sa.force_distance(
        common.elastic_contact(30), sa.Triangle(60 * common.Z0, -9 * common.Z0, 1e-6)
    )
    seconds = perf_counter() - started
    pull_off = -float(result["force_min"]) / (np.pi * common.R * common.W)
    accuracy = f"pull-off {pull_off:.4f} πRW, {100 * (pull_off / 1.5005 - 1):+.2f} % of 1.5005"
    yield Row("elastic Tabor 30, two jumps", common.clock(seconds), accuracy)


class Counted(energy_run.Run):
    """A run that notes Newton iterations and accepted steps by the size of the system."""

    tallies: dict[int, np.ndarray]

    def _advance(self, stop):
        surface = self.surface
        size = surface.mesh.nodes.size + surface.bends
        before = surface.clock["newtons"]
        outcome, records, shapes = super()._advance(stop)
        done = surface.clock["newtons"] - before, len(records)
        self.tallies[size] = self.tallies.get(size, np.zeros(2)) + done
        return outcome, records, shapes


def bound_rows() -> Iterator[tuple]:
    """Time of a run against that of its factorisations, and of a single one per accepted step."""
    cases = common.reference_cases()
    for name in (TAP, "attard-triangle-2um/s", "ldpe-spectroscopy-k28.1", "soft-tabor-30"):
        case, Counted.tallies = cases[name], {}
        with patch.object(energy_run, "Run", Counted):
            common.run(case)
        result, _, inside, _ = common.take_turns({0: lambda case=case: common.run(case)}, 5)[0]
        cost = {size: factorisation_seconds(size) for size in Counted.tallies}
        newtons, steps = sum(Counted.tallies.values())
        factorising = sum(cost[n] * tally[0] for n, tally in Counted.tallies.items())
        least = sum(cost[n] * tally[1] for n, tally in Counted.tallies.items())
        flops = sum(n**3 / 3 * tally[0] for n, tally in Counted.tallies.items())
        yield (
            name, common.clock(inside), result.attrs["solver_most_nodes"], int(steps), int(newtons),
            f"{1e-9 * flops / factorising:.1f}", f"{1e3 * factorising:.2f} ms",
            f"{inside / factorising:.1f}", f"{1e3 * least:.2f} ms", f"{inside / least:.1f}",
        )  # fmt: skip


def spd(size: int) -> np.ndarray:
    """A symmetric positive matrix like that of a contact."""
    mesh = unit_mesh(0.05, 8.0 / size, 8.0)
    stiffness = np.linalg.inv(influence(mesh.nodes, mesh.spacing, mesh.masses))
    size = min(size, len(stiffness))
    return np.ascontiguousarray(stiffness[:size, :size])


def factorisation_seconds(size: int) -> float:
    """Least time of one Cholesky factorisation, s, without the copy of its matrix."""
    matrix = np.eye(size) + 0.5 / size
    work = np.empty_like(matrix)

    def copy():
        work[:] = matrix

    def both():
        work[:] = matrix
        factorise(work, size)

    times = [min(repeat(what, number=20, repeat=40)) / 20 for what in (both, copy)]
    return times[0] - times[1]


def main():
    started = perf_counter()
    warnings.simplefilter("ignore", sa.AccuracyWarning)
    rows = [*tap_rows(), approach_row(), spectroscopy_row(), ladder_row(), scaling_row()]
    rows += tabor_rows()
    titles = {"work": "left", "time": "right", "accuracy": "left", "target": "right",
              "reached": "left"}  # fmt: skip
    common.show("softafm against its targets", titles, (row.cells() for row in rows), 160)
    headings = dict.fromkeys(
        ("run", "time", "nodes", "steps", "Newton", "GFlop/s", "factorising", "time / it",
         "one a step", "time / it "), "right")  # fmt: skip
    headings["run"] = "left"
    title = "Against a lower bound: Cholesky factorisations, n³/3 each, at their measured speed"
    common.show(title, headings, bound_rows(), 160)
    print(f"{platform.machine()}, {os.cpu_count()} cores, python {platform.python_version()}; "
          f"{perf_counter() - started:.0f} s in all")  # fmt: skip


if __name__ == "__main__":
    main()
