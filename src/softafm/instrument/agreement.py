"""Whether what a motion states about itself agrees: height, speed, times and powers."""

from json import dumps
from typing import Any

import numpy as np

from softafm.checks.callers import warn_caller
from softafm.checks.kinds import members, refuse_incomplete
from softafm.checks.refusals import show
from softafm.errors import DoubtfulValueWarning
from softafm.instrument.motion import Motion, bound_speed, find_setpoint, is_steady
from softafm.instrument.motions import Sine, Trajectory, Triangle

_KNOWN_TO_AGREE = (Triangle, Sine, Trajectory)
_PROBES = np.linspace(0.013, 0.987, 24)
"""Parts of every smooth piece at which a motion is tried; none of a regular pattern."""
_TURNS = 0.31, 0.83
"""Parts of the first piece after which a motion with a trigger is turned on trial."""
_SAME_HEIGHT, _SAME_VELOCITY, _SAME_TIME = 1e-6, 1e-3, 1e-6
_CORNER = 0.1
"""Jump of the velocity, over its largest magnitude, that makes a corner, as in ``Trajectory``."""
_HALVINGS = 30
"""Halvings of the time between two probes after which only a corner still changes the velocity."""
_NEAR_ENDS = 1e-5
"""Part of a piece next to its ends where no corner is sought: breaks may be rounded."""
_FAR_TOO_FAST = 10.0
"""Stated over found top speed from which a run takes many times the steps it needs."""


def check_motion(motion: Any) -> None:
    """Raise ValueError if an object is no motion, or its height, speed and times do not agree.

    A solver takes steps by what a motion states, and reads its height from the compiled function
    alone: where these disagree, a run is wrong without a sign. ``Triangle``, ``Sine`` and
    ``Trajectory`` are known to agree. Warns of a top speed that is far too high.
    """
    if type(motion) in _KNOWN_TO_AGREE:
        return
    _check_path(motion)
    _check_repetition(motion)
    _check_trigger(motion)
    _check_words(motion)
    fastest = float(np.abs(motion.velocity(_choose_times(motion))).max())
    if motion.top_speed > _FAR_TOO_FAST * fastest:
        warn_caller(
            DoubtfulValueWarning(
                f"motion.top_speed = {motion.top_speed:g} m/s: the motion '{motion.kind}' was "
                f"found nowhere faster than {fastest:g} m/s, and a run takes many more steps for it"
            )
        )


def _refuse(motion: Any, name: str, value: Any, must: str) -> None:
    shown = f"{value:g}" if isinstance(value, float) else show(value)
    if isinstance(value, np.ndarray):
        shown = " ".join(str(value).split())
    raise ValueError(f"motion.{name} = {shown}: of the motion '{motion.kind}' must be {must}")


def _is_number(value: Any) -> bool:
    number = np.asarray(value)
    return number.ndim == 0 and number.dtype.kind in "if" and bool(np.isfinite(number))


def _check_path(motion: Any) -> None:
    """Refuse what is no motion, or says of its path what is not so."""
    refuse_incomplete("motion", motion, members(Motion), "a motion such as softafm.Triangle")
    _check_times(motion)
    _check_compiled(motion)
    _check_heights(motion)
    _check_speeds(motion)
    _check_corners(motion)


def _check_times(motion: Any) -> None:
    breaks, landmarks = (np.asarray(getattr(motion, n)) for n in ("breaks", "landmarks"))
    ascending = breaks.ndim == 1 and breaks.size > 1 and breaks.dtype.kind == "f"
    if not (ascending and np.isfinite(breaks).all() and (np.diff(breaks) > 0).all()):
        _refuse(motion, "breaks", breaks, "an array of two times or more, s, ever later")
    inside = landmarks.ndim == 1 and np.all((landmarks >= breaks[0]) & (landmarks <= breaks[-1]))
    if not inside:
        _refuse(motion, "landmarks", landmarks, "an array of times between the breaks, s")
    if not (_is_number(motion.top_speed) and motion.top_speed > 0):
        _refuse(motion, "top_speed", motion.top_speed, "above 0 m/s and finite")


def _choose_times(motion: Any) -> np.ndarray:
    """Return some times of every piece, s."""
    breaks = np.asarray(motion.breaks)
    return (breaks[:-1, None] + np.diff(breaks)[:, None] * _PROBES).ravel()


def _check_compiled(motion: Any) -> None:
    from softafm.compiled.functions import HEIGHT, CompiledFunction

    pair = motion.compiled_height
    if not (isinstance(pair, tuple) and len(pair) == 2):
        _refuse(motion, "compiled_height", pair, "a compiled function and its parameters")
    function, parameters = pair
    if not (isinstance(function, CompiledFunction) and function.signature() == HEIGHT):
        must = "a function decorated with softafm.compiled.functions.compile_when_used(HEIGHT)"
        _refuse(motion, "compiled_height[0]", function, must)
    if not (isinstance(parameters, np.ndarray) and parameters.dtype == float):
        given = f", not of {parameters.dtype}" if isinstance(parameters, np.ndarray) else ""
        _refuse(motion, "compiled_height[1]", parameters, f"an array of floats{given}")


def _check_heights(motion: Any) -> None:
    """Try height, velocity and compiled height of a motion at some times of every piece."""
    time = _choose_times(motion)
    height, velocity = (np.asarray(f(time), float) for f in (motion.height, motion.velocity))
    for name, values in (("height", height), ("velocity", velocity)):
        if values.shape != time.shape or not np.isfinite(values).all():
            _refuse(motion, f"{name}(time)", values, f"{time.size} numbers at as many times")
    function, parameters = motion.compiled_height
    compiled = np.array([function(t, parameters) for t in time])
    if (worst := _farthest(compiled, height, _SAME_HEIGHT * np.ptp(height) + 1e-15)) is not None:
        must = f"the height there, {height[worst]:g} m"
        _refuse(motion, f"compiled_height at {time[worst]:g} s", float(compiled[worst]), must)
    moment = 1e-4 * min(np.diff(motion.breaks).min(), np.ptp(height) / motion.top_speed)
    slope = (motion.height(time + moment) - motion.height(time - moment)) / (2 * moment)
    if (worst := _farthest(velocity, slope, _SAME_VELOCITY * motion.top_speed)) is not None:
        must = f"the slope of the height there, {slope[worst]:g} m/s"
        _refuse(motion, f"velocity at {time[worst]:g} s", float(velocity[worst]), must)


def _check_speeds(motion: Any) -> None:
    """Refuse speeds that are stated as smaller than they are, of all time or of a piece."""
    breaks, time = motion.breaks, _choose_times(motion)
    speeds = np.abs(motion.velocity(time))
    if (worst := _farthest(speeds, 0, (1 + _SAME_VELOCITY) * motion.top_speed)) is not None:
        must = f"at least the speed at {time[worst]:g} s, {speeds[worst]:g} m/s"
        _refuse(motion, "top_speed", float(motion.top_speed), must)
    largest = speeds.reshape(-1, _PROBES.size).max(axis=1)
    for start, end, speed in zip(breaks[:-1], breaks[1:], largest, strict=True):
        stated = bound_speed(motion, start, end)
        if not _is_number(stated) or stated < (1 - _SAME_VELOCITY) * speed:
            must = f"a number, at least the speed between, {speed:g} m/s"
            _refuse(motion, f"top_speed_between({start:g}, {end:g})", stated, must)


def _check_corners(motion: Any) -> None:
    """Refuse a motion whose velocity jumps between two breaks: there a step must end."""
    breaks = np.asarray(motion.breaks)
    parts = np.concatenate([[_NEAR_ENDS], _PROBES, [1 - _NEAR_ENDS]])
    time = breaks[:-1, None] + np.diff(breaks)[:, None] * parts
    first, last = time[:, :-1].ravel(), time[:, 1:].ravel()
    before, after = motion.velocity(first), motion.velocity(last)
    largest = max(np.abs(before).max(), np.abs(after).max())
    for _ in range(_HALVINGS):
        middle = (first + last) / 2
        between = motion.velocity(middle)
        early = np.abs(between - before) > np.abs(after - between)
        first, before = np.where(early, first, middle), np.where(early, before, between)
        last, after = np.where(early, middle, last), np.where(early, between, after)
    if (worst := _farthest(before, after, _CORNER * largest)) is not None:
        jump = f"from {before[worst]:.3g} to {after[worst]:.3g} m/s"
        must = f"all corners, and at {last[worst]:.6g} s the velocity jumps {jump}"
        _refuse(motion, "breaks", breaks, must)


def _check_repetition(motion: Any) -> None:
    periods = getattr(motion, "periods", 1)
    if not (_is_number(periods) and periods >= 1 and periods == int(periods)):
        _refuse(motion, "periods", periods, "a whole number, at least 1")
    first, last = motion.height(np.asarray(motion.breaks)[[0, -1]])
    span = float(np.ptp(motion.height(_choose_times(motion))))
    if is_steady(motion) and abs(last - first) > _SAME_HEIGHT * span + 1e-15:
        must = f"False, as it begins at {first:g} m and ends at {last:g} m"
        _refuse(motion, "steady", motion.steady, must)


def _check_trigger(motion: Any) -> None:
    """Turn a motion with a trigger on trial, and refuse it if what comes of it goes another way."""
    force = find_setpoint(motion)
    if force is None:
        return
    if not (_is_number(force) and force > 0):
        _refuse(motion, "setpoint_force", force, "a number above 0 N, or None")
    if not callable(getattr(motion, "turned_at", None)):
        must = "a method, as there is a setpoint_force"
        _refuse(motion, "turned_at", getattr(motion, "turned_at", None), must)
    start, end = motion.breaks[:2]
    for time in start + (end - start) * np.array(_TURNS):
        try:
            _check_turned(motion, time, motion.turned_at(time))
        except ValueError as error:
            raise ValueError(f"motion.turned_at({time:g} s): {error}") from None


def _check_turned(motion: Any, time: float, turned: Any) -> None:
    if (force := find_setpoint(turned)) is not None:
        _refuse(motion, "setpoint_force", force, "None from there on")
    if type(turned) not in _KNOWN_TO_AGREE:
        _check_path(turned)
    start = motion.breaks[0]
    if np.abs(np.subtract(turned.breaks[:2], [start, time])).max() > _SAME_TIME * (time - start):
        must = f"[{start:g} {time:g}] s at first, as it turns there"
        _refuse(motion, "breaks", turned.breaks, must)
    at = start + (time - start) * _PROBES
    height, wanted = turned.height(at), motion.height(at)
    if (worst := _farthest(height, wanted, _SAME_HEIGHT * np.ptp(wanted) + 1e-15)) is not None:
        must = f"the height without a turn, {wanted[worst]:g} m"
        _refuse(motion, f"height at {at[worst]:g} s", float(height[worst]), must)


def _check_words(motion: Any) -> None:
    """Refuse a description and doubts of a form in which they could not be kept or shown."""
    description = getattr(motion, "description", {})
    try:
        text = dumps(description)
    except (TypeError, ValueError):
        text = ""
    if not text.startswith("{"):
        _refuse(motion, "description", description, "a dict of numbers, texts and lists by name")
    doubts = getattr(motion, "doubts", ())
    if not (isinstance(doubts, tuple | list) and all(isinstance(each, str) for each in doubts)):
        _refuse(motion, "doubts", doubts, "a tuple of texts")


def _farthest(values: Any, others: Any, allowed: float) -> int | None:
    """Return where values are farthest from others, if that is more than is allowed."""
    off = np.abs(values - others)
    worst = int(off.argmax())
    return worst if off[worst] > allowed else None
