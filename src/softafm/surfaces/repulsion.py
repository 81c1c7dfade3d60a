"""A repulsion that decays exponentially."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from softafm.checks.validate import check_positive
from softafm.compiled.formulas import Term
from softafm.surfaces.law import SurfaceLaw
from softafm.surfaces.limits import check_length


@dataclass(frozen=True)
class Repulsion(SurfaceLaw):
    """Repulsion without adhesion, p(h) = P0·exp(−h/λ), as of hydration, brushes or charges.

    Parameters
    ----------
    pressure_at_zero
        Pressure P0 at zero gap, Pa.
    decay
        Length λ over which it falls e-fold, m.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    kind: ClassVar[str] = "repulsion"
    overlaps: ClassVar[bool] = True
    pressure_at_zero: float
    decay: float

    def __post_init__(self) -> None:
        P0 = check_positive("pressure_at_zero", self.pressure_at_zero, "Pa")
        object.__setattr__(self, "pressure_at_zero", P0)
        object.__setattr__(self, "decay", check_length("decay", self.decay))

    @property
    def terms(self) -> tuple[Term]:
        """p(h) = P0·exp(−h/λ), Φ(h) = λp(h)."""
        return (Term(exponential, (self.pressure_at_zero, 0.0, self.decay)),)


def exponential(
    h: np.ndarray, pressure: float, origin: float, decay: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Evaluate ``pressure``·exp(−(h − origin)/decay), its slope, and its potential."""
    p = pressure * np.exp((origin - h) / decay)
    return p, -p / decay, p * decay
