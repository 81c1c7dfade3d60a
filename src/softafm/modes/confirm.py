"""Solutions of an approach curve, tapped: what holds of the map, and what is corrected.

The map of taps interpolates. A few solutions are therefore run themselves, and where the map missed
one of them its neighbours, too. What was run counts: a solution moves to where its taps balance the
drive.
"""

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from softafm.checks.gathering import Placed
from softafm.errors import AccuracyWarning, DivergedError
from softafm.instrument.oscillator import Drive
from softafm.modes.amplitude_curve import AmplitudeCurve, Solutions
from softafm.modes.tap_map import OBSERVABLES, TapMap

_FIRST, _MOST_TAPS = 16, 5
_CLOSE, _FAR, _GRAZING, _MEET = 0.2, 1.0, 1.5, 5e-3
"""Tolerances that the excess may be off where slopes give the rest, where a solution holds, and
where a tap decides whether two solutions meet, and where it cannot tell either."""
_NEAR, _FARTHEST, _ASIDE = 0.1, 0.1, 0.25
"""Units that a height may be off; part of the depth by which one moves at most, at least a unit;
units between taps where two solutions may meet."""
_LOSS, _FAINT = 2.0, 4e-4
"""Tolerances that a dissipation may be off, relative to itself or to this share of the largest
force times the amplitude."""

Tap = Callable[[float, float], np.ndarray]


class Confirmed(NamedTuple):
    """Closest approaches, m, (n,) and observables (7, n) of solutions.

    ``solutions`` of them were run; ``wrong`` are warnings of those that do not hold.
    """

    approach: np.ndarray
    observables: np.ndarray
    solutions: int
    wrong: list[Placed]


class _Tapped(NamedTuple):
    """A tap near a solution: closest approach, m, observables, and excess of the force needed."""

    approach: float
    values: np.ndarray
    excess: float


def confirm_solutions(
    found: Solutions, taps: TapMap, tap: Tap, drive: Drive, tolerance: float
) -> Confirmed:
    """Run solutions: a few that lie far apart, and more and more near those that the map missed."""
    approach, observables = found.approach.copy(), taps.observables(found.amplitude, found.approach)
    order = np.lexsort((found.row, np.array(found.branch)))
    missed: dict[int, bool] = {}
    wrong: list[Placed] = []
    pending = set(np.linspace(0, order.size - 1, min(order.size, _FIRST)).astype(int).tolist())
    while pending:
        for position in sorted(pending):
            i = order[position]
            place = amplitude, _ = float(found.amplitude[i]), float(approach[i])
            tapped: list[_Tapped] = []
            missed[position] = True
            try:
                for each in _seek(place, observables[:, i], taps, tap, drive, tolerance):
                    tapped.append(each)
                missed[position] = len(tapped) > 1
            except DivergedError:  # of which the tap warns
                if not tapped:
                    continue
            approach[i], observables[:, i], doubt = _settle(amplitude, tapped, taps, tolerance)
            wrong += [(place, doubt)] if doubt is not None else []
        near = (pair for pair in pairwise(sorted(missed)) if missed[pair[0]] or missed[pair[1]])
        pending = {(low + high) // 2 for low, high in near} - set(missed)
    return Confirmed(approach, observables, len(missed), wrong)


def solve_amplitudes(
    curve: AmplitudeCurve, amplitudes: np.ndarray, precise_tap: Tap, unit: float, tolerance: float
) -> tuple[Solutions, list[Placed]]:
    """Return the solutions of amplitudes, m, on a map, and warnings of those that may be amiss.

    Where two of them nearly meet, or have just parted, three precise taps decide, by a parabola.
    """
    corrections: list[tuple[int, float, float]] = []
    doubts: list[Placed] = []
    for row, place in curve.find_grazing(amplitudes, _GRAZING * tolerance):
        amplitude = float(amplitudes[row])
        approaches = place + unit * np.array([-_ASIDE, 0.0, _ASIDE])
        try:
            taps = [precise_tap(amplitude, each) for each in approaches.tolist()]
        except DivergedError:  # of which the tap warns
            continue
        excesses = [curve.drive.excess(amplitude, *values[:2]) for values in taps]
        bend, slope, middle = np.polyfit([-1, 0, 1], excesses, 2)
        turn = float(np.clip(-slope / (2 * bend), -1, 1)) if bend else 0.0
        found = float(np.polyval([bend, slope, middle], turn))
        approach = place + turn * _ASIDE * unit
        corrections.append((row, approach, found - float(curve.excess(amplitude, approach))))
        if abs(found) < _MEET * tolerance:
            text = (
                "two solutions meet, and may be missing or too many: there the drive differs by "
                f"{abs(found):.2g} of itself from what is needed; take another amplitude_ratio or "
                "a lower tolerance"
            )
            doubts.append(((amplitude, approach), AccuracyWarning(text, -abs(found))))
    return curve.at_amplitudes(amplitudes, corrections), doubts


def _seek(
    place: tuple[float, float],
    expected: np.ndarray,
    taps: TapMap,
    tap: Tap,
    drive: Drive,
    tolerance: float,
) -> Iterator[_Tapped]:
    """Taps that approach a solution by secants, the first with the slope of the map.

    One is enough where the map holds what is ``expected``.
    """
    amplitude, approach = place
    slope, last, holds = taps.find_slopes(amplitude, approach)[0], None, False
    for _ in range(_MOST_TAPS):
        values = tap(amplitude, approach)
        here = _Tapped(approach, values, float(drive.excess(amplitude, values[0], values[1])))
        yield here
        if last is not None and here.approach != last.approach:
            secant = (here.excess - last.excess) / (here.approach - last.approach)
            slope = secant if secant * slope > 0 else slope
        if last is None:
            holds = not _miss(here, expected, amplitude, tolerance)
        elif here.approach != last.approach:  # what is left to the solution changes the loss little
            change = (here.values[1] - last.values[1]) / (here.approach - last.approach)
            loss = _find_loss(values, amplitude)
            holds = abs(change * here.excess / slope) <= 0.5 * _LOSS * tolerance * loss
        if abs(here.excess) <= _CLOSE * tolerance and holds:
            return
        last = here
        farthest = max(taps.unit, _FARTHEST * abs(approach))
        approach = here.approach - float(np.clip(here.excess / slope, -farthest, farthest))


def _miss(tapped: _Tapped, expected: np.ndarray, amplitude: float, tolerance: float) -> bool:
    """Whether the map is off by more than the tolerance where a tap was run."""
    loss, off = _find_loss(tapped.values, amplitude), abs(expected[1] - tapped.values[1])
    return abs(tapped.excess) > tolerance or off > _LOSS * tolerance * loss


def _find_loss(values: np.ndarray, amplitude: float) -> float:
    """Return the dissipation of a tap, J, or what one less than that is measured against."""
    force = np.abs(values[[OBSERVABLES.index("force_max"), OBSERVABLES.index("force_min")]])
    return max(abs(values[1]), _FAINT * force.max() * amplitude)


def _settle(
    amplitude: float, tapped: list[_Tapped], taps: TapMap, tolerance: float
) -> tuple[float, np.ndarray, AccuracyWarning | None]:
    """Closest approach, m, and observables of a solution from the taps near it, and a doubt."""
    best = min(tapped, key=lambda each: abs(each.excess))
    others = [each for each in tapped if each.approach != best.approach]
    if others:
        other = min(others, key=lambda each: abs(each.excess))
        slopes = (best.values - other.values) / (best.approach - other.approach)
        slope = (best.excess - other.excess) / (best.approach - other.approach)
    else:
        slope, slopes = taps.find_slopes(amplitude, best.approach)
    off = -best.excess / slope if slope else np.inf
    crossed = len({each.excess > 0 for each in tapped}) > 1
    found = crossed or not others or abs(best.excess) <= _FAR * tolerance
    if abs(off) > _NEAR * taps.unit or not found:
        if abs(best.excess) <= _FAR * tolerance:
            return best.approach, best.values, None
        text = (
            f"the solution of amplitude {amplitude:.3g} m is off by about {abs(off):.2g} m in "
            "height: taps between those that were run are not smooth"
        )
        return best.approach, best.values, AccuracyWarning(text, abs(off))
    return best.approach + off, best.values + slopes * off, None
