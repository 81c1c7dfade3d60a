"""How values are written in an experiment file: types that read text, units and lists."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, ValidationInfo

from softafm.checks.refusals import suggest
from softafm.checks.validate import (
    check_finite,
    check_poisson_ratio,
    check_positive,
    check_tabor,
    check_tolerance,
    check_whole,
)
from softafm.modes.regularise import Regularise
from softafm.units import quantities as units
from softafm.units.respelling import respell_number

_MOST_ENTRIES = 1000
_MOST_PIXELS = 4096


@dataclass(frozen=True)
class Input:
    """What a form needs to know to ask for a value."""

    kind: Literal["quantity", "number", "word", "flag", "choice", "list", "file", "tables"]
    example: str = ""
    choices: tuple[str, ...] = ()
    unit: str = ""


def _read(kind: units.Kind) -> BeforeValidator:
    return BeforeValidator(lambda written: units.read_quantity(written, kind))


def _describe(read: Callable[..., Any], valid: str, asked: Input) -> tuple[Any, ...]:
    return BeforeValidator(read), Field(description=valid), asked


def _make_quantity(kind: units.Kind) -> tuple[Any, ...]:
    asked = Input("quantity", kind.example, unit=kind.si)
    return _read(kind), Field(description=kind.valid), asked


def quantity_of(kind: units.Kind, *, listed: bool = False) -> Any:
    """Return the type that reads a quantity of a kind as text with its unit, or a list of such."""
    single = Annotated[float, *_make_quantity(kind)]
    return Annotated[tuple[single, ...], *_make_quantities(kind)] if listed else single


def _make_quantities(kind: units.Kind) -> tuple[Any, ...]:
    asked = Input("list", kind.example, unit=kind.si)
    return _describe(_read_list, f"a list, each {kind.valid}", asked)


def _read_number(written: Any) -> float:
    if isinstance(written, bool) or not isinstance(written, int | float):
        meant = respell_number(" ".join(written.split())) if isinstance(written, str) else []
        if meant:
            raise ValueError(f"must be a plain number; did you mean {' or '.join(meant)}?")
        raise ValueError("must be a plain number, without quotes or unit")
    try:
        return check_finite("", written, "")
    except (ValueError, OverflowError):
        raise ValueError("must be a finite number") from None


def make_check(check: Callable[[Any], Any]) -> AfterValidator:
    """Return what refuses a number for the reason that a check gives after its name and value.

    What an object would refuse anyway is so reported for all values at once, before it is made.
    """

    def checked(number: float) -> float:
        try:
            return check(number)
        except ValueError as error:
            raise ValueError(str(error).partition(": ")[2]) from None

    return AfterValidator(checked)


def _read_cycles(written: Any) -> int | str:
    if written == "steady":
        return "steady"
    try:
        return check_whole("cycles", written, 1, 1_000_000)
    except ValueError:
        raise ValueError("must be a whole number from 1 to 1000000, or 'steady'") from None


def _read_regularise(written: Any) -> Regularise:
    words: dict[str, Regularise] = {"auto": "auto", "none": None}
    if isinstance(written, str) and written in words:
        return words[written]
    try:
        return _read_number(written)
    except ValueError as error:
        raise ValueError(f"{error}; or 'auto' or 'none'") from None


def _read_points(written: Any) -> int:
    try:
        return check_whole("points", written, 2, _MOST_ENTRIES)
    except ValueError:
        raise ValueError(f"must be a whole number from 2 to {_MOST_ENTRIES}") from None


def _read_ratio(written: Any) -> float:
    number = _read_number(written)
    if not 0 < number < 1:
        raise ValueError("must be above 0 and below 1")
    return number


def _read_whole(written: Any) -> int:
    if isinstance(written, bool) or not isinstance(written, int) or abs(written) >= 2**63:
        raise ValueError("must be a whole number, such as 100")
    return written


def _read_flag(written: Any) -> bool:
    if not isinstance(written, bool):
        raise ValueError("must be true or false")
    return written


def make_choice(choices: Mapping[str, Any]) -> Any:
    """Return the type that reads the name of a choice as what it names."""

    def read(written: Any) -> Any:
        if not isinstance(written, str) or written not in choices:
            raise ValueError(suggest(written, list(choices)))
        return choices[written]

    return Annotated[Any, BeforeValidator(read), Input("choice", choices=tuple(choices))]


def _read_list(written: Any) -> Any:
    if not isinstance(written, list) or not written:
        raise ValueError("must be a list, in square brackets, with at least one entry")
    if len(written) > _MOST_ENTRIES:
        raise ValueError(f"has {len(written)} entries: must have at most {_MOST_ENTRIES}")
    return tuple(written)


_reading: ContextVar[Callable[[Callable[[Path], Any], Path], Any]] = ContextVar(
    "reading", default=lambda read, path: read(path)
)


@contextmanager
def replace_reader(reading: Callable[[Callable[[Path], Any], Path], Any]) -> Iterator[None]:
    """Have ``reading(read, path)`` called inside for every CSV file in place of ``read(path)``."""
    before = _reading.set(reading)
    try:
        yield
    finally:
        _reading.reset(before)


def make_file_type(read: Callable[[Path], Any]) -> tuple[Any, ...]:
    """Return the marks of a type that reads the name of a CSV file as what the file holds."""

    def held(written: Any, info: ValidationInfo) -> Any:
        return _reading.get()(read, _find_file(written, info))

    return _describe(held, "the name of a CSV file", Input("file", "approach.csv"))


def _find_file(
    written: Any, info: ValidationInfo, valid: str = "a CSV file, such as 'approach.csv'"
) -> Path:
    if not isinstance(written, str) or not written or "\0" in written:
        raise ValueError(f"must be the name of {valid}")
    folder = info.context["folder"] if info.context else Path()
    return folder / written


def _find_image(written: Any, info: ValidationInfo) -> Path:
    return _find_file(written, info, "an image or .npy, such as 'grains.png'")


def _read_pixels(written: Any) -> tuple[int, int]:
    valid = f"two whole numbers from 1 to {_MOST_PIXELS}, along x and y, such as [128, 128]"
    try:
        along_x, along_y = _read_list(written)
        return check_whole("", along_x, 1, _MOST_PIXELS), check_whole("", along_y, 1, _MOST_PIXELS)
    except (TypeError, ValueError):
        raise ValueError(f"must be {valid}") from None


def _check_two(written: Any) -> Any:
    if not isinstance(written, list) or len(written) != 2:
        raise ValueError("must be two lengths, along x and y, such as ['500 nm', '500 nm']")
    return tuple(written)


Positive = make_check(lambda number: check_positive("", number, ""))
Length = Annotated[float, *_make_quantity(units.LENGTH)]
Time = Annotated[float, *_make_quantity(units.TIME)]
Speed = Annotated[float, *_make_quantity(units.SPEED)]
Frequency = Annotated[float, *_make_quantity(units.FREQUENCY)]
Modulus = Annotated[float, *_make_quantity(units.MODULUS)]
Newtons = Annotated[float, *_make_quantity(units.FORCE)]
Stiffness = Annotated[float, *_make_quantity(units.STIFFNESS)]
Joules = Annotated[float, *_make_quantity(units.ENERGY)]
JoulesPerArea = Annotated[float, *_make_quantity(units.ENERGY_PER_AREA)]
Pressure = Annotated[float, *_make_quantity(units.PRESSURE)]
Angle = Annotated[float, *_make_quantity(units.ANGLE)]
Voltage = Annotated[float, *_make_quantity(units.VOLTAGE)]
Temperature = Annotated[float, *_make_quantity(units.TEMPERATURE)]
Viscosity = Annotated[float, *_make_quantity(units.VISCOSITY)]
Concentration = Annotated[float, *_make_quantity(units.CONCENTRATION)]
Compliance = Annotated[float, *_make_quantity(units.COMPLIANCE)]
Compliances = Annotated[tuple[Compliance, ...], *_make_quantities(units.COMPLIANCE)]
Moduli = Annotated[tuple[Modulus, ...], *_make_quantities(units.MODULUS)]
Times = Annotated[tuple[Annotated[Time, Positive], ...], *_make_quantities(units.TIME)]
Number = Annotated[float, *_describe(_read_number, "a number, such as 0.49", Input("number"))]
Poisson = Annotated[Number, make_check(check_poisson_ratio)]
Numbers = Annotated[tuple[Number, ...], BeforeValidator(_read_list), Input("list", "0.5")]
QualityFactor = Annotated[
    float, *_describe(_read_number, "a number, such as 430", Input("number", "430"))
]
Ratio = Annotated[float, BeforeValidator(_read_ratio), Input("number", "0.9")]
Ratios = Annotated[tuple[Ratio, ...], BeforeValidator(_read_list), Input("list", "0.9")]
Points = Annotated[int, BeforeValidator(_read_points), Input("number", "31")]
Cycles = Annotated[int | Literal["steady"], BeforeValidator(_read_cycles), Input("word", "steady")]
Flag = Annotated[bool, BeforeValidator(_read_flag), Input("flag")]
Tolerance = Annotated[
    float, BeforeValidator(_read_number), make_check(check_tolerance), Input("number", "0.01")
]
Regularised = Annotated[
    Regularise,
    BeforeValidator(_read_regularise),
    make_check(lambda tabor: check_tabor("", tabor) if isinstance(tabor, float) else tabor),
    Input("word", "8"),
]
Image = Annotated[
    Path, *_describe(_find_image, "the name of an image", Input("file", "grains.png"))
]
Pixels = Annotated[tuple[int, int], BeforeValidator(_read_pixels), Input("list", "128")]
Extent = Annotated[
    tuple[Length, Length], BeforeValidator(_check_two), Input("list", "500 nm", unit="m")
]
Whole = Annotated[Any, BeforeValidator(_read_whole), Input("number", "100")]
Entries = Annotated[tuple[Any, ...], BeforeValidator(_read_list), Input("tables")]
