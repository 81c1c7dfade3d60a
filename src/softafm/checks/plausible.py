"""Values of a size that hardly any experiment has: most likely their unit is not the SI's."""

from math import inf
from typing import NamedTuple

from softafm.checks.callers import warn_caller
from softafm.errors import DoubtfulValueWarning


class _Range(NamedTuple):
    """What is plausible, SI, and the unit that people write: how many SI units it is."""

    least: float
    most: float
    common: str
    factor: float


_RANGES = {
    "m": _Range(0, 1e-2, "nm", 1e-9),
    "m/s": _Range(0, 10, "nm/s", 1e-9),
    "N": _Range(0, 1, "nN", 1e-9),
    "J": _Range(0, 1e-9, "zJ", 1e-21),
    "J/m²": _Range(0, 10, "mJ/m²", 1e-3),
    "V": _Range(0, 20, "mV", 1e-3),
    "Pa": _Range(1e-6, inf, "GPa", 1e9),
}
"""By unit. Wide: colloidal probes, punches of millimetres and gels of a few pascals are inside."""


def doubt(name: str, number: float, unit: str) -> None:
    """Warn of a value far outside of what experiments have, on behalf of who built the object."""
    if unit not in _RANGES or number == 0:
        return
    least, most, common, factor = _RANGES[unit]
    if least <= abs(number) <= most:
        return
    size = "small" if abs(number) < least else "large"
    warn_caller(
        DoubtfulValueWarning(
            f"{name} = {number:g} {unit}: is very {size}, as all values are in SI units; did you "
            f"mean {number * factor:g} ({number:g} {common})?"
        )
    )
