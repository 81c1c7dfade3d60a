"""How an experiment file is refused: one line that names field, value and what would be valid."""

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pydantic import BaseModel

from softafm.checks.suggestions import guess

_LONGEST_SHOWN = 60
_MOST_LISTED = 50
_OTHER_NAMES = {
    "W": ("work_of_adhesion",),
    "E0": ("G0",),
    "E_inf": ("G_inf",),
    "creep_time": ("relaxation_time",),
    "moduli": ("shear_moduli", "ratios"),
}
"""What a constructor calls a value that the user may have written under another key."""


class ConfigError(ValueError):
    """An experiment file or an override that cannot be used: one line for each problem."""

    def __init__(self, problems: Sequence[str]):
        lines = [_escape(problem) for problem in problems[:_MOST_LISTED]]
        if len(problems) > _MOST_LISTED:
            lines.append(f"and {len(problems) - _MOST_LISTED} more like these")
        super().__init__("\n".join(lines))


def describe_problems(
    name: str, model: "type[BaseModel]", error: Any, valid: list[str]
) -> list[str]:
    """Put one of pydantic's errors into sentences: one, or those of a table within the table."""
    inner = error.get("ctx", {}).get("error")
    if isinstance(inner, ConfigError):
        return [f"{name}.{line}" for line in str(inner).splitlines()]
    return [_describe_problem(name, model, error, valid)]


def _describe_problem(name: str, model: "type[BaseModel]", error: Any, valid: list[str]) -> str:
    key = error["loc"][0]
    path = f"{name}.{key}" + "".join(f"[{index}]" for index in error["loc"][1:])
    if error["type"] == "extra_forbidden":
        return refuse_unknown(key, valid, f"{name}.{key}")
    if error["type"] == "missing":
        what = model.model_fields[key].description
        return f"{path}: missing" + (f"; must be {what}" if what else "")
    reason = str(error.get("ctx", {}).get("error", error["msg"]))
    return f"{path} = {show(error['input'])}: {reason}"


def reword(table: str, written: Mapping[str, Any], error: Exception) -> str | None:
    """Reword an object's refusal, ``field = value unit: reason``, with what the user wrote.

    None if it names no field of the table.
    """
    match = re.match(r"(\w+)(?:\[(\d+)\])?(?: = [^:]*:)? (.*)", str(error), re.DOTALL)
    if match is None:
        return None
    name, index, reason = match.groups()
    name = _find_key(name, written)
    if name not in written:
        return None
    value = written[name]
    if index is not None and isinstance(value, list):
        name, value = f"{name}[{index}]", value[int(index)]

    def other(mention: re.Match[str]) -> str:
        key = _find_key(mention[1], written)
        return f"{table}.{key} = {show(written[key])}" if key in written else mention[0]

    reason = re.sub(r"(?<![\w/])(\w+) = [-+.\de]+ [^\s,;)]+", other, reason)
    reason = re.sub(r"(?<=as many as )\w+", lambda mention: _find_key(mention[0], written), reason)
    return f"{table}.{name} = {show(value)}: {reason}"


def _find_key(name: str, written: Mapping[str, Any]) -> str:
    """Return the key under which the user wrote what a constructor calls ``name``."""
    return next((key for key in (name, *_OTHER_NAMES.get(name, ())) if key in written), name)


def refuse_unknown(key: str, valid: Sequence[str], path: str) -> str:
    """Refuse a key that does not exist."""
    return f"{path[:_LONGEST_SHOWN]}: unknown key; {suggest(key, valid)}"


def suggest(given: object, valid: Sequence[str]) -> str:
    """Say which of the valid names was probably meant, or all of them."""
    text = given[:_LONGEST_SHOWN] if isinstance(given, str) else ""
    near = guess(text, valid)
    if near:
        return f"did you mean {join_with_or(near)}? It must be {join_with_or(valid)}"
    return f"must be {join_with_or(valid)}"


def join_with_or(names: Sequence[str]) -> str:
    """Return ``'a', 'b' or 'c'``."""
    quoted = [f"'{name}'" for name in names]
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} or {quoted[-1]}"


def join_with_and(names: Sequence[str]) -> str:
    """Return ``a, b and c``."""
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def show(value: object) -> str:
    """Return a value as the user would recognise it, cut to a legible length."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):
        return f"(a {type(value).__name__} too long to show)"
    return text if len(text) <= _LONGEST_SHOWN else text[: _LONGEST_SHOWN - 3] + "..."


def _escape(text: str) -> str:
    """Escape what would break or disturb the line."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)
