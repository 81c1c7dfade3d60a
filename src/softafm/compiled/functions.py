"""Compiled functions: the solvers' loops, and the laws, tip profiles and motions that they call.

The latter are first-class typed functions over whole arrays: a solver compiled once serves every
law, tip and motion, from the store on disk, at the speed of inlined code.
"""

import pickle
import sys
from collections.abc import Callable
from functools import cache, cached_property, partial
from hashlib import sha256
from types import FunctionType
from typing import Any

from numba import config, float64, int64, njit, types, void
from numba.core import cgutils
from numba.core.caching import _Cache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps
from numba.experimental.function_type import FunctionModel, _get_wrapper_address
from numba.extending import NativeValue, register_model, typeof_impl, unbox

from softafm.compiled import store
from softafm.compiled.formulas import Shape

if config.DISABLE_JIT:
    raise RuntimeError(
        "NUMBA_DISABLE_JIT is set, so that numba compiles nothing, and softafm needs compiled "
        "code; unset it"
    )

_ARRAY = float64[::1]
_OPTIONS: dict[str, Any] = {
    "fastmath": {"reassoc", "contract", "nsz", "arcp"},
    # Loops that might raise ZeroDivisionError are not vectorised.
    "error_model": "numpy",
}
_NO_MEMORY: dict[str, Any] = {"_nrt": False}
"""Of loops that take no memory, and so need not count the references to that of their arrays."""

_NO_POINTER: dict[str, Any] = {"no_cfunc_wrapper": True}
"""Of loops that no other loop calls by an address: wrapping their arrays takes long to compile."""

INTERNAL: dict[str, Any] = {"no_cpython_wrapper": True}
"""Options of loops that are called from other loops only, and not from Python."""

PRESSURE = void(_ARRAY, _ARRAY, _ARRAY, _ARRAY, int64)
"""``(gap, parameters, pressure, slope, n)``: p and dp/dh of the first n gaps, in Pa and Pa/m.

``parameters[0]`` is the origin that gaps are counted from, m."""

POTENTIAL = void(_ARRAY, _ARRAY, _ARRAY, int64)
"""``(gap, parameters, potential, n)``: interaction energy per area Φ, with Φ' = -p, in J/m²."""

PROFILE = void(_ARRAY, _ARRAY, _ARRAY, int64)
"""``(radius, parameters, profile, n)``: height g of the tip surface above its apex, in m."""

HEIGHT = float64(float64, _ARRAY)
"""``(time, parameters) -> height``: tip height above the undeformed surface, in m."""

RESPONSE = types.UniTuple(float64, 2)(float64, float64, float64, float64, _ARRAY, _ARRAY)
"""``(time, step, deflection, force, parameters, state) -> (rest, stiffness)`` of a lever over the
step, s, that ends at ``time`` and begins with this deflection, m, and force, N; in m and N/m.

A lever of infinite stiffness keeps its deflection."""

ACCEPTANCE = void(float64, float64, float64, float64, _ARRAY, _ARRAY)
"""``(time, step, before, force, parameters, state)``: let the lever remember, in ``state``, that
the force on it went from one to the other, N, in the step that ended at ``time``."""


def compile_for(signature: Any, **options: Any) -> Callable[[Callable], Any]:
    """Decorate a function, to be compiled for ``signature`` here and now, or taken from the store.

    Parameters
    ----------
    signature
        Types of the arguments, with that of what it returns if that is to be stated, for numba.
    options
        Of ``numba.njit``, in place of those that all loops have.

    Raises
    ------
    RuntimeError
        If the function's file is not among those that a build is named after.
    """

    def compile_now(function: Callable) -> Any:
        if not store.is_ours(function.__code__.co_filename):
            raise RuntimeError(f"{function.__code__.co_filename} is not in store.ROOMS")
        dispatcher = njit(**(_OPTIONS | _NO_MEMORY | _NO_POINTER | options))(function)
        dispatcher._cache = _Store(function)
        with store.take_turns():
            dispatcher.compile(signature)
        dispatcher.disable_compile()
        return dispatcher

    return compile_now


def enter(loop: Any) -> Callable:
    """Return a compiled loop for calls from Python that takes its arguments to be of its types.

    To look at the types of many arrays and records takes 20 µs at every call.
    """
    return next(iter(loop.overloads.values())).entry_point


def fix(function: Callable, name: str, **known: Any) -> Any:
    """Return a function under another name to which some globals are constants.

    Compiled, it is then free of all that those rule out.
    """
    fixed = FunctionType(function.__code__, {**function.__globals__, **known}, name)
    fixed.__module__, fixed.__qualname__ = function.__module__, name
    fixed.__doc__ = function.__doc__
    return fixed


def inline(function: Callable) -> Any:
    """Decorate a function that is written into the compiled loops which call it.

    To hand over many arrays would take as long as its work.
    """
    return njit(inline="always", **_OPTIONS, **_NO_MEMORY)(function)


class _Store(_Cache):
    """Numba's way to the compiled code of one function in ``softafm.compiled.store``.

    Its own cache notices changes of the file that a function is in, but not of others whose
    functions it calls.
    """

    cache_path = ""
    _warned = False

    def __init__(self, function: Callable):
        self._name = f"{function.__module__}.{function.__qualname__}"

    def load_overload(self, sig, target_context):
        """Return the code compiled for a signature, None if there is none."""
        target_context.refresh()
        content = store.read(self._file(sig))
        if content is None:
            return None
        return CompileResult._rebuild(target_context, *pickle.loads(content))

    def save_overload(self, sig, data):
        """Keep the code compiled for a signature."""
        try:
            store.write(self._file(sig), dumps(data._reduce()))
        except OSError as error:
            if not _Store._warned:
                _Store._warned = True
                reason = f"softafm: compiled code cannot be kept: {error.strerror or error}"
                remedy = "set NUMBA_CACHE_DIR to a folder that can be written"
                print(f"{reason}; {remedy}", file=sys.stderr)

    def _file(self, signature) -> str:
        typed = sha256(f"{self._name}\0{signature}".encode()).hexdigest()
        return f"{self._name}-{typed[:16]}"

    def enable(self):
        """Do nothing: it always serves."""

    def disable(self):
        """Do nothing: it always serves."""

    def flush(self):
        """Do nothing: code of another build is never found."""


class Pointer(types.FunctionType):
    """The type by which kernels know a ``CompiledFunction``: numba's, but quick to hand over."""


register_model(Pointer)(FunctionModel)


@unbox(Pointer)
def _hand_over(typ, function, c):
    """Read the address that the function keeps: numba looks for it for 7 µs at every call."""
    address = c.pyapi.object_getattr_string(function, "address")
    with c.builder.if_then(cgutils.is_null(c.builder, address), likely=False):
        c.builder.ret(c.pyapi.get_null_object())
    handed = cgutils.create_struct_proxy(typ)(c.context, c.builder)
    handed[0] = c.pyapi.long_as_voidptr(address)  # the others are not called by
    c.pyapi.decref(address)
    return NativeValue(handed._getvalue())


class CompiledFunction(types.WrapperAddressProtocol):
    """A function compiled for one signature, to be called from Python or handed to a kernel.

    It is compiled, or loaded from the store, at its first use, and its address is looked up
    once, and so is its type: numba would do that at every call, at 0.1 ms each.
    """

    def __init__(self, function: Callable, signature: Any, on_disk: bool = True):
        self._python, self._signature, self._on_disk = function, signature, on_disk
        self.__doc__ = function.__doc__

    @cached_property
    def _compiled(self):
        on_disk = partial(compile_for, no_cfunc_wrapper=False)
        compile_it = on_disk if self._on_disk else partial(njit, **_OPTIONS)
        return compile_it(self._signature)(self._python)

    @cached_property
    def address(self) -> int:
        """Where its machine code starts."""
        return _get_wrapper_address(self._compiled, self._signature)

    def __call__(self, *arguments):
        return self._compiled(*arguments)

    def __wrapper_address__(self) -> int:
        return self.address

    def signature(self):
        """The numba signature it is compiled for."""
        return self._signature

    @cached_property
    def numba_type(self) -> Pointer:
        """The type that kernels know it by."""
        return Pointer(self._signature)


@typeof_impl.register(CompiledFunction)
def _find_type(function, context):
    return function.numba_type


def pointer_to(signature: Any) -> Pointer:
    """Return the type of a first-class compiled function with this signature."""
    return Pointer(signature)


def compile_when_used(signature: Any) -> Callable[[Callable], CompiledFunction]:
    """Decorate a function, to be compiled for ``signature`` when it is first used.

    One of this package is kept on disk; a user's is compiled anew in every process.
    """

    def compile_later(function: Callable) -> CompiledFunction:
        on_disk = store.is_ours(function.__code__.co_filename)
        return CompiledFunction(function, signature, on_disk)

    return compile_later


@cache
def compile_pressure(shapes: tuple[Shape, ...]) -> tuple[CompiledFunction, CompiledFunction]:
    """Compile the sum of laws ``f(gap, ...) -> (pressure, slope, potential)``: p and Φ.

    ``shapes`` are those of the law's terms. The functions' parameters are the origin that gaps are
    counted from, m, then those of the terms.
    """
    arguments, gap = "gap, parameters, pressure, slope, n", "gap[i] + parameters[0]"
    pressure = _write_loop(shapes, arguments, gap, 1, ("pressure", "slope", ""))
    potential = _write_loop(shapes, "gap, parameters, potential, n", gap, 1, ("", "", "potential"))
    on_disk = all(map(_is_ours, shapes))
    return (
        CompiledFunction(pressure, PRESSURE, on_disk),
        CompiledFunction(potential, POTENTIAL, on_disk),
    )


@cache
def compile_profile(shape: Shape) -> CompiledFunction:
    """Compile a tip profile ``f(radius, ...) -> height``."""
    profile = _write_loop((shape,), "radius, parameters, profile, n", "radius[i]", 0, ("profile",))
    return CompiledFunction(profile, PROFILE, _is_ours(shape))


def _is_ours(shape: Shape) -> bool:
    """Whether compiled code may be kept on disk: nobody knows what a user's depends on."""
    return store.is_ours(_find_python(shape.function).__code__.co_filename)


def _write_loop(shapes: tuple[Shape, ...], arguments: str, x: str, first: int, results) -> Callable:
    """Write the function that adds up formulas over an array, as dataclasses write methods.

    Parameters start at index ``first``. ``results`` names the array for each result of a formula,
    "" where there is none.
    """
    known: dict[str, Any] = {"__name__": __name__}
    lines, calls = [f" at = {first}"], []
    for k, (function, count) in enumerate(shapes):
        known[f"formula_{k}"] = function if _is_compiled(function) else _compile_formula(function)
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
    codes = [_find_python(shape.function).__code__ for shape in shapes]
    key = body + "".join(f"{c.co_code!r}{c.co_consts!r}{c.co_names!r}" for c in codes)
    name = f"loop_{sha256(key.encode()).hexdigest()[:16]}"
    exec(compile(f"def {name}({arguments}):\n{body}\n", __file__, "exec"), known)
    return known[name]


def _compile_formula(function: Callable) -> Callable:
    return njit(function, **_OPTIONS)


def _is_compiled(function: Callable) -> bool:
    return hasattr(function, "py_func")


def _find_python(function: Callable) -> Any:
    return getattr(function, "py_func", function)
