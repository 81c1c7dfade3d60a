"""Figure 10 of the paper: tip and surface through one tap on polyethylene.

In the paper: twelve instants, setup E as an area and the exact solution as a dashed line. It tells
the sample (Table 1) and the tip, but neither amplitude nor height. Taken here: 49.6 nm about 46 nm
at 278 kHz, the first tap on a flat surface, as in ``ldpe-tap-repulsive`` of ``tests/data``; that
amplitude is the 0.8 of 62 nm of the paper's Figs. 5 to 7.

Here: the default solver as the area and setup E with 25 functions as the dashed line; what the
surface does on the way down and up, as a table; and a movie, ``fig10_movie.html``.
"""

import common
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

import softafm as sa
from softafm.draw.scene_parts import SAMPLE_COLOURS, choose_scales
from softafm.draw.scenes import choose_view, choose_window, interpolate_scenes
from softafm.draw.storyboard import choose_instants

AMPLITUDE, MEAN_HEIGHT, FREQUENCY = 49.6e-9, 46e-9, 278e3
FRAMES = 12
LEVELS = 1e-9, 0.0, -1e-9, -2e-9
"""Tip heights, m, at which ways down and up are compared."""


def main(progress=None):
    """Run the tap with both solvers, draw the frames and write the movie."""
    solvers = {"default": None, "E": common.setup("E", functions=25, domain=common.DOMAIN)}
    tap, setup_e = (
        sa.tapping_cycle(
            common.LDPE, AMPLITUDE, MEAN_HEIGHT, FREQUENCY, cycles=1, profiles=True, solver=solver,
        )
        for solver in common.tracked(solvers.values(), progress, lambda solver: "running the tap")
    )  # fmt: skip
    instants = choose_instants(tap, FRAMES, *choose_window(tap, margin=0.05))
    report_frames(tap, setup_e, instants)
    report_strokes(tap)
    common.save_figure(draw(tap, setup_e, instants), "fig10_movie")
    sa.animate(tap, common.OUTPUT / "fig10_movie.html", overwrite=True)


def report_frames(tap, setup_e, instants):
    """What each picture shows, and how far setup E's surface is from it."""
    ours, theirs = (interpolate_scenes(run, instants) for run in (tap, setup_e))
    time = tap["time"].values
    rows = []
    for i, instant in enumerate(instants):
        height, radius = (
            float(np.interp(instant, time, tap[name].values))
            for name in ("tip_height", "contact_radius")
        )
        off = np.interp(theirs.r, ours.r, ours.surface[i]) - theirs.surface[i]
        rows.append([
            "abcdefghijkl"[i], float(instant), height, float(ours.force[i]),
            float(ours.surface[i, 0]), radius, float(np.abs(off).max()),
        ])  # fmt: skip
    header = ("picture", "time_s", "tip_height_m", "force_N", "axis_deformation_m",
              "contact_radius_m", "setup_E_off_m")  # fmt: skip
    common.write_csv("fig10_movie", header, rows)
    common.show(
        "Pictures",
        ("", "time, ns", "tip, nm", "force, nN", "surface on the axis, nm", "contact radius, nm",
         "E off by, nm"),
        ([row[0], *(round(1e9 * value, 3) for value in row[1:])] for row in rows),
    )  # fmt: skip


def report_strokes(tap):
    """Contact radius at the same tip heights on the way down and up, and the largest bulge."""
    height = tap["tip_height"].values
    lowest = height.argmin()
    strokes = slice(None, lowest + 1), slice(lowest, None)
    rows = []
    for level in LEVELS:
        radii = []
        for stroke in strokes:
            order = np.argsort(height[stroke])
            radii.append(float(np.interp(
                level, height[stroke][order], tap["contact_radius"].values[stroke][order]
            )))  # fmt: skip
        rows.append([level, *radii])
    common.write_csv("fig10_movie_radii", ("tip_height_m", "down_m", "up_m"), rows)
    common.show(
        "Contact radius, nm", ("tip, nm", "down", "up"), ([1e9 * v for v in row] for row in rows)
    )
    bulge = [1e9 * float(tap["axis_deformation"].values[stroke].max()) for stroke in strokes]
    print(f"The surface rises by up to {bulge[0]:.2f} nm on the way down, {bulge[1]:.2f} nm up")


def draw(tap, setup_e, instants):
    """The twelve pictures, with setup E's surface over them."""
    figure = sa.plot_profiles(tap, FRAMES)
    across, along = choose_scales(choose_view(tap, instants[0], instants[-1], shape=1.15))
    scenes = interpolate_scenes(setup_e, instants)
    radius = across * np.concatenate([-scenes.r[::-1], scenes.r])
    for ax, surface in zip(figure.axes, scenes.surface, strict=True):
        height = along * np.concatenate([surface[::-1], surface])
        ax.plot(radius, height, "--", color="black", linewidth=0.9, zorder=3)
    ground, skin = SAMPLE_COLOURS
    handles = [
        Patch(facecolor=ground, edgecolor=skin, label="default solver"),
        Line2D([], [], color="black", linestyle="--", linewidth=0.9, label="setup E, 25 functions"),
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=2, frameon=False)
    return figure


if __name__ == "__main__":
    common.run(main)
