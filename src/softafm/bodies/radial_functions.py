"""Functions that a deformed surface is expanded in, and what a pressure does to each.

Everything lives on the unit domain 0 ≤ r ≤ 1; a domain of radius rd multiplies displacements by rd.
Functions f_0 = 1, f_1, ... are orthogonal with the basis' weight v(r): cosines f_j = cos(jπr) with
v = 1, Bessel functions f_j = J0(α_j r), α_j the zeros of J1, with v = r. Then

    ρ_j(s) = ∫_0^1 f_j(r) k(r, s) v(r) dr,      ζ_j = ∫_0^1 f_j(r)² v(r) dr

(Rajabifar et al. 2021, equations 17 to 20, there with v = 1 throughout, which is wrong for Bessel
functions). Zeros of J1, not of J0: they leave the value at the rim free.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from softafm.bodies.kernel import kernel

BASES = ("cosine", "bessel")
QUADRATURES = ("trapezoid", "midpoint")


class Grid(NamedTuple):
    """Equal segments of the unit domain: nodes and weights (n,), edges of their cells (n + 1,)."""

    radius: np.ndarray
    weight: np.ndarray
    edges: np.ndarray


def grid(nodes: int, quadrature: str) -> Grid:
    """Nodes of the trapezoidal or the midpoint rule on (0, 1)."""
    index = np.arange(nodes)
    if quadrature == "midpoint":
        return Grid((index + 0.5) / nodes, np.full(nodes, 1 / nodes), np.arange(nodes + 1) / nodes)
    radius = index / (nodes - 1)
    edges = np.concatenate([[0.0], (radius[1:] + radius[:-1]) / 2, [1.0]])
    return Grid(radius, np.diff(edges), edges)


def wavenumbers(basis: str, count: int) -> np.ndarray:
    """The factors α_j of r: jπ, or the zeros of J1 after 0."""
    from scipy.special import jn_zeros

    if basis == "cosine":
        return np.pi * np.arange(count)
    return np.concatenate([[0.0], jn_zeros(1, count - 1)]) if count > 1 else np.zeros(1)


def evaluate(basis: str, count: int, r: ArrayLike) -> np.ndarray:
    """f_j(r): shape (r, count)."""
    from scipy.special import j0

    phase = np.multiply.outer(np.asarray(r, float), wavenumbers(basis, count))
    return np.cos(phase) if basis == "cosine" else j0(phase)


def norms(basis: str, count: int) -> np.ndarray:
    """ζ_j, in closed form."""
    if basis == "cosine":
        return np.where(np.arange(count) == 0, 1.0, 0.5)
    return evaluate(basis, count, 1.0) ** 2 / 2


def project(basis: str, count: int, function: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Coefficients (count,) of ``function`` on (0, 1): ∫ f_j function v dr / ζ_j."""
    points, weights = _gauss(100 + 4 * count)
    if basis == "bessel":
        weights = weights * points
    return evaluate(basis, count, points).T @ (weights * function(points)) / norms(basis, count)


@lru_cache(maxsize=8)
def responses(basis: str, count: int, radii: tuple[float, ...]) -> np.ndarray:
    """s·ρ_j(s) at ``radii`` s in [0, 1]: shape (count, s).

    The logarithm at r = s is taken out by r = s ± L·x⁵, after which Gauss-Legendre points converge
    fast. For cosines ρ_j grows as ln(1/s) towards the axis, where s·ρ_j is 0.
    """
    points, weights = _gauss(60 + 8 * count)
    stretched, stretch = points**5, 5 * points**4 * weights
    result = np.zeros((count, len(radii)))
    for i, s in enumerate(radii):
        if s == 0:
            continue
        # On the way to the axis the kernel is smooth; L·x⁵ is its distance from s on either side.
        for length, side in ((s, -1), (1 - s, 1)):
            if length == 0:
                continue
            r = s + side * length * stretched
            inside = r > 0
            r, weight = r[inside], length * stretch[inside]
            if basis == "bessel":
                weight = weight * r
            distance = (length * stretched)[inside]
            result[:, i] += evaluate(basis, count, r).T @ (weight * kernel(r, s, distance))
        result[:, i] *= s
    result.setflags(write=False)
    return result


@lru_cache(maxsize=8)
def _gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    points, weights = np.polynomial.legendre.leggauss(count)
    return (points + 1) / 2, weights / 2
