"""Runs in a process of their own, where one that ends its process harms no other.

The process gets a pickled pair of work and points. It answers with pickled pairs for every run: its
number and None before it begins, its number and a block of it alone when it is done.
"""

import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

from softafm.sweeps.block import Block, Work, fail

_GONE = (EOFError, OSError, pickle.UnpicklingError)


def carry_apart(work: Work, points: Sequence[Any]) -> Block:
    """Do all runs as ``work`` does; one that ends its process fails, and the others are done."""
    block, done = work.empty(len(points)), 0
    while done < len(points):
        done = _carry_on(work, points, block, done)
    return block


def _carry_on(work: Work, points: Sequence[Any], block: Block, first: int) -> int:
    """Do runs from a first one on in a new process; return the first that is not done."""
    import cloudpickle

    path = os.pathsep.join(entry for entry in sys.path if entry)
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", "softafm.sweeps.isolated"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": path},
    )
    assert process.stdin is not None
    assert process.stdout is not None
    began, place = False, first
    with process:
        try:
            with suppress(BrokenPipeError):
                process.stdin.write(cloudpickle.dumps((work, points[first:])))
                process.stdin.flush()
            while True:
                number, part = pickle.load(process.stdout)
                began = True
                if part is not None:
                    _copy(part, block, first + number)
                place = first + number + (part is not None)
                if place == len(points):
                    break
        except _GONE:
            code = process.wait()
            if not began:
                raise RuntimeError(
                    f"a process for runs of their own could not start (exit code {code})"
                ) from None
            if place < len(points):
                fail(block, place, f"the run ended its process: {_describe_ending(code)}")
                place += 1
        finally:
            process.kill()
            with suppress(OSError):
                process.stdin.close()
    return place


def _copy(part: Block, block: Block, place: int) -> None:
    """Copy the only run of one block to a place of another."""
    block.state[place] = part.state[0]
    for name, values in part.values.items():
        block.values[name][place] = values[0]
    for texts, ours in ((part.reasons, block.reasons), (part.warnings, block.warnings)):
        if texts:
            ours[place] = texts[0]


def _describe_ending(code: int) -> str:
    if code >= 0:
        return f"exit code {code}"
    with suppress(ValueError):
        return f"{signal.Signals(-code).name}, perhaps for lack of memory"
    return f"signal {-code}"


def main() -> None:
    """Do what stdin asks for."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that asked
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what a run prints is no answer
    work, points = pickle.load(sys.stdin.buffer)

    def say(*content: Any) -> None:
        pickle.dump(content, answers, protocol=pickle.HIGHEST_PROTOCOL)
        answers.flush()

    for number, point in enumerate(points):
        say(number, None)
        block = work.empty(1)
        work.carry(block, 0, point)
        say(number, block)


if __name__ == "__main__":
    main()
