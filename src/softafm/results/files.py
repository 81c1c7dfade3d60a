"""Read a NetCDF-4 file as ``softafm.save`` writes it, with h5py alone and nothing followed.

HDF5 files can point outside themselves, stand for far more than they hold, and be of types that
convert into each other. All of a file is looked at before any of its values is read, and what
``softafm.save`` never writes is refused.
"""

from collections.abc import Iterator
from math import prod
from typing import Any, NamedTuple

import h5py
import numpy as np

from softafm.results.content import LARGEST

_MOST_VARIABLES, _MOST_ATTRIBUTES, _MOST_DIMENSIONS = 1000, 200, 8
_MOST_TEXTS = 10_000
_LARGEST_ATTRIBUTE = 10_000_000
_OWN_FILTERS = (h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32)
_HIDDEN = (
    "CLASS", "NAME", "REFERENCE_LIST", "DIMENSION_LIST", "_Netcdf4Dimid", "_Netcdf4Coordinates",
    "_NCProperties", "_nc3_strict",
)  # fmt: skip
"""Attributes with which NetCDF-4 keeps names of dimensions."""
_PACKING = ("scale_factor", "add_offset", "missing_value", "_Unsigned", "calendar", "dtype")
_FLAGS = "bool"
"""What the attribute ``dtype`` says of integers that xarray wrote for flags a user added."""
_NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable"


class NotReadable(ValueError):
    """A file that is not read; the message says why, and not which file."""


class Content(NamedTuple):
    """What a file holds, as JSON can: ``variables`` without their values are those of ``arrays``.

    A variable is (name, dimensions, attributes). ``coordinates`` names those that are coordinates
    without being called as a dimension.
    """

    attributes: dict[str, Any]
    variables: list[tuple[str, list[str], dict[str, Any]]]
    coordinates: list[str]


def read(path: str, largest: int = LARGEST) -> tuple[Content, list[np.ndarray]]:
    """Return what a file holds, and the values of its variables.

    ``largest`` is the size that these may have in memory, bytes.

    Raises
    ------
    NotReadable
        If it is no NetCDF-4 file, or holds what ``softafm.save`` does not write.
    """
    try:
        with h5py.File(path, "r") as file:
            return _read(file, largest)
    except NotReadable:
        raise
    except Exception as problem:  # damaged files make h5py raise errors of many kinds
        reason = " ".join(str(problem).split()) or type(problem).__name__
        raise NotReadable(f"not a readable NetCDF file ({reason})") from None


def _read(file: h5py.File, largest: int) -> tuple[Content, list[np.ndarray]]:
    found = {name: _open(file, name) for name in _list_names(file)}
    sizes = {name: dataset.shape[0] for name, dataset in found.items() if _is_dimension(dataset)}
    held = {name: dataset for name, dataset in found.items() if not _is_no_variable(dataset)}
    size = sum(dataset.size * dataset.id.get_type().get_size() for dataset in held.values())
    if size > largest:
        raise NotReadable(f"has {size / 1e6:.0f} MB unpacked: at most {largest / 1e6:g} MB")
    attributes = _read_attributes("the file", file)
    coordinates = str(attributes.pop("coordinates", "")).split()
    variables, flags = [], set()
    for name, dataset in held.items():
        described = _read_attributes(f"variable '{name}'", dataset)
        if described.pop("dtype", None) == _FLAGS:
            flags.add(name)
        coordinates += str(described.pop("coordinates", "")).split()
        variables.append((name, _find_dimensions(file, name, dataset, sizes), described))
    extra = [name for name in dict.fromkeys(coordinates) if name in held]
    arrays = [_read_values(name, dataset, largest) for name, dataset in held.items()]
    arrays = [
        values != 0 if name in flags else values for name, values in zip(held, arrays, strict=True)
    ]
    return Content(attributes, variables, extra), arrays


def _list_names(file: h5py.File) -> list[str]:
    if len(file) > _MOST_VARIABLES:
        raise NotReadable(f"has {len(file)} entries: at most {_MOST_VARIABLES}")
    names = list(file)
    for name in names:
        if not name.isprintable():
            raise NotReadable(f"has an entry named {name[:60]!r}: must be text that can be printed")
        if not isinstance(file.get(name, getlink=True), h5py.HardLink):
            raise NotReadable(f"'{name}' is a link to elsewhere, which no result of softafm holds")
    return names


def _open(file: h5py.File, name: str) -> h5py.Dataset:
    """Return a data set of which nothing was read, and nothing lies outside the file."""
    opened = h5py.h5o.open(file.id, name.encode())
    if not isinstance(opened, h5py.h5d.DatasetID):
        what = "group" if isinstance(opened, h5py.h5g.GroupID) else "named type"
        raise NotReadable(f"'{name}' is a {what}, which no result of softafm holds")
    made = opened.get_create_plist()
    if made.get_external_count():
        raise NotReadable(f"variable '{name}' keeps its values in another file")
    if made.get_layout() == h5py.h5d.VIRTUAL:
        raise NotReadable(f"variable '{name}' is put together from other files")
    filters = [made.get_filter(index)[0] for index in range(made.get_nfilters())]
    if any(code not in _OWN_FILTERS for code in filters):
        raise NotReadable(f"variable '{name}' is packed in a way that softafm does not write")
    _refuse_type(f"variable '{name}'", opened.get_type(), variable=True)
    if opened.shape is None or len(opened.shape) > _MOST_DIMENSIONS:
        raise NotReadable(f"variable '{name}' has no values, or over {_MOST_DIMENSIONS} dimensions")
    return h5py.Dataset(opened)


def _refuse_type(where: str, kind: h5py.h5t.TypeID, variable: bool = False) -> None:
    """Refuse all but numbers and text, of which that of variables has no fixed length."""
    number = isinstance(kind, h5py.h5t.TypeFloatID | h5py.h5t.TypeIntegerID)
    text = isinstance(kind, h5py.h5t.TypeStringID) and (kind.is_variable_str() or not variable)
    if kind.committed() or not (text or (number and kind.get_size() <= 8)):
        raise NotReadable(f"{where} is of a type that softafm does not write")


def _is_dimension(dataset: h5py.Dataset) -> bool:
    return _read_hidden_text(dataset, "CLASS") == "DIMENSION_SCALE" and len(dataset.shape) == 1


def _is_no_variable(dataset: h5py.Dataset) -> bool:
    """Whether it only tells how long a dimension is."""
    return _is_dimension(dataset) and _read_hidden_text(dataset, "NAME").startswith(_NO_VARIABLE)


def _read_hidden_text(dataset: h5py.Dataset, name: str) -> str:
    if name not in dataset.attrs:
        return ""
    return str(_read_attribute(f"attribute '{name}'", dataset, name))


def _find_dimensions(
    file: h5py.File, name: str, dataset: h5py.Dataset, sizes: dict[str, int]
) -> list[str]:
    """Return the names of a variable's dimensions, without opening what it refers to."""
    if not dataset.shape:
        return []
    if "DIMENSION_LIST" in dataset.attrs:
        kind = dataset.attrs.get_id("DIMENSION_LIST").get_type()
        if isinstance(kind, h5py.h5t.TypeVlenID) and kind.get_super() == h5py.h5t.STD_REF_OBJ:
            scales = [refs[-1] if len(refs) else None for refs in dataset.attrs["DIMENSION_LIST"]]
            found = [h5py.h5r.get_name(ref, file.id).decode()[1:] for ref in scales if ref]
            if [sizes.get(each) for each in found] == list(dataset.shape):
                return found
    elif name in sizes:
        return [name]
    raise NotReadable(f"variable '{name}' has dimensions without a name, or of another length")


def _read_attributes(where: str, thing: h5py.File | h5py.Dataset) -> dict[str, Any]:
    return {
        name: value
        for name, value in _list_attributes(where, thing)
        if not (name == "_FillValue" and isinstance(value, float) and np.isnan(value))
    }


def _list_attributes(where: str, thing: h5py.File | h5py.Dataset) -> Iterator[tuple[str, Any]]:
    if len(thing.attrs) > _MOST_ATTRIBUTES:
        raise NotReadable(f"{where} has {len(thing.attrs)} attributes: at most {_MOST_ATTRIBUTES}")
    for name in thing.attrs:
        if name in _HIDDEN:
            continue
        attribute = f"attribute '{name[:60]}' of {where}"
        value = _read_attribute(attribute, thing, name)
        if name in _PACKING and not (name == "dtype" and value == _FLAGS):
            raise NotReadable(f"{attribute}: softafm does not write such values")
        if name == "_FillValue" and value == value:
            raise NotReadable(f"{attribute} = {value}: must be NaN")
        yield name, value


def _read_attribute(where: str, thing: h5py.File | h5py.Dataset, name: str) -> Any:
    """Return a number, a text or a list of them."""
    found = thing.attrs.get_id(name)
    kind, shape = found.get_type(), found.shape
    _refuse_type(where, kind)
    count = prod(shape or ())
    if shape is None or count > _MOST_TEXTS or count * kind.get_size() > _LARGEST_ATTRIBUTE:
        raise NotReadable(f"{where} is empty or too large")
    values = [
        each.decode("utf-8", "replace") if isinstance(each, bytes) else each
        for each in np.asarray(thing.attrs[name]).ravel().tolist()
    ]
    return values[0] if count == 1 else values


def _read_values(name: str, dataset: h5py.Dataset, largest: int) -> np.ndarray:
    if h5py.check_string_dtype(dataset.dtype) is None:
        return dataset[()]
    if dataset.size > _MOST_TEXTS:
        raise NotReadable(f"variable '{name}' has {dataset.size} texts: at most {_MOST_TEXTS}")
    texts = np.array(dataset.asstr(errors="replace")[()], object)
    longest = max(map(len, texts.ravel()), default=0)
    if 4 * longest * texts.size > largest:
        raise NotReadable(f"variable '{name}' holds a text of {longest} characters: too long")
    return texts.astype(str)
