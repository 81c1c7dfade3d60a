"""Is the tolerance the error, and is the cost as foretold? Experiments as people make them.

Every seed is an experiment of ``contacts.py``. It is run at the tolerance, at a tenth of it, and
where the two disagree finer still, in a process that is ended once a run takes too long. Each
observable is measured against itself: forces relative to the larger of itself and 1 % of the
largest force; energies to the larger of itself and 2 % of the largest force times the range of the
law, of taps times 2 % of the amplitude. Solutions of approach curves may be off by 1 % + 0.1 nm in
height and 2 % in dissipation at tolerance 1e-2, in proportion at others; none may be missing or
invented. Warnings that doubt the model, or say what a table shows, excuse no error and are no false
alarm: only those that doubt the numbers count as a warning.

Results are added to a file, one JSON object a line, and what stands there already is not run again:
take a new file for a new version of softafm.

    python benchmarks/accuracy.py --out FILE [--contacts N] [--first SEED] [--tolerances 0.01 ...]
                                  [--limit SECONDS] [--worst N]
"""

import argparse
import json
import multiprocessing
import resource
import signal
import warnings
from dataclasses import replace
from pathlib import Path
from time import process_time, thread_time

import common
import contacts
import numpy as np

import softafm as sa
from softafm.experiment.regime import estimate_seconds
from softafm.modes import MODES
from softafm.modes.regularise import regularise_contact

FORCES = ("force_max", "force_min", "force_min_approach", "force_mean")
ENERGIES = ("loop_energy", "virial", "dissipation", "viscous_loss")
SOLUTIONS = ("mean_height", "dissipation", "force_max", "force_min")
NO_DOUBT = (
    "the lever does not move as the sine", "one amplitude has several stable",
    "no height goes with any", "audit: the tip is still in contact", "regularised by itself",
    "the motion lasts",
)  # fmt: skip
"""How warnings begin that do not doubt the numbers: of the model's second harmonic, which no
tolerance mends, of what a table holds, of a motion that ends too early, and of a law or a sample
that is not quite the one asked for. The finer runs share all of that."""
SLOW, FACTOR = 60.0, 3.0
"""Time a run should not take, s of one core, and by what factor it may differ from the forecast."""


class Runner:
    """Runs experiments in a process of its own, which the system ends when one takes too long."""

    def __init__(self) -> None:
        self.process: multiprocessing.process.BaseProcess | None = None

    def run(self, seed: int, tolerance: float, limit: float) -> dict:
        """Return what ``perform`` found, or how it ended."""
        if self.process is None:
            context = multiprocessing.get_context("spawn")
            self.pipe, other = context.Pipe()
            self.process = context.Process(target=serve, args=(other,), daemon=True)
            self.process.start()
            other.close()
        self.pipe.send((seed, tolerance, limit))
        try:
            return self.pipe.recv()
        except EOFError:
            self.process.join()
            code, self.process = self.process.exitcode, None
            if code == -signal.SIGXCPU:
                return {"ending": f"ended after {limit:g} s", "seconds": limit}
            return {"ending": f"the process ended with {code}", "seconds": 0.0}

    def stop(self) -> None:
        """End the process."""
        if self.process is not None:
            self.process.terminate()
            self.process.join()


def serve(pipe) -> None:
    """Run what is asked for, one after the other, each for a limited time of the processor."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    warnings.simplefilter("ignore")
    load_compiled()
    while True:
        seed, tolerance, limit = pipe.recv()
        experiment = replace(contacts.draw(seed), tolerance=tolerance)
        compile_parts(experiment.contact)
        resource.setrlimit(resource.RLIMIT_CPU, (int(process_time() + limit) + 1, -1))
        found = perform(experiment)
        resource.setrlimit(resource.RLIMIT_CPU, (-1, -1))
        pipe.send(found)


def load_compiled() -> None:
    """Load what is compiled: contacts that are stiff and slack, ramps with a lever, steady taps."""
    tip, law = sa.Paraboloid(1e-8), sa.LennardJones(1e-19, 3e-10)
    lever = sa.Cantilever(1.0)
    for modulus in 1e9, 1e7:
        sample = sa.StandardLinearSolid.from_relaxation_time(modulus, modulus / 10, 1e-4, 0.3)
        for each in sa.Elastic(modulus, 0.3), sample:
            contact = sa.Contact(tip, each, law)
            sa.force_spectroscopy(contact, lever, sa.Triangle(9e-9, 0.0, 1e-6))
        sa.tapping_cycle(contact, 1e-8, 1e-8, 1e5, cycles="steady")


def compile_parts(contact: sa.Contact) -> tuple:
    """Return the compiled law and profile of a contact, so that its run need not compile them."""
    return contact.surface.compiled_pressure, contact.tip.compiled_profile


def perform(experiment) -> dict:
    """Run an experiment; return its observables, seconds of the processor and warnings."""
    # With a limit set, the clock of the process goes by ticks of milliseconds.
    started = thread_time()
    try:
        result = experiment.run()
    except (sa.DivergedError, ValueError, ArithmeticError) as error:
        return {"ending": f"{type(error).__name__}: {error}", "seconds": thread_time() - started}
    names = SOLUTIONS if "branch" in result.dims else (*FORCES, *ENERGIES)
    return {
        "ending": "completed",
        "seconds": thread_time() - started,
        "warnings": str(result.attrs["warnings"]),
        "values": {name: result[name].values.tolist() for name in names if name in result},
        "jumps": result.sizes.get("jump", 0),
        "steps": int(result.attrs.get("solver_attempted_steps", 0)),
    }


def compare(experiment, found: dict, truth: dict) -> dict[str, float]:
    """Return the error of every observable, as a part of what it is measured against."""
    value = {name: np.asarray(found[name]) for name in found}
    exact = {name: np.asarray(truth[name]) for name in truth}
    force = np.fmax(np.abs(exact["force_max"]), np.abs(exact["force_min"]))
    if experiment.mode == "approach-curve":
        amplitude = experiment.motion.free_amplitude * np.array(experiment.motion.amplitude_ratio)
        return compare_solutions(value, exact, 0.02 * force * 0.02 * amplitude)
    length = find_computed(experiment).reach
    if experiment.mode == "tapping-cycle":
        length = 0.02 * experiment.motion.amplitude
    least = dict.fromkeys(FORCES, 0.01 * force) | dict.fromkeys(ENERGIES, 0.02 * force * length)
    return {
        name: float(np.abs(value[name] - exact[name]) / max(np.abs(exact[name]), least[name]))
        for name in value
    }


def find_computed(experiment) -> sa.Contact:
    """Return the contact that is computed, regularised or not."""
    return regularise_contact(
        experiment.contact, experiment.regularise, MODES[experiment.mode], experiment.motion
    )


def compare_solutions(value: dict, exact: dict, least: np.ndarray) -> dict[str, float]:
    """Return the errors of solutions, as parts of a hundred times what they may be off by."""
    found, there = (np.isfinite(each["mean_height"]) for each in (value, exact))
    if (found != there).any():
        return {"solutions": np.inf}
    if not found.any():
        return {"solutions": 0.0}
    height, energy = exact["mean_height"], exact["dissipation"]
    off = 0.01 * np.abs(value["mean_height"] - height) / (0.01 * np.abs(height) + 1e-10)
    lost = 0.5 * np.abs(value["dissipation"] - energy) / np.fmax(np.abs(energy), least)
    return {"mean_height": float(np.nanmax(off)), "dissipation": float(np.nanmax(lost))}


def measure(runner: Runner, seed: int, tolerance: float, limit: float) -> dict:
    """Return the errors, cost and fate of a seed at a tolerance.

    The ``error`` is the largest, None where there is no finer run to measure against. Where the
    first of these disagrees, ``doubt`` is by how much it differs from the one that decides.
    """
    experiment = replace(contacts.draw(seed), tolerance=tolerance)
    contact = experiment.contact
    entry = {
        "seed": seed, "tolerance": tolerance, "mode": experiment.mode, "tip": contact.tip.kind,
        "law": contact.surface.kind, "sample": contact.sample.kind, "error": None,
        "tabor": contact.tabor_softened, "regularised": find_computed(experiment) is not contact,
        "expected": estimate_seconds(experiment), **runner.run(seed, tolerance, limit),
    }  # fmt: skip
    if "values" not in entry:
        return entry
    truth = runner.run(seed, max(tolerance / 10, 1e-5), limit)
    if "values" not in truth:
        return {**entry, "no_truth": truth["ending"]}
    errors = compare(experiment, entry["values"], truth["values"])
    if not max(errors.values()) <= tolerance:
        finer = runner.run(seed, max(tolerance / 30, 1e-5), limit)
        if "values" in finer:
            doubt = compare(experiment, truth["values"], finer["values"])
            entry["doubt"] = max(doubt.values())
            truth, errors = finer, compare(experiment, entry["values"], finer["values"])
    worst = max(errors, key=errors.__getitem__)
    return {
        **entry, "truth": truth["values"], "truth_jumps": truth["jumps"], "errors": errors,
        "worst": worst, "error": errors[worst],
    }  # fmt: skip


def battery(seeds, tolerances, limit: float, out: Path) -> list[dict]:
    """Measure what the file lacks, adding to it line by line; return all that was asked for."""
    lines = out.read_text(encoding="utf-8").splitlines() if out.exists() else []
    found = {(entry["seed"], entry["tolerance"]): entry for entry in map(json.loads, lines)}
    runner = Runner()
    for tolerance in tolerances:
        for seed in seeds:
            if (seed, tolerance) not in found:
                entry = found[seed, tolerance] = measure(runner, seed, tolerance, limit)
                with out.open("a", encoding="utf-8") as file:
                    print(json.dumps(entry), file=file)
    runner.stop()
    return [found[seed, tolerance] for tolerance in tolerances for seed in seeds]


def judge(entry: dict) -> dict[str, bool]:
    """Return what can be said of a run."""
    completed, error = entry["ending"] == "completed", entry["error"]
    within = error is not None and error <= entry["tolerance"]
    warned = doubts_numbers(entry)
    slow = entry["seconds"] > SLOW
    gaps = entry["mode"] == "approach-curve"  # where there is no solution
    values = [] if gaps else list(entry.get("values", {}).values())
    return {
        "within": within,
        "or warned": within or (completed and warned),
        "gave up": not completed and not slow,
        "over 60 s": slow,
        "NaN": bool(np.isnan(values).any()),
        "no truth": "no_truth" in entry,
        "false alarm": within and warned,
        "cost": 1 / FACTOR <= entry["expected"] / max(entry["seconds"], 1e-3) <= FACTOR,
    }


def doubts_numbers(entry: dict) -> bool:
    """Return whether a run warned of its numbers."""
    lines = entry.get("warnings", "").splitlines()
    return any(not line.startswith(NO_DOUBT) for line in lines)


def report(entries: list[dict], worst: int) -> None:
    """Print the shares of all and of every group, and a list of the worst runs."""
    for tolerance in sorted({entry["tolerance"] for entry in entries}, reverse=True):
        some = [entry for entry in entries if entry["tolerance"] == tolerance]
        rows = [("all", *shares(some))]
        for key in ("mode", "sample", "law", "tip"):
            for name in sorted({entry[key] for entry in some}):
                rows.append((name, *shares([entry for entry in some if entry[key] == name])))
        titles = ("", "runs", *judge(some[0]))
        common.show(f"Tolerance {tolerance:g}", dict.fromkeys(titles, "right"), rows)
        report_costs(some)
        missed = [entry for entry in some if not judge(entry)["within"]]
        missed.sort(key=lambda e: (not judge(e)["or warned"], e["error"] or np.inf), reverse=True)
        for entry in missed[:worst]:
            print(describe(entry))


def report_costs(entries: list[dict]) -> None:
    """Print how many times as long as forecast runs take: the forecast's constants follow it."""
    rows = []
    for mode in ("all", *sorted({entry["mode"] for entry in entries})):
        some = [entry for entry in entries if mode in ("all", entry["mode"])]
        ratios = [entry["seconds"] / entry["expected"] for entry in some]
        rows.append((mode, *(f"{each:.2g}" for each in np.percentile(ratios, [5, 25, 50, 75, 95]))))
    titles = ("", "5 %", "25 %", "median", "75 %", "95 %")
    common.show("Time over its forecast", dict.fromkeys(titles, "right"), rows)


def shares(entries: list[dict]) -> tuple:
    """Return how many runs there are, and the share of each judgement as text."""
    judged = [judge(entry) for entry in entries]
    return len(entries), *(f"{np.mean([j[name] for j in judged]):.1%}" for name in judged[0])


def describe(entry: dict) -> str:
    """Return a line on a run."""
    fate = entry["ending"]
    if fate == "completed":
        fate = f"not known ({entry.get('no_truth')})"
    if entry["error"] is not None:
        fate = f"{entry['error']:.2%} in {entry['worst']}"
        fate += f", finer ones differ by {entry['doubt']:.2%}" if "doubt" in entry else ""
    kinds = ", ".join(entry[key] for key in ("mode", "tip", "law", "sample"))
    warned = "; warned" if doubts_numbers(entry) else ""
    return f"seed {entry['seed']}: {fate}{warned}; {kinds}, Tabor {entry['tabor']:.2g}"


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Errors and costs of experiments drawn at random.")
    parser.add_argument("--contacts", type=int, default=600)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--tolerances", type=float, nargs="+", default=[1e-2])
    parser.add_argument("--limit", type=float, default=1.5 * SLOW, help="of a run, s of one core")
    parser.add_argument("--worst", type=int, default=30, help="how many to list")
    parser.add_argument("--out", type=Path, required=True, help="file of results, added to")
    given = parser.parse_args(arguments)
    seeds = range(given.first, given.first + given.contacts)
    entries = battery(seeds, given.tolerances, given.limit, given.out)
    report(entries, given.worst)
    return entries


if __name__ == "__main__":
    main()
