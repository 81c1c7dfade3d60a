"""How the tip moves: prescribed height of its apex above the undeformed surface against time.

Besides its parameters a motion tells the solver where it is not smooth (``breaks``), which instants
matter (``landmarks``), how fast it gets (``top_speed``), and its height as a compiled function.
"""

from dataclasses import dataclass, replace
from typing import ClassVar, Literal

import numpy as np

from softafm._validate import finite, positive


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

    def __post_init__(self):
        object.__setattr__(self, "start", finite("start", self.start, "m"))
        object.__setattr__(self, "turn", finite("turn", self.turn, "m"))
        object.__setattr__(self, "speed", positive("speed", self.speed, "m/s"))
        object.__setattr__(self, "dwell", finite("dwell", self.dwell, "s"))
        if self.turn >= self.start:
            raise ValueError(f"turn = {self.turn:g} m: must be below start = {self.start:g} m")
        if self.dwell < 0:
            raise ValueError(f"dwell = {self.dwell:g} s: must be at least 0")
        if self.setpoint_force is not None:
            force = positive("setpoint_force", self.setpoint_force, "N")
            object.__setattr__(self, "setpoint_force", force)

    @classmethod
    def from_frequency(
        cls, mean_height: float, amplitude: float, frequency: float, **options
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
        mean = finite("mean_height", mean_height, "m")
        half = positive("amplitude", amplitude, "m")
        speed = 4 * half * positive("frequency", frequency, "Hz")
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

    @property
    def _middle(self) -> float:
        return float(self.breaks[1] + self.dwell / 2)

    def height(self, time):
        """Height at ``time`` (s), m."""
        away = np.abs(np.asarray(time, float) - self._middle) - self.dwell / 2
        return self.turn + self.speed * np.maximum(away, 0.0)

    def velocity(self, time):
        """Velocity at ``time`` (s), m/s; at a corner, that after it."""
        down, up = self.breaks[1], self.breaks[-2]
        t = np.asarray(time)
        return np.where(t < down, -self.speed, np.where(t < up, 0.0, self.speed))

    @property
    def compiled_height(self):
        """The height as a compiled function and its parameters (see ``softafm.compiled``)."""
        from softafm.kernels import triangle

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

    def __post_init__(self):
        object.__setattr__(self, "mean_height", finite("mean_height", self.mean_height, "m"))
        object.__setattr__(self, "amplitude", positive("amplitude", self.amplitude, "m"))
        object.__setattr__(self, "frequency", positive("frequency", self.frequency, "Hz"))
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

    def height(self, time):
        """Height at ``time`` (s), m."""
        phase = 2 * np.pi * self.frequency * np.asarray(time, float)
        return self.mean_height + self.amplitude * np.cos(phase)

    def velocity(self, time):
        """Velocity at ``time`` (s), m/s."""
        return -self.top_speed * np.sin(2 * np.pi * self.frequency * np.asarray(time, float))

    @property
    def compiled_height(self):
        """The height as a compiled function and its parameters (see ``softafm.compiled``)."""
        from softafm.kernels import sine

        return sine, np.array([self.mean_height, self.amplitude, self.frequency])


class Trajectory:
    """Any sampled motion, for example a measured one, interpolated by monotone cubics (PCHIP).

    Parameters
    ----------
    time
        Strictly increasing instants, s, shape (n,), n ≥ 2. The first may be any number.
    height
        Tip heights at these instants, m, shape (n,).

    Raises
    ------
    ValueError
        If the arrays differ in length, are too short, hold a NaN or an infinity, or the times do
        not increase.
    """

    kind: ClassVar[str] = "trajectory"

    def __init__(self, time, height):
        from scipy.interpolate import PchipInterpolator

        self.time, self.heights = as_numbers("time", time), as_numbers("height", height)
        if self.time.ndim != 1 or self.time.shape != self.heights.shape or self.time.size < 2:
            raise ValueError(
                f"time and height have shapes {self.time.shape} and {self.heights.shape}: must be "
                "one-dimensional, of equal length and at least 2 long"
            )
        for name, values, unit in (("time", self.time, "s"), ("height", self.heights, "m")):
            bad = np.flatnonzero(~np.isfinite(values))
            if bad.size:
                raise ValueError(
                    f"{name}[{bad[0]}] = {values[bad[0]]} {unit}: must be a finite number"
                )
        back = np.flatnonzero(np.diff(self.time) <= 0)
        if back.size:
            i = back[0] + 1
            raise ValueError(
                f"time[{i}] = {self.time[i]:g} s: must be later than time[{i - 1}] = "
                f"{self.time[i - 1]:g} s"
            )
        self.time.setflags(write=False)
        self.heights.setflags(write=False)
        self._interpolant = PchipInterpolator(self.time, self.heights)
        self._rate = self._interpolant.derivative()

    def __eq__(self, other):
        if not isinstance(other, Trajectory):
            return NotImplemented
        return np.array_equal(self.time, other.time) and np.array_equal(self.heights, other.heights)

    def __hash__(self):
        return hash((self.time.tobytes(), self.heights.tobytes()))

    def __repr__(self):
        return f"Trajectory({self.time.size} points, {self.time[0]:g} to {self.time[-1]:g} s)"

    @property
    def breaks(self) -> np.ndarray:
        """First and last time and those of the corners between them, s.

        A corner is a sample where the velocity changes by over a tenth of its largest magnitude.
        """
        velocity = np.diff(self.heights) / np.diff(self.time)
        corner = np.abs(np.diff(velocity)) > 0.1 * np.abs(velocity).max()
        return self.time[np.concatenate([[True], corner, [True]])]

    @property
    def landmarks(self) -> np.ndarray:
        """Times of the turning points inside the motion, s."""
        slope = np.sign(np.diff(self.heights))
        return self.time[1:-1][slope[1:] * slope[:-1] < 0]

    @property
    def top_speed(self) -> float:
        """Largest magnitude of the velocity between samples, m/s; a still tip counts as 1 fm/s."""
        fastest = np.max(np.abs(np.diff(self.heights) / np.diff(self.time)))
        return max(1.5 * float(fastest), 1e-15)

    def height(self, time):
        """Height at ``time`` (s), m."""
        return self._interpolant(time)

    def velocity(self, time):
        """Velocity at ``time`` (s), m/s."""
        return self._rate(time)

    @property
    def compiled_height(self):
        """The height as a compiled function and its parameters (see ``softafm.compiled``)."""
        from softafm.kernels import sampled

        return sampled, np.concatenate([self.time, self.heights, self._rate(self.time)])


def as_numbers(name: str, values) -> np.ndarray:
    """Return a copy of ``values`` as an array of floats, or raise ValueError naming them."""
    try:
        return np.array(values, float)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: must be a sequence of numbers") from None


def lowest_height(motion) -> float:
    """Return the lowest height of any motion, m; it is met at a break or a landmark."""
    return float(np.min(motion.height(np.concatenate([motion.breaks, motion.landmarks]))))
