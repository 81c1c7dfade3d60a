"""What a motion is: what modes and solvers ask of one."""

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

if TYPE_CHECKING:
    from softafm.compiled.functions import CompiledFunction


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
        """Whether it is repeated until the sample's memory is periodic; it ends where it began."""

    @property
    def periods(self) -> int:
        """Number of periods between the first and the last break; nothing is repeated for it."""


class Turning(Protocol):
    """Power of a motion: a force may turn its first ramp, which ends at the second break."""

    @property
    def setpoint_force(self) -> float | None:
        """Repulsion that turns it before the second break, N; None for no trigger."""

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
