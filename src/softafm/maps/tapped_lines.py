"""Tapping at constant amplitude along scan lines: each pixel starts from what is known nearby.

The tip engages on the first pixel and goes down the first column; from there it goes along every
line. So lines do not depend on each other, and numbers neither on the order of lines nor on how
many are computed at a time. The branch is that of the pixel before while it exists; where the
numerical search starts follows from the known solutions on that branch, those of the first column,
of a few lines that are taken before all others, and of the line.
"""

import warnings
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from softafm.checks.gathering import Placed, keep_worst
from softafm.checks.validate import check_tolerance
from softafm.contact import Contact
from softafm.errors import AccuracyWarning, DivergedError
from softafm.maps.imaging import AmplitudeModulation
from softafm.maps.setpoint import ATTRACTIVE, REPULSIVE, Lost, Point, Setpoint
from softafm.modes.approach import approach_curve
from softafm.modes.driven import make_drive
from softafm.modes.tap_map import OBSERVABLES
from softafm.solvers.solver import Solver

NAMES = ("mean_height", "phase", "branch", *OBSERVABLES)
_NEAREST = 8
_STRAIGHT = 0.95
_ENGAGING_RATIOS = 12


class Spot(NamedTuple):
    """A pixel's contact, its number among all, and where it stands among them."""

    number: int
    contact: Contact
    place: np.ndarray
    label: int


@dataclass
class Known:
    """Solutions found so far, by contact and incoming branch, and those to predict others from."""

    solved: dict[tuple[int, int], Point | str] = field(default_factory=dict)
    bases: dict[tuple[int, int], list[tuple[np.ndarray, Point]]] = field(default_factory=dict)
    gone: dict[tuple[int, int], list[np.ndarray]] = field(default_factory=dict)
    """Places where a branch was searched for and not found, by label and branch."""

    def copy(self) -> "Known":
        """Return the same, to be added to."""
        bases = {key: list(each) for key, each in self.bases.items()}
        return Known(dict(self.solved), bases, {key: list(each) for key, each in self.gone.items()})

    def keep(self, spot: Spot, point: Point) -> None:
        """Let a solution predict others."""
        if point.measured:
            self.bases.setdefault((spot.label, point.branch), []).append((spot.place, point))

    def find_near(self, spot: Spot, branch: int, unit: float) -> tuple[Point, float] | None:
        """Solution to start from, and the closest approach, m, that its neighbours predict."""
        bases = self.bases.get((spot.label, branch))
        if not bases:
            return None
        offsets = np.array([place for place, _ in bases]) - spot.place
        order = np.argsort((offsets**2).sum(axis=1), kind="stable")[:_NEAREST]
        first = bases[order[0]][1]
        if order.size == 1 or spot.place.size == 0:
            return first, first.approach
        approaches = np.array([bases[i][1].approach for i in order])
        steps = offsets[order[1:]] - offsets[order[0]]
        slope = np.linalg.lstsq(steps, approaches[1:] - approaches[0], rcond=1e-3)[0]
        change = float(np.clip(-offsets[order[0]] @ slope, -unit, unit))
        return first, first.approach + change

    def is_past_end(self, spot: Spot, branch: int) -> bool:
        """Whether a branch is gone at a place between here and where it is known to exist."""
        gone = self.gone.get((spot.label, branch))
        bases = self.bases.get((spot.label, branch))
        if not gone or not bases or spot.place.size == 0:
            return False
        places = np.array(gone)
        end = places[((places - spot.place) ** 2).sum(axis=1).argmin()]
        known = np.array([place for place, _ in bases])
        origin = known[((known - end) ** 2).sum(axis=1).argmin()]
        there, here = end - origin, spot.place - origin
        along = float(there @ here)
        straight = along >= _STRAIGHT * np.linalg.norm(there) * np.linalg.norm(here)
        return bool(straight and along >= there @ there)


@dataclass(frozen=True)
class Taken:
    """What a stretch of pixels gave: ``values`` (pixels, NAMES), why some failed, warnings.

    Warnings come with the number of their contact.
    """

    values: np.ndarray
    reasons: dict[int, str]
    warned: list[Placed]
    taps: int


def make_setpoint(imaging: AmplitudeModulation, solver: Solver, tolerance: float) -> Setpoint:
    """Return what finds the taps of a way of imaging."""
    drive, frequency = make_drive(
        imaging.cantilever, imaging.free_amplitude, imaging.drive_frequency
    )
    amplitude = imaging.setpoint * imaging.free_amplitude
    return Setpoint(drive, frequency, amplitude, solver, check_tolerance(tolerance))


def walk(setpoint: Setpoint, spots: list[Spot], branch: int, known: Known) -> Taken:
    """Take pixels one after the other; ``known`` is added to."""
    started, reasons = setpoint.taps, {}
    warned: list[Placed] = []
    values = np.full((len(spots), len(NAMES)), np.nan)
    last: Point | None = None
    for i, spot in enumerate(spots):
        key = spot.number, branch
        if key not in known.solved:
            setpoint.warned.clear()
            known.solved[key] = _solve(setpoint, spot, branch, known, last)
            if isinstance(point := known.solved[key], Point):
                setpoint.doubt(point)
            warned += [(spot.number, each) for each in keep_worst(setpoint.warned)]
        found = known.solved[key]
        if isinstance(found, str):
            reasons[i] = found
            continue
        last, branch = found, found.branch
        height = setpoint.amplitude + found.approach
        values[i] = [height, setpoint.phase(found.values), branch, *found.values]
    return Taken(values, reasons, warned, setpoint.taps - started)


def _solve(
    setpoint: Setpoint, spot: Spot, branch: int, known: Known, last: Point | None
) -> Point | str:
    """The solution of one contact that is new, or why there is none."""
    unit, other = spot.contact.reach, 1 - branch
    near, crossed = known.find_near(spot, branch, unit), known.find_near(spot, other, unit)
    if near is None and last is not None and last.branch == branch:
        near = last, last.approach
    other_guess = np.nan if crossed is None else crossed[1]
    if crossed is not None and known.is_past_end(spot, branch):
        near, other_guess = crossed, np.nan
    start, guess = near or (None, np.nan)
    try:
        point = setpoint.carry(spot.contact, start, guess, branch, other_guess)
    except Lost as reason:
        return str(reason)
    if point.surveyed and point.branch != branch:
        known.gone.setdefault((spot.label, branch), []).append(spot.place)
    known.keep(spot, point)
    return point


def find_engaged_branch(
    imaging: AmplitudeModulation, contact: Contact, solver: Solver, tolerance: float
) -> int:
    """Branch on which a lever that comes down meets the setpoint."""
    if imaging.engaged != "approach":
        return ATTRACTIVE if imaging.engaged == "attractive" else REPULSIVE
    setpoint, highest = imaging.setpoint, max(0.99, (1 + imaging.setpoint) / 2)
    # Past the setpoint: a branch that ended with the amplitudes would look as if it were left.
    ratios = np.append(np.linspace(0.75 * setpoint, highest, _ENGAGING_RATIOS), setpoint)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", AccuracyWarning)
        try:
            curve = approach_curve(
                contact, imaging.cantilever, imaging.free_amplitude, ratios,
                drive_frequency=imaging.drive_frequency, solver=solver, tolerance=tolerance,
            )  # fmt: skip
        except DivergedError:
            return ATTRACTIVE
    stable = curve.isel(amplitude_ratio=-1).sel(branch=["attractive", "repulsive"])
    heights, amplitude = stable["mean_height"].values, curve["approach_amplitude"].values
    felt = np.flatnonzero(np.isfinite(amplitude))
    if felt.size == 0 or not np.isfinite(heights).any():
        return ATTRACTIVE
    met = np.flatnonzero(~(amplitude[felt[0] :] > setpoint * imaging.free_amplitude))
    end = felt[0] + met[0] if met.size else amplitude.size - 1
    return int(np.nanargmin(np.abs(heights - curve["sweep_height"].values[end])))
