"""Compiled functions that solvers call: surface laws, tip profiles, motions.

They are first-class typed functions over whole arrays: a solver compiled once serves every law, tip
and motion, from the on-disk cache, at the speed of inlined code.
"""

from collections.abc import Callable
from functools import cache, cached_property
from hashlib import sha256
from typing import Any

from numba import float64, int64, njit, types, void
from numba.experimental.function_type import _get_wrapper_address
from numba.extending import typeof_impl

from softafm.formulas import Shape

_ARRAY = float64[::1]
_OPTIONS: dict[str, Any] = {
    "fastmath": {"reassoc", "contract", "nsz", "arcp"},
    # Loops that might raise ZeroDivisionError are not vectorised.
    "error_model": "numpy",
}

PRESSURE = void(_ARRAY, _ARRAY, _ARRAY, _ARRAY, int64)
"""``(gap, parameters, pressure, slope, n)``: p and dp/dh of the first n gaps, in Pa and Pa/m.

``parameters[0]`` is the origin that gaps are counted from, m."""

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

    def __init__(self, function: Callable, signature: Any, on_disk: bool = True):
        self._python, self._signature, self._on_disk = function, signature, on_disk
        self.__doc__ = function.__doc__

    @cached_property
    def _compiled(self):
        return njit(self._signature, cache=self._on_disk, **_OPTIONS)(self._python)

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


@cache
def pressure_functions(shapes: tuple[Shape, ...]) -> tuple[CompiledFunction, CompiledFunction]:
    """Compile the sum of laws ``f(gap, ...) -> (pressure, slope, potential)``: p and Φ.

    ``shapes`` are those of the law's terms. The functions' parameters are the origin that gaps are
    counted from, m, then those of the terms.
    """
    arguments, gap = "gap, parameters, pressure, slope, n", "gap[i] + parameters[0]"
    pressure = _loop(shapes, arguments, gap, 1, ("pressure", "slope", ""))
    potential = _loop(shapes, "gap, parameters, potential, n", gap, 1, ("", "", "potential"))
    on_disk = all(map(_is_ours, shapes))
    return (
        CompiledFunction(pressure, PRESSURE, on_disk),
        CompiledFunction(potential, POTENTIAL, on_disk),
    )


@cache
def profile_function(shape: Shape) -> CompiledFunction:
    """Compile a tip profile ``f(radius, ...) -> height``."""
    profile = _loop((shape,), "radius, parameters, profile, n", "radius[i]", 0, ("profile",))
    return CompiledFunction(profile, PROFILE, _is_ours(shape))


def _is_ours(shape: Shape) -> bool:
    """Whether compiled code may be kept on disk: a user's may depend on more than its file."""
    return shape.function.__module__.startswith("softafm.")


def _loop(shapes: tuple[Shape, ...], arguments: str, x: str, first: int, results) -> Callable:
    """Write the function that adds up formulas over an array, as dataclasses write methods.

    Parameters start at index ``first``. ``results`` names the array for each result of a formula,
    "" where there is none. The function passes for one of the first formula's file, where numba
    looks for changes.
    """
    known: dict[str, Any] = {"__name__": _python(shapes[0].function).__module__}
    lines, calls = [f" at = {first}"], []
    for k, (function, count) in enumerate(shapes):
        known[f"formula_{k}"] = function if _is_compiled(function) else _formula(function)
        if count is None:
            names = [f"table_{k}"]
            lines.append(f" table_{k} = parameters[at + 1 : at + 1 + int(parameters[at])]")
            lines.append(" at += 1 + int(parameters[at])")
        else:
            names = [f"p{i}_{k}" for i in range(count)]
            lines += [f" {name} = parameters[at + {i}]" for i, name in enumerate(names)]
            lines.append(f" at += {count}")
        found = ", ".join(f"y{j}_{k}" for j in range(len(results)))
        calls.append(f"  {found} = formula_{k}({', '.join(['x', *names])})")
    lines += [" for i in range(n):", f"  x = {x}", *calls]
    for j, array in enumerate(results):
        if array:
            total = " + ".join(f"y{j}_{k}" for k in range(len(shapes)))
            lines.append(f"  {array}[i] = {total}")
    body = "\n".join(lines)
    codes = [_python(shape.function).__code__ for shape in shapes]
    key = body + "".join(f"{c.co_code!r}{c.co_consts!r}{c.co_names!r}" for c in codes)
    name = f"loop_{sha256(key.encode()).hexdigest()[:16]}"
    exec(compile(f"def {name}({arguments}):\n{body}\n", codes[0].co_filename, "exec"), known)
    return known[name]


def _formula(function: Callable) -> Callable:
    return njit(function, **_OPTIONS)


def _is_compiled(function: Callable) -> bool:
    return hasattr(function, "py_func")


def _python(function: Callable) -> Any:
    return getattr(function, "py_func", function)
