"""How tip and surface are drawn and their numbers written, in every kind of picture."""

from collections.abc import Callable
from math import floor, log10
from typing import TYPE_CHECKING, Any

import numpy as np

from softafm.draw.scenes import Scenes, View
from softafm.units.quantities import choose_prefix

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TIP_COLOURS = ("#b3b3b3", "#4d4d4d")
"""Of its body and of its outline."""
SAMPLE_COLOURS = ("#b5d7ee", "#0072B2")

Writer = Callable[[float], str]


def draw(ax: "Axes", scenes: Scenes, index: int, view: View) -> tuple[Any, ...]:
    """Draw tip and sample at one instant; return sample, tip and the line of the flat surface."""
    across, along = scale = choose_scales(view)
    (body, line), (ground, skin) = TIP_COLOURS, SAMPLE_COLOURS
    tip, sample = (np.array(scale)[:, None] * outline for outline in scenes.outlines(index, view))
    (below,) = ax.fill(*sample, facecolor=ground, edgecolor=skin, linewidth=1.2, zorder=1)
    (above,) = ax.fill(*tip, facecolor=body, edgecolor=line, linewidth=1.0, zorder=2)
    level = ax.axhline(0, color="0.45", linewidth=0.6, linestyle=(0, (4, 3)), zorder=3)
    ax.set_xlim(-across * view.half_width, across * view.half_width)
    ax.set_ylim(along * view.bottom, along * view.top)
    ax.set_aspect(view.stretch * across / along)
    return below, above, level


def choose_scales(view: View) -> tuple[float, float]:
    """Return the factors from m to the units of radii and heights: one in true proportions."""
    return _choose_units(view)[0][0], _choose_units(view)[1][0]


def write_titles(view: View) -> tuple[str, str]:
    """Return titles of the horizontal and the vertical axis."""
    (_, across), (_, along) = _choose_units(view)
    stretched = "" if view.stretch == 1 else f", drawn ×{view.stretch}"
    return f"Distance from the axis ({across})", f"Height ({along}){stretched}"


def _choose_units(view: View) -> tuple[tuple[float, str], tuple[float, str]]:
    height = view.half_width if view.stretch == 1 else view.top - view.bottom
    return choose_prefix(view.half_width, "m"), choose_prefix(height, "m")


def make_writers(scenes: Scenes) -> tuple[Writer, Writer]:
    """Return two functions that write a time and a force with the same digits in every picture."""
    interval = float(np.ptp(scenes.time)) / max(scenes.time.size - 1, 1)
    strongest = float(np.abs(scenes.force).max())
    return (
        _make_writer(float(np.abs(scenes.time).max()), "s", interval / 2),
        _make_writer(strongest, "N", strongest / 100),
    )


def _make_writer(largest: float, unit: str, step: float) -> Writer:
    """Return a function that writes values in one unit, with the digits that show a step."""
    factor, name = choose_prefix(largest, unit)
    digits = min(max(-floor(log10(factor * step)), 0), 6) if step > 0 else 0

    def write(value: float) -> str:
        shown = round(factor * value, digits) + 0.0  # no minus zero
        return f"{shown:.{digits}f} {name}".replace("-", "−")

    return write
