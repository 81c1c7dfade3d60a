"""How likely what a path leaves of a record is, if the noise of neighbours may be correlated."""

from math import log

import numpy as np

_MOST = 32
"""Earlier samples, at most, from which the noise of the next one is predicted."""


def judge_residuals(left: np.ndarray, smallest: float) -> tuple[float, int]:
    """Return the cost of residuals, and from how many earlier ones each is best predicted.

    The cost is n·log v + order·log n, with the variance v of what an autoregression of that order
    does not predict: −2 log of the likelihood, with the price of Schwarz' criterion. The order is
    the one that costs least, 0 for white noise.

    Parameters
    ----------
    left
        Residuals of evenly spaced samples, or nearly so, shape (n,).
    smallest
        Standard deviation below which nothing is distinguished.

    Notes
    -----
    Levinson and Durbin's recursion: P. J. Brockwell and R. A. Davis, Time Series: Theory and
    Methods (Springer, 1991), section 5.2.
    """
    n, floor = left.size, smallest**2
    lags = range(min(_MOST, n // 4) + 1)
    covariance = np.array([left[lag:] @ left[: n - lag] for lag in lags]) / n
    variance, weights = float(covariance[0]), np.empty(0)
    best = n * log(max(variance, floor)), 0
    for order in lags[1:]:
        if variance <= floor:
            break
        reflection = (covariance[order] - weights @ covariance[order - 1 : 0 : -1]) / variance
        weights = np.append(weights - reflection * weights[::-1], reflection)
        variance *= 1 - reflection**2
        best = min(best, (n * log(max(variance, floor)) + order * log(n), order))
    return best
