"""Small dense systems for compiled loops: factorise, solve, multiply.

Written out by hand, as calls to LAPACK and BLAS cost more than the work at the 25 to 80 unknowns of
a contact. Inner loops run over slices from 0: an index that the compiler cannot see to be positive
might count from the end, and such a loop is not vectorised.
"""

from numba import boolean, float64, int64, types

from softafm.compiled.functions import compile_for

_V = float64[::1]
_M = float64[:, ::1]
_CONST2 = types.Array(float64, 2, "C", readonly=True)


@compile_for(boolean(_M, int64))
def factorise(matrix, n):
    """RᵀD⁻¹R of the upper triangle in place, of Cholesky's kind without his roots.

    D is the diagonal of R, left inverted. False if the matrix is not positive.
    """
    for k in range(0, n - 3, 4):
        a1, a2, a3 = matrix[k, k + 1], matrix[k, k + 2], matrix[k, k + 3]
        b1, b2, b3 = matrix[k + 1, k + 1], matrix[k + 1, k + 2], matrix[k + 1, k + 3]
        c2, c3, e3 = matrix[k + 2, k + 2], matrix[k + 2, k + 3], matrix[k + 3, k + 3]
        if not matrix[k, k] > 0.0:
            return False
        da = 1.0 / matrix[k, k]
        f1, f2, f3 = a1 * da, a2 * da, a3 * da
        b1 -= f1 * a1
        if not b1 > 0.0:
            return False
        db, b2, b3 = 1.0 / b1, b2 - f1 * a2, b3 - f1 * a3
        g2, g3 = b2 * db, b3 * db
        c2 -= f2 * a2 + g2 * b2
        if not c2 > 0.0:
            return False
        dc, c3 = 1.0 / c2, c3 - f2 * a3 - g2 * b3
        h3 = c3 * dc
        e3 -= f3 * a3 + g3 * b3 + h3 * c3
        if not e3 > 0.0:
            return False
        de = 1.0 / e3
        matrix[k, k], matrix[k + 1, k + 1] = da, db
        matrix[k + 2, k + 2], matrix[k + 3, k + 3] = dc, de
        matrix[k + 1, k + 2], matrix[k + 1, k + 3], matrix[k + 2, k + 3] = b2, b3, c3
        a, b = matrix[k, k + 4 : n], matrix[k + 1, k + 4 : n]
        c, e = matrix[k + 2, k + 4 : n], matrix[k + 3, k + 4 : n]
        for j in range(a.size):
            y = b[j] - f1 * a[j]
            z = c[j] - f2 * a[j] - g2 * y
            b[j], c[j] = y, z
            e[j] -= f3 * a[j] + g3 * y + h3 * z
        whole = n - n % 4
        for i in range(k + 4, whole, 4):
            a, b = matrix[k, i:n], matrix[k + 1, i:n]
            c, e = matrix[k + 2, i:n], matrix[k + 3, i:n]
            a0, b0, c0, e0 = a[0] * da, b[0] * db, c[0] * dc, e[0] * de
            a1, b1, c1, e1 = a[1] * da, b[1] * db, c[1] * dc, e[1] * de
            a2, b2, c2, e2 = a[2] * da, b[2] * db, c[2] * dc, e[2] * de
            a3, b3, c3, e3 = a[3] * da, b[3] * db, c[3] * dc, e[3] * de
            row0, row1 = matrix[i, i:n], matrix[i + 1, i:n]
            row2, row3 = matrix[i + 2, i:n], matrix[i + 3, i:n]
            for j in range(row0.size):
                w, x, y, z = a[j], b[j], c[j], e[j]
                row0[j] -= a0 * w + b0 * x + c0 * y + e0 * z
                row1[j] -= a1 * w + b1 * x + c1 * y + e1 * z
                row2[j] -= a2 * w + b2 * x + c2 * y + e2 * z
                row3[j] -= a3 * w + b3 * x + c3 * y + e3 * z
        for i in range(whole, n):
            for j in range(i, n):
                matrix[i, j] -= (
                    matrix[k, i] * da * matrix[k, j]
                    + matrix[k + 1, i] * db * matrix[k + 1, j]
                    + matrix[k + 2, i] * dc * matrix[k + 2, j]
                    + matrix[k + 3, i] * de * matrix[k + 3, j]
                )
    for k in range(n - n % 4, n):
        if not matrix[k, k] > 0.0:
            return False
        matrix[k, k] = 1.0 / matrix[k, k]
        for i in range(k + 1, n):
            part = matrix[k, i] * matrix[k, k]
            for j in range(i, n):
                matrix[i, j] -= part * matrix[k, j]
    return True


@compile_for((_M, _V, int64))
def solve_factorised(factor, x, n):
    """Overwrite ``x`` with (RᵀD⁻¹R)⁻¹ x, four rows at a time."""
    whole = n - n % 4
    for i in range(0, whole, 4):
        z0 = x[i] * factor[i, i]
        x1 = x[i + 1] - z0 * factor[i, i + 1]
        z1 = x1 * factor[i + 1, i + 1]
        x2 = x[i + 2] - z0 * factor[i, i + 2] - z1 * factor[i + 1, i + 2]
        z2 = x2 * factor[i + 2, i + 2]
        x3 = x[i + 3] - z0 * factor[i, i + 3] - z1 * factor[i + 1, i + 3]
        x3 -= z2 * factor[i + 2, i + 3]
        z3 = x3 * factor[i + 3, i + 3]
        x[i + 1], x[i + 2], x[i + 3] = x1, x2, x3
        a, b = factor[i, i + 4 : n], factor[i + 1, i + 4 : n]
        c, e = factor[i + 2, i + 4 : n], factor[i + 3, i + 4 : n]
        rest = x[i + 4 : n]
        for j in range(rest.size):
            rest[j] -= z0 * a[j] + z1 * b[j] + z2 * c[j] + z3 * e[j]
    for i in range(whole, n):
        z0 = x[i] * factor[i, i]
        for j in range(i + 1, n):
            x[j] -= z0 * factor[i, j]
    for i in range(n - 1, whole - 1, -1):
        for j in range(i + 1, n):
            x[i] -= factor[i, j] * x[j]
        x[i] *= factor[i, i]
    for i in range(whole - 4, -1, -4):
        x0, x1, x2, x3 = x[i], x[i + 1], x[i + 2], x[i + 3]
        a, b = factor[i, i + 4 : n], factor[i + 1, i + 4 : n]
        c, e = factor[i + 2, i + 4 : n], factor[i + 3, i + 4 : n]
        rest = x[i + 4 : n]
        for j in range(rest.size):
            x0 -= a[j] * rest[j]
            x1 -= b[j] * rest[j]
            x2 -= c[j] * rest[j]
            x3 -= e[j] * rest[j]
        x3 *= factor[i + 3, i + 3]
        x2 = (x2 - factor[i + 2, i + 3] * x3) * factor[i + 2, i + 2]
        x1 -= factor[i + 1, i + 2] * x2 + factor[i + 1, i + 3] * x3
        x1 *= factor[i + 1, i + 1]
        x0 -= factor[i, i + 1] * x1 + factor[i, i + 2] * x2 + factor[i, i + 3] * x3
        x[i], x[i + 1], x[i + 2], x[i + 3] = x0 * factor[i, i], x1, x2, x3


@compile_for((_CONST2, _V, _V))
def multiply(matrix, x, out):
    """out = matrix x."""
    rows, columns = matrix.shape
    for i in range(rows):
        total = 0.0
        for j in range(columns):
            total += matrix[i, j] * x[j]
        out[i] = total


@compile_for((_CONST2, _CONST2, _M))
def multiply_rows(left, right, out):
    """out = left rightᵀ: dot products of the rows of two matrices, in blocks of 2 by 4."""
    rows, n = left.shape
    columns = right.shape[0]
    for i in range(0, rows, 2):
        pair = min(i + 1, rows - 1)
        j = 0
        while j + 4 <= columns:
            a0 = a1 = a2 = a3 = b0 = b1 = b2 = b3 = 0.0
            for s in range(n):
                x, y = left[i, s], left[pair, s]
                r0, r1, r2, r3 = right[j, s], right[j + 1, s], right[j + 2, s], right[j + 3, s]
                a0 += x * r0
                a1 += x * r1
                a2 += x * r2
                a3 += x * r3
                b0 += y * r0
                b1 += y * r1
                b2 += y * r2
                b3 += y * r3
            out[i, j], out[i, j + 1], out[i, j + 2], out[i, j + 3] = a0, a1, a2, a3
            out[pair, j], out[pair, j + 1], out[pair, j + 2], out[pair, j + 3] = b0, b1, b2, b3
            j += 4
        while j < columns:
            a0 = b0 = 0.0
            for s in range(n):
                a0 += left[i, s] * right[j, s]
                b0 += left[pair, s] * right[j, s]
            out[i, j], out[pair, j] = a0, b0
            j += 1


@compile_for(int64(_M, int64[::1]))
def factorise_general(matrix, pivots):
    """LU of a square matrix in place, rows exchanged; returns the sign of the determinant.

    The diagonal of U is inverted; ``pivots`` holds the exchanges. 0 if a pivot is 0 or NaN.
    """
    n = pivots.size
    sign = 1
    for k in range(0, n, 4):
        end = min(k + 4, n)
        for p in range(k, end):
            best, chosen = abs(matrix[p, p]), p
            for i in range(p + 1, n):
                if abs(matrix[i, p]) > best:
                    best, chosen = abs(matrix[i, p]), i
            if not best > 0.0:
                return 0
            pivots[p] = chosen
            if chosen != p:
                sign = -sign
                for j in range(n):
                    matrix[p, j], matrix[chosen, j] = matrix[chosen, j], matrix[p, j]
            if matrix[p, p] < 0.0:
                sign = -sign
            inverse = 1.0 / matrix[p, p]
            matrix[p, p] = inverse
            for i in range(p + 1, n):
                f = matrix[i, p] * inverse
                matrix[i, p] = f
                for j in range(p + 1, end):
                    matrix[i, j] -= f * matrix[p, j]
        if end == n:
            break
        for p in range(k + 1, end):
            for q in range(k, p):
                f = matrix[p, q]
                for j in range(end, n):
                    matrix[p, j] -= f * matrix[q, j]
        w, x = matrix[k, end:n], matrix[k + 1, end:n]
        y, z = matrix[k + 2, end:n], matrix[k + 3, end:n]
        for i in range(end, n - 1, 2):
            a0, a1, a2, a3 = matrix[i, k], matrix[i, k + 1], matrix[i, k + 2], matrix[i, k + 3]
            b0, b1 = matrix[i + 1, k], matrix[i + 1, k + 1]
            b2, b3 = matrix[i + 1, k + 2], matrix[i + 1, k + 3]
            a, b = matrix[i, end:n], matrix[i + 1, end:n]
            for j in range(a.size):
                a[j] -= a0 * w[j] + a1 * x[j] + a2 * y[j] + a3 * z[j]
                b[j] -= b0 * w[j] + b1 * x[j] + b2 * y[j] + b3 * z[j]
        if (n - end) % 2 == 1:
            a = matrix[n - 1]
            for j in range(w.size):
                a[end + j] -= a[k] * w[j] + a[k + 1] * x[j] + a[k + 2] * y[j] + a[k + 3] * z[j]
    return sign


@compile_for((_M, int64[::1], _V))
def solve_general(factor, pivots, x):
    """Overwrite ``x`` with the solution of a system factorised by ``factorise_general``."""
    n = pivots.size
    for i in range(n):
        x[i], x[pivots[i]] = x[pivots[i]], x[i]
    for i in range(n):
        total = x[i]
        for j in range(i):
            total -= factor[i, j] * x[j]
        x[i] = total
    for i in range(n - 1, -1, -1):
        total = x[i]
        for j in range(i + 1, n):
            total -= factor[i, j] * x[j]
        x[i] = total * factor[i, i]
