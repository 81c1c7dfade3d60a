"""Bodies whose surface answers each wavenumber by itself: layers on a half-space.

In the Hankel domain û(κ) = −(2J/κ) S(κ) p̂(κ), with S = 1 for a half-space of the material at the
surface. What S changes is smooth, as S → 1 within the length of the layers:
k(r, s) = k_halfspace(r, s) + 2 ∫ (S(κ) − 1) J0(κr) J0(κs) dκ over all κ.

A frictionless tip that presses a disc of radius a of such a body has −u = ∫ S B J0(κr) dκ with
B = ∫_0^a φ(x) cos κx dx and φ + Mφ = (2/π)(δ − h) (a Fredholm equation of the second kind; Lebedev
and Ufliand 1958), where M(x, y) = (2/π) ∫ (S − 1) cos κx cos κy dκ and h(x) is the depth that the
tip has on a half-space in a contact of radius x. Its pressure ends without a singularity if
φ(a) = 0, and with that of JKR if φ(a) = −√(8Wa/(πE)). The force is πE ∫ φ dx.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

HIGHEST = 20.0
"""Wavenumber, over the inverse length of a body, from which on S counts as 1."""
_PANEL_POINTS, _PANEL_WEIGHTS = np.polynomial.legendre.leggauss(10)
_PANEL, _FEWEST = 6.0, 6
"""Length of a panel over the inverse radius, and the least number of panels: J0 to ten digits."""
_GAUSS, _WEIGHTS = (x / 2 for x in np.polynomial.legendre.leggauss(48))
POINTS = 0.5 + _GAUSS
"""Gauss points ξ on (0, 1), of fractions of a contact radius."""
_SMALLEST, _LARGEST, _RADII = 1e-2, 4.0, 40
"""Contact radii, in lengths of a body, of which estimates are tabulated."""

_REFINED = 4.0 ** np.arange(-6, 0)
"""Edges of panels in the first one, as parts of it."""

Factor = Callable[[np.ndarray], np.ndarray]


def wavenumbers(highest: float, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Points and weights of ∫ f dκ from 0 to ``highest``, for J0 and cosines out to ``radius``.

    Panels are ever finer towards 0: there S of a thin hard skin changes rapidly.
    """
    panels = max(_FEWEST, int(np.ceil(highest * radius / _PANEL)))
    edges = np.arange(1, panels + 1) * (highest / panels)
    edges = np.concatenate([[0.0], edges[0] * _REFINED, edges])
    half = np.diff(edges)[:, None] / 2
    points = edges[:-1, None] + half * (1 + _PANEL_POINTS)
    return points.ravel(), (half * _PANEL_WEIGHTS).ravel()


def excess(nodes: np.ndarray, factor: Factor, highest: float) -> np.ndarray:
    """2 ∫ (S − 1) J0(κr) J0(κs) dκ at ``nodes`` r, s: shape (n, n), in inverse units of them.

    ``factor`` is S of arrays of κ; from ``highest`` on it counts as 1.
    """
    from scipy.special import j0

    points, weights = wavenumbers(highest, nodes[-1])
    waves = j0(np.outer(nodes, points))
    # Not a dot product: the bits of BLAS depend on the number of threads.
    return np.einsum("ik,jk->ij", 2 * weights * (factor(points) - 1) * waves, waves)


class Estimates(NamedTuple):
    """Weights (m, n) of the depths h(a·ξ) of a half-space, and hardening less 1 (m, 1), by a (m,).

    Both vanish as a does.
    """

    radii: np.ndarray
    weights: np.ndarray
    hardening: np.ndarray

    def at(self, radius: np.ndarray, table: np.ndarray) -> np.ndarray:
        """Rows of one of the tables at some radii, by straight lines in ln a, held at the end."""
        logs = np.log(self.radii)
        place = (np.log(radius) - logs[0]) / (logs[1] - logs[0])
        row = np.clip(place.astype(int), 0, logs.size - 2)
        share = np.clip(place - row, 0, 1)[:, None]
        vanishing = np.minimum(radius / self.radii[0], 1)[:, None]
        return vanishing * ((1 - share) * table[row] + share * table[row + 1])


def estimates(factor: Factor) -> Estimates:
    """Solve the Fredholm equation for flat punches of 0.01 to 4 lengths; all in units of it.

    With β = (M at x = a)·(1 + M)⁻¹ the depth of a contact is (h(a) − β h)/(1 − β 1), and the
    stiffness is that of a half-space times the mean of (1 + M)⁻¹ 1.
    """
    radii = np.geomspace(_SMALLEST, _LARGEST, _RADII)
    points, shares = POINTS, _WEIGHTS
    weights, hardening = np.empty((radii.size, points.size)), np.empty((radii.size, 1))
    for row, a in enumerate(radii):
        k, weight = wavenumbers(HIGHEST, a)
        # 2/π of M and, from the Gauss rule on (0, 1), a.
        weight = 2 / np.pi * a * weight * (factor(k) - 1)
        cosines = np.cos(a * np.outer(points, k))
        matrix = np.einsum("ik,jk->ij", cosines * weight, cosines) * shares
        last = (cosines @ (np.cos(a * k) * weight)) * shares
        matrix += np.eye(points.size)
        weights[row] = np.linalg.solve(matrix.T, last)
        hardening[row] = shares @ np.linalg.solve(matrix, np.ones(points.size)) - 1
    return Estimates(radii, weights, hardening)
