"""TOML of others: parsed in a bounded time, into tables of a bounded depth and number."""

import re
import tomllib
from typing import Any

_DEEPEST, _MOST_KEYS, _MOST_VALUES = 16, 2000, 200_000
_KEY = r"""(?:[\w-]+|"[^"\n]*"|'[^'\n]*')"""
_LONG_KEY = re.compile(rf"""(?<![\w-]){_KEY}(?:[ \t]*\.[ \t]*{_KEY}){{{_DEEPEST}}}""")
"""A key of many parts: ``tomllib`` takes 90 s for one of 100 kB."""


def parse(text: str) -> dict[str, Any]:
    """Return the tables of a text; ValueError, in one line, if it is no TOML or more than may be.

    Experiment, campaign and map files are five tables deep at most.
    """
    if _LONG_KEY.search(text):
        raise ValueError(f"has a key of more than {_DEEPEST} parts")
    try:
        tables = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        reason = "nested too deeply" if isinstance(error, RecursionError) else error
        raise ValueError(f"is not valid TOML: {reason}") from None
    _refuse_excess(tables)
    return tables


def parse_apart(text: str) -> tuple[dict[str, Any], list[Any]]:
    """Return what ``parse`` does for ``softafm.files.guard``; dates, which none needs, as texts."""
    return _plain(parse(text)), []


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_plain(each) for each in value]
    return value if isinstance(value, str | int | float) else str(value)


def _refuse_excess(tables: dict[str, Any]) -> None:
    level: list[Any] = [tables]
    keys = values = 0
    for _ in range(_DEEPEST):
        within: list[Any] = []
        for each in level:
            keys += len(each) if isinstance(each, dict) else 0
            within += each.values() if isinstance(each, dict) else each
        values += len(within)
        if keys > _MOST_KEYS:
            raise ValueError(f"has {keys} keys: at most {_MOST_KEYS}")
        if values > _MOST_VALUES:
            raise ValueError(f"has {values} values: at most {_MOST_VALUES}")
        level = [each for each in within if isinstance(each, dict | list)]
    if level:
        raise ValueError(f"is nested more than {_DEEPEST} deep")
