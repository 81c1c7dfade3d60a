"""Angles of tips: in radians, refused with a word on degrees."""

from math import degrees, pi

from softafm.checks.validate import check_finite


def check_half_angle(value: float) -> float:
    """Return the half angle of a cone, rad, if it lies between 0 and π/2."""
    angle = check_finite("half_angle", value, "rad")
    if not 0 < angle < pi / 2:
        raise ValueError(
            f"half_angle = {angle:g} rad: must be above 0 and below pi/2 rad, that is 90 degrees "
            f"({angle:g} rad are {degrees(angle):.4g} degrees; math.radians converts)"
        )
    return angle
