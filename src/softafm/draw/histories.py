"""What a force curve or a tap shows: what is drawn against what, its strokes, where force acts."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from softafm.results.content import VARIABLES

if TYPE_CHECKING:
    from xarray import Dataset

AXES = {
    "time": ("Time", "s"),
    "tip_height": ("Tip height", "m"),
    "base_height": ("Base height", "m"),
    "deflection": ("Deflection", "m"),
    "force": ("Force on the tip", "N"),
    "contact_radius": ("Contact radius", "m"),
}
"""Title and unit of the axis of a variable."""
_UNPREFIXED = {"1": "", "degree": " (°)"}
"""What is added to the title of an axis whose unit takes no prefix."""


def find_axis(name: str) -> tuple[str, str | None]:
    """Return the title of the axis of a variable of results, and its unit if it takes prefixes."""
    if name in AXES:
        return AXES[name]
    unit, words = VARIABLES[name]
    title = words[:1].upper() + words[1:]
    return (f"{title}{_UNPREFIXED[unit]}", None) if unit in _UNPREFIXED else (title, unit)


def name_moved(run: "Dataset") -> str:
    """Return what follows the motion: the base of a lever, or else the tip."""
    return "base_height" if "base_height" in run else "tip_height"


def split_strokes(height: np.ndarray) -> Iterator[tuple[slice, bool]]:
    """Yield the strokes of a motion as (points, whether the tip falls).

    A stroke ends at its extreme height once the motion has reversed by a fiftieth of its range:
    the noise of a measured trajectory makes none.
    """
    reversal = np.ptp(height) / 50
    away = np.flatnonzero(np.abs(height - height[0]) > reversal)
    falling = bool(away.size == 0 or height[away[0]] < height[0])
    start = extreme = 0
    for i, now in enumerate(height):
        onward = height[extreme] - now if falling else now - height[extreme]
        if onward >= 0:
            extreme = i
        elif -onward > reversal:
            yield slice(start, extreme + 1), falling
            start, extreme, falling = extreme, i, not falling
    yield slice(start, height.size), falling


def find_force(runs: Sequence["Dataset"], *variables: str) -> tuple[float, float]:
    """Return where the force exceeds a hundredth of its largest, with a margin.

    The range is that of all the variables in all runs.
    """
    within = []
    for run in runs:
        strength = np.abs(run["force"].values)
        where = strength >= 0.01 * strength.max()
        within += [run[variable].values[where] for variable in variables]
    low, high = float(np.min(np.concatenate(within))), float(np.max(np.concatenate(within)))
    margin = 0.1 * (high - low) or 0.1 * (abs(high) or 1.0)
    return low - margin, high + margin
