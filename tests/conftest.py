"""Compile before the first test, so that no test sees the compiler at work; browser and server."""

import json
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack, contextmanager
from pathlib import Path
from shutil import which
from typing import NamedTuple
from urllib.parse import urlsplit

import pytest

from softafm.cli import main
from softafm.compiled.announce import announce_compilation

NO_BROWSER = "no browser: "
# Forces, energies and lengths here are far below 1e-12, by which approx lets any number be off.
type(pytest.approx(1.0)).DEFAULT_ABSOLUTE_TOLERANCE = 0.0
PATIENCE = 120  # s: for a machine that compiles first, or is busy


@pytest.fixture(scope="session", autouse=True)
def compiled_solvers():
    with announce_compilation("tests"):
        import softafm.solvers.energy.run
        import softafm.solvers.paper.run

    return softafm.solvers


@pytest.fixture(scope="session")
def reference_cases():
    """Converged results of independent solvers by name (see data/README.md)."""
    cases = json.loads((Path(__file__).parent / "data" / "cases.json").read_text())
    return {case["name"]: case for case in cases}


@pytest.fixture
def softafm(capsys):
    """Run a command line; return its exit code, stdout and stderr."""

    def softafm(*arguments):
        capsys.readouterr()
        code = main([str(argument) for argument in arguments])
        said = capsys.readouterr()
        return code, said.out, said.err

    return softafm


def pytest_terminal_summary(terminalreporter):
    """Say what was measured, and what was left out for want of a browser."""
    for report in terminalreporter.stats.get("passed", []):
        for name, value in report.user_properties if report.when == "call" else ():
            terminalreporter.write_line(f"measured: {name} {value}")
    skipped = terminalreporter.stats.get("skipped", [])
    reasons = [report.longrepr[2] for report in skipped if isinstance(report.longrepr, tuple)]
    reasons = [reason for reason in reasons if NO_BROWSER in reason]
    if reasons:
        remedy = reasons[0].partition(NO_BROWSER)[2]
        terminalreporter.write_line(
            f"left out: {len(reasons)} tests of the page in a browser; {remedy}", yellow=True
        )


@pytest.fixture(scope="session")
def browser():
    """A headless Chromium."""
    try:
        from playwright.sync_api import sync_playwright
    except ModuleNotFoundError:
        pytest.skip(f"{NO_BROWSER}pip install 'softafm[test]' brings Playwright")
    chromium = which("chromium") or which("chromium-browser")
    if chromium is None:
        pytest.skip(f"{NO_BROWSER}tools/install-chromium installs one")
    with sync_playwright() as started:
        opened = started.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        yield opened
        opened.close()


class Site(NamedTuple):
    """A running ``softafm app``."""

    address: str
    process: subprocess.Popen
    started: float
    """When it was started, by ``time.monotonic``."""


@contextmanager
def _serving(folder: Path, options: tuple[str, ...]):
    log = folder / "server.log"
    command = [sys.executable, "-m", "softafm.cli", "app", "--no-browser", "--port", "0", *options]
    started = time.monotonic()
    with log.open("w") as noise:
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=noise, text=True)
    with process:
        try:
            line = process.stdout.readline()
            assert "the page is at " in line, log.read_text()
            yield Site(line.split()[5], process, started)
            process.terminate()
            assert "the page is closed" in process.communicate(timeout=PATIENCE)[0]
            assert process.returncode == 0
        finally:
            process.kill()
    assert str(Path("softafm", "app")) not in log.read_text()  # as it would be in a traceback


@pytest.fixture(scope="module")
def serve(browser, tmp_path_factory) -> Callable[..., Site]:
    """Start ``softafm app`` with options as a process of its own, for the tests of a module.

    It must end when told to, and must not have had an error that nobody expected.
    """
    with ExitStack() as stack:
        yield lambda *options: stack.enter_context(
            _serving(tmp_path_factory.mktemp("server"), options)
        )


@pytest.fixture
def visit(browser):
    """Open an address as a new user, and return the page, once it can be used.

    Whatever it complains of, or asks of any other machine, is an error.
    """
    wrong, contexts = [], []

    def opened(address: str, **options):
        options = {"viewport": {"width": 1366, "height": 768}, "color_scheme": "light"} | options
        contexts.append(browser.new_context(**options))
        contexts[-1].set_default_timeout(1000 * PATIENCE)
        page = contexts[-1].new_page()
        page.wrong = wrong
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on("console", lambda said: said.type == "error" and wrong.append(said.text))
        page.on("request", lambda asked: _outside(asked.url) and wrong.append(asked.url))
        page.goto(address)
        page.locator("button.run").wait_for()
        page.locator(".words:not(:empty)").wait_for()
        return page

    yield opened
    for context in contexts:
        context.close()
    assert wrong == []


def _outside(url: str) -> bool:
    parts = urlsplit(url)
    return parts.scheme not in ("data", "blob") and parts.hostname != "127.0.0.1"
