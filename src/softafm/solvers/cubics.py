"""Interpolation of a history by local cubics."""

import numpy as np
from numba import float64, int64

from softafm.compiled.functions import compile_for

COUNT = 4
"""Instants that a cubic goes through, and points of the rule of integration in a step."""
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(COUNT)
_LONGEST = 10.0
"""How many times as long as one beside it an interval may be for a cubic to cross it."""


@compile_for(
    (float64[:], float64[:, :], int64[:, ::1], float64[:, :, ::1]),
    fastmath=False,
    error_model="python",
)
def interpolate(time, at, near, basis):
    """Lagrange's polynomials through the four instants of ``time`` (n,) nearest to points in time.

    Each row of ``at`` (m, points) lies within one interval, beyond that of the row before. The same
    row of ``near`` (m, 4) gets the indices of the instants, and that of ``basis`` (m, points, 4)
    the values of the polynomials. Of fewer than four instants all serve. Where intervals are very
    uneven a cubic would run wild, and the line through the two next instants serves.
    """
    rows, most = near.shape
    count = min(most, time.size)
    left = 0
    for m in range(rows):
        while time[left + 1] < at[m, 0]:
            left += 1
        first = min(max(left - 1, 0), time.size - count)
        shortest = time[left + 1] - time[left]
        for j in range(most):
            near[m, j] = first + min(j, count - 1)
            if 0 < j < count:
                shortest = min(shortest, time[first + j] - time[first + j - 1])
        uneven = time[left + 1] - time[left] > _LONGEST * shortest
        begin, end = (left, left + 2) if uneven else (first, first + count)
        basis[m] = 0.0
        for j in range(begin, end):
            scale = 1.0
            for other in range(begin, end):
                scale *= time[j] - time[other] if other != j else 1.0
            for p in range(at.shape[1]):
                value = 1.0
                for other in range(begin, end):
                    value *= at[m, p] - time[other] if other != j else 1.0
                basis[m, p, j - first] = value / scale


@compile_for(
    int64(
        float64[:], int64[:, ::1], float64, float64, int64[::1], float64[:, ::1],
        float64[:, ::1], int64[:, ::1], float64[:, :, ::1],
    ),
    fastmath=False,
    error_model="python",
)  # fmt: skip
def lay(time, ends, start, stop, step, at, lengths, near, basis):
    """Fill the arrays of a ``Quadrature`` for pieces between the ``ends`` (pieces, 2).

    Returns how many steps there are.
    """
    count = 0
    for first, last in ends:
        begun = count
        for i in range(first, last - 1):
            a, b = max(time[i], start), min(time[i + 1], stop)
            if a < b:
                step[count] = i
                for p in range(COUNT):
                    at[count, p] = (b + a) / 2 + (b - a) / 2 * _POINTS[p]
                    lengths[count, p] = (b - a) / 2 * _WEIGHTS[p]
                count += 1
        found = near[begun:count]
        interpolate(time[first:last], at[begun:count], found, basis[begun:count])
        for m in range(begun, count):
            for j in range(COUNT):
                near[m, j] += first
    return count
