"""Uploaded files are read apart: whoever waits for one waits alone."""

import asyncio
import base64
import queue
import threading
import time
from pathlib import Path
from urllib.request import urlopen

import numpy as np
import pytest

pytest.importorskip("panel", reason="the page is not installed: pip install softafm[app]")

import panel as pn

from softafm.app import readings
from softafm.app.form import read_presets
from softafm.app.limits import Limits
from softafm.app.page import Page
from softafm.app.readings import MeasuredFiles, Reading, try_out
from softafm.app.runs import Runner
from softafm.app.take_away import write_netcdf, write_toml
from softafm.experiment.config import build_experiment
from softafm.files.guard import Unreadable, read_apart
from softafm.files.measured import read_trajectory
from softafm.tips import read_tip_profile

TAP = read_presets()["ldpe-tapping"]
TIP = "radius (nm),height (nm)\n" + "".join(f"{r},{r * r / 20}\n" for r in range(30))


@pytest.fixture
def page():
    with Runner(processes=0) as idle:
        one = Page(idle, Limits(upload_bytes=2_000_000))
        yield one
        one.close()


@pytest.fixture
def stuck(monkeypatch):
    """Readers that take 3 s, whatever they are asked to read."""
    read = read_apart

    def sleeping(*_, **__):
        return read("stand_ins:sleeps", 3)

    for place in ("softafm.app.readings.read_apart", "softafm.files.guard.read_apart"):
        monkeypatch.setattr(place, sleeping)


def sent(name, content):
    return {"open": name, "content": base64.b64encode(content).decode()}


def until(what):
    for _ in range(1000):
        if what():
            return
        time.sleep(0.02)
    raise AssertionError("waited in vain")


def words(page):
    return page._bar.state["words"], page._bar.state["bad"]


# Whoever waits, waits alone


def test_other_visitors_are_served_while_a_file_is_read(stuck):
    """One visitor's files of all kinds are stuck; the others' pages come as ever."""
    pages = []

    def visited():
        pages.append(Page(runner, Limits()))
        return pages[-1]

    with Runner(processes=0) as runner:
        servers = queue.SimpleQueue()

        def serve():
            asyncio.set_event_loop(asyncio.new_event_loop())  # that of this thread may be in use
            made = pn.serve(
                visited, port=0, address="127.0.0.1", show=False, start=False, verbose=False
            )
            made.start()
            servers.put(made)
            made.io_loop.start()

        loop = threading.Thread(target=serve)
        loop.start()
        server = servers.get(timeout=60)
        address = f"http://127.0.0.1:{server.port}/"
        try:
            assert urlopen(address, timeout=60).status == 200
            (stuck_one,) = pages
            done = threading.Event()

            def upload():
                stuck_one.form.choose("tip", "measured")
                stuck_one.form.upload("tip.file", "tip.csv", TIP.encode())
                stuck_one.answer(sent("other.toml", write_toml(TAP).encode()))
                done.set()

            started = time.monotonic()
            server.io_loop.add_callback(upload)
            assert done.wait(timeout=2.5)
            assert stuck_one.form.reading
            assert words(stuck_one) == ("reading other.toml ...", False)
            assert urlopen(address, timeout=2.5).status == 200
            assert time.monotonic() - started < 3
            assert len(pages) == 2
            assert pages[1].form.problems == {}
        finally:
            server.io_loop.add_callback(server.io_loop.stop)
            loop.join()
            server.stop()
            for one in pages:
                one.close()


def test_a_page_goes_on_while_its_file_is_read(page, stuck):
    page.answer(sent("a.nc", b"\x89HDF\r\n\x1a\n"))
    assert words(page) == ("reading a.nc ...", False)
    page.answer(sent("b.nc", b"\x89HDF\r\n\x1a\n"))
    assert words(page) == ("b.nc: another file is being read; open it again in a moment", True)
    page.form.edit("tip.radius", "11 nm")
    assert page.form.document["tip"]["radius"] == "11 nm"
    page.answer({"run": True})
    assert [entry.state for entry in page.session.entries] == ["waiting"]


def test_a_reading_that_fails_is_told_on_the_page(page, monkeypatch):
    read = read_apart
    monkeypatch.setattr(
        "softafm.files.guard.read_apart", lambda *_, **__: read("stand_ins:spins", 0, seconds=0.3)
    )
    monkeypatch.setattr(readings, "read_apart", lambda *_, **__: read("stand_ins:is_killed", 9))
    for name, content, reason in (
        ("a.nc", b"\x89HDF\r\n\x1a\n", "a.nc: could not be read within 0.3 s; is it damaged?"),
        ("a.toml", b"mode = 1", "a.toml: could not be read (its process was ended by SIGKILL); is"),
    ):
        page.answer(sent(name, content))
        until(lambda: page._file[1].over)
        page.answer({})
        assert words(page)[0].startswith(reason)
        assert words(page)[1]
        assert page.session.entries == []
        assert page.form.document == TAP


def test_an_experiment_from_a_file_fills_the_form(page):
    document = {**TAP, "motion": {**TAP["motion"], "cycles": 3}}
    page.answer(sent("tap.toml", write_toml(document).encode()))
    until(lambda: page._file[1].over)
    page.answer({})
    assert page.form.document == document
    assert page._file is None


def test_a_file_that_goes_on_and_on_holds_up_nobody_who_types(page):
    """Deep and long documents are refused before the form sees them."""
    for text in ("a." * 400_000 + "b = 1", "x = " + "[" * 900_000, "k = 1\n" * 3000):
        page.answer(sent("a.toml", text.encode()))
        until(lambda: page._file[1].over)
        page.answer({})
        assert words(page)[0].startswith("a.toml: ")
        assert words(page)[1]
        assert page.form.document == TAP


# Measured files


def test_a_measured_file_is_read_once_apart_and_then_here(page, monkeypatch):
    asked = []
    read = read_apart

    def noted(*arguments, **options):
        asked.append(arguments)
        return read(*arguments, **options)

    monkeypatch.setattr(readings, "read_apart", noted)
    page.form.choose("tip", "measured")
    page.form.upload("tip.file", "tip.csv", TIP.encode())
    assert page.form.problems == {"tip.file": "is being read ..."}
    assert not page._bar.state["can_run"]
    until(lambda: (page.answer({}), not page.form.reading)[1])
    assert page.form.problems == {}
    assert page._bar.state["can_run"]
    for height in ("47 nm", "48 nm"):
        page.form.edit("motion.mean_height", height)
        assert page.form.problems == {}
    path = page.form.folder / "tip.csv"
    reader = "softafm.tips.reading:read_tip_profile"
    assert asked == [("softafm.app.readings:try_out", reader, str(path))]
    with page.form.files_as_read():
        experiment = build_experiment(page.form.document, page.form.folder)
    assert experiment.contact.tip == read_tip_profile(path)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"radius (nm),height (nm)\n0,0\n1,x\n", "line 3"),
        (b"\x00\xff\xfe", "is not text in UTF-8"),
        (b"", "is empty"),
        (b"," * 400_000, "has no column 'radius'"),
    ],
)
def test_a_measured_file_that_is_no_good_is_told_at_its_field(page, content, reason):
    page.form.choose("tip", "measured")
    page.form.upload("tip.file", "odd.csv", content)
    until(lambda: (page.answer({}), not page.form.reading)[1])
    assert reason in page.form.problems["tip.file"]


def test_a_file_that_takes_too_long_to_use_is_refused(tmp_path, monkeypatch):
    path = tmp_path / "long.csv"
    path.write_text(TIP)
    monkeypatch.setattr(readings, "_MOST_WORK", 0.0)
    with pytest.raises(ValueError, match=r"takes .* s to read: at most 0 s; leave out points"):
        try_out("softafm.tips.reading:read_tip_profile", str(path))


def test_few_files_of_one_user_are_read_at_a_time(tmp_path, stuck):
    files = MeasuredFiles()
    for number in range(6):
        (tmp_path / f"{number}.csv").write_text(TIP)
    said = []
    for number in range(6):
        with pytest.raises(ValueError, match="read") as caught:
            files.read(read_tip_profile, tmp_path / f"{number}.csv")
        said.append(str(caught.value))
    assert said == ["is being read ..."] * 4 + ["waits until other files are read"] * 2
    with pytest.raises(ValueError, match="no such file"):
        files.read(read_trajectory, tmp_path / "none.csv")
    assert files.busy


def test_a_reading_tells_what_it_found_or_why_not():
    assert Reading(lambda: 5).result() == 5

    def refuse():
        raise Unreadable("odd")

    def fail():
        raise KeyError("odd")

    with pytest.raises(ValueError, match=r"^odd$"):
        Reading(refuse).result()
    with pytest.raises(ValueError, match=r"^cannot be read \(KeyError\('odd'\)\)$"):
        Reading(fail).result()


def test_moduli_of_a_long_record_are_tried_as_the_form_uses_them(tmp_path):
    """With the fit that every answer in the form repeats."""
    frequency = np.geomspace(1e-3, 1e6, 2000)
    # A spring beside a springpot: (iω)^a = ω^a (cos πa/2 + i sin πa/2).
    springpot = 1e6 * (2j * np.pi * frequency) ** 0.1
    storage, loss = 1e6 + springpot.real, springpot.imag
    rows = np.column_stack([frequency, storage, loss])
    path = tmp_path / "dma.csv"
    header = "frequency (Hz),storage (Pa),loss (Pa)"
    np.savetxt(path, rows, delimiter=",", header=header, comments="")
    reader = "softafm.rheology.dma_table:read_moduli"
    assert read_apart("softafm.app.readings:try_out", reader, str(path)) == (None, [])


def test_an_uploaded_result_is_drawn_and_comes_back_whole(page):
    tap = build_experiment(TAP, Path()).run()
    page.answer(sent("tap.nc", write_netcdf(tap)))
    until(lambda: page._file[1].over)
    page.answer({})
    (found,) = page.results.values()
    assert found.identical(tap)
    assert page._selected == page.session.entries[0].id
