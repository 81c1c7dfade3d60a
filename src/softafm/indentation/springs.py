"""Springs in place of a viscoelastic half-space, one at every radius, that a dent presses."""

from collections.abc import Callable
from itertools import pairwise
from math import inf, isinf, pi
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from softafm.bodies.body import body_of
from softafm.checks.validate import check_numbers
from softafm.indentation.curve import Curve
from softafm.indentation.dent import Dent
from softafm.indentation.tabulated import Depths, make_depths
from softafm.rheology import PowerLaw, chain_to_prony
from softafm.rheology.check import check_sample

if TYPE_CHECKING:
    from softafm.tips import Tip

Growth = Callable[[np.ndarray], np.ndarray]
"""∫ E*(s) ds from 0 to times (s), Pa s: the stress of a strain that grows evenly, over its rate."""

_POINTS = 100
"""Instants of a curve between two corners of the motion."""
_SEARCHED = 401
_SAME = 1e-9
_HALVINGS = 60
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
_GRADED = 8.0 ** -np.arange(6, 0, -1)
_PANELS = np.concatenate([[0.0], _GRADED[2:], [0.5], 1 - _GRADED[::-1], [1.0]])
"""Edges of panels of radii, in contact radii: finer at the edge, where springs are fresh."""


def integrate_modulus(sample: Any) -> Growth:
    """Return ∫ E*(s) ds of a sample or a half-space of it; ValueError of other bodies."""
    body = body_of(sample)
    if not isinf(body.length):
        raise ValueError(f"sample: is the body '{body.kind}'; must be a half-space, of one sample")
    solid = body.sample
    check_sample("sample", solid)
    share = 1 / (1 - solid.poisson**2)
    if isinstance(solid, PowerLaw):
        power, unit = 1 - solid.exponent, solid.reference_time
        return lambda time: share * solid.E1 * unit / power * (time / unit) ** power
    E_inf, moduli, times = chain_to_prony(*solid.compliance)

    def integrate(time: np.ndarray) -> np.ndarray:
        grown = E_inf * time
        for modulus, relaxation in zip(moduli, times, strict=True):
            grown = grown - modulus * relaxation * np.expm1(-time / relaxation)
        return share * grown

    return integrate


class Springs:
    """Loads q(ρ, t) of springs that one dent presses, by the time s at which each was met."""

    def __init__(self, dent: Dent, growth: Growth):
        self.dent, self.growth = dent, growth
        self.met = dent.time[: dent.turn + 1]

    def follow(self, tip: "Tip", over: float, times: np.ndarray) -> Curve:
        """Return the force on a tip at instants until and after the contact is over, s."""
        depths = make_depths(tip, float(self.dent.depth.max()))
        touching = (times > self.met[0]) & (times < over)
        radius, force = np.zeros(times.shape), np.zeros(times.shape)
        if np.any(touching):
            now = times[touching]
            loads = self._accumulate(now)
            radius[touching] = wide = depths.find_radius(self._find_depth(now, loads))
            force[touching] = self._sum_loads(now, loads, wide, depths)
        return Curve(radius, -np.interp(times, *self.dent.whole), force, times)

    def find_end(self) -> float:
        """Return when the contact is over, s; infinite if the motion ends before.

        Raises
        ------
        ValueError
            If the surface comes back faster than the tip withdraws.
        """
        dent = self.dent
        later = np.linspace(dent.time[dent.back], dent.time[-1], _SEARCHED)
        times = np.union1d(dent.time[dent.back :], later)
        loads = self._accumulate(times)
        over = np.flatnonzero(loads[:, 0] < 0)
        last = int(over[0]) if over.size else times.size
        depth = self._find_depth(times[:last], loads[:last])
        grows = np.append(np.diff(depth) > _SAME * dent.depth.max(), loads[last:, 0] > 0)
        if np.any(grows):
            at = float(times[int(np.argmax(grows))])
            raise ValueError(
                f"motion: withdraws at {at:g} s more slowly than the surface comes back, which "
                "meets the tip again; must withdraw faster"
            )
        if not over.size:
            return inf if dent.depth[-1] > 0 else float(times[-1])
        low, high = float(times[last - 1]), float(times[last])
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            ends = self._accumulate(np.array([middle]))[0, 0] < 0
            low, high = (low, middle) if ends else (middle, high)
        return high

    def _accumulate(self, time: np.ndarray) -> np.ndarray:
        """Return the loads, Pa m, at some times of springs met at the knots until the turn."""
        knots = np.minimum(self.dent.time, time[:, None])
        grown = self.growth(time[:, None] - knots)
        added = self.dent.speed * (grown[:, :-1] - grown[:, 1:])
        after = added[:, self.dent.turn :].sum(1, keepdims=True)
        before = np.cumsum(added[:, : self.dent.turn][:, ::-1], axis=1)[:, ::-1]
        return np.append(before + after, after, axis=1)

    def _find_depth(self, time: np.ndarray, loads: np.ndarray) -> np.ndarray:
        """Return how deep the tip was, m, when it met the springs at the edge: those of no load."""
        piece = np.clip(np.sum(loads > 0, axis=1) - 1, 0, self.dent.turn - 1)
        low, high = self.met[piece], np.minimum(self.met[piece + 1], time)
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            loaded = self._find_load(time, loads, piece, middle) > 0
            low, high = np.where(loaded, middle, low), np.where(loaded, high, middle)
        growing = loads[:, -1] >= 0
        met = np.where(growing, np.minimum(time, self.met[-1]), low)
        return np.interp(met, self.dent.time, self.dent.depth)

    def _find_load(
        self, time: np.ndarray, loads: np.ndarray, piece: np.ndarray, met: np.ndarray
    ) -> np.ndarray:
        """Return the loads, Pa m, of springs met at times in some pieces; all of shape (n, ...)."""
        end = np.minimum(self.met[piece + 1], time)
        onward = np.take_along_axis(loads, piece.reshape(time.shape[0], -1) + 1, 1)
        grown = self.growth(time - met) - self.growth(time - end)
        return onward.reshape(piece.shape) + self.dent.speed[piece] * grown

    def _sum_loads(
        self, time: np.ndarray, loads: np.ndarray, wide: np.ndarray, depths: Depths
    ) -> np.ndarray:
        """Return the forces, N: 2∫ q dρ from 0 to contact radii, m."""
        dent = self.dent
        kinks = depths.find_radius(dent.depth[dent.corners[dent.corners < dent.turn]])
        kinks = np.append(kinks, depths.rough)
        edges = np.concatenate([wide[:, None] * _PANELS, np.minimum(kinks, wide[:, None])], axis=1)
        edges = np.sort(edges, axis=1)
        middle, half = (edges[:, 1:] + edges[:, :-1]) / 2, np.diff(edges, axis=1) / 2
        radius = (middle[..., None] + half[..., None] * _NODES).reshape(time.size, -1)
        weight = (half[..., None] * _WEIGHTS).reshape(time.size, -1)
        deep = depths(radius)
        rising = dent.depth[: dent.turn + 1]
        piece = np.clip(np.searchsorted(rising, deep, side="right") - 1, 0, dent.turn - 1)
        speed = dent.speed[piece]
        met = self.met[piece] + (deep - rising[piece]) / np.where(speed > 0, speed, 1.0)
        now = time[:, None]
        met = np.clip(met, self.met[piece], np.minimum(self.met[piece + 1], now))
        return 2 * np.sum(weight * self._find_load(now, loads, piece, met), axis=1)

    def choose_times(self, over: float) -> np.ndarray:
        """Return times of a curve, s: dense where the motion has corners, and the contact ends."""
        corners, end = self.dent.time[self.dent.corners], min(over, float(self.dent.time[-1]))
        corners = np.append(corners[corners < end], end)
        grades = (1 - np.cos(np.linspace(0, pi, _POINTS))) / 2
        parts = [start + (end - start) * grades for start, end in pairwise(corners)]
        return np.unique(np.concatenate(parts))

    def check_times(self, time: ArrayLike) -> np.ndarray:
        """Return times of the motion, s; ValueError if one does not lie in it."""
        times = np.array(check_numbers("time", time, "s"))
        first, last = self.dent.whole[0][[0, -1]]
        outside = (times < first) | (times > last)
        if np.any(outside):
            raise ValueError(
                f"time = {times[outside][0]:g} s: must lie in the motion, {first:g} to {last:g} s"
            )
        return times
