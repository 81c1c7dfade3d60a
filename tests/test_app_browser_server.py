"""The page for several users: runs that end otherwise, a queue, limits, a server that is gone."""

import os
import re
import signal
from pathlib import Path

import pytest

from softafm.app.documents import replace_value
from softafm.app.form import read_presets
from softafm.app.links import write_query
from softafm.cli import main

LONG = replace_value(read_presets()["ldpe-tapping"], "motion.cycles", 40_000)
LONG = replace_value(LONG, "run.tolerance", 1e-3)  # for half a minute


@pytest.fixture(scope="module")
def site(serve):
    return serve(
        "--processes", "1", "--waiting", "1", "--listed", "4", "--run-limit", "1200 s",
        "--upload-limit", "0.1",
    )  # fmt: skip


@pytest.fixture
def long(site, visit):
    """A page on which a long run has begun."""
    page = visit(f"{site.address}?{write_query(LONG)}")
    page.locator("input.movie").uncheck()
    page.locator("button.run").click()
    page.locator(".run-running progress").wait_for()
    return page


def run_tap(page):
    page.locator(".choice-preset").select_option("ldpe-tapping")
    page.wait_for_url(re.compile(r"cycles=1(&|$)"))
    page.locator("button.run").click()


def test_a_long_run_tells_how_far_it_is_and_is_cancelled_at_once(long):
    long.locator(".run-running .state", has_text="left").wait_for()
    run_tap(long)
    second = long.locator("ul.runs li").nth(1)
    second.locator(".state", has_text="waiting, number 1 in the queue").wait_for()
    long.locator("button.run").click()
    long.locator(".words.bad", has_text="1 of your runs are waiting already").wait_for()
    long.get_by_role("button", name="cancel 1 tapping-cycle").click()
    long.locator(".run-cancelled").wait_for()
    second.locator(".state", has_text="done in").wait_for()
    long.get_by_role("button", name="remove 1 tapping-cycle").click()
    long.locator(".run-cancelled").wait_for(state="detached")


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="processes are found in /proc")
def test_a_run_whose_process_is_killed_fails_and_the_next_one_works(site, long):
    children = Path(f"/proc/{site.process.pid}/task/{site.process.pid}/children")
    tasks = children.parent.parent.glob("*/children")
    (worker,) = [int(pid) for task in tasks for pid in task.read_text().split()]
    os.kill(worker, signal.SIGKILL)
    long.locator(".run-failed .problem", has_text="its process was ended by SIGKILL").wait_for()
    run_tap(long)
    long.locator(".run-done").wait_for()


def test_users_do_not_see_each_other_but_wait_for_each_other(site, long, visit):
    other = visit(site.address)
    other.locator("button.run").click()
    waiting = other.locator("ul.runs li", has_text="waiting, number 1 in the queue")
    waiting.wait_for()
    assert other.locator("ul.runs li").count() == long.locator("ul.runs li").count() == 1
    long.close()  # which ends its run, and frees the process
    other.locator(".run-done").wait_for()
    assert other.locator("ul.runs .label").input_value() == "1 ldpe-tapping"


def test_what_is_too_much_is_refused_with_a_reason(site, visit, tmp_path):
    page = visit(site.address)
    large = tmp_path / "large.nc"
    large.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(200_000))
    page.locator("input.open").set_input_files(large)
    page.locator(".words.bad", has_text="at most 0.1 MB").wait_for()
    for name, content, words in (
        ("odd.nc", b"<img src=x>", "odd.nc: not a NetCDF file that softafm wrote"),
        ("odd.nc", large.read_bytes()[:5000], "odd.nc: not a readable NetCDF file"),
        ("odd.toml", b"\xff\xfe\x00", "odd.toml: neither a result (.nc) nor text"),
        ("odd.toml", b"mode = <img src=x>", "odd.toml: is not valid TOML"),
    ):
        page.locator("input.open").set_input_files(
            {"name": name, "mimeType": "application/octet-stream", "buffer": content}
        )
        page.locator(".words.bad", has_text=words).wait_for()
    page.locator(".field-motion-cycles input").fill("400000")
    page.locator(".words", has_text=" min").wait_for()
    page.locator("button.run").click()
    page.locator(".words.bad", has_text="more than the 1200 s allowed").wait_for()
    page.locator(".choice-preset").select_option("ldpe-tapping")
    page.locator(".words:not(.bad)", has_text="expected to take").wait_for()
    for count in range(4):
        page.locator("button.run").click()
        page.locator(".run-done").nth(count).wait_for()
    page.locator("button.run").click()
    page.locator(".words.bad", has_text="4 runs are listed, the most allowed").wait_for()
    assert page.locator("img").count() == 0


def test_a_server_that_is_gone_is_told(serve, visit):
    site = serve("--memory-limit", "0.5")
    page = visit(site.address)
    page.locator("button.run").click()
    page.locator(".run-failed .problem", has_text="MB, more than 0.5 MB").wait_for()
    assert page.get_by_role("alert").is_hidden()
    site.process.terminate()
    page.get_by_role("alert").wait_for()
    assert page.get_by_role("button", name="reload the page").is_visible()
    site.process.wait()


# Tornado leaves a socket open that it could not bind.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--port", "70000"], "--port = 70000: must be between 0 and 65535"),
        (["--address", "192.0.2.77"], "--address = 192.0.2.77: Cannot assign"),
        (
            ["--address", "nowhere.invalid", "--port", "0"],
            "--address = nowhere.invalid, --port = 0: ",
        ),
        (["--processes", "0"], "processes"),
        (["--run-limit", "5"], "--run-limit = '5'"),
        (["--upload-limit", "0"], "upload_bytes"),
    ],
)
def test_options_that_make_no_sense_are_refused(options, words, capsys):
    pytest.importorskip("panel")
    assert main(["app", "--no-browser", *options]) == 2
    assert words in capsys.readouterr().err
