"""Values of a size that hardly any experiment has, or none: their unit is not the SI's."""

import sys
import warnings
from math import inf
from typing import NamedTuple

from softafm.errors import DoubtfulValueWarning


class _Range(NamedTuple):
    """What is plausible and what possible, SI, and the unit that people write, in SI units."""

    least: float
    most: float
    possible: float
    common: str
    factor: float


_RANGES = {
    "m": _Range(0, 1e-2, 1.0, "nm", 1e-9),
    "m/s": _Range(0, 10, 1e4, "nm/s", 1e-9),
    "N": _Range(0, 1, 1e3, "nN", 1e-9),
    "J": _Range(0, 1e-9, 1e-3, "zJ", 1e-21),
    "J/m²": _Range(0, 10, 1e3, "mJ/m²", 1e-3),
    "V": _Range(0, 20, 1e4, "mV", 1e-3),
    "Pa": _Range(1e-6, inf, inf, "GPa", 1e9),
}
"""By unit. Wide: colloidal probes, punches of millimetres and gels of a few pascals are plausible;
the lenses of a surface forces apparatus, of centimetres, are possible."""


def doubt(name: str, number: float, unit: str) -> None:
    """Warn of a value far outside of what experiments have, on behalf of who built the object.

    Raises
    ------
    ValueError
        If it is far outside of what any could have: a run would take long, and come to nothing.
    """
    if unit not in _RANGES or number == 0:
        return
    least, most, possible, common, factor = _RANGES[unit]
    if least <= abs(number) <= most:
        return
    hint = f"did you mean {number * factor:g} ({number:g} {common})?"
    if abs(number) > possible:
        bounds = f"at most {possible:g} {unit}" + (" in magnitude" if number < 0 else "")
        raise ValueError(
            f"{name} = {number:g} {unit}: must be {bounds}, as all values are in SI units; {hint}"
        )
    size = "small" if abs(number) < least else "large"
    warnings.warn(
        f"{name} = {number:g} {unit}: is very {size}, as all values are in SI units; {hint}",
        DoubtfulValueWarning,
        stacklevel=_frames_of_ours(),
    )


def _frames_of_ours() -> int:
    """Count the frames from the function that asks up to the first one outside of the package."""
    frame, count = sys._getframe(1), 0
    while frame is not None and frame.f_globals.get("__name__", "").startswith("softafm."):
        frame, count = frame.f_back, count + 1  # type: ignore[assignment]
    return count + 1
