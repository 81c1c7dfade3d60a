"""Tip and surface at chosen instants: what movies and series of pictures show.

Everything here is numbers in SI units; ``animation`` and ``storyboard`` draw them.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from softafm.checks.validate import check_finite
from softafm.units.quantities import write_quantity

if TYPE_CHECKING:
    from xarray import Dataset

STRETCHES = (5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000)


class Scenes(NamedTuple):
    """Tip and surface at instants: ``time``, ``force``, ``velocity`` (n,); profiles (n, r)."""

    time: np.ndarray
    force: np.ndarray
    velocity: np.ndarray
    """Velocity of the tip, m/s, positive upwards."""
    r: np.ndarray
    tip: np.ndarray
    """Height of the tip's surface, m."""
    surface: np.ndarray
    """Height of the sample's surface, m."""

    def outlines(self, index: int, view: "View") -> tuple[np.ndarray, np.ndarray]:
        """Outlines (2, points) of tip and sample at one instant, closed beyond the view, m."""
        r = np.concatenate([-self.r[::-1], self.r])
        corners = np.array([r[-1], r[0]])
        beyond = view.top - view.bottom

        def outline(half: np.ndarray, edge: float) -> np.ndarray:
            heights = np.concatenate([half[::-1], half, [edge, edge]])
            return np.array([np.concatenate([r, corners]), heights])

        tip = self.tip[index]
        above = max(view.top, float(tip.max())) + beyond
        return outline(tip, above), outline(self.surface[index], view.bottom - beyond)


class View(NamedTuple):
    """What a picture shows: radii up to ``half_width`` on both sides, heights in between; m."""

    half_width: float
    bottom: float
    top: float
    stretch: int
    """How many times heights are drawn larger than radii: 1 but for very blunt tips."""


def require_profiles(result: "Dataset") -> None:
    """Raise ValueError if a result holds no surface profiles."""
    if "deformation" not in result or "gap" not in result:
        raise ValueError(
            "the result holds no surface profiles: run it with --profiles (profiles=True in Python)"
        )


def choose_window(
    result: "Dataset",
    start: float | None = None,
    stop: float | None = None,
    margin: float = 0.1,
) -> tuple[float, float]:
    """Return the stretch of time to show, s.

    By default while a force acts, at least a hundredth of the largest, and then while the surface
    returns, but no longer than the force acted; with a margin on both sides. Of several taps it is
    the last.

    Raises
    ------
    ValueError
        If nothing of the result lies between ``start`` and ``stop``.
    """
    time = result["time"].values
    first, last = float(time[0]), float(time[-1])
    given = {
        name: check_finite(name, value, "s")
        for name, value in (("start", start), ("stop", stop))
        if value is not None
    }
    low = max(given.get("start", first), first)
    high = min(given.get("stop", last), last)
    if not low < high:
        written = ", ".join(
            f"{name} = {write_quantity(value, 's')}" for name, value in given.items()
        )
        raise ValueError(
            f"{written}: must be in order and overlap the run, from {write_quantity(first, 's')} "
            f"to {write_quantity(last, 's')}"
        )
    if start is None and stop is None and result.sizes.get("cycle", 1) > 1:
        low = last - (last - first) / result.sizes["cycle"]
    inside = (time >= low) & (time <= high)
    time, force = time[inside], result["force"].values[inside]
    strength = np.abs(force)
    if strength.max(initial=0.0) > 0:
        felt = time[strength >= 0.01 * strength.max()]
        moves = np.cumsum(measure_changes(force, result["deformation"].values[inside]))
        rest = float(time[1:][moves >= 0.995 * moves[-1]][0]) if moves.size else felt[-1]
        end = np.clip(rest, felt[-1], 2 * felt[-1] - felt[0])
        around = margin * (end - felt[0])
        low = low if start is not None else max(low, float(felt[0] - around))
        high = high if stop is not None else min(high, float(end + around))
    return low, high


def measure_changes(force: np.ndarray, surface: np.ndarray) -> np.ndarray:
    """How far force and surface move in each step, as parts of their ranges, summed."""
    moves = np.zeros(max(force.size - 1, 0))
    if moves.size and (largest := np.ptp(force)) > 0:
        moves += np.abs(np.diff(force)) / largest
    if moves.size and (largest := np.abs(surface).max()) > 0:
        moves += np.abs(np.diff(surface, axis=0)).max(axis=1) / largest
    return moves


def find_jumping_steps(time: np.ndarray, jumps: np.ndarray) -> np.ndarray:
    """Return which steps (n - 1,) between instants (n,) hold an elastic jump."""
    return np.isin(np.arange(1, time.size), np.searchsorted(time, jumps))


def interpolate_scenes(result: "Dataset", instants: np.ndarray) -> Scenes:
    """Interpolate profiles and force linearly between the steps of a run.

    Over an elastic jump nothing is interpolated: all stays as it was until the jump has happened.
    """
    time = result["time"].values
    after = np.clip(np.searchsorted(time, instants, side="right"), 1, time.size - 1)
    before = after - 1
    share = (instants - time[before]) / (time[after] - time[before])
    jumps = find_jumping_steps(time, result["jump_time"].values)
    share = np.where(jumps[before] & (share < 1), 0.0, share)

    def at(values: np.ndarray) -> np.ndarray:
        weight = share.reshape(-1, *[1] * (values.ndim - 1))
        return (1 - weight) * values[before] + weight * values[after]

    surface = at(result["deformation"].values)
    return Scenes(
        time=np.asarray(instants, float),
        force=at(result["force"].values),
        velocity=at(_estimate_velocity(time, result["tip_height"].values, jumps)),
        r=result["r"].values,
        tip=at(result["gap"].values) + surface,
        surface=surface,
    )


def _estimate_velocity(time: np.ndarray, height: np.ndarray, jumps: np.ndarray) -> np.ndarray:
    """Velocity at every instant, the mean of the steps before and after; a jump is no motion."""
    slope = np.where(jumps, 0.0, np.diff(height) / np.diff(time))
    smooth = np.where(jumps, 0.0, 1.0)
    total, count = np.convolve(slope, [1, 1]), np.convolve(smooth, [1, 1])
    return total / np.maximum(count, 1.0)


def choose_view(result: "Dataset", start: float, stop: float, shape: float) -> View:
    """Return the view that holds the contact between two times, for a picture of this shape.

    ``shape`` is the width of the picture over its height. The view reaches out two contact radii
    and shows more than the surface's whole movement, and the tip at its lowest. Heights are
    stretched only if all that would otherwise fill less than an eleventh of the picture.
    """
    time, r = result["time"].values, result["r"].values
    steps = slice(
        max(np.searchsorted(time, start, side="right") - 1, 0), np.searchsorted(time, stop) + 1
    )
    surface = result["deformation"].values[steps]
    contact = float(result["contact_radius"].values[steps].max())
    half_width = min(2 * contact, r[-1]) if contact > 0 else r[-1] / 2
    low, high = min(float(surface.min()), 0.0), max(float(surface.max()), 0.0)
    nearest = float(result["tip_height"].values[steps].min())
    needed = 2.2 * (max(high, nearest) - low)
    height = 2 * half_width / shape
    stretch = max((s for s in STRETCHES if needed > 0 and s <= height / needed), default=1)
    height = max(height / stretch, needed)
    bottom = low - 0.3 * (height - (high - low))
    return View(float(half_width), bottom, bottom + height, stretch)
