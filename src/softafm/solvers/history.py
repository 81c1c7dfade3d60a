"""What every solver returns: the contact's history."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(4)
_MOST_UNEVEN = 4.0
_LONGEST = 10.0
"""How many times as long as one beside it an interval may be for a cubic to cross it."""


@dataclass(frozen=True)
class Profiles:
    """Surface shapes on common radii: ``radius`` (r,) m and ``deformation`` (time, r) m."""

    radius: np.ndarray
    deformation: np.ndarray


@dataclass(frozen=True)
class History:
    """One contact through one motion. Arrays over the accepted steps, shape (n,)."""

    time: np.ndarray
    """Instants, s."""
    tip_height: np.ndarray
    """Height h0 of the apex above the flat surface, m."""
    force: np.ndarray
    """Force on the tip, N, positive = repulsive."""
    contact_radius: np.ndarray
    """Radius of the largest tension, m; 0 out of contact."""
    axis_deformation: np.ndarray
    """Displacement u of the surface under the apex, m, positive towards the tip."""
    viscous_power: np.ndarray
    """Power dissipated in the sample's dashpots, W."""
    pieces: tuple[slice, ...]
    """Runs of steps over which the history is smooth; neighbours share the step at a break of the
    motion, and none at an elastic jump."""
    jump_time: np.ndarray
    """Instants of elastic jumps, s, shape (jump,)."""
    jump_energy: np.ndarray
    """Energy each jump released, J, shape (jump,)."""
    motion: Any
    """The motion as it was carried out: a ramp may have been turned by a force."""
    profiles: Profiles | None = None
    diagnostics: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    _quadratures: dict = field(default_factory=dict, init=False, repr=False, compare=False)

    def integrate(self, values, weight, start=-np.inf, stop=np.inf) -> float:
        """∫ values(t) weight(t) dt from ``start`` to ``stop`` (s).

        ``values`` (n,) is interpolated in every step by the cubic through its four nearest
        instants of the same smooth piece; ``weight`` is a function of time. Gauss-Legendre with
        four points a step.
        """
        total = 0.0
        for piece, at, lengths, near, basis in self._quadrature(start, stop):
            interpolated = np.einsum("mpc,mc->mp", basis, values[piece][near])
            total += float(np.sum(interpolated * weight(at) * lengths))
        return total

    def _quadrature(self, start, stop) -> list[tuple]:
        """Points and weights of every piece, and the cubics there: kept for the next integral."""
        key = start, stop
        if key not in self._quadratures:
            rules = self._quadratures[key] = []
            for piece in self.pieces:
                time = self.time[piece]
                edges = np.unique(np.clip(time, start, stop))
                if edges.size > 1:
                    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges)[:, None] / 2
                    at = middle[:, None] + half * _POINTS
                    rules.append((piece, at, half * _WEIGHTS, *cubics(time, at)))
        return self._quadratures[key]

    def extreme(self, values, sign: int, start=-np.inf, stop=np.inf) -> float:
        """Largest (``sign`` 1) or smallest (-1) of ``values`` (n,) between two times (s).

        Refined by the parabola through the extreme step and its neighbours in the same piece, where
        they are about as far away on one side as on the other.
        """
        best = -np.inf
        for piece in self.pieces:
            time, height = self.time[piece], sign * values[piece]
            inside = np.flatnonzero((time >= start) & (time <= stop))
            if inside.size == 0:
                continue
            top = inside[np.argmax(height[inside])]
            value = height[top]
            if inside[0] < top < inside[-1]:
                (x0, x1), (y0, y1) = (
                    time[top - 1 : top + 2 : 2] - time[top],
                    height[top - 1 : top + 2 : 2] - value,
                )
                curvature = (y1 / x1 - y0 / x0) / (x1 - x0)
                slope = y0 / x0 - curvature * x0
                if curvature < 0 and _MOST_UNEVEN * x1 > -x0 > x1 / _MOST_UNEVEN:
                    value -= slope**2 / (4 * curvature)
            best = max(best, value)
        return sign * float(best)


def cubics(time, at):
    """Instants near ``at`` (m, points), each row within one interval of ``time`` (n,).

    Returns their indices (m, 4) and the values (m, points, 4) of Lagrange's polynomials through
    them, of four instants, or all if there are fewer; of two where intervals are very uneven.
    """
    count = min(4, time.size)
    right = np.searchsorted(time, at.mean(axis=1))
    first = np.clip(right - 2, 0, time.size - count)
    near = first[:, None] + np.arange(count)
    instants = time[near].T
    offsets = at - instants[:, :, None]
    terms = np.empty(offsets.shape)
    for j in range(count):
        others = [other for other in range(count) if other != j]
        apart = np.prod(instants[j] - instants[others], axis=0)
        terms[j] = np.prod(offsets[others], axis=0) / apart[:, None]
    basis = np.ascontiguousarray(np.moveaxis(terms, 0, -1))
    # A cubic runs wild across an interval that is much longer than one beside it: a line does not.
    length = time[right] - time[right - 1]
    for row in np.flatnonzero(length > _LONGEST * np.diff(instants, axis=0).min(axis=0)):
        part = (at[row] - time[right[row] - 1]) / length[row]
        basis[row] = 0
        basis[row, :, right[row] - 1 - first[row]] = 1 - part
        basis[row, :, right[row] - first[row]] = part
    return near, basis
