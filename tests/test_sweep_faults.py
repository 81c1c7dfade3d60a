"""Sweeps that are killed, for real: nothing is lost, and the data are those of a quiet run."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
import psutil
import pytest
from swept import XS, YS, calm, deadly

import softafm as sa
from softafm.experiment.config import read_example
from softafm.sweeps.execution import Halted
from softafm.sweeps.progress import read_status

resource = pytest.importorskip("resource")

pytestmark = pytest.mark.skipif(os.name != "posix", reason="kills as POSIX does")

CALL = [sys.executable, "-c", "import sys; from softafm.cli import main; sys.exit(main())"]
CAMPAIGN = (
    read_example("ldpe-tapping")
    + """
[sweep]
batch = 5
observables = ["dissipation", "virial", "force_min"]
[sweep.vary]
sample.E_inf = ["0.05 GPa", "0.1 GPa", "0.2 GPa"]
motion.mean_height = { from = "42 nm", to = "46 nm", points = 60 }
"""
)
GRID = {"x": XS, "y": YS}


@pytest.fixture(scope="module")
def quiet():
    """The result of a run that nothing disturbs."""
    return sa.sweep(calm, GRID, workers=0)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty current directory with a campaign."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "taps.toml").write_text(CAMPAIGN, encoding="utf-8")
    return tmp_path


@pytest.fixture(scope="module")
def taps(tmp_path_factory):
    """The result of the campaign's undisturbed run."""
    path = tmp_path_factory.mktemp("taps") / "taps.toml"
    path.write_text(CAMPAIGN, encoding="utf-8")
    return sa.sweep(path, workers=0)


def same(one, other):
    """Assert that all variables are alike to the last bit."""
    assert list(one.variables) == list(other.variables)
    for name in one.variables:
        assert one[name].dtype == other[name].dtype
        assert one[name].values.tobytes() == other[name].values.tobytes() or (
            one[name].dtype.kind not in "fiub" and (one[name] == other[name]).all()
        )


def finished(store):
    """The number of blocks in a store."""
    return len(list(Path(store, "state").glob("[0-9]*"))) if Path(store).exists() else 0


def until(what):
    """Wait until something holds."""
    for _ in range(6000):
        if what():
            return
        time.sleep(0.01)
    pytest.fail("it did not happen within a minute")


# Workers


def test_what_a_killed_worker_had_is_run_again_and_what_always_kills_fails(tmp_path, quiet, capfd):
    function = partial(deadly, folder=str(tmp_path))
    found = sa.sweep(function, GRID, workers=2, batch=5, store=tmp_path / "s.zarr")
    assert (tmp_path / "killed").exists()
    state = np.ones((len(XS), len(YS)))
    state[5, 2] = 2
    assert np.array_equal(found["state"], state)
    assert str(found["reason"].values[5, 2]).startswith("the run ended its process: SIGKILL")
    for name in ("sum", "product"):
        assert np.isnan(found[name].values[5, 2])
        assert np.array_equal(found[name].where(state == 1), quiet[name].where(state == 1), True)
    assert capfd.readouterr() == ("", "")


def test_a_script_that_its_workers_cannot_read_is_told_how(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import softafm as sa\n"
        "def double(x):\n    return {'y': 2 * x}\n"
        "sa.sweep(double, {'x': [1, 2]}, workers=1)\n",
        encoding="utf-8",
    )
    said = subprocess.run([sys.executable, script], capture_output=True, text=True)
    assert said.returncode == 1
    assert said.stderr.count("Traceback") == 1
    assert said.stderr.endswith("(a script must sweep under if __name__ == '__main__':)\n")


# The client


def test_a_client_that_is_killed_leaves_a_store_to_go_on_with(folder, taps):
    process = subprocess.Popen([*CALL, "sweep", "taps.toml", "--workers", "2"])
    until(lambda: finished("taps.zarr") >= 3 or process.poll() is not None)
    assert process.poll() is None
    assert read_status("taps.zarr").running
    children = psutil.Process(process.pid).children(recursive=True)
    process.kill()
    process.wait()
    until(lambda: not any(child.is_running() and child.status() != "zombie" for child in children))
    found = read_status("taps.zarr")
    assert not found.running
    assert 15 <= found.done < found.runs == 180

    blocks = sorted(Path("taps.zarr/state").glob("[0-9]*"))
    before = {block.name: block.stat().st_mtime_ns for block in blocks}
    with open(f"taps.zarr/virial/{blocks[0].name}", "r+b") as chunk:
        chunk.truncate(20)
    (Path("taps.zarr/force_min") / blocks[1].name).unlink()
    said = subprocess.run(
        [*CALL, "sweep", "taps.toml", "--workers", "1", "--resume"], capture_output=True, text=True
    )
    assert (said.returncode, said.stderr) == (0, "")
    same(sa.load_sweep("taps.zarr"), taps)
    again = {n for n, at in before.items() if Path("taps.zarr/state", n).stat().st_mtime_ns != at}
    assert again == {blocks[0].name, blocks[1].name}


def test_ctrl_c_says_in_one_line_how_to_go_on(folder, taps):
    process = subprocess.Popen(
        [*CALL, "sweep", "taps.toml", "--workers", "1"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
        # A shell's background job ignores Ctrl-C, and so would its children.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
    until(lambda: finished("taps.zarr") >= 2 or process.poll() is not None)
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out) == (1, "")
    assert err == (
        "softafm: interrupted; finished runs are in taps.zarr; --resume continues the sweep\n"
    )
    assert 0 < read_status("taps.zarr").done < 180
    same(sa.sweep("taps.toml", workers=0, store="taps.zarr", resume=True).load(), taps)


# The scheduler


@pytest.fixture
def cluster(tmp_path):
    """A scheduler and two workers, as processes of their own."""
    known = os.pathsep.join([str(Path(__file__).parent), *filter(None, sys.path)])
    options = {"env": {**os.environ, "PYTHONPATH": known}, "stderr": subprocess.DEVNULL}
    file = tmp_path / "scheduler.json"
    dask = [sys.executable, "-m", "dask"]
    local = ["--scheduler-file", str(file), "--no-dashboard"]
    scheduler = subprocess.Popen(
        [*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", *local], **options
    )
    worker = subprocess.Popen(
        [*dask, "worker", *local, "--nworkers", "2", "--nthreads", "2", "--local-directory",
         str(tmp_path), "--death-timeout", "20"], **options,
    )  # fmt: skip
    until(lambda: file.exists() and file.stat().st_size)
    try:
        yield scheduler, json.loads(file.read_text(encoding="utf-8"))["address"]
    finally:
        for process in (worker, scheduler):
            for child in [*psutil.Process(process.pid).children(recursive=True), process]:
                with contextlib.suppress(psutil.NoSuchProcess):
                    child.kill()
            process.wait()


def test_a_scheduler_that_goes_away_halts_a_sweep_which_can_be_resumed(
    tmp_path, cluster, quiet, capfd
):
    scheduler, address = cluster
    store, options = tmp_path / "s.zarr", {"batch": 5, "scheduler": address}
    found = sa.sweep(calm, GRID, store=tmp_path / "whole.zarr", **options)
    same(found, quiet)

    def kill(fraction, message):
        if fraction > 0.2:
            scheduler.kill()

    with pytest.raises(Halted, match="scheduler is gone"):
        sa.sweep(calm, GRID, store=store, progress=kill, **options)
    assert 20 < read_status(store).done < 140
    found = sa.sweep(calm, GRID, store=store, workers=0, resume=True)
    same(found, quiet)
    assert capfd.readouterr() == ("", "")


def test_a_scheduler_that_does_not_answer_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr("softafm.sweeps.execution._CONNECT", 0.3)
    with pytest.raises(Halted, match=r"scheduler = tcp://127\.0\.0\.1:9: "):
        sa.sweep(calm, GRID, scheduler="tcp://127.0.0.1:9")


# The disk


def test_a_disk_without_room_halts_a_sweep_which_can_be_resumed(tmp_path, quiet):
    """Files may not grow beyond a few bytes, as a quota or a full disk has it."""
    store, limits = tmp_path / "s.zarr", resource.getrlimit(resource.RLIMIT_FSIZE)

    def fill(fraction, message):
        if fraction > 0:
            resource.setrlimit(resource.RLIMIT_FSIZE, (20, limits[1]))

    try:
        with pytest.raises(OSError, match="File too large"):
            sa.sweep(calm, GRID, store=store, workers=0, batch=5, progress=fill)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert read_status(store).done == 5
    assert not list(store.rglob("*.part"))
    same(sa.sweep(calm, GRID, store=store, workers=0, resume=True), quiet)


def test_a_full_disk_is_told_in_one_line(folder, taps):
    disk = folder / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=200k", "tmpfs", str(disk)]
    try:
        tried = subprocess.run(mount, capture_output=True)
    except FileNotFoundError:
        pytest.skip("there is no mount")
    if tried.returncode:
        pytest.skip("a disk of its own may not be mounted here")
    store, free = disk / "taps.zarr", disk / "filled"
    command = [*CALL, "sweep", "taps.toml", "--workers", "1", "--out", str(store)]
    try:
        left = os.statvfs(disk)
        # The metadata and some blocks have room, at a page for every file.
        free.write_bytes(bytes(left.f_bfree * left.f_bsize - 40 * os.sysconf("SC_PAGESIZE")))
        said = subprocess.run(command, capture_output=True, text=True)
        assert (said.returncode, said.stdout) == (1, "")
        assert said.stderr == (
            f"softafm: {store} could not be written: No space left on device; finished runs "
            f"are in {store}; --resume continues the sweep\n"
        )
        assert 0 < read_status(store).done < 180
        free.unlink()
        subprocess.run(["mount", "-o", "remount,size=10m", str(disk)], check=True)
        said = subprocess.run([*command, "--resume"], capture_output=True, text=True)
        assert (said.returncode, said.stderr) == (0, "")
        same(sa.load_sweep(store), taps)
    finally:
        subprocess.run(["umount", str(disk)], check=True)
