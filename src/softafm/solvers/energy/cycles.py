"""What is reported of each cycle of a lever with inertia, from what was watched."""

import numpy as np

from softafm.instrument.lock_in import demodulate, integrate_modes, measure_modes
from softafm.instrument.resonator import Resonator
from softafm.solvers.energy.watch import (
    BASE_WORK,
    DAMPING,
    DEFLECTION,
    FORCE,
    JUMPED,
    LARGEST,
    LOST,
    SMALLEST,
    VIRIAL,
    WORK,
)

HARMONICS = 10
"""Harmonics of the first drive that are observed."""


def observe_cycles(
    lever: Resonator, times: np.ndarray, states: np.ndarray, found: np.ndarray
) -> dict[str, np.ndarray]:
    """Return the observables of all cycles by name, the first dimension the cycle.

    ``times`` (cycles + 1,), s, and ``states`` of the lever (cycles + 1, s) are those between
    cycles, and the rows of ``found`` the sums of ``softafm.solvers.energy.watch``.
    """
    modes = len(lever.modes)
    spectrum = found[:, DAMPING + modes :]
    force = spectrum[:, ::2] + 1j * spectrum[:, 1::2]
    omegas = [2 * np.pi * drive.frequency for drive in lever.drives]
    drive_work = found[:, BASE_WORK].copy()
    at_drives = []
    between = measure_modes(lever, times, states)
    for j, (drive, omega) in enumerate(zip(lever.drives, omegas, strict=True)):
        column = 0 if j == 0 else HARMONICS + j - 1
        integrals = integrate_modes(lever, times, states, omega, force[:, column])
        at_drives.append(demodulate(integrals, times, omega))
        pushed = np.diff(np.cos(omega * times)[:, None] * between, axis=0)
        drive_work += (pushed - omega * integrals.imag) @ lever.find_forces(drive)
    swings = np.empty((len(found), modes), complex)
    for i, mode in enumerate(lever.modes):
        nearest = min(
            range(len(omegas)), key=lambda j: abs(lever.drives[j].frequency / mode.frequency - 1)
        )
        own = nearest if _is_driven(lever, nearest, i) else 0
        turned = np.exp(-1j * np.angle(lever.find_forces(lever.drives[own])[i]))
        swings[:, i] = at_drives[own][:, i] * turned
    harmonics = [
        integrate_modes(lever, times, states, n * omegas[0], force[:, n - 1]).sum(axis=1)
        for n in range(1, HARMONICS + 1)
    ]
    length = np.diff(times)
    phase = -np.degrees(np.angle(swings))
    return {
        "amplitude": np.abs(swings),
        "phase": phase,
        "harmonic_amplitude": 2 * np.abs(np.transpose(harmonics)) / length[:, None],
        "virial": (found[:, VIRIAL] - found[:, DEFLECTION] * found[:, FORCE] / length) / length,
        "dissipation": found[:, WORK] + found[:, BASE_WORK],
        "drive_work": drive_work,
        "damping": found[:, DAMPING : DAMPING + modes].sum(axis=1),
        "viscous_loss": found[:, LOST],
        "jump_loss": found[:, JUMPED],
        "force_max": found[:, LARGEST],
        "force_min": found[:, SMALLEST],
        "force_mean": found[:, FORCE] / length,
        "mean_deflection": found[:, DEFLECTION] / length,
    }


def _is_driven(lever: Resonator, drive: int, mode: int) -> bool:
    """Whether a mode is the nearest one to the frequency of a drive."""
    frequency = lever.drives[drive].frequency
    near = [abs(frequency / each.frequency - 1) for each in lever.modes]
    return near[mode] == min(near)
