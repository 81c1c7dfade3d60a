"""What files a document from a browser may name."""

from collections.abc import Mapping
from typing import Any

from softafm.checks.refusals import ConfigError, show

_SEPARATORS = ("/", "\\", ":", "\0")


def refuse_paths(document: Mapping[str, Any]) -> None:
    """Raise ConfigError if a ``file`` anywhere in a document is more than a plain name."""
    lines = [
        f"{path} = {show(name)}: must be the plain name of a file that was uploaded"
        for path, name in _find_files(document, "")
        if name in (".", "..") or any(mark in name for mark in _SEPARATORS)
    ]
    if lines:
        raise ConfigError(lines)


def _find_files(thing: Any, path: str):
    """Yield every text under a key ``file``, with its place."""
    if isinstance(thing, Mapping):
        for key, value in thing.items():
            inner = f"{path}.{key}" if path else str(key)
            if key == "file" and isinstance(value, str):
                yield inner, value
            yield from _find_files(value, inner)
    elif isinstance(thing, list):
        for index, value in enumerate(thing):
            yield from _find_files(value, f"{path}[{index}]")
