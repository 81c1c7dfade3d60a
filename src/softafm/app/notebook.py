"""What the page needs in a notebook: Panel loaded into it, processes for its runs, and a frame."""

import atexit
from functools import cache

import panel as pn

from softafm.app.limits import Limits
from softafm.app.runs import Runner

FRAME = {"height": 760, "sizing_mode": "stretch_width", "css_classes": ["softafm-cell"]}
"""How the page is laid out in a cell, where no window gives it a height."""


def load_panel() -> None:
    """Load Panel into the notebook, all from this machine.

    Each time: the browser may have been reloaded since, which the kernel is not told.
    """
    pn.extension(inline=True)


@cache
def share_runner(limits: Limits) -> Runner:
    """Return the runner of all pages of this Python process with such limits, started."""
    runner = Runner(limits.processes, limits.waiting, limits.run_seconds, limits.kept_bytes)
    runner.start()
    atexit.register(runner.close)
    return runner
