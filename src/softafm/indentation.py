"""Elastic indentation by any axisymmetric tip, in closed form: to plot beside a result.

The contact is elastic, without friction, and of small slopes: the half-space deforms as under
pressures on a flat surface, for these solutions as in the solvers. Results of a solver approach
them where surface forces act over distances much shorter than the indentation.
"""

from math import pi
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.validate import check_positive, refuse_masked

if TYPE_CHECKING:
    from softafm.tips import Tip

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_PANELS = pi / 2 * np.append(0.0, 4.0 ** np.arange(-16, 1))
_HALVINGS = 52


def depth(tip: "Tip", contact_radius: ArrayLike) -> np.ndarray:
    """Depth that ``tip`` is pressed in when the contact has a radius, without adhesion, m.

    δ(a) = a ∫ g'(r)/√(a² − r²) dr from 0 to a, in the unit of the contact radius, m.

    Raises
    ------
    ValueError
        If a contact radius is negative or not finite.

    References
    ----------
    I. N. Sneddon, *Int. J. Eng. Sci.* 3, 47 (1965).
    """
    radius = _check_not_negative("contact_radius", contact_radius)
    return (radius * _average_slopes(tip, radius)[0])[()]


def load(tip: "Tip", contact_radius: ArrayLike, modulus: float) -> np.ndarray:
    """Force on ``tip`` when the contact has a radius (m), without adhesion, N.

    F(a) = 2E* ∫ r² g'(r)/√(a² − r²) dr from 0 to a, with ``modulus`` the reduced E*, Pa.

    Raises
    ------
    ValueError
        If a contact radius is negative or not finite, or the modulus not above zero.

    References
    ----------
    I. N. Sneddon, *Int. J. Eng. Sci.* 3, 47 (1965).
    """
    radius, modulus = _check_not_negative("contact_radius", contact_radius), _check_modulus(modulus)
    return (2 * modulus * radius**2 * _average_slopes(tip, radius)[1])[()]


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
    radius = _check_not_negative("contact_radius", contact_radius)
    return (depth(tip, radius) - _stretch(radius, modulus, work_of_adhesion))[()]


def jkr_load(
    tip: "Tip", contact_radius: ArrayLike, modulus: float, work_of_adhesion: float
) -> np.ndarray:
    """Force on ``tip`` in an adhesive contact with short-ranged forces, N; negative when pulled.

    F(a) − √(8πE*Wa³) with F(a) as in ``load``; parameters, refusals and source as of ``jkr_depth``.
    """
    radius = _check_not_negative("contact_radius", contact_radius)
    stretch = _stretch(radius, modulus, work_of_adhesion)
    return (load(tip, radius, modulus) - 2 * modulus * radius * stretch)[()]


def contact_radius(tip: "Tip", depth: ArrayLike) -> np.ndarray:
    """Contact radius at which ``tip`` is ``depth`` (m) deep without adhesion, m; 0 above 0 m.

    Raises
    ------
    ValueError
        If a depth is not finite.
    """
    deep = np.asarray(depth, float)
    if not np.all(np.isfinite(deep)):
        raise ValueError(f"depth = {deep[~np.isfinite(deep)].flat[0]} m: must be a finite number")
    # As δ(a) ≥ g(a), the contact is no wider than the tip at that height.
    widest = [tip.radius_at(each) if each > 0 else 0.0 for each in deep.flat]
    low, high = np.zeros(deep.shape), np.array(widest).reshape(deep.shape)
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        shallow = middle * _average_slopes(tip, middle)[0] <= deep
        low, high = np.where(shallow, middle, low), np.where(shallow, high, middle)
    return low[()]


def force(tip: "Tip", depth: ArrayLike, modulus: float) -> np.ndarray:
    """Force on ``tip`` when it is ``depth`` (m) deep without adhesion, N; 0 above 0 m.

    ``modulus`` is the reduced E*, Pa. Refusals are those of ``contact_radius`` and ``load``.
    """
    return load(tip, contact_radius(tip, depth), modulus)


def hertz_force(radius: float, depth: ArrayLike, modulus: float) -> np.ndarray:
    """Force on a paraboloid of apex ``radius`` R (m), (4/3) E* √R δ^(3/2), N; 0 above 0 m.

    Raises
    ------
    ValueError
        If the radius or the modulus E* (Pa) is not a finite number above zero.

    References
    ----------
    H. Hertz, *J. reine angew. Math.* 92, 156 (1881).
    """
    radius, deep = check_positive("radius", radius, "m"), np.maximum(np.asarray(depth, float), 0.0)
    return (4 / 3 * _check_modulus(modulus) * radius**0.5 * deep**1.5)[()]


def jkr_pull_off(radius: float, work_of_adhesion: float) -> float:
    """Force at which a paraboloid parts from a soft sample under load control, −(3/2)πWR, N.

    ``radius`` R in m and ``work_of_adhesion`` W in J/m², both above zero or a ValueError.

    References
    ----------
    K. L. Johnson, K. Kendall and A. D. Roberts, *Proc. R. Soc. Lond. A* 324, 301 (1971).
    """
    return -1.5 * pi * check_positive("radius", radius, "m") * _check_work(work_of_adhesion)


def dmt_pull_off(radius: float, work_of_adhesion: float) -> float:
    """Force at which a paraboloid parts from a stiff sample, −2πWR, N.

    ``radius`` R in m and ``work_of_adhesion`` W in J/m², both above zero or a ValueError.

    References
    ----------
    B. V. Derjaguin, V. M. Muller and Y. P. Toporov, *J. Colloid Interface Sci.* 53, 314 (1975).
    """
    return -2 * pi * check_positive("radius", radius, "m") * _check_work(work_of_adhesion)


def _average_slopes(tip: "Tip", radius: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """∫ g'(a sin θ) dθ and ∫ g'(a sin θ) sin²θ dθ from 0 to π/2 for contact radii a.

    Gauss-Legendre between the joints of the profile, and ever finer towards the axis, for tips
    that are much sharper than the contact is wide.
    """
    wide = np.where(radius > 0, radius, 1.0)[..., None]
    joints = np.arcsin(np.minimum(np.array(tip.joints) / wide, 1.0))
    panels = np.broadcast_to(_PANELS, (*radius.shape, _PANELS.size))
    edges = np.sort(np.concatenate([panels, joints], axis=-1), axis=-1)
    middle, half = (edges[..., 1:] + edges[..., :-1]) / 2, np.diff(edges, axis=-1) / 2
    sine = np.sin(middle[..., None] + half[..., None] * _POINTS)
    weighted = half[..., None] * _WEIGHTS * tip.slope(wide[..., None] * sine)
    return weighted.sum((-2, -1)), (weighted * sine**2).sum((-2, -1))


def _stretch(radius: np.ndarray, modulus: float, work_of_adhesion: float) -> np.ndarray:
    return np.sqrt(2 * pi * radius * _check_work(work_of_adhesion) / _check_modulus(modulus))


def _check_modulus(value: float) -> float:
    return check_positive("modulus", value, "Pa")


def _check_work(value: float) -> float:
    return check_positive("work_of_adhesion", value, "J/m²")


def _check_not_negative(name: str, values: ArrayLike) -> np.ndarray:
    refuse_masked(name, values)
    array = np.asarray(values, float)
    bad = ~(np.isfinite(array) & (array >= 0))
    if np.any(bad):
        raise ValueError(f"{name} = {array[bad].flat[0]:g} m: must be finite and not negative")
    return array
