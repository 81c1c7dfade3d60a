"""Movies and twelve instants: what they show, and that their files are whole or not there."""

import json
import re
import stat
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import imageio_ffmpeg
import matplotlib
import numpy as np
import pytest
import xarray as xr
from PIL import Image

import softafm as sa
from softafm.cli import main
from softafm.draw.scenes import choose_view, choose_window, interpolate_scenes
from softafm.draw.storyboard import choose_instants
from softafm.experiment.config import read_example

LDPE = sa.Contact(
    tip=sa.Paraboloid(radius=10e-9),
    sample=sa.StandardLinearSolid(E0=2e9, E_inf=0.1e9, creep_time=1e-7, poisson=0.49),
    surface=sa.LennardJones(hamaker=1e-19, z0=0.25e-9),
)
SOFT = sa.Contact(LDPE.tip, sa.Elastic(0.1e9, poisson=0.49), LDPE.surface)
FORMATS = ["tap.html", "tap.gif", "tap.mp4"]
posix = pytest.mark.skipif(sys.platform == "win32", reason="the stand-in for ffmpeg is a script")


@pytest.fixture(autouse=True)
def _strict_floating_point():
    with np.errstate(all="raise", under="ignore"):
        yield


@pytest.fixture(scope="module")
def tap():
    """The tap of Fig. 10 of the paper; the surface peels off slowly."""
    return sa.tapping_cycle(
        LDPE, 49.6e-9, 46e-9, 278e3, cycles=1, profiles=True, tolerance=0.05
    )  # fmt: skip


@pytest.fixture(scope="module")
def ramp():
    """A tip that an elastic surface snaps to, and later from."""
    return sa.force_distance(
        SOFT, sa.Triangle(10e-9, -3e-9, 5e-6), profiles=True, tolerance=0.05
    )  # fmt: skip


def made_up(surface, height, jump_time=(), radius=10e-9):
    """A result, one step a second, with a given surface (time,), flat over r, and tip height."""
    surface, height = np.asarray(surface, float), np.asarray(height, float)
    r = np.linspace(0, 30e-9, 31)
    deformation = np.repeat(surface[:, None], r.size, axis=1)
    tip = height[:, None] + r**2 / (2 * radius)
    return xr.Dataset(
        {
            "tip_height": ("time", height),
            "force": ("time", 10 * surface),
            "contact_radius": ("time", np.where(height < surface, 5e-9, 0)),
            "deformation": (("time", "r"), deformation),
            "gap": (("time", "r"), tip - deformation),
            "jump_time": ("jump", np.array(jump_time, float)),
        },
        coords={"time": np.arange(surface.size, dtype=float), "r": r},
    )


def left_in(folder):
    return sorted(path.name for path in folder.iterdir())


def page_data(path):
    (text,) = re.findall(
        r'<script type="application/json" id="data">(.*?)</script>',
        path.read_text(encoding="utf-8"),
        re.S,
    )
    return json.loads(text)


@pytest.fixture
def stand_in(tmp_path_factory, monkeypatch):
    """Put a program in place of ffmpeg: it notes its arguments and how much it was sent."""

    def stand_in(body):
        folder = tmp_path_factory.mktemp("programs")
        program = folder / "ffmpeg"
        program.write_text(f"#!{sys.executable}\nimport json, sys\n{body}\n")
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        monkeypatch.setenv("PATH", str(folder))

    return stand_in


NOTING = """
sent = len(sys.stdin.buffer.read())
open(sys.argv[-1], "w").write(json.dumps({"sent": sent, "arguments": sys.argv[1:]}))
"""


@pytest.fixture
def any_ffmpeg(stand_in):
    """Make .mp4 writable wherever the tests run."""
    if sys.platform == "win32":
        pytest.skip("the stand-in for ffmpeg is a script")
    stand_in(NOTING)


# Scenes: shapes at any instant


def test_the_tip_is_rigid_and_where_the_run_had_it(tap):
    scenes = interpolate_scenes(tap, tap["time"].values)
    profile = tap["r"].values ** 2 / (2 * 10e-9)
    expected = tap["tip_height"].values[:, None] + profile
    assert scenes.tip == pytest.approx(expected, rel=1e-9, abs=1e-18)
    assert np.array_equal(scenes.surface, tap["deformation"].values)
    assert np.array_equal(scenes.force, tap["force"].values)


def test_between_steps_shapes_and_force_are_interpolated():
    result = made_up(surface=[0, 2e-9, 4e-9], height=[9e-9, 5e-9, 7e-9])
    scenes = interpolate_scenes(result, np.array([0.25, 1.5, 2.0]))
    assert scenes.surface[:, 3] == pytest.approx([0.5e-9, 3e-9, 4e-9])
    assert scenes.tip[:, 0] == pytest.approx([8e-9, 6e-9, 7e-9])
    assert scenes.force == pytest.approx([5e-9, 30e-9, 40e-9])
    assert np.sign(scenes.velocity).tolist() == [-1, 1, 1]


def test_a_jump_is_never_interpolated():
    result = made_up([0, 1e-9, 5e-9, 6e-9], [9e-9, 8e-9, 7e-9, 6e-9], jump_time=[2.0])
    scenes = interpolate_scenes(result, np.array([0.5, 1.0, 1.5, 2 - 1e-12, 2.0, 2.5, 3.0]))
    heights = scenes.surface[:, 0] * 1e9
    assert heights == pytest.approx([0.5, 1, 1, 1, 5, 5.5, 6])
    assert scenes.tip[:, 0] * 1e9 == pytest.approx([8.5, 8, 8, 8, 7, 6.5, 6])
    assert np.all(scenes.velocity < 0)


def test_no_scene_of_a_run_with_jumps_mixes_their_two_sides(ramp):
    time, jumps = ramp["time"].values, ramp["jump_time"].values
    assert jumps.size == 2
    for jump in jumps:
        step = int(np.searchsorted(time, jump))
        before, after = ramp["deformation"].values[[step - 1, step]]
        assert np.abs(after - before).max() > 0.2e-9
        scenes = interpolate_scenes(ramp, np.linspace(time[step - 1], time[step], 20))
        assert np.array_equal(scenes.surface[:-1], np.repeat(before[None], 19, axis=0))
        assert np.array_equal(scenes.surface[-1], after)


def test_the_window_of_a_tap_holds_the_contact_and_little_else(tap):
    start, stop = choose_window(tap)
    time, force = tap["time"].values, np.abs(tap["force"].values)
    felt = time[force > 0.02 * force.max()]
    assert start < felt[0]
    assert felt[-1] < stop
    assert stop - start < 0.35 * (time[-1] - time[0])
    assert stop - start > 1.2 * (felt[-1] - felt[0])


def test_a_surface_that_creeps_for_ever_does_not_hold_the_movie_up():
    time = np.arange(1000.0)
    contact = (time > 400) & (time < 500)
    creeping = made_up(-5e-9 * np.exp(-np.abs(time - 450) / 2000), np.where(contact, -6e-9, 9e-9))
    creeping["force"] = ("time", np.where(contact, 1e-9, 0.0))
    assert choose_window(creeping) == pytest.approx((381.4, 618.6), abs=2)


def test_the_window_of_several_taps_is_in_the_last():
    contact = sa.Contact(LDPE.tip, sa.Elastic(1e9, poisson=0.3), LDPE.surface)
    taps = sa.tapping_cycle(contact, 5e-9, 4.5e-9, 278e3, cycles=3, profiles=True, tolerance=0.1)
    start, stop = choose_window(taps)
    assert 2 / 278e3 < start < 2.5 / 278e3 < stop < 3 / 278e3
    assert choose_window(taps, start=0.0)[0] == 0.0
    assert choose_window(taps, start=0.0)[1] > 2.5 / 278e3


def test_start_and_stop_restrict_the_window(tap):
    assert choose_window(tap, 1.5e-6, 1.7e-6) == (1.5e-6, 1.7e-6)
    start, stop = choose_window(tap)
    assert choose_window(tap, start=1.8e-6) == pytest.approx((1.8e-6, stop), rel=0.05)
    assert choose_window(tap, stop=1.8e-6) == pytest.approx((start, 1.8e-6), rel=0.05)
    whole = float(tap["time"][0]), float(tap["time"][-1])
    assert choose_window(tap, -1.0, 1.0) == whole


def test_nothing_moves_and_all_is_shown(tmp_path):
    still = made_up(np.zeros(5), np.full(5, 3e-9))
    assert choose_window(still) == (0.0, 4.0)
    view = choose_view(still, 0.0, 4.0, shape=2.0)
    assert view.bottom < 0 < 3e-9 < view.top
    assert view.stretch == 1
    sa.animate(still, tmp_path / "still.gif", frames=4, seconds=1)
    sa.animate(still, tmp_path / "still.html", frames=4)
    sa.plot_profiles(still).savefig(tmp_path / "still.png")


def test_the_view_holds_tip_and_surface_in_true_proportions(tap):
    start, stop = choose_window(tap)
    view = choose_view(tap, start, stop, shape=2.2)
    surface = tap["deformation"].values
    assert view.stretch == 1
    assert view.bottom < surface.min()
    assert surface.max() < view.top
    contact = float(tap["contact_radius"].max())
    assert 1.5 * contact < view.half_width < 4 * contact
    assert 2 * view.half_width / (view.top - view.bottom) == pytest.approx(2.2, rel=0.1)


def test_under_a_blunt_tip_heights_are_stretched():
    blunt = sa.Contact(sa.Paraboloid(10e-6), sa.Elastic(5e9, poisson=0.3), LDPE.surface)
    motion = sa.Triangle(3e-9, -2e-9, 1e-6)
    result = sa.force_distance(blunt, motion, profiles=True, tolerance=0.1)
    view = choose_view(result, *choose_window(result), shape=2.2)
    assert view.stretch >= 5
    assert view.top - view.bottom < 0.2 * view.half_width
    (ax, *_) = sa.plot_profiles(result).axes
    assert ax.get_aspect() == view.stretch
    assert f"drawn ×{view.stretch}" in sa.plot_profiles(result).get_supylabel()


# Files


def test_a_gif_holds_its_frames_and_lasts_its_time(tap, tmp_path):
    sa.animate(tap, tmp_path / "tap.gif", frames=30, seconds=1.25)
    assert left_in(tmp_path) == ["tap.gif"]
    with Image.open(tmp_path / "tap.gif") as movie:
        assert movie.n_frames == 30
        assert movie.info["loop"] == 0
        durations, pictures = [], []
        for index in range(movie.n_frames):
            movie.seek(index)
            durations.append(movie.info["duration"])
            pictures.append(np.asarray(movie.convert("RGB"), int))
    assert sum(durations) == 1250
    assert all(np.any(one != next_one) for one, next_one in pairwise(pictures))
    for colour in ((0xB5, 0xD7, 0xEE), (0xB3, 0xB3, 0xB3), (0xD5, 0x5E, 0x00)):
        assert np.all(pictures[12] == colour, axis=2).any()


def test_a_gif_shows_the_tip_where_it_is(tap, tmp_path):
    """The middle column of the stage: grey from its top down to the apex, then gap and sample."""
    sa.animate(tap, tmp_path / "tap.gif", frames=2, start=1.55e-6, stop=2.3e-6)
    view = choose_view(tap, 1.55e-6, 2.3e-6, shape=0.895 * 8 / (0.6 * 5.5))
    with Image.open(tmp_path / "tap.gif") as movie:
        picture = np.asarray(movie.convert("RGB"), int)
    column = picture[:, round(800 * (0.09 + 0.895 / 2)) + 15]
    top, height = 550 * (1 - 0.38 - 0.6), 550 * 0.6
    grey = np.flatnonzero(np.all(column == (0xB3, 0xB3, 0xB3), axis=1))
    grey = grey[grey < top + height]
    scene = interpolate_scenes(tap, np.array([1.55e-6]))
    beside = 15 / (800 * 0.895) * 2 * view.half_width
    apex = np.interp(beside, scene.r, scene.tip[0])
    expected = top + height * (view.top - apex) / (view.top - view.bottom)
    assert grey[-1] == pytest.approx(expected, abs=4)


def test_a_page_stands_alone_and_holds_the_shapes(tap, tmp_path):
    path = tmp_path / "tap.html"
    sa.animate(tap, path, frames=40)
    page = path.read_text(encoding="utf-8")
    assert page.startswith("<!DOCTYPE html>")
    assert not re.search(r"https?://|\bsrc=|<link|@import|url\((?!#)", page)
    assert "default-src 'none'" in page
    assert len(page) < 200_000

    data = page_data(path)
    scenes = interpolate_scenes(tap, np.linspace(*choose_window(tap), 40))
    surface = np.array(data["surface"]) * data["quantum"]
    assert surface.shape == (40, len(data["r"]))
    shown = np.array([np.interp(data["r"], scenes.r * 1e9, row) for row in scenes.surface]) * 1e9
    assert surface == pytest.approx(shown, abs=2 * data["quantum"])
    tip = (np.array(data["apex"])[:, None] + np.array(data["tip"])) * data["quantum"]
    assert np.all(tip > surface)
    assert data["time"] == pytest.approx(scenes.time * 1e6, rel=1e-6)
    assert data["force"] == pytest.approx(scenes.force * 1e9, rel=1e-4)
    assert data["stretch"] == pytest.approx(1)
    assert data["titles"] == [
        *("Distance from the axis (nm)", "Height (nm)", "Time (µs)", "Force (nN)")
    ]
    assert data["moment"][0].endswith(" µs")
    assert data["strength"][20].endswith(" nN")


@posix
def test_an_mp4_is_piped_to_ffmpeg_frame_by_frame(tap, tmp_path, stand_in):
    stand_in(NOTING)
    sa.animate(tap, tmp_path / "tap.mp4", frames=5, seconds=2)
    assert left_in(tmp_path) == ["tap.mp4"]
    noted = json.loads((tmp_path / "tap.mp4").read_text())
    assert noted["sent"] == 5 * 1280 * 880 * 3
    assert "1280x880" in noted["arguments"]
    assert noted["arguments"][noted["arguments"].index("-framerate") + 1] == "2.5"


def test_the_real_ffmpeg_writes_a_movie(tap, tmp_path, monkeypatch):
    programs = tmp_path / "programs"
    programs.mkdir()
    (programs / "ffmpeg").symlink_to(imageio_ffmpeg.get_ffmpeg_exe())
    monkeypatch.setenv("PATH", str(programs))
    path = tmp_path / "tap.mp4"
    sa.animate(tap, path, frames=5, seconds=1)
    assert path.read_bytes()[4:8] == b"ftyp"
    check = ["ffmpeg", "-loglevel", "error", "-i", str(path), "-f", "null", "-"]
    assert subprocess.run(check, capture_output=True, check=True).stderr == b""


def test_without_ffmpeg_an_mp4_is_refused_with_a_remedy(tap, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(RuntimeError, match=r"install it .* or write \.html or \.gif") as caught:
        sa.animate(tap, tmp_path / "tap.mp4")
    assert "\n" not in str(caught.value)
    assert left_in(tmp_path) == []


@posix
@pytest.mark.parametrize("reads", ["", "sys.stdin.buffer.read(); "])
def test_what_ffmpeg_complains_of_is_passed_on(tap, tmp_path, stand_in, reads):
    stand_in(f"{reads}sys.exit('banner\\nUnknown encoder h264')")
    with pytest.raises(RuntimeError, match=r"ffmpeg could not write .*: Unknown encoder h264"):
        sa.animate(tap, tmp_path / "tap.mp4", frames=5)
    assert left_in(tmp_path) == []


@pytest.mark.usefixtures("any_ffmpeg")
@pytest.mark.parametrize("name", FORMATS)
def test_existing_files_are_kept_unless_told_otherwise(tap, tmp_path, name):
    path = tmp_path / name
    path.write_bytes(b"precious")
    with pytest.raises(FileExistsError, match=name):
        sa.animate(tap, path, frames=3)
    assert path.read_bytes() == b"precious"
    sa.animate(tap, path, frames=3, overwrite=True)
    assert path.read_bytes() != b"precious"
    assert left_in(tmp_path) == [name]


@pytest.mark.usefixtures("any_ffmpeg")
@pytest.mark.parametrize("name", FORMATS)
def test_an_interrupted_movie_leaves_nothing(tap, tmp_path, name):
    def interrupt(fraction, message):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sa.animate(tap, tmp_path / name, frames=3, progress=interrupt)
    assert left_in(tmp_path) == []
    (tmp_path / name).write_bytes(b"precious")
    with pytest.raises(KeyboardInterrupt):
        sa.animate(tap, tmp_path / name, frames=3, overwrite=True, progress=interrupt)
    assert (tmp_path / name).read_bytes() == b"precious"
    assert left_in(tmp_path) == [name]


def test_progress_is_reported_to_the_end(tap, tmp_path):
    fractions = []
    sa.animate(tap, tmp_path / "tap.gif", frames=4, progress=lambda part, _: fractions.append(part))
    assert fractions == [0.25, 0.5, 0.75, 1.0]


def test_a_movie_changes_no_setting(tap, tmp_path):
    before = {name: value for name, value in matplotlib.rcParams.items() if name != "backend"}
    sa.animate(tap, tmp_path / "tap.gif", frames=3)
    sa.plot_profiles(tap)
    after = {name: value for name, value in matplotlib.rcParams.items() if name != "backend"}
    assert before == after


@pytest.mark.parametrize(
    ("name", "options", "reason"),
    [
        ("tap.avi", {}, r"suffix '\.avi' is not known, must be \.mp4, \.gif or \.html"),
        ("tap", {}, "suffix '' is not known"),
        ("tap.gif", {"frames": 1}, "frames = 1: must be a whole number from 2 to 1000"),
        ("tap.gif", {"frames": 10.0}, "frames = 10.0: must be a whole number"),
        ("tap.gif", {"frames": 400}, r"frames = 400: a \.gif shows at most 50 a second, 300 in 6"),
        ("tap.html", {"seconds": 0}, "seconds = 0 s: must be greater than 0"),
        ("tap.html", {"start": 2e-6, "stop": 1e-6}, "start = 2 µs, stop = 1 µs: must be in order"),
        ("tap.html", {"start": 9.0}, "start = 9 s: .* overlap the run, from 0 s to 3.597 µs"),
        ("tap.html", {"stop": float("nan")}, "stop = nan s: must be a finite number"),
    ],
)
def test_bad_arguments_are_refused_in_one_line(tap, tmp_path, name, options, reason):
    with pytest.raises(ValueError, match=reason) as caught:
        sa.animate(tap, tmp_path / name, **options)
    assert "\n" not in str(caught.value)
    assert left_in(tmp_path) == []


@pytest.mark.parametrize("draw", [lambda run: sa.animate(run, "x.html"), sa.plot_profiles])
def test_a_result_without_shapes_is_refused(tap, tmp_path, monkeypatch, draw):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match="run it with --profiles") as caught:
        draw(tap.drop_vars(["deformation", "gap", "pressure"]))
    assert "\n" not in str(caught.value)
    assert left_in(tmp_path) == []


# Other solvers and modes


def test_shapes_of_the_papers_solver_and_of_a_bent_lever_are_shown(tmp_path):
    solver = sa.solvers.EnhancedAttard(8, 30, steps=300)
    fixed = sa.force_distance(
        LDPE, sa.Triangle(4e-9, 1e-9, 1e-3), solver=solver, profiles=True
    )  # fmt: skip
    lever = sa.Cantilever(stiffness=0.5, quality_factor=400, frequency=278e3)
    bent = sa.force_spectroscopy(
        SOFT, lever, sa.Triangle(10e-9, -3e-9, 1e-6), profiles=True, tolerance=0.05
    )
    assert bent["jump_time"].size
    for index, result in enumerate((fixed, bent)):
        path = tmp_path / f"{index}.html"
        sa.animate(result, path, frames=50)
        data = page_data(path)
        assert np.all(np.array(data["apex"])[:, None] + data["tip"] > np.array(data["surface"]))
        assert len(sa.plot_profiles(result).axes) == 12


def test_the_example_of_the_movies_page_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = Path(__file__).parents[1] / "docs" / "movies.md"
    (block,) = re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.S)
    exec(block, {})
    assert left_in(tmp_path) == ["tap.html", "tap.png"]


# Twelve instants


def test_six_instants_lead_to_the_lowest_height_and_six_away(tap):
    instants = choose_instants(tap, 12, *choose_window(tap))
    heights = np.interp(instants, tap["time"], tap["tip_height"])
    assert np.all(np.diff(instants) > 0)
    assert np.all(np.diff(heights[:6]) < 0)
    assert heights[5] == pytest.approx(float(tap["tip_height"].min()), abs=0.01e-9)
    assert np.all(np.diff(heights[5:]) > 0)


def test_the_instants_show_both_sides_of_a_snap(ramp):
    instants = choose_instants(ramp, 12, *choose_window(ramp))
    time = ramp["time"].values
    for jump in ramp["jump_time"].values:
        step = int(np.searchsorted(time, jump))
        assert time[step - 1] in instants
        assert time[step] in instants
    assert np.all(np.diff(instants) > 0)
    assert time[ramp["tip_height"].values.argmin()] == pytest.approx(instants[5])


def test_a_tip_that_only_comes_down_fills_all_pictures():
    down = made_up(np.linspace(0, -2e-9, 20), np.linspace(3e-9, -2e-9, 20))
    instants = choose_instants(down, 12, 0.0, 19.0)
    assert instants == pytest.approx(np.linspace(0, 19, 12))


def arrows(ax):
    """Directions of the arrows of a picture: 1 up, -1 down."""
    return [np.sign(note.xy[1] - note.xyann[1]) for note in ax.texts if hasattr(note, "xyann")]


def test_the_pictures_say_when_how_strong_and_where_the_tip_goes(tap):
    figure = sa.plot_profiles(tap)
    assert len(figure.axes) == 12
    assert [arrows(ax) for ax in figure.axes] == [[-1]] * 5 + [[]] + [[1]] * 6
    for letter, ax in zip("abcdefghijkl", figure.axes, strict=True):
        moment, force, *_ = (text.get_text() for text in ax.texts)
        assert re.fullmatch(rf"\({letter}\) \d\.\d\d+ µs", moment)
        assert re.fullmatch(r"−?\d\.\d\d nN", force)
        assert ax.get_aspect() == 1
    assert "(nm)" in figure.get_supxlabel()
    assert figure.get_supylabel() == "Height (nm)"


def test_the_surface_does_what_the_paper_describes(tap):
    """Section 5: it bulges to the coming tip, clings to the going one, and is wider in contact."""
    scenes = interpolate_scenes(tap, choose_instants(tap, 12, *choose_window(tap)))
    bulge = scenes.surface.max(axis=1)
    assert 0.05e-9 < bulge[1] < 0.6e-9
    assert bulge[6:10].max() > 1.5e-9
    assert 0 < bulge[-1] < 0.2e-9
    time, radius = tap["time"].values, tap["contact_radius"].values
    height = tap["tip_height"].values
    lowest = height.argmin()
    down = np.interp(1e-9, -height[:lowest], radius[:lowest])  # 1 nm below the flat surface
    up = np.interp(-1e-9, height[lowest:], radius[lowest:])
    assert up > 1.2 * down
    assert time[lowest] == pytest.approx(0.5 / 278e3, rel=1e-3)


@pytest.mark.parametrize("frames", [2, 5, 8, 26])
def test_the_number_of_pictures_can_be_chosen(tap, frames):
    assert len([ax for ax in sa.plot_profiles(tap, frames).axes if ax.patches]) == frames


@pytest.mark.parametrize("frames", [1, 27, 12.0, True])
def test_a_wrong_number_of_pictures_is_refused(tap, frames):
    with pytest.raises(ValueError, match=r"frames = .*: must be a whole number from 2 to 26"):
        sa.plot_profiles(tap, frames)


# Command line


@pytest.fixture
def folder(tmp_path, monkeypatch, tap):
    """The current directory, with a result that holds shapes and one that does not."""
    monkeypatch.chdir(tmp_path)
    sa.save(tap, "tap.nc")
    sa.save(tap.drop_vars(["deformation", "gap", "pressure"]), "curve.nc")
    return tmp_path


def test_the_bundled_example_makes_a_movie(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ldpe-movie.toml").write_text(read_example("ldpe-movie"), encoding="utf-8")
    assert main(["run", "ldpe-movie.toml"]) == 0
    movie = ["animate", "ldpe-movie.nc", "--frames", "20", "--out"]
    assert main([*movie, "tap.html", "--start", "1.5us"]) == 0
    assert main([*movie, "tap.gif", "--seconds", "1"]) == 0
    assert main(["plot", "ldpe-movie.nc", "--profiles"]) == 0
    assert page_data(tmp_path / "tap.html")["time"][0] == pytest.approx(1.5)
    with Image.open("tap.gif") as gif:
        assert gif.n_frames == 20
    assert (tmp_path / "ldpe-movie-profiles.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("animate", "curve.nc", "--out", "a.html"), "run it with --profiles"),
        (("plot", "curve.nc", "--profiles"), "run it with --profiles"),
        (("plot", "tap.nc", "tap.nc", "--profiles"), "2 results with --profiles: must be one"),
        (("animate", "tap.nc", "--out", "a.avi"), "must end in .mp4 or .gif or .html"),
        (("animate", "tap.nc", "--out", "tap.html"), "exists; choose another name or add --force"),
        (("animate", "tap.nc", "--out", "a.html", "--frames", "0"), "frames = 0: must be"),
        (("animate", "tap.nc", "--out", "a.html", "--start", "1 kg"), "--start = '1 kg': must be"),
        (("animate", "tap.nc", "--out", "a.html", "--start", "9 s"), "overlap the run"),
        (("animate", "none.nc", "--out", "a.html"), "none.nc: no such file"),
        (("animate", "tap.nc"), "--out"),
    ],
)
def test_bad_input_is_refused_on_the_command_line(folder, capsys, arguments, reason):
    (folder / "tap.html").write_text("precious")
    before = left_in(folder)
    assert main(list(arguments)) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert reason in said.err
    assert left_in(folder) == before
    assert (folder / "tap.html").read_text() == "precious"


def test_force_overwrites_a_movie(folder):
    (folder / "tap.html").write_text("precious")
    assert main(["animate", "tap.nc", "--out", "tap.html", "--force"]) == 0
    assert "precious" not in (folder / "tap.html").read_text(encoding="utf-8")


def test_a_missing_ffmpeg_is_a_failure_on_the_command_line(folder, capsys, monkeypatch):
    monkeypatch.setenv("PATH", str(folder))
    before = left_in(folder)
    assert main(["animate", "tap.nc", "--out", "tap.mp4"]) == 1
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "install it" in said
    assert left_in(folder) == before
