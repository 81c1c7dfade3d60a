"""The lever that carries the tip."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, ClassVar

from softafm.checks.kinds import refuse_other
from softafm.checks.refusals import show
from softafm.checks.validate import check_positive


@dataclass(frozen=True)
class Eigenmode:
    """A higher eigenmode of a cantilever, its deflection counted at the tip.

    Parameters
    ----------
    stiffness
        Stiffness k of the mode against a force on the tip, N/m; its effective mass is k/(2πf)².
    frequency
        Resonance frequency f away from the sample, Hz.
    quality_factor
        Quality factor Q there, no unit.

    Raises
    ------
    ValueError
        If a value is not a finite number above zero.
    """

    kind: ClassVar[str] = "eigenmode"
    stiffness: float
    frequency: float
    quality_factor: float

    def __post_init__(self) -> None:
        _check_fields(self, {"stiffness": "N/m", "frequency": "Hz", "quality_factor": ""})


@dataclass(frozen=True)
class Cantilever:
    """A cantilever with one mode of vibration, or several.

    Parameters
    ----------
    stiffness
        Static stiffness k against a force on the tip, N/m; where the lever moves with its inertia,
        that of its first eigenmode.
    quality_factor
        Quality factor Q of the resonance away from the sample, no unit; needed where the lever
        oscillates.
    frequency
        Resonance frequency away from the sample, Hz; needed where the lever oscillates.
    higher_modes
        Further eigenmodes, ``Eigenmode`` each, of ever higher frequency; only
        ``tapping_transient`` takes them into account.

    Raises
    ------
    ValueError
        If a value is not a finite number above zero, or a higher mode is none.
    """

    kind: ClassVar[str] = "cantilever"
    stiffness: float
    quality_factor: float | None = None
    frequency: float | None = None
    higher_modes: tuple[Eigenmode, ...] = ()

    def __post_init__(self) -> None:
        given = {"stiffness": "N/m", "quality_factor": "", "frequency": "Hz"}
        _check_fields(self, {n: u for n, u in given.items() if getattr(self, n) is not None})
        _check_fields(self, {"stiffness": "N/m"})
        object.__setattr__(self, "higher_modes", _check_modes(self.higher_modes, self.frequency))

    @property
    def eigenmodes(self) -> tuple[Eigenmode, ...]:
        """All eigenmodes, the first one included.

        Raises
        ------
        ValueError
            If it lacks quality factor or frequency.
        """
        for name in ("quality_factor", "frequency"):
            if getattr(self, name) is None:
                raise ValueError(
                    f"cantilever: needs {name}, as the lever moves with its inertia here"
                )
        assert self.frequency is not None
        assert self.quality_factor is not None
        first = Eigenmode(self.stiffness, self.frequency, self.quality_factor)
        return (first, *self.higher_modes)


def _check_fields(thing: Any, units: dict[str, str]) -> None:
    """Take fields that are finite numbers above zero as floats, or raise ValueError."""
    for name, unit in units.items():
        object.__setattr__(thing, name, check_positive(name, getattr(thing, name), unit))


def _check_modes(modes: Any, frequency: float | None) -> tuple[Eigenmode, ...]:
    """Return the higher modes of a lever as a tuple; ValueError if one is out of order or none."""
    if isinstance(modes, Eigenmode) or not isinstance(modes, Iterable):
        raise ValueError(f"higher_modes = {show(modes)}: must be a list of softafm.Eigenmode")
    found = tuple(modes)
    below = 0.0 if frequency is None else frequency
    for i, mode in enumerate(found):
        refuse_other(f"higher_modes[{i}]", mode, Eigenmode, "a softafm.Eigenmode")
        if mode.frequency <= below:
            raise ValueError(
                f"higher_modes[{i}].frequency = {mode.frequency:g} Hz: must be above that of the "
                f"mode before, {below:g} Hz"
            )
        below = mode.frequency
    return found
