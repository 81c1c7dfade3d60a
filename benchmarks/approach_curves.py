"""Are approach curves right? Random levers and contacts against scans with taps of their own.

Q 2 to 1000, A0 2 to 60 nm, k 0.1 to 50 N/m, 20 to 500 kHz; tips of 5 nm to 1 µm, E_inf 1 MPa to
10 GPa, relaxed Tabor numbers up to 15. At three amplitudes each the closest approach is scanned by
taps at a tenth of the tolerance, and every zero of the balance of the drive is bracketed and
solved there, without any map. A height counts as right within 1 % + 0.1 nm, a dissipation within
2 % of itself or of 2 % of the largest force × 2 % of the amplitude. With --out, results are added
to a file, one JSON object a line, and what stands there already is not run again.

    python benchmarks/approach_curves.py [--contacts N] [--first SEED] [--tolerance 0.01]
                                         [--out FILE]
"""

import argparse
import json
import signal
import warnings
from pathlib import Path
from time import process_time
from typing import NamedTuple

import common
import numpy as np
from scipy.optimize import brentq, minimize_scalar

import softafm as sa
from softafm.instrument.oscillator import Drive

_MOST_SECONDS = 150
RATIOS = (0.3, 0.6, 0.9)
TABOR_BOUND = 15


class Drawn(NamedTuple):
    """A random contact, its lever, and the free amplitude, m."""

    contact: sa.Contact
    lever: sa.Cantilever
    free: float


def draw(seed: int) -> Drawn:
    """Contact, lever and free amplitude of a seed."""
    random = np.random.default_rng(seed)
    uniform = random.uniform

    def between(low, high):
        return float(np.exp(uniform(np.log(low), np.log(high))))

    while True:
        R, z0, W = between(5e-9, 1e-6), uniform(1.5e-10, 5e-10), between(5e-3, 0.1)
        modulus, nu = between(1e6, 1e10), uniform(0.2, 0.5)
        if R * (W * (1 - nu**2) / modulus) ** 2 <= (TABOR_BOUND * z0) ** 3:
            break
    frequency, ratio = between(2e4, 5e5), between(1, 50)
    creep = between(0.01, 10) * 0.1 / frequency
    stiff, window = ratio * modulus, (1e-3 / frequency, 1e2 / frequency)
    sample = [
        lambda: sa.Elastic(modulus, nu),
        lambda: sa.StandardLinearSolid(stiff, modulus, creep, nu),
        lambda: sa.KelvinVoigt(modulus, 0.1 * creep, nu),
        lambda: sa.GeneralizedMaxwell(
            modulus, stiff * uniform(0.1, 1, 4), np.geomspace(1e-8, 1e-4, 4), nu
        ),
        lambda: sa.FractionalStandardLinearSolid(
            stiff, modulus, creep, uniform(0.3, 0.9), window, nu
        ),
    ][random.integers(5)]()
    law = [
        lambda: sa.LennardJones.from_work_of_adhesion(W, z0),
        lambda: sa.DMT.from_work_of_adhesion(W, z0, uniform(0.05, 0.25)),
        lambda: sa.Morse(W, z0, z0 * uniform(0.3, 0.6)),
        lambda: sa.Exponential(W, z0, z0 * uniform(0.3, 1), 0.1 * z0),
        lambda: sa.Repulsion(between(10, 1000) * stiff, 0.2 * z0),
    ][random.integers(5)]()
    tip = [
        lambda: sa.Paraboloid(R),
        lambda: sa.Sphere(R),
        lambda: sa.Hyperboloid(R, uniform(0.2, 1.2)),
        lambda: sa.Cone(uniform(0.3, 1.2), R),
    ][random.integers(4)]()
    lever = sa.Cantilever(between(0.1, 50), between(2, 1000), frequency)
    return Drawn(sa.Contact(tip, sample, law), lever, between(2e-9, 60e-9))


class Scan:
    """Taps of one amplitude, m, as closely as a drive has to know them."""

    def __init__(self, drawn: Drawn, amplitude: float, tolerance: float):
        self.contact, lever, free = drawn
        self.amplitude, self.tolerance, self.frequency = amplitude, tolerance, lever.frequency
        self.drive = Drive(lever.stiffness, lever.quality_factor, 1.0, free)
        self.taps: dict[float, dict[str, float]] = {}

    def tap(self, approach: float) -> dict[str, float]:
        if approach not in self.taps:
            tap = sa.tapping_cycle(
                self.contact, self.amplitude, self.amplitude + approach, self.frequency,
                tolerance=self.tolerance,
            )  # fmt: skip
            names = "virial", "dissipation", "viscous_loss", "force_max", "force_min"
            self.taps[approach] = {name: float(tap[name]) for name in names}
            self.taps[approach]["jumps"] = float(tap["jump_energy"].sum())
        return self.taps[approach]

    def excess(self, approach: float) -> float:
        tap = self.tap(approach)
        return float(self.drive.excess(self.amplitude, tap["virial"], tap["dissipation"]))

    def zeros(self) -> tuple[list[float], list[float]]:
        """Closest approaches, m, of all solutions, and those where two nearly meet or part."""
        unit = self.contact.reach
        deep, far = -2 * unit, 4 * unit
        while self.excess(deep) < 0.1 or self.tap(deep)["virial"] > 0:
            deep *= 1.5
            if deep < -3 * self.amplitude - 3000 * unit:
                break
        free = self.amplitude / self.drive.free_amplitude - 1
        while far < 300 * unit and abs(self.excess(far) - free) > 0.05 * abs(free):
            far *= 1.5
        grid = np.concatenate(
            [np.linspace(deep, 2 * unit, 50), np.geomspace(2 * unit, far, 20)[1:]]
        )
        excess = np.array([self.excess(d) for d in grid.tolist()])
        zeros, marginal = [], []
        for i in range(grid.size - 1):
            if excess[i] * excess[i + 1] < 0:
                zeros.append(brentq(self.excess, grid[i], grid[i + 1], xtol=2e-12))
            elif i and (excess[i - 1 : i + 2] * excess[i] > 0).all():
                if abs(excess[i]) > min(0.1, *abs(excess[[i - 1, i + 1]])):
                    continue
                sign, ends = np.sign(excess[i]), grid[[i - 1, i + 1]].tolist()
                found = minimize_scalar(
                    lambda d, sign=sign: sign * self.excess(d),
                    bounds=ends, method="bounded", options={"xatol": 1e-2 * unit, "maxiter": 12},
                )  # fmt: skip
                if found.fun < 0:
                    zeros += [brentq(self.excess, end, found.x, xtol=2e-12) for end in ends]
                if abs(found.fun) < 0.02:
                    marginal.append(found.x)
        return sorted(zeros, reverse=True), marginal


def compare(drawn: Drawn, result, row: int, tolerance: float) -> dict:
    """Differences of the solutions of one amplitude from a scan of its own."""
    amplitude = RATIOS[row] * drawn.free
    scan = Scan(drawn, amplitude, tolerance)
    zeros, marginal = scan.zeros()
    heights = result["mean_height"].values[:, row]
    named = np.flatnonzero(~np.isnan(heights))
    named = named[np.argsort(-heights[named])]
    found = [float(heights[i] - amplitude) for i in named]

    def near(d):
        return any(abs(d - m) < 3 * drawn.contact.reach for m in marginal)

    out = {
        "zeros": zeros,
        "found": found,
        "marginal": marginal,
        "off": [],
        "loss": [],
        "grazing": [],
    }
    matched = len(zeros) == len(found)
    out["count"] = "right" if matched else "marginal" if any(map(near, zeros + found)) else "wrong"
    for d in found if zeros else []:
        true = min(zeros, key=lambda zero: abs(zero - d))
        tap = scan.tap(true)
        i = named[found.index(d)]
        allowed = 1e-10 + 0.01 * abs(true + amplitude)
        force = max(abs(tap["force_max"]), abs(tap["force_min"]))
        sound = tap["viscous_loss"] + tap["jumps"]
        loss = float(result["dissipation"].values[i, row])
        floor = 4e-4 * force * amplitude
        out["off"].append(abs(d - true) / allowed)
        out["loss"].append(abs(loss - tap["dissipation"]) / max(abs(tap["dissipation"]), floor))
        out["grazing"].append([loss, tap["dissipation"], sound])
    return out


def measure(seed: int, tolerance: float) -> dict:
    """Time, errors and warnings of the approach curve of a seed."""
    drawn = draw(seed)
    contact, lever, free = drawn
    found = {
        "seed": seed, "tolerance": tolerance,
        "tabor": contact.tabor_relaxed if contact.adhesive else 0,
        "kinds": f"{contact.tip.kind}, {contact.surface.kind}, {contact.sample.kind}",
        "lever": [lever.stiffness, lever.quality_factor, lever.frequency, free],
    }  # fmt: skip
    signal.alarm(_MOST_SECONDS)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sa.AccuracyWarning)
        started = process_time()
        try:
            result = sa.approach_curve(contact, lever, free, RATIOS, tolerance=tolerance)
        except (sa.DivergedError, TimeoutError) as error:
            return {**found, "ending": str(error)}
        found["seconds"], found["taps"] = process_time() - started, int(result.attrs["solver_taps"])
        found["warnings"] = [line[:160] for line in result.attrs["warnings"].splitlines()]
        started = process_time()
        signal.alarm(_MOST_SECONDS)
        try:
            found["rows"] = [compare(drawn, result, i, tolerance / 10) for i in range(len(RATIOS))]
        except (sa.DivergedError, TimeoutError) as error:
            return {**found, "ending": f"scan: {error}"}
        finally:
            signal.alarm(0)
        found["scan_seconds"] = process_time() - started
    return {**found, "ending": "completed"}


def judge(entry: dict) -> str:
    """In a word what is wrong with a curve, or "" if it is right."""
    if entry["ending"].startswith("scan"):
        return ""
    if entry["ending"] != "completed":
        return "gave up"
    rows = entry["rows"]
    if any(row["count"] == "wrong" for row in rows):
        return "solutions"
    if any(off > 1 for row in rows for off in row["off"]):
        return "height"
    if any(off > 0.02 for row in rows for off in row["loss"]):
        return "dissipation"
    return ""


def _stop(signum, frame):
    raise TimeoutError(f"after {_MOST_SECONDS} s")


def main(arguments=None):
    signal.signal(signal.SIGALRM, _stop)
    parser = argparse.ArgumentParser(description="Errors of random approach curves.")
    parser.add_argument("--contacts", type=int, default=36)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--tolerance", type=float, default=1e-2)
    parser.add_argument("--out", type=Path, help="file of results, added to")
    given = parser.parse_args(arguments)
    lines = given.out.read_text().splitlines() if given.out and given.out.exists() else []
    known = {(entry["seed"], entry["tolerance"]): entry for entry in map(json.loads, lines)}
    entries = []
    for seed in range(given.first, given.first + given.contacts):
        entry = known.get((seed, given.tolerance)) or measure(seed, given.tolerance)
        entries.append(entry)
        if given.out and (seed, given.tolerance) not in known:
            with given.out.open("a", encoding="utf-8") as file:
                print(json.dumps(entry), file=file)
        wrong, warned = judge(entry), bool(entry.get("warnings"))
        if wrong or warned:
            print(f"seed {seed}: {wrong or 'right'}{' (warned)' if warned else ''}, "
                  f"{entry['kinds']}, Q {entry['lever'][1]:.3g}, {entry.get('seconds', 0):.2g} s",
                  flush=True)  # fmt: skip
    wrong = np.array([bool(judge(entry)) for entry in entries])
    warned = np.array([bool(entry.get("warnings")) for entry in entries])
    rows = [
        (
            len(entries),
            f"{1 - wrong.mean():.1%}",
            f"{1 - (wrong & ~warned).mean():.1%}",
            f"{(warned & ~wrong).mean():.1%}",
            f"{max(e.get('seconds', 0) for e in entries):.3g}",
        )
    ]
    titles = ("curves", "right", "or warned", "false alarms", "slowest, s")
    common.show("Random approach curves", dict.fromkeys(titles, "right"), rows)
    return entries


if __name__ == "__main__":
    main()
