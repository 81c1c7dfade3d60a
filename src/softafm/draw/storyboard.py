"""Twelve pictures of a tip and a surface, from approach to release, in one figure."""

from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np

from softafm.checks.kinds import refuse_non_dataset
from softafm.checks.validate import check_whole
from softafm.draw.scene_parts import draw, make_writers, write_titles
from softafm.draw.scenes import (
    Scenes,
    choose_view,
    choose_window,
    find_jumping_steps,
    interpolate_scenes,
    measure_changes,
    require_profiles,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset

_LETTERS = "abcdefghijklmnopqrstuvwxyz"
_COLUMNS = 6
_PLAIN = 0.3
"""Change of force and surface (``measure_changes``) from which a jump gets two pictures."""


def plot_profiles(
    result: "Dataset",
    frames: int = 12,
    *,
    start: float | None = None,
    stop: float | None = None,
) -> "Figure":
    """Draw tip and deformed surface at instants of a cycle or force curve, one picture each.

    The first half of the pictures leads to the lowest tip height, the others away from it, as in
    Fig. 10 of Rajabifar et al. (2021). They stand closer where more happens, and just before and
    after an elastic jump. Arrows show where the tip is going.

    Parameters
    ----------
    result
        What a mode returned with ``profiles=True``.
    frames
        Number of pictures, 2 to 26.
    start, stop
        Times to begin and end at, s; by default while force acts and the surface returns.

    Returns
    -------
    matplotlib.figure.Figure
        Save it with ``figure.savefig``.

    Raises
    ------
    ValueError
        If the result holds no surface profiles or an argument is out of range.
    """
    from matplotlib.figure import Figure

    refuse_non_dataset("result", result)
    require_profiles(result)
    check_whole("frames", frames, 2, len(_LETTERS))
    instants = choose_instants(result, frames, *choose_window(result, start, stop, margin=0.05))
    columns = min(_COLUMNS, ceil(frames / 2))
    rows = ceil(frames / columns)
    figure = Figure(figsize=(1.0 + 1.9 * columns, 0.7 + 1.75 * rows), dpi=150, layout="constrained")
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    scenes = interpolate_scenes(result, instants)
    view = choose_view(result, instants[0], instants[-1], shape=1.15)
    rest = 0.03 * np.abs(scenes.velocity).max()
    for index, ax in enumerate(grid.flat):
        if index >= frames:
            ax.set_axis_off()
            continue
        draw(ax, scenes, index, view)
        _annotate(ax, scenes, index, rest)
        ax.tick_params(labelsize=8, direction="in", top=True, right=True)
    across, along = write_titles(view)
    figure.supxlabel(across, size=10)
    figure.supylabel(along, size=10)
    return figure


def choose_instants(result: "Dataset", frames: int, start: float, stop: float) -> np.ndarray:
    """Choose instants, half of them down to the lowest tip height, closer where more happens."""
    time, height = result["time"].values, result["tip_height"].values
    inside = time[(time > start) & (time < stop)]
    times = np.concatenate([[start], inside, [stop]])
    scenes = interpolate_scenes(result, times)
    change = measure_changes(scenes.force, scenes.surface)
    jumps = find_jumping_steps(times, result["jump_time"].values)
    smooth = np.where(jumps, 0.0, change)
    pace = smooth / (smooth.sum() or 1.0) + 0.5 * np.diff(times) / (stop - start)
    way = np.concatenate([[0.0], np.cumsum(pace)])

    lowest = np.interp(times, time, height).argmin()
    down = (frames + 1) // 2
    if 0.02 < way[lowest] / way[-1] < 0.98:
        there = np.linspace(0, way[lowest], down)
        back = np.linspace(way[lowest], way[-1], frames - down + 1)
        marks = np.concatenate([there, back[1:]])
    else:  # the tip goes one way only
        marks = np.linspace(0, way[-1], frames)
    instants = np.interp(marks, way, times)
    for step in np.flatnonzero(jumps & (change > _PLAIN)):
        _show_both_sides(instants, times[step], times[step + 1], times[lowest])
    return instants


def _show_both_sides(instants: Any, before: float, after: float, lowest: float) -> None:
    """Move the pictures next to a jump to its two sides, but not that of the lowest height."""
    second = int(np.searchsorted(instants, after))
    if second < instants.size and instants[second] != lowest:
        instants[second] = after
    if second > 0 and instants[second - 1] != lowest:
        instants[second - 1] = max(before, instants[second - 1])


def _annotate(ax: "Axes", scenes: Scenes, index: int, rest: float) -> None:
    """Write letter, instant and force into a picture, and draw the arrow of the tip's motion."""
    moment, force = make_writers(scenes)
    place: dict[str, Any] = {"transform": ax.transAxes, "fontsize": 8, "zorder": 4}
    letter = f"({_LETTERS[index]}) {moment(scenes.time[index])}"
    ax.text(0.04, 0.04, letter, va="bottom", **place)
    ax.text(0.96, 0.04, force(scenes.force[index]), va="bottom", ha="right", **place)
    velocity = scenes.velocity[index]
    if abs(velocity) > rest:
        tail, head = (0.93, 0.74) if velocity < 0 else (0.74, 0.93)
        ax.annotate(
            "",
            xy=(0.5, head),
            xytext=(0.5, tail),
            xycoords="axes fraction",
            arrowprops={"arrowstyle": "-|>", "color": "black", "linewidth": 1.4, "shrinkA": 0,
                        "shrinkB": 0},
            zorder=4,
        )  # fmt: skip
