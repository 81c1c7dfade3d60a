"""The path of a record with noise: where its corners are, and what runs between them."""

from itertools import pairwise
from math import inf, log, sqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from softafm.instrument.innovations import judge_residuals

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

FEWEST = 20
"""Samples that a record has at least."""
_NEAREST = 5
"""Samples on each side of a corner, at least, that show it."""
_CHANCE = 1000.0
"""In how many records of a smooth path noise may pass for a corner once."""
_ROUNDING = 1e-9
"""Noise of a record that has none, over its range: that of nine digits."""
_LARGER = 1, 4, 16, 64, 256
"""How many times larger white noise may stand for correlated noise."""
_BLOCK = 500_000
"""Samples in windows that are fit at a time, for the sake of memory."""


class Path(NamedTuple):
    """Cubics between knots (s), highest power first, corners (s) among the knots, noise (m)."""

    knots: np.ndarray
    cubics: np.ndarray
    corners: np.ndarray
    noise: float


class _Drawn(NamedTuple):
    """Knots, cubics, and the corners among the knots with both ends, in units of the record."""

    knots: np.ndarray
    cubics: np.ndarray
    bounds: np.ndarray


def fit_path(time: np.ndarray, height: np.ndarray, noise: float | None) -> Path:
    """Fit a path to a record, as ``Trajectory.from_measurement`` describes it.

    Parameters
    ----------
    time, height
        Rising instants, s, and heights, m; shape (n,), n ≥ ``FEWEST``.
    noise
        Standard deviation of a height, m; estimated if None.
    """
    unit, scale = time[-1] - time[0], float(np.ptp(height)) or 1.0
    t, y = (time - time[0]) / unit, (height - height[0]) / scale
    sigma = max(_estimate_noise(t, y) if noise is None else noise / scale, _ROUNDING)
    knots, cubics, bounds = _draw_by_any_noise(t, y, sigma)
    powers = scale / unit ** np.arange(3.0, -1.0, -1.0)
    cubics = cubics * powers[:, None]
    cubics[3] += height[0]
    knots = time[0] + unit * knots
    knots[-1] = time[-1]
    return Path(knots, cubics, time[0] + unit * bounds[1:-1], sigma * scale)


def _draw_by_any_noise(t: np.ndarray, y: np.ndarray, sigma: float) -> _Drawn:
    """Draw a path for white noise, or for correlated noise if the path for white noise leaves that.

    Means of many samples vary by correlated noise as they do by white noise that is larger. So
    paths for larger noise are drawn, too, and the one that costs least is taken.
    """
    from scipy.interpolate import PPoly

    best, least = None, inf
    for larger in _LARGER:
        drawn = _draw(t, y, larger * sigma)
        left, order = judge_residuals(y - PPoly(drawn.cubics, drawn.knots)(t), _ROUNDING)
        if best is None and order == 0:
            return drawn
        cost = left + log(t.size) * (drawn.knots.size + 2 * drawn.bounds.size)
        if best is None or cost < least - 2 * log(_CHANCE):
            best, least = drawn, cost
    assert best is not None
    return best


def _draw(t: np.ndarray, y: np.ndarray, sigma: float) -> _Drawn:
    """Draw the simplest path that white noise allows."""
    cuts = _keep_needed(t, y, sigma, [0, *(_find_corners(t, y, sigma) + 1), t.size])
    bounds = np.array([0.0, *(0.5 * (t[i - 1] + t[i]) for i in cuts[1:-1]), 1.0])
    for _ in range(2):  # the second time with every sample on its side of the crossings
        cuts = [0, *np.searchsorted(t, bounds[1:-1]), t.size]
        curves = [_fit_curve(t, y, sigma, a, b)[0] for a, b in pairwise(cuts)]
        bounds = _find_crossings(t, curves, bounds)
    return _Drawn(*_join(curves, bounds), bounds)


def _estimate_noise(t: np.ndarray, y: np.ndarray) -> float:
    """Estimate the noise from what a cubic through its four neighbours leaves of each sample."""
    windows = np.lib.stride_tricks.sliding_window_view(t, 5)
    values = np.lib.stride_tricks.sliding_window_view(y, 5)
    left, variance = values[:, 2].copy(), np.ones(len(windows))
    neighbours = [0, 1, 3, 4]
    for j in neighbours:
        others = [k for k in neighbours if k != j]
        weight = np.prod(
            [(windows[:, 2] - windows[:, k]) / (windows[:, j] - windows[:, k]) for k in others], 0
        )
        left -= weight * values[:, j]
        variance += weight**2
    changing = np.ptp(values, axis=1) > 0  # a dead signal says nothing about noise
    if not changing.any():
        return 0.0
    return 1.4826 * float(np.median(np.abs(left[changing]) / np.sqrt(variance[changing])))


def _find_corners(t: np.ndarray, y: np.ndarray, sigma: float) -> np.ndarray:
    """Return the samples after which the path turns a corner, found at the shortest reach first."""
    n, found, reach = t.size, np.empty(0, int), _NEAREST
    while 2 * reach <= n:
        after = np.arange(reach - 1, n - reach, max(1, reach // 8))
        inside = np.searchsorted(found, after + reach)
        inside -= np.searchsorted(found, after - reach, side="right")
        after = after[inside == 0]
        blocks = np.array_split(after, 1 + after.size * reach // _BLOCK)
        gain = np.concatenate([_measure_gain(t, y, sigma, block, reach) for block in blocks])
        certain = np.count_nonzero(gain > 2 * log(_CHANCE * n / reach))
        for i in np.argsort(-gain)[:certain]:
            if not found.size or np.abs(found - after[i]).min() >= reach:
                found = np.sort(np.append(found, _place_corner(t, y, after[i], reach)))
        reach = int(1.6 * reach)
    return found


def _place_corner(t: np.ndarray, y: np.ndarray, after: int, reach: int) -> int:
    """Return the sample near ``after`` for which one-sided fits leave least of the same samples."""
    first, last = after - reach + 1, after + reach + 1
    places = np.unique(np.linspace(after - reach // 2, after + reach // 2, 65).astype(int))
    left = [
        _measure_residuals(t[None, a:b], y[None, a:b], 2)[0]
        for place in places
        for a, b in ((first, place + 1), (place + 1, last))
    ]
    return int(places[np.argmin(np.sum(np.reshape(left, (-1, 2)), axis=1))])


def _measure_gain(
    t: np.ndarray, y: np.ndarray, sigma: float, after: np.ndarray, reach: int
) -> np.ndarray:
    """Return by how many variances of noise two one-sided fits beat one, less what they miss.

    Two parabolas stand against a polynomial of degree 5, which has as many parameters and suits
    every smooth path better. ``after`` (m,) are the last samples of the left sides.
    """
    index = after[:, None] + np.arange(1 - reach, reach + 1)
    times, values = t[index], y[index] / sigma
    one = _measure_residuals(times, values, 5)
    two = _measure_residuals(times[:, :reach], values[:, :reach], 2)
    two += _measure_residuals(times[:, reach:], values[:, reach:], 2)
    freedom = 2 * reach - 6
    # The noise may be a tenth larger than estimated.
    return one - two - 4 * np.maximum(two - 1.2 * freedom - sqrt(2 * freedom), 0.0)


def _measure_residuals(times: np.ndarray, values: np.ndarray, degree: int) -> np.ndarray:
    """Return the sums of squares that polynomials of a degree leave of rows of samples, (m,)."""
    x = times - 0.5 * (times[:, :1] + times[:, -1:])
    x /= x[:, -1:]
    basis: list[np.ndarray] = []
    left = values
    for power in range(degree + 1):
        term = np.ones_like(x) if power == 0 else x * basis[-1]
        for earlier in basis[-2:]:
            term = term - earlier * np.sum(earlier * term, 1, keepdims=True)
        term /= np.sqrt(np.sum(term * term, 1, keepdims=True))
        left = left - term * np.sum(term * left, 1, keepdims=True)
        basis.append(term)
    return np.sum(left * left, 1)


def _keep_needed(t: np.ndarray, y: np.ndarray, sigma: float, cuts: list[int]) -> list[int]:
    """Return the cuts without those in whose place one curve, over both sides, costs less."""
    kept = cuts[:1]
    for cut, end in pairwise(cuts[1:]):
        apart = _fit_curve(t, y, sigma, kept[-1], cut)[1] + _fit_curve(t, y, sigma, cut, end)[1]
        if apart < _fit_curve(t, y, sigma, kept[-1], end)[1]:
            kept.append(cut)
    return [*kept, cuts[-1]]


def _fit_curve(
    t: np.ndarray, y: np.ndarray, sigma: float, start: int, end: int
) -> "tuple[BSpline, float]":
    """Return the line or cubic spline through samples ``start`` to ``end`` that costs least.

    The cost is misfit/σ² + parameters·log n. Twice as many knots are tried each time, until some
    explain all but the noise and more cost more.
    """
    from scipy.interpolate import make_lsq_spline

    price, t, y = log(t.size), t[start:end], y[start:end]
    most, noise = t.size // 4, t.size + 5 * sqrt(2 * t.size)
    best, least, misfit, dearer = None, inf, inf, 0
    for degree, inner in [(1, 0), *((3, int(2**k)) for k in range(-1, most.bit_length()))]:
        if (dearer >= 3 and misfit < noise) or (degree == 3 and inner + 2 > most):
            break
        knots = np.interp(np.linspace(0, t.size - 1, inner + 2), np.arange(t.size), t)
        knots = np.concatenate([[t[0]] * degree, knots, [t[-1]] * degree])
        curve = make_lsq_spline(t, y, knots, degree)
        misfit = float(np.sum((curve(t) - y) ** 2)) / sigma**2
        cost = misfit + price * (inner + degree + 1)
        dearer = 0 if cost < least else dearer + 1
        if cost < least:
            best, least = curve, cost
    return best, least


def _find_crossings(t: np.ndarray, curves: "list[BSpline]", bounds: np.ndarray) -> np.ndarray:
    """Return the bounds moved to where neighbours cross, if they do so few samples away."""
    moved, place = bounds.copy(), np.searchsorted(t, bounds)
    for i, (before, after) in enumerate(pairwise(curves), start=1):
        near = max(1, min(place[i] - place[i - 1], place[i + 1] - place[i]) // 4)
        low, high = t[place[i] - near - 1], t[place[i] + near]
        at = bounds[i]
        for _ in range(4):
            slope = before(at, 1) - after(at, 1)
            at -= (before(at) - after(at)) / slope if slope else inf
            if not low < at < high:
                break
        else:
            moved[i] = at
    # Where few samples lie between corners, crossings may leave too few for a curve.
    samples = np.diff(np.searchsorted(t, moved))
    kept = np.all(np.diff(moved) > 0) and np.all(samples >= _NEAREST)
    return moved if kept else bounds


def _join(curves: "list[BSpline]", bounds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return knots and cubics of curves that meet at the bounds, tilted where they do not cross."""
    inner = zip(pairwise(curves), bounds[1:-1], strict=True)
    missed = [0.0, *(0.5 * float(after(at) - before(at)) for (before, after), at in inner), 0.0]
    knots, cubics = [], []
    for i, (curve, (start, end)) in enumerate(zip(curves, pairwise(bounds), strict=True)):
        tilt = (missed[i] + missed[i + 1]) / (end - start)
        between = np.unique(curve.t)
        x = np.concatenate([[start], between[(between > start) & (between < end)]])
        height = curve(x) - missed[i] + tilt * (x - start)
        # The derivatives of a line end at the first.
        third, second = (curve(x, n) if n <= curve.k else np.zeros(x.size) for n in (3, 2))
        knots.append(x)
        cubics.append([third / 6, second / 2, curve(x, 1) + tilt, height])
    return np.concatenate([*knots, bounds[-1:]]), np.concatenate(cubics, axis=1)
