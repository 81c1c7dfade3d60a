"""The linear passive solid that is closest to measured moduli, and refusals of what none can have.

Passive solids have E* = E_inf + Σ E_k iωλ_k/(1 + iωλ_k) with E_inf, E_k ≥ 0: their storage modulus
rises with frequency, and their loss follows from it (Kramers and Kronig). On a dense grid of
relaxation times non-negative least squares finds the closest of them all.
"""

from math import ceil, log10, pi

import numpy as np

_DENSE = 10
"""Relaxation times a decade of the grid."""
_FASTEST, _SLOWEST = 0.1, 10**0.5
"""Ends of the grid, in 1/ω of the highest and lowest frequency. All storage in the slowest term
would make tan δ = 0.3: where it is less, a long-term modulus is needed, and no liquid will do."""
_STIFFENED = 0.03
"""Share of the storage, at most, that the fastest term adds to make up all of the loss."""
_OFF, _STANDARD_ERRORS = 0.1, 3
"""How far, in the logarithm and on average over a decade, moduli may be from the closest solid, and
how many standard errors of this mean more."""


def find_ends(frequency: np.ndarray, storage: np.ndarray, loss: np.ndarray) -> tuple[float, float]:
    """Return the shortest and the longest relaxation time, s, that moduli determine."""
    fastest = min(_FASTEST, _STIFFENED * storage[-1] / loss[-1])
    return fastest / (2 * pi * frequency[-1]), _SLOWEST / (2 * pi * frequency[0])


def make_columns(
    times: np.ndarray, frequency: np.ndarray, storage: np.ndarray, loss: np.ndarray
) -> np.ndarray:
    """Return what unit moduli add to storage and, below, loss, relative to what was measured.

    The shape is (2n, 1 + m) for n frequencies (Hz) and m ``times`` (s); E_inf comes first.
    """
    lag = 2j * pi * frequency[:, None] * times
    terms = np.hstack([np.ones((frequency.size, 1)), lag / (1 + lag)])
    return np.vstack([terms.real / storage[:, None], terms.imag / loss[:, None]])


def differentiate(
    times: np.ndarray, frequency: np.ndarray, storage: np.ndarray, loss: np.ndarray
) -> np.ndarray:
    """Return the derivatives of such columns, without that of E_inf, by ln λ; shape (2n, m)."""
    lag = 2j * pi * frequency[:, None] * times
    slopes = lag / (1 + lag) ** 2
    return np.vstack([slopes.real / storage[:, None], slopes.imag / loss[:, None]])


def fit_closest(rows: np.ndarray) -> np.ndarray:
    """Return the moduli (Pa), none negative, of the least relative misfit of such columns."""
    from scipy.optimize import nnls

    norms = np.linalg.norm(rows, axis=0)
    moduli, _ = nnls(rows / norms, np.ones(rows.shape[0]), maxiter=100 * norms.size)
    return moduli / norms


def fit_closest_of_all(
    frequency: np.ndarray, storage: np.ndarray, loss: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return relaxation times (s), E_inf and moduli (Pa), and the fit relative to the data (2n)."""
    first, last = find_ends(frequency, storage, loss)
    times = np.geomspace(first, last, ceil(_DENSE * log10(last / first)) + 1)
    rows = make_columns(times, frequency, storage, loss)
    moduli = fit_closest(rows)
    return times, moduli, rows @ moduli


def refuse_impossible(frequency: np.ndarray, storage: np.ndarray, loss: np.ndarray) -> None:
    """Raise ValueError if no linear passive solid has such moduli (Pa) at rising frequencies (Hz).

    It has not if even the closest differs systematically: over a decade by more than 10 % on
    average, and by more than three standard errors of that mean. Noise is what is left in second
    differences of the misfit.
    """
    off = np.log(np.split(fit_closest_of_all(frequency, storage, loss)[2], 2))
    place = np.log10(frequency)
    averages = [_average_squares(place, each) for each in off]
    excess = [np.abs(mean) - _OFF - _STANDARD_ERRORS * error for mean, error in averages]
    if np.max(excess) <= 0:
        return
    decade = np.abs(place - place[np.max(excess, axis=0).argmax()]) <= 0.5
    which, i = np.unravel_index(np.argmax(np.where(decade, np.abs(off), 0)), (2, place.size))
    name, values = (("storage", storage), ("loss", loss))[which]
    raise ValueError(
        f"{name} = {values[i]:.4g} Pa at {frequency[i]:.4g} Hz: no linear passive solid has this "
        f"beside the other moduli, the closest has {values[i] * np.exp(off[which, i]):.2g} Pa: "
        + _describe_contradiction(frequency, storage)
    )


def _describe_contradiction(frequency: np.ndarray, storage: np.ndarray) -> str:
    """Return which law of passive solids is broken."""
    share = storage / np.maximum.accumulate(storage)
    last = int(np.argmin(share))
    if share[last] > 1 - _OFF:
        return "the loss does not follow from the rise of the storage (Kramers and Kronig)"
    first = int(np.argmax(storage[:last]))
    return (
        f"the storage falls by {100 * (1 - share[last]):.2g} % from {frequency[first]:.4g} to "
        f"{frequency[last]:.4g} Hz, but can only rise with frequency"
    )


def _average_squares(place: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the means over a decade around each place, and their standard errors."""
    mean, count = _average_decades(place, values, place, 0.5)
    if values.size < 3:
        return mean, np.zeros(values.size)
    scatter, _ = _average_decades(place[1:-1], np.diff(values, 2) ** 2 / 6, place, 1.0)
    return mean, np.sqrt(scatter / count)


def _average_decades(
    place: np.ndarray, values: np.ndarray, centres: np.ndarray, reach: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the means of values within reach of some centres, of all if none is, and how many."""
    first = np.searchsorted(place, centres - reach)
    last = np.searchsorted(place, centres + reach, side="right")
    first, last = np.where(first < last, first, 0), np.where(first < last, last, place.size)
    sums = np.append(0, np.cumsum(values))
    return (sums[last] - sums[first]) / (last - first), last - first
