"""Units at the edge of the program: text with a unit in, SI floats inside, SI prefixes out."""

import re
from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from math import floor, inf, isfinite, log10
from typing import Any

from softafm.units import plain as plain_units
from softafm.units.respelling import respell

SMALLEST, LARGEST = 1e-40, 1e40
"""Magnitudes beyond these overflow or vanish when they are cubed, so they are refused."""

_NUMBER = re.compile(r"[+-]?(?:(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?|nan|inf)")
_THERMAL = re.compile(rf"({_NUMBER.pattern}) ?k_?[Bb]? ?T")
_BOLTZMANN, _ROOM_TEMPERATURE = 1.380649e-23, 298.0
_LONGEST_UNIT = 40
_PREFIXES = {-18: "a", -15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
_PREFIXED = {"m", "s", "N", "J", "Pa", "Hz", "m/s", "J/m²", "N/m"}


@dataclass(frozen=True)
class Kind:
    """A kind of physical quantity: what it is called, its SI unit, and how a user writes one."""

    noun: str
    si: str
    example: str

    @property
    def valid(self) -> str:
        """What a user may write, with an example."""
        return f"{self.noun} with its unit, such as '{self.example}'"


LENGTH = Kind("a length", "m", "10 nm")
TIME = Kind("a time", "s", "0.1 us")
SPEED = Kind("a speed", "m/s", "5 um/s")
ANGULAR_FREQUENCY = Kind("an angular frequency", "rad/s", "10 rad/s")
FREQUENCY = Kind("a frequency", "Hz", "278 kHz")
MODULUS = Kind("a modulus", "Pa", "2 GPa")
PRESSURE = Kind("a pressure", "Pa", "100 MPa")
ANGLE = Kind("an angle", "rad", "20 deg")
VOLTAGE = Kind("a voltage", "V", "-25 mV")
TEMPERATURE = Kind("a temperature", "K", "298 K")
CONCENTRATION = Kind("a concentration", "mol/L", "1 mmol/L")
VISCOSITY = Kind("a viscosity", "Pa s", "1 kPa s")
COMPLIANCE = Kind("a compliance", "1/Pa", "0.5 1/GPa")
ENERGY = Kind("an energy", "J", "1e-19 J")
ENERGY_PER_AREA = Kind("an energy per area", "J/m^2", "30 mJ/m^2")
FORCE = Kind("a force", "N", "5 nN")
STIFFNESS = Kind("a stiffness", "N/m", "28 N/m")


@cache
def _find_si_factor(unit: str, kind: Kind) -> Decimal:
    """Return how many SI units of ``kind`` one ``unit`` is; ValueError if it is of another kind."""
    plain, si = plain_units.parse(unit), plain_units.parse(kind.si)
    assert si is not None
    if plain is None:
        return _ask_pint(unit, kind)
    if plain.roots != si.roots:
        raise _refuse_kind(unit, kind)
    return plain.factor / si.factor


@cache
def _build_registry() -> Any:
    """Build pint's registry once, when a unit is read that is not plain: it takes half a second."""
    import pint

    return pint.UnitRegistry()


def _ask_pint(unit: str, kind: Kind) -> Decimal:
    """Return what ``_find_si_factor`` does, of any unit that pint knows."""
    registry = _build_registry()
    try:
        parsed = registry.parse_units(unit)
        factor, root = registry.get_root_units(parsed)
        at_zero = registry.Quantity(0.0, parsed).to_root_units().magnitude
    except Exception:  # pint raises some ten unrelated types for text it cannot read
        raise ValueError(f"must be {kind.valid}; '{unit}' is not a known unit") from None
    if at_zero:
        raise ValueError(
            f"must be {kind.valid}; '{unit}' does not count from zero, '{kind.si}' does"
        )
    si_factor, si_root = registry.get_root_units(registry.parse_units(kind.si))
    # Roots, not dimensions: pint calls rad/s a frequency, and would lose a factor 2π in silence.
    if root != si_root:
        raise _refuse_kind(unit, kind)
    return Decimal(f"{factor / si_factor:.15g}")


def _refuse_kind(unit: str, kind: Kind) -> ValueError:
    return ValueError(f"must be {kind.valid}; '{unit}' does not measure {kind.noun}")


def is_unit(text: str) -> bool:
    """Whether a text is a unit, of whatever kind; a number is none."""
    if len(text) > _LONGEST_UNIT or not plain_units.PATTERN.fullmatch(text):
        return False
    if plain_units.parse(text) is not None:
        return True
    try:
        return not _build_registry().parse_units(text).dimensionless
    except Exception:  # as above
        return False


def is_coherent(text: Any) -> bool:
    """Whether a text is a unit of the SI without prefix, such as "N/m"; "kg" is one."""
    if not isinstance(text, str) or not is_unit(text):
        return False
    plain = plain_units.parse(text)
    if plain is not None:
        return plain.factor == 1
    registry = _build_registry()
    factor, _ = registry.get_base_units(registry.parse_units(text))
    return bool(factor == 1)


def read_quantity(written: object, kind: Kind) -> float:
    """Return in SI the quantity written as text, such as ``"10 nm"``.

    Raises
    ------
    ValueError
        If it is not text, has no unit or one of another kind, or is not a usable number. The
        message says what would be valid and what may have been meant, not what was written.
    """
    if not isinstance(written, str):
        bare = isinstance(written, int | float) and not isinstance(written, bool)
        raise ValueError(f"must be {kind.valid}" + ("; the unit is missing" if bare else ""))
    text = " ".join(written.split())
    if kind is ENERGY and (thermal := _THERMAL.fullmatch(text)):
        joules = float(thermal[1]) * _BOLTZMANN * _ROOM_TEMPERATURE
        raise ValueError(
            f"must be {kind.valid}; the thermal energy kT depends on the temperature; did you mean "
            f"'{joules:.4g} J', that at {_ROOM_TEMPERATURE:g} K?"
        )
    try:
        return _read(text, kind)
    except ValueError as error:
        meant = " or ".join(f"'{spelling}'" for spelling in respell(text, kind.si))
        raise ValueError(f"{error}; did you mean {meant}?" if meant else str(error)) from None


def _read(text: str, kind: Kind) -> float:
    number = _NUMBER.match(text)
    if number is None:
        raise ValueError(f"must be {kind.valid}")
    unit = text[number.end() :].strip()
    if not unit:
        raise ValueError(f"must be {kind.valid}; the unit is missing")
    if len(unit) > _LONGEST_UNIT or not plain_units.PATTERN.fullmatch(unit):
        raise ValueError(f"must be {kind.valid}")
    factor = _find_si_factor("1" + unit if unit.startswith("/") else unit, kind)
    if not isfinite(float(number[0])):
        raise ValueError(f"must be finite: {kind.valid}")
    value = float(Decimal(number[0]) * factor) if abs(float(number[0])) < LARGEST else inf
    if value != 0 and not SMALLEST < abs(value) < LARGEST:
        raise ValueError(
            f"must be {kind.valid}, between {SMALLEST:g} and {LARGEST:g} {kind.si} in magnitude"
        )
    return value


def write_quantity(value: float, unit: str) -> str:
    """Return a value with four digits and a sensible SI prefix, such as ``"-8.609 nN"``."""
    if unit not in _PREFIXED or value == 0 or not isfinite(value):
        return f"{value:.4g} {unit}".removesuffix(" 1").strip()
    rounded = float(f"{value:.3e}")
    exponent = 3 * floor(log10(abs(rounded)) / 3 + 1e-12)
    exponent = min(max(exponent, min(_PREFIXES)), max(_PREFIXES))
    return f"{rounded / 10.0**exponent:.4g} {_PREFIXES[exponent]}{unit}"


def choose_prefix(largest: float, unit: str) -> tuple[float, str]:
    """Return the factor from SI to the prefix that suits a magnitude, and the prefixed unit."""
    exponent = 3 * floor(log10(largest) / 3 + 1e-12) if largest > 0 else 0
    exponent = min(max(exponent, min(_PREFIXES)), max(_PREFIXES))
    return 10.0**-exponent, f"{_PREFIXES[exponent]}{unit}"
