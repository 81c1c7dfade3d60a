"""The tables of an experiment file and the objects they stand for.

Each choice a user can make in a table (``shape``, ``model``, ``law``, ``name``) is one small class:
its fields are the table's other keys, and ``build`` returns the object.
"""

from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields
from functools import cache
from inspect import Parameter, signature
from pathlib import Path
from types import NoneType
from typing import Annotated, Any, ClassVar, Literal, get_args, get_origin, get_type_hints

import numpy as np
from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    ValidationError,
    ValidationInfo,
    create_model,
    field_validator,
)

from softafm.checks.refusals import (
    ConfigError,
    describe_problems,
    join_with_and,
    join_with_or,
    reword,
    show,
    suggest,
)
from softafm.checks.suggestions import explain_limit
from softafm.experiment.entries import (
    Angle,
    Compliances,
    Concentration,
    Cycles,
    Entries,
    Flag,
    Frequency,
    Joules,
    JoulesPerArea,
    Length,
    Moduli,
    Modulus,
    Newtons,
    Number,
    Numbers,
    Points,
    Poisson,
    Positive,
    Pressure,
    QualityFactor,
    Ratio,
    Ratios,
    Regularised,
    Speed,
    Stiffness,
    Temperature,
    Time,
    Times,
    Tolerance,
    Viscosity,
    Voltage,
    Whole,
    make_check,
    make_choice,
    make_file_type,
    quantity_of,
)
from softafm.files.measured import read_base_trajectory, read_trajectory
from softafm.instrument.cantilever import Cantilever, Eigenmode
from softafm.instrument.motions import Sine, Trajectory, Triangle
from softafm.modes import Mode
from softafm.modes.driven import AmplitudeSweep
from softafm.rheology import (
    Elastic,
    FractionalStandardLinearSolid,
    GeneralizedKelvinVoigt,
    GeneralizedMaxwell,
    KelvinVoigt,
    Maxwell,
    PowerLaw,
    StandardLinearSolid,
)
from softafm.rheology.dma_table import DynamicModuli, read_moduli
from softafm.samples import NAMED
from softafm.solvers.energy import Energy
from softafm.solvers.paper.attard import Attard
from softafm.solvers.paper.enhanced import EnhancedAttard
from softafm.solvers.paper.stepping import AdamsBashforth, ForwardEuler, RungeKutta4, Stepper
from softafm.surfaces import (
    DLVO,
    DMT,
    Dugdale,
    Exponential,
    LennardJones,
    Morse,
    Repulsion,
    SumOfLaws,
    SurfaceLaw,
    VanDerWaals,
    VanDerWaalsAttraction,
    read_law,
)
from softafm.surfaces.limits import check_length
from softafm.tips import (
    Cone,
    FlatPunch,
    Hyperboloid,
    Paraboloid,
    PowerLawTip,
    Sphere,
    Tip,
    read_tip_profile,
)
from softafm.units.quantities import Kind


class Table(BaseModel):
    """A table of the file: known keys only."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)
    alternatives: ClassVar[tuple[tuple[tuple[str, ...], ...], ...]] = ()
    """Choices between groups of keys, of each of which one group is to be given, whole."""

    def build(self) -> Any:
        """Return the object that the table describes; ValueError if it refuses the values."""
        return self

    def given(self, alternatives: tuple[tuple[str, ...], ...]) -> dict[str, Any]:
        """Return the one of several groups of keys that the user gave, whole and alone."""
        present = [a for a in alternatives if any(getattr(self, k) is not None for k in a)]
        values = {k: getattr(self, k) for a in present for k in a if getattr(self, k) is not None}
        if len(present) == 1 and len(values) == len(present[0]):
            return values
        choices = ", or ".join(map(join_with_and, alternatives))
        raise ValueError(f"give {choices}; found {', '.join(values) or 'none of them'}")


class StandardLinearSolidSample(Table):
    """``[sample] model = "standard-linear-solid"``: moduli E or G, creep or relaxation time."""

    alternatives = (
        (("E0", "E_inf"), ("G0", "G_inf")),
        (("creep_time",), ("relaxation_time",)),
    )
    E0: Annotated[Modulus, Positive] | None = None
    E_inf: Annotated[Modulus, Positive] | None = None
    G0: Annotated[Modulus, Positive] | None = None
    G_inf: Annotated[Modulus, Positive] | None = None
    creep_time: Annotated[Time, Positive] | None = None
    relaxation_time: Annotated[Time, Positive] | None = None
    poisson: Poisson

    def build(self) -> StandardLinearSolid:
        moduli, time = map(self.given, self.alternatives)
        if "G0" in moduli:
            (duration,) = time.values()
            solid = StandardLinearSolid.from_shear(
                **moduli, creep_time=duration, poisson=self.poisson
            )
            moduli = {"E0": solid.E0, "E_inf": solid.E_inf}
        if "relaxation_time" in time:
            return StandardLinearSolid.from_relaxation_time(**moduli, **time, poisson=self.poisson)
        return StandardLinearSolid(**moduli, **time, poisson=self.poisson)


class TriangleMotion(Table):
    """``[motion] shape = "triangle"``: a ramp, or one period of a wave."""

    alternatives = ((("start", "turn", "speed"), ("mean_height", "amplitude", "frequency")),)
    start: Length | None = None
    turn: Length | None = None
    speed: Annotated[Speed, Positive] | None = None
    mean_height: Length | None = None
    amplitude: Annotated[Length, Positive] | None = None
    frequency: Annotated[Frequency, Positive] | None = None
    dwell: Time = 0.0
    setpoint_force: Newtons | None = None

    def build(self) -> Triangle:
        given = self.given(*self.alternatives)
        triangle = Triangle if "start" in given else Triangle.from_frequency
        return triangle(**given, dwell=self.dwell, setpoint_force=self.setpoint_force)


class SineMotion(Table):
    """``[motion] shape = "sine"``."""

    mean_height: Length
    amplitude: Annotated[Length, Positive]
    frequency: Annotated[Frequency, Positive]
    cycles: Cycles = 1

    def build(self) -> Sine:
        return Sine(self.mean_height, self.amplitude, self.frequency, self.cycles)


class TapMotion(SineMotion):
    """``[motion]`` of a tapping cycle."""

    cycles: Cycles = "steady"


class TrajectoryMotion(Table):
    """``[motion] shape = "trajectory"``: a CSV file beside the experiment file.

    Parameters
    ----------
    measured
        Whether the path is a record with noise, which is to be smoothed between its corners.
    """

    file: Annotated[Any, *make_file_type(read_trajectory)]
    smooth: Flag = False
    measured: Flag = False
    noise: Annotated[Length, Positive] | None = None

    def build(self) -> Trajectory:
        if self.noise is not None and not self.measured:
            raise ValueError("noise = : not used without measured = true")
        if self.smooth and self.measured:
            raise ValueError(
                "smooth = True: not used with measured = true, which is smooth between corners"
            )
        samples = self.file.time, self.file.heights
        if not self.measured:
            return Trajectory(*samples, smooth=True) if self.smooth else self.file
        try:
            return Trajectory.from_measurement(*samples, noise=self.noise)
        except ValueError as error:
            raise ValueError(f"file = : {error}") from None


class BaseTrajectoryMotion(TrajectoryMotion):
    """``[motion] shape = "trajectory"`` of the base of a lever."""

    file: Annotated[Any, *make_file_type(read_base_trajectory)]


class SweepMotion(Table):
    """``[motion]`` of an approach curve: amplitude ratios, listed or evenly spaced.

    Parameters
    ----------
    first_ratio, last_ratio
        Largest and smallest amplitude over the free amplitude, each between 0 and 1.
    points
        Number of amplitudes, evenly spaced from the first ratio to the last.
    """

    alternatives = ((("amplitude_ratio",), ("first_ratio", "last_ratio", "points")),)
    free_amplitude: Annotated[Length, Positive]
    amplitude_ratio: Ratios | None = None
    first_ratio: Ratio | None = None
    last_ratio: Ratio | None = None
    points: Points | None = None
    drive_frequency: Annotated[Frequency, Positive] | None = None

    def build(self) -> AmplitudeSweep:
        self.given(*self.alternatives)
        first, last, points = self.first_ratio, self.last_ratio, self.points
        ratios = self.amplitude_ratio or ()
        if first is not None and last is not None and points is not None:
            if first == last:
                raise ValueError(
                    f"first_ratio = {first}: must differ from last_ratio; for one ratio write "
                    "amplitude_ratio, a list"
                )
            ratios = tuple(np.linspace(first, last, points).tolist())
        return AmplitudeSweep(self.free_amplitude, ratios, self.drive_frequency)


class EigenmodeTable(Table):
    """One of the ``[[cantilever.higher_modes]]``."""

    stiffness: Annotated[Stiffness, Positive]
    frequency: Annotated[Frequency, Positive]
    quality_factor: Annotated[QualityFactor, Positive]

    def build(self) -> Eigenmode:
        return Eigenmode(self.stiffness, self.frequency, self.quality_factor)


class LeverTable(Table):
    """``[cantilever]`` of a lever that bends slowly."""

    stiffness: Annotated[Stiffness, Positive]
    quality_factor: Annotated[QualityFactor, Positive] | None = None
    frequency: Annotated[Frequency, Positive] | None = None
    higher_modes: (
        Annotated[
            Entries,
            Field(
                description="tables [[cantilever.higher_modes]], each with stiffness, frequency "
                "and quality_factor"
            ),
        ]
        | None
    ) = None

    @field_validator("higher_modes")
    @classmethod
    def _build_modes(cls, modes: tuple[Any, ...], info: ValidationInfo) -> tuple[Eigenmode, ...]:
        folder = info.context["folder"] if info.context else Path()
        built = []
        for i, mode in enumerate(modes):
            name = f"higher_modes[{i}]"
            if not isinstance(mode, dict):
                raise ConfigError([f"{name} = {show(mode)}: must be a table"])
            built.append(build_kind(name, mode, EigenmodeTable, folder=folder))
        return tuple(built)

    def build(self) -> Cantilever:
        modes = self.higher_modes or ()
        return Cantilever(self.stiffness, self.quality_factor, self.frequency, modes)


class ResonatorTable(LeverTable):
    """``[cantilever]`` of a lever that oscillates."""

    quality_factor: Annotated[QualityFactor, Positive]
    frequency: Annotated[Frequency, Positive]


class Run(Table):
    """``[run]``: how well and how much to compute."""

    tolerance: Tolerance = 1e-2
    profiles: Flag = False
    check: Flag = False
    regularise: Regularised = "auto"


STEPPERS: dict[str, Stepper] = {
    ForwardEuler.kind: ForwardEuler(),
    **{f"{AdamsBashforth.kind}-{order}": AdamsBashforth(order) for order in range(1, 6)},
    RungeKutta4.kind: RungeKutta4(),
}
"""How the steppers are written."""

_PLAIN: dict[Any, Any] = {
    int: Whole,
    float: Number,
    tuple[float, ...]: Numbers,
    bool: Flag,
    Stepper: make_choice(STEPPERS),
}
"""How parameters without unit are written, by the type that the dataclass declares."""


class Solver(Table):
    """``[solver]``: its other keys are the solver's own parameters, left out at their defaults."""

    solver: ClassVar[type]

    def build(self) -> Any:
        return self.solver(**{key: getattr(self, key) for key in self.model_fields_set})


def _make_solver_table(solver: type) -> type[Solver]:
    """Return the table of a solver, a dataclass whose parameters all have defaults."""
    types = get_type_hints(solver, include_extras=True)
    keys: dict[str, Any] = {
        f.name: (_find_key_type(f.name, types[f.name]), None) for f in fields(solver)
    }
    table = create_model(solver.__name__, __base__=Solver, **keys)
    table.solver = solver
    return table


def _find_key_type(name: str, declared: Any) -> Any:
    """Return the type of a key that is a field of a dataclass; ValueError if there is none."""
    if NoneType in get_args(declared):
        (declared,) = (each for each in get_args(declared) if each is not NoneType)
    for unit in getattr(declared, "__metadata__", ()):
        if isinstance(unit, Kind):
            return quantity_of(unit, listed=declared.__origin__ == tuple[float, ...])
    if get_origin(declared) is Literal:
        return make_choice({choice: choice for choice in get_args(declared)})
    if declared in _PLAIN:
        return _PLAIN[declared]
    raise ValueError(
        f"field {name}: {declared} cannot be written in an experiment file; take float or "
        "tuple[float, ...], Annotated with a Kind of softafm.units.quantities, int, bool or Literal"
    )


class Thing(Table):
    """A tip, sample or surface law, which one of several constructors makes of the keys."""

    constructors: ClassVar[tuple[Callable[..., Any], ...]]

    def build(self) -> Any:
        given = {key: getattr(self, key) for key in self.model_fields_set}
        for constructor in self.constructors:
            needed, known = _list_keys(constructor)
            if set(needed) <= given.keys() <= set(known):
                return constructor(**{known[key]: value for key, value in given.items()})
        common, ways = _find_common_keys(self.constructors), _list_ways(self.constructors)
        found = ", ".join(key for key in type(self).model_fields if key in given.keys() - common)
        raise ValueError(
            f"give {', or '.join(map(join_with_and, ways))}; found {found or 'none of them'}"
        )


def _make_table(
    *constructors: Callable[..., Any], file: Callable[[Path], Any] | None = None
) -> type[Thing]:
    """Return the table of what a class, or another of its constructors, makes.

    ``file`` reads what the constructor takes as such.
    """
    written = KEYS if file is None else {**KEYS, "file": Annotated[Any, *make_file_type(file)]}
    needed = _find_common_keys(constructors)
    names = dict.fromkeys(key for make in constructors for key in _list_keys(make)[1])
    if unwritten := [key for key in names if key not in written]:
        raise ValueError(
            f"{join_with_and(unwritten)} of {constructors[0].__name__}: add it to KEYS of "
            f'softafm/experiment/schema.py, such as "{unwritten[0]}": Annotated[Length, Positive]'
        )
    keys: dict[str, Any] = {key: (written[key], ... if key in needed else None) for key in names}
    table = create_model(constructors[0].__name__, __base__=Thing, **keys)
    table.constructors = constructors
    table.alternatives = (_list_ways(constructors),) if len(constructors) > 1 else ()
    return table


def _list_ways(constructors: tuple[Callable[..., Any], ...]) -> tuple[tuple[str, ...], ...]:
    """Return for each constructor the keys that it needs and not all do."""
    common = _find_common_keys(constructors)
    return tuple(tuple(k for k in _list_keys(c)[0] if k not in common) for c in constructors)


def _find_common_keys(constructors: tuple[Callable[..., Any], ...]) -> set[str]:
    return set.intersection(*(set(_list_keys(make)[0]) for make in constructors))


def _list_keys(constructor: Callable[..., Any]) -> tuple[list[str], dict[str, str]]:
    """Return the keys that a constructor needs, and of each it knows the name of its parameter."""
    parameters = signature(constructor).parameters
    key_of = {name: _KEY_OF.get(name, name) for name in parameters}
    needed = [
        key_of[n] for n, parameter in parameters.items() if parameter.default is Parameter.empty
    ]
    return needed, {key: name for name, key in key_of.items()}


KEYS: dict[str, Any] = {
    **dict.fromkeys(
        ("radius", "apex_radius", "edge_radius", "z0"), Annotated[Length, Positive]
    ),
    **dict.fromkeys(
        ("decay", "core", "debye_length", "cutoff"),
        Annotated[Length, make_check(lambda number: check_length("", number))],
    ),
    "height": Length,
    **dict.fromkeys(("E", "E0", "E1", "G", "G0"), Annotated[Modulus, Positive]),
    **dict.fromkeys(("E_inf", "G_inf"), Modulus),
    **dict.fromkeys(("moduli", "shear_moduli"), Moduli),
    **dict.fromkeys(("creep_time", "relaxation_time", "reference_time"), Annotated[Time, Positive]),
    **dict.fromkeys(("relaxation_times", "retardation_times", "window"), Times),
    **dict.fromkeys(("tension", "pressure_at_zero"), Annotated[Pressure, Positive]),
    **dict.fromkeys(("surface_potential", "tip_potential"), Voltage),
    "poisson": Poisson,
    **dict.fromkeys(
        ("exponent", "error", "wall", "smoothing", "permittivity", "mixing_ratio", "per_decade"),
        Number,
    ),
    "half_angle": Angle,
    "compliances": Compliances,
    "ratios": Numbers,
    "viscosity": Annotated[Viscosity, Positive],
    "hamaker": Annotated[Joules, Positive],
    "work_of_adhesion": Annotated[JoulesPerArea, Positive],
    "temperature": Annotated[Temperature, Positive],
    "concentration": Annotated[Concentration, Positive],
}  # fmt: skip
"""How the parameters of tips, samples and surface laws are written, by their names."""

_KEY_OF = {"W": "work_of_adhesion"}
"""Keys that are not called as the parameter is."""


def use_measured_tip(file: Tip) -> Tip:
    """Return the tip that ``read_tip_profile`` read."""
    return file


def use_tabulated_law(file: SurfaceLaw) -> SurfaceLaw:
    """Return the surface law that ``read_law`` read."""
    return file


def fit_measured_moduli(
    file: DynamicModuli, poisson: float, per_decade: float = 2.0
) -> GeneralizedMaxwell:
    """Fit moduli that ``read_moduli`` read, as ``GeneralizedMaxwell.from_dma``."""
    return GeneralizedMaxwell.from_dma(*file.young(poisson), poisson, per_decade)


class SumSurface(Table):
    """``[surface] law = "sum"``: each of its ``[[surface.parts]]`` is like a ``[surface]``."""

    parts: Annotated[
        Entries,
        Field(description="tables [[surface.parts]], each with a law and its keys"),
    ]

    @field_validator("parts")
    @classmethod
    def _build_parts(cls, parts: tuple[Any, ...], info: ValidationInfo) -> tuple[SurfaceLaw, ...]:
        chooser, laws = CHOICES["surface"]
        single = {law: table for law, table in laws.items() if table is not cls}
        folder = info.context["folder"] if info.context else Path()
        return tuple(
            build_choice(f"parts[{index}]", part, chooser, single, folder=folder)
            for index, part in enumerate(parts)
        )

    def build(self) -> SumOfLaws:
        return SumOfLaws(self.parts)


CHOICES: dict[str, tuple[str, dict[str, type[Table]]]] = {
    "tip": (
        "shape",
        {
            **{
                tip.kind: _make_table(tip)
                for tip in (Paraboloid, Sphere, Cone, Hyperboloid, FlatPunch)
            },
            PowerLawTip.kind: _make_table(PowerLawTip),
            "measured": _make_table(use_measured_tip, file=read_tip_profile),
        },
    ),
    "sample": (
        "model",
        {
            "standard-linear-solid": StandardLinearSolidSample,
            "elastic": _make_table(Elastic),
            "kelvin-voigt": _make_table(
                KelvinVoigt, KelvinVoigt.from_viscosity, KelvinVoigt.from_shear
            ),
            "maxwell": _make_table(Maxwell, Maxwell.from_viscosity, Maxwell.from_shear),
            "generalized-kelvin-voigt": _make_table(GeneralizedKelvinVoigt),
            "generalized-maxwell": _make_table(
                GeneralizedMaxwell, GeneralizedMaxwell.from_shear, GeneralizedMaxwell.from_ratios
            ),
            "power-law": _make_table(PowerLaw),
            "fractional-standard-linear-solid": _make_table(FractionalStandardLinearSolid),
            "measured-moduli": _make_table(fit_measured_moduli, file=read_moduli),
            **{name: _make_table(sample) for name, sample in NAMED.items()},
        },
    ),
    "surface": (
        "law",
        {
            "lennard-jones": _make_table(LennardJones, LennardJones.from_work_of_adhesion),
            "van-der-waals": _make_table(VanDerWaals, VanDerWaals.from_work_of_adhesion),
            "dmt": _make_table(DMT, DMT.from_work_of_adhesion),
            **{law.kind: _make_table(law) for law in (Exponential, Morse, Dugdale)},
            "dlvo": _make_table(DLVO, DLVO.from_concentration),
            **{law.kind: _make_table(law) for law in (Repulsion, VanDerWaalsAttraction)},
            "tabulated": _make_table(use_tabulated_law, file=read_law),
            "sum": SumSurface,
        },
    ),
    "solver": (
        "name",
        {solver.kind: _make_solver_table(solver) for solver in (Energy, Attard, EnhancedAttard)},
    ),
}
"""For each table the key that chooses, and what it can choose."""

_MOTIONS: dict[type, type[Table]] = {
    Triangle: TriangleMotion,
    Sine: SineMotion,
    Trajectory: TrajectoryMotion,
    AmplitudeSweep: SweepMotion,
}
"""Tables of motions that can be written in several ways."""
_OF_A_BASE: dict[type, type[Table]] = {Trajectory: BaseTrajectoryMotion}
"""Those that differ where the base of a lever moves."""
_OF_PARAMETERS: dict[type, type[Table]] = {Sine: TapMotion}
"""Those that differ where a mode takes the parameters of a motion and not the motion."""


class FieldsTable(Table):
    """A table whose keys are the fields of a dataclass."""

    made: ClassVar[type]

    def build(self) -> Any:
        return self.made(**{key: getattr(self, key) for key in self.model_fields_set})


@cache
def motions_of(mode: Mode) -> dict[str, type[Table]]:
    """Return the tables of the motions that a mode takes by shape, the default one first."""
    written = dict(_MOTIONS)
    written |= _OF_A_BASE if mode.lever else {}
    written |= {} if mode.takes_motion else _OF_PARAMETERS
    return {
        shape: written[motion] if motion in written else table_of(motion)
        for shape, motion in mode.motions.items()
    }


@cache
def table_of(made: type) -> type[FieldsTable]:
    """Return the table of a dataclass, with its units, defaults and docstring."""
    types = get_type_hints(made, include_extras=True)
    keys: dict[str, Any] = {
        f.name: (_find_key_type(f.name, types[f.name]), ... if f.default is MISSING else f.default)
        for f in fields(made)
    }
    table = create_model(made.__name__, __base__=FieldsTable, **keys)
    table.made = made
    return table


def cantilever_of(mode: Mode) -> type[Table] | None:
    """Return the table of a mode's cantilever, None if it has no use for one."""
    return {"": None, "stiffness": LeverTable, "resonator": ResonatorTable}[mode.lever]


def build_choice(
    name: str,
    written: Any,
    chooser: str,
    choices: Mapping[str, type[Table]],
    *,
    default: str | None = None,
    folder: Path,
) -> Any:
    """Build what a table describes whose key ``chooser`` says of which choice it is.

    ``name`` is what the table is called in a ConfigError; files are sought in ``folder``.
    """
    if not isinstance(written, dict):
        raise ConfigError([f"{name} = {show(written)}: must be a table with a {chooser}"])
    choice = written.get(chooser, default)
    if choice is None:
        raise ConfigError([f"{name}.{chooser}: missing; must be {join_with_or(list(choices))}"])
    if not isinstance(choice, str) or choice not in choices:
        reason = suggest(choice, list(choices))
        if chooser == "law" and isinstance(choice, str):
            reason = explain_limit(choice) + reason
        raise ConfigError([f"{name}.{chooser} = {show(choice)}: {reason}"])
    return build_kind(name, written, choices[choice], chooser=chooser, folder=folder)


def build_kind(
    name: str,
    written: Mapping[str, Any],
    table: type[Table],
    *,
    chooser: str | None = None,
    folder: Path,
) -> Any:
    """Build what a table of a known kind describes; ConfigError if it cannot be."""
    keys = {key: value for key, value in written.items() if key != chooser}
    try:
        return table.model_validate(keys, context={"folder": folder}).build()
    except ValidationError as invalid:
        valid = [*table.model_fields, *([chooser] if chooser else [])]
        lines = [
            describe_problems(name, table, e, valid) for e in invalid.errors(include_url=False)
        ]
        raise ConfigError([line for several in lines for line in several]) from None
    except (ValueError, ArithmeticError) as error:
        raise ConfigError([reword(name, written, error) or f"{name}: {error}"]) from error
