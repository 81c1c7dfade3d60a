"""What the form asks for, generated from the tables of an experiment file."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from inspect import Parameter, signature
from typing import Any, get_args

from softafm.app.help_texts import find_help, find_summary
from softafm.experiment import schema
from softafm.experiment.config import list_examples, parse_document, read_example
from softafm.experiment.entries import Input
from softafm.modes import MODES
from softafm.units.quantities import choose_prefix

_SYMBOLS = {
    "E0": "E₀", "E1": "E₁", "E_inf": "E∞", "G0": "G₀", "G_inf": "G∞", "z0": "z₀",
    "hamaker": "Hamaker constant", "debye_length": "Debye length", "poisson": "Poisson's ratio",
}  # fmt: skip
"""Labels of keys that are no plain words."""

_TYPICAL = "ldpe-tapping"
"""The bundled experiment from which examples are taken first."""

_WITHOUT_DEFAULT = ("tip", "sample", "surface", "surface.parts")
"""Tables that must say what they choose; the others stand for the first choice if they do not."""


@dataclass(frozen=True)
class Field:
    """A key of a table, and how its value is written.

    ``kind`` and ``unit`` are as in ``softafm.experiment.entries.Input``; ``example`` and
    ``default`` are texts, "" if there is none; ``help`` is the meaning, with SI unit and bounds.
    """

    name: str
    label: str
    kind: str
    example: str
    help: str
    required: bool
    default: str = ""
    choices: tuple[str, ...] = ()
    unit: str = ""


@dataclass(frozen=True)
class Alternatives:
    """Groups of fields, ``ways``, of which one is to be given."""

    ways: tuple[tuple[Field, ...], ...]

    @property
    def names(self) -> tuple[tuple[str, ...], ...]:
        """The keys of each way."""
        return tuple(tuple(field.name for field in way) for way in self.ways)

    @property
    def labels(self) -> tuple[str, ...]:
        """What each way is called."""
        return tuple(", ".join(field.label for field in way) for way in self.ways)


@dataclass(frozen=True)
class Section:
    """What the form asks for one table, made as one of its choices.

    ``chooser`` is the key that chooses, "" if there is nothing to choose, and ``default`` the
    choice that a table without this key stands for. ``entries`` are fields, and alternatives where
    the first of their keys stands. ``choice`` is "" if it is not among ``choices``.
    """

    table: str
    chooser: str = ""
    choices: tuple[str, ...] = ()
    choice: str = ""
    default: str = ""
    help: str = ""
    entries: tuple[Field | Alternatives, ...] = ()

    @property
    def fields(self) -> dict[str, Field]:
        """All fields by name, of all alternatives; of several of one name the first."""
        found: dict[str, Field] = {}
        for entry in self.entries:
            ways = entry.ways if isinstance(entry, Alternatives) else ((entry,),)
            for way in ways:
                for field in way:
                    found.setdefault(field.name, field)
        return found


def read_presets() -> dict[str, dict[str, Any]]:
    """Return the bundled experiments by name, as documents of their own without empty tables."""
    files = {name: parse_document(read_example(name), name) for name in list_examples()}
    return {
        name: {key: value for key, value in document.items() if value != {}}
        for name, document in files.items()
    }


@cache
def read_preset_titles() -> dict[str, str]:
    """Return what each bundled experiment is about, by name."""
    return {name: read_example(name).partition("\n")[0].lstrip("# ") for name in list_examples()}


def list_tables(mode: object) -> tuple[str, ...]:
    """Return the tables that a mode has, in the order of the form and of a file."""
    known = MODES.get(str(mode))
    lever = ("cantilever",) if known is not None and known.lever else ()
    further = () if known is None else tuple(known.tables)
    return ("tip", "sample", "surface", *lever, "motion", *further, "solver", "run")


def describe_section(table: str, choice: object, mode: object) -> Section:
    """Return what the form asks for a table in a mode.

    ``choice`` is what the document says, None if nothing. ``table`` may be ``"surface.parts"``, one
    of a sum. A mode that does not exist has no motion to choose.
    """
    chooser, choices = _find_choices(table, mode)
    default = next(iter(choices), "") if table not in _WITHOUT_DEFAULT else ""
    chosen = default if choice is None else choice
    if not isinstance(chosen, str) or chosen not in choices:
        return Section(table, chooser, tuple(choices), "", default)
    made = choices[chosen]
    text = find_summary(made) if chooser else ""
    return Section(
        table, chooser, tuple(choices), chosen, default, text, _describe_entries(table, made)
    )


def _find_choices(table: str, mode: object) -> tuple[str, Mapping[str, type[schema.Table]]]:
    """Return the key of a table that chooses, "" if none does, and what there is to choose."""
    if table == "run":
        return "", {"": schema.Run}
    if table == "cantilever":
        made = schema.cantilever_of(MODES[str(mode)])
        return "", {} if made is None else {"": made}
    known = MODES.get(str(mode))
    if known is not None and table in known.tables:
        return "", {"": schema.table_of(known.tables[table])}
    if table == "motion":
        return "shape", {} if known is None else schema.motions_of(known)
    chooser, choices = schema.CHOICES[table.partition(".")[0]]
    if table == "surface.parts":
        choices = {name: law for name, law in choices.items() if law is not schema.SumSurface}
    return chooser, choices


@cache
def _describe_entries(table: str, made: type[schema.Table]) -> tuple[Field | Alternatives, ...]:
    alternatives_of = {key: ways for ways in made.alternatives for way in ways for key in way}
    entries: list[Field | Alternatives] = []
    seen: set[Any] = set()
    for key in made.model_fields:
        ways = alternatives_of.get(key)
        if ways is None:
            entries.append(_describe_field(table, made, key))
        elif ways not in seen:
            seen.add(ways)
            entries.append(_describe_alternatives(table, made, ways))
    return tuple(entries)


def _describe_alternatives(
    table: str, made: type[schema.Table], ways: tuple[tuple[str, ...], ...]
) -> Alternatives:
    # A thing's alternatives are its constructors, one a way, which may mean different things by
    # keys of one name; those of other tables are documented by everything the table builds.
    makers = made.constructors if issubclass(made, schema.Thing) else (None,) * len(ways)
    pairs = zip(ways, makers, strict=True)
    return Alternatives(
        tuple(
            tuple(_describe_field(table, made, key, maker) for key in way) for way, maker in pairs
        )
    )


def _describe_field(
    table: str, made: type[schema.Table], key: str, constructor: Callable | None = None
) -> Field:
    asked = _find_input(made, key)
    required = constructor is not None or made.model_fields[key].is_required()
    required = required or any(key in way for ways in made.alternatives for way in ways)
    return Field(
        name=key,
        label=_SYMBOLS.get(key, key.replace("_", " ")),
        kind=asked.kind,
        example=_collect_examples().get((table, key), asked.example),
        help=find_help(made, key, constructor),
        required=required,
        default="" if required else _write_default(_find_default(made, key), asked),
        choices=asked.choices,
        unit=asked.unit,
    )


def _find_input(made: type[schema.Table], key: str) -> Input:
    """Return how a key is written: what its type, or the optional one of it, carries."""
    info = made.model_fields[key]
    marks = list(info.metadata)
    for inner in get_args(info.annotation):
        marks += getattr(inner, "__metadata__", ())
    return next(mark for mark in marks if isinstance(mark, Input))


def _find_default(made: type[schema.Table], key: str) -> Any:
    """Return the value that counts for a key that is left out, None if there is none."""
    if issubclass(made, schema.Solver):
        return getattr(made.solver(), key)
    if issubclass(made, schema.Thing):
        for constructor in made.constructors:
            parameter = signature(constructor).parameters.get(key)
            if parameter is not None and parameter.default is not Parameter.empty:
                return parameter.default
    return made.model_fields[key].default


def _write_default(value: Any, asked: Input) -> str:
    """Return a default as a user would write it; "" for None."""
    if value is None:
        return ""
    if asked.kind == "flag":
        return "true" if value else "false"
    if asked.kind == "choice":
        written = {choice: made for choice, made in schema.STEPPERS.items() if made == value}
        return next(iter(written), str(value))
    if asked.unit:
        factor, unit = choose_prefix(abs(value), asked.unit)
        return f"{value * factor:.6g} {unit}"
    return f"{value:g}" if isinstance(value, float) else str(value)


@cache
def _collect_examples() -> dict[tuple[str, str], str]:
    """Return by table and key how a bundled experiment writes a value: the best of examples."""
    seen: dict[tuple[str, str], str] = {}
    typical_first = sorted(read_presets().items(), key=lambda preset: preset[0] != _TYPICAL)
    for _, document in typical_first:
        for table, written in document.items():
            if isinstance(written, dict):
                for key, value in written.items():
                    seen.setdefault((table, key), str(value))
    return seen
