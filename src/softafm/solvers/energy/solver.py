"""The default solver: implicit energy-minimising steps on a mesh that follows the contact edge."""

from dataclasses import dataclass
from math import log10
from time import perf_counter
from typing import Any, ClassVar

from softafm.checks.callers import warn_caller
from softafm.checks.validate import check_finite, check_positive, check_tolerance
from softafm.compiled.announce import announce_compilation
from softafm.instrument.lever import Lever, check_lever, make_lever
from softafm.instrument.motion import Motion, count_periods, is_steady
from softafm.instrument.motions import find_lowest_height
from softafm.progress import Progress
from softafm.solvers.energy.tuning import FAR_SOFTER
from softafm.solvers.history import History

_RUN, _CYCLE = 5e-3, 4e-3
"""Time of a run besides its steps, and that of a ramp or a cycle without adhesion, s on one core.
All these are such that most of the runs of ``benchmarks/accuracy.py`` take between a third of the
forecast and three times as long."""
_LENGTH, _STEEP_LENGTH = 4e-5, 2e-4
"""Time in which an edge crosses a cohesive length, s, and where a steep tip holds it."""
_RIDE, _RIDE_WITH_MEMORY = 4e-3, 7.5e-3
"""Times in which it rides over some, s: for every tenfold number, and for its power of 0.38."""
_MOST_CYCLES = 30.0
"""What the longest search for a steady cycle is worth: far from it a cycle takes few steps."""


@dataclass(frozen=True)
class Energy:
    """Implicit steps that minimise the energy, with exact memory and elastic jumps.

    Each step solves an elastic adhesion problem whose compliance is that of the step and whose
    offset is the memory, by Newton's method; the memory is integrated exactly for a pressure
    quadratic in time. Steps adapt to the tolerance. Where no stable shape is near, the surface
    falls to the next one and the jump is recorded. The mesh rides with the contact edge and its
    spacing there follows the width of the cohesive zone. ``softafm docs solver`` has more.

    Parameters
    ----------
    finest_spacing
        Smallest node spacing at the contact edge, in contact radii. A cohesive zone that asks for
        less raises ``AccuracyWarning``.
    most_steps
        Attempted steps after which a run is given up with ``DivergedError``.

    Raises
    ------
    ValueError
        If an option is out of range.
    """

    kind: ClassVar[str] = "energy"
    adaptive: ClassVar[bool] = True
    finest_spacing: float = 1e-10
    most_steps: int = 2_000_000

    def __post_init__(self) -> None:
        spacing = check_positive("finest_spacing", self.finest_spacing, "contact radii")
        if spacing > 0.3:
            raise ValueError(f"finest_spacing = {spacing:g} contact radii: must be at most 0.3")
        if check_finite("most_steps", self.most_steps, "steps") < 1:
            raise ValueError(f"most_steps = {self.most_steps!r} steps: must be at least 1")

    def solve(
        self,
        contact: Any,
        motion: Motion,
        *,
        stiffness: float | None = None,
        lever: Lever | None = None,
        tolerance: float = 1e-2,
        profiles: bool = False,
        progress: Progress | None = None,
    ) -> History:
        """Carry the contact, flat and relaxed at first, through the motion.

        Parameters
        ----------
        contact, motion
            ``softafm.Contact`` and a motion, e.g. ``softafm.Triangle``.
        stiffness
            Stiffness of a lever that carries the tip and whose base moves so, N/m; None moves the
            tip itself.
        lever
            In place of a stiffness, a lever of any kind: see ``softafm.instrument.lever``.
        tolerance
            Target relative error of forces and energies.
        profiles
            Keep the surface shapes.
        progress
            Callable of (fraction done, message), or None.

        Raises
        ------
        ValueError
            If ``tolerance`` is not from 1e-5 to 0.1, ``lever`` is none, or a stiffness is given
            besides.
        DivergedError
            If ``most_steps`` do not suffice or no stable shape is found.
        """
        tolerance = check_tolerance(tolerance)
        if lever is None:
            lever = make_lever(stiffness)
        elif stiffness is not None:
            raise ValueError(
                f"stiffness = {stiffness:g} N/m: must be left out where there is a lever"
            )
        else:
            check_lever(lever)
        started = perf_counter()
        with announce_compilation(self.kind):
            from softafm.solvers.energy.run import Run

            run = Run(self, contact, motion, lever, tolerance, profiles)
        for fraction in run.cycles() if is_steady(motion) else run.steps():
            if progress is not None:
                progress(fraction, f"{fraction:.0%} of the motion")
        history = run.history(perf_counter() - started)
        for warning in history.warnings:
            warn_caller(warning)
        return history

    def expected_seconds(self, contact: Any, motion: Motion) -> float:
        """Order of magnitude of a run at the default tolerance, s on one core, as measured."""
        lengths = count_cohesive_lengths(contact, motion) / count_periods(motion)
        creep = contact.body.compliance
        if contact.steep:
            crossing = _STEEP_LENGTH * lengths
        elif is_steady(motion):
            crossing = _LENGTH * lengths
        else:  # a slack edge rides over many lengths in a step, and its memory with it
            duration = float(motion.breaks[-1] - motion.breaks[0])
            softened = float(creep.at(duration)) / creep.instantaneous - 1
            evenly = creep.relaxed == creep.instantaneous or softened >= FAR_SOFTER
            riding = _RIDE * log10(1 + lengths) if evenly else _RIDE_WITH_MEMORY * lengths**0.38
            crossing = min(_LENGTH * lengths, riding)
        return _RUN + estimate_cycles(contact, motion) * (_CYCLE + crossing)


def estimate_cycles(contact: Any, motion: Motion) -> float:
    """Return how many cycles a run takes, until a steady one is found by experience.

    The more, the more the sample would still creep after a cycle, relative to what it does in one.
    """
    creep = contact.body.compliance
    if not is_steady(motion) or creep.relaxed == creep.instantaneous:
        return count_periods(motion)
    crept = float(creep.at(float(motion.breaks[-1] - motion.breaks[0])))
    return min(1 + 2 * (creep.relaxed / crept - 1) ** 0.4, _MOST_CYCLES)


def count_cohesive_lengths(contact: Any, motion: Motion) -> float:
    """Return how many cohesive lengths the contact edge crosses at most, in and out each cycle.

    None without adhesion. The modulus is what the motion leaves of it, the softened one at
    least, and that in a steady motion.
    """
    if not contact.adhesive:
        return 0.0
    law, radius = contact.surface, contact.contact_radius(find_lowest_height(motion))
    modulus = contact.softened_modulus
    if not is_steady(motion):
        duration = float(motion.breaks[-1] - motion.breaks[0])
        modulus = max(modulus, 1 / float(contact.body.compliance.at(duration)))
    length = modulus * law.range**2 / law.work_of_adhesion
    return 2 * radius / length * count_periods(motion)
