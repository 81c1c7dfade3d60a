"""What all surface laws are asked for, and how it follows from their formulas."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, reduce
from math import inf, sqrt
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from softafm.compiled.formulas import Term
from softafm.surfaces.check import check_repulsion

_GAPS = np.geomspace(1e-12, 1e-6, 6001)
_OUTWARDS = np.geomspace(1e-3, 1e2, 4001)
"""Distances beyond the largest tension at which its slope is searched for, in ranges."""
_STEEPEST = 1.220535
"""max p' over max(−p)/z0 of a Lennard-Jones law beyond its largest tension."""


class SurfaceLaw(ABC):
    """A pressure p(h) between two surfaces, positive = repulsive, that depends on their gap only.

    A law is a frozen dataclass with a name, ``kind``, that lists its ``terms``: each a formula

        f(gap, a, b, ...) -> (pressure, slope, potential)

    in Pa, Pa/m and J/m², with slope = dp/dh, pressure = −dΦ/dh and Φ(∞) = 0. What follows from it
    is found numerically here; a law that knows it in closed form may say so.
    """

    kind: ClassVar[str]
    overlaps: ClassVar[bool] = False
    """Whether the law goes on, finite and smooth, at gaps of zero and below: its core is soft."""

    def __add__(self, other: "SurfaceLaw") -> "SurfaceLaw":
        """Return the law whose pressure is the sum of both."""
        return SumOfLaws((self, other)) if isinstance(other, SurfaceLaw) else NotImplemented

    @property
    @abstractmethod
    def terms(self) -> tuple[Term, ...]:
        """The formulas whose sum the law is, with their parameters."""

    def pressure(self, gap: ArrayLike) -> np.ndarray:
        """Pressure at ``gap`` (m), positive = repulsive, Pa."""
        return self._evaluate(gap)[0]

    def slope(self, gap: ArrayLike) -> np.ndarray:
        """dp/dh at ``gap`` (m), Pa/m."""
        return self._evaluate(gap)[1]

    def potential(self, gap: ArrayLike) -> np.ndarray:
        """Interaction energy per area Φ at ``gap`` (m), J/m²; Φ' = −p."""
        return self._evaluate(gap)[2]

    def _evaluate(self, gap: ArrayLike) -> tuple[np.ndarray, ...]:
        h = np.asarray(gap, float)
        with np.errstate(over="ignore", under="ignore"):
            results = [term(h) for term in self.terms]
            return tuple(sum(parts) for parts in zip(*results, strict=True))

    @property
    def closest_gap(self) -> float:
        """Gap above which the law may be asked, m: 0, or −∞ of a law that goes on below."""
        return -inf if self.overlaps else 0.0

    @cached_property
    def attracts(self) -> bool:
        """Whether there is a gap at which the surfaces attract each other."""
        return bool(self._scanned.min() < 0)

    @property
    def equilibrium_gap(self) -> float:
        """Gap of zero pressure, m: where the attraction at its largest, followed inwards, ends."""
        return self._equilibrium

    @property
    def gap_of_largest_tension(self) -> float:
        """Gap where the attraction is strongest, m."""
        return self._tension_gap

    @cached_property
    def largest_tension(self) -> float:
        """Largest attraction −p, Pa; 0 of a law that only repels."""
        return -float(self.pressure(self.gap_of_largest_tension)) if self.attracts else 0.0

    @cached_property
    def work_of_adhesion(self) -> float:
        """Work per area to part the surfaces from the equilibrium gap, J/m².

        0 of a law that only repels; negative where an outer barrier outweighs the well.
        """
        return -float(self.potential(self.equilibrium_gap)) if self.attracts else 0.0

    @property
    def range(self) -> float:
        """Distance over which the attraction acts: 16/(9√3)·W/max(−p), m.

        It is z0 of the Lennard-Jones law of the same work of adhesion and largest tension, on which
        the transition from stiff to soft contacts depends (Maugis 1992).

        Raises
        ------
        ValueError
            If there is no attractive well, or it takes no work to leave it.
        """
        tension = -float(self.pressure(self.gap_of_largest_tension))
        if not self.work_of_adhesion > 0:
            raise ValueError(
                f"surface law '{self.kind}': its work of adhesion is {self.work_of_adhesion:.3g} "
                "J/m², as a barrier outweighs the well; a range needs one above 0"
            )
        return 16 / (9 * sqrt(3)) * self.work_of_adhesion / tension

    @cached_property
    def width_of_well(self) -> float:
        """Distance over which the tension of the well acts, m, whatever barrier lies outside.

        As ``range``, with the work from the equilibrium gap to where the attraction ends: the same
        where no barrier does.
        """
        outside = np.flatnonzero((self.gap_of_largest_tension < _GAPS) & (self._scanned > 0))
        work = -float(self.potential(self.equilibrium_gap))
        if outside.size:
            end = _find_root(self.pressure, _GAPS[outside[0] - 1], _GAPS[outside[0]])
            work += float(self.potential(end))
        return 16 / (9 * sqrt(3)) * work / self.largest_tension

    @cached_property
    def sharpness(self) -> float:
        """How steeply the tension ends, in units of a Lennard-Jones law of the same range."""
        beyond = self.gap_of_largest_tension + self.range * _OUTWARDS
        return float(self.slope(beyond).max()) * self.range / self.largest_tension / _STEEPEST

    def stretched(self, factor: float) -> "SurfaceLaw":
        """Return the law with all its lengths times ``factor``, of the same work of adhesion.

        Its pressure is p(h/factor)/factor.

        Raises
        ------
        ValueError
            If the factor is not above 0 or the law has lengths of its own that must not change.
        """
        raise ValueError(
            f"surface law '{self.kind}': cannot be stretched, as its lengths have meanings of "
            "their own; use a law such as 'lennard-jones' of the same work of adhesion"
        )

    @property
    def compiled_pressure(self) -> tuple[Any, Any, np.ndarray]:
        """p and Φ compiled for solvers, and their parameters (see ``softafm.compiled``)."""
        from softafm.compiled.functions import compile_pressure

        pressure, potential = compile_pressure(tuple(term.shape for term in self.terms))
        values = [value for term in self.terms for value in term.packed]
        return pressure, potential, np.array([0.0, *values])

    @cached_property
    def _scanned(self) -> np.ndarray:
        pressure = self.pressure(_GAPS)
        check_repulsion(self.kind, _GAPS[0], pressure[0])
        return pressure

    @cached_property
    def _tension_gap(self) -> float:
        pressure = self._scanned
        strongest = int(pressure.argmin())
        if not pressure[strongest] < 0:
            raise ValueError(
                f"surface law '{self.kind}': has no attractive well, so no equilibrium gap, gap of "
                "largest tension or range; adhesion needs a law that attracts at some gap"
            )
        if strongest == _GAPS.size - 1:
            raise ValueError(
                f"surface law '{self.kind}': attracts ever more up to a gap of {_GAPS[-1]:g} m; "
                "its attraction must fade"
            )
        return _find_root(self.slope, _GAPS[strongest - 1], _GAPS[strongest + 1])

    @cached_property
    def _equilibrium(self) -> float:
        gap = self._tension_gap
        inside = int(np.flatnonzero((gap > _GAPS) & (self._scanned >= 0))[-1])
        return _find_root(self.pressure, _GAPS[inside], min(gap, _GAPS[inside + 1]))


@dataclass(frozen=True)
class SumOfLaws(SurfaceLaw):
    """The sum of the pressures of several laws, also written ``one + another``.

    Parameters
    ----------
    parts
        The laws; sums among them are taken apart. A part alone may be purely attractive, their sum
        has to repel when the surfaces come close.

    Raises
    ------
    ValueError
        If a part is no surface law or there is none.
    """

    kind: ClassVar[str] = "sum"
    parts: tuple[SurfaceLaw, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", _check_laws(self.parts))

    @property
    def closest_gap(self) -> float:
        """The largest of those of the parts, m."""
        return max(part.closest_gap for part in self.parts)

    @property
    def terms(self) -> tuple[Term, ...]:
        """The terms of all parts."""
        return tuple(term for part in self.parts for term in part.terms)

    def _evaluate(self, gap: ArrayLike) -> tuple[np.ndarray, ...]:
        results = [part._evaluate(gap) for part in self.parts]
        return tuple(reduce(np.add, parts) for parts in zip(*results, strict=True))


def _check_laws(given: Any) -> tuple[SurfaceLaw, ...]:
    if isinstance(given, str | bytes | dict) or not hasattr(given, "__iter__"):
        raise ValueError(f"parts = {given!r}: must be a list of surface laws")
    flat: list[SurfaceLaw] = []
    for index, part in enumerate(given):
        if not isinstance(part, SurfaceLaw):
            raise ValueError(f"parts[{index}] = {part!r}: must be a surface law")
        flat += part.parts if isinstance(part, SumOfLaws) else (part,)
    if not flat:
        raise ValueError("parts is empty: must hold at least one surface law")
    return tuple(flat)


def _find_root(function: Callable[[float], Any], low: float, high: float) -> float:
    from scipy.optimize import brentq

    return float(brentq(lambda gap: float(function(gap)), low, high, xtol=1e-16 * high, rtol=1e-14))
