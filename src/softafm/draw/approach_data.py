"""What a sweep of the lever's height shows: curves, solutions, where amplitude and phase jump."""

import json
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from xarray import Dataset

DIRECTIONS = ("approach", "retract")
AXES = {
    "ratio": ("Amplitude ratio A/A₀", None),
    "phase": ("Phase lag (°)", None),
    "dissipation": ("Dissipation in a cycle", "J"),
    "virial": ("Virial", "J"),
    "force_max": ("Peak force", "N"),
    "height": ("Mean height of the tip, Z", "m"),
    "lowest": ("Lowest height of the tip, Z − A", "m"),
}
"""Title of the axis of what ``collect_curves`` returns, and the unit if it takes prefixes."""

Curves = dict[str, dict[str, np.ndarray]]
_OBSERVABLES = ("phase", "dissipation", "virial", "force_max")
_MOST_SOLUTIONS = 60
_SMALLEST, _STEEPER = 0.02, 4.0


def collect_curves(result: "Dataset") -> Curves:
    """Return what is drawn of an approach curve, SI, each curve by the names in ``AXES``.

    The sweeps are called as in ``DIRECTIONS``, the solutions ``"stable"`` and ``"unstable"``; of
    these at most some sixty amplitudes are kept.
    """
    free = json.loads(result.attrs["experiment"])["motion"]["free_amplitude"]
    known = [name for name in _OBSERVABLES if name in result]
    curves: Curves = {}
    for direction in DIRECTIONS:
        swept = {name: result[f"{direction}_{name}"].values for name in known}
        amplitude, height = result[f"{direction}_amplitude"].values, result["sweep_height"].values
        lowest = height - amplitude
        curves[direction] = {
            **swept, "ratio": amplitude / free, "height": height, "lowest": lowest
        }  # fmt: skip
    ordered = result.sortby("amplitude_ratio")
    ratio = ordered["amplitude_ratio"].values
    every = max(1, ratio.size // _MOST_SOLUTIONS)
    for kind, branches in (("stable", ["attractive", "repulsive"]), ("unstable", ["unstable"])):
        chosen = ordered.sel(branch=branches).isel(amplitude_ratio=slice(None, None, every))
        solutions = {name: chosen[name].values.ravel() for name in known}
        height = chosen["mean_height"].values.ravel()
        ratios = np.tile(ratio[::every], len(branches))
        lowest = height - free * ratios
        curves[kind] = {**solutions, "ratio": ratios, "height": height, "lowest": lowest}
    return curves


def find_jumps(result: "Dataset", direction: str) -> list[tuple[int, int]]:
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
