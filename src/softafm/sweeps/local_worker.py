"""What Dask does first in the worker processes that a sweep starts on its own machine."""

import signal
from typing import Any

from softafm.compiled import announce


def dask_setup(worker: Any) -> None:
    """Leave Ctrl-C, and words to the user, to the process that started the sweep."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    announce.silence()
