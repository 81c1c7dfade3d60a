"""Elastic indentation without adhesion when the depth is given."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from softafm.indentation.elastic import load
from softafm.indentation.tabulated import make_depths

if TYPE_CHECKING:
    from softafm.tips import Tip


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
    radius, deepest = np.zeros(deep.shape), float(deep.max(initial=0.0))
    if deepest > 0:
        radius[deep > 0] = make_depths(tip, deepest).find_radius(deep[deep > 0])
    return radius[()]


def force(tip: "Tip", depth: ArrayLike, modulus: float) -> np.ndarray:
    """Force on ``tip`` when it is ``depth`` (m) deep without adhesion, N; 0 above 0 m.

    ``modulus`` is the reduced E*, Pa. Refusals are those of ``contact_radius`` and ``load``.
    """
    return load(tip, contact_radius(tip, depth), modulus)
