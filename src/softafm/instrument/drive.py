"""What makes a lever oscillate."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from softafm.checks.validate import check_choice, check_positive
from softafm.units.quantities import FREQUENCY, LENGTH


@dataclass(frozen=True)
class Drive:
    """A sinusoidal drive of constant strength, given by what it does away from the sample.

    Parameters
    ----------
    frequency
        Frequency, Hz.
    free_amplitude
        Amplitude of the deflection at that frequency away from the sample, m.
    by
        What is driven: the ``"tip"``, by a force on it, or the ``"base"`` of the lever, which is
        shaken. The tip of a shaken lever moves by the deflection and with the base, which matters
        at low quality factors.

    Raises
    ------
    ValueError
        If frequency or amplitude are not finite numbers above zero, or ``by`` is something else.
    """

    kind: ClassVar[str] = "drive"
    frequency: Annotated[float, FREQUENCY]
    free_amplitude: Annotated[float, LENGTH]
    by: Literal["tip", "base"] = "tip"

    def __post_init__(self) -> None:
        for name, unit in {"frequency": "Hz", "free_amplitude": "m"}.items():
            object.__setattr__(self, name, check_positive(name, getattr(self, name), unit))
        check_choice("by", self.by, ("tip", "base"))
