"""What is to be said of a document before any run: what is wrong with it, or what it will be."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from softafm.app.files import refuse_paths
from softafm.app.form import list_tables
from softafm.checks.refusals import ConfigError, show
from softafm.experiment.config import build_experiment
from softafm.experiment.regime import estimate_seconds, list_rows
from softafm.experiment.scales import Row

_OPTIONAL = ("solver", "run")
_LONGEST_PATH = 60
"""Length to which the refusal of an unknown key cuts its path."""
_LINE = re.compile(r"([\w.\[\]-]+)(?: = .*?)?: (.*)")


@dataclass(frozen=True)
class Outlook:
    """What a document leads to.

    ``problems`` are reasons by the path of what they refuse; without any, ``rows`` give the regime
    and ``seconds`` the order of magnitude of a run, s on one core.
    """

    problems: dict[str, str] = field(default_factory=dict)
    rows: tuple[Row, ...] = ()
    seconds: float | None = None


def foresee(document: Mapping[str, Any], folder: Path) -> Outlook:
    """Return what is wrong with a document, or its regime; its files are in ``folder``."""
    needed = [name for name in list_tables(document.get("mode")) if name not in _OPTIONAL]
    whole = {**dict(document), **{name: {} for name in needed if name not in document}}
    try:
        refuse_paths(whole)
        experiment = build_experiment(whole, folder)
    except ConfigError as error:
        return Outlook(problems=_sort_by_path(str(error).splitlines(), whole))
    try:
        return Outlook({}, tuple(list_rows(experiment)), estimate_seconds(experiment))
    except (ValueError, ArithmeticError, RuntimeError) as error:
        return Outlook(problems={"mode": f"cannot be foreseen: {error}"})


def find_problems(document: Mapping[str, Any], folder: Path) -> dict[str, str]:
    """Return why a document cannot run: reasons by path, such as ``"sample.E0"``; {} if it can."""
    return foresee(document, folder).problems


def summarise(document: Mapping[str, Any], folder: Path) -> tuple[Row, ...]:
    """Return the rows of ``softafm info``; () if the document cannot run."""
    return foresee(document, folder).rows


def estimate_cost(document: Mapping[str, Any], folder: Path) -> float | None:
    """Return the order of magnitude of a run, s on one core; None if the document cannot run."""
    return foresee(document, folder).seconds


def _sort_by_path(lines: list[str], document: Mapping[str, Any]) -> dict[str, str]:
    """Part the lines of a ConfigError, ``path = value: reason`` or ``path: reason``."""
    places = sorted(_list_places(document, ""), key=lambda place: -len(place[0]))
    found: dict[str, str] = {}
    for line in lines:
        path, reason = _part_line(line, places)
        found.setdefault(path, reason)
    return found


def _part_line(line: str, places: list[tuple[str, Any]]) -> tuple[str, str]:
    for path, value in places:
        for start in (f"{path} = {show(value)}: ", f"{path[:_LONGEST_PATH]}: "):
            # A ConfigError escapes what cannot be printed, and so must be compared with one.
            start = str(ConfigError([start]))
            if line.startswith(start):
                return path, line.removeprefix(start)
    match = _LINE.fullmatch(line)
    return (match[1], match[2]) if match else ("mode", line)


def _list_places(thing: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield everything in a document with its path."""
    if isinstance(thing, dict):
        for key, value in thing.items():
            inner = f"{path}.{key}" if path else str(key)
            yield inner, value
            yield from _list_places(value, inner)
    elif isinstance(thing, list):
        for index, value in enumerate(thing):
            yield f"{path}[{index}]", value
            yield from _list_places(value, f"{path}[{index}]")
