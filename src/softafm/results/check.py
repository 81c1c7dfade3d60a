"""Whether what a file holds is a result that figures, tables and exports can be made of.

Everything behind ``softafm.load`` relies on these checks and does not repeat them.
"""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from softafm.checks.refusals import join_with_or, show, suggest
from softafm.results.content import (
    BRANCHES,
    FORMAT,
    MAPS,
    NEEDED,
    PROFILES,
    REGULARISED,
    RISING,
    SAMPLES,
    UNNUMBERED,
    Needed,
    find_unit,
)

Variables = Mapping[str, tuple[tuple[str, ...], np.ndarray, Mapping[str, Any]]]
"""Dimensions, values and attributes by name."""

_LARGEST = {"degree": 360.0}
_LARGEST_BY_DEFAULT = 1e30
"""What no quantity exceeds, in its SI unit: sums and squares of such numbers stay finite."""
_NUMBERS = (
    "check_largest",
    "check_tolerance",
    "check_mean_height",
    "regularised_error",
    *REGULARISED,
)
_TEXTS = ("warnings", "softafm_version", "created")


def refuse_unusable(attributes: Mapping[str, Any], variables: Variables) -> None:
    """Raise ValueError, in one line, if this is no result of softafm, or not a whole one."""
    if attributes.get("format") != FORMAT:
        raise ValueError("not a result of softafm (its attribute 'format' says otherwise)")
    mode = attributes.get("mode")
    if not isinstance(mode, str) or mode not in NEEDED:
        modes_first = sorted(NEEDED, key=lambda known: known in MAPS)
        raise ValueError(f"attribute mode = {show(mode)}: {suggest(mode, modes_first)}")
    needed = NEEDED[mode]
    _refuse_experiment(mode, needed, attributes)
    _refuse_attributes(needed, attributes)
    for name, (dimensions, values, described) in variables.items():
        _refuse_words(name, described)
        _refuse_shape(name, dimensions, values, variables)
    wanted = dict(needed.variables)
    wanted |= PROFILES if any(name in variables for name in PROFILES) else {}
    along = {
        each for dimensions in wanted.values() for each in dimensions if each not in UNNUMBERED
    }
    wanted |= {each: (each,) for each in sorted(along)}
    for name, dimensions in wanted.items():
        if name not in variables:
            raise ValueError(f"variable '{name}' is missing, which a result of mode '{mode}' holds")
        _refuse_variable(name, dimensions, variables, gaps=needed.gaps and name not in along)
    for name in variables:
        if name not in wanted and find_unit(name) is not None:
            refuse_values(name, variables[name][1], gaps=needed.gaps)


def _refuse_experiment(mode: str, needed: Needed, attributes: Mapping[str, Any]) -> None:
    experiment = _parse_table("experiment", attributes)
    if experiment.get("mode") != mode:
        raise ValueError(
            f"attribute experiment: is one of mode {show(experiment.get('mode'))}, but the result "
            f"says mode = {mode!r}"
        )
    for part in ("tip", "sample", "surface", needed.described):
        if not isinstance(experiment.get(part), dict):
            raise ValueError(f"attribute experiment: does not describe the {part}")
    for name, unit in needed.inputs.items():
        value = experiment["motion"].get(name)
        if not _is_number(value) or not 0 < value < _LARGEST_BY_DEFAULT:
            raise ValueError(
                f"attribute experiment: motion.{name} = {show(value)}: must be a number in "
                f"{unit}, greater than 0"
            )


def _refuse_attributes(needed: Needed, attributes: Mapping[str, Any]) -> None:
    required = [*needed.numbers, *(REGULARISED if "regularised_range" in attributes else ())]
    for name in (*required, *(each for each in _NUMBERS if each in attributes)):
        value: Any = attributes.get(name)
        if not _is_number(value) or abs(value) > _LARGEST_BY_DEFAULT:
            raise ValueError(f"attribute {name} = {show(value)}: must be a number")
    for name in _TEXTS:
        if not isinstance(attributes.get(name, ""), str):
            raise ValueError(f"attribute {name} = {show(attributes[name])}: must be text")
    for name in ("check_differences", "regularised_errors"):
        if not all(map(_is_number, _parse_table(name, attributes, "{}").values())):
            raise ValueError(f"attribute {name}: must hold numbers by name")
    if not isinstance(_parse("failures", attributes, "[]"), list):
        raise ValueError("attribute failures: must be a list, as JSON")


def _parse_table(
    name: str, attributes: Mapping[str, Any], default: str | None = None
) -> dict[str, Any]:
    found = _parse(name, attributes, default)
    if not isinstance(found, dict):
        raise ValueError(f"attribute {name}: must be a table, as JSON")
    return found


def _parse(name: str, attributes: Mapping[str, Any], default: str | None) -> Any:
    text = attributes.get(name, default)
    if text is None:
        raise ValueError(f"attribute {name}: missing")
    if not isinstance(text, str):
        raise ValueError(f"attribute {name} = {show(text)}: must be text, as JSON")
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        raise ValueError(f"attribute {name} = {show(text)}: cannot be read as JSON") from None


def _is_number(value: Any) -> bool:
    """Whether it is a number; one that is not finite says that a check failed."""
    return isinstance(value, int | float | np.number) and not isinstance(value, bool)


def _refuse_words(name: str, described: Mapping[str, Any]) -> None:
    for key in ("units", "long_name"):
        word = described.get(key, "")
        if not isinstance(word, str) or not word.isprintable():
            raise ValueError(f"variable '{name}': its {key} = {show(word)}: must be a word")
    units, known = described.get("units"), find_unit(name)
    if known is not None and units != known:
        raise ValueError(f"variable '{name}' has the unit {show(units)}: must be {known!r}")


def _refuse_shape(
    name: str, dimensions: tuple[str, ...], values: np.ndarray, variables: Variables
) -> None:
    """Refuse a variable that is as long as no other along one of its dimensions."""
    for each, length in zip(dimensions, values.shape, strict=True):
        known = variables[each][1].shape if each in variables else (length,)
        if known != (length,):
            raise ValueError(
                f"variable '{name}' has {length} values along {each}: must have as many as "
                f"'{each}', {known[0] if known else 'a single number'}"
            )


def _refuse_variable(
    name: str, dimensions: tuple[str, ...], variables: Variables, *, gaps: bool
) -> None:
    """Refuse a variable that a mode needs and has otherwise."""
    found, values, _ = variables[name]
    if tuple(found) != dimensions:
        wanted = ", ".join(dimensions)
        raise ValueError(f"variable '{name}' is over ({', '.join(found)}): must be over ({wanted})")
    least, most = SAMPLES.get(name, (0, values.size))
    if not least <= values.size <= most:
        wanted = f"must have {least} to {most}"
        raise ValueError(f"variable '{name}' has {values.size} values: {wanted}")
    if name == "branch" and dimensions == ("branch",):
        if sorted(map(str, values)) != sorted(BRANCHES):
            raise ValueError(f"variable 'branch' must hold {join_with_or(BRANCHES)}, each once")
        return
    refuse_values(name, values, gaps=gaps)
    if name in RISING and not (np.diff(values) > 0).all():
        raise ValueError(f"variable '{name}' must rise from value to value")


def refuse_values(name: str, values: np.ndarray, *, gaps: bool) -> None:
    """Refuse values that are no numbers, or larger than what the unit of a known name allows."""
    if values.dtype.kind not in "fiu":
        raise ValueError(f"variable '{name}' holds {show(values.dtype.name)}: must hold numbers")
    units = find_unit(name)
    largest = _LARGEST.get(str(units), _LARGEST_BY_DEFAULT)
    numbers = values[~np.isnan(values)] if gaps else values
    wrong = ~(np.abs(numbers) <= largest)
    if wrong.any():
        value = numbers[wrong][0]
        valid = "a finite number" if np.isnan(value) else f"within {largest:g}"
        raise ValueError(f"variable '{name}' holds {value:g} {units}: must be {valid}")
