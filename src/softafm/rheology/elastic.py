"""A sample without memory."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from softafm.checks.validate import check_poisson_ratio, check_positive
from softafm.rheology.compliance import CreepCompliance
from softafm.rheology.solid import Solid


@dataclass(frozen=True)
class Elastic(Solid):
    """Elastic half-space.

    Parameters
    ----------
    E
        Young's modulus, Pa.
    poisson
        Poisson's ratio, in (-1, 0.5].

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    kind: ClassVar[str] = "elastic"
    E: float
    poisson: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "E", check_positive("E", self.E, "Pa"))
        object.__setattr__(self, "poisson", check_poisson_ratio(self.poisson))

    @property
    def compliance(self) -> CreepCompliance:
        """1/E, without elements."""
        return CreepCompliance(1 / self.E, np.zeros(0), np.zeros(0))
