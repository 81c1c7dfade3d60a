"""Run the code of the tutorials, print their numbers and draw the figure of a first force curve.

python docs/figures/tutorials.py
"""

import os
import re
import shutil
import tempfile
from pathlib import Path

from softafm.experiment.config import read_example

DOCS = Path(__file__).parents[1]


def run(page):
    blocks = re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.S)
    exec("\n".join(blocks), {})


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        Path("ldpe-tapping.toml").write_text(read_example("ldpe-tapping"), encoding="utf-8")
        run("first-force-curve.md")
        run("first-tap.md")
        shutil.copy("curve.png", DOCS / "images" / "first-force-curve.png")
        os.chdir(DOCS)


if __name__ == "__main__":
    main()
