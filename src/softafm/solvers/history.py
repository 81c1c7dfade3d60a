"""What every solver returns: the contact's history."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from softafm.errors import AccuracyWarning
from softafm.instrument.motion import Motion
from softafm.solvers.energies import Energies, measure_energies

if TYPE_CHECKING:
    from softafm.solvers.quadrature import Quadrature

_POOR = 0.1
"""Part by which the power at both ends may miss the energy of a step that still is resolved."""


@dataclass(frozen=True)
class Profiles:
    """Surface shapes on common radii: ``radius`` (r,) m and ``deformation`` (time, r) m."""

    radius: np.ndarray
    deformation: np.ndarray


@dataclass(frozen=True)
class History:
    """One contact through one motion: what every solver returns.

    Attributes
    ----------
    time
        Instants at the ends of the accepted steps, ever later, s, shape (n,). The first is the
        first break of ``motion``, the last its last.
    tip_height
        Height h0 of the apex above the undeformed surface, m, shape (n,). On a lever, the height
        of the base is ``motion.height(time)``, and the difference the deflection.
    force
        Force on the tip, N, positive = repulsive, shape (n,).
    contact_radius
        Radius of the largest tension, m, 0 out of contact, shape (n,).
    axis_deformation
        Displacement u of the surface under the apex, m, positive towards the tip, shape (n,).
    viscous_power
        Power dissipated in the sample's dashpots, W, not negative, shape (n,).
    pieces
        Slices of the steps over which the history is smooth: they cover all steps, and neighbours
        share the step at a break of the motion, and none at an elastic jump.
    jump_time
        Instants of elastic jumps, s, shape (jump,); may be empty.
    jump_energy
        Energy that each jump released, J, shape (jump,).
    motion
        The motion as it was carried out: where a setpoint force turned it, what its ``turned_at``
        returned, which has other breaks than the motion asked for.
    profiles
        ``Profiles``, the shapes of the surface, if they were asked for, else None.
    diagnostics
        Numbers by name, such as ``steps``, which become attributes of results. Where there are
        ``stored_energy_start`` and ``stored_energy_end``, J, of sample, surfaces and lever at the
        first and the last instant, they differ by the work done less what was dissipated and
        released.
    warnings
        The ``AccuracyWarning`` that the solver has given, a tuple.
    viscous_energy
        Energy that the dashpots took in the step that ends at each instant, J, shape (n,); None if
        the solver does not know it better than from their power.
    stored_energy
        Energy held by sample, surfaces and lever at each instant, J, shape (n,), NaN where it was
        not measured; None if the solver knows it at the ends at most.
    """

    time: np.ndarray
    tip_height: np.ndarray
    force: np.ndarray
    contact_radius: np.ndarray
    axis_deformation: np.ndarray
    viscous_power: np.ndarray
    pieces: tuple[slice, ...]
    jump_time: np.ndarray
    jump_energy: np.ndarray
    motion: Motion
    profiles: Profiles | None = None
    diagnostics: dict[str, float] = field(default_factory=dict)
    warnings: tuple[AccuracyWarning, ...] = ()
    viscous_energy: np.ndarray | None = None
    stored_energy: np.ndarray | None = None
    _quadratures: "dict[Any, Quadrature]" = field(
        default_factory=dict, init=False, repr=False, compare=False
    )
    _energies: dict[Any, Energies] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def integrate(
        self,
        values: np.ndarray,
        weight: Callable[[np.ndarray], Any],
        start: float = -np.inf,
        stop: float = np.inf,
    ) -> float:
        """∫ values(t) weight(t) dt from ``start`` to ``stop`` (s).

        ``values`` (n,) is interpolated in every step by the cubic through its four nearest
        instants of the same smooth piece; ``weight`` is a function of time. Gauss-Legendre with
        four points a step.
        """
        rule = self._quadrature(start, stop)
        return float(np.sum(rule.interpolate(values) * weight(rule.at) * rule.lengths))

    def integrate_power(self, start: float = -np.inf, stop: float = np.inf) -> float:
        """Energy that dashpots take from ``start`` to ``stop`` (s), J: ∫ ``viscous_power`` dt.

        As ``integrate``, but for steps so long for a creep time that the power at their ends does
        not tell: what the solver states as ``viscous_energy`` counts there.
        """
        rule, power = self._quadrature(start, stop), self.viscous_power
        each = np.sum(rule.interpolate(power) * rule.lengths, axis=1)
        if self.viscous_energy is not None:
            step, end, width = rule.step, rule.step + 1, rule.lengths.sum(axis=1)
            lost, straight = self.viscous_energy[end], width * (power[step] + power[end]) / 2
            poor = np.abs(lost - straight) > _POOR * np.maximum(lost, np.abs(straight))
            whole = width > (1 - 1e-9) * (self.time[end] - self.time[step])
            each = np.where(poor & whole, lost, each)
        return float(each.sum())

    def compare_rules(
        self,
        values: np.ndarray,
        weight: Callable[[np.ndarray], Any],
        start: float = -np.inf,
        stop: float = np.inf,
    ) -> tuple[float, float]:
        """Return the integral of ``integrate``, and how far that over straight lines is from it.

        Of the second one parts of positive and of negative weight count by their magnitude, as they
        are off in opposite directions on the way down and up.
        """
        rule = self._quadrature(start, stop)
        weighted = weight(rule.at) * rule.lengths
        curved = rule.interpolate(values)
        off = np.interp(rule.at, self.time, values) - curved
        opposed = max(abs(np.sum(off * weighted)), abs(np.sum(off * np.abs(weighted))))
        return float(np.sum(curved * weighted)), float(opposed)

    def _quadrature(self, start: float, stop: float) -> "Quadrature":
        """Return the rule between two times, s: kept for the next integral."""
        from softafm.solvers.quadrature import lay_quadrature

        key = max(start, self.time[0]), min(stop, self.time[-1])
        if key not in self._quadratures:
            self._quadratures[key] = lay_quadrature(self.time, self.pieces, *key)
        return self._quadratures[key]

    def energies(self, start: float = -np.inf, stop: float = np.inf) -> Energies:
        """Return the ``Energies`` between two times, s, at which the motion is met by a step."""
        key = max(start, self.time[0]), min(stop, self.time[-1])
        if key not in self._energies:
            self._energies[key] = measure_energies(self, *key)
        return self._energies[key]

    def extreme(
        self, values: np.ndarray, sign: int, start: float = -np.inf, stop: float = np.inf
    ) -> float:
        """Largest (``sign`` 1) or smallest (-1) of ``values`` (n,) between two times (s).

        Refined in the intervals on both sides of the extreme step by the cubics of ``integrate``.
        """
        from softafm.solvers.quadrature import find_summit

        best = -np.inf
        for piece in self.pieces:
            time, height = self.time[piece], sign * values[piece]
            first, last = int(time.searchsorted(start)), int(time.searchsorted(stop, "right")) - 1
            if first > last:
                continue
            top = first + int(height[first : last + 1].argmax())
            best = max(best, height[top])
            if first < top < last:
                best = max(best, find_summit(time, height, top))
        return sign * float(best)
