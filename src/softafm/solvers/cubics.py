"""Interpolation of a history by local cubics."""

from numba import float64, int64

from softafm.compiled.functions import compile_for

_LONGEST = 10.0
"""How many times as long as one beside it an interval may be for a cubic to cross it."""


@compile_for(
    (float64[:], float64[:, :], int64[:, ::1], float64[:, :, ::1]),
    fastmath=False,
    error_model="python",
)
def cubics(time, at, near, basis):
    """Lagrange's polynomials through the four instants of ``time`` (n,) nearest to points in time.

    Each row of ``at`` (m, points) lies within one interval, beyond that of the row before. The same
    row of ``near`` (m, count) gets the indices of the instants, and that of ``basis``
    (m, points, count) the values of the polynomials; ``count`` is 4, or n if that is less. Where
    intervals are very uneven a cubic would run wild, and the line through the two next instants
    serves.
    """
    rows, count = near.shape
    left = 0
    for m in range(rows):
        while time[left + 1] < at[m, 0]:
            left += 1
        first = min(max(left - 1, 0), time.size - count)
        shortest = time[left + 1] - time[left]
        for j in range(count):
            near[m, j] = first + j
            if j > 0:
                shortest = min(shortest, time[first + j] - time[first + j - 1])
        uneven = time[left + 1] - time[left] > _LONGEST * shortest
        for p in range(at.shape[1]):
            for j in range(count):
                value = 1.0
                for other in range(count):
                    if uneven and not left <= first + other <= left + 1:
                        continue
                    if other != j:
                        a, b = time[first + other], time[first + j]
                        value *= (at[m, p] - a) / (b - a)
                inside = left <= first + j <= left + 1
                basis[m, p, j] = value if inside or not uneven else 0.0
