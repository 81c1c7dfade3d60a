"""What is drawn of a result: lines, points and jumps as columns of numbers in SI units."""

from collections.abc import Sequence
from math import inf
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from softafm.draw import approach_data, histories
from softafm.draw.approach_data import DIRECTIONS, Curves
from softafm.modes import MODES

if TYPE_CHECKING:
    from xarray import Dataset

_MOST_POINTS = 20_000
_MISSED = 1e-4
"""Of the range of a column, by how much each round of leaving out points may at first miss it."""


class Parts(NamedTuple):
    """What is drawn of one result; each part has columns by the names of variables."""

    lines: Curves
    """``"approach"`` and ``"retract"``, or ``"curve"``; with NaN where a line is interrupted."""
    points: Curves
    """Points by what they are called."""
    jumps: dict[str, tuple[dict[str, np.ndarray], dict[str, np.ndarray]]]
    """For each direction of a sweep the states before and after its jumps."""

    def holds(self, *names: str) -> bool:
        """Whether there are columns of all these names."""
        return all(name in columns for columns in self.lines.values() for name in names)

    @property
    def names(self) -> list[str]:
        """The names of the columns."""
        return list(next(iter(self.lines.values())))

    def extent(self, name: str, along: str = "", within: tuple[float, float] = (-inf, inf)):
        """Return lowest and highest value on lines and points, where ``along`` is ``within``."""
        found = []
        for part in (*self.lines.values(), *self.points.values()):
            values = part[name]
            at = part[along or name]
            found.append(values[(at >= within[0]) & (at <= within[1]) & np.isfinite(values)])
        values = np.concatenate(found)
        return (float(values.min()), float(values.max())) if values.size else (inf, -inf)


def collect_parts(result: "Dataset") -> Parts | None:
    """Return what is drawn of a result; None if there is nothing."""
    if "sweep_height" in result.dims:
        return _collect_approach_curve(result) if result.sizes["sweep_height"] else None
    if "jump_time" in result and result.sizes["time"] > 1:
        return _collect_history(result)
    return _collect_curve(result)


def find_panels(result: "Dataset") -> tuple[tuple[str, str], ...]:
    """Return for each panel of a result's figure what is drawn against what; () if not known."""
    mode = MODES.get(str(result.attrs.get("mode")))
    return () if mode is None else mode.figure.panels


def find_axis(name: str) -> tuple[str, str | None]:
    """Return the title of the axis of a column, and its unit if it takes prefixes."""
    return approach_data.AXES[name] if name in approach_data.AXES else histories.find_axis(name)


def _collect_curve(result: "Dataset") -> Parts | None:
    """Return the curves over the coordinate of the first panel; of several at once the first."""
    names = dict.fromkeys(name for panel in find_panels(result) for name in panel if name in result)
    along = result[next(iter(names))].dims if names else ()
    shown = {name: result[name] for name in names if result[name].dims[:1] == along}
    columns = {n: each.values.reshape(each.shape[0], -1)[:, 0] for n, each in shown.items()}
    return Parts({"curve": columns}, {}, {}) if len(along) == 1 and len(columns) > 1 else None


def _collect_history(result: "Dataset") -> Parts:
    drawn = dict.fromkeys([*histories.AXES, *(n for panel in find_panels(result) for n in panel)])
    columns = {
        name: result[name].values
        for name in drawn
        if name in result and result[name].dims == ("time",)
    }
    kept = thin(columns["time"], list(columns.values()), _MOST_POINTS)
    time, height = columns["time"], columns[histories.name_moved(result)][kept]
    strokes: dict[str, list[slice]] = {direction: [] for direction in DIRECTIONS}
    for stroke, falling in histories.split_strokes(height):
        strokes["approach" if falling else "retract"].append(stroke)
    lines = {
        direction: {name: _separate(values[kept], slices) for name, values in columns.items()}
        for direction, slices in strokes.items()
    }
    jumps = result["jump_time"].values
    points = {name: np.interp(jumps, time, values) for name, values in columns.items()}
    return Parts(lines, {"elastic jump": points} if jumps.size else {}, {})


def _collect_approach_curve(result: "Dataset") -> Parts:
    curves = approach_data.collect_curves(result)
    lines, jumps = {}, {}
    for direction in DIRECTIONS:
        swept, pairs = curves[direction], approach_data.find_jumps(result, direction)
        cut = [max(pair) for pair in pairs]
        lines[direction] = {name: np.insert(v, cut, np.nan) for name, v in swept.items()}
        before, after = (
            {name: values[[pair[side] for pair in pairs]] for name, values in swept.items()}
            for side in (0, 1)
        )
        if pairs:
            jumps[direction] = before, after
    points = {f"{kind} solution": curves[kind] for kind in ("stable", "unstable")}
    return Parts(lines, points, jumps)


def _separate(values: np.ndarray, slices: Sequence[slice]) -> np.ndarray:
    """Return stretches of an array one after another, with NaN between them."""
    pieces = [piece for one in slices for piece in (values[one], [np.nan])]
    return np.concatenate(pieces[:-1]) if pieces else np.empty(0)


def thin(time: np.ndarray, columns: Sequence[np.ndarray], most: int) -> np.ndarray:
    """Return the indices of at most ``most`` points, and all if there are no more than that.

    Straight lines between them in ``time`` miss no column by more of its range than is needed to
    have so few, and so one column drawn against another keeps its shape. Ends and extremes stay.
    """
    kept = np.arange(time.size)
    if time.size <= most:
        return kept
    needed = np.zeros(time.size, bool)
    ends = [int(end(values)) for values in columns for end in (np.argmin, np.argmax)]
    needed[[0, -1, *ends]] = True
    missed = _MISSED
    while kept.size > most:
        before = kept.size
        for first in (1, 2):
            kept = _leave_out_straight(time, columns, kept, needed, missed, first)
        if kept.size > 0.9 * before:
            missed *= 2
    return kept


def _leave_out_straight(
    time: np.ndarray,
    columns: Sequence[np.ndarray],
    kept: np.ndarray,
    needed: np.ndarray,
    missed: float,
    first: int,
) -> np.ndarray:
    """Leave out every other point, from ``first`` on, that lies between its neighbours."""
    before, at, after = (kept[first + shift :][: kept.size - 1 - first : 2] for shift in (-1, 0, 1))
    size = min(before.size, at.size, after.size)
    before, at, after = before[:size], at[:size], after[:size]
    span = time[after] - time[before]
    part = np.divide(time[at] - time[before], span, out=np.full(size, 0.5), where=span > 0)
    straight = ~needed[at]
    for values in columns:
        line = values[before] + part * (values[after] - values[before])
        straight &= np.abs(values[at] - line) <= missed * np.ptp(values)
    return np.setdiff1d(kept, at[straight], assume_unique=True)
