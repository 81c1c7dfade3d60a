"""A tap at the setpoint of a feedback: the closest approach at which a lever keeps an amplitude.

At a fixed amplitude A the balance of the drive (``softafm.instrument.oscillator``) is one equation
for the closest approach d = Z − A. It is solved from a solution nearby by secants, a few taps;
where there is none nearby, all solutions are found from a map of taps along d, as in an approach
curve.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from softafm.checks.gathering import collect_warnings
from softafm.contact import Contact
from softafm.errors import AccuracyWarning, DivergedError
from softafm.instrument.motions import Sine
from softafm.instrument.oscillator import Drive
from softafm.modes.amplitude_curve import AmplitudeCurve
from softafm.modes.audit import audit
from softafm.modes.driven import doubt_sine
from softafm.modes.tap_map import OBSERVABLES, TapMap
from softafm.modes.tapping import observe_taps
from softafm.solvers.history import History
from softafm.solvers.own import solve
from softafm.solvers.solver import Solver

ATTRACTIVE, REPULSIVE = 0, 1
BRANCHES = ("attractive", "repulsive")
_MOST_TAPS = 7
_FARTHEST_STEP = 2.0
_STEP = 1e-2
_CLOSE, _VERY_CLOSE = 3.0, 0.3
"""Tolerances that the excess may be off, and what is left be had from slopes: those of the contact
itself, and those of a neighbour."""
_NEAR, _SAME = 0.03, 0.1
"""Reaches, per such tolerance, that d may be off then; reaches within which solutions are one."""


class Point(NamedTuple):
    """A solution at the setpoint.

    ``values`` are the ``OBSERVABLES``, ``slopes`` theirs along d, in SI per m.
    """

    approach: float
    values: np.ndarray
    slopes: np.ndarray
    branch: int
    measured: bool
    """Whether the slopes are this contact's own."""
    surveyed: bool = False
    """Whether all solutions of the contact were looked at."""


class Lost(Exception):
    """A contact has no solution that the feedback could hold; the text says why."""


@dataclass
class Setpoint:
    """Finds taps of one amplitude that a drive sustains.

    Parameters
    ----------
    drive, frequency
        The ``softafm.instrument.oscillator.Drive`` and its frequency, Hz.
    amplitude
        Amplitude A at the setpoint, m.
    solver, tolerance
        As for ``softafm.approach_curve``.

    Attributes
    ----------
    taps
        Taps that were run.
    warned
        What the solver and ``doubt`` warned of since it was emptied.
    last
        The last tap, if it has not been audited.
    """

    drive: Drive
    frequency: float
    amplitude: float
    solver: Solver
    tolerance: float
    taps: int = 0
    warned: list[AccuracyWarning] = field(default_factory=list)
    last: tuple[Contact, History] | None = None

    def tap(self, contact: Contact, approach: float, amplitude: float | None = None) -> np.ndarray:
        """``OBSERVABLES`` of a steady tap of a closest approach, m."""
        amplitude = self.amplitude if amplitude is None else amplitude
        with collect_warnings(self.warned):
            motion = Sine(amplitude + approach, amplitude, self.frequency, "steady")
            history = solve(self.solver, contact, motion, tolerance=self.tolerance)
        self.taps += 1
        self.last = contact, history
        found = observe_taps(contact, motion, history)
        return np.array([found[name] for name in OBSERVABLES])

    def excess(self, values: np.ndarray) -> float:
        """Force needed over that of the drive, less 1."""
        return float(self.drive.excess(self.amplitude, values[0], values[1]))

    def doubt(self, point: Point) -> None:
        """Add what the audit of the last tap finds, and whether the lever moves as a sine."""
        if self.last is not None:
            self.warned.extend(audit(*self.last, self.tolerance).problems)
            self.last = None
        if (doubtful := doubt_sine(self.drive, self.amplitude, *point.values[:2])) is not None:
            self.warned.append(doubtful)

    def phase(self, values: np.ndarray) -> float:
        """Lag of the deflection behind the drive, degrees."""
        return float(self.drive.phase(self.amplitude, values[0], values[1]))

    def follow(self, contact: Contact, start: Point, guess: float) -> Point | None:
        """Solution that continues one of a similar contact, or None if that leads nowhere.

        Parameters
        ----------
        start
            The solution to continue.
        guess
            Closest approach to try first, m.
        """
        slopes, measured, approach = start.slopes, False, guess
        last: tuple[float, np.ndarray] | None = None
        farthest, near = _FARTHEST_STEP * contact.reach, _NEAR * contact.reach
        for _ in range(_MOST_TAPS):
            values = self.tap(contact, approach)
            if last is not None and abs(approach - last[0]) > 1e-6 * contact.reach:
                slopes, measured = (values - last[1]) / (approach - last[0]), True
            slope = self._excess_slope(values, slopes)
            if not slope < 0:
                return None
            excess = self.excess(values)
            step = -excess / slope
            close = _CLOSE if measured else _VERY_CLOSE
            if abs(excess) <= close * self.tolerance and abs(step) <= near * close:
                return self._keep_if_held(
                    Point(approach + step, values + step * slopes, slopes, start.branch, measured)
                )
            last = approach, values
            approach += float(np.clip(step, -farthest, farthest))
        return None

    def survey(self, contact: Contact) -> list[Point]:
        """All solutions that the feedback can hold, from far to near."""
        taps = TapMap(
            lambda amplitude, approach: self.tap(contact, approach, amplitude),
            self.drive, self.amplitude, self.amplitude, contact.reach, self.tolerance,
        )  # fmt: skip
        for _ in taps.explore():
            pass
        found = AmplitudeCurve(taps, self.drive).at_amplitudes(np.array([self.amplitude]))
        points = []
        for approach, branch, stable in zip(
            found.approach.tolist(), found.branch, found.stable, strict=True
        ):
            if not stable or branch not in BRANCHES:
                continue
            step = _STEP * contact.reach
            far, near = (taps.observables(self.amplitude, approach + s) for s in (step, -step))
            values = taps.observables(self.amplitude, approach)
            slopes = (far - near) / (2 * step)
            if self._excess_slope(values, slopes) < 0:
                points.append(Point(approach, values, slopes, BRANCHES.index(branch), True))
        return sorted(points, key=lambda point: -point.approach)

    def start_anew(self, contact: Contact, branch: int) -> Point:
        """Solution on a branch, or on the other one if there is none; raises ``Lost``."""
        points = self.survey(contact)
        same = [point for point in points if point.branch == branch]
        if not points:
            raise Lost("no height holds the setpoint")
        chosen = (same or points)[0 if branch == ATTRACTIVE else -1]
        exact = self.follow(contact, chosen, chosen.approach)
        return (chosen if exact is None else exact)._replace(measured=True, surveyed=True)

    def carry(
        self, contact: Contact, start: Point | None, guess: float, branch: int, other_guess: float
    ) -> Point:
        """Solution on the branch that a lever comes along, or that it jumps to.

        The branch is kept where it exists and can be held. ``start`` and ``guess`` are as for
        ``follow``; None and NaN seek from nothing. ``other_guess`` is where the other branch is
        expected: one that is met there goes over into the other and gets its name.

        Raises
        ------
        Lost
            If no height holds the setpoint, or the solver gives up.
        """
        try:
            if start is not None:
                point = self.follow(contact, start, guess)
                if point is not None:
                    if self._is_plain(point):
                        return point
                    if abs(point.approach - other_guess) < _SAME * contact.reach:
                        return point._replace(branch=1 - branch)
            return self.start_anew(contact, branch)
        except DivergedError as error:
            raise Lost(str(error)) from None

    def _is_plain(self, point: Point) -> bool:
        """Whether the phase alone says that it is the branch it is."""
        return (self.phase(point.values) > 90) == (point.branch == ATTRACTIVE)

    def _excess_slope(self, values: np.ndarray, slopes: np.ndarray) -> float:
        """Slope of the excess along d, 1/m: that of hypot(c, s)/F0."""
        A = self.amplitude
        c, s = self.drive.components(A, values[0], values[1])
        change = c * -2 * slopes[0] / A + s * slopes[1] / (np.pi * A)
        return float(change / (np.hypot(c, s) * self.drive.force))

    def _keep_if_held(self, point: Point) -> Point | None:
        """The point if a feedback can hold it; along A, taps change nearly as √A."""
        V, E = point.values[:2]
        along = point.values[:2] / (2 * self.amplitude) - point.slopes[:2]
        return point if self.drive.stable(self.amplitude, V, E, *along) else None
