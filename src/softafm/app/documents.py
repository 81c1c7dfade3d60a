"""The document behind the form: values by their paths, and as the texts that fields hold."""

import re
from collections.abc import Mapping
from copy import deepcopy
from math import isfinite
from typing import Any

from softafm.app.form import Field, section, tables

_STEP = re.compile(r"([^.\[\]]+)|\[(\d+)\]")


def steps(path: str) -> list[str | int]:
    """Return the keys and indices of a path such as ``"surface.parts[0].law"``."""
    return [int(index) if index else key for key, index in _STEP.findall(path)]


def value_at(document: Mapping[str, Any], path: str) -> Any:
    """Return the value at a path, None if there is none."""
    found: Any = document
    for step in steps(path):
        listed = isinstance(found, list) and isinstance(step, int) and step < len(found)
        if not listed and not (isinstance(found, dict) and step in found):
            return None
        found = found[step]
    return found


def with_value(document: Mapping[str, Any], path: str, value: Any) -> dict[str, Any]:
    """Return a document with another value at a path, None for none; missing tables are made."""
    changed = deepcopy(dict(document))
    inner: Any = changed
    *way, last = steps(path)
    for step in way:
        if isinstance(inner, dict) and not isinstance(inner.get(step), dict | list):
            inner[step] = {}
        inner = inner[step]
    if value is not None:
        inner[last] = value
    elif value_at(document, path) is not None:
        del inner[last]
    return changed


def without(thing: Any, path: str, here: str = "") -> Any:
    """Return a copy of a document without what stands at a path, whatever its keys are like."""
    if isinstance(thing, dict):
        paths = {key: f"{here}.{key}" if here else str(key) for key in thing}
        kept = {key: value for key, value in thing.items() if paths[key] != path}
        return {key: without(value, path, paths[key]) for key, value in kept.items()}
    if isinstance(thing, list):
        paths_of = [(f"{here}[{index}]", value) for index, value in enumerate(thing)]
        return [without(value, path, inner) for inner, value in paths_of if inner != path]
    return thing


def ordered(document: Mapping[str, Any]) -> dict[str, Any]:
    """Return a document in the order of the form, without tables of which nothing is left.

    What the form does not know comes last. A solver is named as soon as an option of it is given,
    and is not if it is the default one without options.
    """
    mode = document.get("mode")
    known = ("mode", *tables(mode))
    names = dict.fromkeys((*(name for name in known if name in document), *document))
    found = {
        name: _ordered(name, document[name], mode) if name in known[1:] else document[name]
        for name in names
    }
    return {name: written for name, written in found.items() if written != {}}


def _ordered(table: str, written: Any, mode: object) -> Any:
    if not isinstance(written, dict):
        return written
    unset = section(table, None, mode)
    if table == "solver" and written:
        written = {unset.chooser: unset.default} | written
        if written == {unset.chooser: unset.default}:
            return {}
    known = (unset.chooser, *section(table, written.get(unset.chooser), mode).fields)
    return {key: written[key] for key in known if key in written} | written


def read_text(text: str, field: Field) -> Any:
    """Return what a field's text stands for in a document, None if it is empty.

    A text that is no number where one is asked for stays text, which is then refused.
    """
    text = text.strip()
    if not text:
        return None
    if field.kind in ("number", "word"):
        return _number_or_text(text)
    if field.kind == "list":
        entries = [entry.strip() for entry in text.strip("[]").split(",")]
        return [entry if field.unit else _number_or_text(entry) for entry in entries if entry]
    return text


def written_text(value: Any) -> str:
    """Return the text that a field holds for a value of a document, "" for None."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        return ", ".join(map(written_text, value))
    return str(value)


def _number_or_text(text: str) -> Any:
    try:
        return int(text)
    except ValueError:
        pass
    try:
        number = float(text)
    except ValueError:
        return text
    return number if isfinite(number) else text
