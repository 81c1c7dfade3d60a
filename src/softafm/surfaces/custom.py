"""A surface law that is a function of the user's own."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from softafm.compiled.formulas import Term, bound_parameters, find_first_line
from softafm.surfaces.law import SurfaceLaw

_GAPS = np.geomspace(1e-12, 1e-6, 301)
_FAR = 1.0
"""Gap at which the potential must have vanished, m."""
_STEP = 1e-4
"""Step of the differences that check the derivatives, in gaps."""
_TOLERANCE = 1e-3
_NOISE = 1e-9
"""Part of the largest pressure or potential below which rounding may hide its derivative."""
_STRONGEST = 1e4
"""Repulsions that exceed the largest tension, or 1 MPa, so many times are not checked."""


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
    function: Callable
    parameters: tuple[tuple[str, float], ...]

    def __init__(self, function: Callable, /, **parameters: float):
        object.__setattr__(self, "function", function)
        object.__setattr__(self, "parameters", bound_parameters(function, "gap", parameters))
        self._refuse_what_is_no_law()

    @property
    def terms(self) -> tuple[Term]:
        """The function with the values of its parameters."""
        return (Term(self.function, tuple(value for _, value in self.parameters)),)

    def _evaluate(self, gap):
        h = np.asarray(gap, float)
        flat = np.ascontiguousarray(h).ravel()
        pressure, potential, values = self.compiled_pressure
        p, slope, energy = np.empty((3, flat.size))
        pressure(flat, values, p, slope, flat.size)
        potential(flat, values, energy, flat.size)
        return tuple(result.reshape(h.shape)[()] for result in (p, slope, energy))

    def _refuse_what_is_no_law(self) -> None:
        wrong = f"function = {getattr(self.function, '__name__', 'function')}: "
        try:
            p, slope, potential = self._evaluate(_GAPS)
            far = float(self.potential(_FAR))
        except Exception as error:  # numba raises many types
            raise ValueError(
                f"{wrong}must be one that numba compiles and that returns (pressure, slope, "
                f"potential) at any gap: {find_first_line(error)}"
            ) from error
        tension = max(float(np.max(-p, initial=0.0, where=np.isfinite(p))), 1e6)
        checked = ~(p > _STRONGEST * tension)
        h, p, slope, potential = (a[checked] for a in (_GAPS, p, slope, potential))
        for name, values in (("pressure", p), ("slope", slope), ("potential", potential)):
            for i in np.flatnonzero(~np.isfinite(values)):
                raise ValueError(f"{wrong}{name} {values[i]:g} at {h[i]:.4g} m: must be finite")
        for name, claimed, of, sign in (
            ("slope", slope, self.pressure, 1),
            ("pressure", p, self.potential, -1),
        ):
            found = sign * _differentiate(of, h)
            values = np.abs(of(h))
            scale = np.abs(claimed) + (values + _NOISE * values.max(initial=0.0)) / h
            off = np.abs(claimed - found) > _TOLERANCE * scale
            for i in np.flatnonzero(off[1:] & off[:-1]):  # one alone may be at a kink
                unit, rule = ("Pa/m", "dp/dh") if sign > 0 else ("Pa", "−dΦ/dh")
                raise ValueError(
                    f"{wrong}{name} {claimed[i]:.6g} {unit} at {h[i]:.4g} m: must be {rule} = "
                    f"{found[i]:.6g} {unit}"
                )
        if not abs(far) <= _TOLERANCE * np.max(np.abs(potential), initial=0.0):
            raise ValueError(
                f"{wrong}potential {far:.6g} J/m² at {_FAR:g} m: must vanish at large gaps"
            )


def _differentiate(function, h):
    step = _STEP * h
    near = function(h + step) - function(h - step)
    return (8 * near - (function(h + 2 * step) - function(h - 2 * step))) / (12 * step)
