"""One dent: how deep a tip is from where it meets the surface to where it leaves it."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from softafm.checks.kinds import members, refuse_incomplete
from softafm.instrument.motion import Motion, find_setpoint, is_steady
from softafm.instrument.trajectory import Trajectory

_PIECES = 400
"""Straight pieces that stand for a curved motion between its breaks."""
_PROBES = np.linspace(0, 1, 33)
_STRAIGHT = 1e-9
"""Distance from a straight line that counts as none, over the range of the motion."""
_SAME = 1e-9
"""Change of speed, over the largest, and way back, over the largest depth, that is round-off."""


class Dent(NamedTuple):
    """Depths (m), straight between times (s), both of shape (n,); 0 at the first time.

    ``turn`` is the first index at which the tip is deepest, ``back`` the last. ``whole`` are times
    and heights of all of the motion.
    """

    time: np.ndarray
    depth: np.ndarray
    turn: int
    back: int
    whole: tuple[np.ndarray, np.ndarray]

    @property
    def speed(self) -> np.ndarray:
        """Rate at which the depth rises in each piece, m/s, shape (n − 1,)."""
        return np.diff(self.depth) / np.diff(self.time)

    @property
    def corners(self) -> np.ndarray:
        """Indices of times at which the speed jumps, first and last included."""
        jump = np.abs(np.diff(self.speed)) > 0.1 * np.abs(self.speed).max()
        return np.concatenate([[0], np.flatnonzero(jump) + 1, [self.time.size - 1]])


def find_dent(motion: Motion) -> Dent:
    """Return the dent that a motion makes.

    Raises
    ------
    ValueError
        If the motion is none, never comes below the surface, begins below it, or comes down again
        before or after it has left it.
    """
    whole = time, height = _sample(motion)
    deep = -height
    inside = np.flatnonzero(deep > _SAME * deep.max())
    if not deep.max() > 0:
        raise ValueError(
            f"motion: its lowest height is {height.min():g} m; must come below the surface, at 0 m"
        )
    first, last = int(inside[0]), int(inside[-1])
    if first == 0:
        raise ValueError(
            f"motion: begins {deep[0]:g} m below the surface; must begin above it, which rests flat"
        )
    time, deep = _cut(time, deep, first, last)
    turn = int(np.argmax(deep >= deep.max() * (1 - _SAME)))
    back = deep.size - 1 - int(np.argmax(deep[::-1] >= deep.max() * (1 - _SAME)))
    wrong = np.diff(deep) * np.where(np.arange(deep.size - 1) < turn, 1, -1) < -_SAME * deep.max()
    if np.any(wrong):
        at = float(time[int(np.argmax(wrong))])
        raise ValueError(
            f"motion: reverses at {at:g} s; must press in once and withdraw once, as each dent "
            "meets a surface that remembers the one before"
        )
    deep[turn : back + 1] = deep.max()
    return Dent(time, deep, turn, back, whole)


def _cut(
    time: np.ndarray, deep: np.ndarray, first: int, last: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return the part between the crossings of depth 0, and these."""

    def cross(low: int) -> float:
        share = deep[low] / (deep[low] - deep[low + 1])
        return float(time[low] + share * (time[low + 1] - time[low]))

    inner = slice(first, last + 1)
    start, times, depths = cross(first - 1), time[inner], deep[inner]
    if last + 1 < time.size:
        times, depths = np.append(times, cross(last)), np.append(depths, 0.0)
    times, depths = np.append(start, times), np.append(0.0, depths)
    speed = np.diff(depths) / np.diff(times)
    bends = np.abs(np.diff(speed)) > _SAME * np.abs(speed).max()
    kept = np.concatenate([[True], bends, [True]])
    return times[kept], depths[kept]


def _sample(motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Return times (s) and heights (m) of a motion, between which it is straight or nearly so."""
    refuse_incomplete("motion", motion, members(Motion), "a motion such as softafm.Triangle")
    if is_steady(motion):
        raise ValueError(
            "motion: is repeated until it is steady; must be one dent in a surface at rest"
        )
    if find_setpoint(motion) is not None:
        raise ValueError(
            f"motion: turns at a force of {find_setpoint(motion):g} N, which depends on the run; "
            "must be without, such as Trajectory(time, tip_height) of its result"
        )
    if isinstance(motion, Trajectory) and not motion.smooth and motion.noise is None:
        return motion.time, motion.heights
    marks = np.union1d(motion.breaks, motion.landmarks)
    straight = _STRAIGHT * float(np.ptp(motion.height(marks)))
    times = [marks[:1]]
    for start, end in pairwise(marks):
        line = motion.height(start) * (1 - _PROBES) + motion.height(end) * _PROBES
        bent = np.abs(motion.height(start + (end - start) * _PROBES) - line) > straight
        times.append(np.linspace(start, end, _PIECES + 1 if np.any(bent) else 2)[1:])
    instants = np.concatenate(times)
    return instants, np.asarray(motion.height(instants), float)
