"""What touches: tip, sample and the law between them, and the scales that follow."""

from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, pi, sqrt

import numpy as np
from numpy.typing import ArrayLike

from softafm.bodies import Body
from softafm.bodies.body import body_of
from softafm.bodies.check import check_body
from softafm.checks.kinds import is_built_in, refuse_other
from softafm.checks.validate import LARGEST_TABOR, check_tabor
from softafm.rheology import Solid
from softafm.rheology.check import check_compliance, check_sample
from softafm.surfaces import SurfaceLaw
from softafm.surfaces.check import check_law
from softafm.surfaces.limits import LONGEST
from softafm.tips import Tip
from softafm.tips.check import check_tip

_ZOOMS, _POINTS = 9, 33
_ROUGH = 0.1
"""Largest error of a least depth on radii 15 % apart, relative: ten times that of a paraboloid."""
_STEEP, _LARGEST_OF_STEEP = 0.05, 20.0
"""Width over which a tip rises from one to two ranges of the attraction, in radii of the open
contact, below which its edge stays there (paraboloids have 0.4, cones 0.9, punches 0), and the
Tabor number up to which the solver can follow such a contact."""
_SOFT = 1e-4
"""Share of the modulus to which the repulsion of a law without attraction falls at the edge."""
_FAINT, _DIAMOND = 1e-6, 1e12
"""Share of the modulus up to which an attraction is not felt, and the largest modulus that counts
there, Pa: a sample said to be rigid feels none."""
_MOST_STRETCHES, _SAME = 60, 1e-9
_MOST_DOUBLINGS = 200


@dataclass(frozen=True)
class Contact:
    """A rigid tip above a viscoelastic body with a surface law between them.

    Parameters
    ----------
    tip
        Shape of the tip, e.g. ``Paraboloid``.
    sample
        Rheology of a half-space, e.g. ``StandardLinearSolid``, or a ``softafm.bodies.Body``.
    surface
        Pressure against gap, e.g. ``LennardJones``.

    Raises
    ------
    ValueError
        If one of them is something else, or of a class of the user's own that is not what the
        guide to such classes asks for: profiles, laws, samples and bodies are tried here.
    """

    tip: Tip
    sample: Solid | Body
    surface: SurfaceLaw

    def __post_init__(self) -> None:
        refuse_other("tip", self.tip, Tip, "a tip such as softafm.Paraboloid")
        refuse_other(
            "surface", self.surface, SurfaceLaw, "a surface law such as softafm.LennardJones"
        )
        check_tip(self.tip)
        self._check_body()
        check_law(self.surface)

    def _check_body(self) -> None:
        body = body_of(self.sample)
        check_sample("sample" if body is not self.sample else "sample.sample", body.sample)
        check_body(body)
        if not is_built_in(body):
            check_compliance("sample.compliance", body.compliance)

    @cached_property
    def body(self) -> Body:
        """The elastic thing under the tip: ``sample``, or a half-space of it."""
        return body_of(self.sample)

    @property
    def rheology(self) -> Solid:
        """The sample itself, of a body the one at its surface."""
        return self.body.sample

    @property
    def _modulus_instantaneous(self) -> float:
        return 1 / self.body.compliance.instantaneous

    @property
    def _modulus_relaxed(self) -> float:
        return 1 / self.body.compliance.relaxed

    @cached_property
    def adhesive(self) -> bool:
        """Whether it takes work to part the surfaces."""
        return self.surface.attracts and self.surface.work_of_adhesion > 0

    @cached_property
    def pulled(self) -> bool:
        """Whether there is an attraction that the sample feels.

        It does not in the faint outer minimum of a double layer, far from where it is pressed.
        """
        law = self.surface
        hardness = min(self.softened_modulus, _DIAMOND)
        return law.attracts and law.largest_tension > _FAINT * hardness

    @property
    def sticky(self) -> bool:
        """Whether the sample feels an attraction that takes work to part."""
        return self.adhesive and self.pulled

    @cached_property
    def edge_gap(self) -> float:
        """Gap at the edge of the contact, m: that of largest tension.

        Without attraction, or a faint one, that at which the repulsion has fallen to 1e-4 of the
        softened modulus.
        """
        if self.pulled:
            return self.surface.gap_of_largest_tension
        low, high, least = 1e-12, 1e-6, _SOFT * self.softened_modulus
        for _ in range(60):
            middle = sqrt(low * high)
            low, high = (middle, high) if self.surface.pressure(middle) > least else (low, middle)
        return low

    @cached_property
    def softened_modulus(self) -> float:
        """Long-term reduced modulus; of a sample that flows, its modulus when flow sets in, Pa."""
        creep = self.body.compliance
        if creep.fluidity == 0:
            return 1 / creep.relaxed
        slowest = max([creep.instantaneous / creep.fluidity, *creep.retardation_times])
        return 1 / float(creep.at(slowest))

    @cached_property
    def reach(self) -> float:
        """Distance over which the pressure changes at the edge of the contact, m.

        The range of the attraction, or of a law that only repels the length in which it decays.
        """
        gap = self.edge_gap
        if self.pulled:
            return self.surface.width_of_well if self.adhesive else gap
        return -float(self.surface.pressure(gap) / self.surface.slope(gap))

    @cached_property
    def effective_radius(self) -> float:
        """Radius of the paraboloid that rises as high as the tip where its height is one reach, m.

        It takes the place of the radius of curvature for tips that are no paraboloids.
        """
        return self.tip.radius_at(self.reach) ** 2 / (2 * self.reach)

    @cached_property
    def open_radius(self) -> float:
        """Radius over which tip and sample feel each other before they touch, m."""
        return self.tip.radius_at(1.125 * self.reach)

    @cached_property
    def open_width(self) -> float:
        """Width of the zone there in which the gap opens, m."""
        return self.tip.radius_at(2 * self.reach) - self.tip.radius_at(self.reach)

    @property
    def largest_tabor(self) -> float:
        """Tabor number up to which the default solver can follow the edge: less if it is steep."""
        return _LARGEST_OF_STEEP if self.steep else LARGEST_TABOR

    @cached_property
    def steep(self) -> bool:
        """Whether the tip rises so steeply, as at the rim of a punch, that it holds the edge."""
        return self.open_width <= _STEEP * self.open_radius

    @cached_property
    def force_scale(self) -> float:
        """A force to be felt, N: a part of the pull-off, or of Hertz's at a depth of one reach."""
        if self.adhesive:
            return 0.2 * pi * self.effective_radius * self.surface.work_of_adhesion
        modulus = self.softened_modulus * self.body.hardening(self.open_radius)
        return 1e-2 * modulus * self.open_radius * self.reach

    def _tabor(self, modulus: float) -> float:
        if not self.adhesive:
            return 0.0
        if modulus == 0:
            return inf
        W, z0 = self.surface.work_of_adhesion, self.surface.range
        return (self.effective_radius * W**2 / (modulus**2 * z0**3)) ** (1 / 3)

    @cached_property
    def tabor_instantaneous(self) -> float:
        """Tabor number μ = (R W²/(E² z0³))^(1/3) with the short-term reduced modulus."""
        return self._tabor(self._modulus_instantaneous)

    @property
    def tabor_relaxed(self) -> float:
        """Tabor number μ = (R W²/(E² z0³))^(1/3) with the long-term reduced modulus.

        Below about 0.1 adhesion acts outside a Hertz contact (DMT), above about 5 inside it (JKR).
        """
        return self._tabor(self._modulus_relaxed)

    @cached_property
    def tabor_softened(self) -> float:
        """Tabor number with the softened modulus: the relaxed one, or of a sample that flows."""
        return self._tabor(self.softened_modulus)

    def tabor_after(self, duration: float) -> float:
        """Tabor number with the reduced modulus that creep leaves of the sample in a time, s.

        Of a sample that flows no less than its modulus when flow sets in.
        """
        return self._tabor(self._modulus_after(duration))

    def _modulus_after(self, duration: float) -> float:
        return max(1 / float(self.body.compliance.at(duration)), self.softened_modulus)

    def regularised(self, tabor: float) -> "Contact":
        """Return the contact with a law of longer range, at the same work of adhesion.

        All lengths of the law grow until the Tabor number of the softened sample is ``tabor``.
        Where it is that or below already, the contact is returned as it is. ``softafm docs soft``
        tells what changes and what does not.

        Raises
        ------
        ValueError
            If the number is not from 0.1 to 1000, there is no adhesion, or the law has no longer
            range.
        """
        tabor = check_tabor("tabor", tabor)
        if not self.adhesive:
            raise ValueError(
                f"surface law '{self.surface.kind}': has no adhesion, so no Tabor number that a "
                "longer range could lower; do not regularise it"
            )
        if self.tabor_softened <= tabor:
            return self
        factor, contact = 1.0, self
        for _ in range(_MOST_STRETCHES):
            # The number falls as factor^(-2/3) for a cone to factor^(-4/3) for a flat punch.
            factor *= (contact.tabor_softened / tabor) ** 0.75
            if factor * self.surface.range > LONGEST:
                raise ValueError(
                    f"surface law '{self.surface.kind}': its range would have to be "
                    f"{factor * self.surface.range:.3g} m for a Tabor number of {tabor:g}, and "
                    f"surface forces reach at most {LONGEST:g} m; take a larger number"
                )
            contact = replace(self, surface=self.surface.stretched(factor))
            if abs(contact.tabor_softened / tabor - 1) < _SAME:
                break
        return contact

    def _cohesive_length(self, modulus: float) -> float:
        if not self.adhesive:
            return inf
        return modulus * self.surface.range**2 / self.surface.work_of_adhesion

    @property
    def cohesive_length(self) -> float:
        """Width ℓ = E z0²/W of the tension zone at the relaxed contact edge, m."""
        return self._cohesive_length(self._modulus_relaxed)

    @property
    def cohesive_length_instantaneous(self) -> float:
        """Width ℓ = E z0²/W of the tension zone at the short-term modulus, m."""
        return self._cohesive_length(self._modulus_instantaneous)

    def rigid_force(self, tip_height: ArrayLike) -> np.ndarray:
        """Force at tip heights (m) above a flat surface that does not deform, N.

        2π ∫ p(h0 + g) r dr; of a paraboloid 2πRΦ(h0) (Derjaguin 1934).
        """
        height = np.asarray(tip_height, float)[..., None]
        r, weight = self._radial_rule
        return 2 * pi * self.surface.pressure(height + self.tip.profile(r)) @ weight

    @cached_property
    def _radial_rule(self) -> tuple[np.ndarray, np.ndarray]:
        """Radii and weights of ∫ f r dr over all that the surface forces reach."""
        points, weights = np.polynomial.legendre.leggauss(10)
        start = self.tip.radius_at(0.01 * self.reach)
        edges = start * np.concatenate([[0], np.geomspace(1, 1e5, 101)])
        edges = np.union1d(edges, self.tip.joints)
        middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
        r = middle[:, None] + half[:, None] * points
        return r.ravel(), (half[:, None] * weights * r).ravel()

    @property
    def steepest_attraction(self) -> float:
        """Largest slope of the attraction on a surface that does not deform, N/m.

        A lever softer than this snaps in. 0 of a law that only repels.
        """
        if not self.surface.attracts:
            return 0.0
        r, weight = self._radial_rule
        height = self.edge_gap * np.geomspace(0.5, 20, 400)[:, None]
        slopes = 2 * pi * self.surface.slope(height + self.tip.profile(r)) @ weight
        return max(0.0, float(slopes.max()))

    def contact_radius(self, tip_height: float) -> float:
        """Radius of the relaxed contact expected at a tip height (m, negative = indented), m.

        The stable branch of JKR (Johnson, Kendall and Roberts 1971), by the ``depth`` of the body;
        zero where no contact exists. A sample that flows counts with its softened modulus.
        """
        return self._find_contact_radius(tip_height, self.softened_modulus)

    def contact_radius_instantaneous(self, tip_height: float) -> float:
        """Radius of the contact at a tip height (m) before the sample has crept, m.

        As ``contact_radius``, with the short-term modulus: the smaller of the two.
        """
        if self.contact_radius(tip_height) == 0:
            return 0.0  # a stiffer sample reaches no farther for the tip
        return self._find_contact_radius(tip_height, self._modulus_instantaneous)

    def contact_radius_after(self, tip_height: float, duration: float) -> float:
        """Radius of the contact at a tip height (m) where the sample has crept for a time, s, m.

        As ``contact_radius``, with the modulus of ``tabor_after``.
        """
        return self._find_contact_radius(tip_height, self._modulus_after(duration))

    def _find_contact_radius(self, tip_height: float, modulus: float) -> float:
        depth = -tip_height
        if depth < self._bound_depth(modulus):
            return 0.0
        low, shallowest = self._last_contact(modulus)
        if depth < shallowest:
            return 0.0
        high = 2 * low
        for _ in range(_MOST_DOUBLINGS):
            if not self._depth(np.array([high]), modulus)[0] < depth:
                break
            low, high = high, 2 * high
        else:
            raise ValueError(
                f"contact: no contact of the body '{self.body.kind}' is {depth:g} m deep; its "
                "depth must rise with the radius of the contact"
            )
        for _ in range(_ZOOMS):
            radius = np.linspace(low, high, _POINTS)
            above = np.flatnonzero(self._depth(radius, modulus) >= depth)[:1]
            last = above[0] if above.size else _POINTS - 1
            low, high = radius[max(last - 1, 0)], radius[last]
        return float(high)

    @cached_property
    def _rough_radii(self) -> np.ndarray:
        return self.tip.radius_at(self.reach) * np.geomspace(1e-6, 1e6, 6 * _POINTS)

    @cached_property
    def _depth_bounds(self) -> dict[float, float]:
        return {}

    def _bound_depth(self, modulus: float) -> float:
        """Depth of the tip, m, below which there is no contact at a modulus; found quickly."""
        if modulus not in self._depth_bounds:
            least = float(self._depth(self._rough_radii, modulus).min())
            self._depth_bounds[modulus] = least - _ROUGH * abs(least)
        return self._depth_bounds[modulus]

    @cached_property
    def _last_contacts(self) -> dict[float, tuple[float, float]]:
        return {}

    def _last_contact(self, modulus: float) -> tuple[float, float]:
        """Radius of the smallest stable contact at a modulus, and the depth of the tip there, m."""
        if modulus not in self._last_contacts:
            radius = self._rough_radii
            for _ in range(_ZOOMS // 2 + 1):  # a least depth has twice the digits of its radius
                depth = self._depth(radius, modulus)
                least = np.clip(depth.argmin(), 1, radius.size - 2)
                radius = np.linspace(radius[least - 1], radius[least + 1], _POINTS)
            depth = self._depth(radius, modulus)
            last = float(radius[depth.argmin()]), float(depth.min())
            self._last_contacts[modulus] = last
        return self._last_contacts[modulus]

    def _depth(self, radius: np.ndarray, modulus: float) -> np.ndarray:
        """Depth of the tip, m, in contacts of some radii, m, shape (n,), at a modulus, Pa."""
        work = self.surface.work_of_adhesion if self.adhesive else 0.0
        return self.body.depth(self.tip, radius, modulus, work)
