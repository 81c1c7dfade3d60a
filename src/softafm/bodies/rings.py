"""Pressure to displacement on rings of constant pressure, in closed form.

A disc of radius a under unit pressure displaces an elastic half-space of unit reduced modulus by
D(r, a) = ∫_0^a k(r, s) s ds (Johnson 1985, Contact Mechanics, section 3.4); a ring is the
difference of two discs. The logarithmic singularity of the kernel is integrated exactly.
"""

from typing import Any

import numpy as np


def disc(r: Any, a: Any) -> np.ndarray:
    """D(r, a) at radii ``r`` ≥ 0 for disc radii ``a`` ≥ 0 that broadcast, in their unit."""
    from scipy.special import ellipe, ellipkm1

    r, a = np.broadcast_arrays(np.asarray(r, float), np.asarray(a, float))
    larger, smaller = np.maximum(r, a), np.minimum(r, a)
    nonzero = np.where(larger > 0, larger, 1.0)
    m = (smaller / nonzero) ** 2
    # 1 − m, written so that it keeps its digits where r and a nearly meet; at r = a, m' K(m) = 0.
    complement = (larger - smaller) * (larger + smaller) / nonzero**2
    outside = complement * ellipkm1(np.where(complement > 0, complement, 1.0))
    return 4 / np.pi * larger * (ellipe(m) - np.where(r > a, outside, 0.0))


def ring_influence(radii: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Matrix of the displacement at ``radii`` (n,) by unit pressure on each ring.

    Rings lie between neighbours of ``edges`` (m + 1,); returns shape (n, m), in the unit of both.
    """
    discs = disc(np.asarray(radii)[:, None], np.asarray(edges)[None, :])
    return np.diff(discs, axis=1)
