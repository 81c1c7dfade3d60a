"""Figure 9 of the paper: approach and retract curves of tapping on polystyrene.

In the paper: phase, dissipation and virial against the amplitude ratio, for a lever of 28.1 N/m and
Q = 429.5 at 278 kHz with a free amplitude of 15 nm. Its caption says polyethylene; its text and its
Table 3, taken here, say polystyrene, under a tip of 50 nm. Attraction and repulsion exist together
over a range of amplitude ratios.

Here: the curves that an instrument records as the lever comes down and goes up, all solutions
behind them, and as markers those of an independent program that scanned the height
(``approach_curve_ps.json`` of ``tests/data``). A fourth panel shows how deep the tip goes.
"""

import json
import warnings
from time import perf_counter

import common
import numpy as np
from matplotlib.lines import Line2D

import softafm as sa
from softafm.draw.approach_data import find_jumps
from softafm.draw.results import COLOURS

POLYSTYRENE = sa.Contact(
    sa.Paraboloid(radius=50e-9),
    sa.StandardLinearSolid(E0=4.25e9, E_inf=1.89e9, creep_time=1e-7, poisson=0.35),
    sa.LennardJones(hamaker=2e-20, z0=0.15e-9),
)
LEVER = sa.Cantilever(stiffness=28.1, quality_factor=429.5, frequency=278e3)
FREE = 15e-9
RATIOS = np.linspace(0.95, 0.2, 31)
FINE = np.linspace(0.95, 0.2, 601)
"""Amplitude ratios of the lines that are drawn; they need no more taps than a few would."""
TOLERANCES = 1e-2, 1e-3
ROUNDS = 3
ENERGIES = "virial", "dissipation"


def main(progress=None):
    """Compute the curve at two tolerances and at the reference's ratios; draw the fine one."""
    known = json.loads(
        (common.ROOT / "tests/data/approach_curve_ps.json").read_text(encoding="utf-8")
    )["curve"]
    jobs = [("31 ratios", RATIOS, TOLERANCES[0])] * ROUNDS
    jobs += [("those of the reference", [row["amplitude_ratio"] for row in known], t)
             for t in TOLERANCES]  # fmt: skip
    jobs += [("601 ratios", FINE, TOLERANCES[0])]
    runs, seconds = {}, {}
    common.warm_up()
    for name, ratios, tolerance in common.tracked(jobs, progress, lambda job: job[0]):
        started = perf_counter()
        with warnings.catch_warnings():  # of a sliver beside the upper fold with two such states
            warnings.filterwarnings("ignore", "one amplitude has several stable attractive")
            runs[name, tolerance] = sa.approach_curve(
                POLYSTYRENE, LEVER, FREE, ratios, tolerance=tolerance
            )
        seconds.setdefault((name, tolerance), []).append(perf_counter() - started)
    curve, fine = (runs[name, TOLERANCES[0]] for name in ("31 ratios", "601 ratios"))
    least = min(seconds["31 ratios", TOLERANCES[0]])
    print(f"31 amplitude ratios from {curve.attrs['solver_taps']} taps in {1e3 * least:.0f} ms")
    report_curve(curve)
    report_jumps(fine)
    report_deviations(runs, known)
    common.save_figure(draw(fine, known), "fig9_approach")


def report_curve(curve):
    """All solutions, as CSV."""
    names = "mean_height", "phase", *ENERGIES, "force_max", "force_min", "indentation"
    rows = [
        [branch, float(ratio), *(float(curve[name].sel(branch=branch).values[i]) for name in names)]
        for branch in curve["branch"].values
        for i, ratio in enumerate(curve["amplitude_ratio"].values)
        if np.isfinite(curve["mean_height"].sel(branch=branch).values[i])
    ]
    header = ("branch", "amplitude_ratio", "mean_height_m", "phase_degree", "virial_J",
              "dissipation_J", "force_max_N", "force_min_N", "indentation_m")  # fmt: skip
    common.write_csv("fig9_approach", header, rows)


def report_jumps(fine):
    """Where the sweeps jump, and the ranges of amplitude ratios in which two states are stable."""
    rows = []
    for direction in ("approach", "retract"):
        for pair in find_jumps(fine, direction):
            height = float(fine["sweep_height"].values[list(pair)].mean())
            ends = [
                [fine[f"{direction}_{name}"].values[i] for i in pair]
                for name in ("amplitude", "phase", *ENERGIES)
            ]
            ratio, phase, virial, dissipation = ends
            rows.append([direction, height, *(v / FREE for v in ratio), *phase, *virial,
                         *dissipation])  # fmt: skip
    header = ["direction", "height_m"] + [
        f"{name}_{when}"
        for name in ("ratio", "phase_degree", "virial_J", "dissipation_J")
        for when in ("before", "after")
    ]
    common.write_csv("fig9_approach_jumps", header, rows)
    common.show(
        "Jumps, before and after",
        ("", "Z, nm", "A/A0", "phase, °", "virial, aJ", "dissipation, aJ"),
        ([row[0], f"{1e9 * row[1]:.2f}", *(f"{a:.3g}, {b:.3g}" for a, b in (
            row[2:4], row[4:6], (1e18 * v for v in row[6:8]), (1e18 * v for v in row[8:10])))]
         for row in rows),
    )  # fmt: skip
    both = np.isfinite(fine["mean_height"].sel(branch=["attractive", "repulsive"])).all("branch")
    ratios = fine["amplitude_ratio"].values
    parts = np.split(ratios, np.flatnonzero(np.diff(both.values)) + 1)
    found = [f"{p[-1]:.3f} to {p[0]:.3f}" for p in parts[int(not both[0]) :: 2]]
    print(f"Attraction and repulsion are both stable at A/A0 of {', '.join(found)}")


def report_deviations(runs, known):
    """Largest deviations from the reference's solutions at each tolerance."""
    header = ("tolerance", "amplitude_ratio", "branch", "height_off_m", "phase_off_degree",
              "virial_off_percent", "dissipation_off_percent")  # fmt: skip
    rows = []
    for tolerance in TOLERANCES:
        curve = runs["those of the reference", tolerance]
        found = int(np.isfinite(curve["mean_height"]).sum())
        expected = sum(len(row["solutions"]) for row in known)
        print(f"tolerance {tolerance:g}: {found} solutions, the reference has {expected}")
        for i, row in enumerate(known):
            here = curve.isel(amplitude_ratio=i)
            for solution in row["solutions"]:
                off = np.abs(here["mean_height"].values - solution["mean_height"])
                mine = here.isel(branch=int(np.nanargmin(off)))
                largest = {name: max(abs(s[name]) for r in known for s in r["solutions"])
                           for name in ENERGIES}  # fmt: skip
                rows.append([
                    tolerance, row["amplitude_ratio"], str(mine["branch"].values),
                    float(mine["mean_height"]) - solution["mean_height"],
                    float(mine["phase"]) - solution["phase_deg"],
                    *(100 * (float(mine[name]) - solution[name]) / largest[name]
                      for name in ENERGIES),
                ])  # fmt: skip
    common.write_csv("fig9_approach_deviations", header, rows)
    table = np.array([[row[0], *row[3:]] for row in rows])
    common.show(
        "Largest deviation from the reference (energies: of their largest)",
        ("tolerance", "Z, nm", "phase, °", "virial, %", "dissipation, %"),
        ([t, *map(float, np.abs(table[table[:, 0] == t, 1:]).max(axis=0) * [1e9, 1, 1, 1])]
         for t in TOLERANCES),
    )  # fmt: skip


def draw(fine, known):
    """Three panels of the paper, and the lowest height of the tip against that of the lever."""
    figure, axes = common.panels(2, 2, 6.6)
    phase, dissipation, virial, lowest = axes
    panels = (
        (phase, "phase", 1.0, "phase lag (°)"),
        (dissipation, "dissipation", 1e18, "dissipation in a cycle (aJ)"),
        (virial, "virial", 1e18, "virial (aJ)"),
    )
    for ax, name, scale, label in panels:
        for branch, style in (("unstable", ":"), ("attractive", "-"), ("repulsive", "-")):
            values = scale * fine[name].sel(branch=branch).values
            ax.plot(FINE, values, style, color="0.6", linewidth=1.3, zorder=1.5)
        for direction, colour in zip(("approach", "retract"), COLOURS, strict=False):
            ratio = fine[f"{direction}_amplitude"].values / FREE
            sweep(ax, fine, direction, ratio, scale * fine[f"{direction}_{name}"].values, colour)
        key = "phase_deg" if name == "phase" else name
        marks = [
            (row["amplitude_ratio"], scale * s[key]) for row in known for s in row["solutions"]
        ]
        ax.plot(*zip(*marks, strict=True), **MARKS)
        ax.set_xlabel("amplitude ratio $A/A_0$")
        ax.set_ylabel(label)
        ax.set_xlim(0.18, 0.97)
    for branch, style in (("unstable", ":"), ("attractive", "-"), ("repulsive", "-")):
        height = fine["mean_height"].sel(branch=branch).values
        lowest.plot(1e9 * height, 1e9 * (height - FINE * FREE), style, color="0.6", linewidth=1.3)
    for direction, colour in zip(("approach", "retract"), COLOURS, strict=False):
        height = fine["sweep_height"].values
        depth = height - fine[f"{direction}_amplitude"].values
        sweep(lowest, fine, direction, 1e9 * height, 1e9 * depth, colour)
    marks = [(s["mean_height"], s["mean_height"] - row["amplitude_ratio"] * FREE)
             for row in known for s in row["solutions"]]  # fmt: skip
    lowest.plot(*(1e9 * np.transpose(marks)), **MARKS)
    lowest.set_xlabel("mean height $Z$ (nm)")
    lowest.set_ylabel("lowest height of the tip $Z - A$ (nm)")
    phase.axhline(90, color="0.75", linewidth=0.6, zorder=0)
    for words, where in {"attractive": 93, "repulsive": 82}.items():
        phase.text(0.2, where, words, color="0.4", fontsize=9)
    phase.set_yticks(range(30, 181, 30))
    for ax in (virial, lowest):
        ax.axhline(0, color="0.75", linewidth=0.6, zorder=0)
    dissipation.set_ylim(bottom=0)
    handles = [
        Line2D([], [], color=COLOURS[0], linewidth=2.2, label="approach"),
        Line2D([], [], color=COLOURS[1], linewidth=2.2, label="retract"),
        Line2D([], [], color="0.6", linewidth=1.3, label="stable"),
        Line2D([], [], color="0.6", linewidth=1.3, linestyle=":", label="unstable"),
        Line2D([], [], label="independent program", **MARKS),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=5, frameon=False)
    return figure


def sweep(ax, fine, direction, x, y, colour):
    """Draw what a sweep records, its jumps as arrows."""
    jumps = find_jumps(fine, direction)
    for before, after in jumps:
        arrow = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.2, "shrinkA": 0, "shrinkB": 0}
        ax.annotate("", (x[after], y[after]), (x[before], y[before]), arrowprops=arrow)
    cut = [max(pair) for pair in jumps]
    style = {"color": colour, "linewidth": 2.2}
    if direction == "retract":
        style["linestyle"] = (0, (4, 1.5))
    ax.plot(np.insert(x, cut, np.nan), np.insert(y, cut, np.nan), **style)


MARKS = {"marker": "o", "markersize": 4.5, "markerfacecolor": "white", "color": "black",
         "linestyle": "none", "zorder": 4}  # fmt: skip


if __name__ == "__main__":
    common.run(main)
