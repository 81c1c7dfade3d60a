"""The tables of an experiment file and the objects they stand for.

Each choice a user can make in a table (``shape``, ``model``, ``law``, ``name``) is one small class:
its fields are the table's other keys, and ``build`` returns the object.
"""

from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo, create_model

from softafm import units
from softafm._validate import finite, tolerance_of
from softafm.measured import read_trajectory
from softafm.motions import Sine, Trajectory, Triangle
from softafm.rheology import Elastic, GeneralizedKelvinVoigt, StandardLinearSolid
from softafm.solvers.energy import Energy
from softafm.surfaces import LennardJones
from softafm.tips import Paraboloid


def _quantity(kind: units.Kind):
    return Annotated[
        float,
        BeforeValidator(lambda written: units.read_quantity(written, kind)),
        Field(description=kind.valid),
    ]


def _number(written: Any) -> float:
    if isinstance(written, bool) or not isinstance(written, int | float):
        raise ValueError("must be a plain number, without quotes or unit")
    try:
        return finite("", written, "")
    except (ValueError, OverflowError):
        raise ValueError("must be a finite number") from None


def _tolerance(written: Any) -> float:
    number = _number(written)
    try:
        return tolerance_of(number)
    except ValueError as error:
        raise ValueError(str(error).partition(": ")[2]) from None


def _count(written: Any) -> int:
    if isinstance(written, bool) or not isinstance(written, int) or not 1 <= written <= 1_000_000:
        raise ValueError("must be a whole number from 1 to 1000000")
    return written


def _flag(written: Any) -> bool:
    if not isinstance(written, bool):
        raise ValueError("must be true or false")
    return written


def _list(written: Any) -> Any:
    if not isinstance(written, list) or not written:
        raise ValueError("must be a list, in square brackets, with at least one entry")
    return tuple(written)


def _file(written: Any, info: ValidationInfo) -> Path:
    if not isinstance(written, str) or not written or "\0" in written:
        raise ValueError("must be the name of a CSV file, such as 'approach.csv'")
    folder = info.context["folder"] if info.context else Path()
    return folder / written


Length = _quantity(units.LENGTH)
Time = _quantity(units.TIME)
Speed = _quantity(units.SPEED)
Frequency = _quantity(units.FREQUENCY)
Modulus = _quantity(units.MODULUS)
Joules = _quantity(units.ENERGY)
EnergyPerArea = _quantity(units.ENERGY_PER_AREA)
Compliances = Annotated[
    tuple[_quantity(units.COMPLIANCE), ...],
    BeforeValidator(_list),
    Field(description=f"a list, each {units.COMPLIANCE.valid}"),
]
Times = Annotated[
    tuple[Time, ...],
    BeforeValidator(_list),
    Field(description=f"a list, each {units.TIME.valid}"),
]
Number = Annotated[float, BeforeValidator(_number), Field(description="a number, such as 0.49")]
Count = Annotated[int, BeforeValidator(_count)]
Flag = Annotated[bool, BeforeValidator(_flag)]
Tolerance = Annotated[float, BeforeValidator(_tolerance)]
File = Annotated[Path, BeforeValidator(_file), Field(description="the name of a CSV file")]


class Table(BaseModel):
    """A table of the file: known keys only."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    def given(self, *alternatives: tuple[str, ...]) -> tuple[str, ...]:
        """Return the one of several groups of keys that the user gave, whole and alone."""
        present = [a for a in alternatives if any(getattr(self, k) is not None for k in a)]
        keys = [k for a in present for k in a if getattr(self, k) is not None]
        if len(present) == 1 and len(keys) == len(present[0]):
            return present[0]
        choices = ", or ".join(" and ".join(a) for a in alternatives)
        found = ", ".join(keys) if keys else "none of them"
        raise ValueError(f"give {choices}; found {found}")


class ParaboloidTip(Table):
    """``[tip] shape = "paraboloid"``."""

    radius: Length

    def build(self) -> Paraboloid:
        return Paraboloid(radius=self.radius)


class ElasticSample(Table):
    """``[sample] model = "elastic"``."""

    E: Modulus
    poisson: Number

    def build(self) -> Elastic:
        return Elastic(E=self.E, poisson=self.poisson)


class StandardLinearSolidSample(Table):
    """``[sample] model = "standard-linear-solid"``: moduli E or G, creep or relaxation time."""

    E0: Modulus | None = None
    E_inf: Modulus | None = None
    G0: Modulus | None = None
    G_inf: Modulus | None = None
    creep_time: Time | None = None
    relaxation_time: Time | None = None
    poisson: Number

    def build(self) -> StandardLinearSolid:
        moduli = self.given(("E0", "E_inf"), ("G0", "G_inf"))
        time = self.given(("creep_time",), ("relaxation_time",))
        relaxes = time == ("relaxation_time",)
        duration = self.relaxation_time if relaxes else self.creep_time
        E0, E_inf = self.E0, self.E_inf
        if moduli == ("G0", "G_inf"):
            solid = StandardLinearSolid.from_shear(self.G0, self.G_inf, duration, self.poisson)
            if not relaxes:
                return solid
            E0, E_inf = solid.E0, solid.E_inf
        if relaxes:
            from_relaxation = StandardLinearSolid.from_relaxation_time
            return from_relaxation(E0, E_inf, duration, self.poisson)
        return StandardLinearSolid(E0, E_inf, duration, self.poisson)


class GeneralizedKelvinVoigtSample(Table):
    """``[sample] model = "generalized-kelvin-voigt"``."""

    E0: Modulus
    compliances: Compliances
    retardation_times: Times
    poisson: Number

    def build(self) -> GeneralizedKelvinVoigt:
        return GeneralizedKelvinVoigt(
            self.E0, self.compliances, self.retardation_times, self.poisson
        )


class LennardJonesSurface(Table):
    """``[surface] law = "lennard-jones"``: a Hamaker constant or a work of adhesion."""

    hamaker: Joules | None = None
    work_of_adhesion: EnergyPerArea | None = None
    z0: Length

    def build(self) -> LennardJones:
        if self.given(("hamaker",), ("work_of_adhesion",)) == ("hamaker",):
            return LennardJones(hamaker=self.hamaker, z0=self.z0)
        return LennardJones.from_work_of_adhesion(self.work_of_adhesion, self.z0)


class TriangleMotion(Table):
    """``[motion] shape = "triangle"``."""

    start: Length
    turn: Length
    speed: Speed

    def build(self) -> Triangle:
        return Triangle(start=self.start, turn=self.turn, speed=self.speed)


class SineMotion(Table):
    """``[motion] shape = "sine"``, and the motion of a tapping cycle."""

    mean_height: Length
    amplitude: Length
    frequency: Frequency
    cycles: Count = 1

    def build(self) -> Sine:
        return Sine(self.mean_height, self.amplitude, self.frequency, self.cycles)


class TrajectoryMotion(Table):
    """``[motion] shape = "trajectory"``: a CSV file beside the experiment file."""

    file: File

    def build(self) -> Trajectory:
        try:
            return read_trajectory(self.file)
        except ValueError as error:
            raise ValueError(f"file = {self.file.name}: {error}") from error


class Run(Table):
    """``[run]``: how well and how much to compute."""

    tolerance: Tolerance = 1e-2
    profiles: Flag = False


def _solver(solver: type) -> type[Table]:
    """Return the table of a solver: its keys are the solver's own parameters."""
    keys = {field.name: (field.type, field.default) for field in fields(solver)}
    table = create_model(solver.__name__, __base__=Table, **keys)
    table.build = lambda self: solver(**self.model_dump())
    return table


CHOICES: dict[str, tuple[str, dict[str, type[Table]]]] = {
    "tip": ("shape", {"paraboloid": ParaboloidTip}),
    "sample": (
        "model",
        {
            "standard-linear-solid": StandardLinearSolidSample,
            "elastic": ElasticSample,
            "generalized-kelvin-voigt": GeneralizedKelvinVoigtSample,
        },
    ),
    "surface": ("law", {"lennard-jones": LennardJonesSurface}),
    "solver": ("name", {"energy": _solver(Energy)}),
}
"""For each table the key that chooses, and what it can choose."""

MOTIONS: dict[str, dict[str, type[Table]]] = {
    "force-distance": {
        "triangle": TriangleMotion,
        "sine": SineMotion,
        "trajectory": TrajectoryMotion,
    },
    "tapping-cycle": {"sine": SineMotion},
}
"""For each mode the shapes of motion it takes, the default one first."""

ANNOUNCED = ("force-spectroscopy", "approach-curve")
"""Modes that the format knows and this version cannot run."""
