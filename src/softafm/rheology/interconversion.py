"""Exact change between a Prony series of the modulus and a Kelvin-Voigt chain.

With s = −1/x the transform of either response is a sum of simple poles on x > 0, and the times of
one response are the zeros of the other. Both read Σ w_i/(x − p_i) = c with positive weights: one
zero between each two poles, and one beyond the last if c > 0. Differences to the poles are kept
exact by measuring each zero from its nearest pole, so that weak terms lose nothing.
"""

import numpy as np
from numpy.typing import ArrayLike


def prony_to_chain(
    E_inf: float, moduli: ArrayLike, relaxation_times: ArrayLike
) -> tuple[float, np.ndarray, np.ndarray, float]:
    """Return the creep compliance of E(t) = E_inf + Σ E_k exp(−t/λ_k).

    Parameters
    ----------
    E_inf
        Long-term modulus, Pa; zero if the material flows.
    moduli, relaxation_times
        E_k ≥ 0 (Pa) and λ_k > 0 (s), shape (n,), in any order; terms of equal times are added.

    Returns
    -------
    instantaneous, compliances, retardation_times, fluidity
        J_g (1/Pa), J_m (1/Pa), τ_m (s) and φ (1/(Pa s)) of
        J(t) = J_g + Σ J_m (1 − exp(−t/τ_m)) + φ t, times rising.

    References
    ----------
    s J(s) · s E(s) = 1 (Gross 1953). Zeros: Σ E_k λ_k/(τ − λ_k) = E_inf; weights:
    J_m = 1/(τ_m Σ E_k λ_k/(τ_m − λ_k)²).
    """
    moduli, poles = _merge(moduli, relaxation_times)
    instantaneous = 1 / (E_inf + float(np.sum(moduli)))
    weights = moduli * poles
    times, distances = _find_zeros(poles, weights, E_inf)
    compliances = 1 / (times * np.sum(weights / distances / distances, axis=1))
    fluidity = 1 / float(np.sum(weights)) if E_inf == 0 else 0.0
    return instantaneous, compliances, times, fluidity


def chain_to_prony(
    instantaneous: float,
    compliances: ArrayLike,
    retardation_times: ArrayLike,
    fluidity: float = 0.0,
) -> tuple[float, np.ndarray, np.ndarray]:
    """Return the relaxation modulus of J(t) = J_g + Σ J_m (1 − exp(−t/τ_m)) + φ t.

    Parameters
    ----------
    instantaneous
        J_g > 0, 1/Pa.
    compliances, retardation_times
        J_m ≥ 0 (1/Pa) and τ_m > 0 (s), shape (m,), in any order; elements of equal times are added.
    fluidity
        φ ≥ 0, 1/(Pa s).

    Returns
    -------
    E_inf, moduli, relaxation_times
        E_inf (Pa), E_k (Pa) and λ_k (s) of E(t) = E_inf + Σ E_k exp(−t/λ_k), times rising.

    References
    ----------
    As ``prony_to_chain``. Zeros: J_g/λ + Σ J_m/(λ − τ_m) = φ; weights:
    E_k = 1/(λ_k² (J_g/λ_k² + Σ J_m/(λ_k − τ_m)²)).
    """
    compliances, times = _merge(compliances, retardation_times)
    poles, weights = np.append(0.0, times), np.append(instantaneous, compliances)
    zeros, distances = _find_zeros(poles, weights, fluidity)
    moduli = 1 / np.sum(weights * (zeros[:, None] / distances) ** 2, axis=1)
    E_inf = 0.0 if fluidity > 0 else 1 / float(np.sum(weights))
    return E_inf, moduli, zeros


def _merge(weights: ArrayLike, times: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Return the terms by rising time, equal times added and zero weights left out."""
    weights, times = np.asarray(weights, float), np.asarray(times, float)
    times, group = np.unique(times[weights > 0], return_inverse=True)
    return np.bincount(group, weights[weights > 0], times.size), times


def _find_zeros(
    poles: np.ndarray, weights: np.ndarray, level: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the zeros x of Σ w_i/(x − p_i) − level, and x − p_i, of shape (zeros, poles)."""
    count = poles.size
    if count == 0:
        return np.zeros(0), np.zeros((0, 0))
    left = np.arange(count - 1)
    half = np.diff(poles) / 2
    above, below = _halve(poles[left, None] - poles + half[:, None], weights, level)
    # +1: the zero lies right of its nearest pole, by at most half a gap; -1: left of it.
    side = np.where(above > below, -1.0, 1.0)
    nearest = np.where(above > below, left + 1, left)
    least = weights[nearest] / np.maximum(above, below)
    if level > 0:
        nearest, side = np.append(nearest, count - 1), np.append(side, 1.0)
        least = np.append(least, weights[-1] / level)
        half = np.append(half, np.sum(weights) / level)
    apart = poles[nearest, None] - poles

    low, high = np.minimum(np.log(least / half), 0), np.zeros(nearest.size)
    y = (low + high) / 2
    for _ in range(200):
        distances = apart + (side * half * np.exp(y))[:, None]
        above, below = _halve(distances, weights, level)
        excess = side * np.log(above / below)
        low, high = np.where(excess >= 0, y, low), np.where(excess <= 0, y, high)
        terms = weights / distances / distances
        fall = np.sum(np.where(distances > 0, terms, 0), axis=1) / above
        fall += np.sum(np.where(distances < 0, terms, 0), axis=1) / below
        newton = y + excess / (half * np.exp(y) * fall)
        inside = (newton >= low) & (newton <= high)
        onward = np.where(inside, newton, (low + high) / 2)
        # Newton's steps converge quadratically: after one of 1e-9 the rest is round-off.
        done = np.abs(onward - y) <= np.where(inside, 1e-9, 1e-14)
        y = onward
        if np.all(done):
            break
    distances = apart + (side * half * np.exp(y))[:, None]
    return poles[nearest] + side * half * np.exp(y), distances


def _halve(
    distances: np.ndarray, weights: np.ndarray, level: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the positive and the negative terms of Σ w_i/(x − p_i) − level, both as sums > 0."""
    terms = weights / distances
    above = np.sum(np.where(terms > 0, terms, 0), axis=1)
    below = level - np.sum(np.where(terms < 0, terms, 0), axis=1)
    return above, below
