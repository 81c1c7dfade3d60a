"""Time, memory and error of the default solver on the reference cases of tests/data.

Times are the least of several runs after a warm-up, on one core, from the call to the finished
dataset. Errors are in per cent of each observable's scale (largest |force|; for energies the larger
of the value and |force|·z0, or 2 % of |force|·amplitude for taps).

    python benchmarks/reference_cases.py [TOLERANCE]
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import json
import resource
import sys
from pathlib import Path
from time import perf_counter

from rich.console import Console
from rich.table import Table

import softafm as sa

DATA = Path(__file__).parents[1] / "tests" / "data" / "cases.json"


def run(case, tolerance):
    inputs = case["inputs"]
    contact = sa.Contact(
        sa.Paraboloid(inputs["radius"]),
        sa.StandardLinearSolid(inputs["E0"], inputs["E_inf"], inputs["tau"], inputs["poisson"]),
        sa.LennardJones(inputs["hamaker"], inputs["z0"]),
    )
    if case["kind"] == "tapping_cycle":
        motion = inputs["amplitude"], inputs["mean_height"], inputs["frequency"]
        return sa.tapping_cycle(contact, *motion, tolerance=tolerance)
    motion = sa.Triangle(inputs["start"], inputs["turn"], inputs["speed"])
    return sa.force_distance(contact, motion, tolerance=tolerance)


def errors(case, result):
    expected = {name: entry["value"] for name, entry in case["expected"].items()}
    force = max(abs(expected["force_max"]), abs(expected["force_min"]))
    for name, value in expected.items():
        scale = force
        if name == "loop_energy":
            scale = max(abs(value), force * case["inputs"]["z0"])
        elif not name.startswith("force"):
            scale = max(abs(value), 0.02 * force * case["inputs"]["amplitude"])
        yield 100 * (float(result[name]) - value) / scale, name


def main():
    tolerance = float(sys.argv[1]) if len(sys.argv) > 1 else 1e-2
    cases = [c for c in json.loads(DATA.read_text()) if c["kind"] != "force_spectroscopy"]
    run(cases[0], tolerance)
    table = Table(title=f"Reference cases at tolerance {tolerance:g}")
    for heading in ("case", "time, ms", "steps", "nodes", "jumps", "largest error, %", "in"):
        table.add_column(heading, justify="left" if heading in ("case", "in") else "right")
    for case in cases:
        run(case, tolerance)
        times = []
        while len(times) < 5 or (sum(times) < 0.3 and len(times) < 30):
            started = perf_counter()
            result = run(case, tolerance)
            times.append(perf_counter() - started)
        error, name = max(errors(case, result), key=lambda pair: abs(pair[0]))
        table.add_row(
            case["name"],
            f"{1e3 * min(times):.1f}",
            f"{result.attrs['solver_steps']}",
            f"{result.attrs['solver_most_nodes']}",
            f"{result.sizes['jump']}",
            f"{error:+.3f}",
            name,
        )
    Console(width=110).print(table)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"peak memory of the process: {peak:.0f} MB")


if __name__ == "__main__":
    main()
