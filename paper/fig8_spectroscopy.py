"""Figure 8 of the paper: force spectroscopy on polyethylene.

In the paper: deflection against time, force against base height Z and against tip height d, for a
lever of 28.1 N/m whose base follows a triangular wave of 1 Hz and 50 nm amplitude, which is
200 nm/s; polyethylene of its Table 1, but with a creep time of 0.01 ms. It does not tell where the
wave begins and turns. Taken here: from 20 nm above the surface to 5 nm below it, as in
``ldpe-spectroscopy-k28.1`` of ``tests/data``. Beyond about 3 nm nothing happens, so that only the
lowest height matters.

Here: the default solver, setup E with 25 functions over it, and the same with a lever of 2 N/m,
softer than the attraction at its steepest, that snaps in and out together with the surface. Setup E
needs steps below the relaxation time of 0.5 µs in a ramp of a quarter of a second. The tables tell
how far both are from the default solver at a tolerance of 1e-4.
"""

import json
from dataclasses import replace

import common
import numpy as np

import softafm as sa
from softafm.draw.results import COLOURS

POLYETHYLENE = replace(common.LDPE, sample=replace(common.LDPE.sample, creep_time=1e-5))
RAMP = sa.Triangle(start=20e-9, turn=-5e-9, speed=200e-9)
STIFFNESSES = 28.1, 2.0
DEFAULT, CONVERGED = "1e-2", "1e-4"
RUNS = {
    DEFAULT: {"tolerance": 1e-2},
    "1e-3": {"tolerance": 1e-3},
    CONVERGED: {"tolerance": 1e-4},
    "E": {"solver": common.setup("E", functions=25, domain=common.DOMAIN, steps=700_000)},
}
"""By name: the tolerance of the default solver, or the setup."""
ROUNDS = 5
WATCHED = "force_max", "force_min", "force_min_approach", "loop_energy"
STROKES = dict(zip(("approach", "retraction"), COLOURS, strict=False))
SNAP = 1e-3
"""Time within which a snap is sought, s."""


def main(progress=None):
    """Run both levers; of the default the fastest round counts."""
    common.warm_up()
    jobs = [(k, name) for name in RUNS for k in STIFFNESSES for _ in range(rounds(name))]
    runs = {}
    for job in common.tracked(jobs, progress, lambda job: f"{job[0]} N/m, {job[1]}"):
        run = common.spectrum(POLYETHYLENE, job[0], RAMP, **RUNS[job[1]])
        if job not in runs or run.seconds < runs[job].seconds:
            runs[job] = run
    runs = {(k, name): runs[k, name] for k in STIFFNESSES for name in RUNS}
    report_runs(runs)
    common.save_figure(draw(runs), "fig8_spectroscopy")


def rounds(name):
    """How often a run is timed, the first time to load what it needs."""
    return 1 + ROUNDS if name == DEFAULT else 1


def report_runs(runs):
    """Tables of what was found, how long it took and how far it is from the converged values."""
    header = ("stiffness_N/m", "solver", "steps", "ms", *WATCHED, "viscous_loss", "jump_energy",
              "jumps", "snap_in_s", "snap_out_s")  # fmt: skip
    header += tuple(f"{name}_error_percent" for name in WATCHED)
    header += tuple(f"{name}_off_reference_percent" for name in WATCHED)
    header += ("ending",)
    rows = []
    for (stiffness, name), run in runs.items():
        converged = runs[stiffness, CONVERGED].observables
        references = reference(stiffness)
        rows.append([
            stiffness, name, steps(name, run), 1e3 * run.seconds,
            *(run.observables.get(of, np.nan) for of in (*WATCHED, "viscous_loss")),
            float(run.jump_energy.sum()), run.jump_energy.size, *snaps(run),
            *(run.error(of, converged) for of in WATCHED),
            *(run.error(of, references) for of in WATCHED),
            run.ending,
        ])  # fmt: skip
    common.write_csv("fig8_spectroscopy", header, rows)
    common.show(
        "Force spectroscopy",
        ("N/m", "run", "steps", "ms", "max, nN", "min, nN", "loop, aJ", "jumps", "in, ms",
         "out, ms"),
        ([*r[:4], *(1e9 * f for f in r[4:6]), 1e18 * r[7], 1e18 * r[9], 1e3 * r[11], 1e3 * r[12]]
         for r in rows),
    )  # fmt: skip
    for what, first in ((f"the run at {CONVERGED}", 13), ("tests/data", 17)):
        common.show(
            f"Deviation from {what}, %",
            ("N/m", "run", "max", "min", "min of approach", "loop", "ending"),
            ([*r[:2], *(round(error, 3) for error in r[first : first + 4]), r[-1]] for r in rows),
        )


def steps(name, run):
    """Steps that a run took, or would have taken."""
    solver = RUNS[name].get("solver")
    return run.attributes["solver_steps"] if solver is None else solver.steps


def reference(stiffness):
    """Observables of the same ramp in the tests' reference cases."""
    cases = json.loads((common.ROOT / "tests/data/cases.json").read_text(encoding="utf-8"))
    case = next(case for case in cases if case["name"] == f"ldpe-spectroscopy-k{stiffness}")
    return {name: found["value"] for name, found in case["expected"].items()}


def snaps(run):
    """Times, s, that the force takes from 10 to 90 % of its largest change within a millisecond.

    One on the way in, one on the way out; NaN of a run that stopped.
    """
    if not run.completed:
        return [np.nan, np.nan]
    times = []
    for stroke in strokes(run):
        time = np.arange(run.time[stroke][0], run.time[stroke][-1], 1e-3 * SNAP)
        force = np.interp(time, run.time[stroke], run.force[stroke])
        width = round(SNAP / (time[1] - time[0]))
        start = np.argmax(np.abs(force[width:] - force[:-width]))
        part = (force[start : start + width] - force[start]) / (force[start + width] - force[start])
        times.append(float((np.argmax(part > 0.9) - np.argmax(part > 0.1)) * (time[1] - time[0])))
    return times


def strokes(run):
    """Samples of approach and retraction; the lowest point belongs to both."""
    lowest = np.argmin(RAMP.height(run.time))
    return slice(None, lowest + 1), slice(lowest, None)


def sound(run, stiffness):
    """A run that stopped, up to where deflection and force lost each other."""
    bending = stiffness * (run.tip_height - RAMP.height(run.time))
    lost = np.abs(bending - run.force) > 0.05e-9
    if run.completed or not lost.any():
        return run
    kept = slice(None, np.argmax(lost))
    return replace(run, time=run.time[kept], tip_height=run.tip_height[kept], force=run.force[kept])


def draw(runs):
    """One row a lever: deflection against time, force against base and against tip height."""
    figure, axes = common.panels(2, 3, 5.8)
    for row, stiffness in zip(axes.reshape(2, 3), STIFFNESSES, strict=True):
        found, setup_e = runs[stiffness, DEFAULT], sound(runs[stiffness, "E"], stiffness)
        for stroke, (name, colour) in zip(strokes(found), STROKES.items(), strict=True):
            for ax, curve in zip(row, curves(found), strict=True):
                ax.plot(*(v[stroke] for v in curve), color=colour, linewidth=2.2, label=name)
        for ax, curve in zip(row, curves(setup_e), strict=True):
            common.curve(ax, setup_e, *curve, color="black", linestyle="--", linewidth=0.9,
                         label="setup E, 25 functions")  # fmt: skip
        for ax, curve in zip(row, curves(found), strict=True):
            for jump in found.jump_time:
                at = np.searchsorted(found.time, jump)
                ax.plot(*(v[at - 1 : at + 1] for v in curve), "o", color="black", markersize=4,
                        markerfacecolor="white", zorder=4, label="elastic jump")  # fmt: skip
        row[0].set_ylabel("deflection $q$ (nm)")
        row[0].set_xlim(80, 175)
        row[0].set_ylim(top=1.25 * row[0].get_ylim()[1])
        row[0].text(0.05, 0.91, f"$k$ = {stiffness:g} N/m", transform=row[0].transAxes)
        for ax in row[1:]:
            ax.set_ylabel("force on the tip (nN)")
            ax.set_xlim(-5.4, 4)
        common.zoom(row[2], (0.5, 0.5, 0.46, 0.46), (0.2, 2.6), (-1.7, 0.15))
        for ax in row:
            ax.axhline(0, color="0.75", linewidth=0.6, zorder=0)
    titles = "time (ms)", "base height $Z$ (nm)", "tip height $d = Z + q$ (nm)"
    for ax, title in zip(axes[3:], titles, strict=True):
        ax.set_xlabel(title)
    entries = dict(zip(*axes[3].get_legend_handles_labels()[::-1], strict=True))
    handles = [*entries.values(), common.END_ENTRY]
    figure.legend(handles=handles, loc="outside lower center", ncols=5, frameon=False)
    return figure


def curves(run):
    """Deflection against time, force against base height and tip height; ms, nm, nN."""
    base = RAMP.height(run.time)
    force = 1e9 * run.force
    return (
        (1e3 * run.time, 1e9 * (run.tip_height - base)),
        (1e9 * base, force),
        (1e9 * run.tip_height, force),
    )


if __name__ == "__main__":
    common.run(main)
