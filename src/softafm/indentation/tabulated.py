"""Depths of one tip at very many contact radii: polynomials between a few that are integrated."""

from typing import TYPE_CHECKING

import numpy as np

from softafm.indentation.elastic import depth

if TYPE_CHECKING:
    from softafm.tips import Tip

_ORDER = 12
_NODES = np.polynomial.legendre.leggauss(_ORDER)[0]
_TO_SERIES = np.linalg.inv(np.polynomial.legendre.legvander(_NODES, _ORDER - 1))
_SMALLEST = 1e-9
"""Radius of the innermost panel, over that of the widest contact."""
_GRADES = 4.0 ** -np.arange(1, 12)
_GRADES = np.concatenate([-_GRADES, [0.0], _GRADES])
_FEW = 8
"""Number of joints up to which panels become finer towards each of them."""
_MOST = 100
"""Joints that are edges of panels, where there are more."""
_HALVINGS = 60


class Depths:
    """Depth of a tip without adhesion, as ``depth`` returns it, to about 1e-10 of it.

    Parameters
    ----------
    tip
        E.g. ``softafm.Paraboloid``.
    widest
        Largest contact radius, m; the table grows where a larger one is asked for.
    """

    def __init__(self, tip: "Tip", widest: float):
        self.tip = tip
        self._tabulate(widest)

    def __call__(self, radius: np.ndarray) -> np.ndarray:
        """Return the depths, m, in contacts of some radii, m."""
        widest = float(np.max(radius, initial=0.0))
        if widest > self._edges[-1]:
            self._tabulate(4 * widest)
        panel = np.clip(np.searchsorted(self._edges, radius) - 1, 0, self._edges.size - 2)
        low, high = self._edges[panel], self._edges[panel + 1]
        x = (2 * radius - low - high) / (high - low)
        return radius * np.polynomial.legendre.legval(x, self._series[:, panel], tensor=False)

    def find_radius(self, deep: np.ndarray) -> np.ndarray:
        """Return the contact radii, m, in which the tip is so deep, m, at depths of 0 or more."""
        low, high = np.zeros(deep.shape), np.full(deep.shape, self._edges[-1])
        while np.any(self(high) < deep):
            high *= 2
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            shallow = self(middle) <= deep
            low, high = np.where(shallow, middle, low), np.where(shallow, high, middle)
        return low

    @property
    def rough(self) -> np.ndarray:
        """Radii, m, between which the depth is smooth: near few joints, or some of very many."""
        joints = np.array(self.tip.joints)
        if joints.size <= _FEW:
            return np.outer(joints, 1 + _GRADES).ravel()
        return joints[:: -(-joints.size // _MOST)]

    def _tabulate(self, widest: float) -> None:
        halved = widest * np.append(0.0, 2.0 ** np.arange(np.log2(_SMALLEST), 1))
        edges = np.append(halved, self.rough)
        self._edges = np.unique(edges[edges <= halved[-1]])
        low, high = self._edges[:-1], self._edges[1:]
        radius = (low + high) / 2 + (high - low) / 2 * _NODES[:, None]
        self._series = _TO_SERIES @ (depth(self.tip, radius) / radius)


def make_depths(tip: "Tip", deepest: float) -> Depths:
    """Return the depths of a tip in contacts up to one of a depth, m, above 0."""
    # As δ(a) ≥ g(a), the contact is no wider than the tip at that height.
    return Depths(tip, tip.radius_at(deepest))
