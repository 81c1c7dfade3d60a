"""What all tips are asked for, and how it follows from their profile."""

from abc import ABC, abstractmethod
from math import inf
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.validate import check_finite
from softafm.compiled.formulas import Term

_FIRST_RADIUS = 1e-12
_MOST_DOUBLINGS = 200
_ZOOMS, _POINTS = 9, 65
_STEP = 3e-4
_DIFFERENCES = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))
"""Central differences of sixth order: multiple of the step and its weight."""


class Tip(ABC):
    """A rigid tip of revolution, given by the height g(r) of its surface above its apex.

    A tip is a frozen dataclass with a name, ``kind``, and a formula, ``f(radius, a, b, ...) ->
    height``, as its ``term``. The profile starts at g(0) = 0 and never falls, has no corner at the
    apex and is defined for all radii.
    """

    kind: ClassVar[str]

    @property
    @abstractmethod
    def term(self) -> Term:
        """The formula of the profile, with its parameters."""

    @property
    def joints(self) -> tuple[float, ...]:
        """Radii, rising, at which the curvature of the profile jumps, m."""
        return ()

    def profile(self, r: ArrayLike) -> np.ndarray:
        """Height of the tip surface above its apex at radial coordinate ``r``, m."""
        return self.term(np.asarray(r, float))

    def slope(self, r: ArrayLike) -> np.ndarray:
        """dg/dr at radial coordinate ``r``, from differences that do not reach across joints.

        Its relative error is about 1e-12 between joints, and 1e-8 on one.
        """
        r = np.asarray(r, float)
        joints = np.array([0.0, *self.joints, inf])
        above = np.clip(np.searchsorted(joints, r), 1, joints.size - 1)
        room = np.minimum(r - joints[above - 1], joints[above] - r)
        step = np.clip(room / 3.5, 1e-9 * r, _STEP * r)
        rise = sum(
            weight * (self.profile(r + k * step) - self.profile(r - k * step))
            for k, weight in _DIFFERENCES
        )
        return rise / np.where(step > 0, step, 1.0)

    def radius_at(self, height: float) -> float:
        """Largest radius at which the profile is not above ``height`` (m), m.

        Raises
        ------
        ValueError
            If the height is negative or not finite, or the profile never gets above it.
        """
        height = check_height(height)
        low, high = 0.0, max(height, _FIRST_RADIUS)
        for _ in range(_MOST_DOUBLINGS):
            if self.profile(high) > height:
                break
            low, high = high, 2 * high
        else:
            raise ValueError(f"height = {height:g} m: the tip does not reach it at any radius")
        for _ in range(_ZOOMS):
            radius = np.linspace(low, high, _POINTS)
            above = int(np.argmax(self.profile(radius) > height))
            low, high = radius[above - 1], radius[above]
        return float(low)

    @property
    def compiled_profile(self) -> tuple[Any, np.ndarray]:
        """The profile compiled for solvers, and its parameters (see ``softafm.compiled``)."""
        from softafm.compiled.functions import compile_profile

        return compile_profile(self.term.shape), np.array(self.term.packed, float)


def check_height(value: float) -> float:
    """Return a height above the apex (m) if it is a finite number that is not negative."""
    height = check_finite("height", value, "m")
    if height < 0:
        raise ValueError(f"height = {height:g} m: must not be below the apex, at 0 m")
    return height
