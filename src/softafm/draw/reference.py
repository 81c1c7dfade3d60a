"""What a figure of results shows beside them: another result, known answers, other curves."""

from collections.abc import Sequence
from itertools import cycle
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from softafm.checks.kinds import refuse_other
from softafm.checks.refusals import suggest
from softafm.checks.validate import check_numbers
from softafm.draw.histories import AXES
from softafm.draw.known_answers import ANSWERS, Line, find_answer
from softafm.draw.style import COLOURS, choose_colours, choose_factor, write_label
from softafm.indentation import Curve
from softafm.modes import MODES

NAME = "reference"
_PANEL = "tip_height", "force"
_WANTED = (
    "a result of softafm, or a pair (tip heights in m, forces in N), a Curve of "
    "softafm.indentation or the name of a known answer, or a list of these"
)
_LOOKS: tuple[tuple[str, Any], ...] = (
    ("black", ":"), (COLOURS[2], "-."), (COLOURS[3], (0, (1, 2.5))), (COLOURS[4], "--")
)  # fmt: skip
"""Colours and strokes of references, whose colour gives way to that of results if it varies."""


def list_references(reference: Any) -> list[Any]:
    """Return names, curves and pairs; a list is a pair unless a name or a curve is in it."""
    several = isinstance(reference, list) and any(isinstance(r, str | Curve) for r in reference)
    return reference if several else [reference]


def check_curve(reference: Any, name: str = NAME) -> Line:
    """Return tip heights (m) and forces (N) of a curve; ValueError if it is none."""
    if isinstance(reference, Curve):
        return reference.height, reference.force
    refuse_other(name, reference, (tuple, list, np.ndarray), _WANTED)
    if len(reference) != 2:
        raise ValueError(f"{name} has {len(reference)} entries: must be {_WANTED}")
    height, force = (
        np.array(check_numbers(f"{name}[{i}]", values, unit))
        for i, (values, unit) in enumerate(zip(reference, ("m", "N"), strict=True))
    )
    if height.size != force.size or height.size < 2:
        raise ValueError(
            f"{name} has {height.size} heights and {force.size} forces: must have as many of "
            "each, at least 2"
        )
    return height, force


def draw_references(
    figure: Figure, mode: str, runs: Sequence[xr.Dataset], references: Sequence[Any]
) -> None:
    """Draw known answers and curves into the panel of force against tip height.

    A known answer is drawn for each result in its colour, or once if it is the same for all. The
    limits of the panel stay.

    Raises
    ------
    ValueError
        If one is no such curve, does not suit a result, or the figure has no such panel.
    """
    lines = [
        _find_lines(reference, NAME if len(references) == 1 else f"{NAME}[{i}]", runs)
        for i, reference in enumerate(references)
    ]
    if mode not in MODES or _PANEL not in MODES[mode].figure.panels:
        raise ValueError(
            f"reference: a figure of mode = {mode} has no axis of tip height; give a result of "
            "that mode"
        )
    x_scale, y_scale = (choose_factor(*(run[n].values for run in runs)) for n in _PANEL)
    ax = _find_panel(figure, write_label(*AXES["tip_height"], x_scale))
    limits, entries = (ax.get_xlim(), ax.get_ylim()), []
    for (label, curves), (own, stroke) in zip(lines, cycle(_LOOKS), strict=False):
        look = {"linestyle": stroke, "linewidth": 1.8, "label": label}
        for index, (height, force) in enumerate(curves):
            colour = own if len(curves) == 1 else choose_colours(index, len(curves))[0]
            ax.plot(x_scale * height, y_scale * force, color=colour, zorder=4, **look)
        entries.append(Line2D([], [], color=own if len(curves) == 1 else "black", **look))
    ax.set(xlim=limits[0], ylim=limits[1])
    legend = ax.get_legend()
    before = [] if legend is None else list(legend.legend_handles)
    ax.legend(handles=[*before, *entries], frameon=False)


def _find_lines(reference: Any, name: str, runs: Sequence[xr.Dataset]) -> tuple[str, list[Line]]:
    """Return what a legend calls a reference, and its line for each result, or one for all."""
    if not isinstance(reference, str):
        return name, [check_curve(reference, name)]
    if reference not in ANSWERS:
        raise ValueError(f"{name} = {reference!r}: {suggest(reference, list(ANSWERS))}")
    lines = [find_answer(reference, run) for run in runs]
    same = all(np.array_equal(one, lines[0]) for one in lines[1:])
    return ANSWERS[reference][0], lines[:1] if same else lines


def _find_panel(figure: Figure, label: str) -> Axes:
    return next(ax for ax in figure.axes if ax.get_xlabel() == label)
