"""The guard of readings, on readers that misbehave in every way but a harmful one."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from softafm.files import guard
from softafm.files.guard import Unreadable, read_apart


def stand_in(name, *arguments, **options):
    return read_apart(f"stand_ins:{name}", *arguments, **options)


def test_what_a_reader_returns_comes_back():
    content, arrays = stand_in("whole", 1000)
    assert content == {"text": "µ\n\udc80", "none": None}
    numbers, texts, empty, single, turned = arrays
    assert numbers.tolist() == list(range(1000))
    assert texts.tolist() == ["a", "bcd"]
    assert empty.shape == (0, 3)
    assert single == 2.0
    assert turned.tolist() == [[0, 3], [1, 4], [2, 5]]
    numbers[0] = 5  # it is ours
    assert stand_in("prints", "rubbish\n{}") == ("said", [])


def test_what_is_refused_is_told_in_one_line():
    with pytest.raises(Unreadable, match=r"^one; two$"):
        stand_in("refuses", "one\ntwo")
    with pytest.raises(Unreadable, match=r"^KeyError\('odd'\)$"):
        stand_in("fails", "odd")


@pytest.mark.parametrize("name", ["sleeps", "spins"])
def test_one_that_does_not_end_is_ended(name):
    started = time.monotonic()
    with pytest.raises(Unreadable, match=r"^could not be read within 0\.3 s; is it damaged\?$"):
        stand_in(name, 3600, seconds=0.3)
    assert time.monotonic() - started < 10


@pytest.mark.skipif(sys.platform != "linux", reason="memory is bounded elsewhere")
def test_one_that_takes_too_much_memory_is_refused():
    with pytest.raises(Unreadable, match=r"^needs more memory than it may have$"):
        stand_in("allocates", 2_000_000_000, largest=1000)
    with pytest.raises(Unreadable, match=r"^has more than 0\.001 MB unpacked$"):
        stand_in("allocates", 1001, largest=1000)
    assert stand_in("allocates", 1000, largest=1000)[1][0].sum() == 1000


@pytest.mark.parametrize(
    ("name", "argument", "words"),
    [
        ("dies", 3, r"its process ended with exit code 3"),
        ("is_killed", int(signal.SIGTERM), r"its process was ended by SIGTERM"),
        ("garbles", "rubbish\n", r"its process ended with exit code 0"),
        ("garbles", '{"content": 1, "arrays": [["O", [1]]]}\n', "exit code 0"),
        ("garbles", '{"content": 1, "arrays": [["<f8", [9]]]}\n', "exit code 0"),
        ("garbles", '{"content": 1, "arrays": [["<f8", [-9]]]}\n', "exit code 0"),
        ("garbles", "[" * 100_000, "exit code 0"),
    ],
)
def test_one_that_breaks_down_is_told(name, argument, words):
    with pytest.raises(Unreadable, match=rf"^could not be read \(.*{words}\); is it damaged\?$"):
        stand_in(name, argument, seconds=20)


def test_more_than_may_be_is_not_even_made_room_for():
    with pytest.raises(Unreadable, match=r"^has more than 100 MB unpacked$"):
        stand_in("garbles", '{"content": 1, "arrays": [["<f8", [1000000000000]]]}\n')


def test_nested_answers_harm_no_one():
    with pytest.raises(Unreadable):
        stand_in("deep", 200_000)


def test_it_knows_no_secrets_and_writes_nothing(tmp_path, monkeypatch):
    monkeypatch.setenv("SECRET_TOKEN", "x")
    monkeypatch.setenv("LC_ALL", "C.UTF-8")
    known, _ = stand_in("knows", "SECRET_TOKEN", "LC_ALL", "OMP_NUM_THREADS")
    assert known == {"SECRET_TOKEN": None, "LC_ALL": "C.UTF-8", "OMP_NUM_THREADS": "1"}
    if sys.platform == "linux":
        with pytest.raises(Unreadable, match="File too large"):
            stand_in("writes", str(tmp_path / "file"))
        assert not (tmp_path / "file").read_bytes()


ASK = """
import os, sys
from softafm.files import guard
made = guard.subprocess.Popen
def told(*arguments, **options):
    process = made(*arguments, **options)
    print(process.pid, flush=True)
    return process
guard.subprocess.Popen = told
guard.read_apart("stand_ins:spins", 0, seconds=float(sys.argv[1]))
"""


def gone(number):
    for _ in range(200):
        state = Path(f"/proc/{number}/stat")
        if not state.exists() or state.read_text().rpartition(")")[2].split()[0] == "Z":
            return True
        time.sleep(0.05)
    return False


@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
@pytest.mark.parametrize(("end", "seconds"), [(signal.SIGINT, 60), (signal.SIGKILL, 1)])
def test_it_ends_with_whoever_asked(end, seconds):
    """At once by Ctrl-C; when its time is over if the one who asked was killed."""
    command = [sys.executable, "-c", ASK, str(seconds)]
    environment = guard.make_environment() | {"PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env=environment,
        # A shell's background job ignores Ctrl-C, and so would its children.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as asking:
        number = int(asking.stdout.readline())
        time.sleep(1.5)
        asking.send_signal(end)
        started = time.monotonic()
        asking.wait()
        assert time.monotonic() - started < 5
    assert gone(number)


def test_large_results_come_back_fast(record_property):
    started = time.monotonic()
    (one,) = stand_in("allocates", 100_000_000, largest=100_000_000)[1]
    record_property("0.1 GB out of a guard", f"{time.monotonic() - started:.2f} s")
    assert np.all(one == 1)
