"""Refusals of what closed forms are given."""

from math import inf

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.validate import check_positive, refuse_masked


def check_modulus(value: float) -> float:
    """Return a reduced modulus, Pa, if it is above zero."""
    return check_positive("modulus", value, "Pa")


def check_work(value: float) -> float:
    """Return a work of adhesion, J/m², if it is above zero."""
    return check_positive("work_of_adhesion", value, "J/m²")


def check_not_negative(name: str, values: ArrayLike) -> np.ndarray:
    """Return lengths, m, if all are finite and none is negative."""
    refuse_masked(name, values)
    array = np.asarray(values, float)
    bad = ~(np.isfinite(array) & (array >= 0))
    if np.any(bad):
        raise ValueError(f"{name} = {array[bad].flat[0]:g} m: must be finite and not negative")
    return array


def check_stiffness(value: float) -> float:
    """Return the stiffness of what pulls, N/m: 0 at a fixed load, infinite at fixed grips."""
    if not isinstance(value, int | float | np.number) or not value >= 0:
        raise ValueError(
            f"stiffness = {value!r} N/m: must be 0 (fixed load), above 0, or inf (fixed grips)"
        )
    return float(value) if value < inf else inf
