"""The handle of a process that runs experiments (``softafm.app.worker``)."""

import pickle
import signal
import subprocess
import sys
from collections.abc import Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from softafm.files.guard import make_environment

if TYPE_CHECKING:
    from softafm.app.worker import Answer

GONE = (EOFError, OSError, pickle.UnpicklingError)
"""What asking or hearing a process raises that is gone."""


class Process:
    """A process that waits for runs, with only so much of our environment as it needs.

    Parameters
    ----------
    largest
        Size above which a result is refused, bytes.

    Attributes
    ----------
    warm
        Whether it has said that it is ready.
    """

    def __init__(self, largest: int = 500_000_000) -> None:
        # Not multiprocessing: its children import the parent's script, and get all its environment.
        command = [sys.executable, "-P", "-m", "softafm.app.worker", str(largest)]
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=make_environment()
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._requests, self._answers = self._process.stdin, self._process.stdout
        self.warm = False

    @property
    def id(self) -> int:
        """The operating system's number of the process."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Whether it is warm and has not ended."""
        return self.warm and self._process.poll() is None

    @property
    def last_words(self) -> str:
        """Why the process is gone, having waited until it is."""
        code = self._process.wait()
        if code >= 0:
            return f"its process ended with exit code {code}; the server's log may say why"
        try:
            name = signal.Signals(-code).name
        except ValueError:
            name = f"signal {-code}"
        return f"its process was ended by {name}, perhaps for lack of memory"

    def warm_up(self) -> None:
        """Wait until it is ready, or gone."""
        with suppress(*GONE):
            self.warm = self.answer()[0] == "ready"

    def ask(self, document: Mapping[str, Any], folder: str) -> None:
        """Send a run; an exception of ``GONE`` if it is gone."""
        pickle.dump((document, folder), self._requests)
        self._requests.flush()

    def answer(self) -> "Answer":
        """Wait for the next answer; an exception of ``GONE`` if it is gone."""
        return pickle.load(self._answers)

    def kill(self) -> None:
        """End it, in the midst of whatever it does."""
        self._process.kill()

    def close(self) -> None:
        """End it, and forget it."""
        self.kill()
        self._process.wait()
        self._answers.close()
        with suppress(OSError):  # the last request may never have got through
            self._requests.close()
