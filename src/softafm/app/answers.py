"""What becomes of a document when another mode, choice or way is chosen in the form.

``memory`` holds by path what fields held that are no longer there; each function adds to it.
"""

from collections.abc import Mapping, MutableMapping
from typing import Any

from softafm.app.documents import find_value, replace_value
from softafm.app.form import Alternatives, Section, describe_section, list_tables
from softafm.app.plan import Shown, find_way

_MOST_PARTS = 20
Memory = MutableMapping[str, Any]


def choose(
    document: Mapping[str, Any], shown: Shown, choice: str, memory: Memory
) -> dict[str, Any]:
    """Return the document with another choice in a section; KeyError if there is no such choice."""
    old, chooser = shown.section, shown.section.chooser
    if choice not in old.choices:
        raise KeyError(choice)
    written = _find_table(document, shown.path)
    new = describe_section(old.table, choice, document.get("mode"))
    made: dict[str, Any] = {} if choice == new.default else {chooser: choice}
    made |= _fill(shown.path, new, written, memory)
    laws = [part for part in written.get("parts", ()) if isinstance(part, dict)]
    if "parts" in new.fields and "parts" not in made:
        made["parts"] = [written]
    made |= next((law for law in laws if law.get(chooser) == choice), {})
    return replace_value(document, shown.path, made)


def change_mode(document: Mapping[str, Any], mode: str, memory: Memory) -> dict[str, Any]:
    """Return the document with another mode, its motion and its lever as that mode has them."""
    changed = {**document, "mode": mode}
    motion = _find_table(document, "motion")
    shape = motion.get("shape")
    shape = shape if shape in describe_section("motion", None, mode).choices else None
    made = {} if shape is None else {"shape": shape}
    made |= _fill("motion", describe_section("motion", shape, mode), motion, memory)
    changed["motion"] = made
    lever = _find_table(document, "cantilever")
    changed.pop("cantilever", None)
    if "cantilever" in list_tables(mode):
        changed["cantilever"] = _fill(
            "cantilever", describe_section("cantilever", None, mode), lever, memory
        )
    else:
        _remember("cantilever", lever, memory)
    return changed


def take_way(
    document: Mapping[str, Any], path: str, alternatives: Alternatives, way: int, memory: Memory
) -> dict[str, Any]:
    """Return the document with a table's alternatives given in another way."""
    written = _find_table(document, path)
    _remember(path, written, memory)
    all_keys = {key for keys in alternatives.names for key in keys}
    kept = {key: value for key, value in written.items() if key not in all_keys}
    wanted = {key: memory.get(f"{path}.{key}") for key in alternatives.names[way]}
    given = {key: value for key, value in wanted.items() if value is not None}
    return replace_value(document, path, kept | given)


def add_part(document: Mapping[str, Any]) -> dict[str, Any]:
    """Return the document with one more part of its sum of laws, unless there are very many."""
    parts = find_value(document, "surface.parts")
    parts = parts if isinstance(parts, list) else []
    more = [*parts, {}] if len(parts) < _MOST_PARTS else parts
    return replace_value(document, "surface.parts", more)


def _find_table(document: Mapping[str, Any], path: str) -> dict[str, Any]:
    written = find_value(document, path)
    return dict(written) if isinstance(written, dict) else {}


def _remember(path: str, written: Mapping[str, Any], memory: Memory) -> None:
    memory.update({f"{path}.{key}": value for key, value in written.items()})


def _fill(path: str, new: Section, written: Mapping[str, Any], memory: Memory) -> dict[str, Any]:
    """Return what fields of a section are filled with: what is written, or was before."""
    _remember(path, written, memory)
    found = {key: memory[f"{path}.{key}"] for key in new.fields if f"{path}.{key}" in memory}
    for entry in new.entries:
        if isinstance(entry, Alternatives):
            all_keys = {key for keys in entry.names for key in keys}
            given = written if all_keys & written.keys() else found
            way = entry.names[find_way(entry, given)]
            found = {k: value for k, value in found.items() if k in way or k not in all_keys}
    return found
