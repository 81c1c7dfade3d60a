"""One-line refusals of numbers outside a range."""

from softafm._validate import finite

SHORTEST, LONGEST = 2e-12, 1e-6
"""Lengths that surface forces may have, m: from a hundredth of an atom to a wave of light."""


def between(name: str, value: float, unit: str, least: float, most: float) -> float:
    """Return ``value`` as a float if it lies from ``least`` to ``most``."""
    number = finite(name, value, unit)
    if not least <= number <= most:
        shown = f"{name} = {number:g} {unit}".rstrip()
        raise ValueError(f"{shown}: must be between {least:g} and {most:g} {unit}".rstrip())
    return number


def length(name: str, value: float) -> float:
    """Return ``value`` as a float if it is a length (m) that surface forces may have."""
    return between(name, value, "m", SHORTEST, LONGEST)
