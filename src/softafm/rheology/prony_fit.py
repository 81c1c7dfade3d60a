"""A Prony series, of as few terms as the noise of measured moduli allows to tell apart."""

from functools import lru_cache
from math import log
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.validate import check_finite
from softafm.rheology.closest import (
    differentiate,
    find_ends,
    fit_closest,
    fit_closest_of_all,
    make_columns,
    refuse_impossible,
)
from softafm.rheology.dma import sort_moduli

_EXACT = 1e-3
"""Relative accuracy that no data exceed: a term is not needed for less."""
_FARTHEST = 20.0
"""How far a logarithm of a modulus may move from its start."""
_SETTLED, _MOST_STEPS = 1e-4, 50
"""Relative gain at which a search ends, and its steps: a continuous spectrum without noise leaves
something to gain for ever."""


def fit_prony(
    frequency: ArrayLike, storage: ArrayLike, loss: ArrayLike, per_decade: float = 2
) -> tuple[float, tuple[float, ...], tuple[float, ...]]:
    """Fit E_inf, moduli and relaxation times to measured moduli.

    The closest non-negative series of a dense grid of times begins: terms nearer to each other than
    1/``per_decade`` decades are merged, then all are moved to the least squares of the relative
    misfit. The least needed is left out, and the rest moved again, while that raises the misfit by
    less than Schwarz's criterion allows for its parameters. The long-term modulus is one of them: a
    liquid results only from data that show no plateau.

    Parameters
    ----------
    frequency
        Measured frequencies, Hz, shape (n,), in any order.
    storage, loss
        Moduli, Pa, shape (n,).
    per_decade
        Relaxation times a decade, at most, from which the fit begins; 0.5 to 10.

    Returns
    -------
    E_inf, moduli, relaxation_times
        In Pa and s, times rising.

    Raises
    ------
    ValueError
        If the data are not such, or no linear passive solid has them (``refuse_impossible``).

    References
    ----------
    G. Schwarz, Ann. Statist. 6, 461 (1978).
    """
    data = sort_moduli(frequency, storage, loss)
    per_decade = check_finite("per_decade", per_decade, "times")
    if not 0.5 <= per_decade <= 10:
        raise ValueError(f"per_decade = {per_decade:g} times: must be between 0.5 and 10")
    refuse_impossible(*data)
    return _fit(per_decade, *(tuple(values.tolist()) for values in data))


class _Series(NamedTuple):
    """E_inf and moduli above zero (Pa, shape (1 + m,)), times (s, (m,)), and the sum of squares."""

    moduli: np.ndarray
    times: np.ndarray
    cost: float

    @property
    def parameters(self) -> int:
        return int(self.moduli[0] > 0) + 2 * self.times.size


@lru_cache(maxsize=32)
def _fit(
    per_decade: float, *values: tuple[float, ...]
) -> tuple[float, tuple[float, ...], tuple[float, ...]]:
    data = [np.array(each) for each in values]
    count = 2 * data[0].size
    times, moduli, _ = fit_closest_of_all(*data)
    series = _move(data, *_merge(moduli, times, log(10) / per_decade))
    while np.count_nonzero(series.moduli) > 1:
        fewer = _drop_least(data, series)
        noise = max(series.cost / max(count - series.parameters, 1), _EXACT**2)
        allowed = noise * log(count) * (series.parameters - fewer.parameters)
        if fewer.cost - series.cost > allowed:
            break
        series = fewer
    return float(series.moduli[0]), tuple(series.moduli[1:].tolist()), tuple(series.times.tolist())


def _merge(moduli: np.ndarray, times: np.ndarray, apart: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the series with terms merged, nearest first, until all ln λ are ``apart``."""
    used = np.flatnonzero(moduli[1:])
    weights, places = moduli[1:][used], np.log(times[used])
    # A hair less, for the times of a grid are apart by that only to round-off.
    while places.size > 1 and np.min(np.diff(places)) < (1 - 1e-9) * apart:
        i = int(np.argmin(np.diff(places)))
        places[i] = np.average(places[i : i + 2], weights=weights[i : i + 2])
        weights[i] += weights[i + 1]
        places, weights = np.delete(places, i + 1), np.delete(weights, i + 1)
    return np.append(moduli[0], weights), np.exp(places)


def _move(data: list[np.ndarray], moduli: np.ndarray, times: np.ndarray) -> _Series:
    """Return the series of the least relative misfit from here, all logarithms being free."""
    from scipy.optimize import least_squares

    solid = int(moduli[0] > 0)
    strengths = solid + times.size
    start = np.log(np.concatenate([moduli[1 - solid :], times]))

    def split(logs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        values = np.exp(logs)
        return np.append(np.zeros(1 - solid), values[:strengths]), values[strengths:]

    def misfit(logs: np.ndarray) -> np.ndarray:
        moduli, times = split(logs)
        return make_columns(times, *data) @ moduli - 1

    def slopes(logs: np.ndarray) -> np.ndarray:
        moduli, times = split(logs)
        return np.hstack(
            [
                (make_columns(times, *data) * moduli)[:, 1 - solid :],
                differentiate(times, *data) * moduli[1:],
            ]
        )

    shortest, longest = np.log(find_ends(*data))
    low, high = start - _FARTHEST, start + _FARTHEST
    low[strengths:], high[strengths:] = shortest, longest
    found = least_squares(
        misfit,
        np.clip(start, low, high),
        slopes,
        bounds=(low, high),
        ftol=_SETTLED,
        max_nfev=_MOST_STEPS,
    )
    moduli, times = split(found.x)
    order = np.argsort(times)
    return _Series(np.append(moduli[0], moduli[1:][order]), times[order], 2 * found.cost)


def _drop_least(data: list[np.ndarray], series: _Series) -> _Series:
    """Return the series without the term whose loss raises the misfit least."""
    rows = make_columns(series.times, *data)
    found = []
    for place in np.flatnonzero(series.moduli):
        moduli = np.zeros(series.moduli.size)
        others = np.arange(moduli.size) != place
        moduli[others] = fit_closest(rows[:, others])
        found.append((float(np.sum((rows @ moduli - 1) ** 2)), int(place), moduli))
    moduli = min(found)[2]
    used = np.flatnonzero(moduli[1:])
    return _move(data, np.append(moduli[0], moduli[1:][used]), series.times[used])
