"""The page in a browser, from a click to numbers, movie and files: as what Python gives."""

import io
import time
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import xarray as xr
from PIL import Image

import softafm as sa
from softafm.app.documents import replace_value
from softafm.app.form import read_presets
from softafm.app.links import read_query
from softafm.app.movie import FRAMES, make_movie
from softafm.draw.summary import list_observables
from softafm.experiment import config

TAP = read_presets()["ldpe-tapping"]

DATA = """() => Object.fromEntries(
  [...Bokeh.index.all_views()].map(view => view.model)
    .filter(model => model.type === "GlyphRenderer" && model.name)
    .map(({ name, data_source }) => [name, Object.fromEntries(
      Object.entries(data_source.data).map(([key, values]) => [key, Array.from(values)]))]))"""

DRAWN = """name => [...Bokeh.index.all_views()].map(view => view.model)
  .some(model => model.type === "GlyphRenderer" && model.name === name)"""

MARKER = """() => [...Bokeh.index.all_views()].map(view => view.model)
  .filter(model => model.type === "GlyphRenderer" && model.glyph.type === "Scatter")
  .map(model => model.data_source.data).filter(data => data.height?.length === 1)
  .map(({ time, height, force }) => ({ time: time[0], height: height[0], force: force[0] }))[0]"""


def python(document):
    return config.build_experiment(document, Path()).run()


@pytest.fixture(scope="module")
def tap():
    return python(replace_value(TAP, "run.profiles", True))


@pytest.fixture(scope="module")
def site(serve):
    return serve()


def ran(page, count=1):
    """Click, and wait until so many runs are done."""
    page.locator("button.run").click()
    page.locator(".run-done").nth(count - 1).wait_for()


def tab(page, title):
    page.locator(".bk-tab", has_text=title).click()


def assert_holds(field, value):
    from playwright.sync_api import expect

    expect(field).to_have_value(value)


def data(page, *names):
    page.wait_for_function(f"names => names.every({DRAWN})", arg=list(names), polling=50)
    return page.evaluate(DATA)


def assert_curves_are_of(page, label, result):
    found = data(page, f"{label}, approach", f"{label}, retract")
    strokes = [found[f"{label}, {stroke}"] for stroke in ("approach", "retract")]
    for name, factor in (("tip_height", 1e9), ("force", 1e9), ("time", 1e6)):
        drawn = np.concatenate([strokes[0][name], strokes[1][name][1:]])
        np.testing.assert_allclose(drawn, factor * result[name], rtol=1e-12)


def test_a_preset_is_run_at_once_and_gives_what_python_gives(site, visit, tap, record_property):
    page = visit(site.address)
    record_property("usable page", f"{time.monotonic() - site.started:.1f} s after the start")
    run = page.locator("button.run").bounding_box()
    assert run["y"] + run["height"] < 768
    assert page.evaluate("document.documentElement.scrollHeight") == 768
    began = time.monotonic()
    ran(page)
    data(page, "1 ldpe-tapping, approach")
    record_property("LDPE tap shown", f"{time.monotonic() - began:.2f} s after the click")
    assert_curves_are_of(page, "1 ldpe-tapping", tap)
    tab(page, "Numbers")
    page.get_by_text("1 ldpe-tapping", exact=True).wait_for()
    cells = [str(cell) for column in list_observables(tap).columns for cell in column.cells]
    shown = page.locator("td").all_inner_texts()
    assert len(cells) > 20
    assert sorted(shown) == sorted(cells)


def test_a_changed_value_changes_the_curves_the_address_and_not_the_others(site, visit, tap):
    page = visit(site.address)
    page.locator(".field-sample-E_inf input").fill("0.2 GPa")
    page.wait_for_url("**E_inf=0.2+GPa**")
    ran(page)
    changed = replace_value(TAP, "sample.E_inf", "0.2 GPa")
    assert read_query(page.url.partition("?")[2]) == changed
    result = python(changed)
    assert_curves_are_of(page, "1 tapping-cycle", result)

    page.locator(".choice-preset").select_option("ldpe-tapping")
    page.wait_for_url("**E_inf=0.1+GPa**")
    ran(page, 2)
    assert_curves_are_of(page, "2 ldpe-tapping", tap)
    assert_curves_are_of(page, "1 tapping-cycle", result)
    first = page.locator("ul.runs li").first
    first.locator(".label").fill("<img src=x onerror=alert(1)> stiff")
    page.keyboard.press("Tab")
    renamed = "<img src=x onerror=alert(1)> stiff"
    assert_curves_are_of(page, renamed, result)
    tab(page, "Numbers")
    page.get_by_text(renamed, exact=True).wait_for()
    assert page.locator("img[src='x']").count() == 0
    tab(page, "Force–distance")
    first.locator(".shown").uncheck()
    page.wait_for_function(f"name => !({DRAWN})(name)", arg=f"{renamed}, approach", polling=50)
    assert_curves_are_of(page, "2 ldpe-tapping", tap)
    first.get_by_role("button", name="remove").click()
    page.locator("ul.runs li").nth(1).wait_for(state="detached")
    assert_holds(page.locator("ul.runs .label"), "2 ldpe-tapping")


def test_the_movie_plays_and_its_marker_follows_the_slider(site, visit, tap, record_property):
    page = visit(site.address)
    ran(page)
    tab(page, "Surface")
    page.get_by_role("button", name="▶").click()
    page.wait_for_function("window.softafm_movie_frames >= 5")
    frames, began = page.evaluate("[window.softafm_movie_frames, performance.now()]")
    page.wait_for_function(f"window.softafm_movie_frames >= {frames + 60}")
    frames, now = page.evaluate(f"[window.softafm_movie_frames - {frames}, performance.now()]")
    record_property("movie", f"{1000 * frames / (now - began):.0f} frames/s of {FRAMES / 6:.0f}")
    page.get_by_role("button", name="❚❚").click()
    page.get_by_role("button", name="▶").wait_for()
    shown = make_movie(tap, FRAMES).frames
    for key, index in (("End", FRAMES - 1), ("Home", 0), ("ArrowRight", 1)):
        page.locator(".noUi-handle").press(key)
        page.wait_for_function(
            f"time => Math.abs(({MARKER})().time - time) < 1e-9", arg=float(shown["time"][index])
        )
        marker = page.evaluate(MARKER)
        assert marker == pytest.approx({name: shown[name][index] for name in marker}, rel=1e-9)


def test_files_taken_away_hold_the_run_and_come_back(site, visit, tap, tmp_path):
    page = visit(site.address)
    ran(page)
    tab(page, "Take away")

    def taken(kind):
        with page.expect_download() as download:
            page.locator(f".download-{kind} .bk-btn").click()
        file = tmp_path / download.value.suggested_filename
        download.value.save_as(file)
        return file

    netcdf = taken("nc")
    loaded = sa.load(netcdf)
    xr.testing.assert_equal(loaded, tap)
    assert loaded.attrs["experiment"] == tap.attrs["experiment"]
    rows = [line for line in taken("csv").read_text().splitlines() if not line.startswith("#")]
    names, *numbers = [row.split(",") for row in rows]
    force = np.array(numbers, float)[:, names.index("force (N)")]
    np.testing.assert_allclose(force, tap.force, rtol=1e-6)
    with Image.open(io.BytesIO(taken("png").read_bytes())) as picture:
        assert min(picture.size) > 300
    assert ElementTree.parse(taken("svg")).getroot().tag.endswith("svg")
    toml = taken("toml")
    filmed = replace_value(TAP, "run.profiles", True)
    assert tomllib.loads(toml.read_text(encoding="utf-8")) == filmed

    page = visit(site.address)
    page.locator(".choice-preset").select_option("ps-approach-curve")
    page.wait_for_url("**mode=approach-curve**")
    page.locator("input.open").set_input_files(netcdf)
    page.locator("ul.runs li", has_text="uploaded").wait_for()
    assert_curves_are_of(page, "1 result", tap)
    page.locator("input.open").set_input_files(toml)
    page.wait_for_url("**mode=tapping-cycle**run.profiles=true**")
    assert_holds(page.locator(".field-sample-E_inf input"), "0.1 GPa")


def test_a_link_opens_the_same_form_for_someone_else(site, visit):
    page = visit(site.address)
    page.locator(".choice-preset").select_option("pdms-sphere")
    page.locator(".field-tip-radius input").fill("7 um")
    page.wait_for_url("**tip.radius=7+um**")
    ran(page)
    tab(page, "Take away")
    link = page.locator("pre", has_text="http").text_content()
    lines = page.locator("pre", has_text="import softafm").text_content()
    found = {}
    exec(lines, found)
    filmed = replace_value(read_presets()["pdms-sphere"], "tip.radius", "7 um") | {
        "run": {"profiles": True}
    }
    xr.testing.assert_equal(found["result"], python(filmed))
    for address in (page.url, link):
        other = visit(address)
        assert_holds(other.locator(".field-tip-radius input"), "7 um")
        assert other.locator(".field-cantilever-stiffness input").input_value() != ""
        assert other.locator("ul.runs li").count() == 0
    assert read_query(other.url.partition("?")[2]) == filmed


@pytest.mark.parametrize(
    ("query", "words"),
    [
        ("mode=tapping-cycle&mode=b", "the link has mode more than once"),
        ("nonsense", "the link cannot be read"),
        ("tip.shape=<img src=x onerror=alert(1)>&odd.key=1", "to correct before it can run"),
    ],
)
def test_a_link_that_makes_no_sense_is_told_and_does_no_harm(site, visit, query, words):
    page = visit(f"{site.address}?{query}")
    page.locator(".words", has_text=words).wait_for()
    assert page.locator("img").count() == 0
    page.locator(".choice-preset").select_option("ldpe-tapping")
    page.locator("button.run:enabled").wait_for()
