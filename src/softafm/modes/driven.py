"""A driven lever: what drives it, which amplitudes it is asked for, and when it is no sine."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.validate import check_finite, check_positive, refuse_masked
from softafm.contact import Contact
from softafm.errors import AccuracyWarning, DivergedError
from softafm.instrument.cantilever import Cantilever
from softafm.instrument.motions import Sine
from softafm.instrument.oscillator import Drive
from softafm.solvers.energies import Energies
from softafm.units.quantities import write_quantity

_SINE = 0.02
"""Second harmonic over the first up to which the tip moves as a sine."""
_UNSTEADY, _UNBALANCED = 1.0, 10.0
"""Gaps of largest tension that a cycle may be off from the next, and tolerances that its work may
be amiss, over that of the drive, in a tap that counts."""


@dataclass(frozen=True)
class AmplitudeSweep:
    """What ``approach_curve`` takes besides contact and cantilever."""

    free_amplitude: float
    amplitude_ratio: Any
    drive_frequency: float | None = None


def ratios_of(values: ArrayLike) -> np.ndarray:
    """Return amplitude ratios as an array, or raise ValueError naming the one that is not."""
    refuse_masked("amplitude_ratio", values)
    try:
        if isinstance(values, str | bytes):
            raise TypeError
        array = np.atleast_1d(np.asarray(values, float))
    except (TypeError, ValueError):
        raise ValueError(f"amplitude_ratio = {values!r}: must be a list of numbers") from None
    if array.ndim != 1 or array.size == 0:
        raise ValueError(f"amplitude_ratio has shape {array.shape}: must be a list of numbers")
    for i, value in enumerate(array):
        if not 0 < check_finite(f"amplitude_ratio[{i}]", value, "") < 1:
            raise ValueError(f"amplitude_ratio[{i}] = {value:g}: must be above 0 and below 1")
    return array


def make_drive(
    cantilever: Cantilever, free_amplitude: float, drive_frequency: float | None = None
) -> tuple[Drive, float]:
    """Return the drive of a lever and its frequency, Hz; ValueError if it cannot be driven."""
    quality, resonance = cantilever.quality_factor, cantilever.frequency
    if quality is None or resonance is None:
        name = "quality_factor" if quality is None else "frequency"
        raise ValueError(f"cantilever.{name} = None: must be given for an approach curve")
    frequency = resonance
    if drive_frequency is not None:
        frequency = check_positive("drive_frequency", drive_frequency, "Hz")
    return Drive(cantilever.stiffness, quality, frequency / resonance, free_amplitude), frequency


def estimate_deepest_tap(
    contact: Contact, drive: Drive, frequency: float, amplitudes: np.ndarray
) -> Sine:
    """Estimate which tap of several amplitudes, m, indents most, before any run.

    A brief contact has V = −A F with the mean force F, at most half of what the drive can push
    against. F is that of Hertz, δ^1.5, over a parabola in time about the depth δ:
    F = δ² √(2R/A)/(4 c) with the relaxed compliance c. Attraction, which adds to δ, is left out.
    """
    amplitudes = np.asarray(amplitudes, float)
    mean_force = drive.strongest_push(amplitudes) / 2
    compliance = contact.body.compliance.relaxed
    squared = 4 * compliance * mean_force / np.sqrt(2 * contact.effective_radius / amplitudes)
    # A body that is harder or softer than a half-space is so at the contact found there.
    radius = np.sqrt(contact.effective_radius * np.sqrt(squared).max())
    depth = np.sqrt(squared / contact.body.hardening(float(radius)))
    deepest = depth.argmax()
    amplitude = float(amplitudes[deepest])
    return Sine(amplitude - float(depth[deepest]), amplitude, frequency, "steady")


def refuse_unsteady(warned: Iterable[AccuracyWarning]) -> None:
    """Raise DivergedError for a tap of which a solver warned that no cycle repeats another."""
    for warning in warned:
        if str(warning).startswith("no steady cycle") and warning.severity > _UNSTEADY:
            raise DivergedError(str(warning))


def refuse_gain(energies: Energies, drive: Drive, amplitude: float, tolerance: float) -> None:
    """Raise DivergedError for a tap whose work is amiss by what the drive would notice."""
    off = abs(energies.imbalance) / (np.pi * amplitude * drive.force)
    if off > _UNBALANCED * tolerance:
        lost = write_quantity(energies.imbalance, "J")
        raise DivergedError(f"energy is not balanced: {lost} of work went nowhere")


def doubt_sine(
    drive: Drive, amplitude: ArrayLike, virial: ArrayLike, dissipation: ArrayLike
) -> AccuracyWarning | None:
    """Return what to warn of where a lever would not move as a sine, or nothing.

    Amplitudes, m, virials and dissipations, J, of solutions: arrays of one shape, or numbers.
    """
    shares = np.atleast_1d(drive.second_harmonic(amplitude, virial, dissipation))
    worst = int(shares.argmax())
    if shares[worst] <= _SINE:
        return None
    off = write_quantity(float(shares[worst] * np.atleast_1d(amplitude)[worst]), "m")
    text = (
        f"the lever does not move as the sine that is assumed: its second harmonic is {off}, "
        f"{shares[worst]:.2g} of the amplitude, at quality_factor = {drive.quality_factor:g} and "
        f"{drive.detuning:.3g} times the resonance frequency; heights are off by about as much, "
        "and forces and energies with them; take a lever of a higher quality factor, a drive "
        "nearer to resonance or amplitudes nearer to the free one"
    )
    return AccuracyWarning(text, float(shares[worst]))
