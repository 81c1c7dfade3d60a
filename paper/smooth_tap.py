"""Convergence of the paper's setups on a tap without an elastic fold.

In the paper: setups A and B serve as exact solutions, and higher orders of Adams and Bashforth are
recommended, without measured orders.

Here: a tap on a stiffer sample (case "smooth-tap" of the tests), where everything must converge.
Errors with growing numbers of nodes (B) and functions (C to G) are against the default solver at a
tolerance of 1e-4, itself good to some 0.03 %; orders of convergence in time against a fine
Runge-Kutta run of the same setup E. Last, how A differs from B with its iteration tolerance.
"""

import common
import numpy as np

from softafm import solvers
from softafm.draw.results import COLOURS

CASE = common.tap_case("smooth-tap")
OBSERVABLES = ("virial", "dissipation", "force_max", "force_min")
DOMAIN = 24e-9
NODES = (35, 70, 140, 200)
FUNCTIONS = (5, 10, 20, 30, 40, 50)
STEPS = (2500, 5000, 10_000, 20_000, 40_000)
STEPPERS = {
    "Euler": solvers.ForwardEuler(),
    **{f"AB{order}": solvers.AdamsBashforth(order) for order in (2, 3, 4, 5)},
    "RK4": solvers.RungeKutta4(),
}
ORDERS = dict(zip(STEPPERS, (1, 2, 3, 4, 5, 4), strict=True))
FINE = ("fine", "RK4", 4 * STEPS[-1])
EXACT = ("exact", "B", 10_000)
ITERATION_TOLERANCES = (1e-3, 1e-6, 1e-9)


def plan():
    """All solvers by (study, setup or stepper, size)."""
    space = {"domain": DOMAIN, "steps": 10_000}
    time = {"domain": common.DOMAIN, "nodes": 70, "functions": 25}
    runs = {
        ("nodes", "B", n): common.setup("B", domain=DOMAIN, nodes=n, steps=20_000) for n in NODES
    }
    for letter in "CDEFG":
        for n in FUNCTIONS:
            key = "functions", letter, n
            runs[key] = common.setup(letter, **space, nodes=140, functions=n)
    runs[FINE] = common.setup("E", **time, steps=FINE[2], stepper=STEPPERS["RK4"])
    for name, stepper in STEPPERS.items():
        for steps in STEPS:
            runs["time", name, steps] = common.setup("E", **time, steps=steps, stepper=stepper)
    runs[EXACT] = common.setup("B", **space)
    for tolerance in ITERATION_TOLERANCES:
        key = "iteration", "A", tolerance
        runs[key] = common.setup("A", **space, iteration_tolerance=tolerance)
    return runs


def main(progress=None):
    """Run all, write, print and draw."""
    jobs = plan().items()
    runs = {
        key: common.tap(CASE.contact, CASE.motion, solver)
        for key, solver in common.tracked(jobs, progress, lambda job: f"{job[0][1]}: {job[0][2]}")
    }
    converged = common.converged_tap(CASE.contact, CASE.motion)
    space = report_space(runs, converged)
    time = report_time(runs)
    report_iteration(runs)
    common.save_figure(draw(space, time), "smooth_tap")


def report_space(runs, converged):
    """Errors of all observables in per cent with nodes and functions."""
    keys = [key for key in runs if key[0] in ("nodes", "functions")]
    errors = {key: [runs[key].error(name, converged) for name in OBSERVABLES] for key in keys}
    header = ("study", "setup", "size", *(f"{name} %" for name in OBSERVABLES))
    rows = [(*key, *of_key) for key, of_key in errors.items()]
    common.report("smooth_tap_space", "Errors; functions at 140 nodes", header, rows)
    return errors


def report_time(runs):
    """Relative errors of V and of the force history against the fine run, and their orders."""
    fine = runs[FINE]
    errors = {}
    for name, steps in [key[1:] for key in runs if key[0] == "time"]:
        run = runs["time", name, steps]
        same = fine.force[:: FINE[2] // steps]
        history = np.abs(run.force - same).max() / np.ptp(same) if run.completed else np.nan
        errors[name, steps] = abs(run.error("virial", fine.observables)) / 100, history
    header = ("stepper", "steps", "V error", "V order", "force error", "force order")
    rows = []
    for (name, steps), (virial, history) in errors.items():
        before = errors.get((name, steps // 2), (np.nan, np.nan))
        orders = np.log2(before[0] / virial), np.log2(before[1] / history)
        rows.append((name, steps, virial, float(orders[0]), history, float(orders[1])))
    common.report("smooth_tap_time", "Setup E in time, by halving the step", header, rows)
    return errors


def report_iteration(runs):
    """How far the forces of A are from those of B."""
    exact = runs[EXACT].force
    header = ("iteration tolerance", "max force difference / peak", "iterations a step")
    rows = []
    for tolerance in ITERATION_TOLERANCES:
        run = runs["iteration", "A", tolerance]
        difference = float(np.abs(run.force - exact).max() / np.abs(exact).max())
        rows.append((tolerance, difference, run.attributes["solver_iterations"] / 10_000))
    common.report("smooth_tap_iteration", "Setup A against B", header, rows)


def draw(space, time):
    """Errors with nodes and functions above, in time below."""
    figure, axes = common.panels(2, 2, 7.4)
    for panel, observable in enumerate(("virial", "dissipation")):
        ax, index = axes[panel], OBSERVABLES.index(observable)
        for letter in "BCDEFG":
            study, sizes = ("nodes", NODES) if letter == "B" else ("functions", FUNCTIONS)
            ax.loglog(
                sizes, [abs(space[study, letter, n][index]) for n in sizes], ".-",
                color=common.SETUP_COLOURS[letter], linewidth=1.2, label=f"{letter}: {study}",
            )  # fmt: skip
        ax.axhline(1, color="black", linestyle="--", linewidth=1)
        ax.set_xticks([5, 10, 20, 50, 100, 200], ["5", "10", "20", "50", "100", "200"])
        ax.minorticks_off()
        ax.set_xlabel("nodes (B) or functions at 140 nodes (C to G)")
        ax.set_ylabel(f"error of {observable} (%)")
        ax.set_title("in space, against the default solver", fontsize=10)
    axes[0].legend(frameon=False, fontsize=9)
    for panel, label in enumerate(("virial V", "force history")):
        ax = axes[2 + panel]
        for colour, (name, order) in zip(COLOURS, ORDERS.items(), strict=False):
            values = np.array([100 * time[name, steps][panel] for steps in STEPS])
            look = {"color": colour, "linewidth": 1.2}
            ax.loglog(STEPS, values, ".-", **look, label=f"{name}: order {order}")
            ax.loglog(STEPS, values[-1] * (STEPS[-1] / np.array(STEPS)) ** order, ":", **look)
        ax.set_xticks(STEPS, [f"{steps:,}".replace(",", " ") for steps in STEPS])
        ax.minorticks_off()
        ax.set_title("in time, setup E against its finest run", fontsize=10)
        ax.set_xlabel("number of steps")
        ax.set_ylabel(f"error of {label} (%)")
    axes[2].set_ylim(1e-10, 40)
    axes[3].set_ylim(1e-9, 100)
    axes[2].legend(frameon=False, fontsize=9, loc="lower left", title="dotted: these orders")
    return figure


if __name__ == "__main__":
    main()
