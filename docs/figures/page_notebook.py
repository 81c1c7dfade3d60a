"""The picture of the page in a notebook, for docs/page.md.

Run as ``python docs/figures/page_notebook.py``; it needs jupyterlab besides softafm[test] and
Chromium, and writes docs/images/page-notebook.png.
"""

import json
import re
import subprocess
import sys
from pathlib import Path
from secrets import token_hex
from shutil import which
from tempfile import TemporaryDirectory

from page import WINDOW, run, write
from playwright.sync_api import sync_playwright

CELL = "from softafm.app import Page\n\npage = Page()\npage"
SETTINGS = ("@jupyterlab/apputils-extension", "notification.jupyterlab-settings")


def notebook() -> str:
    """Return a notebook of one cell, as its file."""
    cell = {"cell_type": "code", "execution_count": None, "metadata": {}, "outputs": []}
    kernel = {"name": "python3", "display_name": "Python 3"}
    return json.dumps(
        {
            "cells": [{**cell, "id": "page", "source": CELL}],
            "metadata": {"kernelspec": kernel},
            "nbformat": 4,
            "nbformat_minor": 5,
        }
    )


def main() -> None:
    """Open a notebook, show the page, run, and write the picture."""
    chromium, token = which("chromium") or which("chromium-browser"), token_hex()
    with TemporaryDirectory() as folder, sync_playwright() as playwright:
        (Path(folder) / "tap.ipynb").write_text(notebook(), encoding="utf-8")
        settings = Path(folder).joinpath("settings", *SETTINGS)
        settings.parent.mkdir(parents=True)
        settings.write_text('{"fetchNews": "false", "checkForUpdates": false}', encoding="utf-8")
        command = [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root"]
        command += ["--ip=127.0.0.1", "--port=0", f"--IdentityProvider.token={token}"]
        command += [f"--ServerApp.root_dir={folder}"]
        command += [f"--LabApp.user_settings_dir={folder}/settings"]
        with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as server:
            try:
                assert server.stderr is not None
                found = (re.search(r"http://127\S+/lab", line) for line in server.stderr)
                address = next(match for match in found if match)[0]
                browser = playwright.chromium.launch(
                    executable_path=chromium, args=["--no-sandbox"]
                )
                page = browser.new_page(viewport={**WINDOW, "height": 1000})
                page.goto(f"{address}/tree/tap.ipynb?token={token}")
                page.locator(".jp-CodeCell .cm-content").first.click()
                page.get_by_text("| Idle").wait_for()
                page.keyboard.press("Escape")
                page.keyboard.press("Control+b")
                page.keyboard.press("Control+Enter")
                page.locator("button.run:enabled").wait_for(timeout=60_000)
                run(page)
                write(page, "notebook")
                browser.close()
            finally:
                server.terminate()
                server.communicate()


if __name__ == "__main__":
    main()
