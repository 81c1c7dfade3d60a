"""Integrals and extremes of a history, interpolated by local cubics."""

from typing import NamedTuple

import numpy as np

from softafm.solvers.cubics import COUNT, interpolate, lay

_SHARES = np.linspace(0, 1, 64)[1:-1]


class Quadrature(NamedTuple):
    """Gauss-Legendre rule with four points in each of m steps, and the cubics at its points.

    Attributes
    ----------
    step
        Index of the instant at which each step starts, shape (m,).
    at, lengths
        Points in time, s, and their weights, s, shape (m, 4).
    near, basis
        Indices of the instants that are interpolated between, shape (m, 4), and how much each
        counts at each point, shape (m, 4, 4).
    """

    step: np.ndarray
    at: np.ndarray
    lengths: np.ndarray
    near: np.ndarray
    basis: np.ndarray

    def interpolate(self, values: np.ndarray) -> np.ndarray:
        """Values (n,) at the instants, interpolated at the points, shape (m, 4)."""
        return np.einsum("mpc,mc->mp", self.basis, values[self.near])


def lay_quadrature(
    time: np.ndarray, pieces: tuple[slice, ...], start: float, stop: float
) -> Quadrature:
    """Return the rule for a history at instants ``time`` (n,), smooth in ``pieces``.

    Steps that reach beyond ``start`` or ``stop``, s, count up to there.
    """
    ends = np.array([piece.indices(time.size)[:2] for piece in pieces])
    size = int((ends[:, 1] - ends[:, 0] - 1).sum())
    step, near = np.empty(size, int), np.empty((size, COUNT), int)
    at, lengths = np.empty((2, size, COUNT))
    basis = np.empty((size, COUNT, COUNT))
    count = lay(time, ends, start, stop, step, at, lengths, near, basis)
    return Quadrature(*(each[:count] for each in (step, at, lengths, near, basis)))


def find_summit(time: np.ndarray, height: np.ndarray, top: int) -> float:
    """Largest height (n,) that the local cubics have within an interval of the instant ``top``."""
    starts, ends = time[top - 1 : top + 1, None], time[top : top + 2, None]
    at = starts + (ends - starts) * _SHARES
    near, basis = np.empty((2, COUNT), int), np.empty((2, _SHARES.size, COUNT))
    interpolate(time, at, near, basis)
    return float(np.einsum("mpc,mc->mp", basis, height[near]).max())
