"""Measured storage and loss moduli: read, fit by a Prony series, and compare with a sample."""

from math import ceil, log10, pi
from pathlib import Path

import numpy as np

from softafm._validate import finite
from softafm.measured import read_columns
from softafm.rheology.lists import samples
from softafm.units import FREQUENCY, MODULUS

NOISE = 0.05
"""How far a storage modulus may fall below an earlier one and pass for measurement noise."""
NEGLIGIBLE = 1e-4
"""A term that adds less to every modulus, relatively, is left out."""


def read_dma(path: str | Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Read frequency (Hz), storage and loss modulus (Pa) from a CSV file.

    Parameters
    ----------
    path
        CSV file whose header names the units, for example
        ``frequency (Hz),storage (MPa),loss (MPa)``; other columns are ignored.

    Raises
    ------
    ValueError
        If the file cannot be read, lacks a column or a unit, or holds what no passive solid does.
    """
    columns = {"frequency": FREQUENCY, "storage": MODULUS, "loss": MODULUS}
    example = "frequency (Hz),storage (MPa),loss (MPa)"
    frequency, storage, loss = read_columns(path, columns, example)
    return checked(frequency, storage, loss)


def fit_prony(
    frequency, storage, loss, per_decade: float = 2
) -> tuple[float, tuple[float, ...], tuple[float, ...]]:
    """Fit E_inf, moduli and relaxation times to measured moduli; see ``GeneralizedMaxwell``."""
    from scipy.optimize import nnls

    frequency, storage, loss = checked(frequency, storage, loss)
    per_decade = finite("per_decade", per_decade, "times")
    if not 0.5 <= per_decade <= 10:
        raise ValueError(f"per_decade = {per_decade:g} times: must be between 0.5 and 10")
    angular = 2 * pi * frequency
    decades = 2 + log10(angular[-1] / angular[0])
    times = np.geomspace(0.1 / angular[-1], 10 / angular[0], ceil(per_decade * decades) + 1)
    s = 1j * angular[:, None] * times
    terms = np.hstack([np.ones((angular.size, 1)), s / (1 + s)])
    rows = np.vstack([terms.real / storage[:, None], terms.imag / loss[:, None]])

    kept = np.arange(terms.shape[1])
    for _ in range(2):
        moduli, _ = nnls(rows[:, kept], np.ones(rows.shape[0]))
        kept = kept[np.max(rows[:, kept] * moduli, axis=0) > NEGLIGIBLE]
    moduli = np.zeros(terms.shape[1])
    moduli[kept], _ = nnls(rows[:, kept], np.ones(rows.shape[0]))
    used = np.flatnonzero(moduli[1:])
    return float(moduli[0]), tuple(moduli[1:][used].tolist()), tuple(times[used].tolist())


def dma_misfit(sample, frequency, storage, loss) -> tuple[float, float]:
    """Return the largest and the root mean square relative misfit of a sample to measured moduli.

    Storage and loss modulus (Pa, at ``frequency`` in Hz) are each compared with their own value.
    """
    frequency, storage, loss = checked(frequency, storage, loss)
    misfit = np.concatenate(
        [sample.storage_modulus(frequency) / storage - 1, sample.loss_modulus(frequency) / loss - 1]
    )
    return float(np.max(np.abs(misfit))), float(np.sqrt(np.mean(misfit**2)))


def checked(frequency, storage, loss) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return measured moduli as arrays if they can be those of a passive solid."""
    frequency = samples("frequency", frequency, "Hz")
    if frequency.ndim != 1 or frequency.size < 2:
        raise ValueError(f"frequency has shape {frequency.shape}: must be a list of at least 2")
    moduli = samples("storage", storage, "Pa"), samples("loss", loss, "Pa")
    for name, values in zip(("storage", "loss"), moduli, strict=True):
        if values.shape != frequency.shape:
            raise ValueError(
                f"{name} has {values.size} entries: must have as many as frequency, "
                f"{frequency.size}"
            )
    for i in np.flatnonzero(np.diff(frequency) <= 0) + 1:
        raise ValueError(
            f"frequency[{i}] = {frequency[i]:g} Hz: must be above frequency[{i - 1}] = "
            f"{frequency[i - 1]:g} Hz (sort the data by rising frequency)"
        )
    highest = np.maximum.accumulate(moduli[0])
    for i in np.flatnonzero(moduli[0] < (1 - NOISE) * highest):
        j = int(np.argmax(moduli[0][:i]))
        raise ValueError(
            f"storage[{i}] = {moduli[0][i]:g} Pa at {frequency[i]:g} Hz: must not fall more than "
            f"{100 * NOISE:g} % below storage[{j}] = {moduli[0][j]:g} Pa at {frequency[j]:g} Hz "
            "(passive solids stiffen with frequency)"
        )
    return frequency, *moduli
