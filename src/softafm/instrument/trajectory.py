"""A motion given by samples: straight between them, smooth through them, or fit to a record."""

from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.validate import check_positive, refuse_masked

_CORNER = 0.1
"""Change of velocity, over its largest magnitude, that makes a sample a corner."""
_RECORD = 100
"""Samples from which a path that is nearly all corners looks like a record with noise."""
_FAR = 2.0
"""Ratio of the noise and of what the path leaves, either way, from which one of them is wrong."""
_FEW_CORNERS, _MANY_KNOTS = 3, 10
"""Corners, and knots per corner, from which a path looks as if it followed noise."""
_INVISIBLE = 1e-12
"""Distance that no instrument tells from none, m."""
_CALM = 10.0
"""A calm stretch lasts so many times as long as the whole range takes at the top speed."""


class Trajectory:
    """Any sampled motion: straight lines between the samples, or monotone cubics through them.

    Parameters
    ----------
    time
        Strictly increasing instants, s, shape (n,), n ≥ 2. The first may be any number.
    height
        Tip heights at these instants, m, shape (n,).
    smooth
        Whether monotone cubics (PCHIP; F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5,
        300, 1984) take the place of straight lines. They flatten at every turning point, so a ramp
        given by its corners needs straight lines; samples of a smooth motion may be fewer with
        cubics. A record with noise needs ``from_measurement``.

    Raises
    ------
    ValueError
        If the arrays differ in length, are too short, hold a NaN or an infinity, or the times do
        not increase.
    """

    kind: ClassVar[str] = "trajectory"
    smooth: bool = False
    noise: float | None = None
    """Standard deviation of the noise of a measured path, m; None for samples taken as they are."""
    _noise_is_estimated: bool = False

    def __init__(self, time: ArrayLike, height: ArrayLike, smooth: bool = False) -> None:
        if not isinstance(smooth, bool):
            raise ValueError(f"smooth = {smooth!r}: must be True or False")
        self.time, self.heights = _check_points(time, height)
        self.smooth = smooth
        velocity = np.diff(self.heights) / np.diff(self.time)
        corner = np.abs(np.diff(velocity)) > _CORNER * np.abs(velocity).max()
        if smooth:
            from scipy.interpolate import PchipInterpolator

            cubics = PchipInterpolator(self.time, self.heights).c
        else:
            cubics = np.zeros((4, velocity.size))
            cubics[2:] = velocity, self.heights[:-1]
        self._follow(self.time, cubics, self.time[1:-1][corner])

    @classmethod
    def from_measurement(
        cls, time: ArrayLike, height: ArrayLike, noise: float | None = None
    ) -> "Trajectory":
        """Draw the simplest path that a record with noise allows, and keep its corners sharp.

        A corner is where one polynomial fits the samples on both sides worse, beyond noise, than
        one for each side. Between corners runs a straight line, or a cubic spline of least squares
        with as many knots as Schwarz' criterion justifies; neighbours meet where they cross.

        Parameters
        ----------
        time
            Strictly increasing instants, s, shape (n,), n ≥ 20; unevenly spaced or not.
        height
            Heights recorded at these instants, m, shape (n,).
        noise
            Standard deviation of the height of one sample, m; estimated if None, from what a cubic
            through its four neighbours leaves of each. State all of it where the noise of
            neighbours is correlated, as hum is, or behind a low-pass filter: the estimate is then
            too small, and slow hum may pass for motion.

        Raises
        ------
        ValueError
            As ``Trajectory``; if there are fewer than 20 samples, or the noise is not above zero.

        Notes
        -----
        If the path leaves noise whose neighbours are correlated, paths for larger noise are drawn,
        too, and what they leave is judged as autoregressive noise. ``doubts`` tells where the noise
        is far from what the path leaves, and where the path looks like hum.

        One-sided fits against one fit, at growing distances: C. R. Loader, Ann. Statist. 24, 1667
        (1996). The criterion: G. Schwarz, Ann. Statist. 6, 461 (1978). Noise from local residuals:
        T. Gasser, L. Sroka and C. Jennen-Steinmetz, Biometrika 73, 625 (1986), here their median.
        """
        from softafm.instrument.smoothing import FEWEST, fit_path

        noise = None if noise is None else check_positive("noise", noise, "m")
        path = cls.__new__(cls)
        path.time, path.heights = _check_points(time, height)
        if path.time.size < FEWEST:
            raise ValueError(
                f"time has {path.time.size} entries: a measurement must have at least {FEWEST}; "
                "Trajectory takes few samples as they are"
            )
        fit = fit_path(path.time, path.heights, noise)
        path.noise, path._noise_is_estimated = fit.noise, noise is None
        path._follow(fit.knots, fit.cubics, fit.corners)
        return path

    def _follow(self, knots: np.ndarray, cubics: np.ndarray, corners: np.ndarray) -> None:
        """Take for the path cubics between n knots: shape (4, n − 1), highest power first."""
        from scipy.interpolate import PPoly

        self._path = PPoly(cubics, knots)
        self._rate = self._path.derivative()
        self.corners = _make_read_only(corners)
        bends = _find_roots(3 * cubics[0], 2 * cubics[1], cubics[2])
        bends = (bends + knots[:-1])[(bends > 0) & (bends < np.diff(knots))]
        points = np.union1d(knots, bends)
        turns = points[_find_turns(self._path(points), self.noise or 0.0)]
        self._speeds = _find_top_speeds(cubics, np.diff(knots))
        calm = _find_calm_stretches(knots, self._speeds, float(np.ptp(self._path(points))))
        self.landmarks = _make_read_only(np.setdiff1d(np.union1d(turns, calm), knots[[0, -1]]))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Trajectory):
            return NotImplemented
        return (
            (self.smooth, self.noise) == (other.smooth, other.noise)
            and np.array_equal(self.time, other.time)
            and np.array_equal(self.heights, other.heights)
        )

    def __hash__(self) -> int:
        return hash((self.smooth, self.noise, self.time.tobytes(), self.heights.tobytes()))

    def __repr__(self) -> str:
        noise = "" if self.noise is None else f", noise {self.noise:.2g} m"
        smooth = ", smooth" if self.smooth else ""
        span = f"{self.time[0]:g} to {self.time[-1]:g} s"
        return f"Trajectory({self.time.size} points, {span}{smooth}{noise})"

    @property
    def description(self) -> dict[str, Any]:
        """What results keep: the samples, and how the path was drawn."""
        path = {"smooth": self.smooth} if self.noise is None else {"noise": self.noise}
        return {"time": self.time.tolist(), "height": self.heights.tolist(), **path}

    @property
    def breaks(self) -> np.ndarray:
        """First and last time and those of the corners between them, s.

        A sample is a corner if the velocity changes there by over a tenth of its largest magnitude.
        """
        return np.concatenate([self.time[:1], self.corners, self.time[-1:]])

    @property
    def doubts(self) -> tuple[str, ...]:
        """What a run should warn of before it starts."""
        if self.noise is not None:
            return self._doubts_of_noise(self.noise)
        if self.time.size < _RECORD or self.corners.size < self.time.size / 2:
            return ()
        return (
            f"{self.corners.size} of {self.time.size} samples of the motion are corners, which "
            "costs some twenty steps each and takes noise for motion: if they were measured, use "
            "Trajectory.from_measurement (measured = true in a file)",
        )

    def _doubts_of_noise(self, noise: float) -> tuple[str, ...]:
        misfit = float(np.sqrt(np.mean((self.height(self.time) - self.heights) ** 2)))
        found = (
            f"the path leaves its {self.time.size} samples by {misfit:.2g} m, root mean square, "
            f"where their noise is taken to be {noise:.2g} m: "
        )
        if misfit > _FAR * noise + _INVISIBLE:
            return (
                f"{found}state noise = {misfit:.2g} m if that of neighbours is correlated, as hum "
                "is; else remove outliers, or give steps by their corners to Trajectory",
            )
        if noise > _FAR * misfit + _INVISIBLE:
            where = "in place of the estimate" if self._noise_is_estimated else "or leave it out"
            return (f"{found}so large a noise hides motion; state noise = {misfit:.2g} m, {where}",)
        corners, knots = self.corners.size, self._path.x.size
        if corners >= _FEW_CORNERS and knots > _MANY_KNOTS * corners:
            return (
                f"the path has {corners} corners and {knots - corners} bends between them, as "
                "one that follows hum: if there is hum, state the noise with that in it",
            )
        return ()

    @property
    def top_speed(self) -> float:
        """Largest magnitude of the velocity, m/s; a still tip counts as 1 fm/s."""
        return max(float(self._speeds.max()), 1e-15)

    def top_speed_between(self, start: float, end: float) -> float:
        """Largest magnitude of the velocity from ``start`` to ``end``, s; in m/s."""
        first = np.searchsorted(self._path.x, start, side="right") - 1
        last = np.searchsorted(self._path.x, end, side="left")
        return float(self._speeds[first:last].max())

    def height(self, time: ArrayLike) -> np.ndarray:
        """Height at ``time`` (s), m."""
        return self._path(time)

    def velocity(self, time: ArrayLike) -> np.ndarray:
        """Velocity at ``time`` (s), m/s; at a corner, that after it."""
        return self._rate(time)

    @property
    def compiled_height(self) -> tuple[Any, np.ndarray]:
        """The height as a compiled function and its parameters (see ``softafm.compiled``)."""
        from softafm.instrument.compiled_motions import sampled

        return sampled, np.concatenate([self._path.x, self._path.c.ravel()])


def _check_points(time: ArrayLike, height: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Return copies of samples that make a motion, read-only, or raise ValueError."""
    time, height = check_numbers("time", time), check_numbers("height", height)
    if time.ndim != 1 or time.shape != height.shape or time.size < 2:
        raise ValueError(
            f"time and height have shapes {time.shape} and {height.shape}: must be "
            "one-dimensional, of equal length and at least 2 long"
        )
    for name, values, unit in (("time", time, "s"), ("height", height, "m")):
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            raise ValueError(f"{name}[{bad[0]}] = {values[bad[0]]} {unit}: must be a finite number")
    back = np.flatnonzero(np.diff(time) <= 0)
    if back.size:
        i = back[0] + 1
        raise ValueError(
            f"time[{i}] = {time[i]:g} s: must be later than time[{i - 1}] = {time[i - 1]:g} s"
        )
    return _make_read_only(time), _make_read_only(height)


def check_numbers(name: str, values: ArrayLike) -> np.ndarray:
    """Return a copy of ``values`` as an array of floats, or raise ValueError naming them."""
    refuse_masked(name, values)
    try:
        return np.array(values, float)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: must be a sequence of numbers") from None


def _make_read_only(values: np.ndarray) -> np.ndarray:
    values.setflags(write=False)
    return values


def _find_roots(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Return the real roots of a x² + b x + c, shape (2, n); NaN where there is none."""
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        q = -0.5 * (b + np.copysign(np.sqrt(b * b - 4 * a * c), b))
        return np.array([q / a, c / q])


def _find_top_speeds(cubics: np.ndarray, duration: np.ndarray) -> np.ndarray:
    """Return the largest magnitude of the velocity of each cubic over its duration (s), m/s."""
    cube, square, start, _ = cubics
    speed = np.maximum(abs(start), abs(start + duration * (2 * square + 3 * cube * duration)))
    bent = np.flatnonzero((cube * square < 0) & (abs(square) < 3 * abs(cube) * duration))
    vertex = start[bent] - square[bent] ** 2 / (3 * cube[bent])
    speed[bent] = np.maximum(speed[bent], abs(vertex))
    return speed


def _find_turns(height: np.ndarray, reversal: float) -> list[int]:
    """Return the indices of the extremes between which heights change by more than ``reversal``.

    The lowest of all is among them.
    """
    found, extreme, falling = [int(np.argmin(height))], 0, None
    for i, now in enumerate(height):
        change = now - height[extreme]
        if falling is None and abs(change) > reversal:
            extreme, falling = i, bool(change < 0)
        elif falling is not None and change != 0 and (change < 0) == falling:
            extreme = i
        elif falling is not None and abs(change) > reversal:
            found.append(extreme)
            extreme, falling = i, not falling
    return sorted(set(found))


def _find_calm_stretches(knots: np.ndarray, speeds: np.ndarray, travel: float) -> np.ndarray:
    """Return the times (s) at which stretches of slow motion begin and end.

    A solver that takes no step longer than a part of the way at the fastest speed to come is not
    to pass a long rest at the speed of what follows. A stretch counts that is ten times slower, for
    more than ten times the time, than it takes to travel the whole range at the faster speed; and
    so on within it.
    """
    found: list[np.ndarray] = []
    fast = float(speeds.max())
    while fast > 0:
        slow = np.concatenate([[False], speeds < fast / 10, [False]])
        edges = np.flatnonzero(np.diff(slow.astype(int)))
        starts, ends = knots[edges[::2]], knots[edges[1::2]]
        long = (ends - starts) * fast > _CALM * travel
        found += [starts[long], ends[long]]
        slower = speeds[speeds < fast / 10]
        fast = float(slower.max()) if slower.size else 0.0
    return np.unique(np.concatenate(found)) if found else np.empty(0)
