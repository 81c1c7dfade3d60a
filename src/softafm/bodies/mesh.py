"""Where the surface is sampled: a radial mesh in units of the contact radius, finest at its edge.

Nodes are ξ_j = ξ(j), j = 0..n−1, with r = a·ξ and a the radius of the contact edge. The smooth map

    j(ξ) = [asinh(g(ξ − 1)/δ) + asinh(g(ξ + 1)/δ)]/g

has spacing δ at the edge ξ = 1, grows by a factor e^g per node away from it, and is odd in ξ, so
even functions of radius stay even in j. Its inverse is, with y = g j/2,

    ξ(j) = tanh(y) √(1 + (δ/g)² cosh²(y)).

Sums over nodes with weights ξ dξ/dj are then trapezoidal rules in j for smooth integrands, which
converge faster than any power of the spacing once the Euler-Maclaurin terms of their two ends are
folded into the masses there.
"""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(8)


class UnitMesh(NamedTuple):
    """Nodes and masses at contact radius 1; for a contact radius a: a·nodes, a²·masses."""

    nodes: np.ndarray
    """ξ, shape (n,)."""
    spacing: np.ndarray
    """dξ/dj at the nodes, shape (n,)."""
    masses: np.ndarray
    """∫ f s ds = Σ masses·f, shape (n,)."""
    edge_spacing: float
    """δ, node spacing at ξ = 1."""
    growth: float
    """g, logarithmic growth of the spacing per node."""
    far: np.ndarray
    """Radii beyond the last node, shape (far,)."""
    far_masses: np.ndarray
    """∫ f s ds from the last node to infinity = Σ far_masses·f(far), shape (far,)."""
    slopes: np.ndarray
    """√(1 + x²) at the nodes, x the argument of each asinh in j(ξ): shape (2, n)."""


def node_index(radius: Any, edge_spacing: float, growth: float) -> Any:
    """Fractional node index j(ξ) of the mesh map at ``radius`` ξ."""
    inner = np.arcsinh(growth * (radius - 1) / edge_spacing)
    outer = np.arcsinh(growth * (radius + 1) / edge_spacing)
    return (inner + outer) / growth


def _spacing(radius: Any, edge_spacing: float, growth: float) -> Any:
    """dξ/dj at ``radius`` ξ."""
    inner = 1 / np.hypot(edge_spacing, growth * (radius - 1))
    outer = 1 / np.hypot(edge_spacing, growth * (radius + 1))
    return 1 / (inner + outer)


def _masses(nodes: np.ndarray, spacing: np.ndarray) -> np.ndarray:
    """Weights of ∫ f ξ dξ = Σ masses·f for even f: corrected trapezoids in j.

    At the axis w = ξ dξ/dj is odd, w ≈ w₁ j + w₃ j³/6; the Euler-Maclaurin terms (f w)'/12 and
    −(f w)‴/720, with f″ ≈ 2 (f(1) − f(0)), fall on nodes 0 and 1. The last three nodes carry
    Gregory's weights.
    """
    masses = nodes * spacing
    slope = spacing[0] ** 2
    third = 6 * (masses[1] - slope)
    masses[0] = slope / 12 - (third - 6 * slope) / 720
    masses[1] -= slope / 120
    masses[-3:] *= 23 / 24, 7 / 6, 3 / 8
    return masses


@lru_cache(maxsize=64)
def unit_mesh(edge_spacing: float, growth: float, extent: float) -> UnitMesh:
    """Build the mesh out to ξ = ``extent`` (or just beyond); cached.

    ``edge_spacing`` δ and ``growth`` g are dimensionless, see the module's formula.
    """
    last = int(np.ceil(node_index(extent, edge_spacing, growth)))
    half = growth / 2 * np.arange(last + 1)
    nodes = np.tanh(half) * np.hypot(1, edge_spacing / growth * np.cosh(half))
    spacing = _spacing(nodes, edge_spacing, growth)
    masses = _masses(nodes, spacing)
    far, far_masses = beyond(nodes[-1])
    slopes = np.hypot(1, growth / edge_spacing * (nodes - [[1], [-1]]))
    for array in (nodes, spacing, masses, far, far_masses, slopes):
        array.setflags(write=False)
    return UnitMesh(nodes, spacing, masses, edge_spacing, growth, far, far_masses, slopes)


def beyond(end: float) -> tuple[np.ndarray, np.ndarray]:
    """Radii and weights of ∫ f s ds from ``end`` to infinity, for f that falls faster than 1/s².

    Gauss-Legendre in end/s: exact for f = s^-3 to s^-18.
    """
    inverse = (1 + _POINTS) / 2
    return end / inverse, end**2 * _WEIGHTS / 2 / inverse**3
