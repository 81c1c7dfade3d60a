"""Rigid axisymmetric tips."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from softafm._validate import positive


@dataclass(frozen=True)
class Paraboloid:
    """Paraboloid of revolution, g(r) = r²/2R: a sphere near its apex.

    Parameters
    ----------
    radius
        Radius of curvature R at the apex, m.

    Raises
    ------
    ValueError
        If the radius is not a finite number above zero.

    Notes
    -----
    Stands for a sphere while the contact radius is well below R (g is 3 % low at r = R/3).
    """

    kind: ClassVar[str] = "paraboloid"
    radius: float

    def __post_init__(self):
        object.__setattr__(self, "radius", positive("radius", self.radius, "m"))

    def profile(self, r):
        """Height of the tip surface above its apex at radial coordinate ``r``, m."""
        return np.square(r) / (2 * self.radius)

    @property
    def compiled_profile(self):
        """The profile as a compiled function and its parameters (see ``softafm.compiled``)."""
        from softafm.kernels import paraboloid

        return paraboloid, np.array([self.radius])
