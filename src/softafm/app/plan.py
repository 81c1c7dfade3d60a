"""The plan of the form as the browser draws it: sections, rows and fields, in plain data."""

import re
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from softafm.app.documents import find_value
from softafm.app.form import (
    Alternatives,
    Field,
    Section,
    describe_section,
    list_tables,
    read_preset_titles,
)
from softafm.modes import MODES

_ADVANCED = ("solver", "run")


class Shown(NamedTuple):
    """A section on the page: where its table is in the document, and which ways are taken.

    ``others`` are fields of ways that are not taken, which the document holds all the same.
    """

    path: str
    section: Section
    ways: dict[Alternatives, int]
    others: tuple[Field, ...]

    @property
    def fields(self) -> dict[str, Field]:
        """The fields to be filled, by name: those of the ways taken, and all that have no other."""
        found = {}
        for entry in self.section.entries:
            fields = entry.ways[self.ways[entry]] if isinstance(entry, Alternatives) else (entry,)
            found.update({field.name: field for field in fields})
        return found

    @property
    def inputs(self) -> dict[str, Field]:
        """All fields on the page, by path in the document."""
        fields = (*self.fields.values(), *self.others)
        return {f"{self.path}.{field.name}": field for field in fields}


def list_sections(
    document: Mapping[str, Any], preferred: Mapping[tuple[str, int], int]
) -> list[Shown]:
    """Return the sections of a document, each part of a sum of laws after its surface.

    ``preferred`` are ways by path of the section and number of the alternatives, which count where
    the document does not say otherwise.
    """
    mode = document.get("mode")
    found = []
    for table in list_tables(mode):
        found.append(_choose_shown(table, table, document, preferred))
        if "parts" in found[-1].section.fields:
            for index in range(_count_parts(find_value(document, f"{table}.parts"))):
                path = f"{table}.parts[{index}]"
                found.append(_choose_shown(path, f"{table}.parts", document, preferred))
    return found


def _count_parts(parts: Any) -> int:
    return len(parts) if isinstance(parts, list) else 0


def _choose_shown(
    path: str, table: str, document: Mapping[str, Any], preferred: Mapping[tuple[str, int], int]
) -> Shown:
    written = find_value(document, path)
    written = written if isinstance(written, dict) else {}
    mode = document.get("mode")
    shape = describe_section(table, written.get(describe_section(table, None, mode).chooser), mode)
    ways = {}
    for index, entry in enumerate(_list_alternatives(shape)):
        ways[entry] = find_way(entry, written, preferred.get((path, index), 0))
    taken = Shown(path, shape, ways, ()).fields
    others = (field for name, field in shape.fields.items() if name in written)
    return Shown(path, shape, ways, tuple(field for field in others if field.name not in taken))


def _list_alternatives(shape: Section) -> Iterator[Alternatives]:
    return (entry for entry in shape.entries if isinstance(entry, Alternatives))


def find_way(alternatives: Alternatives, given: Mapping[str, Any], preferred: int = 0) -> int:
    """Return the way of which most keys are given, of several the preferred or the first one."""
    counts = [sum(key in given for key in way) for way in alternatives.names]
    preferred = preferred if preferred < len(counts) else 0
    return preferred if counts[preferred] == max(counts) else counts.index(max(counts))


def make_plan(shown: list[Shown], largest_upload: int) -> dict[str, Any]:
    """Return what the browser needs to draw the form, whatever its fields hold."""
    return {
        "largest": largest_upload,
        "modes": tuple(MODES),
        "presets": list(read_preset_titles().items()),
        "sections": [_plan_section(one) for one in shown],
    }


def make_css_name(path: str) -> str:
    """Return a path as it stands in names of CSS classes: ``surface-parts-0-law``."""
    return re.sub(r"\W+", "-", path).strip("-")


def _plan_section(one: Shown) -> dict[str, Any]:
    shape = one.section
    rows: list[dict[str, Any]] = []
    for entry in shape.entries:
        if isinstance(entry, Alternatives):
            rows += _plan_alternatives(one, entry)
        else:
            rows.append(_plan_row(one.path, entry))
    part = "." in shape.table
    only = (shape.choice,) == shape.choices
    return {
        "path": one.path,
        "name": make_css_name(one.path),
        "title": "law" if part else shape.table,
        "part": part,
        "advanced": shape.table in _ADVANCED,
        "choices": () if only or not shape.chooser else shape.choices,
        "choice": shape.choice,
        "help": shape.help,
        "rows": [*rows, *(_plan_row(one.path, field) for field in one.others)],
    }


def _plan_alternatives(one: Shown, entry: Alternatives) -> list[dict[str, Any]]:
    """Return the row to choose a way, and its fields; a single field and its choice are one row."""
    index = list(one.ways).index(entry)
    choice = {"alternatives": index, "ways": entry.labels, "way": one.ways[entry]}
    rows = [_plan_row(one.path, field) for field in entry.ways[one.ways[entry]]]
    if all(len(way) == 1 for way in entry.ways):
        return [rows[0] | choice]
    return [{"kind": "ways", "name": f"{make_css_name(one.path)}-{index}", **choice}, *rows]


def _plan_row(path: str, field: Field) -> dict[str, Any]:
    return {
        "path": f"{path}.{field.name}",
        "name": make_css_name(f"{path}.{field.name}"),
        "label": field.label,
        "kind": field.kind,
        "help": field.help,
        "required": field.required,
        "example": _choose_placeholder(field),
        "choices": field.choices,
        "default": field.default,
    }


def _choose_placeholder(field: Field) -> str:
    """Return what an empty field shows."""
    if field.default:
        return f"{field.default} by default"
    example = field.example or "a number"
    if field.kind == "list":
        example = f"{example}, {example}, ..."
    return f"such as {example}" if field.required else f"optional, such as {example}"
