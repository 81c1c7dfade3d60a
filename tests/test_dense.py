"""The small dense systems of the compiled loops against NumPy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from softafm.compiled import dense

seeds = st.integers(0, 2**32 - 1)


@given(st.integers(1, 90), seeds)
@settings(deadline=None, max_examples=60)
def test_positive_systems_are_solved(n, seed):
    random = np.random.default_rng(seed)
    root = random.normal(size=(n, n))
    matrix = root @ root.T + 0.1 * n * np.eye(n)
    right = random.normal(size=n)
    factor = np.triu(matrix) + np.tril(np.full((n, n), np.nan), -1)  # only the upper part is read
    assert dense.factorise(factor, n)
    upper = np.linalg.cholesky(matrix).T
    rooted = np.sqrt(np.diag(factor))[:, None]
    found = rooted * np.triu(factor, 1) + np.diag(1 / rooted[:, 0])
    assert np.allclose(found, upper, rtol=0, atol=1e-12 * np.abs(upper).max())
    x = right.copy()
    dense.solve_factorised(factor, x, n)
    wanted = np.linalg.solve(matrix, right)
    assert np.allclose(x, wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())
    out = np.empty(n)
    dense.multiply(matrix, right, out)
    assert np.allclose(out, matrix @ right, rtol=0, atol=1e-12 * np.abs(out).max())


@given(st.integers(1, 90), st.floats(-10, 0), seeds)
@settings(deadline=None, max_examples=60)
def test_indefinite_systems_are_rejected(n, lowest, seed):
    random = np.random.default_rng(seed)
    vectors, _ = np.linalg.qr(random.normal(size=(n, n)))
    values = random.uniform(0.5, 2, n)
    values[0] = lowest - 1e-6
    assert not dense.factorise(np.ascontiguousarray((vectors * values) @ vectors.T), n)


@pytest.mark.parametrize("n", [1, 3, 4, 5, 30])
def test_systems_with_nan_are_rejected(n):
    matrix = np.eye(n)
    matrix[n // 2, n // 2] = np.nan
    assert not dense.factorise(matrix, n)


@given(st.integers(1, 90), seeds)
@settings(deadline=None, max_examples=60)
def test_general_systems_are_solved(n, seed):
    random = np.random.default_rng(seed)
    matrix = random.normal(size=(n, n))
    right = random.normal(size=n)
    factor, pivots, x = matrix.copy(), np.zeros(n, np.int64), right.copy()
    sign = dense.factorise_general(factor, pivots)
    assert sign == np.linalg.slogdet(matrix)[0]
    dense.solve_general(factor, pivots, x)
    scale = np.linalg.cond(matrix) * np.abs(x).max()
    assert np.allclose(x, np.linalg.solve(matrix, right), rtol=0, atol=1e-14 * n * scale)


@pytest.mark.parametrize("n", [1, 3, 4, 5, 30])
@pytest.mark.parametrize("bad", [0.0, np.nan])
def test_general_systems_without_a_solution_are_rejected(n, bad):
    matrix = np.eye(n)
    matrix[n // 2, n // 2] = bad
    assert dense.factorise_general(matrix, np.zeros(n, np.int64)) == 0


@given(st.integers(1, 40), st.integers(1, 40), st.integers(1, 90), seeds)
@settings(deadline=None, max_examples=60)
def test_products_of_rows(rows, columns, n, seed):
    random = np.random.default_rng(seed)
    left, right = random.normal(size=(rows, n)), random.normal(size=(columns, n))
    out = np.full((rows, columns), np.nan)
    dense.multiply_rows(left, right, out)
    assert np.allclose(out, left @ right.T, rtol=0, atol=1e-12 * n)
    one = np.empty(rows)
    dense.multiply(left, right[0], one)
    assert np.allclose(one, left @ right[0], rtol=0, atol=1e-12 * n)
