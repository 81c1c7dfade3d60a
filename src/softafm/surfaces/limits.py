"""Lengths that surface forces may have."""

from softafm.checks.validate import check_between

SHORTEST, LONGEST = 2e-12, 1e-6
"""Lengths that surface forces may have, m: from a hundredth of an atom to a wave of light."""


def check_length(name: str, value: float) -> float:
    """Return ``value`` as a float if it is a length (m) that surface forces may have."""
    return check_between(name, value, "m", SHORTEST, LONGEST)
