"""What a sweep is to do: the table ``[sweep]`` of a campaign file, or arguments in its place."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path
from typing import Any

from softafm.checks.refusals import ConfigError, join_with_or, show, suggest
from softafm.experiment.fields import Field, find_field, make_plain_field
from softafm.experiment.takers import refuse_unless
from softafm.modes import MODES
from softafm.sweeps.campaign import (
    Campaign,
    plan_calls,
    plan_experiments,
)
from softafm.sweeps.designs import make_design


@dataclass(frozen=True)
class Table:
    """The keys of ``[sweep]``, None where nothing was said."""

    vary: Mapping[Any, Any] | None = None
    design: str | None = None
    samples: int | None = None
    seed: int | None = None
    observables: Sequence[str] | None = None
    batch: int | None = None

    def over(self, other: "Table") -> "Table":
        """Return the table of what this one says, and where it says nothing the other."""
        names = [field.name for field in fields(self)]
        return Table(
            **{
                name: getattr(other if getattr(self, name) is None else self, name)
                for name in names
            }
        )


def read_table(written: Any) -> Table:
    """Read ``[sweep]``; ConfigError if it has other keys, or values of another kind."""
    if not isinstance(written, Mapping):
        raise ConfigError([f"sweep = {show(written)}: must be a table, [sweep]"])
    known = [*(field.name for field in fields(Table)), "together"]
    for key in written:
        if key not in known:
            raise ConfigError([f"sweep.{key}: unknown key; {suggest(key, known)}"])
    kinds: dict[str, tuple[Any, str]] = {
        "vary": (Mapping, "a table, [sweep.vary]"),
        "together": (list, "tables, [[sweep.together]]"),
        "observables": (list, "a list of names"),
        "batch": (int, "a whole number"),
    }
    for key, (kind, valid) in kinds.items():
        if key in written and not isinstance(written[key], kind):
            raise ConfigError([f"sweep.{key} = {show(written[key])}: must be {valid}"])
    values = {key: value for key, value in written.items() if key != "together"}
    vary: dict[Any, Any] = dict(_flatten(written.get("vary", {})))
    for index, group in enumerate(written.get("together", [])):
        if not isinstance(group, Mapping) or not group:
            raise ConfigError(
                [f"sweep.together[{index}] = {show(group)}: must be a table of fields and values"]
            )
        group = dict(_flatten(group))
        vary[tuple(group)] = list(group.values())
    if "vary" in written or "together" in written:
        values["vary"] = vary
    return Table(**values)


def _flatten(tables: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield paths and values, of tables within tables, too: TOML makes them of bare keys."""
    for key, value in tables.items():
        name = f"{path}.{key}" if path else key
        if isinstance(value, Mapping) and not {"from", "to"} & set(value) and value:
            yield from _flatten(value, name)
        else:
            yield name, value


def make_campaign(
    what: Mapping[str, Any] | Callable[..., Any], folder: Path, table: Table, from_file: bool
) -> Campaign:
    """Return the campaign of an experiment's document, or of a function, having tried it.

    Raises
    ------
    ConfigError
        One line for each problem.
    """
    if table.vary is None:
        if isinstance(what, Mapping):
            refuse_unless({**what, "sweep": {}}, "sweep")
        raise ConfigError(
            [
                "sweep.vary: missing; add a table [sweep.vary] of fields and values ('softafm run' "
                "runs an experiment without it)"
            ]
        )
    if isinstance(table.observables, str):
        raise ConfigError([f"sweep.observables = {show(table.observables)}: must be a list"])
    kind, seed = table.design or "grid", table.seed or 0
    design = partial(make_design, kind, table.vary, samples=table.samples, seed=seed)
    if callable(what):
        return plan_calls(what, design(make_plain_field), table.observables)
    mode = what.get("mode")
    if mode is None:
        raise ConfigError([f"mode: missing; must be {join_with_or(list(MODES))}"])
    if not isinstance(mode, str) or mode not in MODES:
        raise ConfigError([f"mode = {show(mode)}: {suggest(mode, list(MODES))}"])
    paths = [p for key in table.vary for p in (key if isinstance(key, tuple) else (key,))]
    field = partial(_find_field, what, paths, folder, not from_file)
    taken = [*MODES[mode].observed, *MODES[mode].axes.dims, "sample"]
    return plan_experiments(what, folder, design(field, taken=taken), table.observables)


def _find_field(
    document: Mapping[str, Any], varied: list[str], folder: Path, bare: bool, path: str
) -> Field:
    return find_field(document, path, varied, folder, bare)
