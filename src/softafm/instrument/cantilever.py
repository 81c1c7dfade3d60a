"""The lever that carries the tip."""

from dataclasses import dataclass
from typing import ClassVar

from softafm.checks.validate import check_positive


@dataclass(frozen=True)
class Cantilever:
    """A cantilever with one mode of vibration.

    Parameters
    ----------
    stiffness
        Static stiffness k against a force on the tip, N/m.
    quality_factor
        Quality factor Q of the resonance away from the sample, no unit; needed where the lever
        oscillates.
    frequency
        Resonance frequency away from the sample, Hz; needed where the lever oscillates.

    Raises
    ------
    ValueError
        If a value is not a finite number above zero.
    """

    kind: ClassVar[str] = "cantilever"
    stiffness: float
    quality_factor: float | None = None
    frequency: float | None = None

    def __post_init__(self) -> None:
        units = {"stiffness": "N/m", "quality_factor": "", "frequency": "Hz"}
        for name, unit in units.items():
            value = getattr(self, name)
            if value is not None or name == "stiffness":
                object.__setattr__(self, name, check_positive(name, value, unit))
