"""A lever with inertia: its eigenmodes, and what drives them.

Each eigenmode obeys m q̈ + (mω/Q) q̇ + k q = F(t) + D(t), m = k/ω², with F the force on the tip. With
λ = −ω/2Q ± iω_d, ω_d = ω √(1 − 1/4Q²), what the tip's force does is exactly one complex memory,

    r = Im z/(m ω_d),     ż = λ z + F,

or, with Q ≤ ½, two real ones, r = (y₁ − y₂)/(m (λ₁ − λ₂)). What drives of frequencies ω_j do is a
sum of tones, known beforehand. In the limit of short periods this is a spring in balance.
"""

from cmath import sqrt
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf, pi
from typing import Any

import numpy as np

from softafm.instrument.cantilever import Eigenmode
from softafm.instrument.drive import Drive
from softafm.instrument.lever import Rigid

_CRITICAL = 1e-4
"""Least |λ₁ − λ₂|/2ω: closer ones, at Q = ½, are the same mode to 1e-8 and cancel each other."""
_SHAKEN = (1.5660, -0.8679, 0.5089, -0.3638, 0.2829, -0.2315)
"""What an acceleration of the base does to the eigenmodes of a uniform beam, in −m Z̈: ∫φ/∫φ², each
φ being 1 at the tip (φ and its frequencies: Rabe, Janser and Arnold 1996)."""


@dataclass(frozen=True)
class Resonator:
    """A lever of some eigenmodes, driven or not, for solvers: a ``Lever``.

    Parameters
    ----------
    modes
        The eigenmodes.
    drives
        What drives them; a drive by the base leaves out that the tip moves with the base.
    swinging
        Whether it begins as the drives have it swing far away, or at rest.
    """

    modes: tuple[Eigenmode, ...]
    drives: tuple[Drive, ...] = ()
    swinging: bool = False
    stiffness = inf

    def list_filters(self) -> list[tuple[complex, complex, int]]:
        """Return λ, 1/s, and w, m/(N s), of each filter with the number of its mode."""
        filters: list[tuple[complex, complex, int]] = []
        for i, mode in enumerate(self.modes):
            omega = 2 * pi * mode.frequency
            mass, fading = mode.stiffness / omega**2, -omega / (2 * mode.quality_factor)
            split = sqrt(fading**2 - omega**2)
            if abs(split) < _CRITICAL * omega:
                split = complex(0.0, _CRITICAL * omega)
            if split.imag > 0:
                filters.append((fading + split, -1j / (mass * split.imag), i))
            else:
                for sign in (1, -1):
                    filters.append((fading + sign * split, sign / (2 * mass * split), i))
        return filters

    def respond_at(self, omega: Any) -> np.ndarray:
        """Complex compliance of the modes at angular frequencies, m/N, shape (modes, ...)."""
        omega = np.asarray(omega, float)
        found = []
        for mode in self.modes:
            own = 2 * pi * mode.frequency
            ratio = omega / own
            bend = mode.stiffness * (1 - ratio**2 + 1j * ratio / mode.quality_factor)
            found.append(1 / bend)
        return np.array(found)

    def find_forces(self, drive: Drive) -> np.ndarray:
        """Amplitude of the force that a drive puts on each mode, N; shape (modes,)."""
        omega = 2 * pi * drive.frequency
        if drive.by == "tip":
            each = np.ones(len(self.modes))
        else:
            masses = [m.stiffness / (2 * pi * m.frequency) ** 2 for m in self.modes]
            each = omega**2 * np.array(masses) * _SHAKEN[: len(masses)]
        moved = abs(np.sum(self.respond_at(omega) * each))
        return each * drive.free_amplitude / moved

    def find_shaking(self, drive: Drive) -> float:
        """Amplitude of the base that a drive shakes, m, in phase with its force; 0 by the tip."""
        if drive.by == "tip":
            return 0.0
        first = self.modes[0]
        mass = first.stiffness / (2 * pi * first.frequency) ** 2
        force = float(self.find_forces(drive)[0])
        return force / (_SHAKEN[0] * mass * (2 * pi * drive.frequency) ** 2)

    def list_tones(self) -> np.ndarray:
        """Return ω, 1/s, C and S, m, and the number of the mode of every tone, shape (tones, 4)."""
        tones = []
        for drive in self.drives:
            omega = 2 * pi * drive.frequency
            swings = self.respond_at(omega) * self.find_forces(drive)
            tones += [(omega, each.real, each.imag, i) for i, each in enumerate(swings)]
        return np.array(tones).reshape(-1, 4)

    @cached_property
    def compiled_response(self) -> tuple[Any, Any, np.ndarray]:
        from softafm.instrument.compiled_oscillators import swing, swing_on

        filters, tones = self.list_filters(), self.list_tones()
        rows = [(a.real, a.imag, w.real, w.imag, i) for a, w, i in filters]
        head = [len(filters), len(tones)]
        return swing, swing_on, np.concatenate([head, np.ravel(rows), np.ravel(tones)])

    def at_start(self) -> np.ndarray:
        state = np.zeros(2 * len(self.list_filters()))
        if not self.swinging:
            tones = self.list_tones()
            for i in range(len(self.modes)):
                omega, c, s, _ = tones[tones[:, 3] == i].T
                self.push(state, i, -float(c.sum()), float(np.sum(omega * s)))
        return state

    def push(self, state: np.ndarray, mode: int, deflection: float, speed: float) -> None:
        """Add a deflection, m, and a speed, m/s, to those of a mode."""
        filters = self.list_filters()
        own = [j for j, (*_, i) in enumerate(filters) if i == mode]
        if len(own) == 1:
            rate, weight, _ = filters[own[0]]
            # Re(w z) = q and Re(w λ z) = v for x = w z.
            x = complex(deflection, (rate.real * deflection - speed) / rate.imag) / weight
            state[2 * own[0]] += x.real
            state[2 * own[0] + 1] += x.imag
            return
        (fast, weight, _), (slow, other, _) = (filters[j] for j in own)
        first = (speed - slow.real * deflection) / (fast.real - slow.real)
        state[2 * own[0]] += first / weight.real
        state[2 * own[1]] += (deflection - first) / other.real

    def deflection_at(self, time: float, state: np.ndarray) -> float:
        """Deflection at a time, s, of a lever in this state, m."""
        return float(self.measure(time, state)[0])

    def measure(self, time: float, state: np.ndarray) -> np.ndarray:
        """Deflection at a time, s, then those of the modes, m, and their speeds, m/s."""
        from softafm.instrument.compiled_oscillators import measure_motion

        motion = np.empty(1 + 2 * len(self.modes))
        measure_motion(time, self.compiled_response[2], state, motion)
        return motion

    def falling(self, creep_time: float) -> Rigid:
        """Return what holds the tip, which has inertia, while the surface falls."""
        return Rigid()


def shake(lever: Resonator, frequency: float, amplitude: float) -> Drive:
    """Return the drive that shakes the base of a lever by an amplitude, m, at a frequency, Hz."""
    unit = Drive(frequency, 1e-9, "base")
    return Drive(frequency, 1e-9 * amplitude / lever.find_shaking(unit), "base")


def check_drives(drives: Any, modes: Sequence[Eigenmode]) -> tuple[Drive, ...]:
    """Return one drive or several as a tuple; ValueError if one cannot drive these modes."""
    given = (drives,) if isinstance(drives, Drive) else drives
    if isinstance(given, str | bytes | dict) or not hasattr(given, "__iter__"):
        raise ValueError(f"drive = {given!r}: must be a softafm.Drive, or a list of them")
    found = tuple(given)
    if not found:
        raise ValueError("drive = []: must hold at least one softafm.Drive")
    fastest = modes[-1].frequency
    for i, drive in enumerate(found):
        name = "drive" if len(found) == 1 else f"drive[{i}]"
        if not isinstance(drive, Drive):
            raise ValueError(f"{name} = {drive!r}: must be a softafm.Drive")
        if drive.frequency > 2 * fastest:
            raise ValueError(
                f"{name}.frequency = {drive.frequency:g} Hz: must be at most twice the frequency "
                f"of the highest eigenmode, {fastest:g} Hz; add an Eigenmode to higher_modes"
            )
        if drive.by == "base" and len(modes) > len(_SHAKEN):
            raise ValueError(
                f"{name}.by = 'base': is known for up to {len(_SHAKEN)} eigenmodes, not "
                f"{len(modes)}; take by = 'tip'"
            )
    return found
