"""What a sweep of the lever's height shows: where amplitude and phase jump."""

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from xarray import Dataset

DIRECTIONS = ("approach", "retract")
_SMALLEST, _STEEPER = 0.02, 4.0


def jumps_of(result: "Dataset", direction: str) -> list[tuple[int, int]]:
    """Return the jumps of an approach curve on ``"approach"`` or ``"retract"``.

    Each is the pair of neighbouring indices of ``sweep_height`` before and after it. A jump is a
    step of amplitude and phase far longer than both its neighbours. Where a branch ends in a fold
    its slope is infinite, but its steps grow only as √1 − √0 : √2 − √1 = 2.4.
    """
    amplitude = result[f"{direction}_amplitude"].values
    phase = result[f"{direction}_phase"].values
    largest = np.max(amplitude, initial=0.0, where=np.isfinite(amplitude))
    if largest == 0:
        return []
    step = np.hypot(np.diff(amplitude) / largest, np.diff(phase) / 90)
    around = np.concatenate([[np.nan], step, [np.nan]])
    longest = np.fmax(around[:-2], around[2:])
    jumped = np.flatnonzero((step > _SMALLEST) & (step > _STEEPER * longest))
    pairs = [(int(i), int(i) + 1) for i in jumped]  # heights fall with the index
    return pairs if direction == "approach" else [(j, i) for i, j in reversed(pairs)]
