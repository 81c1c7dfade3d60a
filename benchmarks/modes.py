"""Time and error of the modes of an instrument: spectroscopy, steady taps, approach curves.

Times are the least of several runs after a warm-up, on one core, from the call to the finished
dataset. Errors are in per cent of each observable's scale (for the loop energy the larger of the
value and largest |force|·z0; for virial and dissipation the value), heights in pm.

    python benchmarks/modes.py [TOLERANCE]
"""

import json
import sys
import warnings
from typing import NamedTuple

import common
import numpy as np

import softafm as sa

REPLACED = {0.95: 1.920e-19, 0.9: 3.121e-19, 0.8: 4.527e-19}
"""Dissipation of the farthest solutions by amplitude ratio, J (tests/data/README.md)."""

RATIOS = np.linspace(0.2, 0.95, 31)


class Misses(NamedTuple):
    """What an approach curve gets wrong: V and E in per cent by name, heights, solutions."""

    observables: dict[str, float]
    height: float
    """Largest deviation of Z, m."""
    wrong: int
    """Solutions missing or too many."""


def spectroscopy(tolerance):
    """The curves of the reference cases."""
    for name, case in common.reference_cases().items():
        if case["kind"] != "force_spectroscopy":
            continue
        result, seconds = common.timed(lambda case=case: common.run(case, tolerance))
        found = common.errors(case, result, common.expected(case))
        yield name, seconds, f"{result.attrs['solver_steps']} steps", common.describe_worst(found)


def steady_tap(tolerance):
    """The smooth tap with a creep time of 100 periods, against 600 cycles one after the other."""
    sample = sa.StandardLinearSolid(2.5e9, 0.3e9, 100 / 250e3, 0.45)
    contact = sa.Contact(sa.Paraboloid(12e-9), sample, sa.LennardJones(1e-19, 0.3e-9))
    tap = contact, 40e-9, 36e-9, 250e3
    result, seconds = common.timed(lambda: sa.tapping_cycle(*tap, tolerance=tolerance))
    many = sa.tapping_cycle(*tap, cycles=600, tolerance=tolerance)
    found = common.of_its_value(result, many, ("virial", "viscous_loss", "force_max"))
    cycles = f"{int(result['cycles_run'])} cycles"
    yield "steady tap, creep time 100 periods", seconds, cycles, common.describe_worst(found)


def polystyrene():
    """Inputs and solutions of the reference approach curve (Fig. 9 of the paper)."""
    curve = json.loads((common.DATA / "approach_curve_ps.json").read_text(encoding="utf-8"))
    return curve["inputs"], curve["curve"]


def approach_curve(ratios, tolerance):
    """The curve of Fig. 9 at these amplitude ratios."""
    inputs, _ = polystyrene()
    lever = sa.Cantilever(inputs["stiffness"], inputs["quality_factor"], inputs["frequency"])
    contact = common.contact_of(inputs)
    return sa.approach_curve(contact, lever, inputs["free_amplitude"], ratios, tolerance=tolerance)


def approach_misses(tolerance) -> Misses:
    """Compare all branches with the reference at its ratios."""
    _, rows = polystyrene()
    found = approach_curve([row["amplitude_ratio"] for row in rows], tolerance)
    errors: dict[str, float] = {}
    off, wrong = 0.0, 0
    for i, row in enumerate(rows):
        table = found.isel(amplitude_ratio=i)
        order = np.argsort(-np.nan_to_num(table["mean_height"].values))
        wrong += abs(int(np.isfinite(table["mean_height"]).sum()) - len(row["solutions"]))
        for j, solution in zip(order, row["solutions"], strict=False):
            off = max(off, abs(float(table["mean_height"][j]) - solution["mean_height"]))
            wanted = dict(solution)
            if j == order[0] and row["amplitude_ratio"] in REPLACED:
                wanted["dissipation"] = REPLACED[row["amplitude_ratio"]]
            for name in ("virial", "dissipation"):
                error = 100 * (float(table[name][j]) / wanted[name] - 1)
                key = f"{name} at {row['amplitude_ratio']:g}"
                errors[key] = max(errors.get(key, 0.0), error, key=abs)
    return Misses(errors, off, wrong)


def approach(tolerance):
    """The curve of Fig. 9: its time with 31 ratios, its errors at the ratios of the reference."""
    result, seconds = common.timed(lambda: approach_curve(RATIOS, tolerance))
    errors, off, wrong = approach_misses(tolerance)
    worst = common.describe_worst(errors)
    notes = f"{worst}; Z {1e12 * off:.1f} pm; {wrong} solutions missing or wrong"
    yield "approach curve, 31 ratios", seconds, f"{result.attrs['solver_taps']} taps", notes


def main():
    tolerance = float(sys.argv[1]) if len(sys.argv) > 1 else 1e-2
    warnings.simplefilter("always", sa.AccuracyWarning)
    rows = [
        (name, f"{1e3 * seconds:.1f}", *notes)
        for mode in (spectroscopy, steady_tap, approach)
        for name, seconds, *notes in mode(tolerance)
    ]
    headings = {"case": "left", "time, ms": "right", "work": "right", "largest error": "left"}
    common.show(f"Modes at tolerance {tolerance:g}", headings, rows)


if __name__ == "__main__":
    main()
