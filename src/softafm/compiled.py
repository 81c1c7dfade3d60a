"""The shapes of compiled functions that solvers call: surface laws, tip profiles, motions.

They are first-class typed functions over whole arrays: a solver compiled once serves every law, tip
and motion, from the on-disk cache, at the speed of inlined code.
"""

import sys
from contextlib import contextmanager
from threading import Timer

from numba import float64, int64, njit, types, void

_ARRAY = float64[::1]

PRESSURE = void(_ARRAY, _ARRAY, _ARRAY, _ARRAY, int64)
"""``(gap, parameters, pressure, slope, n)``: p and dp/dh of the first n gaps, in Pa and Pa/m."""

POTENTIAL = void(_ARRAY, _ARRAY, _ARRAY, int64)
"""``(gap, parameters, potential, n)``: interaction energy per area Φ, with Φ' = -p, in J/m²."""

PROFILE = void(_ARRAY, _ARRAY, _ARRAY, int64)
"""``(radius, parameters, profile, n)``: height g of the tip surface above its apex, in m."""

HEIGHT = float64(float64, _ARRAY)
"""``(time, parameters) -> height``: tip height above the undeformed surface, in m."""


def pointer(signature: types.Type) -> types.FunctionType:
    """Return the type of a first-class compiled function with this signature."""
    return types.FunctionType(signature)


def compiled(signature: types.Type):
    """Decorate a function: compile it for ``signature`` now, or load it from the disk cache."""
    return njit(signature, cache=True, fastmath={"reassoc", "contract", "nsz", "arcp"})


@contextmanager
def announced_compilation(patience: float = 2.0):
    """Tell the user, on stderr, if what happens inside takes longer than ``patience`` seconds.

    Loading compiled code takes under a second; only a machine's first run waits for the compiler.
    """
    notice = Timer(
        patience,
        print,
        ["softafm: compiling for this machine, first use only (about 15 s) ..."],
        {"file": sys.stderr, "flush": True},
    )
    notice.daemon = True
    notice.start()
    try:
        yield
    finally:
        notice.cancel()
