"""Exponential attraction with a steeper exponential repulsion."""

from dataclasses import dataclass, field, replace
from math import log
from typing import ClassVar

from softafm.checks.validate import check_positive
from softafm.compiled.formulas import Term
from softafm.surfaces.law import SurfaceLaw
from softafm.surfaces.limits import check_length
from softafm.surfaces.repulsion import exponential


@dataclass(frozen=True)
class Exponential(SurfaceLaw):
    """Exponential attraction and core, p(h) = σ·(exp(−(h−z0)/core) − exp(−(h−z0)/decay)).

    Parameters
    ----------
    work_of_adhesion
        Work of adhesion W = σ·(decay − core), J/m².
    z0
        Equilibrium gap, where the pressure vanishes, m.
    decay
        Length over which the attraction falls e-fold, m.
    core
        Length over which the repulsion does, m; shorter than ``decay``.

    Raises
    ------
    ValueError
        If a value is out of range or the core is not the shorter length.
    """

    kind: ClassVar[str] = "exponential"
    overlaps: ClassVar[bool] = True
    work_of_adhesion: float = field()  # without a default, whatever the base class has
    z0: float
    decay: float
    core: float

    def __post_init__(self) -> None:
        W = check_positive("work_of_adhesion", self.work_of_adhesion, "J/m²")
        object.__setattr__(self, "work_of_adhesion", W)
        object.__setattr__(self, "z0", check_length("z0", self.z0))
        object.__setattr__(self, "decay", check_length("decay", self.decay))
        object.__setattr__(self, "core", check_length("core", self.core))
        if not self.core <= 0.99 * self.decay:
            raise ValueError(
                f"core = {self.core:g} m: must be shorter than decay = {self.decay:g} m, at most "
                "0.99 of it"
            )

    @property
    def equilibrium_gap(self) -> float:
        """Gap of zero pressure, z0, m."""
        return self.z0

    @property
    def gap_of_largest_tension(self) -> float:
        """Gap where the attraction is strongest, z0 + ln(decay/core)/(1/core − 1/decay), m."""
        return self.z0 + log(self.decay / self.core) / (1 / self.core - 1 / self.decay)

    def stretched(self, factor: float) -> "Exponential":
        """Return the law with all its lengths times ``factor``, of the same work of adhesion."""
        factor = check_positive("factor", factor, "")
        return replace(
            self, z0=factor * self.z0, decay=factor * self.decay, core=factor * self.core
        )

    @property
    def terms(self) -> tuple[Term, Term]:
        """The core and the attraction."""
        strength = self.work_of_adhesion / (self.decay - self.core)
        return (
            Term(exponential, (strength, self.z0, self.core)),
            Term(exponential, (-strength, self.z0, self.decay)),
        )
