"""The profile that sphere, cone and punch share: a flat, an arc and a straight flank."""

from math import cos, radians, sin, tan

import numpy as np

STEEPEST = radians(80)
"""Slope angle at which an arc gives way to its tangent: beyond it would have to turn vertical."""

JOIN, SLOPE = sin(STEEPEST), tan(STEEPEST)
"""Radius at which an arc of radius 1 is as steep, and dg/dr there."""


def arc_and_flank(r: np.ndarray, flat: float, R: float, join: float, slope: float) -> np.ndarray:
    """Height of a profile flat to ``flat``, an arc of radius R for ``join`` more, then straight.

    The arc R − √(R² − x²) is written without the difference, which would cancel at small x.
    """
    x = np.maximum(r - flat, 0.0)
    curved = np.minimum(x, join)
    arc = curved * curved / (R + np.sqrt((R - curved) * (R + curved)))
    return arc + slope * (x - curved)


def flank(half_angle: float) -> tuple[float, float]:
    """Radius at which an arc of radius 1 meets a cone of this half angle (rad), and dg/dr there."""
    return cos(half_angle), 1 / tan(half_angle)
