"""What every solver returns: the contact's history."""

from dataclasses import dataclass, field

import numpy as np

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(4)


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
    profiles: Profiles | None = None
    diagnostics: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    def integrate(self, values, weight, start=-np.inf, stop=np.inf) -> float:
        """∫ values(t) weight(t) dt from ``start`` to ``stop`` (s).

        ``values`` (n,) is interpolated by a cubic spline within each smooth piece; ``weight`` is a
        function of time. Gauss-Legendre with four points a step.
        """
        from scipy.interpolate import make_interp_spline

        total = 0.0
        for piece in self.pieces:
            time = self.time[piece]
            if time.size < 2:
                continue
            edges = np.unique(np.clip(time, start, stop))
            if edges.size < 2:
                continue
            spline = make_interp_spline(time, values[piece], k=min(3, time.size - 1))
            middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
            at = middle[:, None] + half[:, None] * _POINTS
            total += float(np.sum(spline(at) * weight(at) * _WEIGHTS * half[:, None]))
        return total

    def extreme(self, values, sign: int, start=-np.inf, stop=np.inf) -> float:
        """Largest (``sign`` 1) or smallest (-1) of ``values`` (n,) between two times (s).

        Refined by the parabola through the extreme step and its neighbours in the same piece.
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
                if curvature < 0:
                    value -= slope**2 / (4 * curvature)
            best = max(best, value)
        return sign * float(best)
