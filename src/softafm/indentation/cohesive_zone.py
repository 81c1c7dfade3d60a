"""Adhesive elastic contacts between the limits of JKR and DMT: a cohesive zone of one tension."""

from collections.abc import Callable
from math import inf, log, pi
from typing import TYPE_CHECKING

import numpy as np

from softafm.checks.validate import check_finite, check_positive
from softafm.indentation.adhesive import jkr_parting
from softafm.indentation.check import check_modulus, check_stiffness, check_work
from softafm.indentation.curve import (
    Curve,
    Parting,
    find_coordinate,
    find_last_state,
    make_parting,
)
from softafm.indentation.elastic import load
from softafm.indentation.tabulated import make_depths

if TYPE_CHECKING:
    from softafm.tips import Tip

_POINTS = 151
_BEFORE = np.append(0.0, np.geomspace(1e-3, 1, 31))
_AFTER = np.geomspace(1e-4, 10, 121)
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)
_FRACTIONS, _WEIGHTS = (_NODES + 1) / 2, _WEIGHTS / 2
_MOST_STEPS, _SAME = 60, 1e-12
_HALVINGS = 60


def maugis(
    tip: "Tip", modulus: float, work_of_adhesion: float, tension: float, deepest: float
) -> Curve:
    """States of an adhesive contact whose surfaces attract each other evenly up to a range.

    A tension σ0 acts between surfaces that are apart by less than W/σ0: around a contact of radius
    a, where pressures stay finite at the edge, in a < r < c; before they touch in r < c. The curve
    leads from where the attraction begins, without force, to a depth, through stable and unstable
    states. It tends to ``jkr`` for large tensions, and for small ones to ``dmt_force``.

    Parameters
    ----------
    tip
        E.g. ``softafm.Paraboloid``.
    modulus
        Reduced modulus E*, Pa.
    work_of_adhesion
        Work of adhesion W, J/m².
    tension
        Tension σ0, Pa. With the ``largest_tension`` of another law the transition between the
        limits is where it is for that law; Maugis' λ is then 1.157 Tabor numbers.
    deepest
        Depth at which the curve ends, m; negative above the undeformed surface.

    Raises
    ------
    ValueError
        If a number is out of range, or no attraction reaches as high as ``deepest``.

    Notes
    -----
    With δ_e, F_e of ``depth`` and ``load``: δ = δ_e(a) − (2σ0/E*)√(c² − a²),
    F = F_e(a) − 2σ0 [a√(c² − a²) + c² acos(a/c)], and at r = c the gap is W/σ0, the sum of
    (2/π)∫ (δ_e(t) − δ_e(a))/√(c² − t²) dt from a to c, due to the tip, and of
    (4σ0/πE*)[√(c² − a²) acos(a/c) − (c − a)].

    References
    ----------
    D. Maugis, *J. Colloid Interface Sci.* 150, 243 (1992), for paraboloids, here by Abel
    transforms for any profile; before the surfaces touch K. L. Johnson and J. A. Greenwood,
    *J. Colloid Interface Sci.* 192, 326 (1997).
    """
    zone = _Zone(tip, modulus, work_of_adhesion, tension)
    deepest = check_finite("deepest", deepest, "m")
    if deepest <= -zone.range:
        raise ValueError(
            f"deepest = {deepest:g} m: must be above {-zone.range:g} m, where the attraction begins"
        )
    last = zone.find_last_state(inf)
    deep = find_coordinate(zone.find_states, last, deepest)
    grades = np.linspace(0, 1, _POINTS)
    places = [zone.touching * grades, last * grades, last + (deep - last) * grades**1.5]
    return Curve(*zone.find_states(np.unique(np.minimum(np.concatenate(places), deep))))


def maugis_parting(
    tip: "Tip",
    modulus: float,
    work_of_adhesion: float,
    tension: float,
    stiffness: float = inf,
) -> Parting:
    """Return the last state of a contact with a cohesive zone that is pulled slowly.

    Parameters
    ----------
    tip, modulus, work_of_adhesion, tension
        As for ``maugis``.
    stiffness
        Of what pulls, N/m: that of a lever, 0 at a fixed load, infinite at fixed grips.

    Returns
    -------
    Parting
        ``contact_radius`` and ``depth``, m, and ``force``, N; the radius is 0 if the surfaces no
        longer touch, and the force if they part without a jump.

    Raises
    ------
    ValueError
        If a number is out of range.
    """
    zone = _Zone(tip, modulus, work_of_adhesion, tension)
    return make_parting(zone.find_states, zone.find_last_state(check_stiffness(stiffness)))


class _Zone:
    """States along a curve, by a coordinate: the radius of the zone until the surfaces touch.

    From there on it rises with the radius of the contact.
    """

    def __init__(self, tip: "Tip", modulus: float, work_of_adhesion: float, tension: float):
        self.tip, self.modulus = tip, check_modulus(modulus)
        self.work = check_work(work_of_adhesion)
        self.tension = check_positive("tension", tension, "Pa")
        self.range = self.work / self.tension
        self.strain = 2 * self.tension / self.modulus
        self.depths = make_depths(tip, self.range)
        # The apex touches the surface that bulges under the tension.
        self.touching = _halve(
            lambda c: bool(tip.profile(c) + (1 - 2 / pi) * self.strain * c < self.range),
            tip.radius_at(self.range),
        )

    def find_last_state(self, stiffness: float) -> float:
        """Return the coordinate of the last state of a slow pull."""
        soft = jkr_parting(self.tip, self.modulus, self.work).contact_radius
        places = np.append(self.touching * _BEFORE, self.touching + soft * _AFTER)
        return find_last_state(self.find_states, places, stiffness)

    def find_states(self, coordinate: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return contact radius and depth, m, and force, N."""
        a = np.maximum(coordinate - self.touching, 0.0)
        touching = a > 0
        c = np.array(coordinate)
        c[touching] = a[touching] + self._find_width(a[touching])
        width = np.sqrt((c - a) * (c + a))
        bulge = np.where(touching, self.depths(a) - self.strain * width, 0.0)
        apart = self.range - self.tip.profile(c) + 2 / pi * self.strain * c
        deep = np.where(touching, bulge, -apart)
        zone = 2 * self.tension * (a * width + c**2 * np.arctan2(width, a))
        return a, deep, load(self.tip, a, self.modulus) - zone

    def _find_width(self, a: np.ndarray) -> np.ndarray:
        """Return the widths c − a, m, of the zones around contacts of radii a.

        By regula falsi (Illinois) between logarithms of width and gap, which are nearly straight.
        """
        # The gap at c is at least (1 − 2/π) times 2σ0/E* times the width, whatever the tip.
        most = self.range / (1 - 2 / pi) / self.strain
        high = np.full(a.shape, log(min(most, self.tip.radius_at(self.range))))
        above = self._compare_gap(a, high)
        while np.any(above < 0):
            high = np.where(above < 0, high + 1, high)
            above = self._compare_gap(a, high)
        low = high - 1
        below = self._compare_gap(a, low)
        while np.any(below > 0):
            low = np.where(below > 0, low - 1, low)
            below = self._compare_gap(a, low)
        for _ in range(_MOST_STEPS):
            middle = high - above * (high - low) / (above - below)
            there = self._compare_gap(a, middle)
            if np.all((np.abs(there) < _SAME) | (high - low < _SAME)):
                break
            # The end that stays counts half, or it would stay for ever (Illinois).
            moved = there > 0
            above, below = np.where(moved, there, above / 2), np.where(moved, below / 2, there)
            high, low = np.where(moved, middle, high), np.where(moved, low, middle)
        return np.exp(middle)

    def _compare_gap(self, a: np.ndarray, log_width: np.ndarray) -> np.ndarray:
        """Return the logarithm of the gaps at the edges of zones, in ranges of the attraction."""
        wide = np.exp(log_width)
        c, width = a + wide, np.sqrt(wide * (2 * a + wide))
        angle = np.arctan2(width, a)
        theta = angle[:, None] * _FRACTIONS
        rise = self.depths(c[:, None] * np.cos(theta)) - self.depths(a)[:, None]
        of_tip = 2 / pi * angle * (rise @ _WEIGHTS)
        return np.log((of_tip + 2 / pi * self.strain * (width * angle - wide)) / self.range)


def _halve(is_low: Callable[[float], bool], high: float) -> float:
    """Return where a condition that holds from 0 on ends, below ``high``."""
    low = 0.0
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if is_low(middle) else (low, middle)
    return high
