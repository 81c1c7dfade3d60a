"""A tip whose radial profile was measured."""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from softafm.checks.validate import check_numbers
from softafm.compiled.formulas import Term
from softafm.tips.tip import Tip

_LEAST = 4


@dataclass(frozen=True)
class MeasuredTip(Tip):
    """Radial profile through measured points: monotone cubics in r², straight beyond the last.

    A function of r² is even: the profile has no corner at the apex, and a paraboloid is met exactly
    however few its points.

    Parameters
    ----------
    r
        Radial coordinates, m, strictly rising from 0; at least four.
    height
        Heights of the tip surface there, m, never falling; counted from that of the apex.

    Raises
    ------
    ValueError
        If the lists differ in length or are too short, hold what is no finite number, or are no
        profile: the entry that is wrong is named with its value.

    References
    ----------
    F. N. Fritsch and J. Butland, *SIAM J. Sci. Stat. Comput.* 5, 300 (1984): monotone cubics.
    """

    kind: ClassVar[str] = "measured"
    r: tuple[float, ...]
    height: tuple[float, ...]

    def __post_init__(self) -> None:
        r, height = check_numbers("r", self.r, "m"), check_numbers("height", self.height, "m")
        _refuse_what_is_no_profile(r, height)
        object.__setattr__(self, "r", r)
        object.__setattr__(self, "height", height)

    @cached_property
    def term(self) -> Term:
        """Monotone cubics in r² (PCHIP), with the last slope beyond the last point."""
        from scipy.interpolate import PchipInterpolator

        square, height = np.square(self.r), np.array(self.height) - self.height[0]
        rate = PchipInterpolator(square, height).derivative()(square)
        if rate[-1] <= 0:
            rate[-1] = (height[-1] - height[-2]) / (square[-1] - square[-2])
        return Term(_height, (*square.tolist(), *height.tolist(), *rate.tolist()), as_array=True)

    @property
    def joints(self) -> tuple[float, ...]:
        """The radii of the points, m."""
        return self.r[1:]


def _height(r: np.ndarray, table: np.ndarray) -> np.ndarray:
    n = table.size // 3
    last = np.sqrt(table[n - 1])
    square = np.minimum(r * r, table[n - 1])
    i = np.minimum(np.searchsorted(table[:n], square, "right") - 1, n - 2)
    width, rise = table[i + 1] - table[i], table[n + i + 1] - table[n + i]
    start, end = width * table[2 * n + i], width * table[2 * n + i + 1]
    t = (square - table[i]) / width
    cubic = t * (start + t * (3 * rise - 2 * start - end + t * (start + end - 2 * rise)))
    return table[n + i] + cubic + 2 * last * table[3 * n - 1] * (r - np.minimum(r, last))


def _refuse_what_is_no_profile(r: tuple[float, ...], height: tuple[float, ...]) -> None:
    if len(r) < _LEAST:
        raise ValueError(f"r has {len(r)} entries: must have at least {_LEAST}")
    if len(height) != len(r):
        raise ValueError(f"height has {len(height)} entries: must have as many as r, {len(r)}")
    if r[0] != 0:
        raise ValueError(f"r[0] = {r[0]:g} m: must be 0, the axis of the tip")
    for i in range(1, len(r)):
        if r[i] <= r[i - 1]:
            raise ValueError(f"r[{i}] = {r[i]:g} m: must be above r[{i - 1}] = {r[i - 1]:g} m")
        if height[i] < height[i - 1]:
            raise ValueError(
                f"height[{i}] = {height[i]:g} m at r = {r[i]:g} m: must not be below "
                f"height[{i - 1}] = {height[i - 1]:g} m at r = {r[i - 1]:g} m (a tip may not turn "
                "back towards the sample; average out noise)"
            )
    if height[-1] == height[0]:
        raise ValueError(f"height = {height[0]:g} m at all r: must rise with r")
    if height[-1] == height[-2]:
        raise ValueError(
            f"height[{len(r) - 1}] = {height[-1]:g} m: must be above the height before it, as the"
            " tip continues with its last slope"
        )
