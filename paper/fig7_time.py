"""Figure 7 of the paper: the time that one cycle takes in the setups A to G.

In the paper: bars of the time of one tap on polyethylene with 10 000 steps. The iterative setup A
takes more than a thousand times as long as E, and E is faster than B if it has fewer functions than
B has nodes.

Here: the same for compiled setups of one program on one machine, and the default solver. Setup A
keeps its kernel as a matrix and chooses its relaxation at every step; a second table shows what A
costs with a relaxation chosen once, and an estimate of an A that evaluates the kernel anew in every
iteration. A second panel shows time against the number of unknowns. Times are those of the solver's
run, without its set-up, which is kept between calls, and without virial and dissipation.
"""

from time import perf_counter

import common
import numpy as np
from scipy.special import ellipkm1

from softafm import solvers

ROUNDS = 5
COMMON = {"nodes": 70, "steps": 10_000, "domain": common.DOMAIN}
SIZES = (10, 20, 25, 30, 35, 40, 50, 60, 70)
RELAXATIONS = (None, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001)
ITERATION_TOLERANCES = (1e-4, 1e-6, 1e-9)


def competitors():
    """Setups as in the paper by name, the default solver last."""
    euler = {"stepper": solvers.ForwardEuler()}
    runs = {f"{letter}, Euler": common.setup(letter, **COMMON, **euler) for letter in "AB"}
    runs |= {letter: common.setup(letter, **COMMON) for letter in "AB"}
    runs |= {letter: common.setup(letter, **COMMON, functions=25) for letter in "CDEFG"}
    return runs | {"default": None}


def sizes():
    """Setups B and E of growing size by (letter, unknowns)."""
    return {("B", n): common.setup("B", **{**COMMON, "nodes": n}) for n in SIZES} | {
        ("E", n): common.setup("E", **COMMON, functions=n) for n in SIZES
    }


def iterations():
    """Setup A by (relaxation, iteration tolerance)."""
    cases = [(None, t) for t in ITERATION_TOLERANCES] + [(r, 1e-6) for r in RELAXATIONS[1:]]
    return {
        (relaxation, tolerance): common.setup(
            "A", **COMMON, relaxation=relaxation, iteration_tolerance=tolerance
        )
        for relaxation, tolerance in cases
    }


def main(progress=None):
    """Time everything: a warm-up, then interleaved rounds, of which the fastest counts."""
    repeated = competitors() | sizes()
    jobs = [(key, solver) for _ in range(1 + ROUNDS) for key, solver in repeated.items()]
    jobs += iterations().items()
    runs = {}
    for key, solver in common.tracked(jobs, progress, lambda job: f"timing {job[0]}"):
        runs.setdefault(key, []).append(common.tap(common.LDPE, common.DEEP_TAP, solver))
    # Time in ms, and the run itself.
    fastest = {key: (min(map(milliseconds, of_key)), of_key[-1]) for key, of_key in runs.items()}
    converged = common.converged_tap(common.LDPE, common.DEEP_TAP)
    report_times(fastest, converged)
    report_sizes(fastest, converged)
    report_iterations(fastest)
    common.save_figure(draw(fastest), "fig7_time")


def milliseconds(run):
    """Time of a run without set-up; NaN if it stopped."""
    return 1e3 * run.attributes.get("solver_wall_time", np.nan)


def errors(run, converged):
    """Errors of virial and dissipation in per cent."""
    return [run.error(key, converged) for key in ("virial", "dissipation")]


def report_times(fastest, converged):
    """Table of the paper's setups."""
    header = ("setup", "ms", "time / E", "time / default", "V error %", "E error %", "ending")
    rows = []
    for name in competitors():
        time, run = fastest[name]
        ratios = time / fastest["E"][0], time / fastest["default"][0]
        rows.append((name, time, *ratios, *errors(run, converged), run.ending))
    common.write_csv("fig7_time", header, rows)
    common.show("Time of one cycle, fastest of interleaved rounds", header, rows)


def report_sizes(fastest, converged):
    """Table of B and E of growing size."""
    header = ("setup", "unknowns", "ms", "V error %", "E error %")
    rows = [(*key, fastest[key][0], *errors(fastest[key][1], converged)) for key in sizes()]
    common.write_csv("fig7_time_sizes", header, rows)
    common.show("Setup B with so many nodes; E with so many functions, 70 nodes", header, rows)


def report_iterations(fastest):
    """Table of setup A's iteration, and the estimate of one without a stored matrix."""
    header = ("relaxation", "iteration tolerance", "ms", "time / E", "iterations a step", "ending")
    rows = []
    for key in iterations():
        time, run = fastest[key]
        per_step = run.attributes.get("solver_iterations", np.nan) / COMMON["steps"]
        rows.append((key[0] or "chosen", key[1], time, time / fastest["E"][0], per_step,
                     run.ending))  # fmt: skip
    common.write_csv("fig7_time_iterations", header, rows)
    common.show("Setup A", header, rows)
    kernel = kernel_milliseconds()
    ratios = [
        f"{row[4] * COMMON['steps'] * kernel / fastest['E'][0]:,.0f} (relaxation {row[0]})"
        for row in rows
        if row[0] in ("chosen", 0.02, 0.001) and row[1] == 1e-6
    ]
    print(f"Evaluating the kernel between all nodes takes {kernel:.2f} ms; done in every iteration "
          f"it would make A slower than E by factors of {', '.join(ratios)}.")  # fmt: skip


def kernel_milliseconds():
    """Time of evaluating the elliptic integral between all nodes once, ms."""
    parameter = np.random.default_rng(0).uniform(0.01, 1, COMMON["nodes"] ** 2)
    times = []
    for _ in range(20):
        started = perf_counter()
        ellipkm1(parameter)
        times.append(perf_counter() - started)
    return 1e3 * min(times)


def draw(fastest):
    """Bars of the setups, and curves against the number of unknowns."""
    figure, (bars, curves) = common.panels(1, 2, 4.2, width_ratios=(1.25, 1))
    names = list(competitors())
    times = [fastest[name][0] for name in names]
    colours = [common.SETUP_COLOURS.get(name[0], "0.5") for name in names]
    drawn = bars.barh(range(len(names)), times, color=colours, log=True)
    bars.bar_label(drawn, [f"{time:.0f} ms" for time in times], padding=4, fontsize=9)
    bars.set_yticks(range(len(names)), names)
    bars.invert_yaxis()
    bars.set_xlim(1, 6 * max(times))
    bars.set_xlabel("time of one cycle (ms)")
    looks = {"B": ("o-", "B: nodes"), "E": ("s-", "E: functions (70 nodes)")}
    for letter, (look, label) in looks.items():
        values = [fastest[letter, n][0] for n in SIZES]
        curves.plot(SIZES, values, look, color=common.SETUP_COLOURS[letter], label=label)
    for key, label in {"B": "B with 70 nodes", "default": "default solver"}.items():
        curves.axhline(fastest[key][0], color="black", linewidth=1, linestyle=":")
        curves.text(9, 1.04 * fastest[key][0], label, va="bottom", fontsize=9)
    curves.set_yscale("log")
    curves.set_xlabel("number of nodes or functions")
    curves.set_ylabel("time of one cycle (ms)")
    curves.legend(frameon=False, fontsize=9, loc=(0.02, 0.2))
    return figure


if __name__ == "__main__":
    main()
