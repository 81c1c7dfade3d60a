"""How a map is taken: at a constant amplitude of a tapping lever, or by a force curve a pixel."""

from dataclasses import dataclass
from typing import ClassVar, Literal

from softafm.checks.kinds import refuse_other
from softafm.checks.validate import check_choice, check_finite, check_positive
from softafm.instrument.cantilever import Cantilever
from softafm.instrument.motion import Motion
from softafm.instrument.motions import Sine, Trajectory, Triangle
from softafm.modes.driven import make_drive
from softafm.modes.start import refuse_other_than_cantilever


@dataclass(frozen=True)
class AmplitudeModulation:
    """Tapping at a setpoint: a feedback moves the lever so that its amplitude stays the same.

    Parameters
    ----------
    cantilever
        With quality factor and frequency.
    free_amplitude
        Amplitude A0 away from the sample, m.
    setpoint
        Amplitude over A0 that the feedback keeps, between 0 and 1.
    drive_frequency
        Frequency of the drive, Hz; that of the cantilever by default.
    engaged
        Branch on which the first pixel is met where there are two: that on which the lever
        arrives as it comes down (``"approach"``), ``"attractive"`` or ``"repulsive"``.

    Raises
    ------
    ValueError
        If a value is out of range or the cantilever lacks quality factor or frequency.
    """

    kind: ClassVar[str] = "amplitude-modulation"
    cantilever: Cantilever
    free_amplitude: float
    setpoint: float
    drive_frequency: float | None = None
    engaged: Literal["approach", "attractive", "repulsive"] = "approach"

    def __post_init__(self) -> None:
        refuse_other_than_cantilever(self.cantilever)
        free = check_positive("free_amplitude", self.free_amplitude, "m")
        setpoint = check_finite("setpoint", self.setpoint, "(amplitude over free amplitude)")
        if not 0 < setpoint < 1:
            raise ValueError(
                f"setpoint = {setpoint:g}: must be above 0 and below 1, the amplitude over the "
                "free amplitude"
            )
        make_drive(self.cantilever, free, self.drive_frequency)
        check_choice("engaged", self.engaged, ("approach", "attractive", "repulsive"))
        object.__setattr__(self, "free_amplitude", free)
        object.__setattr__(self, "setpoint", setpoint)


@dataclass(frozen=True)
class ForceVolume:
    """A force curve a pixel, on a surface flat and relaxed at first.

    Parameters
    ----------
    motion
        Motion of the tip above the local surface, or of the base of the cantilever if there is
        one: ``Triangle`` (perhaps with ``setpoint_force``), ``Sine`` or ``Trajectory``.
    cantilever
        Lever that carries the tip, or None to prescribe the height of the tip.
    """

    kind: ClassVar[str] = "force-volume"
    motion: Motion
    cantilever: Cantilever | None = None

    def __post_init__(self) -> None:
        kinds = Triangle, Sine, Trajectory
        refuse_other("motion", self.motion, kinds, "a Triangle, a Sine or a Trajectory")
        if self.cantilever is not None:
            refuse_other_than_cantilever(self.cantilever)
