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

from timeit import repeat

import common
import numpy as np
from scipy.special import ellipkm1

from softafm import solvers

ROUNDS = 5
COMMON = {"nodes": 70, "steps": 10_000, "domain": common.DOMAIN}
SIZES = (10, 20, 25, 30, 35, 40, 50, 60, 70)
RELAXATIONS = (0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001)
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
    nodal = {("B", n): common.setup("B", **COMMON | {"nodes": n}) for n in SIZES}
    return nodal | {("E", n): common.setup("E", **COMMON, functions=n) for n in SIZES}


def iterations():
    """Setup A by (relaxation, iteration tolerance)."""
    cases = [(None, t) for t in ITERATION_TOLERANCES] + [(r, 1e-6) for r in RELAXATIONS]
    return {
        (w, t): common.setup("A", **COMMON, relaxation=w, iteration_tolerance=t) for w, t in cases
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
    report_times("fig7_time", "Time of one cycle", competitors(), fastest)
    report_times("fig7_time_sizes", "B by nodes; E by functions", sizes(), fastest)
    report_iterations(fastest)
    common.save_figure(draw(fastest), "fig7_time")


def milliseconds(run):
    """Time of a run without set-up; NaN if it stopped."""
    return 1e3 * run.attributes.get("solver_wall_time", np.nan)


def report_times(name, title, keys, fastest):
    """Table of times, their ratios and errors."""
    converged = common.converged_tap(common.LDPE, common.DEEP_TAP)
    header = ("setup", "ms", "/ E", "/ default", "V error %", "E error %", "ending")
    rows = []
    for key in keys:
        time, run = fastest[key]
        ratios = time / fastest["E"][0], time / fastest["default"][0]
        errors = [run.error(of, converged) for of in ("virial", "dissipation")]
        label = key if isinstance(key, str) else f"{key[0]}, {key[1]}"
        rows.append((label, time, *ratios, *errors, run.ending))
    common.report(name, title, header, rows)


def report_iterations(fastest):
    """Table of setup A's iteration, and the estimate of one without a stored matrix."""
    header = ("relaxation", "tolerance", "ms", "time / E", "iterations/step", "ending")
    rows = []
    for key in iterations():
        time, run = fastest[key]
        per_step = run.attributes.get("solver_iterations", np.nan) / COMMON["steps"]
        rows.append((key[0] or "chosen", key[1], time, time / fastest["E"][0], per_step,
                     run.ending))  # fmt: skip
    common.report("fig7_time_iterations", "Setup A", header, rows)
    kernel = kernel_milliseconds()
    ratios = [
        f"{row[4] * COMMON['steps'] * kernel / fastest['E'][0]:,.0f} (relaxation {row[0]})"
        for row in rows
        if row[0] in ("chosen", 0.02, 0.001) and row[1] == 1e-6
    ]
    print(
        f"Evaluating the kernel between all nodes takes {kernel:.2f} ms; done in every iteration "
        f"it would make A slower than E by factors of {', '.join(ratios)}."
    )


def kernel_milliseconds():
    """Time of evaluating the elliptic integral between all nodes once, ms."""
    parameter = np.random.default_rng(0).uniform(0.01, 1, COMMON["nodes"] ** 2)
    return 1e3 * min(repeat(lambda: ellipkm1(parameter), number=1, repeat=20))


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
