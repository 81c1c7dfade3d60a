"""The document behind the form: values by their paths, and as the texts that fields hold."""

import re
from collections.abc import Mapping
from copy import deepcopy
from math import isfinite
from typing import Any

from softafm.app.form import Field, describe_section, list_tables

_STEP = re.compile(r"([^.\[\]]+)|\[(\d+)\]")


def split_path(path: str) -> list[str | int]:
    """Return the keys and indices of a path such as ``"surface.parts[0].law"``."""
    return [int(index) if index else key for key, index in _STEP.findall(path)]


def find_value(document: Mapping[str, Any], path: str) -> Any:
    """Return the value at a path, None if there is none."""
    found: Any = document
    for step in split_path(path):
        listed = isinstance(found, list) and isinstance(step, int) and step < len(found)
        if not listed and not (isinstance(found, dict) and step in found):
            return None
        found = found[step]
    return found


def replace_value(document: Mapping[str, Any], path: str, value: Any) -> dict[str, Any]:
    """Return a document with another value at a path, None for none; missing tables are made."""
    changed = deepcopy(dict(document))
    inner: Any = changed
    *way, last = split_path(path)
    for step in way:
        if isinstance(inner, dict) and not isinstance(inner.get(step), dict | list):
            inner[step] = {}
        inner = inner[step]
    if value is not None:
        inner[last] = value
    elif find_value(document, path) is not None:
        del inner[last]
    return changed


def remove(thing: Any, path: str, here: str = "") -> Any:
    """Return a copy of a document without what stands at a path, whatever its keys are like."""
    if isinstance(thing, dict):
        paths = {key: f"{here}.{key}" if here else str(key) for key in thing}
        kept = {key: value for key, value in thing.items() if paths[key] != path}
        return {key: remove(value, path, paths[key]) for key, value in kept.items()}
    if isinstance(thing, list):
        paths_of = [(f"{here}[{index}]", value) for index, value in enumerate(thing)]
        return [remove(value, path, inner) for inner, value in paths_of if inner != path]
    return thing


def arrange(document: Mapping[str, Any]) -> dict[str, Any]:
    """Return a document in the order of the form, without tables of which nothing is left.

    What the form does not know comes last. A solver is named as soon as an option of it is given,
    and is not if it is the default one without options.
    """
    mode = document.get("mode")
    known = ("mode", *list_tables(mode))
    names = dict.fromkeys((*(name for name in known if name in document), *document))
    found = {
        name: _arrange_table(name, document[name], mode) if name in known[1:] else document[name]
        for name in names
    }
    return {name: written for name, written in found.items() if written != {}}


def _arrange_table(table: str, written: Any, mode: object) -> Any:
    if not isinstance(written, dict):
        return written
    unset = describe_section(table, None, mode)
    if table == "solver" and written:
        written = {unset.chooser: unset.default} | written
        if written == {unset.chooser: unset.default}:
            return {}
    known = (unset.chooser, *describe_section(table, written.get(unset.chooser), mode).fields)
    return {key: written[key] for key in known if key in written} | written


def read_text(text: str, field: Field) -> Any:
    """Return what a field's text stands for in a document, None if it is empty.

    A text that is no number where one is asked for stays text, which is then refused.
    """
    text = text.strip()
    if not text:
        return None
    if field.kind in ("number", "word"):
        return _read_number(text)
    if field.kind == "list":
        entries = [entry.strip() for entry in text.strip("[]").split(",")]
        return [entry if field.unit else _read_number(entry) for entry in entries if entry]
    return text


def write_text(value: Any) -> str:
    """Return the text that a field holds for a value of a document, "" for None."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        return ", ".join(map(write_text, value))
    return str(value)


def _read_number(text: str) -> Any:
    try:
        return int(text)
    except ValueError:
        pass
    try:
        number = float(text)
    except ValueError:
        return text
    return number if isfinite(number) else text
