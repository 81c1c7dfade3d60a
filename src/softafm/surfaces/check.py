"""What a law must be, whether a function or a class of the user's own states it."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from softafm.checks.kinds import check_kind, is_built_in
from softafm.compiled.formulas import find_first_line

if TYPE_CHECKING:
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


def check_law(law: "SurfaceLaw") -> None:
    """Raise ValueError if a law of a class of the user's own, or a sum with one, is no law."""
    parts = [part for part in getattr(law, "parts", (law,)) if not is_built_in(part)]
    for part in parts:
        check_kind("surface", part)
        check_pressure(
            f"surface law '{part.kind}'",
            part,
            "its terms must be formulas of arrays that return (pressure, slope, potential) at any "
            "gap",
        )
    if parts:
        check_repulsion(law.kind, _GAPS[0], float(law.pressure(_GAPS[0])))


def check_repulsion(kind: str, gap: float, pressure: float) -> None:
    """Raise ValueError if a law does not repel, by its pressure, Pa, at a very small gap, m."""
    if not pressure > 0:
        raise ValueError(
            f"surface law '{kind}': its pressure at a gap of {gap:g} m is {pressure:.3g} Pa; it "
            "must repel (above 0) when the surfaces come close, so add a repulsion"
        )


def check_pressure(wrong: str, law: "SurfaceLaw", must: str) -> None:
    """Raise ValueError if pressure, slope and potential of a law do not belong together.

    Parameters
    ----------
    wrong
        What the refusal is about, as it begins.
    law
        The law, asked at gaps from 1e-12 m to 1e-6 m.
    must
        What the refusal asks for where there are no three numbers.
    """
    p, slope, potential, far = _evaluate(wrong, law, must)
    tension = max(float(np.max(-p, initial=0.0, where=np.isfinite(p))), 1e6)
    checked = ~(p > _STRONGEST * tension)
    h, p, slope, potential = (a[checked] for a in (_GAPS, p, slope, potential))
    for name, values in (("pressure", p), ("slope", slope), ("potential", potential)):
        for i in np.flatnonzero(~np.isfinite(values)):
            raise ValueError(f"{wrong}: {name} {values[i]:g} at {h[i]:.4g} m: must be finite")
    for name, claimed, of, sign in (
        ("slope", slope, law.pressure, 1),
        ("pressure", p, law.potential, -1),
    ):
        found = sign * _differentiate(of, h)
        values = np.abs(of(h))
        scale = np.abs(claimed) + (values + _NOISE * values.max(initial=0.0)) / h
        off = np.abs(claimed - found) > _TOLERANCE * scale
        for i in np.flatnonzero(off[1:] & off[:-1]):  # one alone may be at a kink
            unit, rule = ("Pa/m", "dp/dh") if sign > 0 else ("Pa", "−dΦ/dh")
            raise ValueError(
                f"{wrong}: {name} {claimed[i]:.6g} {unit} at {h[i]:.4g} m: must be {rule} = "
                f"{found[i]:.6g} {unit}"
            )
    if not abs(far) <= _TOLERANCE * np.max(np.abs(potential), initial=0.0):
        raise ValueError(
            f"{wrong}: potential {far:.6g} J/m² at {_FAR:g} m: must vanish at large gaps"
        )


def _evaluate(wrong: str, law: "SurfaceLaw", must: str) -> tuple[Any, ...]:
    """Return pressure, slope and potential at the gaps, and the potential far away."""
    try:
        with np.errstate(all="ignore"):
            found = [np.asarray(of(_GAPS)) for of in (law.pressure, law.slope, law.potential)]
            far = float(law.potential(_FAR))
        for each in found:
            if each.shape not in (_GAPS.shape, ()) or each.dtype.kind not in "fiu":
                raise TypeError(f"{_GAPS.size} gaps give {each.dtype} of shape {each.shape}")
    except Exception as error:  # numba raises many types, and so does code of the user's
        raise ValueError(f"{wrong}: {must}: {find_first_line(error)}") from error
    return *(np.broadcast_to(each, _GAPS.shape) for each in found), far


def _differentiate(function: Callable[[np.ndarray], np.ndarray], h: np.ndarray) -> np.ndarray:
    step = _STEP * h
    near = function(h + step) - function(h - step)
    return (8 * near - (function(h + 2 * step) - function(h - 2 * step))) / (12 * step)
