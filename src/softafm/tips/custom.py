"""A tip whose profile is a function of the user's own."""

from collections.abc import Callable
from dataclasses import dataclass
from math import log
from typing import ClassVar

import numpy as np

from softafm.compiled.formulas import Term, bound_parameters, find_first_line
from softafm.tips.tip import Tip

_RADII = np.geomspace(1e-13, 1e-2, 1101)
_NOISE = 1e-15
"""Heights that differ by less, m, count as equal: it is how cancellation looks near the apex."""
_NEAR, _NEARER = 1e-11, 1e-13
_CORNER = 1e-5
"""A slope at the innermost radius below which there is no corner."""
_LEAST_EXPONENT = 1.9


@dataclass(frozen=True, init=False)
class CustomTip(Tip):
    """Profile given by a function ``f(radius, a, b, ...) -> height`` of plain Python.

    The function takes and returns single numbers, in m, and is compiled by numba at its first use;
    it may branch, loop, and call ``math``, NumPy's functions and other ``@njit`` functions.

    Parameters
    ----------
    function
        A function of the radial coordinate and of parameters, plain or decorated with ``@njit``.
    **parameters
        Values of the parameters, SI, by the names they have in the function.

    Raises
    ------
    ValueError
        If the parameters do not match the function, it cannot be compiled, or it is no profile. It
        must be 0 at radius 0, with neither corner nor infinite curvature there, and from 1e-13 m
        to 1e-2 m be finite, never fall, and still rise at the end.
    """

    kind: ClassVar[str] = "custom"
    function: Callable
    parameters: tuple[tuple[str, float], ...]

    def __init__(self, function: Callable, /, **parameters: float):
        object.__setattr__(self, "function", function)
        bound = bound_parameters(function, "radius", parameters)
        object.__setattr__(self, "parameters", bound)
        self._refuse_what_is_no_profile()

    @property
    def term(self) -> Term:
        """The function with the values of its parameters."""
        return Term(self.function, tuple(value for _, value in self.parameters))

    def profile(self, r):
        """Height of the tip surface above its apex at radial coordinate ``r``, m."""
        r = np.asarray(r, float)
        compiled, values = self.compiled_profile
        height = np.empty(r.size)
        compiled(np.ascontiguousarray(r).ravel(), values, height, r.size)
        return height.reshape(r.shape)[()]

    def _refuse_what_is_no_profile(self) -> None:
        name = getattr(self.function, "__name__", "function")
        try:
            height = self.profile(np.append(0.0, _RADII))
        except Exception as error:  # numba raises many types
            raise ValueError(
                f"function = {name}: must be one that numba compiles and that has a value at any "
                f"radius: {find_first_line(error)}"
            ) from error
        r = np.append(0.0, _RADII)
        for i in np.flatnonzero(~np.isfinite(height)):
            raise ValueError(f"function = {name}: {height[i]:g} m at {r[i]:g} m: must be finite")
        if abs(height[0]) > _NOISE:
            raise ValueError(f"function = {name}: {height[0]:g} m at radius 0: must be 0, the apex")
        highest = np.maximum.accumulate(height)
        for i in np.flatnonzero(height < highest * (1 - 1e-12) - _NOISE):
            j = int(np.argmax(height[:i]))
            raise ValueError(
                f"function = {name}: {height[i]:g} m at {r[i]:g} m, but {height[j]:g} m at "
                f"{r[j]:g} m: must never fall"
            )
        if not highest[-1] > highest[-101] * (1 + 1e-9) + _NOISE:
            raise ValueError(
                f"function = {name}: {height[-1]:g} m from {r[-101]:g} m to {r[-1]:g} m: must go "
                "on rising"
            )
        near, nearer = self.profile(np.array([_NEAR, _NEARER])) / (_NEAR, _NEARER)
        if nearer > _CORNER:
            exponent = 1 + log(near / nearer) / log(_NEAR / _NEARER)
            if exponent < _LEAST_EXPONENT:
                raise ValueError(
                    f"function = {name}: rises as radius^{exponent:.2g} at radius 0: must rise as "
                    "radius^2 or slower, with neither a corner nor an infinitely sharp apex"
                )
