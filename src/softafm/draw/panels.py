"""Figures of curves: panels side by side, each of one variable against another."""

from itertools import pairwise

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from softafm.draw.histories import find_axis, find_force, name_moved, split_strokes
from softafm.draw.style import (
    APPROACH,
    HOLLOW,
    RETRACT,
    choose_colours,
    choose_factor,
    make_run_entries,
    make_stroke_entries,
    tidy,
    typeset,
    write_label,
)
from softafm.modes import Layout
from softafm.results.content import find_unit

_SIZES = {1: (6.4, 4.4), 2: (9.6, 4.2)}
_PANEL = (4.0, 4.2)
"""Size of a panel where there are three or more, inches."""


def draw_panels(runs: list[xr.Dataset], names: list[str], layout: Layout) -> Figure:
    """Draw what a mode's figure names, all runs over each other."""
    count = len(layout.panels)
    figure = Figure(
        figsize=_SIZES.get(count, (count * _PANEL[0], _PANEL[1])), dpi=150, layout="constrained"
    )
    axes = figure.subplots(1, count, squeeze=False)[0]
    shared = _share_ordinates(axes, layout)
    for ax, (abscissa, ordinate) in zip(axes, layout.panels, strict=True):
        _draw(ax, runs, abscissa, ordinate)
    for ax in shared:
        ax.set_ylabel("")
        ax.tick_params(labelleft=False)
    if layout.cropped:
        _crop(axes, runs, layout)
    _add_legend(figure, axes, runs, names, layout)
    return figure


def _draw(ax: Axes, runs: list[xr.Dataset], abscissa: str, ordinate: str) -> None:
    """Draw two variables in the prefixes that suit the data, and label the axes."""
    scales = _choose_scale(runs, abscissa), _choose_scale(runs, ordinate)
    ax.axhline(0, color="0.75", linewidth=0.8, zorder=0)
    if abscissa != "time":
        ax.axvline(0, color="0.75", linewidth=0.8, zorder=0)
    for index, run in enumerate(runs):
        along = run[abscissa].dims
        x = scales[0] * run[abscissa].values
        y = scales[1] * run[ordinate].transpose(*along, ...).values
        approach, retract = choose_colours(index, len(runs))
        if along != ("time",):
            ax.plot(x, y.reshape(x.size, -1), color=approach, linewidth=1.5)
            continue
        for stroke, falling in split_strokes(run[name_moved(run)].values):
            ax.plot(
                x[stroke],
                y[stroke],
                color=approach if falling else retract,
                linestyle=APPROACH if falling else RETRACT,
                linewidth=1.5,
            )
        jumps, time = run["jump_time"].values, run["time"].values
        ax.plot(
            np.interp(jumps, time, x),
            np.interp(jumps, time, y),
            color=approach if len(runs) > 1 else "black",
            zorder=3,
            **HOLLOW,
        )
    ax.set_xlabel(_write_label(abscissa, scales[0]), fontsize=11)
    ax.set_ylabel(_write_label(ordinate, scales[1]), fontsize=11)
    tidy(ax)


def _share_ordinates(axes: np.ndarray, layout: Layout) -> list[Axes]:
    """Give neighbours that show one variable one axis; return those right of another."""
    shared = []
    for (left, right), (before, here) in zip(pairwise(axes), pairwise(layout.panels), strict=True):
        if before[1] == here[1]:
            right.sharey(left)
            shared.append(right)
    return shared


def _crop(axes: np.ndarray, runs: list[xr.Dataset], layout: Layout) -> None:
    """Show, with a margin, only where the force exceeds a hundredth of its largest.

    Heights, of the tip and of the base of its lever, are shown alike.
    """
    abscissae = dict.fromkeys(abscissa for abscissa, _ in layout.panels)
    heights = [name for name in abscissae if name.endswith("_height")]
    for ax, (abscissa, _) in zip(axes, layout.panels, strict=True):
        low, high = find_force(runs, *(heights if abscissa in heights else [abscissa]))
        scale = _choose_scale(runs, abscissa)
        ax.set_xlim(scale * low, scale * high)
        if abscissa == "time":
            ax.set_title(_measure_duration(runs), size=10)


def _add_legend(
    figure: Figure, axes: np.ndarray, runs: list[xr.Dataset], names: list[str], layout: Layout
) -> None:
    """Add the legend of runs and strokes, and the scalars of the title."""
    entries, stroke = make_run_entries(names), _make_stroke_entries(runs)
    if len(axes) == 1:
        axes[0].legend(handles=entries + stroke, frameon=False)
    elif not layout.title:
        entries += stroke
        columns = max(1, min(len(entries), 6))
        figure.legend(handles=entries, loc="outside lower center", ncols=columns, frameon=False)
    else:
        axes[0].legend(handles=stroke, frameon=False)
        lines = [_summarise(run, layout) for run in runs]
        if len(runs) == 1:
            axes[-1].set_title(lines[0], size=10)
            return
        lines = [f"{name}: {line}" for name, line in zip(names, lines, strict=True)]
        figure.legend(handles=make_run_entries(lines), loc="outside lower center", frameon=False)


def _make_stroke_entries(runs: list[xr.Dataset]) -> list[Line2D]:
    """Legend entries of the strokes that there are by line style, and of elastic jumps."""
    if "jump_time" not in runs[0]:
        return []
    fallen = {falling for run in runs for _, falling in split_strokes(run[name_moved(run)].values)}
    down, up = make_stroke_entries(len(runs))
    entries = [entry for entry, falling in ((down, True), (up, False)) if falling in fallen]
    if any(run["jump_time"].size for run in runs):
        entries.append(Line2D([], [], color="black", label="elastic jump", **HOLLOW))
    return entries


def _summarise(run: xr.Dataset, layout: Layout) -> str:
    """Return the scalars of the title in words."""
    return ", ".join(
        f"{words} {typeset(float(run[name]), str(find_unit(name)))}" for name, words in layout.title
    )


def _measure_duration(runs: list[xr.Dataset]) -> str:
    duration = max(float(np.ptp(run["time"].values)) for run in runs)
    return f"Interaction only; the run lasts {typeset(duration, 's')}"


def _write_label(variable: str, scale: float) -> str:
    title, unit = find_axis(variable)
    return title if unit is None else write_label(title, unit, scale)


def _choose_scale(runs: list[xr.Dataset], variable: str) -> float:
    """Factor from SI to the prefix that suits the largest value of all runs."""
    if find_axis(variable)[1] is None:
        return 1.0
    return choose_factor(*(run[variable].values for run in runs))
