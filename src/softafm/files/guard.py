"""Files of others are read in a process of their own, with bounds of time and memory.

A damaged file can make a library loop for ever, take all memory or end its process. What happens
to the process of a reading happens to no one else, and what it answers is plain: JSON, and numbers
whose type and size are told before, so that whoever asked executes nothing of it.
"""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from math import ceil, prod
from pathlib import Path
from threading import Event, Timer
from typing import IO, Any

import numpy as np

SECONDS, SECONDS_A_MEGABYTE = 8.0, 0.2
"""Time that a file has to be read, s: so much, and for each MB so much more."""
_SECONDS_TO_START = 60.0
_OWN_MEMORY, _COPIES = 500_000_000, 3
"""Memory of a reading without what it reads, bytes, and how often it holds that."""
_LONGEST_PROBLEM = 2000
_KEPT = {
    "HOME", "LANG", "LANGUAGE", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "LOCALAPPDATA", "PATH",
    "SYSTEMROOT", "TEMP", "TMP", "TMPDIR", "USERPROFILE",
}  # fmt: skip
_KEPT_PREFIXES = ("LC_", "XDG_", "NUMBA_", "OPENBLAS_", "NVPL_", "BLIS_", "MKL_", "OMP_")
"""Among them what chooses the code for algebra: with another a run differs in its last bits."""
_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


class Unreadable(ValueError):
    """A file that could not be read within its bounds, or not at all."""


def allow_seconds(path: str | Path) -> float:
    """Return the time that a file has to be read, s."""
    return SECONDS + SECONDS_A_MEGABYTE * Path(path).stat().st_size / 1e6


def read_apart(
    reader: str, *arguments: Any, seconds: float = SECONDS, largest: int = 100_000_000
) -> tuple[Any, list[np.ndarray]]:
    """Return what a reader returns: what JSON can hold, and arrays of numbers or texts.

    It ends with whoever called, be it by Ctrl-C.

    Parameters
    ----------
    reader
        ``"module:function"``; called in the other process.
    arguments
        What JSON can hold.
    seconds
        Time after which it is ended, s, not counting how long Python takes to start.
    largest
        Size that all arrays may have together, bytes.

    Raises
    ------
    Unreadable
        In one line: what the reader refused, or that it was ended.
    """
    limits = [f"{seconds:g}", str(_OWN_MEMORY + _COPIES * int(largest))]
    command = [sys.executable, "-P", "-B", "-m", "softafm.files.guard", reader, *limits]
    with _start(command) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        with _kill_after(process, _SECONDS_TO_START), suppress(BrokenPipeError):
            process.stdin.write(json.dumps(arguments).encode())
            process.stdin.close()
            process.stdout.readline()
        with _kill_after(process, seconds) as late:
            try:
                return _read_answer(process.stdout, largest)
            except Unreadable:
                raise
            except Exception as problem:  # whatever came, it is no answer
                if late.is_set():
                    reason = f"could not be read within {seconds:.3g} s"
                    raise Unreadable(f"{reason}; is it damaged?") from None
                code = process.wait()
                reason = f"could not be read ({_describe_ending(code)})"
                raise Unreadable(f"{reason}; is it damaged?") from problem


@contextmanager
def _start(command: Sequence[str]) -> Iterator[subprocess.Popen]:
    process = subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env=make_environment(),
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()
        for pipe in (process.stdin, process.stdout):
            assert pipe is not None
            with suppress(OSError):
                pipe.close()


@contextmanager
def _kill_after(process: subprocess.Popen, seconds: float) -> Iterator[Event]:
    """Kill a process that takes longer; the event tells whether that was done."""
    late = Event()

    def end() -> None:
        late.set()
        process.kill()

    timer = Timer(seconds, end)
    timer.daemon = True
    timer.start()
    try:
        yield late
    finally:
        timer.cancel()


def _read_answer(stream: IO[bytes], largest: int) -> tuple[Any, list[np.ndarray]]:
    told = json.loads(stream.readline(_OWN_MEMORY))
    if "problem" in told:
        raise Unreadable(str(told["problem"])[:_LONGEST_PROBLEM])
    content, described = told["content"], told["arrays"]
    kinds = [(np.dtype(kind), tuple(map(int, shape))) for kind, shape in described]
    if any(kind.kind not in "fiubU" for kind, _ in kinds):
        raise TypeError("no array of numbers or texts")
    if sum(kind.itemsize * prod(shape) for kind, shape in kinds) > largest:
        raise Unreadable(f"has more than {largest / 1e6:g} MB unpacked")
    arrays = [np.empty(shape, kind) for kind, shape in kinds]
    for array in arrays:
        if array.size and stream.readinto(array.reshape(-1).view(np.uint8)) != array.nbytes:  # type: ignore[attr-defined]
            raise EOFError
    return content, arrays


def _describe_ending(code: int) -> str:
    if code >= 0:
        return f"its process ended with exit code {code}"
    with suppress(ValueError):
        return f"its process was ended by {signal.Signals(-code).name}"
    return f"its process was ended by signal {-code}"


def make_environment() -> dict[str, str]:
    """Return what a process needs to know of ours: no secrets, and one thread for algebra."""
    kept = {
        name: value
        for name, value in os.environ.items()
        if name.upper() in _KEPT or name.upper().startswith(_KEPT_PREFIXES)
    }
    kept["PYTHONPATH"] = os.pathsep.join(entry for entry in sys.path if entry)
    return kept | dict.fromkeys(_THREADS, "1")


def bound_memory(size: int) -> None:
    """Let this process have so many bytes of memory, where the operating system can see to it."""
    _bound("RLIMIT_DATA", size)


def _bound(name: str, value: int) -> None:
    try:
        import resource
    except ModuleNotFoundError:
        return
    limit = getattr(resource, name)
    hard = resource.getrlimit(limit)[1]
    if hard == resource.RLIM_INFINITY or value < hard:
        resource.setrlimit(limit, (value, hard))


def main(reader: str, seconds: str, memory: str) -> None:
    """Read what stdin names, and answer on stdout."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for whoever asked, and then ends us
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what a library prints is no answer
    module, _, function = reader.partition(":")
    read = getattr(import_module(module), function)
    arguments = json.load(sys.stdin)
    bound_memory(int(memory))
    _bound("RLIMIT_CORE", 0)
    _bound("RLIMIT_FSIZE", 0)  # a reader writes nothing
    if hasattr(signal, "alarm"):  # ends us even if no one is left to do so
        signal.alarm(ceil(float(seconds)) + 1)
    answers.write(b"ready\n")
    answers.flush()
    arrays: list[np.ndarray] = []
    try:
        content, arrays = read(*arguments)
        described = [(array.dtype.str, array.shape) for array in arrays]
        told = json.dumps({"content": content, "arrays": described})
    except MemoryError:
        arrays, told = [], json.dumps({"problem": "needs more memory than it may have"})
    except Exception as problem:
        words = str(problem) if isinstance(problem, ValueError) else repr(problem)
        arrays, told = [], json.dumps({"problem": "; ".join(words.splitlines())})
    answers.write(told.encode() + b"\n")
    for array in arrays:
        answers.write(np.ascontiguousarray(array).reshape(-1).view(np.uint8).data)
    answers.flush()


if __name__ == "__main__":
    main(*sys.argv[1:])
