"""One user's list of runs, its limits, and how the page puts it in words."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from softafm.app.form import read_presets
from softafm.app.limits import Limits
from softafm.app.process import Process
from softafm.app.rows import describe_time, make_row
from softafm.app.runs import Runner
from softafm.app.session import Session
from softafm.app.tables import make_regime_table, write_lines, write_numbers
from softafm.app.take_away import write_netcdf
from softafm.app.worker import refuse_large
from softafm.draw.summary import list_observables
from softafm.experiment.config import build_experiment
from softafm.experiment.scales import Row

TAP = read_presets()["ldpe-tapping"]


@pytest.fixture(scope="module")
def tap():
    return build_experiment(TAP, Path()).run()


@pytest.fixture
def idle():
    """A runner without processes: whatever is submitted waits."""
    with Runner(processes=0, per_user=2) as waiting:
        yield waiting


@pytest.fixture
def session(idle, tmp_path):
    return Session(idle, tmp_path, Limits(listed=3, run_seconds=60, upload_bytes=1_000_000))


def uploaded(session, name, content):
    return session.add(name, session.read(name, content).result())


def test_runs_are_listed_named_and_coloured_and_can_be_removed(session):
    first = session.run(TAP, "tap", 1.0)
    second = session.run(TAP, "tap", None)
    assert [entry.label for entry in session.entries] == ["1 tap", "2 tap"]
    assert first.colour != second.colour
    assert first.document == TAP
    assert first.document is not TAP
    assert session.busy
    with pytest.raises(LookupError):
        _ = first.result
    session.rename(first.id, "  soft \n one " + "x" * 100)
    assert first.label.startswith("soft one x")
    assert len(first.label) == 60
    session.rename(first.id, " ")
    assert first.label.startswith("soft one x")
    session.cancel(second.id)
    assert (second.state, make_row(second)["words"]) == ("cancelled", "cancelled")
    session.remove(first.id)
    assert session.entries == [second]
    assert first.state == "cancelled"
    with pytest.raises(KeyError):
        session.show(first.id, False)
    third = session.run(TAP, "tap", 1.0)
    assert (third.label, third.colour) == ("3 tap", first.colour)
    session.close()
    assert (session.entries, third.state, session.busy) == ([], "cancelled", False)


def test_what_is_too_much_is_refused(session, idle, tmp_path, tap):
    with pytest.raises(ValueError, match="may take 61 s, more than the 60 s allowed"):
        session.run(TAP, "tap", 61.0)
    session.run(TAP, "tap", None)
    session.run(TAP, "tap", None)
    with pytest.raises(ValueError, match="2 of your runs are waiting already"):
        session.run(TAP, "tap", None)
    uploaded(session, "tap.nc", write_netcdf(tap))
    for more in (lambda: session.run(TAP, "tap", None), lambda: session.read("a.nc", b"")):
        with pytest.raises(ValueError, match="3 runs are listed, the most allowed"):
            more()
    other = Session(idle, tmp_path, Limits())
    assert make_row(other.run(TAP, "tap", None))["words"] == "waiting, number 2 in the queue"


def test_results_of_a_user_take_a_bounded_memory(idle, tmp_path, tap):
    content = write_netcdf(tap)
    small = Session(idle, tmp_path, Limits(kept_bytes=tap.nbytes + 1))
    uploaded(small, "tap.nc", content)
    uploaded(small, "tap.nc", content)
    with pytest.raises(ValueError, match="MB of memory: remove some first"):
        uploaded(small, "tap.nc", content)
    many = xr.Dataset({"force": ("time", np.zeros(3_000_000))}, attrs=tap.attrs)
    many["force"].encoding = {"zlib": True}
    path = tmp_path / "bomb.nc"
    many.to_netcdf(path, engine="h5netcdf")
    assert path.stat().st_size < 100_000
    with pytest.raises(ValueError, match=r"bomb.nc: has 24 MB unpacked: at most 5 MB"):
        uploaded(
            Session(idle, tmp_path, Limits(kept_bytes=5_000_000)), "bomb.nc", path.read_bytes()
        )


def test_a_result_that_is_too_large_is_not_sent(tap):
    assert refuse_large("result", tap, tap.nbytes) == ("result", tap)
    kind, words = refuse_large("result", tap, 1000)
    assert (kind, words[:14]) == ("problem", "its result has")
    assert refuse_large("problem", "odd", 0) == ("problem", "odd")


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="memory is bounded elsewhere")
def test_a_process_has_bounded_memory():
    process = Process(largest=1000)
    try:
        process.warm_up()
        limits = Path(f"/proc/{process.id}/limits").read_text().splitlines()
        (data,) = [line for line in limits if line.startswith("Max data size")]
        assert data.split()[3] == "2000004000"
    finally:
        process.close()


def test_an_upload_is_the_result_and_shows_what_is_doubtful(session, tap):
    doubtful = tap.assign_attrs(warnings="too <b>coarse</b>")
    entry = uploaded(session, "soft tap.nc", write_netcdf(doubtful))
    assert (entry.label, entry.state, entry.over) == ("1 soft tap", "done", True)
    assert entry.warnings == ("too <b>coarse</b>",)
    xr.testing.assert_identical(entry.result, doubtful)
    for name, content, words in (
        ("a.nc", b"odd", "a.nc: not a NetCDF file that softafm wrote"),
        ("a.nc", write_netcdf(tap)[:3000], "a.nc: not a readable NetCDF file"),
        ("a.nc", write_netcdf(tap.assign_attrs(format="x")), "a.nc: not a result of softafm"),
        ("a.nc", bytes(1_000_001), "the file has 1.0 MB: at most 1 MB"),
    ):
        with pytest.raises(ValueError, match=words.replace("(", r"\(")):
            uploaded(session, name, content)


def test_what_comes_from_users_is_escaped(tap):
    bad = "<img src=x onerror=alert(1)>"
    for text in (write_numbers(bad, list_observables(tap), [bad]), write_lines({bad: bad})):
        assert "<img" not in text
        assert "&lt;img" in text
    assert make_regime_table([Row("a", "b", "c")], {})["rows"] == [["a", "b", "c"]]
    refused = make_regime_table((), {"tip": bad})
    assert (refused["rows"], refused["bad"]) == ([("tip", bad)], True)


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.0187, "19 ms"), (1.4, "1 s"), (59, "59 s"), (150, "2 min"), (7200, "2.0 h")],
)
def test_times_are_said_as_people_say_them(seconds, words):
    assert describe_time(seconds) == words


@pytest.mark.parametrize(
    "wrong",
    [{"processes": 0}, {"listed": 0}, {"waiting": 0}, {"run_seconds": 0.0}, {"upload_bytes": 1},
     {"kept_bytes": 0}],
)  # fmt: skip
def test_limits_are_refused_out_of_range(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        Limits(**wrong)
