"""Elastic indentation by any tip of revolution, without adhesion."""

from math import pi
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.validate import check_positive
from softafm.indentation.check import check_modulus, check_not_negative

if TYPE_CHECKING:
    from softafm.tips import Tip

_FINE, _COARSE = (np.polynomial.legendre.leggauss(n) for n in (16, 5))
_FEW = 12
"""Joints up to which panels between them are wide enough to need the finer rule."""
_PANELS = pi / 2 * np.append(0.0, 4.0 ** np.arange(-16, 1))


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
    radius = check_not_negative("contact_radius", contact_radius)
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
    radius, modulus = check_not_negative("contact_radius", contact_radius), check_modulus(modulus)
    return (2 * modulus * radius**2 * _average_slopes(tip, radius)[1])[()]


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
    return (4 / 3 * check_modulus(modulus) * radius**0.5 * deep**1.5)[()]


def _average_slopes(tip: "Tip", radius: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """∫ g'(a sin θ) dθ and ∫ g'(a sin θ) sin²θ dθ from 0 to π/2 for contact radii a.

    Gauss-Legendre between the joints of the profile, and ever finer towards the axis, for tips
    that are much sharper than the contact is wide.
    """
    wide = np.where(radius > 0, radius, 1.0)[..., None]
    joints = np.array([joint for joint in tip.joints if joint < radius.max(initial=0.0)])
    points, weights = _FINE if joints.size <= _FEW else _COARSE
    joints = np.arcsin(np.minimum(joints / wide, 1.0))
    panels = np.broadcast_to(_PANELS, (*radius.shape, _PANELS.size))
    edges = np.sort(np.concatenate([panels, joints], axis=-1), axis=-1)
    middle, half = (edges[..., 1:] + edges[..., :-1]) / 2, np.diff(edges, axis=-1) / 2
    sine = np.sin(middle[..., None] + half[..., None] * points)
    weighted = half[..., None] * weights * tip.slope(wide[..., None] * sine)
    return weighted.sum((-2, -1)), (weighted * sine**2).sum((-2, -1))
