"""Cost and error of motions given by samples, against the Triangle or the Sine they stand for.

A record is a ramp with Gaussian noise, evenly sampled. Cost is the solver's time over that of the
clean motion, the least of several runs in turns, on one core; errors are those of the worst of
five records, in per cent of the clean value.

    python benchmarks/trajectories.py
"""

import warnings
from functools import partial
from typing import Any

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
HEADINGS = {"motion": "left", "steps": "right",
            "cost": "right", "peak, %": "right", "pull-off, %": "right",
            "loop, %": "right"}  # fmt: skip


def record(samples: int, noise: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return times and heights of the ramp as an instrument would record it."""
    time = np.linspace(0, RAMP.breaks[-1], samples)
    return time, RAMP.height(time) + noise * np.random.default_rng(seed).standard_normal(samples)


def motions() -> dict[tuple[str, int], Any]:
    """Return what stands for the ramp, by name and number of the record."""
    ends = RAMP.breaks, RAMP.height(RAMP.breaks)
    found = {
        ("Triangle", 0): RAMP,
        ("its corners", 0): sa.Trajectory(*ends),
        ("its corners, smooth", 0): sa.Trajectory(*ends, smooth=True),
    }
    for noise in (0.1e-9, 1e-9):
        for samples in (2000, 10_000):
            name = f"{samples} samples, noise {1e9 * noise:g} nm, measured"
            for seed in range(5):
                found[name, seed] = sa.Trajectory.from_measurement(*record(samples, noise, seed))
    found["2000 samples, noise 0.1 nm, as they are", 0] = sa.Trajectory(*record(2000, 0.1e-9, 0))
    return found


def row(name: str, found: dict[tuple[str, int], common.Timing], clean: common.Timing) -> tuple:
    """Return a row of the table: the dearest of several runs and the largest errors."""
    runs = [timing for (motion, _), timing in found.items() if motion == name]
    errors = (
        max((100 * (float(run.result[n]) / float(clean.result[n]) - 1) for run in runs), key=abs)
        for n in OBSERVABLES
    )
    steps = max(run.result.attrs["solver_attempted_steps"] for run in runs)
    cost = max(run.solver for run in runs) / clean.solver
    return (name, f"{steps}", f"{cost:.2f}", *(f"{error:+.2f}" for error in errors))


def main():
    drawn = motions()
    with warnings.catch_warnings(action="ignore"):
        found = common.take_turns(
            {key: partial(sa.force_distance, CONTACT, motion) for key, motion in drawn.items()}, 10
        )
    clean = found["Triangle", 0]
    rows = [row(name, found, clean) for name in dict.fromkeys(name for name, _ in drawn)]
    common.show("Motions given by samples", HEADINGS, rows)
    given = record(10_000, 1e-9, 0)
    drawing = common.timed(lambda: sa.Trajectory.from_measurement(*given))[1]
    print(
        f"Triangle: {1e3 * clean.solver:.1f} ms; to draw a path by 10000 samples: {drawing:.2f} s"
    )


if __name__ == "__main__":
    main()
