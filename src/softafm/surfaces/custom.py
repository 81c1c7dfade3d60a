"""A surface law that is a function of the user's own."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from softafm.compiled.formulas import Term, bound_parameters
from softafm.surfaces.check import check_pressure
from softafm.surfaces.law import SurfaceLaw


@dataclass(frozen=True, init=False)
class CustomSurface(SurfaceLaw):
    """Law given by a Python function ``f(gap, a, b, ...) -> (pressure, slope, potential)``.

    The function takes and returns single numbers, in m, Pa, Pa/m and J/m², and is compiled by numba
    at once, so that it runs as fast as a built-in law; it may branch, loop, and call ``math``,
    NumPy's functions and other ``@njit`` functions. It is asked at gaps above 0 only.

    Parameters
    ----------
    function
        A function of the gap and of parameters, plain or decorated with ``@njit``.
    **parameters
        Values of the parameters, SI, by the names they have in the function.

    Raises
    ------
    ValueError
        If the parameters do not match the function, it cannot be compiled or does not return three
        numbers, or these are not consistent: slope = dp/dh, pressure = −dΦ/dh and Φ(∞) = 0. They
        are checked at gaps from 1e-12 m to 1e-6 m.
    """

    kind: ClassVar[str] = "custom"
    function: Callable[..., Any]
    parameters: tuple[tuple[str, float], ...]

    def __init__(self, function: Callable[..., Any], /, **parameters: float) -> None:
        object.__setattr__(self, "function", function)
        object.__setattr__(self, "parameters", bound_parameters(function, "gap", parameters))
        check_pressure(
            f"function = {getattr(function, '__name__', 'function')}",
            self,
            "must be one that numba compiles and that returns (pressure, slope, potential) at any "
            "gap",
        )

    @property
    def terms(self) -> tuple[Term]:
        """The function with the values of its parameters."""
        return (Term(self.function, tuple(value for _, value in self.parameters)),)

    def _evaluate(self, gap: ArrayLike) -> tuple[np.ndarray, ...]:
        h = np.asarray(gap, float)
        flat = np.ascontiguousarray(h).ravel()
        pressure, potential, values = self.compiled_pressure
        p, slope, energy = np.empty((3, flat.size))
        pressure(flat, values, p, slope, flat.size)
        potential(flat, values, energy, flat.size)
        return tuple(result.reshape(h.shape)[()] for result in (p, slope, energy))
