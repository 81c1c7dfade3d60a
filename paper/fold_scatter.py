"""How virial and dissipation scatter with the number of steps where a tap crosses an elastic fold.

In the paper: its taps are called independent of the temporal discretisation.

Here: the surfaces of both its samples jump at pull-off, and steps of fixed length cross such a fold
by luck. 26 numbers of steps from 2000 to 6000 and 26 more up to 40 000, for setups B and E (25
functions), against the default solver with 26 tolerances, which follows the jump. Runs that blow up
are crosses at the top. Numbers are spaced geometrically: whether a coarse run survives snap-in
depends on where its steps fall, which repeats every 80 numbers.
"""

import common
import numpy as np

from softafm import solvers
from softafm.draw.results import COLOURS

RANGES = {
    "<6000": np.geomspace(2000, 6000, 26).round().astype(int).tolist(),
    "<40000": np.geomspace(6001, 40_000, 26).round().astype(int).tolist(),
}
TOLERANCES = {"150-400": np.geomspace(3e-2, 1e-3, 26).tolist()}
STEPPERS = {
    "Euler": solvers.ForwardEuler(),
    "AB2": solvers.AdamsBashforth(2),
    "RK4": solvers.RungeKutta4(),
}
EXPLICIT = [("B", "Euler"), ("B", "AB2"), ("E", "Euler"), ("E", "AB2"), ("E", "RK4")]
DEFAULT = ("default", "")
OBSERVABLES = {"virial": "virial V", "dissipation": "dissipation E"}
TAPS = {"LDPE": "ldpe-tap-setpoint-0.8", "PS": "ps-tap-gap-1.0nm"}


def main(progress=None):
    """Run all, write, print and draw."""
    jobs = [
        (sample, kind, choice)
        for sample in TAPS
        for kind in (*EXPLICIT, DEFAULT)
        for choices in choices_of(kind).values()
        for choice in choices
    ]
    cases = {sample: common.tap_case(name) for sample, name in TAPS.items()}
    converged = {s: common.converged_tap(case.contact, case.motion) for s, case in cases.items()}
    runs = {}
    for job in common.tracked(jobs, progress, lambda j: f"{j[0]}: {' '.join(j[1])}"):
        sample, kind, choice = job
        options = {"tolerance": choice} if kind == DEFAULT else {"solver": solver(*kind, choice)}
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
    header = ("tap", "setup", "steps", "V mean", "range", "std", "E mean", "range", "std",
              "in", "off", "warn")  # fmt: skip
    rows = [
        row(sample, kind, name, runs, errors)
        for sample in TAPS
        for kind in (*EXPLICIT, DEFAULT)
        for name in choices_of(kind)
    ]
    title = "Errors in % over 26 numbers of steps or tolerances; blow-ups at snap-in, pull-off"
    common.report("fold_scatter_summary", title, header, rows)
    common.save_figure(draw(runs, errors), "fold_scatter")


def choices_of(kind):
    """Numbers of steps of an explicit solver, tolerances of the default one, by range."""
    return TOLERANCES if kind == DEFAULT else RANGES


def solver(letter, stepper, count):
    """Setup B or E with a stepper and a number of steps."""
    size = {"functions": 25} if letter == "E" else {}
    return common.setup(
        letter, nodes=70, domain=common.DOMAIN, steps=count, stepper=STEPPERS[stepper], **size
    )


def steps(job, run):
    """Number of steps of a run."""
    return run.attributes["solver_steps"] if job[1] == DEFAULT else job[2]


def row(sample, kind, name, runs, errors):
    """One row of the summary: mean, range and standard deviation in per cent, failures."""
    jobs = [(sample, kind, choice) for choice in choices_of(kind)[name]]
    mine = [runs[job] for job in jobs]
    spread = []
    for key in OBSERVABLES:
        values = np.array([errors[*job, key] for job in jobs if runs[job].completed])
        spread += [f"{f(values):.2f}" for f in (np.mean, np.ptp, np.std)]
    # Runs stop at snap-in, before the turn of the motion, or at pull-off, after it.
    stops = [run.tip_height[-1] > run.tip_height[-2] for run in mine if not run.completed]
    failures = stops.count(False), stops.count(True), sum(run.warned for run in mine)
    return sample, " ".join(kind), name, *spread, *failures


def draw(runs, errors):
    """A column for each sample, a row for each observable."""
    figure, axes = common.panels(2, 2, 6.8, sharex=True)
    for panel, ax in enumerate(axes):
        key, sample = list(OBSERVABLES)[panel // 2], list(TAPS)[panel % 2]
        ax.axhline(0, color="0.75", linewidth=0.8)
        for index, kind in enumerate((*EXPLICIT, DEFAULT)):
            mine = [(job, run) for job, run in runs.items() if job[:2] == (sample, kind)]
            colour = COLOURS[6] if kind == DEFAULT else COLOURS[index]
            ax.plot(
                [steps(job, run) for job, run in mine], [errors[*job, key] for job, _ in mine],
                ".-", color=colour, linewidth=0.9, markersize=5,
                label=" ".join(kind),
            )  # fmt: skip
            blown = [steps(job, run) for job, run in mine if not run.completed]
            ax.plot(
                blown, [0.97 - 0.025 * index] * len(blown), "x", color=colour, markersize=4,
                transform=ax.get_xaxis_transform(),
            )  # fmt: skip
        ax.set_xscale("log")
        ax.set_yscale("symlog", linthresh=1)
        ax.set_ylim(-50, 50)
        ax.set_yticks([-10, -1, 0, 1, 10], ["−10", "−1", "0", "1", "10"])
        if panel < 2:
            ax.set_title(f"{sample} tap", fontsize=11)
        else:
            ax.set_xlabel("number of steps")
        ax.set_ylabel(f"error of {OBSERVABLES[key]} (%)")
    axes[2].legend(frameon=False, fontsize=9, loc="lower left", ncols=2)
    return figure


if __name__ == "__main__":
    main()
