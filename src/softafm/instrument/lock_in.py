"""What a lock-in amplifier finds of a lever in each cycle, from what it remembers and the force.

Over a cycle of length T, with F̂ = ∫ F e^(−iωt) dt, a filter ż = λz + F has exactly

    ∫ z e^(−iωt) dt = ([z e^(−iωt)] − F̂)/(λ − iω),

so that the spectrum of the force and the states at both ends tell amplitude and phase of every
eigenmode at every frequency.
"""

import numpy as np

from softafm.instrument.resonator import Resonator


def integrate_modes(
    lever: Resonator, times: np.ndarray, states: np.ndarray, omega: float, force: np.ndarray
) -> np.ndarray:
    """Return ∫ q e^(−iωt) dt of the modes over each cycle, m s, complex, shape (cycles, modes).

    ``times`` (cycles + 1,), s, and ``states`` (cycles + 1, s) are those between cycles, ``force``
    (cycles,) is F̂ of each, N s.
    """
    found = np.zeros((times.size - 1, len(lever.modes)), complex)
    turned = np.exp(-1j * omega * times)
    for j, (rate, weight, mode) in enumerate(lever.list_filters()):
        z = states[:, 2 * j] + 1j * states[:, 2 * j + 1]
        for w, a, y in ((weight, rate, z), (np.conj(weight), np.conj(rate), np.conj(z))):
            found[:, mode] += 0.5 * w * (np.diff(y * turned) - force) / (a - 1j * omega)
    for own, c, s, mode in lever.list_tones():
        for swing, at in ((c + 1j * s, own - omega), (c - 1j * s, -own - omega)):
            found[:, int(mode)] += 0.5 * swing * _integrate_turn(times, at)
    return found


def demodulate(integrals: np.ndarray, times: np.ndarray, omega: float) -> np.ndarray:
    """Return the complex amplitudes A of Re(A e^(iωt)) with these ∫ q e^(−iωt) dt, (cycles, ...).

    Cycles need not be whole periods of this frequency.
    """
    length = np.diff(times)[:, None]
    twice = _integrate_turn(times, -2 * omega)[:, None]
    mirrored = integrals * length - np.conj(integrals) * twice
    return 2 * mirrored / (length**2 - np.abs(twice) ** 2)


def measure_modes(lever: Resonator, times: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Return the deflection of each mode between cycles, m, shape (cycles + 1, modes)."""
    found = np.zeros((times.size, len(lever.modes)))
    for j, (_, weight, mode) in enumerate(lever.list_filters()):
        found[:, mode] += (weight * (states[:, 2 * j] + 1j * states[:, 2 * j + 1])).real
    for omega, c, s, mode in lever.list_tones():
        found[:, int(mode)] += c * np.cos(omega * times) - s * np.sin(omega * times)
    return found


def _integrate_turn(times: np.ndarray, omega: float) -> np.ndarray:
    """Return ∫ e^(iωt) dt over each cycle, s."""
    length = np.diff(times)
    middle = 0.5 * (times[1:] + times[:-1])
    return length * np.sinc(omega * length / (2 * np.pi)) * np.exp(1j * omega * middle)
