"""Is the tolerance the error? Random contacts and motions against runs at a tenth of the tolerance.

Tip radius 5 nm to 5 µm, E_inf 1 MPa to 10 GPa, E0/E_inf 1 to 50, W 5 to 100 mJ/m², z0 0.15 to
0.5 nm, relaxed Tabor number up to 30; triangles, taps, and force curves with a lever of 0.05 to
100 N/m; creep times that matter. Every seed is one contact and motion, always the same. With
--out, results are added to a file, one JSON object a line, and what stands there already is not
run again: take a new file for a new version of softafm.

    python benchmarks/accuracy.py [--contacts N] [--first SEED] [--tolerances 0.01 ...]
                                  [--out FILE [--plot]]
"""

import argparse
import json
import warnings
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import common
import numpy as np

import softafm as sa

TABOR_BOUND = 30


class Drawn(NamedTuple):
    """A random contact's relaxed Tabor number, a length for its energies and a run of tolerance."""

    tabor: float
    length: float
    run: Callable


def draw(seed: int) -> Drawn:
    """Contact and motion of a seed."""
    random = np.random.default_rng(seed)

    def between(low, high):
        return float(np.exp(random.uniform(np.log(low), np.log(high))))

    while True:
        contact = sa.Contact(
            sa.Paraboloid(between(5e-9, 5e-6)),
            sa.Elastic(between(1e6, 1e10), random.uniform(0, 0.5)),
            sa.LennardJones.from_work_of_adhesion(
                between(5e-3, 0.1), random.uniform(0.15e-9, 0.5e-9)
            ),
        )
        if contact.tabor_relaxed <= TABOR_BOUND:
            break
    radius, z0 = contact.tip.radius, contact.surface.z0
    work, modulus = contact.surface.work_of_adhesion, contact.sample.reduced_modulus_relaxed
    adhesive = (6 * np.pi * work * radius**2 / modulus) ** (1 / 3)
    depth = random.uniform(0.2, 1.5) * (adhesive + np.sqrt(radius * z0)) ** 2 / radius + z0
    ratio = between(1, 50)

    def with_creep(creep_time):
        E = contact.sample.E
        solid = sa.StandardLinearSolid(ratio * E, E, creep_time, contact.sample.poisson)
        return sa.Contact(contact.tip, solid, contact.surface)

    mode = random.integers(3)
    if mode == 0:
        frequency = between(1e4, 1e6)
        amplitude = random.uniform(2e-9, 50e-9) + depth
        mean_height = amplitude - depth * random.uniform(-0.2, 1)
        touching = 3 * depth / (2 * np.pi * frequency * amplitude)
        tapped = with_creep(touching * between(0.01, 10))
        tap = tapped, amplitude, mean_height, frequency
        return Drawn(
            contact.tabor_relaxed,
            0.02 * amplitude,
            lambda tolerance: sa.tapping_cycle(*tap, tolerance=tolerance),
        )
    speed = between(1e-8, 1e-3)
    pressed = with_creep(depth / speed * between(0.01, 100))
    start = max(4, 6 * contact.tabor_relaxed**0.43) * z0
    if mode == 1:
        triangle = sa.Triangle(start, -depth, speed)
        return Drawn(
            contact.tabor_relaxed,
            z0,
            lambda tolerance: sa.force_distance(pressed, triangle, tolerance=tolerance),
        )
    lever = sa.Cantilever(between(0.05, 100))
    # The base of the lever goes farther by what bends it: adhesion above, indentation below.
    bent = 6 * np.pi * work * radius / lever.stiffness
    pushed = 4 / 3 * modulus * np.sqrt(radius) * depth**1.5 / lever.stiffness
    ramp = sa.Triangle(start + bent, -depth - pushed, speed)
    return Drawn(
        contact.tabor_relaxed,
        z0,
        lambda tolerance: sa.force_spectroscopy(pressed, lever, ramp, tolerance=tolerance),
    )


def largest_error(result, finer, length: float) -> float:
    """Of forces relative to the largest |force|, of energies to at least that times a length."""
    force = max(abs(float(finer["force_max"])), abs(float(finer["force_min"])))
    worst = 0.0
    for name in ("force_max", "force_min", "force_min_approach"):
        worst = max(worst, abs(float(result[name] - finer[name])) / force)
    for name in ("loop_energy", "virial", "dissipation"):
        if name in finer:
            scale = max(abs(float(finer[name])), force * length)
            worst = max(worst, abs(float(result[name] - finer[name])) / scale)
    return worst


def measure(seed: int, tolerance: float) -> dict:
    """Time, error and fate of a seed at a tolerance; the error is None of a run that gave up."""
    drawn = draw(seed)
    found = {"seed": seed, "tolerance": tolerance, "tabor": drawn.tabor}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sa.AccuracyWarning)
        started = perf_counter()
        try:
            result = drawn.run(tolerance)
            seconds = perf_counter() - started
            finer = drawn.run(max(tolerance / 10, 1e-5))
        except sa.DivergedError as error:
            return {**found, "mode": "", "error": None, "ending": str(error)}
    return {
        **found,
        "mode": result.attrs["mode"],
        "seconds": seconds,
        "error": largest_error(result, finer, drawn.length),
        "warned": bool(result.attrs["warnings"]),
        "ending": "completed",
    }


def battery(seeds, tolerances, out: Path | None = None) -> list[dict]:
    """Measure what the file lacks, adding to it line by line; return all that was asked for."""
    lines = out.read_text(encoding="utf-8").splitlines() if out and out.exists() else []
    found = {(entry["seed"], entry["tolerance"]): entry for entry in map(json.loads, lines)}
    for tolerance in tolerances:
        for seed in seeds:
            if (seed, tolerance) in found:
                continue
            entry = found[seed, tolerance] = measure(seed, tolerance)
            if out:
                with out.open("a", encoding="utf-8") as file:
                    print(json.dumps(entry), file=file)
            tell(entry)
    return [found[seed, tolerance] for tolerance in tolerances for seed in seeds]


def tell(entry: dict) -> None:
    """Print what stands out."""
    error = entry["error"]
    if error is None or error > entry["tolerance"]:
        much = entry["ending"] if error is None else f"{100 * error:.3g} %"
        warned = " (warned)" if entry.get("warned") else ""
        print(
            f"seed {entry['seed']} at {entry['tolerance']:g}: {much}{warned}, {entry['mode']}, "
            f"Tabor {entry['tabor']:.3g}",
            flush=True,
        )


def report(entries: list[dict]) -> None:
    """Print a line for each tolerance, and each mode within it."""
    rows = []
    for tolerance in sorted({entry["tolerance"] for entry in entries}, reverse=True):
        every = [entry for entry in entries if entry["tolerance"] == tolerance]
        modes = sorted({entry["mode"] for entry in every} - {""})
        for mode in ("all", *modes):
            some = [entry for entry in every if mode in ("all", entry["mode"])]
            rows.append((f"{tolerance:g}", mode, *statistics(some, tolerance)))
    titles = ("tolerance", "mode", "runs", "within", "or warned", "median", "99th percentile",
              "largest", "warned", "gave up")  # fmt: skip
    common.show("Errors of random contacts", dict.fromkeys(titles, "right"), rows)


def statistics(entries: list[dict], tolerance: float) -> tuple:
    """Shares and quantiles as text."""
    done = [entry for entry in entries if entry["error"] is not None]
    if not done:
        return len(entries), "", "", "", "", "", 0, len(entries)
    errors = np.array([entry["error"] for entry in done])
    warned = np.array([entry["warned"] for entry in done])
    quantiles = [f"{q:.1e}" for q in np.quantile(errors, [0.5, 0.99, 1.0])]
    within, told = np.mean(errors <= tolerance), np.mean((errors <= tolerance) | warned)
    gave_up = len(entries) - len(done)
    return len(entries), f"{within:.1%}", f"{told:.1%}", *quantiles, warned.sum(), gave_up


def plot(entries: list[dict], path: Path) -> None:
    """Draw the errors against the tolerance, one dot a run."""
    from matplotlib.figure import Figure

    from softafm.draw.results import COLOURS

    figure = Figure(figsize=(6, 4.5), layout="constrained")
    ax = figure.subplots()
    modes = sorted({entry["mode"] for entry in entries} - {""})
    for shift, (mode, colour) in enumerate(zip(modes, COLOURS, strict=False)):
        some = [e for e in entries if e["mode"] == mode and e["error"] is not None]
        side = 1.15 ** (shift - (len(modes) - 1) / 2)
        for warned, marker in ((False, "o"), (True, "x")):
            dots = [
                (e["tolerance"] * side, max(e["error"], 1e-8))
                for e in some
                if e["warned"] == warned
            ]
            if dots:
                label = f"{mode}, warned" if warned else mode
                ax.plot(*zip(*dots, strict=True), marker, color=colour, markersize=4, label=label)
    tolerances = sorted({entry["tolerance"] for entry in entries})
    ends = np.array([tolerances[0] / 1.5, tolerances[-1] * 1.5])
    ax.plot(ends, ends, "-", color="0.4", linewidth=1, label="error = tolerance")
    ax.set(xscale="log", yscale="log", xlabel="tolerance", ylabel="largest error", ylim=(1e-8, 1))
    ax.legend(frameon=False, fontsize=8, loc="lower right")
    figure.savefig(path, dpi=120)
    print(f"Figure: {path}")


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Errors of random contacts.")
    parser.add_argument("--contacts", type=int, default=60)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--tolerances", type=float, nargs="+", default=[1e-2])
    parser.add_argument("--out", type=Path, help="file of results, added to")
    parser.add_argument("--plot", action="store_true", help="draw a figure beside the file")
    given = parser.parse_args(arguments)
    if given.plot and given.out is None:
        parser.error("--plot draws beside the file of --out: give one")
    seeds = range(given.first, given.first + given.contacts)
    entries = battery(seeds, given.tolerances, given.out)
    report(entries)
    if given.plot:
        plot(entries, given.out.with_suffix(".png"))
    return entries


if __name__ == "__main__":
    main()
