"""Adhesive elastic contacts in the two limits: forces of short range (JKR), and of long (DMT)."""

from functools import partial
from math import inf, pi
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.validate import check_finite, check_positive
from softafm.indentation.check import (
    check_modulus,
    check_not_negative,
    check_stiffness,
    check_work,
)
from softafm.indentation.curve import (
    Curve,
    Parting,
    find_coordinate,
    find_last_state,
    make_parting,
)
from softafm.indentation.elastic import depth, hertz_force, load

if TYPE_CHECKING:
    from softafm.tips import Tip

_POINTS = 301
_SEARCHED = np.geomspace(1e-7, 1e7, 281)
"""Radii among which a contact parts, in radii at which the tip is W/E* high."""


def jkr_depth(
    tip: "Tip", contact_radius: ArrayLike, modulus: float, work_of_adhesion: float
) -> np.ndarray:
    """Depth of ``tip`` in an adhesive contact with short-ranged forces, m; negative when pulled.

    δ(a) − √(2πaW/E*) with δ(a) as in ``depth``, ``modulus`` E* in Pa and ``work_of_adhesion`` W in
    J/m². Of radii with the same depth the largest is the stable one.

    Raises
    ------
    ValueError
        If a number is out of range.

    References
    ----------
    K. L. Johnson, K. Kendall and A. D. Roberts, *Proc. R. Soc. Lond. A* 324, 301 (1971), for
    spheres; D. Maugis and M. Barquins, *J. Phys. D* 16, 1843 (1983), for any profile.
    """
    radius = check_not_negative("contact_radius", contact_radius)
    return (depth(tip, radius) - _stretch(radius, modulus, work_of_adhesion))[()]


def jkr_load(
    tip: "Tip", contact_radius: ArrayLike, modulus: float, work_of_adhesion: float
) -> np.ndarray:
    """Force on ``tip`` in an adhesive contact with short-ranged forces, N; negative when pulled.

    F(a) − √(8πE*Wa³) with F(a) as in ``load``; parameters, refusals and source as of ``jkr_depth``.
    """
    radius = check_not_negative("contact_radius", contact_radius)
    stretch = _stretch(radius, modulus, work_of_adhesion)
    return (load(tip, radius, modulus) - 2 * modulus * radius * stretch)[()]


def jkr(tip: "Tip", modulus: float, work_of_adhesion: float, deepest: float) -> Curve:
    """States of an adhesive contact with short-ranged forces, from radius 0 to a depth.

    The curve of ``jkr_depth`` and ``jkr_load`` by rising contact radius, stable and unstable part:
    pulled by a spring, a contact is stable down to the radius of ``jkr_parting``.

    Parameters
    ----------
    tip
        E.g. ``softafm.Paraboloid``.
    modulus
        Reduced modulus E*, Pa.
    work_of_adhesion
        Work of adhesion W, J/m².
    deepest
        Depth at which the curve ends, m; negative above the undeformed surface.

    Raises
    ------
    ValueError
        If a number is out of range, or no contact is as high as ``deepest``.

    References
    ----------
    As of ``jkr_depth``.
    """
    parting = jkr_parting(tip, modulus, work_of_adhesion)
    deepest = check_finite("deepest", deepest, "m")
    if deepest <= parting.depth:
        raise ValueError(
            f"deepest = {deepest:g} m: must be above {parting.depth:g} m, where the contact parts"
        )
    last, states = parting.contact_radius, partial(_find_states, tip, modulus, work_of_adhesion)
    widest = find_coordinate(states, last, deepest)
    onward = last + (widest - last) * np.linspace(0, 1, _POINTS) ** 1.5
    return Curve(*states(np.append(np.linspace(0, last, _POINTS // 4)[:-1], onward)))


def jkr_parting(
    tip: "Tip", modulus: float, work_of_adhesion: float, stiffness: float = inf
) -> Parting:
    """Return the last state of an adhesive contact with short-ranged forces that is pulled slowly.

    Parameters
    ----------
    tip, modulus, work_of_adhesion
        As for ``jkr``.
    stiffness
        Of what pulls, N/m: that of a lever, 0 at a fixed load, infinite at fixed grips. Of a
        paraboloid the force is −(3/2)πWR at a fixed load and −(5/6)πWR at fixed grips.

    Returns
    -------
    Parting
        ``contact_radius`` and ``depth``, m, and ``force``, N.

    Raises
    ------
    ValueError
        If a number is out of range.

    References
    ----------
    The least δ + F/k; D. Maugis and M. Barquins, *J. Phys. D* 11, 1989 (1978).
    """
    stiffness, modulus = check_stiffness(stiffness), check_modulus(modulus)
    scale = tip.radius_at(check_work(work_of_adhesion) / modulus)
    states = partial(_find_states, tip, modulus, work_of_adhesion)
    return make_parting(states, find_last_state(states, scale * _SEARCHED, stiffness))


def jkr_pull_off(radius: float, work_of_adhesion: float) -> float:
    """Force at which a paraboloid parts from a soft sample under load control, −(3/2)πWR, N.

    ``radius`` R in m and ``work_of_adhesion`` W in J/m², both above zero or a ValueError.

    References
    ----------
    K. L. Johnson, K. Kendall and A. D. Roberts, *Proc. R. Soc. Lond. A* 324, 301 (1971).
    """
    return -1.5 * pi * check_positive("radius", radius, "m") * check_work(work_of_adhesion)


def dmt_force(
    radius: float, depth: ArrayLike, modulus: float, work_of_adhesion: float
) -> np.ndarray:
    """Force on a paraboloid in a stiff contact, that of Hertz less 2πWR, N; 0 above 0 m.

    Surface forces act around the contact, over a range in which its own deformation by them is
    small. For other tips they depend on that range: see ``maugis``.

    Parameters
    ----------
    radius
        Radius of curvature R at the apex, m.
    depth
        Depth of the apex, m.
    modulus
        Reduced modulus E*, Pa.
    work_of_adhesion
        Work of adhesion W, J/m².

    Raises
    ------
    ValueError
        If radius, modulus or work are not finite numbers above zero.

    References
    ----------
    B. V. Derjaguin, V. M. Muller and Y. P. Toporov, *J. Colloid Interface Sci.* 53, 314 (1975), in
    the form of D. Maugis, *J. Colloid Interface Sci.* 150, 243 (1992).
    """
    touching = np.asarray(depth, float) >= 0
    attraction = dmt_pull_off(radius, work_of_adhesion)
    return (hertz_force(radius, depth, modulus) + np.where(touching, attraction, 0.0))[()]


def dmt_pull_off(radius: float, work_of_adhesion: float) -> float:
    """Force at which a paraboloid parts from a stiff sample, −2πWR, N.

    ``radius`` R in m and ``work_of_adhesion`` W in J/m², both above zero or a ValueError.

    References
    ----------
    B. V. Derjaguin, V. M. Muller and Y. P. Toporov, *J. Colloid Interface Sci.* 53, 314 (1975).
    """
    return -2 * pi * check_positive("radius", radius, "m") * check_work(work_of_adhesion)


def _stretch(radius: np.ndarray, modulus: float, work_of_adhesion: float) -> np.ndarray:
    return np.sqrt(2 * pi * radius * check_work(work_of_adhesion) / check_modulus(modulus))


def _find_states(
    tip: "Tip", modulus: float, work_of_adhesion: float, radius: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    deep = jkr_depth(tip, radius, modulus, work_of_adhesion)
    return radius, deep, jkr_load(tip, radius, modulus, work_of_adhesion)
