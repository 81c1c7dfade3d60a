"""Which values a sweep takes: grids, lists side by side, random and low-discrepancy samples."""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np

from softafm.checks.refusals import ConfigError, join_with_or, show, suggest
from softafm.checks.validate import check_whole
from softafm.experiment.fields import Field, reword

DESIGNS = ("grid", "random", "latin-hypercube", "sobol")
MOST_RUNS = 100_000_000
"""What a store can keep account of."""
_RANGE = ("from", "to", "points", "spacing")


@dataclass(frozen=True)
class Between:
    """A range from which a random design draws, evenly or, with ``log``, evenly by logarithm.

    Parameters
    ----------
    low, high
        Its ends: SI numbers, or texts with unit such as ``"10 ns"``.
    """

    low: float | str
    high: float | str
    log: bool = False


@dataclass(frozen=True)
class Parameter:
    """A varied field with its values, in SI, along one dimension."""

    field: Field
    dimension: str
    values: Sequence[Any] | np.ndarray


@dataclass(frozen=True)
class Design:
    """The dimensions of a sweep and what varies along them.

    Attributes
    ----------
    dimensions, shape
        Names and sizes.
    parameters
        All that vary, in the order in which they were given.
    names
        The name of each as a coordinate, by its path.
    """

    dimensions: tuple[str, ...]
    shape: tuple[int, ...]
    parameters: tuple[Parameter, ...]
    names: Mapping[str, str]

    @property
    def size(self) -> int:
        """The number of runs."""
        return prod(self.shape)

    def at(self, index: Sequence[int]) -> dict[str, Any]:
        """Return the values of a run, in SI, by the paths of the fields."""
        where = dict(zip(self.dimensions, index, strict=True))
        return {p.field.path: _convert(p.values[where[p.dimension]]) for p in self.parameters}

    def write_at(self, index: Sequence[int]) -> dict[str, Any]:
        """Return the values of a run as an experiment file has them."""
        values = self.at(index)
        return {p.field.path: p.field.written(values[p.field.path]) for p in self.parameters}

    @property
    def coordinates(self) -> dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, str]]]:
        """Coordinates by name, each with its dimensions, values and attributes."""
        return {
            self.names[p.field.path]: (
                (p.dimension,),
                _make_array(p.values),
                {
                    **({"units": p.field.unit} if p.field.unit else {}),
                    "long_name": p.field.path,
                },
            )
            for p in self.parameters
        }


def make_design(
    kind: str,
    vary: Mapping[Any, Any],
    field: Callable[[str], Field],
    samples: int | None,
    seed: int,
    taken: Sequence[str] = (),
) -> Design:
    """Return the design that a user describes.

    Parameters
    ----------
    kind
        One of ``DESIGNS``.
    vary
        Values of each path: a list, or a range as a ``Between`` or as a mapping with ``from``,
        ``to`` and perhaps ``points`` and ``spacing``. Several paths in a tuple vary together, with
        a list of values for each.
    field
        Returns the field of a path, or raises ValueError.
    samples, seed
        Of designs other than grids.
    taken
        Names that coordinates must not have.

    Raises
    ------
    ConfigError
        One line for each problem, with field, value and remedy.
    """
    if kind not in DESIGNS:
        raise ConfigError([f"sweep.design = {show(kind)}: {suggest(kind, DESIGNS)}"])
    if not isinstance(vary, Mapping) or not vary:
        raise ConfigError(["sweep.vary: names nothing to vary; give a field and its values"])
    groups = [key if isinstance(key, tuple) else (key,) for key in vary]
    paths = [path for group in groups for path in group]
    problems = [
        f"sweep.vary.'{path}': is listed twice; leave one out"
        for path in dict.fromkeys(paths)
        if paths.count(path) > 1
    ]
    grid = kind == "grid"
    try:
        count, seed = _check_samples(kind, samples), check_whole("sweep.seed", seed, 0, 2**63 - 1)
    except ValueError as error:
        raise ConfigError([*problems, str(error)]) from None
    columns: list[list[tuple[Field, Any]]] = []
    for group, written in zip(groups, vary.values(), strict=True):
        try:
            columns.append(_read_group(group, written, field, grid))
        except ConfigError as error:
            problems += str(error).splitlines()
    if problems:
        raise ConfigError(problems)
    names = _name_dimensions(paths, taken)
    if not grid:
        return _draw_sample(kind, columns, names, count, seed)
    sizes = [len(group[0][1]) for group in columns]
    if prod(sizes) > MOST_RUNS:
        raise ConfigError([_refuse_size(prod(sizes), sizes, groups)])
    dimensions = ["_".join(names[field.path] for field, _ in group) for group in columns]
    parameters = [
        Parameter(field, dimension, values)
        for dimension, group in zip(dimensions, columns, strict=True)
        for field, values in group
    ]
    return Design(tuple(dimensions), tuple(sizes), tuple(parameters), names)


def _check_samples(kind: str, samples: int | None) -> int:
    if kind == "grid":
        if samples is not None:
            raise ValueError(
                f"sweep.samples = {show(samples)}: has no effect in a grid; leave it out, or "
                f"choose the design {join_with_or(DESIGNS[1:])}"
            )
        return 0
    if samples is None:
        raise ValueError(f"sweep.samples: missing; the design '{kind}' needs a number of runs")
    return check_whole("sweep.samples", samples, 1, MOST_RUNS)


def _refuse_size(runs: int, sizes: list[int], groups: list[tuple[str, ...]]) -> str:
    most = groups[int(np.argmax(sizes))]
    return (
        f"sweep.vary: a grid of {runs:.3g} runs; a store holds at most {MOST_RUNS:.0e}: take fewer "
        f"values, of '{most[0]}' for instance, or a random design"
    )


def _read_group(
    group: tuple[str, ...], written: Any, field: Callable[[str], Field], grid: bool
) -> list[tuple[Field, Any]]:
    """Return the fields that vary along one dimension, each with a list of values or a range."""
    if len(group) == 1:
        return [_read_column(group[0], written, field, grid)]
    together = ", ".join(group)
    if isinstance(written, str | Mapping) or not isinstance(written, Sequence | np.ndarray):
        raise ConfigError([f"sweep.vary.'{together}': must be a list of values for each of them"])
    if len(written) != len(group):
        raise ConfigError(
            [
                f"sweep.vary.'{together}': has {len(written)} lists for {len(group)} fields; give "
                "a list of values for each field"
            ]
        )
    columns = [_read_column(path, w, field, True) for path, w in zip(group, written, strict=True)]
    sizes = [len(values) for _, values in columns]
    if len(set(sizes)) > 1:
        words = ", ".join(f"'{p}' has {n}" for p, n in zip(group, sizes, strict=True))
        raise ConfigError(
            [f"sweep.vary.'{together}': {words} values; those varied together need equally many"]
        )
    return columns


def _read_column(
    path: str, written: Any, field: Callable[[str], Field], grid: bool
) -> tuple[Field, Any]:
    if not isinstance(path, str):
        raise ConfigError([f"sweep.vary = {show(path)}: must be a field, such as 'sample.E_inf'"])
    try:
        what = field(path)
    except ValueError as error:
        raise ConfigError([f"sweep.vary.'{path}': {error}"]) from None
    if isinstance(written, Between | Mapping):
        return what, _read_range(what, written, grid)
    return what, _read_list(what, written)


def _read_list(field: Field, written: Any) -> list[Any]:
    if isinstance(written, str | bytes) or not hasattr(written, "__iter__"):
        raise ConfigError(
            [reword(field.path, None, written, "must be a list of values, or a range")]
        )
    values, problems = [], []
    for index, value in enumerate(written):
        try:
            values.append(field.read(_convert(value)))
        except (ValueError, OverflowError) as error:
            problems.append(reword(field.path, index, value, error))
            if len(problems) == 3:
                break
    if problems:
        raise ConfigError(problems)
    if not values:
        raise ConfigError([f"sweep.vary.'{field.path}' = []: is empty; give at least one value"])
    return values


def _read_range(field: Field, written: Between | Mapping[str, Any], grid: bool) -> Any:
    """Return a range's values in a grid, or a ``Between`` in SI."""
    path = f"sweep.vary.'{field.path}'"
    points, spacing = None, "linear"
    if isinstance(written, Mapping):
        unknown = [key for key in written if key not in _RANGE]
        if unknown:
            raise ConfigError([f"{path}.{unknown[0]}: unknown key; {suggest(unknown[0], _RANGE)}"])
        if missing := [key for key in ("from", "to") if key not in written]:
            raise ConfigError([f"{path}.{missing[0]}: missing; a range has from and to"])
        low, high = written["from"], written["to"]
        points, spacing = written.get("points"), written.get("spacing", "linear")
        if spacing not in ("linear", "log"):
            raise ConfigError([f"{path}.spacing = {show(spacing)}: must be 'linear' or 'log'"])
    else:
        low, high = written.low, written.high
        spacing = "log" if written.log else "linear"
    if grid and points is None:
        raise ConfigError(
            [f"{path}: a grid, or a list side by side with others, needs values; add points, their "
             "number, or choose a random design"]
        )  # fmt: skip
    if not grid and points is not None:
        raise ConfigError([f"{path}.points: has no effect in a random design; leave it out"])
    ends = []
    for key, end in (("from", low), ("to", high)):
        try:
            ends.append(field.read(_convert(end)))
        except (ValueError, OverflowError) as error:
            raise ConfigError([f"{path}.{key} = {show(end)}: {error}"]) from None
        if isinstance(ends[-1], bool | str) or not isinstance(ends[-1], int | float):
            raise ConfigError([f"{path}.{key} = {show(end)}: must be a number; list other values"])
    start, stop = map(float, ends)
    if start == stop:
        raise ConfigError([f"{path}.to = {show(high)}: must differ from from; or list one value"])
    if spacing == "log" and min(start, stop) <= 0:
        raise ConfigError([f"{path}.from = {show(low)}: must be above 0 for spacing = 'log'"])
    try:
        field.read(field.written(start))
    except ValueError as error:
        raise ConfigError([f"{path}: {error}; list the values instead of a range"]) from None
    if points is None:
        return Between(start, stop, spacing == "log")
    try:
        check_whole(f"{path}.points", points, 2, MOST_RUNS)
    except ValueError as error:
        raise ConfigError([str(error)]) from None
    return (np.geomspace if spacing == "log" else np.linspace)(start, stop, points)


def _draw_sample(
    kind: str,
    columns: Sequence[list[tuple[Field, Any]]],
    names: Mapping[str, str],
    count: int,
    seed: int,
) -> Design:
    """Draw a sample: a column of numbers from 0 to 1 for each group."""
    shares = _draw_unit_sample(kind, len(columns), count, seed)
    parameters = []
    for group, share in zip(columns, shares.T, strict=True):
        for field, drawn in group:
            parameters.append(Parameter(field, "sample", _draw_value(drawn, share)))
    return Design(("sample",), (count,), tuple(parameters), names)


def _draw_value(drawn: Any, share: np.ndarray) -> Any:
    if isinstance(drawn, Between):
        low, high = float(drawn.low), float(drawn.high)
        if drawn.log:
            return low * (high / low) ** share
        return low + (high - low) * share
    picked = np.minimum((share * len(drawn)).astype(int), len(drawn) - 1)
    values = _make_array(drawn)
    return values[picked] if values.dtype.kind in "fib" else [drawn[i] for i in picked]


def _draw_unit_sample(kind: str, columns: int, count: int, seed: int) -> np.ndarray:
    """Return ``count`` points in the unit cube, shape (count, columns)."""
    if kind == "random":
        return np.random.default_rng(seed).random((count, columns))
    from scipy.stats import qmc

    engine = qmc.LatinHypercube if kind == "latin-hypercube" else qmc.Sobol
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "The balance properties", UserWarning)
        return engine(columns, rng=seed).random(count)


def _name_dimensions(paths: Sequence[str], taken: Sequence[str]) -> dict[str, str]:
    """Return for each path its last key, or where that is not its alone the whole path."""
    last = [path.rpartition(".")[2] for path in paths]
    return {
        path: name if last.count(name) == 1 and name not in taken else path.replace(".", "_")
        for path, name in zip(paths, last, strict=True)
    }


def _convert(value: Any) -> Any:
    """Return a NumPy scalar as what Python has for it."""
    return value.item() if isinstance(value, np.generic) else value


def _make_array(values: Any) -> np.ndarray:
    """Return values as an array of numbers or flags if they all are, else of texts."""
    array = np.asarray(values) if not _are_mixed(values) else np.array([])
    if array.ndim == 1 and array.size and array.dtype.kind in "fib":
        return array
    return np.array([value if isinstance(value, str) else str(value) for value in values])


def _are_mixed(values: Any) -> bool:
    if isinstance(values, np.ndarray):
        return False
    kinds = {type(value) for value in values}
    return not (kinds <= {int, float} or kinds == {bool})
