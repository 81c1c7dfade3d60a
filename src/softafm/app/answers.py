"""What becomes of a document when another mode, choice or way is chosen in the form.

``memory`` holds by path what fields held that are no longer there; each function adds to it.
"""

from collections.abc import Mapping, MutableMapping
from typing import Any

from softafm.app.documents import value_at, with_value
from softafm.app.form import Alternatives, Section, section, tables
from softafm.app.plan import Shown, way_of

_MOST_PARTS = 20
Memory = MutableMapping[str, Any]


def chosen(
    document: Mapping[str, Any], shown: Shown, choice: str, memory: Memory
) -> dict[str, Any]:
    """Return the document with another choice in a section; KeyError if there is no such choice."""
    old, chooser = shown.section, shown.section.chooser
    if choice not in old.choices:
        raise KeyError(choice)
    written = _table(document, shown.path)
    new = section(old.table, choice, document.get("mode"))
    made: dict[str, Any] = {} if choice == new.default else {chooser: choice}
    made |= _filled(shown.path, new, written, memory)
    laws = [part for part in written.get("parts", ()) if isinstance(part, dict)]
    if "parts" in new.fields and "parts" not in made:
        made["parts"] = [written]
    made |= next((law for law in laws if law.get(chooser) == choice), {})
    return with_value(document, shown.path, made)


def moded(document: Mapping[str, Any], mode: str, memory: Memory) -> dict[str, Any]:
    """Return the document with another mode, its motion and its lever as that mode has them."""
    changed = {**document, "mode": mode}
    motion = _table(document, "motion")
    shape = motion.get("shape")
    shape = shape if shape in section("motion", None, mode).choices else None
    made = {} if shape is None else {"shape": shape}
    made |= _filled("motion", section("motion", shape, mode), motion, memory)
    changed["motion"] = made
    lever = _table(document, "cantilever")
    changed.pop("cantilever", None)
    if "cantilever" in tables(mode):
        changed["cantilever"] = _filled(
            "cantilever", section("cantilever", None, mode), lever, memory
        )
    else:
        _remember("cantilever", lever, memory)
    return changed


def taken(
    document: Mapping[str, Any], path: str, alternatives: Alternatives, way: int, memory: Memory
) -> dict[str, Any]:
    """Return the document with a table's alternatives given in another way."""
    written = _table(document, path)
    _remember(path, written, memory)
    all_keys = {key for keys in alternatives.names for key in keys}
    kept = {key: value for key, value in written.items() if key not in all_keys}
    wanted = {key: memory.get(f"{path}.{key}") for key in alternatives.names[way]}
    given = {key: value for key, value in wanted.items() if value is not None}
    return with_value(document, path, kept | given)


def added(document: Mapping[str, Any]) -> dict[str, Any]:
    """Return the document with one more part of its sum of laws, unless there are very many."""
    parts = value_at(document, "surface.parts")
    parts = parts if isinstance(parts, list) else []
    more = [*parts, {}] if len(parts) < _MOST_PARTS else parts
    return with_value(document, "surface.parts", more)


def _table(document: Mapping[str, Any], path: str) -> dict[str, Any]:
    written = value_at(document, path)
    return dict(written) if isinstance(written, dict) else {}


def _remember(path: str, written: Mapping[str, Any], memory: Memory) -> None:
    memory.update({f"{path}.{key}": value for key, value in written.items()})


def _filled(path: str, new: Section, written: Mapping[str, Any], memory: Memory) -> dict[str, Any]:
    """Return what fields of a section are filled with: what is written, or was before."""
    _remember(path, written, memory)
    found = {key: memory[f"{path}.{key}"] for key in new.fields if f"{path}.{key}" in memory}
    for entry in new.entries:
        if isinstance(entry, Alternatives):
            all_keys = {key for keys in entry.names for key in keys}
            given = written if all_keys & written.keys() else found
            way = entry.names[way_of(entry, given)]
            found = {k: value for k, value in found.items() if k in way or k not in all_keys}
    return found
