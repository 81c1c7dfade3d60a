"""The movie in the browser: shapes as they were computed, and a player that plays them."""

import json
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("bokeh")

from bokeh.embed import file_html, json_item
from bokeh.models import ColumnDataSource, CustomJS, Slider
from bokeh.resources import INLINE

from softafm.app.colours import PALETTES, recolour
from softafm.app.movie import FRAMES, make_player
from softafm.app.movie_data import make_movie
from softafm.draw.scenes import choose_view, choose_window, interpolate_scenes
from softafm.experiment import config


@pytest.fixture(scope="module")
def tap():
    text = config.read_example("ldpe-movie")
    return config.build_experiment(config.parse_document(text, ""), Path()).run()


@pytest.fixture
def player(tap):
    return make_player(tap, "light")


def arguments(layout):
    scripts = [m.args for m in layout.references() if isinstance(m, CustomJS)]
    return next(args for args in scripts if "seconds" in args)


def test_a_result_without_shapes_has_no_movie(tap):
    assert make_player(tap.drop_vars(["deformation", "gap", "pressure"]), "light") is None


def test_outlines_are_the_shapes_to_a_fraction_of_a_pixel(tap):
    shown = make_movie(tap, 40)
    start, stop = choose_window(tap)
    scenes, view = (
        interpolate_scenes(tap, np.linspace(start, stop, 40)),
        choose_view(tap, start, stop, 2.4),
    )
    inside = np.abs(shown.x[:-2]) <= 1e9 * view.half_width
    for index in (0, 17, 39):
        for whole, half, edge in (
            (shown.outline(shown.surface[index], -1.0), scenes.surface[index], -1.0),
            (shown.outline(shown.rise + shown.apex[index], 2.0), scenes.tip[index], 2.0),
        ):
            expected = 1e9 * np.interp(np.abs(shown.x[:-2]) / 1e9, scenes.r, half)
            quantum = 1e9 * (view.top - view.bottom) * 2e-4
            seen = inside & (expected < 1e9 * view.top)
            np.testing.assert_allclose(whole[:-2][seen], expected[seen], atol=1.01 * quantum)
            assert np.all(whole[-2:] == edge)
    assert np.array_equal(shown.x[:-2], -shown.x[:-2][::-1])


def test_outlines_close_beyond_the_view(tap):
    shown = make_movie(tap, 5)
    height = shown.view["top"] - shown.view["bottom"]
    assert shown.ends[0] < shown.view["bottom"] - height
    assert shown.ends[1] > shown.view["top"] + height
    assert shown.x.max() > shown.view["half_width"]


def test_the_marker_is_on_the_force_curve(tap):
    shown = make_movie(tap, 300)
    height, force = (
        np.interp(shown.frames["time"], shown.curve["time"], shown.curve[name])
        for name in ("height", "force")
    )
    still = np.ones(300, bool)
    for jump in 1e6 * tap.jump_time.values:
        still &= np.abs(shown.frames["time"] - jump) > 0.02
    np.testing.assert_allclose(shown.frames["height"][still], height[still], atol=1e-9)
    np.testing.assert_allclose(shown.frames["force"][still], force[still], atol=1e-9)
    assert shown.labels == {
        "time": "Time (µs)", "height": "Tip height (nm)", "force": "Force on the tip (nN)"
    }  # fmt: skip


def test_all_frames_are_sent_at_once_and_are_few_bytes(player):
    assert len(json.dumps(json_item(player))) < 500_000
    assert arguments(player)["surface"].data["surface"].size % FRAMES == 0


def test_what_moves_is_not_told_to_the_server(player):
    args = arguments(player)
    for name in ("tip", "sample", "past", "now", "reading", "slider"):
        assert args[name].syncable is False


def test_the_slider_reads_as_time(player, tap):
    (slider,) = player.select({"type": Slider})
    moments = slider.format.args["moments"]
    assert len(moments) == slider.end + 1 == FRAMES
    assert float(moments[0].split()[0]) == pytest.approx(1e6 * choose_window(tap)[0], abs=1e-3)
    assert moments[0].endswith(" µs")


def test_colours_follow_the_theme(player):
    recolour(player, "dark")
    text = str([m.properties_with_values() for m in player.references()
                if not isinstance(m, ColumnDataSource)])  # fmt: skip
    assert PALETTES["dark"].sample_body in text
    assert PALETTES["light"].sample_body not in text


@pytest.fixture
def page(player, tmp_path, browser):
    """The player in a browser, as a page that needs nothing else."""
    player.sizing_mode, player.height = "stretch_width", 600
    file = tmp_path / "movie.html"
    file.write_text(file_html(player, INLINE, "movie"), encoding="utf-8")
    opened = browser.new_page(viewport={"width": 900, "height": 650})
    opened.complaints = []
    opened.on("pageerror", lambda error: opened.complaints.append(str(error)))
    # Bokeh names in its file what any imported extension brings to a server, as Panel does.
    opened.on("console", lambda said: said.type in ("error", "warning")
              and "ERR_FILE_NOT_FOUND" not in said.text
              and opened.complaints.append(said.text))  # fmt: skip
    opened.goto(file.as_uri())
    opened.get_by_role("button", name="▶").wait_for()
    yield opened
    opened.close()


def columns(page, name, args):
    return page.evaluate(
        """id => Object.fromEntries(Object.entries(Bokeh.documents[0].get_model_by_id(id).data)
                 .map(([key, values]) => [key, Array.from(values)]))""",
        args[name].id,
    )


def test_the_movie_plays_pauses_and_can_be_moved(page, player, tap):
    args = arguments(player)
    page.get_by_role("button", name="▶").click()
    page.wait_for_function("window.softafm_movie_frames >= 40")
    page.keyboard.press("Space")  # the button still has the focus
    page.get_by_role("button", name="▶").wait_for()
    stopped = page.evaluate("window.softafm_movie_frames")
    assert columns(page, "now", args)["time"][0] > args["frames"].data["time"][10]

    page.locator(".noUi-handle").focus()
    page.keyboard.press("End")
    page.wait_for_function(f"window.softafm_movie_frames > {stopped}")
    shown = make_movie(tap, FRAMES)
    now, past = columns(page, "now", args), columns(page, "past", args)
    for name, values in shown.frames.items():
        assert now[name] == [pytest.approx(values[-1], rel=1e-9)]
        assert past[name][-1] == now[name][0]
    sample, tip = columns(page, "sample", args), columns(page, "tip", args)
    outline = shown.outline(shown.surface[-1], shown.ends[0])
    np.testing.assert_allclose(sample["y"], outline, atol=1e-9)
    outline = shown.outline(shown.rise + shown.apex[-1].astype(int), shown.ends[1])
    np.testing.assert_allclose(tip["y"], outline, atol=1e-9)
    assert page.complaints == []


def test_the_stage_has_true_proportions_at_any_size(page, player):
    stage = arguments(player)["stage"]
    for width in (900, 1300):
        page.set_viewport_size({"width": width, "height": 650})
        page.wait_for_timeout(500)
        across, along = page.evaluate(
            """id => { const { inner_width, inner_height, x_range, y_range } =
                         Bokeh.documents[0].get_model_by_id(id);
                       return [(x_range.end - x_range.start) / inner_width,
                               (y_range.end - y_range.start) / inner_height]; }""",
            stage.id,
        )
        assert across == pytest.approx(along, rel=1e-6)
