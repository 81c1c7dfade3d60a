"""Figure 4 of the paper: which adhesion the time steppers of setup E survive.

In the paper: taps on polyethylene with ever smaller z0, that is, larger adhesion; two-step
Adams-Bashforth stays stable where forward Euler does not.

Here: both steppers with four numbers of steps, and the default solver. A run "survives" if it
completes with virial and dissipation within 10 % of the converged ones: others complete with wrong
numbers.
"""

from dataclasses import replace
from itertools import product

import common
import numpy as np
from matplotlib import colormaps
from matplotlib.lines import Line2D
from matplotlib.ticker import NullLocator

import softafm as sa
from softafm import solvers

GAPS = 0.5, 0.4, 0.35, 0.3, 0.25, 0.22, 0.2, 0.15, 0.12, 0.1
"""Equilibrium gaps z0, nm."""
MOTION = sa.Sine(mean_height=28e-9, amplitude=31e-9, frequency=278e3, cycles=1)
STEPPERS = {"Euler": solvers.ForwardEuler(), "AB2": solvers.AdamsBashforth(2)}
RUNS = (*product(STEPPERS, (3000, 10_000, 30_000, 100_000)), ("default", 0))
DRAWN = {
    "E, two-step Adams-Bashforth\n10 000 steps": ("AB2", 10_000),
    "E, forward Euler\n10 000 steps": ("Euler", 10_000),
    "default solver\n(100 to 450 steps)": ("default", 0),
}
TOLERATED = 10
"""Deviation up to which a run survives, %."""


def main(progress=None):
    """Tap with every z0 and stepper."""
    common.warm_up()
    runs, converged = {}, {}
    for job in common.tracked(
        product(GAPS, RUNS), progress, lambda job: f"z0 = {job[0]} nm, {job[1][0]}"
    ):
        z0, (stepper, steps) = job
        contact = replace(common.LDPE, surface=sa.LennardJones(1e-19, z0 * 1e-9))
        if z0 not in converged:
            converged[z0] = common.tap(contact, MOTION, tolerance=1e-3).observables
        solver = common.setup("E", steps=steps, stepper=STEPPERS[stepper]) if steps else None
        runs[job] = common.tap(contact, MOTION, solver)
    errors = {job: deviations(run.observables, converged[job[0]]) for job, run in runs.items()}
    common.write_csv(
        "fig4_stability",
        ("z0_nm", "solver", "stepper", "steps", "ending", "virial_J", "dissipation_J",
         "virial_error_percent", "dissipation_error_percent", "survived", "warned", "seconds"),
        ((z0, "E" if steps else "default", stepper if steps else "", steps or "", run.ending,
          *(run.observables.get(key, np.nan) for key in ("virial", "dissipation")),
          *errors[z0, (stepper, steps)], max(map(abs, errors[z0, (stepper, steps)])) <= TOLERATED,
          run.warned, run.seconds)
         for (z0, (stepper, steps)), run in runs.items()),
    )  # fmt: skip
    common.show(
        "Larger error of V and E, %: in brackets above 10, a dash where a run stopped",
        ("z0, nm", *(f"{name} {steps // 1000}k" if steps else name for name, steps in RUNS)),
        ([z0, *(verdict(errors[z0, run]) for run in RUNS)] for z0 in GAPS),
    )
    draw(runs)


def deviations(observables, converged):
    """Errors of virial and dissipation, %.

    The virial changes its sign as z0 falls: it is judged by at least 2 % of the largest force times
    the amplitude.
    """
    force = max(abs(converged["force_max"]), abs(converged["force_min"]))
    scales = {"virial": max(abs(converged["virial"]), 0.02 * force * MOTION.amplitude)}
    scales["dissipation"] = abs(converged["dissipation"])
    return [100 * (observables.get(key, np.nan) - converged[key]) / s for key, s in scales.items()]


def verdict(errors):
    """Put the errors of a run in one cell."""
    worst = max(map(abs, errors))
    if np.isnan(worst):
        return "-"
    return f"{worst:.1f}" if worst <= TOLERATED else f"({worst:.0f})"


def draw(runs):
    """Draw force against time, one panel a solver."""
    figure, axes = common.panels(1, len(DRAWN), 5.0, sharey=True)
    colours = colormaps["turbo"](np.linspace(0.03, 0.97, len(GAPS)))
    for ax, (title, which) in zip(axes, DRAWN.items(), strict=True):
        for z0, colour in zip(GAPS, colours, strict=True):
            run = runs[z0, which]
            time = 1e6 * (run.time - 0.5 / MOTION.frequency)
            common.curve(ax, run, time, 1e9 * run.force, color=colour, linewidth=1.3)
        ax.set_title(title, fontsize=11)
        ax.set_xlabel("time from the lowest point (µs)")
        ax.set_xlim(-0.4, 0.9)
        stopped = [f"{z0} nm" for z0 in GAPS if not runs[z0, which].completed]
        if stopped:
            common.zoom(ax, (0.42, 0.07, 0.54, 0.27), (-0.281, -0.266), (-5.2, 0))
            text = "\n".join(["stopped at", *stopped])
            ax.text(0.97, 0.97, text, transform=ax.transAxes, ha="right", va="top", fontsize=9)
        ax.axhline(0, color="0.6", linewidth=0.6, zorder=0)
    axes[0].set_yscale("asinh", linear_width=2)
    axes[0].set_yticks([-50, -20, -10, -5, -2, 0, 2, 5])
    axes[0].yaxis.set_major_formatter("{x:.0f}")
    axes[0].yaxis.set_minor_locator(NullLocator())
    axes[0].set_ylim(-65, 7)
    axes[0].set_ylabel("force on the tip (nN)")
    entries = [Line2D([], [], color=c, label=z) for c, z in zip(colours, GAPS, strict=True)]
    entries.append(common.END_ENTRY)
    figure.legend(handles=entries, title="$z_0$ (nm)", loc="outside right center", frameon=False)
    common.save_figure(figure, "fig4_stability")


if __name__ == "__main__":
    common.run(main)
