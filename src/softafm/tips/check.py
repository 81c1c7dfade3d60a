"""What a profile must be, whether a function or a class of the user's own states it."""

from collections.abc import Callable
from math import log
from typing import Any

import numpy as np

from softafm.checks.kinds import check_kind, is_built_in
from softafm.compiled.formulas import find_first_line

_RADII = np.append(0.0, np.geomspace(1e-13, 1e-2, 1101))
_NOISE = 1e-15
"""Heights that differ by less, m, count as equal: it is how cancellation looks near the apex."""
_NEAR, _NEARER = 1e-11, 1e-13
_CORNER = 1e-5
"""A slope at the innermost radius below which there is no corner."""
_LEAST_EXPONENT = 1.9


def check_tip(tip: Any) -> None:
    """Raise ValueError if a tip of a class of the user's own has no name or no profile."""
    if is_built_in(tip):
        return
    check_kind("tip", tip)
    check_profile(
        f"tip '{tip.kind}'",
        tip.profile,
        "its term must be a formula of arrays with a height at any radius",
    )


def check_profile(wrong: str, profile: Callable[[np.ndarray], np.ndarray], must: str) -> None:
    """Raise ValueError if a function of radii, m, is no profile of a tip.

    Parameters
    ----------
    wrong
        What the refusal is about, as it begins.
    profile
        Heights at some radii.
    must
        What the refusal asks for where there are no heights.
    """
    height = _evaluate(wrong, profile, must)
    r = _RADII
    for i in np.flatnonzero(~np.isfinite(height)):
        raise ValueError(f"{wrong}: {height[i]:g} m at {r[i]:g} m: must be finite")
    if abs(height[0]) > _NOISE:
        raise ValueError(f"{wrong}: {height[0]:g} m at radius 0: must be 0, the apex")
    highest = np.maximum.accumulate(height)
    for i in np.flatnonzero(height < highest * (1 - 1e-12) - _NOISE):
        j = int(np.argmax(height[:i]))
        raise ValueError(
            f"{wrong}: {height[i]:g} m at {r[i]:g} m, but {height[j]:g} m at {r[j]:g} m: must "
            "never fall"
        )
    if not highest[-1] > highest[-101] * (1 + 1e-9) + _NOISE:
        raise ValueError(
            f"{wrong}: {height[-1]:g} m from {r[-101]:g} m to {r[-1]:g} m: must go on rising"
        )
    near, nearer = profile(np.array([_NEAR, _NEARER])) / (_NEAR, _NEARER)
    if nearer > _CORNER:
        exponent = 1 + log(near / nearer) / log(_NEAR / _NEARER)
        if exponent < _LEAST_EXPONENT:
            raise ValueError(
                f"{wrong}: rises as radius^{exponent:.2g} at radius 0: must rise as radius^2 or "
                "slower, with neither a corner nor an infinitely sharp apex"
            )


def _evaluate(wrong: str, profile: Callable[[np.ndarray], np.ndarray], must: str) -> np.ndarray:
    try:
        with np.errstate(all="ignore"):
            height: Any = profile(_RADII)
        if not isinstance(height, np.ndarray):
            raise TypeError(f"it returns {height!r:.40}")
        if height.shape != _RADII.shape or height.dtype.kind not in "fiu":
            raise TypeError(f"{_RADII.size} radii give {height.dtype} of shape {height.shape}")
    except Exception as error:  # numba raises many types, and so does code of the user's
        raise ValueError(f"{wrong}: {must}: {find_first_line(error)}") from error
    return height
