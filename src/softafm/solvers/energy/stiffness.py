"""Stiffness of the frame in hand, for bodies on which contacts of all radii do not look alike."""

from math import floor, log

from numba import boolean, float64

from softafm.compiled.functions import compile_for
from softafm.solvers.energy.layout import TABLE


@compile_for(boolean(TABLE, float64))
def find_stiffness(table, frame):
    """Interpolate the stiffness in a frame, m, into ``table.found``; False if that takes others.

    Entry by entry, six-point Lagrange in the logarithm of the frame. Nothing is to be found where
    all frames are alike.
    """
    entries, found = table.entries, table.found
    count, n = entries.shape[0], found.shape[0]
    if n == 0:
        return True
    place = (log(frame) - table.start) / table.step
    base = floor(place) - 2
    if base < 0 or base + 6 > count:
        return False
    t0 = place - base
    t1, t2, t3, t4, t5 = t0 - 1.0, t0 - 2.0, t0 - 3.0, t0 - 4.0, t0 - 5.0
    a, b, c = t0 * t1, t2 * t3, t4 * t5
    w0, w1, w2 = b * c * t1 / -120.0, b * c * t0 / 24.0, a * c * t3 / -12.0
    w3, w4, w5 = a * c * t2 / 12.0, a * b * t5 / -24.0, a * b * t4 / 120.0
    s0, s1, s2 = entries[base], entries[base + 1], entries[base + 2]
    s3, s4, s5 = entries[base + 3], entries[base + 4], entries[base + 5]
    for i in range(n):
        for j in range(n):
            found[i, j] = (
                w0 * s0[i, j] + w1 * s1[i, j] + w2 * s2[i, j]
                + w3 * s3[i, j] + w4 * s4[i, j] + w5 * s5[i, j]
            )  # fmt: skip
    return True
