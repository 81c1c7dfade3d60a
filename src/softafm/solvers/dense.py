"""Small dense symmetric systems for compiled loops: factorise, solve, multiply.

Written out by hand, as calls to LAPACK cost more than the work at the 25 to 80 unknowns of a
contact.
"""

from math import sqrt

from numba import boolean, float64, int64, njit, types

_FAST = {"reassoc", "contract", "nsz", "arcp"}
_V = float64[::1]
_M = float64[:, ::1]
_CONST2 = types.Array(float64, 2, "C", readonly=True)


@njit(boolean(_M, int64), cache=True, fastmath=_FAST)
def factorise(matrix, n):
    """Cholesky UᵀU of the upper triangle in place, diagonal inverted; False if not positive."""
    k = 0
    while k < n:
        block = min(4, n - k)
        for p in range(k, k + block):
            for q in range(k, p):
                f = matrix[q, p]
                for j in range(p, n):
                    matrix[p, j] -= f * matrix[q, j]
            if not matrix[p, p] > 0.0:
                return False
            root = 1.0 / sqrt(matrix[p, p])
            matrix[p, p] = root
            for j in range(p + 1, n):
                matrix[p, j] *= root
        if block < 4:
            return True
        i = k + 4
        while i + 2 <= n:
            a0, a1, a2, a3 = matrix[k, i], matrix[k + 1, i], matrix[k + 2, i], matrix[k + 3, i]
            b0, b1 = matrix[k, i + 1], matrix[k + 1, i + 1]
            b2, b3 = matrix[k + 2, i + 1], matrix[k + 3, i + 1]
            matrix[i, i] -= a0 * a0 + a1 * a1 + a2 * a2 + a3 * a3
            for j in range(i + 1, n):
                x0, x1, x2, x3 = matrix[k, j], matrix[k + 1, j], matrix[k + 2, j], matrix[k + 3, j]
                matrix[i, j] -= a0 * x0 + a1 * x1 + a2 * x2 + a3 * x3
                matrix[i + 1, j] -= b0 * x0 + b1 * x1 + b2 * x2 + b3 * x3
            i += 2
        if i < n:
            a0, a1, a2, a3 = matrix[k, i], matrix[k + 1, i], matrix[k + 2, i], matrix[k + 3, i]
            matrix[i, i] -= a0 * a0 + a1 * a1 + a2 * a2 + a3 * a3
        k += 4
    return True


@njit((_M, _V, int64), cache=True, fastmath=_FAST)
def solve_factorised(factor, x, n):
    """Overwrite ``x`` with (UᵀU)⁻¹ x."""
    for i in range(n):
        x[i] *= factor[i, i]
        f = x[i]
        for j in range(i + 1, n):
            x[j] -= f * factor[i, j]
    for i in range(n - 1, -1, -1):
        total = x[i]
        for j in range(i + 1, n):
            total -= factor[i, j] * x[j]
        x[i] = total * factor[i, i]


@njit((_CONST2, _V, _V, int64), cache=True, fastmath=_FAST)
def multiply(matrix, x, out, n):
    """out = matrix x."""
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += matrix[i, j] * x[j]
        out[i] = total
