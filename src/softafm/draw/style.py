"""The house style of figures: colours, strokes, and axes in the prefixes that suit the data."""

from collections.abc import Iterable, Sequence
from math import floor, log10
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import EngFormatter, MaxNLocator

from softafm.units.quantities import write_quantity

# Okabe and Ito's palette: distinct under every common colour blindness, and in grey.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
APPROACH: Final = "-"
RETRACT: Final = (0, (4, 1.5))
HOLLOW: dict[str, Any] = {
    "linestyle": "none",
    "marker": "o",
    "markersize": 4.5,
    "markerfacecolor": "white",
}
"""Style of points that lie on, or beside, a line."""
PREFIXES = EngFormatter.ENG_PREFIXES
_STYLES: Final = (APPROACH, RETRACT)


def choose_labels(
    noun: str, things: Sequence[Any], labels: Sequence[str] | None, usual: Iterable[str]
) -> list[str]:
    """Return a label for each thing to draw, the usual ones by default.

    Raises
    ------
    ValueError
        If there is nothing to draw or the number of labels is not that of the things.
    """
    if not things:
        raise ValueError(f"{noun}s is empty: must hold at least one {noun}")
    names = list(usual if labels is None else labels)
    if len(names) != len(things):
        raise ValueError(f"labels has {len(names)} entries: must have one a {noun}, {len(things)}")
    return names


def choose_line(index: int) -> dict[str, Any]:
    """Style of one of several lines: a colour each, and dashes when all were used."""
    style = _STYLES[index // len(COLOURS) % len(_STYLES)]
    return {"color": COLOURS[index % len(COLOURS)], "linestyle": style, "linewidth": 1.5}


def choose_colours(index: int, count: int) -> tuple[str, str]:
    """Colours of approach and retract: one a run, but two for a run that stands alone."""
    if count == 1:
        return COLOURS[0], COLOURS[1]
    return COLOURS[index % len(COLOURS)], COLOURS[index % len(COLOURS)]


def make_run_entries(names: list[str]) -> list[Line2D]:
    """Legend entries of runs by colour; none for a run that stands alone."""
    if len(names) == 1:
        return []
    return [
        Line2D([], [], color=choose_colours(index, len(names))[0], linewidth=2.5, label=name)
        for index, name in enumerate(names)
    ]


def make_stroke_entries(count: int) -> list[Line2D]:
    """Legend entries of approach and retract, for so many runs."""
    down, up = choose_colours(0, 1) if count == 1 else ("black", "black")
    return [
        Line2D([], [], color=down, linestyle=APPROACH, label="approach"),
        Line2D([], [], color=up, linestyle=RETRACT, label="retract"),
    ]


def choose_factor(*arrays: np.ndarray) -> float:
    """Factor from SI to the prefix that suits the largest value; NaN do not count."""
    largest = max(float(np.max(np.abs(a), initial=0.0, where=np.isfinite(a))) for a in arrays)
    exponent = 3 * floor(log10(largest) / 3) if largest > 0 else 0
    return 10.0 ** -min(max(exponent, min(PREFIXES)), max(PREFIXES))


def find_prefix(factor: float) -> str:
    """Prefix of the unit of values that were multiplied by ``factor``."""
    return PREFIXES[-round(log10(factor))]


def write_label(title: str, unit: str, factor: float) -> str:
    """Label of an axis whose values were multiplied by ``factor``."""
    return f"{title} ({find_prefix(factor)}{unit})"


def tidy(ax: Axes) -> None:
    """Set round numbers at ticks that point inwards, on all sides."""
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator("auto", steps=[1, 2, 5, 10]))
    ax.tick_params(direction="in", top=True, right=True)


def typeset(value: float, unit: str) -> str:
    """A value with its unit and a minus as in print."""
    return write_quantity(value, unit).replace("-", "−")
