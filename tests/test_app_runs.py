"""Runs in processes of their own: what comes back, what a crash or a cancel leaves behind."""

import io
import os
import pickle
import signal
import sys
import time
from pathlib import Path

import pytest
import xarray as xr

from softafm.app.process import Process
from softafm.app.runs import Runner
from softafm.app.worker import Outlet, answer
from softafm.checks.refusals import ConfigError
from softafm.experiment import config

PATIENCE = 120  # s: for a machine that compiles first, or is busy


def example(name, **tables):
    return config.parse_document(config.read_example(name), name) | tables


SHORT = example("ldpe-tapping")
LONG = example("ps-approach-curve", run={"tolerance": 1e-5})
LONG["motion"] = LONG["motion"] | {"points": 1000}


@pytest.fixture(scope="module")
def runner():
    with Runner(processes=1, per_user=2) as running:
        yield running


@pytest.fixture
def idle():
    """A runner without processes: whatever is submitted waits."""
    with Runner(processes=0, per_user=3) as waiting:
        yield waiting


def until(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def begun(runner):
    """A long run under way, and its process."""
    job = runner.submit(LONG, Path(), "someone")
    until(lambda: job.fraction > 0 or job.problem)
    assert job.state == "running"
    return job, runner._running[job]


def finished(runner, document=SHORT, folder=None):
    job = runner.submit(document, folder or Path(), "someone")
    assert job.wait(PATIENCE)
    return job


def test_a_run_gives_what_python_gives(runner):
    job = finished(runner)
    assert (job.state, job.problem, job.warnings) == ("done", None, ())
    assert (job.fraction, job.place) == (1.0, 0)
    expected = config.build_experiment(SHORT, Path()).run()
    xr.testing.assert_equal(job.result, expected)
    assert job.result.attrs["experiment"] == expected.attrs["experiment"]


def test_files_are_sought_in_the_folder_of_the_user(runner, tmp_path):
    (tmp_path / "way.csv").write_text("time (us),height (nm)\n0,5\n1,2\n2,5\n")
    motion = {"shape": "trajectory", "file": "way.csv"}
    document = example("attard-triangle", motion=motion)
    assert finished(runner, document, tmp_path).state == "done"
    assert "no such file" in finished(runner, document).problem


@pytest.mark.parametrize("name", ["../way.csv", "/etc/passwd", "..", "a\\b.csv", "c:a.csv", "\0"])
def test_only_plain_names_of_files_are_taken(idle, name):
    parts = [{"law": "tabulated", "file": name}]
    document = example("ldpe-tapping", surface={"law": "sum", "parts": parts})
    with pytest.raises(ConfigError, match=r"surface\.parts\[0\]\.file = .*plain name"):
        idle.submit(document, Path(), "someone")


def test_a_run_tells_how_far_it_is_and_can_be_cancelled(runner):
    job, process = begun(runner)
    assert 0 < job.fraction < 1
    assert "taps" in job.message
    assert job.elapsed > 0
    until(lambda: job.remaining is not None)
    job.cancel()
    assert job.state == "cancelled"
    assert job.wait(0)
    until(lambda: process._process.poll() is not None)
    elapsed = job.elapsed
    job.cancel()
    assert (job.state, job.elapsed, job.remaining) == ("cancelled", elapsed, None)
    assert finished(runner).state == "done"


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_a_killed_process_fails_its_run_alone(runner):
    job, process = begun(runner)
    os.kill(process.id, signal.SIGKILL)
    assert job.wait(PATIENCE)
    assert job.state == "failed"
    assert "ended by SIGKILL" in job.problem
    assert len(job.problem.splitlines()) == 1
    assert finished(runner).state == "done"


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_a_process_killed_between_runs_is_replaced(runner):
    finished(runner)
    (process,) = runner._alive
    os.kill(process.id, signal.SIGKILL)
    until(lambda: not process.alive)
    until(lambda: runner.ready)
    assert finished(runner).state == "done"


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_control_c_is_not_for_the_processes(runner):
    job, process = begun(runner)
    os.kill(process.id, signal.SIGINT)
    before = job.fraction
    until(lambda: job.fraction > before or job.state != "running")
    assert job.state == "running"
    job.cancel()


def test_a_run_is_ended_at_its_time_limit():
    with Runner(time_limit=0.2) as hasty:
        job = hasty.submit(LONG, Path(), "someone")
        assert job.wait(PATIENCE)
        assert job.state == "failed"
        assert "longer than a run may take here, 0.2 s" in job.problem
        assert job.result is None


def test_a_bad_document_fails_in_one_line(runner):
    document = example("ldpe-tapping", tip={"shape": "paraboloid", "radius": "10 Nm"})
    document["motion"] = {**document["motion"], "frequency": 5}
    job = finished(runner, document)
    assert job.state == "failed"
    assert "tip.radius = '10 Nm'" in job.problem
    assert "; motion.frequency = 5" in job.problem
    assert len(job.problem.splitlines()) == 1


def test_a_run_that_diverges_says_why(runner):
    solver = {"name": "attard", "steps": 1000, "method": "explicit"}
    job = finished(runner, example("attard-triangle", solver=solver, run={}))
    assert job.state == "failed"
    assert "blew up" in job.problem


def test_what_nobody_expected_is_a_failure_with_its_name(capsys):
    kind, text = answer(None, "", Outlet(io.BytesIO()))
    assert kind == "problem"
    assert text.partition(": ")[0] in ("AttributeError", "TypeError")
    assert "Traceback" in capsys.readouterr().err


def test_warnings_come_with_the_result(runner):
    sample = {
        "model": "power-law",
        "E1": "1 GPa",
        "reference_time": "1 us",
        "exponent": 0.2,
        "poisson": 0.4,
        "window": ["1 ns", "1 us"],
    }
    job = finished(runner, example("ldpe-tapping", sample=sample))
    assert job.state == "done"
    assert ["enlarge the window" in text for text in job.warnings] == [True]


def test_the_queue_goes_round_the_users(idle):
    first, second, third = (idle.submit(SHORT, Path(), "one") for _ in range(3))
    other = idle.submit(SHORT, Path(), "other")
    assert [job.place for job in (first, other, second, third)] == [1, 2, 3, 4]
    assert {job.state for job in (first, other)} == {"waiting"}
    second.cancel()
    assert [job.place for job in (first, other, second, third)] == [1, 2, 0, 3]
    assert (second.state, second.elapsed) == ("cancelled", 0.0)


def test_nobody_fills_the_queue(idle):
    jobs = [idle.submit(SHORT, Path(), "one") for _ in range(3)]
    with pytest.raises(ValueError, match="3 of your runs are waiting already"):
        idle.submit(SHORT, Path(), "one")
    idle.submit(SHORT, Path(), "other")
    jobs[0].cancel()
    idle.submit(SHORT, Path(), "one")


def test_closing_cancels_what_runs_and_waits():
    with Runner() as closing:
        running, process = begun(closing)
        waiting = closing.submit(SHORT, Path(), "someone")
    assert (running.state, waiting.state) == ("cancelled", "cancelled")
    assert process._process.poll() is not None
    with pytest.raises(ValueError, match="closing"):
        closing.submit(SHORT, Path(), "someone")


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_a_process_knows_no_secrets_and_ends_with_us(monkeypatch):
    monkeypatch.setenv("SOFTAFM_SECRET", "cookie")
    process = Process()
    try:
        assert b"cookie" not in Path(f"/proc/{process.id}/environ").read_bytes()
        process._requests.close()
        assert process._process.wait(PATIENCE) == 0
    finally:
        process.close()


def test_reports_are_no_more_frequent_than_one_can_read():
    stream = io.BytesIO()
    outlet = Outlet(stream)
    for k in range(1000):
        outlet.progress(k / 1000, "")
    stream.seek(0)
    assert pickle.load(stream) == ("progress", (0.0, ""))
    assert len(stream.read()) < 1000
