"""Dugdale's constant tension over a cohesive range, with smooth edges."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from math import exp, log, log1p, sqrt
from typing import ClassVar

import numpy as np

from softafm.checks.validate import check_between, check_positive
from softafm.compiled.formulas import Term
from softafm.surfaces.law import SurfaceLaw
from softafm.surfaces.limits import check_length


@dataclass(frozen=True)
class Dugdale(SurfaceLaw):
    """Constant tension σ0 from contact at z0 out to a gap hc, as Maugis has it, but smoothed.

    p(h) = σ0·(k·exp(−(h−z0)/s) − 1/(1 + exp((h−hc)/s))), s = smoothing·W/σ0: the end at hc is
    spread over about ±2s and the hard contact is a wall of decay length s. hc is chosen so that the
    work of adhesion is exactly W, and k = 1/(1 + exp(−(hc−z0)/s)), which is 1 to within e^(−4), so
    that the equilibrium gap is exactly z0. As smoothing → 0, hc → z0 + W/σ0 and the law becomes
    Maugis's. Tension is at its largest half-way out.

    Parameters
    ----------
    work_of_adhesion
        Work of adhesion W, J/m².
    z0
        Equilibrium gap, where the pressure vanishes, m.
    tension
        Constant tension σ0, Pa.
    smoothing
        s over W/σ0, 0.02 to 0.3. The default solver keeps its tolerance from 0.07 up and warns
        below; the smaller it is the longer run contacts of high Tabor number.

    Raises
    ------
    ValueError
        If a value is out of range, or W/σ0 is no length that surface forces may have.

    References
    ----------
    D. S. Dugdale, *J. Mech. Phys. Solids* 8, 100 (1960);
    D. Maugis, *J. Colloid Interface Sci.* 150, 243 (1992).
    """

    kind: ClassVar[str] = "dugdale"
    overlaps: ClassVar[bool] = True
    work_of_adhesion: float = field()  # without a default, whatever the base class has
    z0: float
    tension: float
    smoothing: float = 0.1

    def __post_init__(self) -> None:
        W = check_positive("work_of_adhesion", self.work_of_adhesion, "J/m²")
        object.__setattr__(self, "work_of_adhesion", W)
        object.__setattr__(self, "z0", check_length("z0", self.z0))
        object.__setattr__(self, "tension", check_positive("tension", self.tension, "Pa"))
        object.__setattr__(
            self, "smoothing", check_between("smoothing", self.smoothing, "", 0.02, 0.3)
        )
        try:
            check_length("work_of_adhesion/tension", W / self.tension)
        except ValueError as error:
            raise ValueError(f"tension = {self.tension:g} Pa: {error}") from None

    @property
    def cohesive_range(self) -> float:
        """hc − z0, about W/σ0 + s: where the tension has fallen to half, counted from z0, m."""
        return self._ratio * self._width

    @property
    def equilibrium_gap(self) -> float:
        """Gap of zero pressure, z0, m."""
        return self.z0

    @property
    def gap_of_largest_tension(self) -> float:
        """Gap where the attraction is strongest, about half-way between z0 and hc, m."""
        q = exp(-self._ratio)
        return self.z0 - self._width * log(sqrt(q * (1 + q)) - q)

    def stretched(self, factor: float) -> "Dugdale":
        """Return the law with all its lengths times ``factor``, of the same work of adhesion."""
        factor = check_positive("factor", factor, "")
        return replace(self, z0=factor * self.z0, tension=self.tension / factor)

    @property
    def terms(self) -> tuple[Term]:
        """p(h), with the wall and the outer edge from one exponential."""
        return (Term(_dugdale, (self.tension, self.z0, self._width, exp(-self._ratio))),)

    @property
    def _width(self) -> float:
        return self.smoothing * self.work_of_adhesion / self.tension

    @cached_property
    def _ratio(self) -> float:
        """(hc − z0)/s, from W = σ0·s·(ln(1 + e^ratio) − k); Newton's method, on a convex curve."""
        ratio = 1 / self.smoothing + 1
        for _ in range(8):
            k = 1 / (1 + exp(-ratio))
            ratio -= (ratio + log1p(exp(-ratio)) - k - 1 / self.smoothing) / k**2
        return ratio


def _dugdale(
    h: np.ndarray, tension: float, z0: float, width: float, q: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    near = np.exp(np.minimum((z0 - h) / width, 600.0))
    wall, inside = near / (1 + q), near / (near + q)
    slope = tension / width * (inside * (1 - inside) - wall)
    return tension * (wall - inside), slope, tension * width * (wall - np.log1p(near / q))
