"""The process that runs experiments one after another: asked on stdin, answering on stdout.

Requests are pickled pairs (document, folder), answers pickled pairs (kind, content), see
``Answer``. It ends when its stdin does, as it does when the process that started it is gone.
Its argument is the size of the largest result that is sent, bytes.
"""

import os
import pickle
import queue
import signal
import sys
import threading
import traceback
import warnings
from collections.abc import Mapping
from pathlib import Path
from time import monotonic
from typing import IO, Any, Literal

from softafm.errors import AccuracyWarning, DivergedError
from softafm.experiment.config import build_experiment, parse_document, read_example
from softafm.files.guard import bound_memory

Answer = tuple[Literal["ready", "progress", "warning", "result", "problem"], Any]
"""``ready`` comes once, at the start; of a run there are any number of ``progress`` (fraction,
message) and ``warning`` (text), and then ``result`` (Dataset) or ``problem`` (text, one line)."""

_WARM_UP = ("ldpe-tapping", "ldpe-movie")
"""Examples that load between them the compiled code of most runs."""
_BETWEEN_REPORTS = 0.1  # s
_OWN_MEMORY = 2_000_000_000  # bytes, without any result
_COPIES = 4
"""How often a result is in memory while it is made and sent."""
_SMALLER = "run it without the surface movie, for fewer cycles, or less accurately"


class Outlet:
    """Where answers go."""

    def __init__(self, stream: IO[bytes]):
        self._stream = stream
        self._reported = 0.0

    def say(self, kind: str, content: Any = None) -> None:
        """Send an answer."""
        pickle.dump((kind, content), self._stream, protocol=pickle.HIGHEST_PROTOCOL)
        self._stream.flush()

    def progress(self, fraction: float, message: str) -> None:
        """Send how far a run is, but not more often than anyone can read."""
        now = monotonic()
        if now - self._reported >= _BETWEEN_REPORTS:
            self._reported = now
            self.say("progress", (float(fraction), str(message)))


def main(largest: int) -> None:
    """Warm up, then answer requests until stdin ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the server, which then ends us
    if hasattr(os, "nice"):
        os.nice(5)  # the page comes first
    bound_memory(_OWN_MEMORY + _COPIES * largest)
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what a library prints is no answer
    requests: queue.SimpleQueue[tuple[Mapping[str, Any], str]] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(sys.stdin.buffer, requests), daemon=True).start()
    outlet = Outlet(answers)
    for name in _WARM_UP:
        build_experiment(parse_document(read_example(name), name), Path()).run()
    outlet.say("ready")
    while True:
        outlet.say(*refuse_large(*answer(*requests.get(), outlet), largest))


def _listen(stream: IO[bytes], requests: queue.SimpleQueue) -> None:
    try:
        while True:
            requests.put(pickle.load(stream))
    except (EOFError, OSError, pickle.UnpicklingError):
        os._exit(0)


def answer(document: Mapping[str, Any], folder: str, outlet: Outlet) -> tuple[str, Any]:
    """Run an experiment, reporting on the way, and return the last answer."""
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always", AccuracyWarning)
        try:
            last: tuple[str, Any] = (
                "result",
                build_experiment(document, Path(folder)).run(outlet.progress),
            )
        except MemoryError:
            last = "problem", f"it needs more memory than a run may have here: {_SMALLER}"
        except (ValueError, DivergedError) as error:
            last = "problem", join_lines(str(error))
        except Exception as error:
            traceback.print_exc()
            last = "problem", join_lines(f"{type(error).__name__}: {error}")
    for warning in found:
        if issubclass(warning.category, AccuracyWarning):
            outlet.say("warning", join_lines(str(warning.message)))
    return last


def refuse_large(kind: str, content: Any, largest: int) -> tuple[str, Any]:
    """Return an answer, or a problem in the place of a result that is too large."""
    if kind == "result" and content.nbytes > largest:
        size = f"{content.nbytes / 1e6:.0f} MB, more than {largest / 1e6:g} MB"
        return "problem", f"its result has {size}: {_SMALLER}"
    return kind, content


def join_lines(text: str) -> str:
    """Return lines as sentences of one."""
    return "; ".join(" ".join(line.split()) for line in text.splitlines() if line.strip())


if __name__ == "__main__":
    main(int(sys.argv[1]))
