"""Convergence of the paper's setups on a tap without an elastic fold.

In the paper: setups A and B serve as exact solutions, and higher orders of Adams and Bashforth are
recommended, without measured orders.

Here: a tap on a stiffer sample (case "smooth-tap" of the tests), where everything must converge.
Errors against the default solver at a tolerance of 1e-4 with growing numbers of nodes (B) and
functions (C to G); orders of convergence in time of all steppers against a fine Runge-Kutta run of
the same setup E; and the difference of A and B against the tolerance of A's iteration.
"""

import common
import numpy as np

from softafm import solvers
from softafm.plotting import COLOURS

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
REFERENCE = ("time", "reference")
ITERATION_TOLERANCES = (1e-3, 1e-6, 1e-9)


def plan():
    """All solvers by (study, setup or stepper, size)."""
    space = {"domain": DOMAIN, "steps": 10_000}
    time = {"domain": common.DOMAIN, "nodes": 70, "functions": 25}
    nodal = {"domain": DOMAIN, "nodes": 70, "steps": 10_000}
    runs = {
        ("nodes", "B", n): common.setup("B", nodes=n, **space | {"steps": 20_000}) for n in NODES
    }
    runs |= {
        ("functions", letter, n): common.setup(letter, nodes=140, functions=n, **space)
        for letter in "CDEFG"
        for n in FUNCTIONS
    }
    fine = common.setup("E", **time, steps=4 * STEPS[-1], stepper=STEPPERS["RK4"])
    runs |= {(*REFERENCE, 4 * STEPS[-1]): fine}
    runs |= {
        ("time", name, steps): common.setup("E", **time, steps=steps, stepper=stepper)
        for name, stepper in STEPPERS.items()
        for steps in STEPS
    }
    runs |= {("iteration", "B", 0.0): common.setup("B", **nodal)}
    return runs | {
        ("iteration", "A", t): common.setup("A", **nodal, iteration_tolerance=t)
        for t in ITERATION_TOLERANCES
    }


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
    errors = {
        key: [run.error(name, converged) for name in OBSERVABLES]
        for key, run in runs.items()
        if key[0] in ("nodes", "functions")
    }
    header = ("study", "setup", "size", *(f"{name} %" for name in OBSERVABLES), "ending")
    rows = [(*key, *of_key, runs[key].ending) for key, of_key in errors.items()]
    common.write_csv("smooth_tap_space", header, rows)
    common.show("Errors with nodes, and with functions at 140 nodes", header, rows)
    return errors


def report_time(runs):
    """Relative errors of V and of the force history against the fine run, and their orders."""
    fine = runs[*REFERENCE, 4 * STEPS[-1]]
    errors = {}
    for key, run in runs.items():
        if key[0] != "time" or key[:2] == REFERENCE:
            continue
        virial = abs(run.error("virial", fine.observables)) / 100
        same = fine.force[:: 4 * STEPS[-1] // key[2]]
        history = np.abs(run.force - same).max() / np.ptp(same) if run.completed else np.nan
        errors[key[1:]] = virial, history
    header = ("stepper", "steps", "V error", "V order", "force error", "force order")
    rows = []
    for (name, steps), (virial, history) in errors.items():
        before = errors.get((name, steps // 2), (np.nan, np.nan))
        orders = np.log2(before[0] / virial), np.log2(before[1] / history)
        rows.append((name, steps, virial, float(orders[0]), history, float(orders[1])))
    common.write_csv("smooth_tap_time", header, rows)
    common.show("Errors in time of setup E, and orders from each halving of the step", header, rows)
    return errors


def report_iteration(runs):
    """How far the forces of A are from those of B."""
    exact = runs["iteration", "B", 0.0].force
    header = ("iteration tolerance", "max force difference / peak", "iterations a step")
    rows = []
    for tolerance in ITERATION_TOLERANCES:
        run = runs["iteration", "A", tolerance]
        difference = float(np.abs(run.force - exact).max() / np.abs(exact).max())
        rows.append((tolerance, difference, run.attributes["solver_iterations"] / 10_000))
    common.write_csv("smooth_tap_iteration", header, rows)
    common.show("Setup A against B", header, rows)


def draw(space, time):
    """Errors with nodes and functions above, in time below."""
    figure, axes = common.panels(2, 2, 7.4)
    for panel, observable in enumerate(("virial", "dissipation")):
        ax, index = axes[panel], OBSERVABLES.index(observable)
        for (study, letter), sizes in {
            ("nodes", "B"): NODES, **{("functions", letter): FUNCTIONS for letter in "CDEFG"}
        }.items():  # fmt: skip
            ax.loglog(
                sizes, [abs(space[study, letter, n][index]) for n in sizes], ".-",
                color=common.SETUP_COLOURS[letter], linewidth=1.2, label=f"{letter}: {study}",
            )  # fmt: skip
        ax.axhline(1, color="black", linestyle="--", linewidth=1)
        ax.set_xlabel("nodes (B) or functions at 140 nodes (C to G)")
        ax.set_ylabel(f"error of {observable} (%)")
    axes[0].legend(frameon=False, fontsize=9)
    for panel, label in enumerate(("virial V", "force, largest over the cycle")):
        ax = axes[2 + panel]
        for colour, name in zip(COLOURS, STEPPERS, strict=False):
            values = [100 * time[name, steps][panel] for steps in STEPS]
            ax.loglog(STEPS, values, ".-", color=colour, linewidth=1.2, label=name)
        for order in (1, 2, 4):
            guide = [10 ** (1.6 - order) * (STEPS[0] / steps) ** order for steps in STEPS[1:3]]
            ax.loglog(STEPS[1:3], guide, color="0.5", linewidth=3, alpha=0.5)
            ax.text(STEPS[2], guide[-1], f" order {order}", color="0.3", fontsize=9, va="center")
        ax.set_xlabel("number of steps")
        ax.set_ylabel(f"error of {label} (%)")
    axes[2].legend(frameon=False, fontsize=9, loc="lower left")
    return figure


if __name__ == "__main__":
    main()
