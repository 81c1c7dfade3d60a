"""Runs of any solver, and whether what one of someone's own returns can be true."""

from typing import Any

import numpy as np

from softafm.checks.kinds import refuse_incomplete, refuse_other
from softafm.checks.refusals import show
from softafm.errors import AccuracyWarning
from softafm.instrument.motion import find_setpoint
from softafm.progress import Progress
from softafm.solvers.energy import Energy
from softafm.solvers.history import History, Profiles
from softafm.solvers.paper.attard import Attard
from softafm.solvers.paper.enhanced import EnhancedAttard

_TESTED = (Energy, Attard, EnhancedAttard)
_OVER_TIME = (
    "time", "tip_height", "force", "contact_radius", "axis_deformation", "viscous_power",
)  # fmt: skip
_SAME = 1e-6
"""Largest difference of heights or times over their range that is due to rounding."""
_UNBENT = 1e-3
"""Deflection, over that which the force asks for, below which a lever was forgotten."""


def solve(
    solver: Any,
    contact: Any,
    motion: Any,
    *,
    stiffness: float | None = None,
    tolerance: float = 1e-2,
    profiles: bool = False,
    progress: Progress | None = None,
) -> History:
    """Carry a contact through a motion, as ``Solver.solve``; a solver may have no defaults.

    ValueError if the history of a solver that is not of this package contradicts itself, the
    motion or the options.
    """
    history = solver.solve(
        contact, motion,
        stiffness=stiffness, tolerance=tolerance, profiles=profiles, progress=progress,
    )  # fmt: skip
    if type(solver) not in _TESTED:
        wanted = f"a softafm.solvers.History, of the solver '{solver.kind}'"
        refuse_other("history", history, History, wanted)
        _Examination(solver.kind, history).examine(motion, stiffness, profiles)
    return history


class _Examination:
    """Refuses, on behalf of a solver by its ``kind``, what a history says wrongly."""

    def __init__(self, kind: str, history: History):
        self.kind, self.history = kind, history

    def examine(self, motion: Any, stiffness: float | None, profiles: bool) -> None:
        self._examine_arrays()
        self._examine_motion(motion)
        self._examine_heights(stiffness)
        self._examine_pieces()
        self._examine_jumps()
        if profiles:
            self._examine_profiles()
        doubts = self.history.warnings
        if not (isinstance(doubts, tuple) and all(isinstance(d, AccuracyWarning) for d in doubts)):
            self._refuse("warnings", doubts, "a tuple of AccuracyWarnings")

    def _refuse(self, name: str, value: Any, must: str) -> None:
        given = " ".join(str(value).split()) if isinstance(value, np.ndarray) else show(value)
        raise ValueError(f"history.{name} = {given}: of the solver '{self.kind}' must be {must}")

    def _check_array(self, name: str, size: int | None) -> None:
        array, count = getattr(self.history, name), "n" if size is None else size
        fit = isinstance(array, np.ndarray) and array.ndim == 1 and array.dtype.kind == "f"
        if not fit or size not in (None, array.size):
            self._refuse(name, array, f"an array of floats, shape ({count},)")
        if not np.isfinite(array).all():
            worst = int(np.flatnonzero(~np.isfinite(array))[0])
            self._refuse(f"{name}[{worst}]", float(array[worst]), "finite")

    def _examine_arrays(self) -> None:
        self._check_array("time", None)
        time = self.history.time
        if time.size < 2 or not (np.diff(time) > 0).all():
            self._refuse("time", time, "two times or more, s, ever later")
        for name in _OVER_TIME:
            self._check_array(name, time.size)

    def _examine_motion(self, asked: Any) -> None:
        """Refuse a motion that is not that asked for, or turned by its force."""
        done, time, force = self.history.motion, self.history.time, self.history.force
        refuse_incomplete("history.motion", done, ("breaks", "height"), "the motion as carried out")
        start, end = done.breaks[0], done.breaks[-1]
        slack = _SAME * (end - start)
        if abs(time[0] - start) > slack or abs(time[-1] - end) > slack:
            ends = f"from {start:g} to {end:g} s, as history.motion does"
            self._refuse("time", time[[0, -1]], ends)
        trigger = find_setpoint(asked)
        if trigger is not None:
            early = (time < done.breaks[1] - slack) & (force > trigger)
            if early.any():
                first = int(np.flatnonzero(early)[0])
                must = f"the motion turned by its setpoint_force, reached at {time[first]:g} s"
                self._refuse("motion", done, must)
        turned = trigger is not None and find_setpoint(done) is None
        if not turned and max(abs(start - asked.breaks[0]), abs(end - asked.breaks[-1])) > slack:
            ends = f"that asked for, from {asked.breaks[0]:g} to {asked.breaks[-1]:g} s"
            self._refuse("motion", done, ends)

    def _examine_heights(self, stiffness: float | None) -> None:
        """Refuse a tip that does not follow the motion, or a lever that does not bend."""
        history = self.history
        prescribed = history.motion.height(history.time)
        off = np.abs(history.tip_height - prescribed)
        if stiffness is None:
            worst = int(off.argmax())
            if off[worst] > _SAME * np.ptp(prescribed) + 1e-15:
                at = f"tip_height at {history.time[worst]:g} s"
                must = f"that of history.motion there, {prescribed[worst]:g} m"
                self._refuse(at, float(history.tip_height[worst]), must)
            return
        asked = float(np.abs(history.force).max()) / stiffness
        if off.max() < _UNBENT * asked - _SAME * np.ptp(prescribed):
            must = f"off the base by up to {asked:.3g} m, as stiffness = {stiffness:g} N/m"
            self._refuse("tip_height", history.tip_height, must)

    def _examine_pieces(self) -> None:
        """Refuse pieces that leave out steps, or overlap by more than one."""
        pieces, size = self.history.pieces, self.history.time.size
        fit = isinstance(pieces, tuple) and len(pieces) > 0
        end = 0
        for number, piece in enumerate(pieces if fit else ()):
            fit = fit and isinstance(piece, slice) and piece.step in (None, 1)
            starts = {end, end - 1} if number else {0}
            fit = fit and piece.start in starts and end < (piece.stop or 0) <= size
            end = piece.stop if fit else end
        if not fit or end != size:
            must = f"slices that cover all {size} steps, neighbours sharing one at most"
            self._refuse("pieces", pieces, must)

    def _examine_jumps(self) -> None:
        self._check_array("jump_time", None)
        self._check_array("jump_energy", self.history.jump_time.size)
        time, jumps = self.history.time, self.history.jump_time
        if ((jumps < time[0]) | (jumps > time[-1])).any():
            self._refuse("jump_time", jumps, f"from {time[0]:g} to {time[-1]:g} s")

    def _examine_profiles(self) -> None:
        profiles, size = self.history.profiles, self.history.time.size
        if not isinstance(profiles, Profiles):
            self._refuse("profiles", profiles, "softafm.solvers.Profiles, as they are asked for")
        assert profiles is not None
        shapes, radius = profiles.deformation, profiles.radius
        if np.shape(shapes) != (size, *np.shape(radius)) or not np.isfinite(shapes).all():
            must = f"finite, shape ({size}, {np.size(radius)}): by time and radius"
            self._refuse("profiles.deformation", shapes, must)
