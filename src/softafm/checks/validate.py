"""One-line refusals of bad numbers: field, value, unit and what would be valid."""

from math import isfinite
from typing import Any

import numpy as np

from softafm.checks.plausible import doubt

LARGEST_TABOR = 1000.0
"""Tabor number up to which the default solver is known to take a surface law as it is: benchmarks
and tests go so far, elastic and viscoelastic contacts together."""


def check_positive(name: str, value: float, unit: str) -> float:
    """Return ``value`` as a float if it is finite and above zero, else raise ValueError."""
    number = _check_number(name, value, unit)
    if number <= 0:
        raise ValueError(f"{name} = {number:g} {unit}".rstrip() + ": must be greater than 0")
    doubt(name, number, unit)
    return number


def check_finite(name: str, value: float, unit: str) -> float:
    """Return ``value`` as a float if it is a finite real number, else raise ValueError."""
    number = _check_number(name, value, unit)
    doubt(name, number, unit)
    return number


def _check_number(name: str, value: float, unit: str) -> float:
    refuse_masked(name, value)
    try:
        if isinstance(value, bool | str | bytes):
            raise TypeError
        number = float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} = {value!r}: must be a number{_write_unit(unit)}") from None
    if not isfinite(number):
        raise ValueError(f"{name} = {number} {unit}".rstrip() + ": must be a finite number")
    return number


def _write_unit(unit: str) -> str:
    return f" in {unit}" if unit else ""


def check_between(name: str, value: float, unit: str, least: float, most: float) -> float:
    """Return ``value`` as a float if it lies from ``least`` to ``most``."""
    number = _check_number(name, value, unit)
    if not least <= number <= most:
        shown = f"{name} = {number:g} {unit}".rstrip()
        raise ValueError(f"{shown}: must be between {least:g} and {most:g} {unit}".rstrip())
    return number


def check_numbers(name: str, values: Any, unit: str) -> tuple[float, ...]:
    """Return the values as a tuple of finite floats, else raise ValueError naming the entry."""
    if isinstance(values, str | bytes | dict) or not hasattr(values, "__iter__"):
        raise ValueError(f"{name} = {values!r}: must be a list of numbers{_write_unit(unit)}")
    refuse_masked(name, values)
    found = tuple(_check_number(f"{name}[{i}]", value, unit) for i, value in enumerate(values))
    if found:
        largest = max(range(len(found)), key=lambda i: abs(found[i]))
        doubt(f"{name}[{largest}]", found[largest], unit)
    return found


def refuse_masked(name: str, values: Any) -> None:
    """Raise ValueError if entries of an array are masked: NumPy would read through the mask."""
    if not isinstance(values, np.ma.MaskedArray):
        return
    for index in np.argwhere(np.ma.getmaskarray(values)):
        entry = f"{name}[{', '.join(map(str, index))}]" if index.size else name
        raise ValueError(f"{entry} is masked: must be a number; leave masked entries out")


def check_whole(name: str, value: int, least: int, most: int) -> int:
    """Return ``value`` if it is a whole number from ``least`` to ``most``."""
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise ValueError(f"{name} = {value!r}: must be a whole number from {least} to {most}")
    return value


def check_choice(name: str, value: Any, choices: tuple[Any, ...]) -> Any:
    """Return ``value`` if it is one of the choices."""
    if not any(
        value is choice or (isinstance(value, str) and value == choice) for choice in choices
    ):
        valid = " or ".join(map(repr, choices))
        raise ValueError(f"{name} = {value!r}: must be {valid}")
    return value


def check_poisson_ratio(value: float, name: str = "poisson") -> float:
    """Return ``value`` if it lies in (-1, 0.5], the range of stable isotropic solids."""
    number = check_finite(name, value, "")
    if not -1 < number <= 0.5:
        raise ValueError(f"{name} = {number:g}: must be above -1 and at most 0.5")
    return number


def check_tolerance(value: float) -> float:
    """Return ``value`` if it is a tolerance that solvers can keep, 1e-5 to 0.1."""
    return check_between("tolerance", value, "", 1e-5, 0.1)


def check_tabor(name: str, value: float) -> float:
    """Return ``value`` if it is a Tabor number that a contact can be given, 0.1 to 1000."""
    return check_between(name, value, "", 0.1, LARGEST_TABOR)
