"""The command line on results of others, and on disks without room."""

import os
import signal
import subprocess
import sys
import time
from functools import partial

import pytest
from result_samples import results

import softafm as sa
from softafm.experiment.config import read_example
from softafm.files import guard
from softafm.results.datasets import load_apart


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder to work in, with a result."""
    monkeypatch.chdir(tmp_path)
    sa.save(results()["with shapes"], tmp_path / "shapes.nc")
    return tmp_path


COMMANDS = {
    "plot": ("plot", "shapes.nc", "--out", "new.png"),
    "plot --profiles": ("plot", "shapes.nc", "--profiles", "--out", "new.png"),
    "export": ("export", "shapes.nc", "--out", "new.csv"),
    "animate": ("animate", "shapes.nc", "--out", "new.html"),
}


def refused(answer, words):
    code, said, complaint = answer
    assert (code, said) == (2, "")
    assert complaint.startswith("softafm: ")
    assert complaint.count("\n") == 1
    assert words in complaint


@pytest.mark.parametrize("command", COMMANDS)
def test_a_result_that_is_no_good_is_bad_input(folder, softafm, command):
    half = results()["with shapes"].drop_vars("force")
    sa.save(half, folder / "shapes.nc", overwrite=True)
    refused(softafm(*COMMANDS[command]), "shapes.nc: variable 'force' is missing")
    assert sorted(os.listdir()) == ["shapes.nc"]


@pytest.mark.parametrize("command", COMMANDS)
def test_a_reading_that_does_not_end_is_ended(folder, softafm, command, monkeypatch):
    read = guard.read_apart
    monkeypatch.setattr(
        guard, "read_apart", lambda *_, **__: read("stand_ins:spins", 0, seconds=0.4)
    )
    refused(softafm(*COMMANDS[command]), "shapes.nc: could not be read within 0.4 s; is it damaged")
    assert sorted(os.listdir()) == ["shapes.nc"]


def test_the_time_for_a_reading_follows_the_size(folder, monkeypatch):
    asked = []
    read = guard.read_apart

    def noted(*arguments, **options):
        asked.append(options["seconds"])
        return read(*arguments, **options)

    monkeypatch.setattr(guard, "read_apart", noted)
    size = os.path.getsize("shapes.nc")
    load_apart("shapes.nc")
    assert asked == [pytest.approx(8 + 0.2 * size / 1e6)]


STUCK = """
import sys
from softafm.files import guard
from softafm.experiment.config import read_example
from softafm.results.datasets import load_apart
from softafm.cli import main
read = guard.read_apart
def stuck(*_, **__):
    print("reading", flush=True)
    return read("stand_ins:spins", 0, seconds=60)
guard.read_apart = stuck
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGINT to send")
def test_ctrl_c_ends_a_reading_at_once(folder):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-c", STUCK, *COMMANDS["plot"]]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    # A shell's background job ignores Ctrl-C, and so would its children.
    pipes["preexec_fn"] = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    with subprocess.Popen(command, text=True, env=environment, **pipes) as process:
        assert process.stdout.readline() == "reading\n"
        time.sleep(1)
        started = time.monotonic()
        process.send_signal(signal.SIGINT)
        said = process.communicate()
        assert time.monotonic() - started < 5
    assert (process.returncode, *said) == (1, "", "softafm: interrupted, nothing written\n")
    assert os.listdir() == ["shapes.nc"]


FULL = """
import resource, sys
from softafm.cli import main
resource.setrlimit(resource.RLIMIT_FSIZE, (300, -1))
for line in sys.stdin:
    print(main(line.split()), file=sys.stderr)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="limits file sizes as POSIX does")
def test_a_full_disk_is_one_line_and_leaves_what_was_there(folder):
    """Files may not grow beyond a few bytes, as a full disk has it."""
    writers = [
        "plot shapes.nc --out old.png",
        "plot shapes.nc --profiles --out old.pdf",
        "export shapes.nc --out old.csv",
        "export shapes.nc --out old.h5",
        "animate shapes.nc --frames 3 --out old.html",
        "animate shapes.nc --frames 3 --out old.gif",
        "example ldpe-tapping --out old.toml",
        "show known.toml --out old.svg",
    ]
    outputs = [line.rpartition(" ")[2] for line in writers]
    for name in outputs:
        (folder / name).write_text("precious")
    (folder / "known.toml").write_text(read_example("ldpe-tapping"))
    before = sorted(os.listdir())
    asked = "".join(f"{line} --force\n" for line in writers)
    answer = subprocess.run(
        [sys.executable, "-c", FULL], input=asked, capture_output=True, text=True, check=True
    )
    expected = [
        line for name in outputs
        for line in (f"softafm: {name} could not be written: File too large", "1")
    ]  # fmt: skip
    assert answer.stderr.splitlines() == expected
    assert answer.stdout == ""
    assert sorted(os.listdir()) == before
    assert {(folder / name).read_text() for name in outputs} == {"precious"}
