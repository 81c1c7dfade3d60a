"""What every solver returns: the contact's history."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from softafm.errors import AccuracyWarning
from softafm.instrument.motion import Motion

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(4)
_MOST_UNEVEN = 4.0


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
    motion: Motion
    """The motion as it was carried out: a ramp may have been turned by a force."""
    profiles: Profiles | None = None
    diagnostics: dict[str, float] = field(default_factory=dict)
    warnings: tuple[AccuracyWarning, ...] = ()
    """What the solver doubts; it has warned of it, too."""
    _quadratures: dict[Any, Any] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def integrate(
        self,
        values: np.ndarray,
        weight: Callable[[np.ndarray], Any],
        start: float = -np.inf,
        stop: float = np.inf,
    ) -> float:
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

    def _quadrature(self, start: float, stop: float) -> list[tuple[Any, ...]]:
        """Points and weights of every piece, and the cubics there: kept for the next integral."""
        from softafm.solvers.cubics import cubics

        key = start, stop
        if key not in self._quadratures:
            rules = self._quadratures[key] = []
            for piece in self.pieces:
                time = self.time[piece]
                edges = np.unique(np.clip(time, start, stop))
                if edges.size > 1:
                    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges)[:, None] / 2
                    at = middle[:, None] + half * _POINTS
                    count = min(4, time.size)
                    near = np.empty((len(at), count), int)
                    basis = np.empty((*at.shape, count))
                    cubics(time, at, near, basis)
                    rules.append((piece, at, half * _WEIGHTS, near, basis))
        return self._quadratures[key]

    def extreme(
        self, values: np.ndarray, sign: int, start: float = -np.inf, stop: float = np.inf
    ) -> float:
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
