"""A surface law given by numbers: measured, simulated, or sampled from a function."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import log
from typing import ClassVar

import numpy as np

from softafm.checks.validate import check_numbers, check_whole
from softafm.compiled.formulas import Term
from softafm.surfaces.law import SurfaceLaw
from softafm.surfaces.limits import check_length

_LEAST = 4
_SLOWEST = 1.5
"""Least power with which the tail falls; one that falls as 1/h or slower has no potential."""


@dataclass(frozen=True)
class Tabulated(SurfaceLaw):
    """Pressure through given points: monotone cubics, which have no bumps between the points.

    Inside the first point the repulsion goes on exponentially; beyond the last, pressure falls as
    the power of the gap that the last two points have, or is 0 if the last is. The slope is
    continuous throughout and the potential is the exact integral.

    Parameters
    ----------
    gaps
        Gaps, m, strictly rising; at least four.
    pressures
        Pressures at these gaps, Pa, positive = repulsive. The first must be repulsive and above the
        second, the last weaker than the one before.

    Raises
    ------
    ValueError
        If the lists differ in length or are too short, an entry is no number or out of order, or
        the law cannot go on at either end.

    References
    ----------
    F. N. Fritsch and J. Butland, *SIAM J. Sci. Stat. Comput.* 5, 300 (1984): monotone cubics.
    """

    kind: ClassVar[str] = "tabulated"
    overlaps: ClassVar[bool] = True
    gaps: tuple[float, ...]
    pressures: tuple[float, ...]

    def __post_init__(self) -> None:
        gaps, pressures = (
            check_numbers("gaps", self.gaps, "m"),
            check_numbers("pressures", self.pressures, "Pa"),
        )
        _refuse_what_is_no_law(gaps, pressures)
        object.__setattr__(self, "gaps", gaps)
        object.__setattr__(self, "pressures", pressures)

    @classmethod
    def from_function(
        cls,
        pressure: Callable[[float], float],
        shortest: float,
        longest: float,
        points: int = 400,
    ) -> "Tabulated":
        """Sample a Python function of the gap (m) at gaps spaced evenly in their logarithm."""
        shortest, longest = check_length("shortest", shortest), check_length("longest", longest)
        if not shortest < longest:
            raise ValueError(
                f"longest = {longest:g} m: must be above the shortest gap, {shortest:g} m"
            )
        gaps = np.geomspace(
            shortest, longest, check_whole("points", points, _LEAST, 10_000)
        ).tolist()
        return cls(tuple(gaps), tuple(pressure(gap) for gap in gaps))

    @cached_property
    def terms(self) -> tuple[Term]:
        """The table: (λ, n), gaps, p, p', quadratic and cubic coefficients, Φ."""
        from scipy.interpolate import PchipInterpolator

        h, p = np.array(self.gaps), np.array(self.pressures)
        width, rise = np.diff(h), np.diff(p) / np.diff(h)
        rate = PchipInterpolator(h, p).derivative()(h)
        rate[0] = rate[0] if rate[0] < 0 else rise[0]
        power = _find_power(self.gaps, self.pressures) if p[-1] else 2.0
        rate[-1] = -power * p[-1] / h[-1]
        square = np.append((3 * rise - 2 * rate[:-1] - rate[1:]) / width, 0.0)
        cube = np.append((rate[:-1] + rate[1:] - 2 * rise) / width**2, 0.0)
        done = width * (p[:-1] + width * (rate[:-1] / 2 + width * (square / 3)[:-1]))
        done += width**4 * cube[:-1] / 4
        beyond = np.append(np.cumsum(done[::-1])[::-1], 0.0)
        potential = p[-1] * h[-1] / (power - 1) + beyond
        table = np.concatenate([[-p[0] / rate[0], power], h, p, rate, square, cube, potential])
        return (Term(_tabulated, tuple(table.tolist()), as_array=True),)


def _tabulated(h: np.ndarray, table: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    n = (table.size - 2) // 6
    first, last = table[2], table[n + 1]
    near = np.minimum(np.maximum(h, first), last)
    i = np.searchsorted(table[2 : n + 1], near, "right") + 1
    x = near - table[i]
    p, rate, square, cube = table[i + n], table[i + 2 * n], table[i + 3 * n], table[i + 4 * n]
    done = x * (p + x * (rate / 2 + x * (square / 3 + x * cube / 4)))
    p = p + x * (rate + x * (square + x * cube))
    rate = rate + x * (2 * square + 3 * x * cube)
    # Inside the first point depth > 0 and stretch = 1, beyond the last stretch > 1 and depth = 0.
    depth = (near - np.minimum(h, near)) / table[0]
    stretch = np.maximum(h, near) / near
    core, tail = np.exp(depth), np.exp(-table[1] * np.log(stretch))
    slope = rate * core * tail / stretch
    potential = (table[i + 5 * n] - done) * tail * stretch + p * table[0] * (core - 1)
    return p * core * tail, slope, potential


def _find_power(gaps: Sequence[float], pressures: Sequence[float]) -> float:
    power = log(pressures[-2] / pressures[-1]) / log(gaps[-1] / gaps[-2])
    return max(power, _SLOWEST)


def _refuse_what_is_no_law(gaps: tuple[float, ...], pressures: tuple[float, ...]) -> None:
    if len(gaps) < _LEAST:
        raise ValueError(f"gaps has {len(gaps)} entries: must have at least {_LEAST}")
    if len(pressures) != len(gaps):
        raise ValueError(
            f"pressures has {len(pressures)} entries: must have as many as gaps, {len(gaps)}"
        )
    if gaps[0] <= 0:
        raise ValueError(f"gaps[0] = {gaps[0]:g} m: must be greater than 0")
    for i in range(1, len(gaps)):
        if gaps[i] <= gaps[i - 1]:
            raise ValueError(
                f"gaps[{i}] = {gaps[i]:g} m: must be above gaps[{i - 1}] = {gaps[i - 1]:g} m"
            )
    if pressures[0] <= 0:
        raise ValueError(
            f"pressures[0] = {pressures[0]:g} Pa at {gaps[0]:g} m: must repel, above 0; begin the "
            "table at a shorter gap"
        )
    if pressures[1] >= pressures[0]:
        raise ValueError(
            f"pressures[1] = {pressures[1]:g} Pa: must be below pressures[0] = {pressures[0]:g} "
            "Pa, as repulsion rises when the gap closes"
        )
    end, before = pressures[-1], pressures[-2]
    if end and (end * before <= 0 or abs(end) >= abs(before) * gaps[-2] / gaps[-1]):
        raise ValueError(
            f"pressures[{len(gaps) - 1}] = {end:g} Pa after {before:g} Pa: must fade faster than "
            "1/gap at the end; extend the table, average out noise, or end it with 0"
        )
