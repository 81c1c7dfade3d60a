"""Van der Waals attraction between half-spaces, with a repulsion of any power."""

from dataclasses import dataclass, replace
from math import pi
from typing import ClassVar

import numpy as np

from softafm.checks.validate import check_finite, check_positive
from softafm.compiled.formulas import Term
from softafm.surfaces.law import SurfaceLaw
from softafm.surfaces.limits import check_length


@dataclass(frozen=True)
class VanDerWaals(SurfaceLaw):
    """Van der Waals attraction and a power-law repulsion, p(h) = H/(6πh³)·((z0/h)^(n−3) − 1).

    With n = 9 it is ``LennardJones``; a larger power makes the contact harder.

    Parameters
    ----------
    hamaker
        Hamaker constant H, J.
    z0
        Equilibrium gap, where the pressure vanishes, m.
    exponent
        Power n of the repulsive pressure, above 3 and at most 100.

    Raises
    ------
    ValueError
        If a value is out of range.

    References
    ----------
    J. N. Israelachvili, Intermolecular and Surface Forces, 3rd ed., Academic Press 2011, ch. 13.
    """

    kind: ClassVar[str] = "van-der-waals"
    hamaker: float
    z0: float
    exponent: float = 9.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "hamaker", check_positive("hamaker", self.hamaker, "J"))
        object.__setattr__(self, "z0", check_length("z0", self.z0))
        object.__setattr__(self, "exponent", _check_exponent(self.exponent))

    @classmethod
    def from_repulsion(cls, hamaker: float, strength: float, exponent: float) -> "VanDerWaals":
        """Build the law from H, J, and a repulsion of its own, strength/hⁿ, strength in Pa mⁿ."""
        H, n = check_positive("hamaker", hamaker, "J"), _check_exponent(exponent)
        B = check_positive("strength", strength, "Pa m^n")
        try:
            return cls(H, (6 * pi * B / H) ** (1 / (n - 3)), n)
        except (ValueError, OverflowError) as error:
            raise ValueError(f"strength = {B:g} Pa m^n: its equilibrium gap: {error}") from None

    @classmethod
    def from_work_of_adhesion(cls, W: float, z0: float, exponent: float = 9.0) -> "VanDerWaals":
        """Build the law from its work of adhesion, W = H/(12πz0²)·(n−3)/(n−1).

        Parameters
        ----------
        W
            Work per area to part the surfaces, J/m².
        """
        W, z0, n = check_positive("W", W, "J/m²"), check_length("z0", z0), _check_exponent(exponent)
        return cls(12 * pi * z0**2 * W * (n - 1) / (n - 3), z0, n)

    @property
    def work_of_adhesion(self) -> float:
        """H/(12πz0²)·(n−3)/(n−1), J/m²."""
        n = self.exponent
        return self.hamaker / (12 * pi * self.z0**2) * (n - 3) / (n - 1)

    @property
    def equilibrium_gap(self) -> float:
        """Gap of zero pressure, z0, m."""
        return self.z0

    @property
    def gap_of_largest_tension(self) -> float:
        """Gap where the attraction is strongest, z0·(n/3)^(1/(n−3)), m."""
        return self.z0 * (self.exponent / 3) ** (1 / (self.exponent - 3))

    def stretched(self, factor: float) -> "VanDerWaals":
        """Return the law with all its lengths times ``factor``, of the same work of adhesion."""
        factor = check_positive("factor", factor, "")
        return replace(self, hamaker=factor**2 * self.hamaker, z0=factor * self.z0)

    @property
    def terms(self) -> tuple[Term]:
        """p(h) = H/(6πh³)·((z0/h)^(n−3) − 1), Φ(h) = H/(12πh²)·(2/(n−1)·(z0/h)^(n−3) − 1)."""
        return (Term(_van_der_waals, (self.hamaker, self.z0, self.exponent)),)


def _van_der_waals(
    h: np.ndarray, H: float, z0: float, n: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    inverse = 1 / h
    attraction = H / (6 * pi) * inverse * inverse * inverse
    repulsion = attraction * (z0 * inverse) ** (n - 3)
    slope = (3 * attraction - n * repulsion) * inverse
    return repulsion - attraction, slope, h * (repulsion / (n - 1) - 0.5 * attraction)


def _check_exponent(value: float) -> float:
    number = check_finite("exponent", value, "")
    if not 3 < number <= 100:
        raise ValueError(
            f"exponent = {number:g}: must be above 3, that of the attraction, and at most 100"
        )
    return number
