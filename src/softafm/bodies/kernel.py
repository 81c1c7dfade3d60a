"""Pressure to displacement on an elastic half-space (axisymmetric Boussinesq).

(K p)(r) = ∫ p(s) k(r, s) s ds with k(r, s) = 4/(π r_>) K_ell((r_</r_>)²), Rajabifar et al. 2021,
equation (12). The kernel is logarithmic at r = s. On nodes s_j = s(j) of a smooth map the
trapezoidal rule keeps its order when the singular term is replaced by its zeta-regularised value
(Kress 1999; Wu and Martinsson 2021): near r = s, k → (2/πr) ln(8r/|r − s|), and ∫ln|x| f dx is
h Σ' ln|x_j| f_j + h ln(h/2π) f_0 up to O(h³).
"""

from typing import Any

import numpy as np


def kernel(r: Any, s: Any, distance: Any = None) -> np.ndarray:
    """k(r, s) of two arrays of unequal positive radii, in 1/(their unit).

    ``distance`` is |r − s|, for radii so close that their difference has lost its digits.
    """
    from scipy.special import ellipkm1

    larger, smaller = np.maximum(r, s), np.minimum(r, s)
    if distance is None:
        distance = larger - smaller
    complement = distance * (larger + smaller) / larger**2
    return 4 / (np.pi * larger) * ellipkm1(complement)


def influence(nodes: np.ndarray, spacing: np.ndarray, masses: np.ndarray) -> np.ndarray:
    """Symmetric matrix G with (K p)(r_i) = Σ_j G_ij m_j p_j.

    Parameters
    ----------
    nodes, spacing, masses
        Radii (the first is 0), dr/dj and trapezoidal masses, shape (n,).
    """
    n = nodes.size
    matrix = np.zeros((n, n))
    row, column = np.triu_indices(n, 1)
    matrix[row, column] = matrix[column, row] = kernel(nodes[row], nodes[column])
    diagonal = np.empty(n)
    diagonal[0] = spacing[0] / masses[0]
    diagonal[1:] = 2 / (np.pi * nodes[1:]) * np.log(16 * np.pi * nodes[1:] / spacing[1:])
    np.fill_diagonal(matrix, diagonal)
    _correct_near_axis(matrix, nodes, masses)
    return matrix


def _correct_near_axis(matrix: np.ndarray, nodes: np.ndarray, masses: np.ndarray) -> None:
    """Make rows near the axis exact for a Gaussian pressure.

    There the singularity at r = s and its mirror image at r = −s are only a few nodes apart. The
    error is local and the same for every smooth pressure, so one closed form settles it:
    p = exp(−r²/b²) gives K p = √π b exp(−x) I0(x), x = r²/2b².
    """
    from scipy.special import i0e

    width = 1.0
    pressure = np.exp(-((nodes / width) ** 2))
    exact = width * np.sqrt(np.pi) * i0e((nodes / width) ** 2 / 2)
    error = exact - matrix @ (masses * pressure)
    near = np.flatnonzero(nodes < 0.7)
    matrix[near, near] += error[near] / (masses[near] * pressure[near])
