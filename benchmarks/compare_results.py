"""Whether a change of the code changed any result: every kind of run, before and after.

Runs the reference cases, random contacts, every mode and solver, a map, a sweep and the bundled
experiment files with the sources of a commit and with those of the working tree, and compares all
numbers of all results: the same bits, or the largest difference over the largest value of the
variable. Ends with status 1 if one is above 1e-9.

python benchmarks/compare_results.py COMMIT
"""

import os
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from common import reference_cases, run, setup_A, setup_E
from every_contact import contact_of as random_contact

import softafm as sa

ROOT = Path(__file__).parents[1]
ALLOWED = 1e-9
CONTACTS, MOST_STEPS = 30, 2000
"""How many random contacts are run, and how many steps each may try."""


def polyethylene(creep_time: float = 1e-7) -> sa.Contact:
    solid = sa.StandardLinearSolid(E0=2e9, E_inf=0.1e9, creep_time=creep_time, poisson=0.49)
    return sa.Contact(sa.Paraboloid(10e-9), solid, sa.LennardJones(1e-19, 0.25e-9))


TAP = 49.6e-9, 42.82e-9, 278e3
RAMP = sa.Triangle(1e-8, -5e-9, 2e-6)
PATH = sa.Trajectory(
    np.linspace(0, 1e-2, 41), 5e-9 + 5e-9 * np.cos(2 * np.pi * np.linspace(0, 1, 41))
)
MODES: dict[str, Callable[[], Any]] = {
    "ramp with profiles": lambda: sa.force_distance(polyethylene(1e-5), RAMP, profiles=True),
    "ramp that is checked": lambda: sa.force_distance(polyethylene(1e-5), RAMP, check=True),
    "ramp that dwells": lambda: sa.force_distance(
        polyethylene(1e-3), sa.Triangle(1e-8, -3e-9, 2e-6, dwell=5e-3)
    ),
    "trajectory": lambda: sa.force_distance(polyethylene(1e-3), PATH),
    "spectroscopy": lambda: sa.force_spectroscopy(
        polyethylene(1e-5), sa.Cantilever(2.0), sa.Triangle(2e-8, -5e-9, 2e-7)
    ),
    "spectroscopy to a setpoint": lambda: sa.force_spectroscopy(
        polyethylene(1e-5), sa.Cantilever(0.5),
        sa.Triangle(2e-8, -2e-8, 2e-6, setpoint_force=1e-9),
    ),
    "tap": lambda: sa.tapping_cycle(polyethylene(), *TAP, profiles=True),
    "three taps": lambda: sa.tapping_cycle(polyethylene(1e-6), *TAP, cycles=3),
    "steady tap": lambda: sa.tapping_cycle(polyethylene(1e-5), *TAP),
    "fine tap": lambda: sa.tapping_cycle(polyethylene(), *TAP, tolerance=1e-4),
    "tap, law of longer range": lambda: sa.tapping_cycle(polyethylene(), *TAP, regularise=0.3),
    "approach curve": lambda: sa.approach_curve(
        sa.Contact(sa.Paraboloid(50e-9), sa.samples.polystyrene(), sa.LennardJones(2e-20, 1.5e-10)),
        sa.Cantilever(stiffness=28.1, quality_factor=430, frequency=278e3),
        free_amplitude=15e-9, amplitude_ratio=np.linspace(0.95, 0.2, 9),
    ),
    "tap, setup A": lambda: sa.tapping_cycle(polyethylene(), *TAP, 1, solver=setup_A(1e-6)),
    "tap, setup E": lambda: sa.tapping_cycle(polyethylene(), *TAP, 1, solver=setup_E()),
}  # fmt: skip


def all_runs() -> Iterator[tuple[str, Callable[[], Any]]]:
    """Yield the name of every run and a function that does it."""
    for name, case in reference_cases().items():
        yield name, partial(run, case)
    solver = sa.solvers.Energy(most_steps=MOST_STEPS)
    for seed in range(CONTACTS):
        contact, ramp = random_contact(seed)
        yield f"random contact {seed}", partial(sa.force_distance, contact, ramp, solver=solver)
    yield from MODES.items()


def collect(folder: Path) -> None:
    """Run everything with the softafm at hand; keep the numbers of each run in a file."""
    warnings.simplefilter("ignore")
    for index, (name, work) in enumerate(all_runs()):
        try:
            result = work()
            found = {str(key): np.asarray(values) for key, values in result.variables.items()}
        except sa.DivergedError as error:
            found = {"diverged": np.array(str(error))}
        np.savez(folder / f"{index:03d}.npz", name=name, **found)
    for example in sorted(ROOT.glob("src/softafm/examples/*.toml")):
        keep_file(folder, example, "run")
    for image in sorted(ROOT.glob("src/softafm/examples/maps/*.toml")):
        keep_file(folder, image, "scan")


def keep_file(folder: Path, document: Path, command: str) -> None:
    """Run an experiment file by the command line, and keep its numbers."""
    import xarray

    out = folder / f"{document.stem}.nc"
    arguments = [command, str(document), "--out", str(out)]
    subprocess.run([sys.executable, "-m", "softafm", *arguments], check=True, capture_output=True)
    with xarray.open_dataset(out, engine="h5netcdf", decode_times=False) as result:
        found = {str(key): np.asarray(values) for key, values in result.variables.items()}
    np.savez(folder / f"{document.stem}.npz", name=document.name, **found)


def largest_difference(before, after) -> tuple[float, str]:
    """Return the largest difference of two results' numbers, and the variable it is found in."""
    worst = 0.0, ""
    for key in before.files:
        old, new = before[key], after[key]
        if old.shape != new.shape:
            return np.inf, f"{key}: {old.shape} before, {new.shape} after"
        if old.dtype.kind not in "fiu":
            if not np.array_equal(old, new):
                return np.inf, f"{key}: {old} before, {new} after"
            continue
        if np.array_equal(old, new, equal_nan=True):
            continue
        if not np.array_equal(np.isnan(old), np.isnan(new)):
            return np.inf, f"{key}: numbers in different places"
        found = float(np.nanmax(np.abs(new - old)) / max(np.nanmax(np.abs(old)), 1e-300))
        worst = max(worst, (found, key))
    return worst


def compare(old: Path, new: Path) -> int:
    """Print how results differ; return how many differ by more than is allowed."""
    same = differ = 0
    for path in sorted(old.glob("*.npz")):
        with np.load(path) as before, np.load(new / path.name) as after:
            difference, where = largest_difference(before, after)
            name = str(before["name"])
        if difference == 0:
            same += 1
            continue
        differ += difference > ALLOWED
        print(f"{name:32} {difference:.1e}  {where}", flush=True)
    print(f"{same} results have the same bits; {differ} differ by more than {ALLOWED:g}")
    return differ


def run_with(tree: Path, folder: Path) -> None:
    """Collect the results of the sources in a checkout."""
    environment = {**os.environ, "PYTHONPATH": str(tree / "src")}
    command = [sys.executable, __file__, "--collect", str(folder)]
    subprocess.run(command, env=environment, check=True)


def main(commit: str) -> int:
    with TemporaryDirectory() as folder:
        tree, old, new = (Path(folder) / name for name in ("tree", "before", "after"))
        old.mkdir()
        new.mkdir()
        git = ["git", "-C", str(ROOT), "worktree"]
        subprocess.run([*git, "add", "--quiet", "--detach", str(tree), commit], check=True)
        try:
            run_with(tree, old)
            run_with(ROOT, new)
        finally:
            subprocess.run([*git, "remove", "--force", str(tree)], check=True)
        return int(compare(old, new) > 0)


if __name__ == "__main__":
    if sys.argv[1] == "--collect":
        collect(Path(sys.argv[2]))
    else:
        sys.exit(main(sys.argv[1]))
