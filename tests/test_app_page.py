"""The page without a browser: what becomes of the messages that one sends."""

import base64
import time
from pathlib import Path

import pytest

pytest.importorskip("panel", reason="the page is not installed: pip install softafm[app]")

from softafm.app.form import read_presets
from softafm.app.limits import Limits
from softafm.app.page import Page
from softafm.app.runs import Runner
from softafm.app.take_away import write_netcdf, write_toml
from softafm.experiment.config import build_experiment

TAP = read_presets()["ldpe-tapping"]
CURVE = read_presets()["ps-approach-curve"]


@pytest.fixture(scope="module")
def tap():
    return build_experiment(TAP, Path()).run()


@pytest.fixture
def page():
    """A page whose runs wait for ever."""
    with Runner(processes=0, per_user=9) as idle:
        one = Page(idle, Limits(upload_bytes=2_000_000))
        yield one
        one.close()


def sent(name, content):
    return {"open": name, "content": base64.b64encode(content).decode()}


def open_file(page, name, content):
    """Send a file and wait until it was read."""
    page.answer(sent(name, content))
    while page._file is not None:
        time.sleep(0.02)
        page.answer({})


def words(page):
    return page._bar.state["words"], page._bar.state["bad"]


def test_shapes_are_kept_for_the_movie_without_a_change_of_the_form(page):
    page.answer({"run": True})
    page.answer({"movie": False})
    page.answer({"run": True})
    page.answer({"movie": True})
    page.form.document = CURVE
    assert not page._bar.state["can_film"]
    page.answer({"run": True})
    documents = [entry.document for entry in page.session.entries]
    assert documents == [{**TAP, "run": {"profiles": True}}, TAP, CURVE]
    assert page.form.document == CURVE
    labels = [row["label"] for row in page._list.state["runs"]]
    assert labels == ["1 ldpe-tapping", "2 ldpe-tapping", "3 ps-approach-curve"]


def test_what_cannot_run_is_not_run(page):
    page.form.edit("sample.E0", "2")
    assert not page._bar.state["can_run"]
    assert words(page) == ("1 value to correct before it can run", True)
    page.answer({"run": True})
    assert page.session.entries == []
    page.form.edit("sample.E0", "2 GPa")
    assert page._bar.state["can_run"]
    page.limits = page.session._limits = Limits(listed=1)
    page.answer({"run": True})
    page.answer({"run": True})
    assert words(page) == ("1 runs are listed, the most allowed: remove some first", True)


def test_files_are_opened(page, tap):
    open_file(page, "curve.toml", write_toml(CURVE).encode())
    assert page.form.document == CURVE
    open_file(page, "tap.NC", write_netcdf(tap))
    assert list(page.results) == ["1 tap"]
    assert page._tabs._names[1:] == ["Force–distance", "Time", "Numbers", "Take away"]
    page.answer({"end": page.session.entries[0].id})
    assert page._tabs._names == ["Regime"]


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("a.toml", b"mode = ", "a.toml"),
        ("a.toml", b"\xff", "a.toml: neither a result (.nc) nor text"),
        ("a.toml", b"#" * 2_000_001, "the file has 2.0 MB: at most 2 MB"),
        ("a.nc", b"odd", "a.nc: not a NetCDF file that softafm wrote"),
    ],
)
def test_files_that_are_no_good_are_refused(page, name, content, reason):
    open_file(page, name, content)
    said, bad = words(page)
    assert reason in said
    assert bad
    assert page.form.document == TAP
    assert page.session.entries == []
    page.form.edit("tip.radius", "11 nm")
    assert words(page)[1] is False


def test_a_result_that_cannot_be_drawn_is_refused(page, tap):
    open_file(page, "a.nc", write_netcdf(tap.drop_vars("tip_height")))
    assert words(page)[0].startswith("a.nc: variable 'tip_height' is missing")
    assert page.session.entries == []


@pytest.mark.parametrize(
    "message",
    [
        None, [], {}, "run", {"run": 1}, {"theme": "pink"}, {"show": "x", "shown": True},
        {"show": "x"}, {"rename": "x", "label": "y"}, {"select": "x"}, {"end": "../x"},
        {"open": "a.toml"}, {"open": "a.toml", "content": "?"}, {"open": 1, "content": ""},
        {"end": ["x"]},
    ],
)  # fmt: skip
def test_messages_that_make_no_sense_change_nothing(page, message):
    page.answer({"run": True})
    page.answer(message)
    assert page.form.document == TAP
    assert [entry.state for entry in page.session.entries] == ["waiting"]
    assert page.theme == "light"


def test_a_page_that_is_closed_leaves_nothing_behind(page, tap):
    folder = page.form.folder
    page.form.choose("tip", "measured")
    page.form.upload("tip.file", "tip.csv", b"radius (nm),height (nm)\n0,0\n1,1\n")
    assert [file.name for file in folder.iterdir()] == ["tip.csv"]
    page.form.document = TAP
    page.answer({"run": True})
    entry = page.session.entries[0]
    page.close()
    assert entry.state == "cancelled"
    assert not folder.exists()


def test_results_of_runs_are_drawn_in_the_theme_that_was_chosen():
    with Runner(processes=1) as runner:
        page = Page(runner)
        page.answer({"theme": "dark"})
        page.answer({"run": True})
        while page.session.busy:
            time.sleep(0.02)
        page.answer({})
        assert page._tabs._names[1] == "Force–distance"
        axis = next(m for m in page._tabs[1].object.references() if "LinearAxis" in str(type(m)))
        assert axis.axis_label_text_color == "#d9dce1"
        page.answer({"theme": "light"})
        assert axis.axis_label_text_color == "#33373d"
        row = page._list.state["runs"][0]
        assert row["words"].startswith("done in ")
        assert row["id"] == page._list.state["selected"]
        page.close()


class Looking:
    """The clock that lets the page look after its runs."""

    stopped = False

    def stop(self):
        self.stopped = True


def test_a_run_that_ends_while_the_page_is_brought_up_to_date_is_shown_at_the_next_look(
    page, monkeypatch
):
    page._looking = looking = Looking()
    page.answer({"run": True})
    (entry,) = page.session.entries

    def end_meanwhile():
        entry.job.cancel()

    monkeypatch.setattr(page, "_draw", end_meanwhile)
    page.answer({})
    assert entry.over
    assert page._list.state["runs"][0]["state"] == "waiting"
    assert not looking.stopped
    page.answer({})
    assert page._list.state["runs"][0]["state"] == "cancelled"
    assert looking.stopped
