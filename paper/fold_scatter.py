"""How virial and dissipation scatter with the number of steps where a tap crosses an elastic fold.

In the paper: its taps on polyethylene and polystyrene are called independent of the number of steps.

Here: the surface of both jumps at pull-off, and steps of fixed length cross such a fold by luck. For
26 numbers of steps, setups B and E (25 functions) with forward Euler and two-step Adams-Bashforth
steps, against the default solver with 26 tolerances, which follows the jump. Runs that blow up are
crosses at the top.
"""

import common
import numpy as np

from softafm import solvers
from softafm.plotting import COLOURS

STEPS = np.linspace(2000, 6000, 26).round().astype(int).tolist()
TOLERANCES = np.geomspace(3e-2, 1e-3, 26).tolist()
STEPPERS = {"Euler": solvers.ForwardEuler(), "AB2": solvers.AdamsBashforth(2)}
KINDS = [*((letter, name) for letter in "BE" for name in STEPPERS), ("default", "")]
OBSERVABLES = {"virial": "virial V", "dissipation": "dissipation E"}
TAPS = {"polyethylene": "ldpe-tap-setpoint-0.8", "polystyrene": "ps-tap-gap-1.0nm"}


def main(progress=None):
    """Run all, write, print and draw."""
    jobs = [
        (sample, kind, choice)
        for sample in TAPS
        for kind in KINDS
        for choice in (TOLERANCES if kind[0] == "default" else STEPS)
    ]
    cases = {sample: common.tap_case(name) for sample, name in TAPS.items()}
    converged = {s: common.converged_tap(case.contact, case.motion) for s, case in cases.items()}
    runs = {}
    for job in common.tracked(jobs, progress, lambda j: f"{j[0]}: {' '.join(j[1])}"):
        sample, kind, choice = job
        options = (
            {"tolerance": choice} if kind[0] == "default" else {"solver": solver(*kind, choice)}
        )
        runs[job] = common.tap(cases[sample].contact, cases[sample].motion, **options)
    errors = {
        (*job, key): run.error(key, converged[job[0]])
        for job, run in runs.items()
        for key in OBSERVABLES
    }
    common.write_csv(
        "fold_scatter",
        ("sample", "setup", "steps", "virial_error_percent", "dissipation_error_percent",
         "ending", "warned"),
        ((job[0], " ".join(job[1]), steps(job, run), *(errors[*job, k] for k in OBSERVABLES),
          run.ending, run.warned) for job, run in runs.items()),
    )  # fmt: skip
    header = ("sample", "setup", "V mean %", "V max-min", "V std", "E mean %", "E max-min", "E std",
              "blow-ups", "warned")  # fmt: skip
    rows = [row(sample, kind, runs, errors) for sample in TAPS for kind in KINDS]
    common.write_csv("fold_scatter_summary", header, rows)
    common.show(f"Scatter over {len(STEPS)} numbers of steps or tolerances", header, rows)
    common.save_figure(draw(runs, errors), "fold_scatter")


def solver(letter, stepper, count):
    """Setup B or E with a stepper and a number of steps."""
    size = {"functions": 25} if letter == "E" else {}
    return common.setup(
        letter, nodes=70, domain=common.DOMAIN, steps=count, stepper=STEPPERS[stepper], **size
    )


def steps(job, run):
    """Number of steps of a run."""
    return run.attributes["solver_steps"] if job[1][0] == "default" else job[2]


def row(sample, kind, runs, errors):
    """One row of the summary: mean, range and standard deviation in per cent, failures."""
    mine = [job for job in runs if job[:2] == (sample, kind)]
    spread = []
    for key in OBSERVABLES:
        values = np.array([errors[*job, key] for job in mine if runs[job].completed])
        spread += [f"{f(values):.2f}" for f in (np.mean, np.ptp, np.std)]
    blown = sum(not runs[job].completed for job in mine)
    return sample, " ".join(kind), *spread, blown, sum(runs[job].warned for job in mine)


def draw(runs, errors):
    """A column for each sample, a row for each observable."""
    figure, axes = common.panels(2, 2, 6.8, sharex=True)
    for panel, ax in enumerate(axes):
        key, sample = list(OBSERVABLES)[panel // 2], list(TAPS)[panel % 2]
        ax.axhline(0, color="0.75", linewidth=0.8)
        for index, kind in enumerate(KINDS):
            mine = [(job, run) for job, run in runs.items() if job[:2] == (sample, kind)]
            colour = COLOURS[6] if kind[0] == "default" else COLOURS[index]
            ax.plot(
                [steps(job, run) for job, run in mine], [errors[*job, key] for job, _ in mine],
                ".-", color=colour, linewidth=0.9, markersize=5,
                label=" ".join(kind).strip() + (" solver" if kind[0] == "default" else ""),
            )  # fmt: skip
            blown = [steps(job, run) for job, run in mine if not run.completed]
            ax.plot(
                blown, [0.97 - 0.03 * index] * len(blown), "x", color=colour, markersize=4,
                transform=ax.get_xaxis_transform(),
            )  # fmt: skip
        ax.set_xscale("log")
        ax.margins(y=0.2)
        if panel < 2:
            ax.set_title(sample, fontsize=11)
        else:
            ax.set_xlabel("number of steps")
        ax.set_ylabel(f"error of {OBSERVABLES[key]} (%)")
    axes[0].legend(frameon=False, fontsize=9)
    return figure


if __name__ == "__main__":
    main()
