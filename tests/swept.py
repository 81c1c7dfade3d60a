"""Functions that tests sweep, in a file that workers import quickly."""

import contextlib
import math
import os
import signal
import time
from pathlib import Path

XS, YS = tuple(i / 6 for i in range(7)), tuple(range(20))


def calm(x, y, folder=None):
    """What all functions below give, if they live."""
    time.sleep(0.002)
    return {"sum": math.sin(x) + y, "product": x * math.cos(y)}


def deadly(x, y, folder):
    """End the process that runs it: once at a point, always at another."""
    if (x, y) == (XS[3], 7):
        with contextlib.suppress(FileExistsError):
            Path(folder, "killed").touch(exist_ok=False)
            os.kill(os.getpid(), signal.SIGKILL)
    if (x, y) == (XS[5], 2):
        os.kill(os.getpid(), signal.SIGKILL)
    return calm(x, y)
