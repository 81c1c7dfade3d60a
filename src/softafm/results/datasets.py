"""Results as xarray datasets: names, units, provenance, saving, loading, export."""

import csv
import inspect
import json
import os
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from softafm.checks.kinds import refuse_non_dataset
from softafm.checks.paths import explain_no_file
from softafm.results.content import FORMAT, HISTORY, LARGEST, PROFILES, Labelled, make_variable
from softafm.results.netcdf import make_file_content
from softafm.solvers.history import History
from softafm.version import __version__

if TYPE_CHECKING:
    from xarray import Dataset, Variable

    from softafm.results.files import Content


def _assemble(
    data: "dict[str, Variable]", coordinates: "dict[str, Variable]", attributes: dict[str, Any]
) -> "Dataset":
    """Return the dataset of variables and of coordinates, each along a dimension of its name."""
    import pandas as pd
    from xarray import Coordinates, Dataset
    from xarray.indexes import PandasIndex

    # Made here: xarray would import dask and pint to see whether these are arrays of theirs.
    indexes = {
        name: PandasIndex(pd.Index(known.values), name, coord_dtype=known.dtype)
        for name, known in coordinates.items()
    }
    variables: dict[Any, Variable] = {}
    for name, index in indexes.items():
        variables |= index.create_variables({name: coordinates[name]})
    return Dataset(data, Coordinates(variables, indexes), attributes)


def describe(thing: Any) -> dict[str, Any]:
    """Return the kind and the parameters (SI) of a tip, sample, law, motion, solver or stepper.

    Those of a class that is no dataclass are its ``description``; {} if it has none.
    """
    if is_dataclass(thing):
        values = {f.name: _describe_value(getattr(thing, f.name)) for f in fields(thing)}
    else:
        values = getattr(thing, "description", {})
    return {"kind": thing.kind, **values}


def _describe_value(value: Any) -> Any:
    """Return a parameter as JSON can hold it: of a user's function name and text."""
    if is_dataclass(value):
        return describe(value)
    if isinstance(value, tuple):
        return [_describe_value(entry) for entry in value]
    if not callable(value):
        return value
    function = getattr(value, "py_func", value)
    try:
        source = inspect.getsource(function)
    except (OSError, TypeError):  # it was not defined in a file
        source = None
    return {"name": f"{function.__module__}.{function.__qualname__}", "source": source}


def history_variables(
    contact: Any, history: History
) -> tuple[dict[str, Labelled], dict[str, Labelled]]:
    """Return the curves, jumps and shapes of a history, and their coordinates.

    Both by name as (dims, values).
    """
    data: dict[str, Labelled] = {
        name: (dims, getattr(history, name)) for name, dims in HISTORY.items()
    }
    coordinates: dict[str, Labelled] = {"time": ("time", history.time)}
    if history.profiles is not None:
        shapes = history.profiles
        gap = history.tip_height[:, None] + contact.tip.profile(shapes.radius) - shapes.deformation
        coordinates["r"] = ("r", shapes.radius)
        for name, values in (
            ("deformation", shapes.deformation),
            ("gap", gap),
            ("pressure", contact.surface.pressure(gap)),
        ):
            data[name] = (PROFILES[name], values)
    return data, coordinates


def assemble_history(
    mode: str,
    contact: Any,
    parts: Mapping[str, Any],
    solver: Any,
    tolerance: float,
    data: Mapping[str, Labelled],
    coordinates: Mapping[str, Labelled],
    warnings: Sequence[Warning],
    diagnostics: Mapping[str, Any],
    audit: str = "",
) -> "Dataset":
    """Assemble a result of variables and coordinates, by name as (dims, values).

    ``parts`` are what took part besides the contact, by name: objects, or dictionaries.
    """

    def known(arrays: Mapping[str, Labelled]) -> "dict[str, Variable]":
        return {name: make_variable(name, dims, values) for name, (dims, values) in arrays.items()}

    attributes = _collect_provenance(mode, contact, parts, solver, tolerance, warnings, diagnostics)
    attributes |= {"audit": audit} if audit else {}
    return _assemble(known(data), known(coordinates), attributes)


def record_regularisation(result: "Dataset", given: Any, contact: Any, tabor: float | None) -> None:
    """Write into a result that the range of a law was enlarged, and what the law was like before.

    ``given`` is the contact before, ``tabor`` the number that was asked for; None writes nothing.
    """
    if tabor is None:
        return
    experiment = json.loads(result.attrs["experiment"])
    experiment["regularise"] = {"tabor": float(tabor), "surface": describe(given.surface)}
    result.attrs |= {
        "experiment": json.dumps(experiment),
        "regularised_tabor": float(tabor),
        "regularised_range": contact.surface.range,
        "given_range": given.surface.range,
        "given_tabor": given.tabor_softened,
        "edge_slowed": compute_edge_slowing(given, contact.surface.range),
    }


def compute_edge_slowing(given: Any, longer: float) -> float:
    """Return by what factor the edge of a contact is slower, in cohesive lengths, at a range, m.

    That of an elastic one is none the slower for it, 1: no rate matters there.
    """
    creep = given.body.compliance
    rate_matters = creep.elements.size > 0 or creep.fluidity > 0
    return (longer / given.surface.range) ** 2 if rate_matters else 1.0


def describe_misfit(sample: Any) -> dict[str, float]:
    """Return how well a sample fits the measured moduli it was fitted to; {} for all others."""
    misfit = getattr(sample, "dma_misfit", None)
    if misfit is None:
        return {}
    return dict(zip(("dma_misfit_largest", "dma_misfit_rms"), misfit, strict=True))


def _collect_provenance(
    mode: str,
    contact: Any,
    parts: Mapping[str, Any],
    solver: Any,
    tolerance: float,
    warnings: Sequence[Warning],
    diagnostics: Mapping[str, Any],
) -> dict[str, Any]:
    """Return the attributes of a result: its whole input, and how it was computed."""
    things = {"tip": contact.tip, "sample": contact.sample, "surface": contact.surface, **parts}
    experiment = {
        name: thing if isinstance(thing, dict) else describe(thing)
        for name, thing in things.items()
    }
    return {
        "format": FORMAT,
        "mode": mode,
        "experiment": json.dumps({"mode": mode, **experiment}),
        "solver": json.dumps(describe(solver)),
        **({"tolerance": float(tolerance)} if solver.adaptive else {}),
        "softafm_version": __version__,
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "tabor_instantaneous": contact.tabor_instantaneous,
        "tabor_relaxed": contact.tabor_relaxed,
        "cohesive_length": contact.cohesive_length,
        **describe_misfit(contact.rheology),
        "warnings": "\n".join(map(str, warnings)),
        **{f"solver_{name}": value for name, value in diagnostics.items()},
    }


def save(result: "Dataset", path: str | Path, *, overwrite: bool = False) -> None:
    """Write a result to a NetCDF-4 file; an existing file is replaced only with ``overwrite``.

    The file appears whole or not at all.

    Raises
    ------
    ValueError
        If it is not an ``xarray.Dataset``.
    FileExistsError
        If the path exists and ``overwrite`` is False.
    OSError
        If the folder does not exist or cannot be written.
    """
    refuse_non_dataset("result", result)
    # Formed in memory: on a full disk HDF5 itself may take the process down with it.
    content = make_file_content(result)
    write_whole(path, overwrite, lambda part: Path(part).write_bytes(content))


def load(path: str | Path, *, largest: float = LARGEST) -> "Dataset":
    """Read a result written by ``save``, whole, and close the file.

    What lies outside the file is never read, even if the file says that it belongs to it.

    Parameters
    ----------
    path
        The file.
    largest
        Size that its variables may have in memory, bytes: a small file can stand for a large one.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is not a result of softafm, lacks what its mode needs, or is larger.
    """
    from softafm.results.files import read

    if not Path(path).is_file():
        raise FileNotFoundError(f"{path}: {explain_no_file(Path(path))}")
    try:
        return build_result(*read(str(path), int(largest)))
    except ValueError as problem:
        raise ValueError(f"{path}: {problem}") from None


def load_apart(
    path: str | Path, *, largest: float = LARGEST, seconds: float | None = None
) -> "Dataset":
    """Read a result of someone else, as ``load`` does, in a process of its own.

    A damaged file that makes the reading go on for ever, or end its process, harms no one then.

    Parameters
    ----------
    path, largest
        As for ``load``.
    seconds
        Time after which the reading is ended, s; by default ``softafm.files.guard.allow_seconds``.

    Raises
    ------
    FileNotFoundError, ValueError
        As ``load``, and ValueError if the file cannot be read in that time.
    """
    from softafm.files.guard import allow_seconds, read_apart

    if not Path(path).is_file():
        raise FileNotFoundError(f"{path}: {explain_no_file(Path(path))}")
    try:
        found = read_apart(
            "softafm.results.files:read",
            str(path),
            int(largest),
            seconds=allow_seconds(path) if seconds is None else seconds,
            largest=int(largest),
        )
        return build_result(*found)
    except ValueError as problem:
        raise ValueError(f"{path}: {problem}") from None


def build_result(content: "Content", arrays: Sequence[np.ndarray]) -> "Dataset":
    """Return the result that ``softafm.results.files.read`` found in a file.

    Raises
    ------
    ValueError
        If it is none, or lacks what its mode needs.
    """
    from xarray import Dataset

    from softafm.results.check import refuse_unusable

    attributes, described, coordinates = content
    variables = {
        name: (tuple(dimensions), values, attrs)
        for (name, dimensions, attrs), values in zip(described, arrays, strict=True)
    }
    refuse_unusable(attributes, variables)
    made = {
        name: (*parts, _convert_attributes(attrs)) for name, (*parts, attrs) in variables.items()
    }
    return Dataset(made, attrs=_convert_attributes(attributes)).set_coords(coordinates)


def _convert_attributes(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Return attributes as NumPy's numbers and arrays of numbers, as xarray reads them."""
    return {
        name: value if isinstance(value, str) or _holds_text(value) else np.array(value)[()]
        for name, value in attributes.items()
    }


def _holds_text(value: Any) -> bool:
    return isinstance(value, list) and any(isinstance(each, str) for each in value)


def export(result: "Dataset", path: str | Path, *, overwrite: bool = False) -> None:
    """Write the curves over time to CSV, or the whole result to HDF5, by the path's suffix.

    CSV columns are named ``name (unit)``; the scalars stand above them as comments. Of an approach
    curve they are those of the sweep, over ``sweep_height``; its branches are in the HDF5 only.

    Raises
    ------
    ValueError
        If the suffix is neither .csv nor .h5, or .csv for what has no curve, such as a map.
    FileExistsError, OSError
        As ``save``.
    """
    refuse_non_dataset("result", result)
    suffix = Path(path).suffix.lower()
    if suffix == ".h5":
        save(result, path, overwrite=overwrite)
    elif suffix == ".csv":
        if {"x", "y"} <= set(result.dims):
            raise ValueError(f"{path}: maps have no CSV; use .h5, or export_gwyddion")
        if not _curve_dimension(result) or "experiment" not in result.attrs:
            raise ValueError(f"{path}: the dataset is not a result of softafm, so it has no curve")
        write_whole(path, overwrite, lambda part: _write_csv(result, part))
    else:
        raise ValueError(f"{path}: suffix {suffix!r} is not known, must be .csv or .h5")


def _curve_dimension(result: "Dataset") -> str:
    """Return along which coordinate the curves of a result lie; "" if it has none."""
    known = [str(name) for name in result.dims if name in result.coords]
    curves = {variable.dims for variable in result.data_vars.values()}
    first = [name for name in ("time", "sweep_height") if name in known]
    return next((name for name in [*first, *known] if (name,) in curves), "")


def _write_csv(result: "Dataset", path: str) -> None:
    along = _curve_dimension(result)
    numbers = [v for v in result.data_vars.values() if v.dtype.kind in "fiub"]
    curves = [result[along]] + [v for v in numbers if v.dims == (along,)]
    scalars = [v for v in numbers if v.dims == ()]
    header = [f"{v.name} = {float(v):.9g} {v.units}" for v in scalars]
    header += [f"experiment = {result.attrs['experiment']}"]
    names = [f"{v.name} ({v.units})" for v in curves]
    # To the last digit: steps of a fall may be closer than nine digits can resolve.
    rows = np.column_stack(curves).tolist()
    with open(path, "w", encoding="utf-8") as out:
        out.writelines(f"# {line}\n" for line in header)
        csv.writer(out, lineterminator="\n").writerow(names)
        out.writelines(",".join(map(repr, row)) + "\n" for row in rows)


def write_whole(path: str | Path, overwrite: bool, write: Callable[[str], object]) -> None:
    """Let ``write`` fill a temporary file beside ``path``, then give it its name."""
    path = Path(path)
    if os.path.lexists(path) and not overwrite:  # a dangling link is somebody's, too
        raise FileExistsError(f"{path}: exists already")
    handle, part = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
    os.close(handle)
    try:
        write(part)
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(part, 0o666 & ~mask)
        os.replace(part, path)
    except BaseException:
        os.unlink(part)
        raise
