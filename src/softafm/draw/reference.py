"""What a figure of results shows beside them: another result, or a closed form."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from softafm.checks.kinds import refuse_other
from softafm.checks.validate import check_numbers
from softafm.draw.histories import AXES
from softafm.draw.style import choose_factor, write_label
from softafm.modes import MODES

NAME = "reference"
_PANEL = "tip_height", "force"
_WANTED = "a result of softafm, or a pair (tip heights in m, forces in N)"


def check_curve(reference: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return tip heights (m) and forces (N) of a closed form; ValueError if it is none."""
    refuse_other("reference", reference, (tuple, list, np.ndarray), _WANTED)
    if len(reference) != 2:
        raise ValueError(f"reference has {len(reference)} entries: must be {_WANTED}")
    names = ("reference[0]", "reference[1]")
    height, force = (
        np.array(check_numbers(name, values, unit))
        for name, values, unit in zip(names, reference, ("m", "N"), strict=True)
    )
    if height.size != force.size or height.size < 2:
        raise ValueError(
            f"reference has {height.size} heights and {force.size} forces: must have as many of "
            "each, at least 2"
        )
    return height, force


def draw_curve(figure: Figure, mode: str, runs: list[xr.Dataset], reference: Any) -> None:
    """Draw a closed form into the panel of force against tip height, within its limits.

    Raises
    ------
    ValueError
        If it is no such curve, or the figure has no such panel.
    """
    height, force = check_curve(reference)
    if mode not in MODES or _PANEL not in MODES[mode].figure.panels:
        raise ValueError(
            f"reference: a figure of mode = {mode} has no axis of tip height; give a result of "
            "that mode"
        )
    x_scale, y_scale = (choose_factor(*(run[n].values for run in runs)) for n in _PANEL)
    ax = _find_panel(figure, write_label(*AXES["tip_height"], x_scale))
    limits = ax.get_xlim(), ax.get_ylim()
    (line,) = ax.plot(x_scale * height, y_scale * force, "k:", linewidth=1.8, zorder=4, label=NAME)
    ax.set(xlim=limits[0], ylim=limits[1])
    own = ax.get_legend()
    entries = [] if own is None else list(own.legend_handles)
    ax.legend(handles=[*entries, line], frameon=False)


def _find_panel(figure: Figure, label: str) -> Axes:
    return next(ax for ax in figure.axes if ax.get_xlabel() == label)
