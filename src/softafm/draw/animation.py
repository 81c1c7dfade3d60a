"""Movies of a tip and a surface through a cycle or a force curve."""

import json
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from contextlib import suppress
from importlib import resources
from itertools import permutations
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from softafm.checks.kinds import refuse_non_dataset
from softafm.checks.validate import check_positive, check_whole
from softafm.draw.scene_parts import (
    SAMPLE_COLOURS,
    TIP_COLOURS,
    choose_scales,
    draw,
    make_writers,
    write_titles,
)
from softafm.draw.scenes import choose_view, choose_window, interpolate_scenes, require_profiles
from softafm.progress import Progress, make_reporter
from softafm.results.datasets import write_whole
from softafm.units.quantities import choose_prefix

if TYPE_CHECKING:
    from xarray import Dataset

SUFFIXES = (".mp4", ".gif", ".html")
_MOST_FRAMES = 1000
_SIZE = (8.0, 5.5)  # inches
_DPI = {".gif": 100, ".mp4": 160}  # mp4 needs even numbers of pixels
_STAGE = (0.09, 0.38, 0.895, 0.6)  # left, bottom, width, height in parts of the picture
_GRAPH = (0.09, 0.09, 0.895, 0.17)
_SCENE_SHAPE = _STAGE[2] * _SIZE[0] / (_STAGE[3] * _SIZE[1])
_SHORTEST_GIF_FRAME = 0.02  # s; browsers slow shorter ones down to a tenth of a second
_COLOURS = {"past": "#0072B2", "future": "#b3b3b3", "now": "#D55E00"}
_PAGE_POINTS = 200  # radii a page needs to look smooth

FrameReport = Callable[[int], None]


def animate(
    result: "Dataset",
    path: str | Path,
    *,
    frames: int = 150,
    seconds: float = 6.0,
    start: float | None = None,
    stop: float | None = None,
    overwrite: bool = False,
    progress: bool | Progress | None = None,
) -> None:
    """Write a movie of tip and deformed surface to an .mp4, .gif or .html file.

    The frames are evenly spaced in time. Radii and heights have the same scale, except under a
    tip so blunt that nothing would be seen; the axis then says how far heights are stretched. An
    .html file is a player with the profiles inside: it needs a browser, but no other file or
    address.

    Parameters
    ----------
    result
        What a mode returned with ``profiles=True``.
    path
        File to write; its suffix chooses the format. It appears whole or not at all.
    frames
        Number of frames, 2 to 1000.
    seconds
        Duration of the movie, s.
    start, stop
        Times of the run to begin and end at, s; by default while force acts and the surface
        returns, of several taps in the last.
    overwrite
        Whether an existing file is replaced.
    progress
        None, True for a bar, or a callable (fraction, message).

    Raises
    ------
    ValueError
        If the result holds no surface profiles, the suffix is not known or an argument is out of
        range.
    FileExistsError, OSError
        As ``save``.
    RuntimeError
        If an .mp4 is asked for and the program ffmpeg is not installed, or fails.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise ValueError(f"{path}: suffix {suffix!r} is not known, must be .mp4, .gif or .html")
    refuse_non_dataset("result", result)
    require_profiles(result)
    check_whole("frames", frames, 2, _MOST_FRAMES)
    seconds = check_positive("seconds", seconds, "s")
    if suffix == ".gif" and seconds < frames * _SHORTEST_GIF_FRAME:
        raise ValueError(
            f"frames = {frames}: a .gif shows at most {1 / _SHORTEST_GIF_FRAME:.0f} a second, "
            f"{seconds / _SHORTEST_GIF_FRAME:.0f} in {seconds:g} s"
        )
    if suffix == ".mp4" and _find_ffmpeg() is None:
        raise RuntimeError(
            f"{path}: .mp4 needs the program ffmpeg, which is not installed: install it "
            "(ffmpeg.org, or your system's package ffmpeg), or write .html or .gif"
        )
    movie = _Movie(result, choose_window(result, start, stop), frames)
    write = {".mp4": _write_mp4, ".gif": _write_gif, ".html": _write_html}[suffix]
    with make_reporter(progress) as report:

        def report_frame(index: int) -> None:
            if report is not None:
                report((index + 1) / frames, "drawing")

        write_whole(path, overwrite, lambda part: write(movie, part, seconds, report_frame))


class _Movie:
    """What every format shows: scenes, the view, the curve of force against time, and its texts."""

    def __init__(self, result: "Dataset", times: tuple[float, float], frames: int):
        self.scenes = scenes = interpolate_scenes(result, np.linspace(*times, frames))
        self.view = view = choose_view(result, *times, _SCENE_SHAPE)
        time = result["time"].values
        inside = time[(time > times[0]) & (time < times[1])]
        self.curve_time = np.concatenate([times[:1], inside, times[1:]])
        self.curve_force = interpolate_scenes(result, self.curve_time).force
        self.in_time, second = choose_prefix(float(np.abs(self.curve_time).max()), "s")
        self.in_force, newton = choose_prefix(float(np.abs(self.curve_force).max()), "N")
        self.scale = np.array(choose_scales(view))
        self.titles = (*write_titles(view), f"Time ({second})", f"Force ({newton})")
        self.moment, self.strength = make_writers(scenes)


def _draw_frames(movie: _Movie, dpi: int, report_frame: FrameReport) -> Iterator[np.ndarray]:
    """Yield the frames as colours (height, width, 3); only what moves is drawn anew."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    scenes, view = movie.scenes, movie.view
    figure = Figure(figsize=_SIZE, dpi=dpi)
    canvas = FigureCanvasAgg(figure)
    stage, graph = (figure.add_axes(place) for place in (_STAGE, _GRAPH))
    across, along, time_title, force_title = movie.titles
    stage.set(xlabel=across, ylabel=along)
    sample, tip, level = draw(stage, scenes, 0, view)
    place: dict[str, Any] = {"transform": stage.transAxes, "fontsize": 11, "va": "bottom"}
    clock = stage.text(0.02, 0.03, "", **place)
    gauge = stage.text(0.98, 0.03, "", ha="right", **place)

    times, forces = movie.in_time * movie.curve_time, movie.in_force * movie.curve_force
    graph.axhline(0, color="0.75", linewidth=0.8)
    graph.plot(times, forces, color=_COLOURS["future"], linewidth=1.2)
    (past,) = graph.plot([], [], color=_COLOURS["past"], linewidth=1.6)
    (now,) = graph.plot([], [], marker="o", color=_COLOURS["now"], markersize=6, clip_on=False)
    graph.set(xlim=times[[0, -1]], xlabel=time_title, ylabel=force_title)
    graph.tick_params(direction="in", top=True, right=True)
    figure.align_ylabels()

    moving = [sample, tip, level, clock, gauge, *stage.spines.values(), past, now]
    for artist in moving:
        artist.set_animated(True)
    canvas.draw()
    still = canvas.copy_from_bbox(figure.bbox)
    for index, (time, force) in enumerate(zip(scenes.time, scenes.force, strict=True)):
        above, below = scenes.outlines(index, view)
        tip.set_xy(movie.scale * above.T)
        sample.set_xy(movie.scale * below.T)
        clock.set_text(movie.moment(time))
        gauge.set_text(movie.strength(force))
        x, y = movie.in_time * time, movie.in_force * force
        gone = movie.curve_time < time
        past.set_data([*times[gone], x], [*forces[gone], y])
        now.set_data([x], [y])
        canvas.restore_region(still)
        for artist in moving:
            artist.axes.draw_artist(artist)
        yield np.asarray(canvas.buffer_rgba())[..., :3].copy()
        report_frame(index)


def _write_gif(movie: _Movie, path: str, seconds: float, report_frame: FrameReport) -> None:
    """Write the frames with one palette for all, for then only what moves takes space."""
    from PIL import Image

    palette = Image.new("P", (1, 1))
    palette.putpalette(_make_palette())
    images = [
        Image.fromarray(picture).quantize(palette=palette, dither=Image.Dither.NONE)
        for picture in _draw_frames(movie, _DPI[".gif"], report_frame)
    ]
    ends = np.round(np.linspace(0, 100 * seconds, len(images) + 1))  # a GIF counts in 10 ms
    images[0].save(
        path,
        format="GIF",
        save_all=True,
        append_images=images[1:],
        duration=[10 * int(step) for step in np.diff(ends)],
        loop=0,
    )


def _make_palette() -> list[int]:
    """Red, green and blue of the colours drawn, and of two blends between any two of them."""
    from matplotlib.colors import to_rgb

    names = [*TIP_COLOURS, *SAMPLE_COLOURS, *_COLOURS.values(), "white", "black"]
    colours = [np.array(to_rgb(name)) for name in dict.fromkeys(names)]
    blends = [(2 * a + b) / 3 for a, b in permutations(colours, 2)]
    return np.round(255 * np.concatenate(colours + blends)).astype(int).tolist()


def _find_ffmpeg() -> str | None:
    return shutil.which("ffmpeg")


def _write_mp4(movie: _Movie, path: str, seconds: float, report_frame: FrameReport) -> None:
    """Pipe the frames to ffmpeg."""
    dpi = _DPI[".mp4"]
    width, height = (round(dpi * inches) for inches in _SIZE)
    rate = f"{movie.scenes.time.size / seconds:.9g}"
    command = [_find_ffmpeg() or "ffmpeg", "-loglevel", "error"]
    command += ["-f", "rawvideo", "-pix_fmt", "rgb24"]
    command += ["-video_size", f"{width}x{height}", "-framerate", rate, "-i", "pipe:0"]
    command += ["-vcodec", "h264", "-pix_fmt", "yuv420p", "-movflags", "+faststart"]
    command += ["-f", "mp4", "-y", str(path)]
    with tempfile.TemporaryFile() as said:
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=said, stderr=said)
        assert process.stdin is not None
        with suppress(BrokenPipeError), process:  # then ffmpeg has ended, and said why
            for picture in _draw_frames(movie, dpi, report_frame):
                process.stdin.write(picture.tobytes())
            process.stdin.close()
        if process.returncode != 0:
            said.seek(0)
            lines = said.read().decode(errors="replace").strip().splitlines()
            reason = lines[-1] if lines else f"exit status {process.returncode}"
            raise RuntimeError(f"ffmpeg could not write the movie: {reason}")


def _write_html(movie: _Movie, path: str, seconds: float, report_frame: FrameReport) -> None:
    """Write a page that draws the profiles itself, from whole numbers in fractions of a pixel."""
    scenes, view = movie.scenes, movie.view
    in_radius, in_height = movie.scale.tolist()
    in_time, in_force = movie.in_time, movie.in_force
    seen = np.flatnonzero(scenes.r <= view.half_width)
    seen = np.arange(min(seen[-1] + 2, scenes.r.size))
    seen = np.union1d(seen[:: ceil(seen.size / _PAGE_POINTS)], seen[-1:])
    quantum = 2e-4 * (view.top - view.bottom)

    def quantise(values: np.ndarray) -> list[int]:
        return np.round(values / quantum).astype(int).tolist()

    def shorten(values: np.ndarray, digits: int = 5) -> list[float]:
        return [float(f"{value:.{digits}g}") for value in values]

    data = {
        "seconds": seconds,
        "width": in_radius * view.half_width,
        "bottom": in_height * view.bottom,
        "top": in_height * view.top,
        "stretch": view.stretch * in_radius / in_height,
        "quantum": in_height * quantum,
        "r": shorten(in_radius * scenes.r[seen]),
        "tip": quantise(scenes.tip[0, seen] - scenes.tip[0, 0]),
        "apex": quantise(scenes.tip[:, 0]),
        "surface": quantise(scenes.surface[:, seen]),
        "time": shorten(in_time * scenes.time, 9),
        "force": shorten(in_force * scenes.force),
        "moment": [movie.moment(time) for time in scenes.time],
        "strength": [movie.strength(value) for value in scenes.force],
        "curve": [shorten(in_time * movie.curve_time, 9), shorten(in_force * movie.curve_force)],
        "titles": movie.titles,
        "colours": {**_COLOURS, "tip": TIP_COLOURS, "sample": SAMPLE_COLOURS},
    }
    page = resources.files("softafm.draw").joinpath("player.html").read_text(encoding="utf-8")
    text = json.dumps(data, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
    Path(path).write_text(page.replace("/*DATA*/", text), encoding="utf-8")
    report_frame(scenes.time.size - 1)
