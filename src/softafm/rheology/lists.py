"""One-line refusals of bad lists of numbers: field, index, value, unit and what would be valid."""

from typing import Any

import numpy as np

from softafm.checks.validate import check_numbers, refuse_masked


def check_positives(name: str, values: Any, unit: str, *, zeros: bool = False) -> tuple[float, ...]:
    """Return the values as a tuple of floats above zero, or not below it if ``zeros``."""
    checked = check_numbers(name, values, unit)
    for index, number in enumerate(checked):
        entry = f"{name}[{index}]"
        if zeros and number < 0:
            raise ValueError(f"{entry} = {number:g} {unit}: must not be negative")
        if not zeros and number <= 0:
            raise ValueError(f"{entry} = {number:g} {unit}".rstrip() + ": must be greater than 0")
    return checked


def check_count(
    name: str, values: tuple[Any, ...], as_name: str, as_values: tuple[Any, ...]
) -> None:
    """Refuse two lists of different lengths."""
    if len(values) != len(as_values):
        raise ValueError(
            f"{name} has {len(values)} entries: must have as many as {as_name}, {len(as_values)}"
        )


def check_points(name: str, values: Any, unit: str, least: float | None = None) -> np.ndarray:
    """Return numbers as an array of floats if all are above zero, or at least ``least``."""
    refuse_masked(name, values)
    try:
        array = np.asarray(values, float)
    except (TypeError, ValueError):
        raise ValueError(f"{name} = {values!r}: must be numbers in {unit}") from None
    bad = np.argwhere(~(np.isfinite(array) & ((array > 0) if least is None else (array >= least))))
    if bad.shape[0]:
        where = tuple(int(i) for i in bad[0])
        entry = name + (f"[{', '.join(map(str, where))}]" if where else "")
        valid = "greater than 0" if least is None else f"at least {least:g}"
        raise ValueError(f"{entry} = {array[where]:g} {unit}: must be finite and {valid}")
    return array


def check_window(values: Any) -> tuple[float, float]:
    """Return the shortest and the longest time of a window (s)."""
    times = check_positives("window", values, "s")
    if len(times) != 2 or not times[0] < times[1]:
        shown = ", ".join(f"{time:g}" for time in times)
        raise ValueError(
            f"window = ({shown}) s: must be the shortest and a longer time of the experiment"
        )
    return times[0], times[1]
