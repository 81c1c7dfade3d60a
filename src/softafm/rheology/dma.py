"""Measured storage and loss moduli, and how far a sample is from them."""

import warnings
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from softafm.errors import AccuracyWarning
from softafm.rheology.lists import check_points

_MOST_POINTS, _MOST_DECADES = 2000, 30
"""What can be fitted in seconds."""
_POOR = 0.1
"""Largest relative misfit to measured moduli without a warning."""
_REPEATED = 1.2
"""Largest ratio of storage moduli measured twice at one frequency."""


def measure_misfit(
    sample: Any, frequency: ArrayLike, storage: ArrayLike, loss: ArrayLike
) -> tuple[float, float]:
    """Return the largest and the root mean square relative misfit of a sample to measured moduli.

    Storage and loss modulus (Pa, at ``frequency`` in Hz) are each compared with their own value.
    """
    misfit = _measure_misfit(sample, *sort_moduli(frequency, storage, loss))
    return float(np.max(np.abs(misfit))), float(np.sqrt(np.mean(misfit**2)))


def warn_of_misfit(sample: Any, frequency: ArrayLike, storage: ArrayLike, loss: ArrayLike) -> None:
    """Warn, on behalf of what called the caller, of a sample that is far from what was measured."""
    data = sort_moduli(frequency, storage, loss)
    largest, rms = measure_misfit(sample, *data)
    if largest <= _POOR:
        return
    which, i = divmod(int(np.argmax(np.abs(_measure_misfit(sample, *data)))), data[0].size)
    name, value = ("storage", "loss")[which], data[1 + which][i]
    warnings.warn(
        f"the sample differs from the measured moduli by up to {100 * largest:.2g} %, in the "
        f"{name} of {value:.4g} Pa at {data[0][i]:.4g} Hz ({100 * rms:.2g} % root mean square): "
        "look at both with plot_rheology(sample, data=...), and leave out points that are wrong",
        AccuracyWarning,
        stacklevel=3,
    )


def _measure_misfit(
    sample: Any, frequency: np.ndarray, storage: np.ndarray, loss: np.ndarray
) -> np.ndarray:
    """Return the relative misfit of storage and loss modulus, shape (2, n)."""
    moduli = sample.storage_modulus(frequency), sample.loss_modulus(frequency)
    return np.array([moduli[0] / storage - 1, moduli[1] / loss - 1])


def sort_moduli(
    frequency: ArrayLike, storage: ArrayLike, loss: ArrayLike
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return measured moduli as arrays by rising frequency.

    What was measured twice at a frequency stays twice, if it is of one measurement.

    Raises
    ------
    ValueError
        If they are not positive numbers, as many of each, or are fewer than 2 or more than 2000;
        if frequencies are all equal or span over 30 decades, or storage moduli of one frequency
        differ by more than 20 %.
    """
    frequency = check_points("frequency", frequency, "Hz")
    if frequency.ndim != 1 or not 2 <= frequency.size <= _MOST_POINTS:
        raise ValueError(
            f"frequency has shape {frequency.shape}: must be a list of 2 to {_MOST_POINTS} numbers"
        )
    moduli = check_points("storage", storage, "Pa"), check_points("loss", loss, "Pa")
    for name, values in zip(("storage", "loss"), moduli, strict=True):
        if values.shape != frequency.shape:
            raise ValueError(
                f"{name} has {values.size} entries: must have as many as frequency, "
                f"{frequency.size}"
            )
    order = np.lexsort((moduli[0], frequency))
    frequency, storage, loss = (values[order] for values in (frequency, *moduli))
    span = np.log10(frequency[-1] / frequency[0])
    if not 0 < span <= _MOST_DECADES:
        raise ValueError(
            f"frequency is from {frequency[0]:g} to {frequency[-1]:g} Hz: must vary, and over at "
            f"most {_MOST_DECADES} decades"
        )
    for i in np.flatnonzero(np.diff(frequency) == 0):
        if storage[i + 1] > _REPEATED * storage[i]:
            raise ValueError(
                f"storage is {storage[i]:.4g} and {storage[i + 1]:.4g} Pa at one frequency, "
                f"{frequency[i]:.4g} Hz: must be of one sample at one temperature"
            )
    return frequency, storage, loss
