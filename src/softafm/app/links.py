"""A document as the query of a link, ``mode=tapping-cycle&tip.radius=10+nm...``, and back."""

import re
from collections.abc import Iterator, Mapping
from json import dumps
from typing import Any
from urllib.parse import parse_qsl, urlencode

from softafm.checks.refusals import ConfigError
from softafm.experiment.config import parse_value, set_value

LONGEST = 16_000
_MOST_VALUES = 200
_BARE = re.compile(r"[A-Za-z0-9_-]+")


def write_query(document: Mapping[str, Any]) -> str:
    """Return a document as the query of a link, without the question mark.

    Text stands for itself; what is not text, or would be read as a number, is written as in TOML.

    Raises
    ------
    ConfigError
        If it is too long for a link.
    """
    query = urlencode(list(_list_pairs(document)), safe="/:,")
    if len(query) > LONGEST:
        raise ConfigError(
            [f"the link would have {len(query)} characters, at most {LONGEST}: use the TOML file"]
        )
    return query


def read_query(query: str) -> dict[str, Any]:
    """Return the document of a link's query.

    Raises
    ------
    ConfigError
        If it is too long or ``write_query`` does not write such; what the values mean is not
        checked.
    """
    if len(query) > LONGEST:
        raise ConfigError([f"the link has {len(query)} characters, at most {LONGEST}"])
    try:
        pairs = parse_qsl(
            query.removeprefix("?"),
            keep_blank_values=True,
            strict_parsing=True,
            errors="strict",
            max_num_fields=_MOST_VALUES,
        )
    except ValueError as error:
        raise ConfigError([f"the link cannot be read: {error}"]) from None
    document: dict[str, Any] = {}
    names = [name for name, _ in pairs]
    for name, text in pairs:
        if names.count(name) > 1:
            raise ConfigError([f"the link has {name} more than once"])
        set_value(document, f"{name}={text}")
    return document


def _list_pairs(document: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    for name, value in document.items():
        if isinstance(value, Mapping) and value and all(map(_BARE.fullmatch, value)):
            for key, inner in value.items():
                yield f"{name}.{key}", _write_value(inner)
        else:
            yield name, _write_value(value)


def _write_value(value: Any) -> str:
    """Return text as it is where it is read back as such, and anything else as in TOML."""
    if isinstance(value, str) and value == value.strip() and parse_value(value) == value:
        return value
    return _write_toml(value)


def _write_toml(value: Any) -> str:
    if isinstance(value, Mapping):
        entries = (f"{_quote(key)}={_write_toml(inner)}" for key, inner in value.items())
        return "{" + ",".join(entries) + "}"
    if isinstance(value, list | tuple):
        return "[" + ",".join(map(_write_toml, value)) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return _quote(value, bare=False) if isinstance(value, str) else str(value)


def _quote(text: str, bare: bool = True) -> str:
    if bare and _BARE.fullmatch(text):
        return text
    return dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
