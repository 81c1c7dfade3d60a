"""Whether a folder is the store of a sweep as ``softafm`` writes it, before any of it is used.

A Zarr store names the code that decodes it, and the places of its parts: nothing that a sweep does
not write is handed on, neither to Zarr nor to xarray.
"""

import json
import re
from collections.abc import Mapping
from math import ceil, prod
from os import scandir
from pathlib import Path
from typing import Any, NamedTuple

from softafm.checks.refusals import show

FORMAT = "softafm sweep 1"
_LARGEST_TEXT = 50_000_000
_MOST_RUNS, _MOST_BLOCKS, _MOST_IN_BLOCK = 10**9, 10**7, 10**7
_MOST_ARRAYS, _MOST_DIMENSIONS = 1000, 16
_NUMBERS = re.compile(r"[<|][fiub][1248]|<U\d{1,4}")
_ATTRIBUTES = ("_ARRAY_DIMENSIONS", "units", "long_name", "flag_values", "flag_meanings")


class StoreError(ValueError):
    """A store that cannot be used as asked; the message says what can be done."""


class Metadata(NamedTuple):
    """What a store says of itself: attributes of its own and of its arrays, and their layout."""

    attributes: dict[str, Any]
    arrays: dict[str, dict[str, Any]]
    described: dict[str, dict[str, Any]]


def read_metadata(path: Path) -> Metadata:
    """Return what a store says of itself.

    Raises
    ------
    StoreError
        If it is not the store of a sweep, is damaged, or is such as no sweep writes.
    """
    try:
        return _collect_metadata(path)
    except StoreError as error:
        raise StoreError(f"{path}: {error}") from None
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise StoreError(f"{path}: is not the store of a sweep, or is damaged") from None


def _collect_metadata(path: Path) -> Metadata:
    if not path.exists():
        raise StoreError("no such store")
    if not all((path / name).is_file() for name in (".zattrs", ".zmetadata")):
        raise StoreError("is not the store of a sweep")
    attributes = _read_json(path / ".zattrs")
    found = _read_json(path / ".zmetadata")["metadata"]
    if attributes["format"] != FORMAT:
        raise StoreError("is not the store of a sweep")
    arrays = {key[:-8]: each for key, each in found.items() if key.endswith("/.zarray")}
    described = {name: found[f"{name}/.zattrs"] for name in arrays}
    _refuse(attributes, arrays, described)
    _refuse_links(path, arrays)
    return Metadata(attributes, arrays, described)


def _read_json(file: Path) -> dict[str, Any]:
    if file.stat().st_size > _LARGEST_TEXT:
        raise StoreError(f"{file.name} has more than {_LARGEST_TEXT / 1e6:g} MB")
    found = json.loads(file.read_text(encoding="utf-8"))
    if not isinstance(found, dict):
        raise TypeError
    return found


def _refuse(
    attributes: Mapping[str, Any], arrays: Mapping[str, Any], described: Mapping[str, Any]
) -> None:
    if len(arrays) > _MOST_ARRAYS:
        raise StoreError(f"has {len(arrays)} arrays: at most {_MOST_ARRAYS}")
    for key in ("campaign", "values"):
        if not isinstance(json.loads(attributes[key]), dict):
            raise StoreError(f"its {key} are no table")
    for name, array in arrays.items():
        _refuse_array(name, array, described[name])
    shape, block = arrays["state"]["shape"], arrays["state"]["chunks"]
    runs, blocks = prod(shape), prod(map(_count_blocks, shape, block))
    if not shape or not 0 < runs <= _MOST_RUNS or blocks > _MOST_BLOCKS:
        raise StoreError(f"has an absurd shape, {shape}")
    if prod(block) > _MOST_IN_BLOCK:
        raise StoreError(f"has blocks of {prod(block)} runs: at most {_MOST_IN_BLOCK}")
    kinds = {"state": "|u1", "reason": "|O", "warning": "|O"}
    kinds |= dict.fromkeys(map(str, attributes["observables"]), "<f8")
    for name, kind in kinds.items():
        if name not in arrays:
            raise StoreError(f"its array '{name}' is missing")
        array, depth = arrays[name], len(shape)
        fits = array["shape"][:depth] == shape and array["chunks"][:depth] == block
        if array["dtype"] != kind or not fits or array["shape"][depth:] != array["chunks"][depth:]:
            raise StoreError(f"its array '{name}' is not of the type or shape of its runs")
    for name, array in arrays.items():
        if name not in kinds and array["chunks"] != array["shape"]:
            raise StoreError(f"its coordinate '{name}' is split into parts")


def _count_blocks(size: int, block: int) -> int:
    return ceil(size / block)


def _refuse_array(name: str, array: Mapping[str, Any], attributes: Mapping[str, Any]) -> None:
    if not name.isprintable() or name.startswith(".") or re.search(r"[/\\:]", name):
        raise StoreError(f"has an array named {show(name)}")
    shape, chunks = array["shape"], array["chunks"]
    whole = all(type(size) is int and size >= 0 for size in shape)
    whole = whole and all((type(size) is int and size > 0) or size == 0 in shape for size in chunks)
    if not whole or len(shape) != len(chunks) or len(shape) > _MOST_DIMENSIONS:
        raise StoreError(f"its array '{name}' has the shape {show(shape)} in {show(chunks)}")
    texts = array["dtype"] == "|O"
    filters = [{"id": "vlen-utf8"}] if texts else None
    known = texts or _NUMBERS.fullmatch(array["dtype"])
    packed = array["compressor"]["id"] == "zstd" and array["filters"] == filters
    plain = array["zarr_format"] == 2 and array["order"] == "C"
    if not known or not packed or not plain or array.get("dimension_separator", ".") != ".":
        raise StoreError(f"its array '{name}' is kept in a way that softafm does not write")
    dimensions = attributes["_ARRAY_DIMENSIONS"]
    named = len(dimensions) == len(shape) and all(isinstance(each, str) for each in dimensions)
    words = [attributes.get(key, "") for key in ("units", "long_name", "flag_meanings")]
    if (
        not named
        or any(key not in _ATTRIBUTES for key in attributes)
        or any(type(w) is not str for w in words)
    ):
        raise StoreError(f"its array '{name}' is described in a way that softafm does not write")
    if " since " in words[0]:
        raise StoreError(f"its array '{name}' has the unit {show(words[0])}")


def _refuse_links(path: Path, arrays: Mapping[str, Any]) -> None:
    """Refuse a store of which a part lies elsewhere."""
    for folder in (path, *(path / name for name in arrays)):
        with scandir(folder) as entries:
            for entry in entries:
                if entry.is_symlink():
                    inside = Path(entry.path).relative_to(path)
                    raise StoreError(f"'{inside}' is a link, which no store of a sweep holds")
