"""Figure 3 of the paper: force-distance curves of triangular motions at 5, 2 and 1 µm/s.

In the paper: a paraboloid of 10 µm goes 10 nm deep into a sample of 10 and 1 GPa, as in Attard's
first calculation, and the curves of both agree excellently.

Here: setups A, B and E and the default solver, drawn over each other. Attard's reduced moduli can
be read in two ways. As printed, they are those of this package and the surface never jumps. In his
own convention they are half as large; at 5 and 2 µm/s the surface then crosses an elastic fold at
pull-off, where a setup may stop (fig3_triangle_halved.png).
"""

from itertools import product

import common
import numpy as np
from matplotlib.lines import Line2D

import softafm as sa

READINGS = {"fig3_triangle": 1.0, "fig3_triangle_halved": 0.5}
SPEEDS = 5, 2, 1
STYLES = {
    "default": {"color": "0.82", "linewidth": 9, "solid_capstyle": "round"},
    "A": {"color": common.SETUP_COLOURS["A"], "linewidth": 4.5},
    "B": {"color": common.SETUP_COLOURS["B"], "linewidth": 1.6, "linestyle": (0, (4, 2))},
    "E": {"color": common.SETUP_COLOURS["E"], "linewidth": 1.6, "linestyle": (3, (3, 3))},
}
OBSERVABLES = {"force_max": "N", "force_min": "N", "force_min_approach": "N", "loop_energy": "J"}


def contact(share):
    """Attard's contact with this share of the printed moduli."""
    return sa.Contact(
        sa.Paraboloid(10e-6),
        sa.StandardLinearSolid(share * 10e9, share * 1e9, creep_time=1e-3, poisson=0.0),
        sa.LennardJones(1e-19, 0.5e-9),
    )


def main(progress=None):
    """Run both readings."""
    common.warm_up()
    runs, converged = {}, {}
    for job in common.tracked(
        product(READINGS, SPEEDS, STYLES), progress, lambda job: f"{job[1]} µm/s, {job[2]}"
    ):
        name, speed, letter = job
        given = contact(READINGS[name]), sa.Triangle(10e-9, -10e-9, speed * 1e-6)
        if letter == "default":
            converged[name, speed] = common.force_curve(*given, tolerance=1e-3).observables
        solver = None if letter == "default" else common.setup(letter)
        runs[job] = common.force_curve(*given, solver)
    report(runs, converged)
    for name in READINGS:
        draw(name, {job[1:]: run for job, run in runs.items() if job[0] == name})


def report(runs, converged):
    """Write and print what came out."""
    table, summary = [], []
    for (name, speed, letter), run in runs.items():
        ending = "-" if run.completed else run.ending
        values = [run.observables.get(key, np.nan) for key in OBSERVABLES]
        errors = [run.error(key, converged[name, speed]) for key in OBSERVABLES]
        given = 10 * READINGS[name], speed, letter
        table.append([*given, *values, *errors, run.seconds, run.ending, run.warned])
        shown = ("-" if np.isnan(error) else f"{error:+.2f}" for error in errors)
        summary.append([*given, *shown, f"{run.seconds:.2f}", ending])
    common.write_csv(
        "fig3_triangle",
        ("reduced_E0_GPa", "speed_um_per_s", "solver",
         *(f"{key}_{unit}" for key, unit in OBSERVABLES.items()),
         *(f"{key}_error_percent" for key in OBSERVABLES), "seconds", "ending", "warned"),
        table,
    )  # fmt: skip
    common.show(
        "Errors of forces and loop energy, % (converged: default solver, tolerance 1e-3)",
        ("GPa", "µm/s", "solver", "max", "min", "min, in", "loop", "s", "stopped"),
        summary,
    )  # fmt: skip


def draw(name, runs):
    """Draw one panel a speed, the curves of all solvers over each other."""
    figure, axes = common.panels(1, len(SPEEDS), 4.2, sharey=True)
    moduli = f"reduced moduli {10 * READINGS[name]:g} and {READINGS[name]:g} GPa"
    figure.suptitle(f"Attard's triangle: {moduli}", fontsize=11)
    for ax, speed in zip(axes, SPEEDS, strict=True):
        for letter, style in STYLES.items():
            run = runs[speed, letter]
            common.curve(ax, run, 1e9 * run.tip_height, 1e6 * run.force, **style)
        away = runs[speed, "default"]
        at = 1e9 * away.tip_height[away.force < away.observables["force_min"] / 10][-1]
        drop = 1e6 * away.observables["force_min"]
        common.zoom(ax, (0.5, 0.53, 0.47, 0.43), (at - 1.2, at + 0.6), (1.02 * drop, 0.12))
        ax.axhline(0, color="0.6", linewidth=0.6, zorder=0)
        ax.set_title(f"{speed} µm/s", fontsize=11)
        ax.set_xlabel("tip height $h_0$ (nm)")
    axes[0].set_ylabel("force on the tip (µN)")
    names = ("default solver", *(f"setup {letter}" for letter in "ABE"))
    entries = [
        Line2D([], [], label=label, **style)
        for label, style in zip(names, STYLES.values(), strict=True)
    ]
    if not all(run.completed for run in runs.values()):
        entries.append(common.END_ENTRY)
    figure.legend(
        handles=entries, loc="outside lower center", ncols=5, frameon=False, handlelength=3.2
    )
    common.save_figure(figure, name)


if __name__ == "__main__":
    common.run(main)
