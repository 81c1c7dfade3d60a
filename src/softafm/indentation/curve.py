"""What closed forms return: states of a contact in a row, and the last before it parts."""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import NamedTuple

import numpy as np

_ZOOMS, _POINTS = 8, 33
_HALVINGS = 60

States = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]
"""Contact radii (m), depths (m) and forces (N) at values of what leads along a curve, m."""


@dataclass(frozen=True, eq=False)
class Curve:
    """States of a contact in a row: of equilibrium, or in time.

    Parameters
    ----------
    contact_radius
        Radius of the contact, m, shape (n,); 0 where the surfaces do not touch.
    depth
        Depth of the apex below the undeformed surface, m, shape (n,); negative above it.
    force
        Force on the tip, N, shape (n,); positive = repulsive.
    time
        Instants, s, shape (n,); None where time plays no part.
    """

    contact_radius: np.ndarray
    depth: np.ndarray
    force: np.ndarray
    time: np.ndarray | None = None

    @property
    def height(self) -> np.ndarray:
        """Height of the apex above the undeformed surface, m, shape (n,)."""
        return -self.depth


class Parting(NamedTuple):
    """The last state of a contact that is pulled slowly; the force is 0 if nothing jumps."""

    contact_radius: float
    depth: float
    force: float


def find_last_state(states: States, coordinate: np.ndarray, stiffness: float) -> float:
    """Return where along a curve a contact parts from what pulls with a stiffness, N/m.

    A lever of stiffness k has its base at −(δ + F/k): the state of the least δ + F/k is the last.
    ``coordinate`` leads along the curve, m, and brackets the state.
    """
    for _ in range(_ZOOMS):
        _, depth, force = states(coordinate)
        pulled = depth if stiffness == inf else stiffness * depth + force
        least = int(pulled.argmin())
        ends = coordinate[max(least - 1, 0)], coordinate[min(least + 1, coordinate.size - 1)]
        coordinate = np.linspace(*ends, _POINTS)
    return float(coordinate[_POINTS // 2])


def find_coordinate(states: States, last: float, deepest: float) -> float:
    """Return where along a curve, beyond the state of least depth at ``last``, a depth is met."""
    low, high = last, 2 * last
    while states(np.array([high]))[1][0] < deepest:
        low, high = high, 2 * high
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        deeper = states(np.array([middle]))[1][0] > deepest
        low, high = (low, middle) if deeper else (middle, high)
    return low


def make_parting(states: States, coordinate: float) -> Parting:
    """Return the state at one place along a curve."""
    return Parting(*(float(values[0]) for values in states(np.array([coordinate]))))
