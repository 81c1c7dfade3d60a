"""Where on the form the problems of a document are shown."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from softafm.app.documents import find_value
from softafm.app.plan import Shown

MISSING = "missing"
_ENTRY = re.compile(r"(.*)\[(\d+)\]")


def add_missing(
    problems: Mapping[str, str], shown: Sequence[Shown], document: Mapping[str, Any]
) -> dict[str, str]:
    """Return the problems, of which each empty field that must be given is one.

    That one of several groups of keys must be given is left out where such fields tell it.
    """
    empty = [
        (one.path, f"{one.path}.{field.name}")
        for one in shown
        for field in one.fields.values()
        if field.required and find_value(document, f"{one.path}.{field.name}") is None
    ]
    if not problems:
        return {}
    told = {table for table, path in empty}
    kept = {
        path: reason
        for path, reason in problems.items()
        if not (path in told and reason.startswith("give "))
    }
    return {path: MISSING for _, path in empty} | kept


def place(
    problems: Mapping[str, str], shown: Sequence[Shown]
) -> tuple[dict[str, str], list[tuple[str, str]]]:
    """Part problems into those of a field or section of the form, and others with their paths.

    A problem of an entry of a list is one of the list, and that of a choice one of its section.
    """
    places = {path for one in shown for path in (one.path, *one.inputs)} | {"mode"}
    choosers = {f"{one.path}.{one.section.chooser}": one.path for one in shown}
    at: dict[str, str] = {}
    elsewhere: list[tuple[str, str]] = []
    for path, reason in problems.items():
        place = choosers.get(path, path)
        entry = _ENTRY.fullmatch(path)
        if place not in places and entry and entry[1] in places:
            place, reason = entry[1], f"entry {int(entry[2]) + 1} {reason}"
        if place in places:
            at[place] = f"{at[place]}; {reason}" if place in at else reason
        else:
            elsewhere.append((path, reason))
    return at, elsewhere
