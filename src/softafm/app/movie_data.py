"""What a movie in the browser is made of: shapes as whole numbers, and the force curve."""

from math import ceil
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from softafm.app.curve_data import thin
from softafm.draw.histories import AXES, find_force
from softafm.draw.scene_parts import choose_scales, make_writers, write_titles
from softafm.draw.scenes import Scenes, View, choose_view, choose_window, interpolate_scenes
from softafm.units.quantities import choose_prefix

if TYPE_CHECKING:
    from xarray import Dataset

CURVES = {"time": "time", "height": "tip_height", "force": "force"}
"""The columns of the force curve, and what they are called in a result."""

_SHAPE = 2.4
"""Width over height of the picture, about; the browser makes proportions true at any size."""
_RADII = 150
_REACH = 3
"""How many half widths of the view are sent, for pictures that are wider than expected."""
_BEYOND = 5
"""How many heights of the view lie between it and the closed ends of the outlines."""
_QUANTUM = 2e-4
"""Of the view's height."""
_FARTHEST = 32_000
_CURVE_POINTS = 8000


class Movie(NamedTuple):
    """Tip, surface and force at evenly spaced instants, in the units of the axes."""

    x: np.ndarray
    """Radii of an outline, there and back along its closed end."""
    rise: np.ndarray
    """Height of the tip's surface above its apex, in quanta, from the axis outwards."""
    apex: np.ndarray
    """Height of the apex in each frame, in quanta."""
    surface: np.ndarray
    """Height of the sample's surface, in quanta, (frames, radii)."""
    quantum: float
    ends: tuple[float, float]
    """Heights at which the outlines of sample and tip close."""
    view: dict[str, float]
    """``half_width``, ``bottom``, ``top``, and by how much heights are ``stretch``-ed."""
    titles: tuple[str, str]
    frames: dict[str, np.ndarray]
    """``CURVES`` at the frames."""
    curve: dict[str, np.ndarray]
    """``CURVES`` at the steps of the run."""
    labels: dict[str, str]
    """Titles of the axes of ``CURVES``, with their units."""
    near: tuple[float, float]
    """Tip heights between which there is a force."""
    moments: list[str]
    strengths: list[str]

    def outline(self, half: np.ndarray, end: float) -> np.ndarray:
        """Return the heights over ``x`` of an outline, from those of its half in quanta."""
        heights = self.quantum * np.concatenate([half[::-1], half])
        return np.concatenate([heights, [end, end]])


def make_movie(result: "Dataset", frames: int) -> Movie:
    """Return the movie of a result that holds shapes, while force acts and the surface returns."""
    start, stop = choose_window(result)
    scenes = interpolate_scenes(result, np.linspace(start, stop, frames))
    view = choose_view(result, start, stop, _SHAPE)
    in_radius, in_height = choose_scales(view)
    seen = np.flatnonzero(scenes.r <= _REACH * view.half_width)
    seen = np.union1d(seen[:: ceil(seen.size / _RADII)], seen[-1:])
    radii = in_radius * scenes.r[seen]
    size = view.top - view.bottom
    ends = view.bottom - _BEYOND * size, view.top + _BEYOND * size
    at_frames, curve, labels, near = _collect_curves(result, start, stop, scenes)
    moment, strength = make_writers(scenes)
    return Movie(
        x=np.concatenate([-radii[::-1], radii, [radii[-1], -radii[-1]]]),
        rise=_round_heights(scenes.tip[0, seen] - scenes.tip[0, 0], view),
        apex=_round_heights(scenes.tip[:, 0], view),
        surface=_round_heights(scenes.surface[:, seen], view),
        quantum=in_height * _QUANTUM * size,
        ends=(in_height * ends[0], in_height * ends[1]),
        view={
            "half_width": in_radius * view.half_width,
            "bottom": in_height * view.bottom,
            "top": in_height * view.top,
            "stretch": view.stretch * in_radius / in_height,
        },
        titles=write_titles(view),
        frames=at_frames,
        curve=curve,
        labels=labels,
        near=near,
        moments=[moment(time) for time in scenes.time],
        strengths=[strength(force) for force in scenes.force],
    )


def _round_heights(heights: np.ndarray, view: View) -> np.ndarray:
    quanta = np.round(heights / (_QUANTUM * (view.top - view.bottom)))
    return np.clip(quanta, -_FARTHEST, _FARTHEST).astype(np.int16)


def _collect_curves(result: "Dataset", start: float, stop: float, scenes: Scenes):
    """Return ``CURVES`` at the frames and at the steps of a run, labels, and where force acts."""
    run = {name: result[variable].values for name, variable in CURVES.items()}
    inside = np.flatnonzero((run["time"] > start) & (run["time"] < stop))
    seen = [run[name][inside] for name in ("force", "height")]
    inside = inside[thin(run["time"][inside], seen, _CURVE_POINTS)]
    above = scenes.tip[0, 0] - np.interp(scenes.time[0], run["time"], run["height"])
    frames = {"time": scenes.time, "height": scenes.tip[:, 0] - above, "force": scenes.force}
    curve = {
        name: np.concatenate([frames[name][:1], values[inside], frames[name][-1:]])
        for name, values in run.items()
    }
    labels, near = {}, find_force([result], CURVES["height"])
    for name, variable in CURVES.items():
        title, unit = AXES[variable]
        factor, unit = choose_prefix(float(np.abs(frames[name]).max()), unit)
        curve[name], frames[name] = factor * curve[name], factor * frames[name]
        labels[name] = f"{title} ({unit})"
        if name == "height":
            near = factor * near[0], factor * near[1]
    return frames, curve, labels, near
