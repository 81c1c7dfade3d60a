"""Compiled functions that solvers call: surface laws, tip profiles, motions.

They are first-class typed functions over whole arrays: a solver compiled once serves every law, tip
and motion, from the on-disk cache, at the speed of inlined code.
"""

from collections.abc import Callable
from functools import cached_property
from typing import Any

from numba import float64, int64, njit, types, void
from numba.experimental.function_type import _get_wrapper_address
from numba.extending import typeof_impl

_ARRAY = float64[::1]
_FAST = {"reassoc", "contract", "nsz", "arcp"}

PRESSURE = void(_ARRAY, _ARRAY, _ARRAY, _ARRAY, int64)
"""``(gap, parameters, pressure, slope, n)``: p and dp/dh of the first n gaps, in Pa and Pa/m."""

POTENTIAL = void(_ARRAY, _ARRAY, _ARRAY, int64)
"""``(gap, parameters, potential, n)``: interaction energy per area Φ, with Φ' = -p, in J/m²."""

PROFILE = void(_ARRAY, _ARRAY, _ARRAY, int64)
"""``(radius, parameters, profile, n)``: height g of the tip surface above its apex, in m."""

HEIGHT = float64(float64, _ARRAY)
"""``(time, parameters) -> height``: tip height above the undeformed surface, in m."""


class CompiledFunction(types.WrapperAddressProtocol):
    """A function compiled for one signature, to be called from Python or handed to a kernel.

    It is compiled, or loaded from the disk cache, at its first use, and its address is looked up
    once, and so is its type: numba would do that at every call, at 0.1 ms each.
    """

    def __init__(self, function: Callable, signature: Any):
        self._python, self._signature = function, signature
        self.__doc__ = function.__doc__

    @cached_property
    def _compiled(self):
        return njit(self._signature, cache=True, fastmath=_FAST)(self._python)

    @cached_property
    def _address(self) -> int:
        return _get_wrapper_address(self._compiled, self._signature)

    def __call__(self, *arguments):
        return self._compiled(*arguments)

    def __wrapper_address__(self) -> int:
        return self._address

    def signature(self):
        """The numba signature it is compiled for."""
        return self._signature

    @cached_property
    def numba_type(self) -> types.FunctionType:
        """The type that kernels know it by."""
        return types.FunctionType(self._signature)


@typeof_impl.register(CompiledFunction)
def _type_of(function, context):
    return function.numba_type


def pointer(signature: Any) -> types.FunctionType:
    """Return the type of a first-class compiled function with this signature."""
    return types.FunctionType(signature)


def compiled(signature: Any) -> Callable[[Callable], CompiledFunction]:
    """Decorate a function, to be compiled for ``signature`` when it is first used."""
    return lambda function: CompiledFunction(function, signature)
