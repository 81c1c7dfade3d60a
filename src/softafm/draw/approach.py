"""The figure of an approach curve: what is recorded, and all that could be.

Its panels are those of Fig. 9 of Rajabifar et al. 2021, and the lowest height of the tip, Z − A:
against Z the amplitude itself would be a diagonal with all its jumps too small to see.
"""

from typing import Any, Final

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from softafm.draw.approach_data import AXES, DIRECTIONS, Curves, collect_curves, find_jumps
from softafm.draw.style import (
    APPROACH,
    RETRACT,
    choose_colours,
    choose_factor,
    make_run_entries,
    make_stroke_entries,
    tidy,
    write_label,
)

_STABLE: dict[str, Any] = {"marker": "o", "markersize": 3.5, "linestyle": "none"}
_UNSTABLE: dict[str, Any] = {**_STABLE, "markerfacecolor": "white", "markeredgewidth": 0.8}
_JUMP: dict[str, Any] = {"arrowstyle": "-|>", "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0}
_LEFT_OUT: Final = "0.55"


def draw_approach_curve(runs: list[xr.Dataset], names: list[str]) -> Figure:
    """Phase, dissipation and virial against the amplitude ratio; how deep the tip goes at a height.

    Lines are the sweeps and arrows their jumps; dots are the solutions at the amplitude ratios.
    """
    if any(run.sizes["sweep_height"] == 0 for run in runs):
        raise ValueError("a result holds no height for any amplitude: there is nothing to draw")
    figure = Figure(figsize=(9.6, 7.2), dpi=150, layout="constrained")
    (phase, dissipation), (virial, lowest) = figure.subplots(2, 2)
    curves = [collect_curves(run) for run in runs]
    jumps = [{direction: find_jumps(run, direction) for direction in DIRECTIONS} for run in runs]
    _draw(phase, curves, jumps, "ratio", "phase")
    _draw(dissipation, curves, jumps, "ratio", "dissipation")
    _draw(virial, curves, jumps, "ratio", "virial")
    _draw(lowest, curves, jumps, "height", "lowest")
    phase.yaxis.set_major_locator(MultipleLocator(30))
    _mark(phase, 90, "attractive", "repulsive")
    _mark(virial, 0, "", "")
    _mark(lowest, 0, "above", "below")
    dissipation.set_ylim(bottom=min(0.0, dissipation.get_ylim()[0]))
    entries = [
        *make_run_entries(names),
        *make_stroke_entries(len(runs)),
        *_make_solution_entries(len(runs)),
    ]
    columns = min(len(entries), 6)
    figure.legend(handles=entries, loc="outside lower center", ncols=columns, frameon=False)
    return figure


def _draw(
    ax: Axes, runs: list[Curves], jumps: list[dict[str, Any]], abscissa: str, ordinate: str
) -> None:
    """Draw solutions, sweeps and jumps of all runs, in the prefixes that suit them."""
    scales = []
    for name, label in ((abscissa, ax.set_xlabel), (ordinate, ax.set_ylabel)):
        title, unit = AXES[name]
        scale = 1.0
        if unit is not None:
            scale = choose_factor(*(part[name] for run in runs for part in run.values()))
            title = write_label(title, unit, scale)
        scales.append(scale)
        label(title, fontsize=11)
    tidy(ax)
    for index, (curves, jumped) in enumerate(zip(runs, jumps, strict=True)):
        drawn = {
            kind: (scales[0] * part[abscissa], scales[1] * part[ordinate])
            for kind, part in curves.items()
        }
        own = choose_colours(index, len(runs))
        dots = _LEFT_OUT if len(runs) == 1 else own[0]
        ax.plot(*drawn["stable"], color=dots, zorder=1.5, **_STABLE)
        ax.plot(*drawn["unstable"], color=dots, zorder=1.5, **_UNSTABLE)
        for direction, colour, style in zip(DIRECTIONS, own, (APPROACH, RETRACT), strict=True):
            x, y = drawn[direction]
            for before, after in jumped[direction]:
                arrow = {**_JUMP, "color": colour}
                ends = (x[after], y[after]), (x[before], y[before])
                ax.annotate("", ends[0], ends[1], arrowprops=arrow)
            cut = [max(pair) for pair in jumped[direction]]
            x, y = (np.insert(values, cut, np.nan) for values in (x, y))
            ax.plot(x, y, color=colour, linestyle=style, linewidth=1.5)


def _mark(ax: Axes, level: float, above: str, below: str) -> None:
    """Draw a level, and say at the left end what is above and below it."""
    ax.axhline(level, color="0.75", linewidth=0.8, zorder=0)
    for words, offset, align in ((above, 2, "bottom"), (below, -2, "top")):
        ax.annotate(
            words,
            (0, level),
            xycoords=("axes fraction", "data"),
            xytext=(4, offset),
            textcoords="offset points",
            va=align,
            size=8,
            color="0.45",
            annotation_clip=True,
        )


def _make_solution_entries(count: int) -> list[Line2D]:
    """Legend entries of solutions by stability."""
    colour = _LEFT_OUT if count == 1 else "black"
    return [
        Line2D([], [], color=colour, label="stable solution", **_STABLE),
        Line2D([], [], color=colour, label="unstable solution", **_UNSTABLE),
    ]
