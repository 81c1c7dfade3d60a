"""Runs of a block, one after another, in whichever process: what they give, or why they failed."""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from softafm.checks.gathering import keep_worst
from softafm.errors import AccuracyWarning, DivergedError

UNKNOWN, DONE, FAILED, WARNED = range(4)
"""States of a run; the last is done, with a warning."""


@dataclass
class Block:
    """What a number of runs gave.

    Attributes
    ----------
    state
        Of each run, shape (n,).
    values
        By observable, shape (n, ...); NaN where a run failed.
    reasons, warnings
        Texts of the runs that failed or warned, by their place in the block.
    """

    state: np.ndarray
    values: dict[str, np.ndarray]
    reasons: dict[int, str] = field(default_factory=dict)
    warnings: dict[int, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Work:
    """What is to be done with every point: ``run`` it, and keep observables of known shapes."""

    run: Callable[[Any], Mapping[str, Any]]
    shapes: Mapping[str, tuple[int, ...]]

    def empty(self, count: int) -> Block:
        """Return a block of runs yet to be done."""
        values = {name: np.full((count, *shape), np.nan) for name, shape in self.shapes.items()}
        return Block(np.full(count, UNKNOWN, np.uint8), values)

    def __call__(self, points: Sequence[Any]) -> Block:
        """Do all runs."""
        block = self.empty(len(points))
        for place, point in enumerate(points):
            self.carry(block, place, point)
        return block

    def carry(self, block: Block, place: int, point: Any) -> None:
        """Do one run of a block, and note what it gives there, or the reason why it does not."""
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("ignore")
            warnings.simplefilter("always", AccuracyWarning)
            try:
                given = self.run(point)
                found = {name: self._value(given, name) for name in self.shapes}
            except (Exception, SystemExit) as error:
                fail(block, place, _word_reason(error))
                return
        for name, value in found.items():
            block.values[name][place] = value
        block.state[place] = WARNED if told else DONE
        if told:
            doubts = [each.message for each in told if isinstance(each.message, AccuracyWarning)]
            texts = map(str, keep_worst(doubts))
            block.warnings[place] = "; ".join(map(join_lines, texts))

    def _value(self, given: Mapping[str, Any], name: str) -> np.ndarray:
        if name not in given:
            raise ValueError(f"the run gave no '{name}'")
        value = np.asarray(given[name], float)
        if value.shape != self.shapes[name]:
            raise ValueError(
                f"'{name}' of the run has the shape {value.shape}, others {self.shapes[name]}"
            )
        return value


def fail(block: Block, place: int, reason: str) -> None:
    """Note that a run of a block failed."""
    block.state[place] = FAILED
    block.reasons[place] = reason


def _word_reason(error: BaseException) -> str:
    ours = isinstance(error, ValueError | DivergedError) and str(error)
    return join_lines(str(error) if ours else f"{type(error).__name__}: {error}")


def join_lines(text: str) -> str:
    """Return lines as sentences of one."""
    return "; ".join(" ".join(line.split()) for line in text.splitlines() if line.strip())
