"""What a body must be, where a class of the user's own states it."""

from collections.abc import Hashable
from math import inf
from typing import Any

import numpy as np

from softafm.bodies.hankel import HIGHEST
from softafm.bodies.layered import Layered
from softafm.checks.kinds import check_kind, is_built_in
from softafm.checks.validate import check_between, check_finite

_LOWEST = 1e-4
_INSIDE = np.geomspace(_LOWEST, HIGHEST, 200)
_BEYOND = np.linspace(HIGHEST, 5 * HIGHEST, 30)
_SAME = 1e-6
"""By how much a factor may differ from 1 where it counts as 1."""
_STEEPEST = 5.0
"""Of a factor that grows as 1/κ towards 0 the displacement is infinite; the decade there tells."""


def check_body(body: Any) -> None:
    """Raise ValueError if a body of a class of the user's own is none."""
    if is_built_in(body):
        return
    check_kind("sample", body)
    for name in ("length", "widest"):
        value = getattr(body, name)
        if (isinstance(body, Layered) and name == "length") or value != inf:
            _check_length(f"sample.{name}", value)
    if check_finite("sample.decay", body.decay, "1/m") < 0:
        raise ValueError(f"sample.decay = {body.decay:g} 1/m: must not be negative")
    if not isinstance(body.key, Hashable):
        raise ValueError(f"sample.key = {body.key!r}: must be hashable")
    if isinstance(body, Layered):
        _check_factor(body)


def _check_length(name: str, value: float) -> None:
    # No size is doubtful: a skin of a metre stands for one without end.
    if check_between(name, value, "m", -inf, inf) <= 0:
        raise ValueError(f"{name} = {value:g} m: must be greater than 0")


def _check_factor(body: Layered) -> None:
    inside, beyond = _evaluate(body, _INSIDE), _evaluate(body, _BEYOND)
    for i in np.flatnonzero(~(np.isfinite(inside) & (inside > 0))):
        _refuse(_INSIDE[i], inside[i], "be positive and finite")
    for i in np.flatnonzero(~(np.abs(beyond - 1) <= _SAME)):
        _refuse(_BEYOND[i], beyond[i], f"be 1 to six digits at wavenumbers from {HIGHEST:g} on")
    decade = _evaluate(body, _LOWEST * np.array([1, 10]))
    if decade[0] > _STEEPEST * decade[1]:
        _refuse(_LOWEST, decade[0], "level off towards 0, where what lies deepest answers alone")


def _evaluate(body: Layered, wavenumber: np.ndarray) -> np.ndarray:
    try:
        with np.errstate(all="ignore"):
            found: Any = body.factor(wavenumber)
        if not isinstance(found, np.ndarray):
            raise TypeError(f"it returns {found!r:.40}")
        if found.shape != wavenumber.shape or found.dtype.kind not in "fiu":
            raise TypeError(
                f"{wavenumber.size} wavenumbers give {found.dtype} of shape {found.shape}"
            )
    except Exception as error:  # code of the user's may raise anything
        raise ValueError(
            f"sample.factor: of the body '{body.kind}' must be a formula of arrays that returns as "
            f"many real numbers: {type(error).__name__}: {error}"
        ) from error
    return found


def _refuse(wavenumber: float, factor: float, must: str) -> None:
    raise ValueError(f"sample.factor = {factor:g} at wavenumber {wavenumber:g}: must {must}")
