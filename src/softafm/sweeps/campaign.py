"""A campaign: many runs of one kind, what varies between them and what each gives."""

import hashlib
import inspect
import json
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from softafm.checks.refusals import ConfigError, show, suggest
from softafm.contact import Contact
from softafm.errors import AccuracyWarning
from softafm.experiment.config import Experiment, build_experiment, build_table
from softafm.experiment.fields import Keys, replace_value, split_path
from softafm.modes import MODES, Axes, Mode
from softafm.results.content import VARIABLES
from softafm.sweeps.designs import Design
from softafm.version import __version__

Coordinate = tuple[tuple[str, ...], np.ndarray, Mapping[str, str]]
"""Dimensions, values and attributes."""

_TRIED = 200
"""Values of a parameter, or samples, for which an experiment is built before anything starts."""


@dataclass(frozen=True)
class Observable:
    """A number that every run gives, or an array of them over further dimensions."""

    name: str
    unit: str = "1"
    long_name: str = ""
    dimensions: tuple[str, ...] = ()
    shape: tuple[int, ...] = ()


@dataclass(frozen=True)
class Campaign:
    """Runs over the points of one or more dimensions.

    Attributes
    ----------
    dimensions, shape
        Names and sizes of what varies.
    coordinates
        By name; over these dimensions, or over further ones of the observables.
    observables
        What every run gives.
    point
        Returns what a run is to know, picklable, of an index along each dimension. It is called
        where the campaign was started.
    run
        Turns a point into the values of the observables by name; picklable, as it is called in
        other processes. What it raises is recorded as the reason why the run failed.
    identity
        What makes it this campaign and no other, as JSON can hold it: a store is resumed only by
        the campaign that began it.
    seconds
        Expected duration of a run, s.
    """

    dimensions: tuple[str, ...]
    shape: tuple[int, ...]
    coordinates: Mapping[str, Coordinate]
    observables: tuple[Observable, ...]
    point: Callable[[tuple[int, ...]], Any]
    run: Callable[[Any], Mapping[str, Any]]
    identity: Mapping[str, Any]
    seconds: float | None = None

    @property
    def size(self) -> int:
        """The number of runs."""
        return prod(self.shape)

    def points(self, block: Sequence[range]) -> list[Any]:
        """Return the points of a block, in C order."""
        return [self.point(index) for index in product(*block)]


# Experiments


@dataclass(frozen=True)
class RunExperiment:
    """Runs the experiment that a document becomes with some of its values replaced."""

    document: Mapping[str, Any]
    folder: Path
    names: tuple[str, ...]

    def __call__(self, values: Mapping[str, Any]) -> dict[str, Any]:
        experiment = self.experiment(values)
        kept = _reuse_contact(experiment.contact)
        found = replace(experiment, contact=kept).observables()
        return {name: found[name] for name in self.names}

    def experiment(self, values: Mapping[str, Any]) -> Experiment:
        """Return the experiment of a run; ConfigError if there is none."""
        document = self.document
        for path, value in values.items():
            document = replace_value(document, _split_path(path), value)
        return build_experiment(document, self.folder, _reuse_table)


@lru_cache(maxsize=1024)
def _split_path(path: str) -> Keys:
    return split_path(path)


def _reuse_contact(contact: Contact) -> Contact:
    """Return an equal contact that has worked out its scales already, if one is at hand."""
    try:
        return _build_contact(contact.tip, contact.sample, contact.surface)
    except TypeError:  # a part that cannot be hashed
        return contact


def _reuse_table(name: str, document: Mapping[str, Any], mode: Mode | None, folder: Path) -> Any:
    """Return what a table describes, the same object for equal tables; it warns each time."""
    thing, warned = _build_table(name, json.dumps(document.get(name)), mode, folder)
    for text in warned:
        warnings.warn(text, AccuracyWarning, stacklevel=2)
    return thing


@lru_cache(maxsize=256)
def _build_table(
    name: str, written: str, mode: Mode | None, folder: Path
) -> tuple[Any, tuple[str, ...]]:
    content = json.loads(written)
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always", AccuracyWarning)
        thing = build_table(name, {} if content is None else {name: content}, mode, folder)
    return thing, tuple(str(warning.message) for warning in warned)


@lru_cache(maxsize=64)
def _build_contact(tip: Any, sample: Any, surface: Any) -> Contact:
    return Contact(tip, sample, surface)


def plan_experiments(
    document: Mapping[str, Any], folder: Path, design: Design, names: Sequence[str] | None
) -> Campaign:
    """Return the campaign of an experiment's document, having tried it.

    Raises
    ------
    ConfigError
        If the document is no experiment with any of the values tried, if a value suits no
        experiment tried, or an observable is not one of the mode's.
    """
    from softafm.experiment.regime import estimate_seconds

    mode = MODES[document["mode"]]
    observed = tuple(mode.observed if names is None else names)
    _refuse_unknown(observed, mode.observed)
    run = RunExperiment(document, folder, observed)
    tried = _try_out(run, design)
    costs = [estimate_seconds(experiment) for experiment in tried[:: max(1, len(tried) // 20)]]
    coordinates: dict[str, Coordinate] = dict(design.coordinates)
    _refuse_axes(design, mode.axes)
    axes = [np.array(values) for values in mode.axes.values(tried[0].motion)]
    for name, values in zip(mode.axes.dims, axes, strict=True):
        units, long_name = VARIABLES[name]
        coordinates[name] = ((name,), values, {"units": units, "long_name": long_name})
    shape = tuple(values.size for values in axes)
    return Campaign(
        dimensions=design.dimensions,
        shape=design.shape,
        coordinates=coordinates,
        observables=tuple(Observable(n, *VARIABLES[n], mode.axes.dims, shape) for n in observed),
        point=design.write_at,
        run=run,
        identity={
            "experiment": document,
            "files": _hash_files(document, folder),
            "observables": list(observed),
            "softafm_version": __version__,
        },
        seconds=float(np.mean(costs)),
    )


def _refuse_unknown(observed: Sequence[Any], known: Sequence[str]) -> None:
    if not observed:
        raise ConfigError(["sweep.observables = []: is empty; leave it out for all of them"])
    for name in observed:
        if not isinstance(name, str) or name not in known:
            raise ConfigError([f"sweep.observables = {show(name)}: {suggest(name, known)}"])
        if list(observed).count(name) > 1:
            raise ConfigError([f"sweep.observables: '{name}' is listed twice; leave one out"])


def _refuse_axes(design: Design, axes: Axes) -> None:
    """Raise ConfigError if what varies changes what the results of every run lie over."""
    for parameter in design.parameters:
        path = parameter.field.path
        if path in (f"motion.{key}" for key in axes.keys):
            over = " and ".join(axes.dims)
            raise ConfigError(
                [
                    f"sweep.vary.'{path}': the results of every run lie over {over} already, which "
                    "this would change; set it in [motion] and vary something else"
                ]
            )


def _try_out(run: RunExperiment, design: Design) -> list[Any]:
    """Return experiments that could be built, with every value of every parameter if few.

    A value may suit some values of the other parameters and not others; only one that suits none
    of those tried is refused, with what the first try said.
    """
    shape, sampled = design.shape, design.dimensions == ("sample",)
    anchors = [tuple(int(part * (n - 1)) for n in shape) for part in (0, 1, 0.5)]
    built = {}
    for axis, size in enumerate(shape):
        failures = []
        for i in np.unique(np.linspace(0, size - 1, min(size, _TRIED)).astype(int)):
            refusals: list[ConfigError] = []
            for anchor in anchors:
                index = (*anchor[:axis], int(i), *anchor[axis + 1 :])
                try:
                    if index not in built:
                        built[index] = run.experiment(design.write_at(index))
                    break
                except ConfigError as error:
                    refusals.append(error)
            else:
                failures.append(refusals[0])
            # Of a sample some may be out of range, and are recorded as failed.
            if failures and not sampled:
                raise failures[0]
        if not built:
            raise failures[0]
    return list(built.values())


def _hash_files(document: Any, folder: Path) -> dict[str, str]:
    """Return the SHA-256 of the files that a document names, by name."""
    if isinstance(document, list):
        return {name: d for entry in document for name, d in _hash_files(entry, folder).items()}
    found: dict[str, str] = {}
    for key, value in document.items() if isinstance(document, Mapping) else ():
        if key == "file" and isinstance(value, str) and (folder / value).is_file():
            found[value] = hashlib.sha256((folder / value).read_bytes()).hexdigest()
        else:
            found |= _hash_files(value, folder)
    return found


# Python functions


@dataclass(frozen=True)
class RunFunction:
    """Calls a function with the values of a run by name, and takes the scalars of what it gives."""

    function: Callable[..., Any]

    def __call__(self, values: Mapping[str, Any]) -> dict[str, Any]:
        return {name: value for name, (value, _) in self.scalars(values).items()}

    def scalars(self, values: Mapping[str, Any]) -> dict[str, tuple[float, Mapping[str, str]]]:
        """Return every scalar, with the attributes it has in a dataset."""
        given = self.function(**values)
        if not isinstance(given, Mapping):
            raise TypeError(
                f"gives {show(given)}: must be a mapping of names to numbers, or a dataset"
            )
        found = {}
        for name, value in (getattr(given, "data_vars", None) or given).items():
            number = np.asarray(value)
            if number.ndim == 0 and number.dtype.kind in "fiub":
                found[str(name)] = (float(number), getattr(value, "attrs", {}))
        return found


def plan_calls(
    function: Callable[..., Any], design: Design, names: Sequence[str] | None
) -> Campaign:
    """Return the campaign of a function, having called it once.

    Raises
    ------
    ConfigError
        If it does not take the parameters, the call fails, or gives no such observables.
    """
    from time import perf_counter

    name = getattr(function, "__name__", type(function).__name__)
    run, first = RunFunction(function), design.at((0,) * len(design.shape))
    try:
        inspect.signature(function).bind(**first)
    except TypeError as error:
        raise ConfigError([f"sweep.vary: {name} cannot be called with it: {error}"]) from None
    except ValueError:  # it has no signature to be known
        pass
    started = perf_counter()
    try:
        scalars = run.scalars(first)
    except Exception as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise ConfigError(
            [f"sweep: the first run, of {name} with {_write_values(first)}, failed: {reason}"]
        ) from error
    seconds = perf_counter() - started
    observed = tuple(scalars if names is None else names)
    if not scalars:
        raise ConfigError([f"sweep: the function {name} gives no numbers; return some by name"])
    _refuse_unknown(observed, list(scalars))
    for taken in design.names.values():
        if taken in observed:
            raise ConfigError(
                [f"sweep.observables: '{taken}' is what varies, too; give it another name"]
            )
    return Campaign(
        dimensions=design.dimensions,
        shape=design.shape,
        coordinates=design.coordinates,
        observables=tuple(_describe_observable(n, scalars[n][1]) for n in observed),
        point=design.at,
        run=run,
        identity={
            "function": f"{getattr(function, '__module__', '')}.{name}",
            "source": _find_source(function),
            "observables": list(observed),
            "softafm_version": __version__,
        },
        seconds=seconds,
    )


def _describe_observable(name: str, attributes: Mapping[str, str]) -> Observable:
    unit, long_name = (str(attributes.get(key, "")) for key in ("units", "long_name"))
    return Observable(name, unit, long_name)


def _write_values(values: Mapping[str, Any]) -> str:
    return ", ".join(f"{name} = {show(value)}" for name, value in values.items())


def _find_source(function: Any) -> str | None:
    try:
        return inspect.getsource(getattr(function, "py_func", function))
    except (OSError, TypeError):  # it was not defined in a file
        return None
