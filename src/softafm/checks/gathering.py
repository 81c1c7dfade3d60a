"""Warnings of many runs, told as one of each kind: how many there are, and the worst."""

import warnings
from collections.abc import Callable, Hashable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any

from softafm.errors import AccuracyWarning, DoubtfulValueWarning

Placed = tuple[Hashable, AccuracyWarning]
"""A warning, and the run that gave it."""


@contextmanager
def collect_warnings(found: list[AccuracyWarning]) -> Iterator[None]:
    """Add what is warned of inside to a list instead of showing it.

    Values that a mode itself derives are not doubted; all other warnings are shown afterwards.
    """
    caught: list[warnings.WarningMessage] = []
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", AccuracyWarning)
            warnings.simplefilter("ignore", DoubtfulValueWarning)
            yield
    finally:
        for each in caught:
            if isinstance(each.message, AccuracyWarning):
                found.append(each.message)
            else:
                warnings.warn_explicit(each.message, each.category, each.filename, each.lineno)


def gather(
    found: Iterable[Placed], runs: int, noun: str, where: Callable[[Any], str]
) -> list[AccuracyWarning]:
    """Return one warning for each kind of those found.

    Parameters
    ----------
    found
        Warnings with the run that gave each: anything hashable.
    runs, noun
        How many runs there were, and what they are called.
    where
        Function that says in words which run that was, such as ``"pixel (3, 4)"``.
    """
    kinds: dict[str, list[Placed]] = {}
    for placed in found:
        kinds.setdefault(find_kind(placed[1]), []).append(placed)
    gathered = []
    for alike in kinds.values():
        place, worst = max(alike, key=lambda placed: placed[1].severity)
        count = len({place for place, _ in alike})
        most = "the worst at" if count > 1 else "at"
        text = f"{count} of {runs} {noun}, {most} {where(place)}: {worst}"
        gathered.append(AccuracyWarning(text, worst.severity))
    return gathered


def keep_worst(found: Iterable[AccuracyWarning]) -> list[AccuracyWarning]:
    """Return of the warnings of one run the worst of each kind."""
    worst: dict[str, AccuracyWarning] = {}
    for each in found:
        kind = find_kind(each)
        if kind not in worst or each.severity > worst[kind].severity:
            worst[kind] = each
    return list(worst.values())


def find_kind(warning: AccuracyWarning) -> str:
    """Return what warnings of a kind have in common: their words before the first number."""
    text = str(warning)
    return text[: next((i for i, letter in enumerate(text) if letter.isdigit()), len(text))]
