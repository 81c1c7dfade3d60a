"""What a motion is: what modes and solvers ask of one, and whether an object keeps to it."""

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from softafm.checks.kinds import members, refuse_incomplete

if TYPE_CHECKING:
    from softafm.compiled.functions import CompiledFunction

_PROBES = np.linspace(0.013, 0.987, 24)
"""Parts of every smooth piece at which a motion is tried; none of a regular pattern."""
_SAME_HEIGHT, _SAME_VELOCITY = 1e-6, 1e-3


class Motion(Protocol):
    """Height of the apex above the undeformed surface against time, of the tip or the unbent lever.

    A class of one's own needs these and inherits nothing. It may have the powers of ``Repeating``,
    ``Turning``, ``Resting`` and ``Doubtful`` besides, and a ``description``: its parameters by
    name, kept with results. A dataclass is described by its fields.
    """

    @property
    def kind(self) -> str:
        """Its name."""

    @property
    def breaks(self) -> np.ndarray:
        """Times between which the motion is smooth, first and last included, s."""

    @property
    def landmarks(self) -> np.ndarray:
        """Further times that a step must meet, such as turning points, s; perhaps none."""

    @property
    def top_speed(self) -> float:
        """Largest magnitude of the velocity, m/s."""

    def height(self, time: Any) -> Any:
        """Height at ``time`` (s, an array or a number), m."""

    def velocity(self, time: Any) -> Any:
        """Velocity at ``time`` (s, an array or a number), m/s; at a corner, that after it."""

    @property
    def compiled_height(self) -> tuple["CompiledFunction", np.ndarray]:
        """A function decorated with ``compile_when_used(HEIGHT)``, and its parameters (n,)."""


class Repeating(Protocol):
    """Power of a motion: it consists of periods."""

    @property
    def steady(self) -> bool:
        """Whether it is repeated until the sample's memory is periodic."""

    @property
    def periods(self) -> int:
        """Number of periods that are reported."""


class Turning(Protocol):
    """Power of a motion: a force may turn its first ramp, which ends at the second break."""

    @property
    def setpoint_force(self) -> float | None:
        """Repulsion that turns it, N; None for no trigger."""

    def turned_at(self, time: float) -> Motion:
        """Return the motion that turns at ``time``, s, and has no trigger left."""


class Resting(Protocol):
    """Power of a motion: it knows how fast it gets for a while, so that rests take few steps."""

    def top_speed_between(self, start: float, end: float) -> float:
        """Largest magnitude of the velocity from ``start`` to ``end``, s; in m/s."""


class Doubtful(Protocol):
    """Power of a motion: it may not be what the user thinks."""

    @property
    def doubts(self) -> tuple[str, ...]:
        """Lines to warn of before a run."""


def is_steady(motion: Motion) -> bool:
    """Whether a motion is repeated until the sample's memory is periodic."""
    return bool(getattr(motion, "steady", False))


def count_periods(motion: Motion) -> int:
    """Return the number of periods of a motion, 1 of one that has none."""
    return int(getattr(motion, "periods", 1))


def find_setpoint(motion: Motion) -> float | None:
    """Return the force that turns a motion, N, or None."""
    return getattr(motion, "setpoint_force", None)


def bound_speed(motion: Motion, start: float, end: float) -> float:
    """Return the largest speed from ``start`` to ``end``, m/s; that of all time if not known."""
    between = getattr(motion, "top_speed_between", None)
    return motion.top_speed if between is None else between(start, end)


def list_doubts(motion: Motion) -> tuple[str, ...]:
    """Return what a motion wants to be warned of."""
    return tuple(getattr(motion, "doubts", ()))


def check_motion(motion: Any) -> None:
    """Raise ValueError if an object is no motion, or its height, speed and times do not agree.

    A solver takes steps by what a motion states, and reads its height from the compiled function
    alone: where these disagree, a run is wrong without a sign. The motions of this package are
    known to agree.
    """
    refuse_incomplete("motion", motion, members(Motion), "a motion such as softafm.Triangle")
    if not type(motion).__module__.startswith("softafm."):
        _check_times(motion)
        _check_heights(motion)


def _refuse(motion: Any, name: str, value: Any, must: str) -> None:
    shown = f"{value:g}" if isinstance(value, float) else str(value)
    raise ValueError(f"motion.{name} = {shown}: of the motion '{motion.kind}' must be {must}")


def _check_times(motion: Any) -> None:
    breaks, landmarks = (np.asarray(getattr(motion, n)) for n in ("breaks", "landmarks"))
    ascending = breaks.ndim == 1 and breaks.size > 1 and breaks.dtype.kind == "f"
    if not (ascending and np.isfinite(breaks).all() and (np.diff(breaks) > 0).all()):
        _refuse(motion, "breaks", breaks, "an array of two times or more, s, ever later")
    inside = landmarks.ndim == 1 and np.all((landmarks >= breaks[0]) & (landmarks <= breaks[-1]))
    if not inside:
        _refuse(motion, "landmarks", landmarks, "an array of times between the breaks, s")
    if not (np.isfinite(motion.top_speed) and motion.top_speed > 0):
        _refuse(motion, "top_speed", motion.top_speed, "above 0 m/s and finite")


def _check_heights(motion: Any) -> None:
    """Try height, velocity and compiled height of a motion at some times of every piece."""
    from softafm.compiled.functions import HEIGHT, CompiledFunction

    breaks = np.asarray(motion.breaks)
    time = (breaks[:-1, None] + np.diff(breaks)[:, None] * _PROBES).ravel()
    height, velocity = (np.asarray(f(time), float) for f in (motion.height, motion.velocity))
    for name, values in (("height", height), ("velocity", velocity)):
        if values.shape != time.shape or not np.isfinite(values).all():
            _refuse(motion, f"{name}(time)", values, f"{time.size} numbers at as many times")
    function, parameters = motion.compiled_height
    if not (isinstance(function, CompiledFunction) and function.signature() == HEIGHT):
        must = "a function decorated with softafm.compiled.functions.compile_when_used(HEIGHT)"
        _refuse(motion, "compiled_height[0]", function, must)
    if not (isinstance(parameters, np.ndarray) and parameters.dtype == float):
        _refuse(motion, "compiled_height[1]", parameters, "an array of floats")
    compiled = np.array([function(t, parameters) for t in time])
    if (worst := _farthest(compiled, height, _SAME_HEIGHT * np.ptp(height) + 1e-15)) is not None:
        must = f"the height there, {height[worst]:g} m"
        _refuse(motion, f"compiled_height at {time[worst]:g} s", float(compiled[worst]), must)
    if (
        worst := _farthest(np.abs(velocity), 0, (1 + _SAME_VELOCITY) * motion.top_speed)
    ) is not None:
        must = f"at least the speed at {time[worst]:g} s, {abs(velocity[worst]):g} m/s"
        _refuse(motion, "top_speed", float(motion.top_speed), must)
    moment = 1e-4 * min(np.diff(breaks).min(), np.ptp(height) / motion.top_speed)
    slope = (motion.height(time + moment) - motion.height(time - moment)) / (2 * moment)
    if (worst := _farthest(velocity, slope, _SAME_VELOCITY * motion.top_speed)) is not None:
        must = f"the slope of the height there, {slope[worst]:g} m/s"
        _refuse(motion, f"velocity at {time[worst]:g} s", float(velocity[worst]), must)


def _farthest(values: Any, others: Any, allowed: float) -> int | None:
    """Return where values are farthest from others, if that is more than is allowed."""
    off = np.abs(values - others)
    worst = int(off.argmax())
    return worst if off[worst] > allowed else None
