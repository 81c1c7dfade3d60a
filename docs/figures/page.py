"""The pictures of docs/page.md but that of the notebook, and the times the page quotes.

Run as ``python docs/figures/page.py``; it needs softafm[test] and Chromium, and writes
docs/images/page-*.png.
"""

import io
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from shutil import which

from PIL import Image
from playwright.sync_api import Browser, Locator, Page, sync_playwright

IMAGES = Path(__file__).parents[1] / "images"
WINDOW = {"width": 1366, "height": 768}
LARGEST = 150_000
FRAMES = "() => window.softafm_movie_frames ?? 0"


@contextmanager
def served() -> Iterator[tuple[str, float]]:
    """Serve the page on a free port; its address, and when it was started."""
    command = [sys.executable, "-m", "softafm.cli", "app", "--no-browser", "--port", "0"]
    started = time.monotonic()
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        try:
            yield server.stdout.readline().split()[5], started
        finally:
            server.terminate()
            server.communicate()


def visit(browser: Browser, address: str, colours: str = "light") -> Page:
    """Open the page as a new user, and wait until it can be used."""
    page = browser.new_context(viewport=WINDOW, color_scheme=colours).new_page()
    page.goto(address)
    page.locator(".words:not(:empty)").wait_for()
    page.locator("button.run:enabled").wait_for()
    return page


def tab(page: Page, title: str) -> None:
    """Look at a tab."""
    page.locator(".bk-tab", has_text=title).click()
    page.wait_for_timeout(700)


def field(page: Page, name: str) -> Locator:
    """Find where a value is typed."""
    return page.locator(f".field-{name} input")


def preset(page: Page, name: str) -> None:
    """Choose a bundled example."""
    page.select_option("select.choice-preset", name)
    page.wait_for_timeout(500)


def run(page: Page, label: str = "") -> float:
    """Run what the form describes, name the run, and return the seconds until it was listed."""
    before = page.locator(".run-done").count()
    page.wait_for_timeout(400)
    clicked = time.monotonic()
    page.locator("button.run").click()
    page.locator(".run-done").nth(before).wait_for()
    page.locator(".bk-tab", has_text="Take away").wait_for()
    seconds = time.monotonic() - clicked
    if label:
        name = page.locator("ul.runs input.label").nth(before)
        name.fill(label)
        name.press("Enter")
        name.blur()
    page.wait_for_timeout(700)
    return seconds


def write(page: Page, name: str) -> None:
    """Write a picture of what the window shows."""
    path = IMAGES / f"page-{name}.png"
    page.wait_for_timeout(1000)
    with Image.open(io.BytesIO(page.screenshot())) as picture:
        small = picture.convert("RGB").quantize(kmeans=3, dither=Image.Dither.NONE)
    small.save(path, optimize=True)
    size = path.stat().st_size
    assert size < LARGEST, f"{path.name} has {size} bytes"
    print(f"{path.name}: {size // 1000} kB")


def play(page: Page, fraction: float) -> None:
    """Put the movie at an instant, given as a fraction of its stretch."""
    page.evaluate(
        """fraction => {
          const models = [...Bokeh.documents[0]._all_models.values()];
          const slider = models.find(model => model.type.endsWith("Slider"));
          slider.value = Math.round(slider.start + fraction * (slider.end - slider.start));
        }""",
        fraction,
    )
    page.wait_for_timeout(500)


def frames_per_second(page: Page, seconds: float = 3.0) -> float:
    """Count the frames of the movie while it plays."""
    page.get_by_role("button", name="▶").click()
    page.wait_for_timeout(500)
    before, start = page.evaluate(FRAMES), time.monotonic()
    page.wait_for_timeout(1000 * seconds)
    rate = (page.evaluate(FRAMES) - before) / (time.monotonic() - start)
    page.get_by_role("button", name="❚❚").click()
    return rate


def draw_first_use(page: Page) -> None:
    """The form, curves over each other, files, and bad values."""
    write(page, "form")
    print(f"from the click to the tap on polyethylene: {run(page, 'E∞ = 0.1 GPa'):.2f} s")
    for value in ("0.2", "0.5"):
        field(page, "sample-E_inf").fill(f"{value} GPa")
        run(page, f"E∞ = {value} GPa")
    tab(page, "Force–distance")
    write(page, "curves")
    tab(page, "Take away")
    write(page, "files")
    field(page, "sample-E_inf").fill("0.2 foo")
    field(page, "surface-z0").fill("")
    tab(page, "Regime")
    write(page, "bad")


def draw_movie(page: Page) -> None:
    """The surface movie, in dark colours; nobody else works meanwhile."""
    run(page)
    tab(page, "Surface")
    print(f"the movie: {frames_per_second(page):.0f} frames/s")
    play(page, 0.6)
    write(page, "dark")
    page.locator("button.theme").click()
    page.wait_for_timeout(700)
    write(page, "movie")


def draw_approach(page: Page) -> None:
    """An approach curve."""
    preset(page, "ps-approach-curve")
    run(page)
    write(page, "approach")


def main() -> None:
    """Print the times and write the pictures."""
    chromium = which("chromium") or which("chromium-browser")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        with served() as (address, started):
            page = visit(browser, address)
            print(f"from the command to a usable page: {time.monotonic() - started:.1f} s")
            draw_first_use(page)
            page.context.close()
            draw_movie(visit(browser, address, "dark"))
            draw_approach(visit(browser, address))
        browser.close()


if __name__ == "__main__":
    main()
