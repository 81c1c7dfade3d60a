"""Fields of an experiment file by their path, such as ``sample.E_inf``: unit, and how they read."""

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, get_args, get_origin

from pydantic import TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from softafm.checks.refusals import join_with_or, show, suggest
from softafm.experiment import schema
from softafm.experiment.entries import Input
from softafm.modes import MODES, Mode

Keys = tuple[str | int, ...]

_PATH = re.compile(r"\w+(?:\[\d+\])?(?:\.\w+(?:\[\d+\])?)+")
_CHOOSERS = {**{name: chooser for name, (chooser, _) in schema.CHOICES.items()}, "motion": "shape"}


@dataclass(frozen=True)
class Field:
    """A field that can be varied.

    Attributes
    ----------
    path
        As the user writes it, ``"sample.E_inf"`` or ``"sample.moduli[1]"``.
    unit
        SI unit of its values, "" if they have none.
    read
        Turns what a user wrote into a value in SI; ValueError says what would be valid.
    """

    path: str
    unit: str
    read: Callable[[Any], Any]

    def written(self, value: Any) -> Any:
        """Return a value in SI as an experiment file has it; it is read back to the last bit."""
        return f"{value!r} {self.unit}" if self.unit and isinstance(value, float) else value


def make_plain_field(name: str) -> Field:
    """Return a field of a Python function: numbers, texts or flags without unit."""

    def read(value: Any) -> Any:
        if not isinstance(value, bool | int | float | str):
            raise ValueError("must be a number, a text, True or False")
        return value

    return Field(name, "", read)


def split_path(path: str) -> Keys:
    """Return the keys that lead to a field: names of tables, and numbers of a list's entries."""
    if not _PATH.fullmatch(path):
        raise ValueError("must be a table and a key, such as 'sample.E_inf'")
    return tuple(int(k) if k.isdigit() else k for k in re.split(r"[.\[\]]+", path) if k)


def replace_value(tree: Any, keys: Keys, value: Any) -> Any:
    """Return a copy of nested tables and lists in which one value is another."""
    if not keys:
        return value
    key, *rest = keys
    if isinstance(key, int):
        if not isinstance(tree, list) or key >= len(tree):
            raise ValueError(f"has no entry [{key}]")
        return [*tree[:key], replace_value(tree[key], tuple(rest), value), *tree[key + 1 :]]
    if not isinstance(tree, Mapping):
        raise ValueError(f"is a value and has no '{key}'")
    return {**tree, key: replace_value(tree.get(key, {}), tuple(rest), value)}


def find_field(
    document: Mapping[str, Any], path: str, varied: Collection[str], folder: Path, bare: bool
) -> Field:
    """Return the field of an experiment at a path; ``varied`` are the paths of all that vary.

    With ``bare`` its values may be SI numbers as well as texts with units.

    Raises
    ------
    ValueError
        If there is no such field; the message says which there are.
    """
    if path == "mode":
        raise ValueError("cannot vary within a sweep, as every mode observes something else")
    table, *keys = split_path(path)
    name = str(table)
    mode = MODES[document["mode"]]
    known = ["tip", "sample", "surface", "motion", "solver", "run"]
    known += [*(["cantilever"] if mode.lever else []), *mode.tables]
    if name not in known:
        raise ValueError(f"no table of this experiment; {suggest(name, known)}")
    chooser, choices = _find_choices(name, mode)
    written = document.get(name, {})
    # The parts of a sum of laws are tables of their own.
    while len(keys) > 2 and keys[0] == "parts" and isinstance(keys[1], int):
        parts = written.get("parts", [])
        if keys[1] >= len(parts):
            raise ValueError(f"there are {len(parts)} parts")
        name, written, keys = f"{name}.parts[{keys[1]}]", parts[keys[1]], keys[2:]
    if keys == [chooser]:
        return Field(path, "", _make_choice_reader(list(choices)))
    tables = _find_tables(choices, written.get(chooser), f"{name}.{chooser}" in varied)
    found = [table.model_fields[keys[0]] for table in tables if keys[0] in table.model_fields]
    if not found:
        names = [key for table in tables for key in table.model_fields]
        raise ValueError(f"unknown key; {suggest(keys[0], [*dict.fromkeys(names), chooser])}")
    return _make_field(path, found[0], keys[1:], folder, bare)


def _find_choices(name: str, mode: Mode) -> tuple[str, Mapping[str, Any]]:
    """Return the key of a table that chooses, "" if none does, and what it chooses from."""
    if name == "run":
        return "", {"": schema.Run}
    if name == "cantilever":
        return "", {"": schema.cantilever_of(mode)}
    if name in mode.tables:
        return "", {"": schema.table_of(mode.tables[name])}
    if name == "motion":
        return "shape", schema.motions_of(mode)
    return schema.CHOICES[name]


def _find_tables(choices: Mapping[str, Any], choice: Any, varies: bool) -> Sequence[Any]:
    """Return the tables that a field may be of."""
    if varies or (choice is not None and choice not in choices):
        return list(choices.values())
    return [choices[choice] if choice is not None else next(iter(choices.values()))]


def _make_choice_reader(choices: list[str]) -> Callable[[Any], str]:
    def read(written: Any) -> str:
        if not isinstance(written, str) or written not in choices:
            raise ValueError(f"must be {join_with_or(choices)}")
        return written

    return read


def _make_field(
    path: str, info: FieldInfo, entry: Sequence[Any], folder: Path, bare: bool
) -> Field:
    """Return the field that a model's field is, or with ``[i]`` an entry of a list."""
    kind: Any = info.annotation
    if info.metadata:
        kind = Annotated[(kind, *info.metadata)]
    asked = _find_input(kind)
    if entry:
        if asked is None or asked.kind != "list" or len(entry) > 1:
            raise ValueError("is no list of values")
        kind = get_args(_strip_annotation(kind))[0]
    elif asked is not None and asked.kind == "tables":
        raise ValueError("is a list of tables; vary a key of one, such as surface.parts[0].z0")
    whole_list = asked is not None and asked.kind == "list" and not entry
    unit = "" if asked is None or whole_list else asked.unit
    adapter = TypeAdapter(kind)

    def read(written: Any) -> Any:
        number = isinstance(written, int | float) and not isinstance(written, bool)
        text = f"{float(written)!r} {unit}" if unit and bare and number else written
        try:
            value = adapter.validate_python(text, strict=True, context={"folder": folder})
        except ValidationError as invalid:
            error = invalid.errors(include_url=False)[0]
            raise ValueError(str(error.get("ctx", {}).get("error", error["msg"]))) from None
        return value if isinstance(value, bool | int | float) else written

    return Field(path, unit, read)


def _find_input(kind: Any) -> Input | None:
    """Return how a form would ask for a value of a type."""
    if get_origin(kind) is Annotated:
        for extra in kind.__metadata__:
            if isinstance(extra, Input):
                return extra
        return _find_input(get_args(kind)[0])
    return next((found for arg in get_args(kind) if (found := _find_input(arg))), None)


def _strip_annotation(kind: Any) -> Any:
    """Return the tuple type within an annotated or optional one."""
    while get_origin(kind) is not tuple:
        kind = next(arg for arg in get_args(kind) if arg is not type(None))
    return kind


def reword(path: str, index: int | None, value: Any, reason: object) -> str:
    """Word the refusal of a value of a sweep."""
    entry = "" if index is None else f"[{index}]"
    return f"sweep.vary.'{path}'{entry} = {show(value)}: {reason}"
