"""How far a sweep is, from its store alone."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from softafm.draw.summary import make_table
from softafm.sweeps.block import FAILED, UNKNOWN, WARNED
from softafm.sweeps.store import Store

if TYPE_CHECKING:
    from rich.table import Table

_RECENT = 300.0
"""Time over which a rate is taken, s."""


@dataclass(frozen=True)
class Status:
    """How far a sweep is.

    Attributes
    ----------
    runs, done, failed, warned
        Number of all runs, of those done, and of those among them that failed or warned.
    running
        Whether a process is at work on it.
    rate
        Runs done in a second, of late; None if none were.
    example
        Where and why the first run failed, or None.
    """

    runs: int
    done: int
    failed: int
    warned: int
    running: bool
    rate: float | None
    example: str | None

    @property
    def seconds_left(self) -> float | None:
        """Time that is left at this rate, s."""
        return None if self.rate is None else (self.runs - self.done) / self.rate


def read_status(path: str | Path) -> Status:
    """Read from a store how far its sweep is.

    Raises
    ------
    ValueError
        If it is no store of a sweep.
    """
    store = Store(Path(path))
    counts = np.zeros(4, int)
    times, runs, example = [], [], None
    for number in store.list_begun_blocks():
        states = store.state(number)
        counts += np.bincount(states, minlength=4)[:4]
        if example is None and (states == FAILED).any():
            example = _find_example(store, number, int(np.argmax(states == FAILED)))
        finished = store.read_finish(number)
        if finished is not None:
            times.append(finished)
            runs.append(int((states != UNKNOWN).sum()))
    return Status(
        runs=store.size,
        done=int(counts.sum() - counts[UNKNOWN]),
        failed=int(counts[FAILED]),
        warned=int(counts[WARNED]),
        running=store.in_use,
        rate=_estimate_rate(np.array(times), np.array(runs), store.begun),
        example=example,
    )


def _estimate_rate(times: np.ndarray, runs: np.ndarray, begun: float) -> float | None:
    """Return the runs done in a second since the last begin, or within the last minutes."""
    if not times.size:
        return None
    since = max(begun, times.max() - _RECENT)
    recent = times > since
    if not recent.any():  # it was resumed just now
        since = times.min()
        recent = times > since
    duration = times.max() - since
    return float(runs[recent].sum() / duration) if duration > 0 else None


def _find_example(store: Store, number: int, place: int) -> str:
    """Return where and why a run failed."""
    ranges = store.ranges(number)
    within = np.unravel_index(place, tuple(map(len, ranges)))
    index = [r[int(i)] for r, i in zip(ranges, within, strict=True)]
    where = ", ".join(f"{name}[{i}]" for name, i in zip(store.dimensions, index, strict=True))
    return f"{where}: {store.texts('reason', number)[place]}"


def describe_duration(seconds: float) -> str:
    """Return a duration as a person would say it."""
    for limit, unit, name in ((60, 1, "s"), (3600, 60, "min"), (86400, 3600, "h")):
        if seconds < 2 * limit:
            return f"{seconds / unit:.0f} {name}"
    return f"{seconds / 86400:.0f} days"


def tabulate(found: Status) -> "Table":
    """Return a table of it for people."""
    word = "running" if found.running else "stopped; --resume goes on with it"
    word = "finished" if found.done == found.runs else word
    told = make_table(f"sweep, {word}")
    share = 100 * found.done / found.runs
    told.add_row("done", f"{found.done} of {found.runs}", f"runs, {share:.3g} %")
    told.add_row("failed", str(found.failed), found.example or "")
    told.add_row("warned", str(found.warned), "done, with doubts about their accuracy")
    if found.rate is not None:
        told.add_row("rate", f"{found.rate:.3g}", "runs a second, of late")
        if found.seconds_left:
            told.add_row("time left", describe_duration(found.seconds_left), "at this rate")
    return told
