"""A tip whose profile is a function of the user's own."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from softafm.compiled.formulas import Term, bound_parameters
from softafm.tips.check import check_profile
from softafm.tips.tip import Tip


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
    function: Callable[..., Any]
    parameters: tuple[tuple[str, float], ...]

    def __init__(self, function: Callable[..., Any], /, **parameters: float) -> None:
        object.__setattr__(self, "function", function)
        bound = bound_parameters(function, "radius", parameters)
        object.__setattr__(self, "parameters", bound)
        check_profile(
            f"function = {getattr(function, '__name__', 'function')}",
            self.profile,
            "must be one that numba compiles and that has a value at any radius",
        )

    @property
    def term(self) -> Term:
        """The function with the values of its parameters."""
        return Term(self.function, tuple(value for _, value in self.parameters))

    def profile(self, r: ArrayLike) -> np.ndarray:
        """Height of the tip surface above its apex at radial coordinate ``r``, m."""
        r = np.asarray(r, float)
        compiled, values = self.compiled_profile
        height = np.empty(r.size)
        compiled(np.ascontiguousarray(r).ravel(), values, height, r.size)
        return height.reshape(r.shape)[()]
