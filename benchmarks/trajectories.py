"""Cost and error of motions given by samples, against the Triangle or the Sine they stand for.

A record is a ramp with Gaussian noise, evenly sampled. Cost is the solver's time over that of the
clean motion, the least of several runs on one core; errors are those of the worst of five records,
in per cent of the clean value.

    python benchmarks/trajectories.py
"""

import warnings
from collections.abc import Iterable

import common
import numpy as np

import softafm as sa

CONTACT = sa.Contact(
    tip=sa.Paraboloid(10e-9),
    sample=sa.StandardLinearSolid(E0=2e9, E_inf=0.1e9, creep_time=1e-7, poisson=0.49),
    surface=sa.LennardJones(hamaker=1e-19, z0=0.25e-9),
)
RAMP = sa.Triangle(start=10e-9, turn=-5e-9, speed=1e-3)
OBSERVABLES = ("force_max", "force_min", "loop_energy")
HEADINGS = {"motion": "left", "corners": "right", "steps": "right",
            "cost": "right", "peak, %": "right", "pull-off, %": "right",
            "loop, %": "right"}  # fmt: skip


def record(samples: int, noise: float, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Return times and heights of the ramp as an instrument would record it."""
    time = np.linspace(0, RAMP.breaks[-1], samples)
    return time, RAMP.height(time) + noise * np.random.default_rng(seed).standard_normal(samples)


def solved(motion) -> tuple:
    """Return the result of a run and the least time that the solver took, s."""
    runs = [sa.force_distance(CONTACT, motion) for _ in range(5)]
    return runs[0], min(run.attrs["solver_wall_time"] for run in runs)


def compared(name: str, motions: Iterable, clean, seconds: float) -> tuple:
    """Return a row of the table: what motions that stand for the ramp cost, and how they err."""
    found = [(motion, *solved(motion)) for motion in motions]
    errors = (
        max((100 * (float(run[n]) / float(clean[n]) - 1) for _, run, _ in found), key=abs)
        for n in OBSERVABLES
    )
    motion, run, taken = max(found, key=lambda entry: entry[2])
    count = f"{motion.breaks.size - 2}"
    steps = f"{run.attrs['solver_attempted_steps']}"
    return (name, count, steps, f"{taken / seconds:.2f}", *(f"{error:+.2f}" for error in errors))


def main():
    clean, seconds = solved(RAMP)
    ends = RAMP.breaks, RAMP.height(RAMP.breaks)
    rows = [
        compared("Triangle", [RAMP], clean, seconds),
        compared("its corners", [sa.Trajectory(*ends)], clean, seconds),
        compared("its corners, smooth", [sa.Trajectory(*ends, smooth=True)], clean, seconds),
    ]
    measure, drawing = sa.Trajectory.from_measurement, 0.0
    for noise in (0.1e-9, 1e-9):
        for samples in (2000, 10_000):
            records = [record(samples, noise, seed) for seed in range(5)]
            drawing = common.timed(lambda r=records: measure(*r[0]))[1]
            name = f"{samples} samples, noise {1e9 * noise:g} nm, measured"
            rows.append(compared(name, [measure(*r) for r in records], clean, seconds))
    with warnings.catch_warnings(action="ignore"):
        raw = [sa.Trajectory(*record(2000, 0.1e-9))]
        rows.append(compared("2000 samples, noise 0.1 nm, as they are", raw, clean, seconds))
    common.show("Motions given by samples", HEADINGS, rows)
    print(f"Triangle: {1e3 * seconds:.1f} ms; to draw a path by 10000 samples: {drawing:.2f} s")


if __name__ == "__main__":
    main()
