"""How the tip moves: prescribed height of its apex above the undeformed surface against time.

Besides its parameters a motion tells the solver where it is not smooth (``breaks``), which instants
matter (``landmarks``), how fast it gets (``top_speed``), and its height as a compiled function.
One whose speed varies may state how fast it gets for a while (``top_speed_between``).
"""

from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.validate import check_finite, check_positive
from softafm.instrument.trajectory import Trajectory

__all__ = ["Sine", "Trajectory", "Triangle", "find_lowest_height"]


@dataclass(frozen=True)
class Triangle:
    """Ramp from ``start`` down to ``turn`` and back up at constant speed.

    Parameters
    ----------
    start, turn
        First and lowest height, m; ``turn`` below ``start``, negative = below the flat surface.
    speed
        Magnitude of the velocity, m/s.
    dwell
        Time at the lowest height, s.
    setpoint_force
        Repulsion that turns the ramp when it is reached before ``turn``, N; None for no trigger.

    Raises
    ------
    ValueError
        If a value is not finite, the speed or the setpoint is not above zero, the dwell is below
        zero, or the turn is not below the start.
    """

    kind: ClassVar[str] = "triangle"
    start: float
    turn: float
    speed: float
    dwell: float = 0.0
    setpoint_force: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "start", check_finite("start", self.start, "m"))
        object.__setattr__(self, "turn", check_finite("turn", self.turn, "m"))
        object.__setattr__(self, "speed", check_positive("speed", self.speed, "m/s"))
        object.__setattr__(self, "dwell", check_finite("dwell", self.dwell, "s"))
        if self.turn >= self.start:
            raise ValueError(f"turn = {self.turn:g} m: must be below start = {self.start:g} m")
        if self.dwell < 0:
            raise ValueError(f"dwell = {self.dwell:g} s: must be at least 0")
        if self.setpoint_force is not None:
            force = check_positive("setpoint_force", self.setpoint_force, "N")
            object.__setattr__(self, "setpoint_force", force)

    @classmethod
    def from_frequency(
        cls, mean_height: float, amplitude: float, frequency: float, **options: Any
    ) -> "Triangle":
        """Build one period of a triangular wave, of speed 4·amplitude·frequency.

        Parameters
        ----------
        mean_height, amplitude
            Mean height and amplitude, m.
        frequency
            Frequency, Hz.
        options
            ``dwell`` and ``setpoint_force``.
        """
        mean = check_finite("mean_height", mean_height, "m")
        half = check_positive("amplitude", amplitude, "m")
        speed = 4 * half * check_positive("frequency", frequency, "Hz")
        return cls(mean + half, mean - half, speed, **options)

    def turned_at(self, time: float) -> "Triangle":
        """Return the ramp that turns at ``time`` (s) of the way down, and has no trigger left."""
        return replace(self, turn=self.start - self.speed * time, setpoint_force=None)

    @property
    def breaks(self) -> np.ndarray:
        """Times between which the motion is smooth, first and last included, s."""
        half = (self.start - self.turn) / self.speed
        turns = [half, half + self.dwell] if self.dwell else [half]
        return np.array([0.0, *turns, 2 * half + self.dwell])

    @property
    def landmarks(self) -> np.ndarray:
        """Times to be met by a step though the motion is smooth there, s: none."""
        return np.empty(0)

    @property
    def top_speed(self) -> float:
        """Largest magnitude of the velocity, m/s."""
        return self.speed

    def top_speed_between(self, start: float, end: float) -> float:
        """Largest magnitude of the velocity from ``start`` to ``end``, s; in m/s."""
        return 0.0 if self.breaks[1] <= start and end <= self.breaks[-2] else self.speed

    @property
    def _middle(self) -> float:
        return float(self.breaks[1] + self.dwell / 2)

    def height(self, time: ArrayLike) -> np.ndarray:
        """Height at ``time`` (s), m."""
        away = np.abs(np.asarray(time, float) - self._middle) - self.dwell / 2
        return self.turn + self.speed * np.maximum(away, 0.0)

    def velocity(self, time: ArrayLike) -> np.ndarray:
        """Velocity at ``time`` (s), m/s; at a corner, that after it."""
        down, up = self.breaks[1], self.breaks[-2]
        t = np.asarray(time)
        return np.where(t < down, -self.speed, np.where(t < up, 0.0, self.speed))

    @property
    def compiled_height(self) -> tuple[Any, np.ndarray]:
        """The height as a compiled function and its parameters (see ``softafm.compiled``)."""
        from softafm.instrument.compiled_motions import triangle

        return triangle, np.array([self.turn, self.speed, self._middle, self.dwell / 2])


@dataclass(frozen=True)
class Sine:
    """Oscillation h0 = mean_height + amplitude·cos(2πft), from the top.

    Parameters
    ----------
    mean_height, amplitude
        Mean height and amplitude, m.
    frequency
        Frequency f, Hz.
    cycles
        Number of periods, at least 1, or ``"steady"``: one period, after so many that the sample's
        memory ends it as it began.

    Raises
    ------
    ValueError
        If a value is not finite, or amplitude, frequency or cycles are not above zero.
    """

    kind: ClassVar[str] = "sine"
    mean_height: float
    amplitude: float
    frequency: float
    cycles: int | Literal["steady"] = 1

    def __post_init__(self) -> None:
        object.__setattr__(self, "mean_height", check_finite("mean_height", self.mean_height, "m"))
        object.__setattr__(self, "amplitude", check_positive("amplitude", self.amplitude, "m"))
        object.__setattr__(self, "frequency", check_positive("frequency", self.frequency, "Hz"))
        if isinstance(self.cycles, str) and self.cycles == "steady":
            return
        number = isinstance(self.cycles, int | float) and not isinstance(self.cycles, bool)
        if not number or self.cycles != self.cycles // 1 or self.cycles < 1:
            raise ValueError(
                f"cycles = {self.cycles!r}: must be a whole number, at least 1, or 'steady'"
            )
        object.__setattr__(self, "cycles", int(self.cycles))

    @property
    def steady(self) -> bool:
        """Whether the motion is repeated until the sample's memory is periodic."""
        return self.cycles == "steady"

    @property
    def periods(self) -> int:
        """Number of periods that are reported."""
        return 1 if self.cycles == "steady" else self.cycles

    @property
    def breaks(self) -> np.ndarray:
        """First and last time, s: a sine is smooth between them."""
        return np.array([0.0, self.periods / self.frequency])

    @property
    def landmarks(self) -> np.ndarray:
        """Times of the turning points inside the motion, s."""
        return np.arange(1, 2 * self.periods) / (2 * self.frequency)

    @property
    def top_speed(self) -> float:
        """Largest magnitude of the velocity, m/s."""
        return 2 * np.pi * self.frequency * self.amplitude

    def height(self, time: ArrayLike) -> np.ndarray:
        """Height at ``time`` (s), m."""
        phase = 2 * np.pi * self.frequency * np.asarray(time, float)
        return self.mean_height + self.amplitude * np.cos(phase)

    def velocity(self, time: ArrayLike) -> np.ndarray:
        """Velocity at ``time`` (s), m/s."""
        return -self.top_speed * np.sin(2 * np.pi * self.frequency * np.asarray(time, float))

    @property
    def compiled_height(self) -> tuple[Any, np.ndarray]:
        """The height as a compiled function and its parameters (see ``softafm.compiled``)."""
        from softafm.instrument.compiled_motions import sine

        return sine, np.array([self.mean_height, self.amplitude, self.frequency])


@dataclass(frozen=True)
class Still:
    """A height that does not change, m, for a duration, s: that of a base at rest."""

    kind: ClassVar[str] = "still"
    rest: float
    duration: float
    landmarks = np.empty(0)
    top_speed = 0.0

    @property
    def breaks(self) -> np.ndarray:
        """First and last time, s."""
        return np.array([0.0, self.duration])

    def height(self, time: ArrayLike) -> np.ndarray:
        """Height at ``time`` (s), m."""
        return np.full(np.shape(time), self.rest)

    def velocity(self, time: ArrayLike) -> np.ndarray:
        """Velocity at ``time`` (s), m/s."""
        return np.zeros(np.shape(time))

    @property
    def compiled_height(self) -> tuple[Any, np.ndarray]:
        """The height as a compiled function and its parameters (see ``softafm.compiled``)."""
        from softafm.instrument.compiled_motions import still

        return still, np.array([self.rest])


def find_lowest_height(motion: Any) -> float:
    """Return the lowest height of any motion, m; it is met at a break or a landmark."""
    return float(np.min(motion.height(np.concatenate([motion.breaks, motion.landmarks]))))
