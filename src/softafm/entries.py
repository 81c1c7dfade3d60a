"""How values are written in an experiment file: types that read text, units and lists."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, ValidationInfo

from softafm import units
from softafm._validate import finite, tabor_of, tolerance_of, whole
from softafm.refusals import one_of

_MOST_RATIOS = 1000


def _read(kind: units.Kind) -> BeforeValidator:
    return BeforeValidator(lambda written: units.read_quantity(written, kind))


def _described(kind: units.Kind, prefix: str = "") -> Any:
    return Field(description=prefix + kind.valid)


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


def _tabor(written: Any) -> float:
    number = _number(written)
    try:
        return tabor_of("regularise", number)
    except ValueError as error:
        raise ValueError(str(error).partition(": ")[2]) from None


def _cycles(written: Any) -> int | str:
    if written == "steady":
        return "steady"
    try:
        return whole("cycles", written, 1, 1_000_000)
    except ValueError:
        raise ValueError("must be a whole number from 1 to 1000000, or 'steady'") from None


def _points(written: Any) -> int:
    try:
        return whole("points", written, 2, _MOST_RATIOS)
    except ValueError:
        raise ValueError(f"must be a whole number from 2 to {_MOST_RATIOS}") from None


def _ratio(written: Any) -> float:
    number = _number(written)
    if not 0 < number < 1:
        raise ValueError("must be above 0 and below 1")
    return number


def _ratios(written: Any) -> Any:
    if isinstance(written, list) and len(written) > _MOST_RATIOS:
        raise ValueError(f"has {len(written)} entries: must have at most {_MOST_RATIOS}")
    return _list(written)


def _whole(written: Any) -> int:
    if isinstance(written, bool) or not isinstance(written, int) or abs(written) >= 2**63:
        raise ValueError("must be a whole number, such as 100")
    return written


def _flag(written: Any) -> bool:
    if not isinstance(written, bool):
        raise ValueError("must be true or false")
    return written


def choice_of(choices: Mapping[str, Any]) -> BeforeValidator:
    """Read the name of a choice, and return what it names."""

    def read(written: Any) -> Any:
        if not isinstance(written, str) or written not in choices:
            raise ValueError(f"must be {one_of(list(choices))}")
        return choices[written]

    return BeforeValidator(read)


def _list(written: Any) -> Any:
    if not isinstance(written, list) or not written:
        raise ValueError("must be a list, in square brackets, with at least one entry")
    return tuple(written)


def _file(written: Any, info: ValidationInfo) -> Path:
    if not isinstance(written, str) or not written or "\0" in written:
        raise ValueError("must be the name of a CSV file, such as 'approach.csv'")
    folder = info.context["folder"] if info.context else Path()
    return folder / written


Length = Annotated[float, _read(units.LENGTH), _described(units.LENGTH)]
Time = Annotated[float, _read(units.TIME), _described(units.TIME)]
Speed = Annotated[float, _read(units.SPEED), _described(units.SPEED)]
Frequency = Annotated[float, _read(units.FREQUENCY), _described(units.FREQUENCY)]
Modulus = Annotated[float, _read(units.MODULUS), _described(units.MODULUS)]
Newtons = Annotated[float, _read(units.FORCE), _described(units.FORCE)]
Stiffness = Annotated[float, _read(units.STIFFNESS), _described(units.STIFFNESS)]
Joules = Annotated[float, _read(units.ENERGY), _described(units.ENERGY)]
JoulesPerArea = Annotated[float, _read(units.ENERGY_PER_AREA), _described(units.ENERGY_PER_AREA)]
Pressure = Annotated[float, _read(units.PRESSURE), _described(units.PRESSURE)]
Angle = Annotated[float, _read(units.ANGLE), _described(units.ANGLE)]
Voltage = Annotated[float, _read(units.VOLTAGE), _described(units.VOLTAGE)]
Temperature = Annotated[float, _read(units.TEMPERATURE), _described(units.TEMPERATURE)]
Viscosity = Annotated[float, _read(units.VISCOSITY), _described(units.VISCOSITY)]
Concentration = Annotated[float, _read(units.CONCENTRATION), _described(units.CONCENTRATION)]
Compliances = Annotated[
    tuple[Annotated[float, _read(units.COMPLIANCE)], ...],
    BeforeValidator(_list),
    _described(units.COMPLIANCE, "a list, each "),
]
Moduli = Annotated[
    tuple[Modulus, ...], BeforeValidator(_list), _described(units.MODULUS, "a list, each ")
]
Times = Annotated[tuple[Time, ...], BeforeValidator(_list), _described(units.TIME, "a list, each ")]
Number = Annotated[float, BeforeValidator(_number), Field(description="a number, such as 0.49")]
Numbers = Annotated[tuple[Number, ...], BeforeValidator(_list)]
QualityFactor = Annotated[
    float, BeforeValidator(_number), Field(description="a number, such as 430")
]
Ratio = Annotated[float, BeforeValidator(_ratio)]
Ratios = Annotated[tuple[Ratio, ...], BeforeValidator(_ratios)]
Points = Annotated[int, BeforeValidator(_points)]
Cycles = Annotated[int | Literal["steady"], BeforeValidator(_cycles)]
Flag = Annotated[bool, BeforeValidator(_flag)]
Tolerance = Annotated[float, BeforeValidator(_tolerance)]
Tabor = Annotated[float, BeforeValidator(_tabor)]
File = Annotated[Path, BeforeValidator(_file), Field(description="the name of a CSV file")]
Whole = Annotated[Any, BeforeValidator(_whole)]
Entries = Annotated[tuple[Any, ...], BeforeValidator(_list)]
