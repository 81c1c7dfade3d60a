"""Time and error of the modes of an instrument: spectroscopy, steady taps, approach curves.

Times are the least of several runs after a warm-up, on one core, from the call to the finished
dataset. Errors are in per cent of each observable's scale (for the loop energy the larger of the
value and largest |force|·z0; for virial and dissipation the value), heights in pm.

    python benchmarks/modes.py [TOLERANCE]
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import json
import sys
import warnings
from pathlib import Path
from time import perf_counter

import numpy as np
from rich.console import Console
from rich.table import Table

import softafm as sa

DATA = Path(__file__).parents[1] / "tests" / "data"
REPLACED = {0.95: 1.920e-19, 0.9: 3.121e-19, 0.8: 4.527e-19}
"""Dissipation of the farthest solutions by amplitude ratio, J (tests/data/README.md)."""


def contact_of(inputs):
    return sa.Contact(
        sa.Paraboloid(inputs["radius"]),
        sa.StandardLinearSolid(inputs["E0"], inputs["E_inf"], inputs["tau"], inputs["poisson"]),
        sa.LennardJones(inputs["hamaker"], inputs["z0"]),
    )


def timed(run):
    """Return the result of ``run`` and the least time of several repetitions, s."""
    run()
    times = []
    while len(times) < 3 or (sum(times) < 0.5 and len(times) < 20):
        started = perf_counter()
        result = run()
        times.append(perf_counter() - started)
    return result, min(times)


def worst(errors):
    """Return the largest of errors by name, as text."""
    name, error = max(errors.items(), key=lambda pair: abs(pair[1]))
    return f"{error:+.3f} % {name}"


def spectroscopy(tolerance):
    """The curves of the reference cases."""
    cases = json.loads((DATA / "cases.json").read_text())
    for case in cases:
        if case["kind"] != "force_spectroscopy":
            continue
        inputs = case["inputs"]
        contact, lever = contact_of(inputs), sa.Cantilever(inputs["stiffness"])
        motion = sa.Triangle(inputs["start"], inputs["turn"], inputs["speed"])
        result, seconds = timed(
            lambda c=contact, k=lever, m=motion: sa.force_spectroscopy(c, k, m, tolerance=tolerance)
        )
        expected = {name: entry["value"] for name, entry in case["expected"].items()}
        force = max(abs(expected["force_max"]), abs(expected["force_min"]))
        errors = {}
        for name, value in expected.items():
            scale = force
            if name == "loop_energy":
                scale = max(abs(value), force * inputs["z0"])
            errors[name] = 100 * (float(result[name]) - value) / scale
        yield case["name"], seconds, 0.15, f"{result.attrs['solver_steps']} steps", worst(errors)


def steady_tap(tolerance):
    """The smooth tap with a creep time of 100 periods, against 600 cycles one after the other."""
    sample = sa.StandardLinearSolid(2.5e9, 0.3e9, 100 / 250e3, 0.45)
    contact = sa.Contact(sa.Paraboloid(12e-9), sample, sa.LennardJones(1e-19, 0.3e-9))
    tap = contact, 40e-9, 36e-9, 250e3
    result, seconds = timed(lambda: sa.tapping_cycle(*tap, tolerance=tolerance))
    many = sa.tapping_cycle(*tap, cycles=600, tolerance=tolerance)
    errors = {
        name: 100 * (float(result[name]) / float(many[name]) - 1)
        for name in ("virial", "viscous_loss", "force_max")
    }
    cycles = f"{int(result['cycles_run'])} cycles"
    yield "steady tap, creep time 100 periods", seconds, None, cycles, worst(errors)


def approach(tolerance):
    """The curve of Fig. 9: its time with 31 ratios, its errors at the ratios of the reference."""
    reference = json.loads((DATA / "approach_curve_ps.json").read_text())
    inputs, rows = reference["inputs"], reference["curve"]
    contact = contact_of(inputs)
    lever = sa.Cantilever(inputs["stiffness"], inputs["quality_factor"], inputs["frequency"])

    def run(ratios):
        free = inputs["free_amplitude"]
        return sa.approach_curve(contact, lever, free, ratios, tolerance=tolerance)

    result, seconds = timed(lambda: run(np.linspace(0.2, 0.95, 31)))
    found = run([row["amplitude_ratio"] for row in rows])
    errors, off, lost = {}, 0.0, 0
    for i, row in enumerate(rows):
        table = found.isel(amplitude_ratio=i)
        order = np.argsort(-np.nan_to_num(table["mean_height"].values))
        lost += abs(int(np.isfinite(table["mean_height"]).sum()) - len(row["solutions"]))
        for j, solution in zip(order, row["solutions"], strict=False):
            off = max(off, abs(float(table["mean_height"][j]) - solution["mean_height"]))
            wanted = dict(solution)
            if j == order[0] and row["amplitude_ratio"] in REPLACED:
                wanted["dissipation"] = REPLACED[row["amplitude_ratio"]]
            for name in ("virial", "dissipation"):
                error = 100 * (float(table[name][j]) / wanted[name] - 1)
                key = f"{name} at {row['amplitude_ratio']:g}"
                errors[key] = max(errors.get(key, 0.0), error, key=abs)
    notes = f"{worst(errors)}; Z {1e12 * off:.1f} pm; {lost} solutions amiss"
    yield "approach curve, 31 ratios", seconds, 1.0, f"{result.attrs['solver_taps']} taps", notes


def main():
    tolerance = float(sys.argv[1]) if len(sys.argv) > 1 else 1e-2
    warnings.simplefilter("always", sa.AccuracyWarning)
    table = Table(title=f"Modes at tolerance {tolerance:g}")
    for heading in ("case", "time, ms", "wanted", "work", "largest error"):
        right = heading in ("time, ms", "wanted", "work")
        table.add_column(heading, justify="right" if right else "left")
    for mode in (spectroscopy, steady_tap, approach):
        for name, seconds, target, work, error in mode(tolerance):
            wanted = "" if target is None else f"{1e3 * target:.0f}"
            table.add_row(name, f"{1e3 * seconds:.1f}", wanted, work, error)
    Console(width=130).print(table)


if __name__ == "__main__":
    main()
