"""Figure 6 of the paper: how the force curve converges with the number of radial functions.

In the paper: force against tip height of a deep tap on polyethylene, setup E, for several n_b (the
number of functions less one). It is visibly converged from n_b = 20 on, and the repulsion earlier
than the attraction.

Here: the same with the converged curve behind, approach and retraction apart. That tap crosses an
elastic fold at pull-off, where the force drops at once by a tenth of its largest value, and setup E
by more: however small a shift of the drop is a deviation of 10 %. So the deviation without the drop
is told, too.
"""

import common
import numpy as np
from matplotlib import colormaps

BASIS_SIZES = 0, 2, 5, 10, 15, 20, 25, 30


def main(progress=None):
    """Run all numbers of functions."""
    common.warm_up()
    converged = common.tap(common.LDPE, common.DEEP_TAP, tolerance=1e-3)
    runs = {}
    for n_b in common.tracked(BASIS_SIZES, progress, lambda n_b: f"n_b = {n_b}"):
        solver = common.setup("E", functions=n_b + 1, domain=common.DOMAIN)
        runs[n_b] = common.tap(common.LDPE, common.DEEP_TAP, solver)
    header = ("n_b", "approach_error_percent", "retraction_error_percent",
              "retraction_without_drop_error_percent", "force_max_N",
              "force_min_N", "ending", "warned")  # fmt: skip
    rows = [
        [n_b, *deviations(run, converged),
         *(run.observables.get(key, np.nan) for key in ("force_max", "force_min")),
         run.ending, run.warned]
        for n_b, run in [*runs.items(), ("converged", converged)]
    ]  # fmt: skip
    common.write_csv("fig6_force_curves", header, rows)
    common.show(
        "Largest deviation of the force in approach (in) and retraction (out), %",
        ("n_b", "in", "out", "out, but the drop", "max, nN", "min, nN", "ending"),
        ([*row[:4], 1e9 * row[4], 1e9 * row[5], row[6]] for row in rows),
    )
    draw(runs, converged)


def strokes(run):
    """Samples of approach and retraction."""
    falling = run.time <= 0.5 / common.DEEP_TAP.frequency
    return falling, ~falling


def deviations(run, converged):
    """Largest deviations from the converged force, %: approach, retraction, and that but the drop.

    The drop is where the converged force changes most between two steps, give or take 0.2 nm.
    """
    force = np.interp(run.time, converged.time, converged.force)
    error = 100 * np.abs(run.force - force) / np.abs(converged.force).max()
    approach, retraction = strokes(run)
    leaving = strokes(converged)[1]
    drop = converged.tip_height[leaving][np.argmax(np.diff(converged.force[leaving]))]
    smooth = retraction & (np.abs(run.tip_height - drop) > 0.2e-9)
    parts = approach, retraction, smooth
    return [float(error[part].max()) if run.completed else np.nan for part in parts]


def draw(runs, converged):
    """Draw force against tip height, one panel a stroke."""
    figure, axes = common.panels(1, 2, 4.8, sharey=True)
    colours = colormaps["plasma_r"](np.linspace(0.1, 0.95, len(runs)))
    for index, (ax, title) in enumerate(zip(axes, ("approach", "retraction"), strict=True)):
        curves = [(converged, {"color": "black", "linewidth": 3.5, "label": "converged"})]
        for (n_b, run), colour in zip(runs.items(), colours, strict=True):
            curves.append((run, {"color": colour, "linewidth": 1.4, "label": f"$n_b$ = {n_b}"}))
        for run, style in curves:
            stroke = strokes(run)[index]
            common.curve(ax, run, 1e9 * run.tip_height[stroke], 1e9 * run.force[stroke], **style)
        ax.set_title(title, fontsize=11)
        ax.set_xlabel("tip height $h_0$ (nm)")
        ax.set_xlim(-7.5, 8)
    common.zoom(axes[1], (0.5, 0.6, 0.46, 0.36), (1, 2.6), (-8, 0.3))
    for ax in axes:
        ax.axhline(0, color="0.6", linewidth=0.6, zorder=0)
    axes[0].set_ylabel("force on the tip (nN)")
    handles = axes[0].get_legend_handles_labels()[0]
    if not all(run.completed for run in runs.values()):
        handles.append(common.END_ENTRY)
    figure.legend(handles=handles, loc="outside right center", frameon=False)
    common.save_figure(figure, "fig6_force_curves")


if __name__ == "__main__":
    common.run(main)
