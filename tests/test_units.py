"""Quantities with their units: the own reader against pint, and what a misspelling is taken for."""

import re
import subprocess
import sys
from decimal import Decimal

import pint
import pytest

from softafm.units import plain as plain_units
from softafm.units import quantities as units
from softafm.units.quantities import Kind, read_quantity

KINDS = {kind.noun: kind for kind in vars(units).values() if isinstance(kind, Kind)}
SPELLINGS = """
m | nm | um | µm | μm | pm | km | Å | cm | s | us | ms | ns | Ms | m/s | nm/s | um/s | µm·s^-1
m*s**-1 | Hz | kHz | MHz | 1/s | s^-1 | s⁻¹ | /s | 1/ s | rad/s | rad | deg | mrad | °
Pa | kPa | MPa | GPa | mPa | N/m² | N/m^2 | N/m**2 | J/m³ | uN/um^2 | V | mV | K | mK | mol/L
mmol/L | mol/m^3 | mol/l | umol/mL | Pa·s | Pa s | kPa*s | J | aJ | zJ | N·m | nN·nm | kg·m^2/s^2
J/m^2 | mJ/m² | mJ / m^2 | mN/m | N | nN | pN | N/m | N m^-1 | mN/m | pN/nm | nN/nm | g | kg | m/s/s
N/m/m | N m / s | 1/Pa | 1/GPa | 1 / GPa | GPa^-1 | /MPa | m^2/N | % | inch | bar | psi | eV | u m
micrometer | dyn/cm | min | nonsense | Mm/ks
"""


@pytest.fixture(scope="module")
def registry():
    return pint.UnitRegistry()


def by_pint(registry, unit: str, kind: Kind) -> Decimal | None:
    """What pint says that a unit is in SI units of a kind; None if it is not of the kind."""
    try:
        factor, roots = registry.get_root_units(registry.parse_units(unit))
    except (pint.UndefinedUnitError, pint.DefinitionSyntaxError):
        return None
    si_factor, si_roots = registry.get_root_units(registry.parse_units(kind.si))
    return Decimal(f"{factor / si_factor:.15g}") if roots == si_roots else None


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_units_are_what_pint_says_to_the_last_digit(registry, kind):
    accepted = 0
    for unit in re.split(r" \| |\n", SPELLINGS.strip()):
        expected = by_pint(registry, "1" + unit if unit.startswith("/") else unit, kind)
        if expected is None:
            with pytest.raises(ValueError, match=r"is not a known unit|does not measure"):
                read_quantity(f"1 {unit}", kind)
        else:
            accepted += 1
            assert read_quantity(f"1 {unit}", kind) == float(expected), unit
    assert accepted >= 1


def test_every_symbol_with_every_prefix_is_what_pint_says(registry):
    for symbol, (factor, roots) in plain_units.SYMBOLS.items():
        value, found = registry.get_root_units(registry.parse_units(symbol))
        si = " * ".join(f"{root}**{times}" for root, times in roots.items())
        si_value, expected = registry.get_root_units(registry.parse_units(si))
        assert (Decimal(f"{value / si_value:.15g}"), found) == (factor, expected), symbol


def test_plain_units_do_not_need_pint():
    read = "\n".join(f"units.read_quantity('3 {kind.si}', {kind!r})" for kind in KINDS.values())
    examples = "\n".join(f"units.read_quantity('{k.example}', {k!r})" for k in KINDS.values())
    imports = "import sys\nfrom softafm.units import quantities as units"
    code = f"{imports}\nfrom softafm.units.quantities import Kind\n{read}\n{examples}"
    subprocess.run([sys.executable, "-c", f"{code}\nassert 'pint' not in sys.modules"], check=True)


@pytest.mark.parametrize(
    ("written", "kind", "meant"),
    [
        ("5,0 um", units.LENGTH, ["5.0 um"]),
        ("1,000 nm", units.LENGTH, ["1.000 nm", "1000 nm"]),
        ("1.234,5 nm", units.LENGTH, ["1234.5 nm"]),
        ("1,234.5 nm", units.LENGTH, ["1234.5 nm"]),
        ("0,1 mol/L", units.CONCENTRATION, ["0.1 mol/L"]),
        ("10 NM", units.LENGTH, ["10 nm"]),
        ("1 u m", units.LENGTH, ["1 um"]),
        ("10 [nm]", units.LENGTH, ["10 nm"]),
        ("5·10^-9 m", units.LENGTH, ["5e-9 m"]),
        ("1 × 10^−9 m", units.LENGTH, ["1e-9 m"]),
        ("−5 nm", units.LENGTH, ["-5 nm"]),
        ("5e−9 m", units.LENGTH, ["5e-9 m"]),
        ("30 mJ/m2", units.ENERGY_PER_AREA, ["30 mJ/m^2"]),
        ("30 mJ m-2", units.ENERGY_PER_AREA, ["30 mJ m^-2"]),
        ("28 N⋅m^-1", units.STIFFNESS, ["28 N·m^-1"]),
        ("28 N.m-1", units.STIFFNESS, ["28 N·m^-1"]),
        ("2 gpa", units.MODULUS, ["2 GPa"]),
        ("2 mpa", units.MODULUS, ["2 mPa", "2 MPa"]),
        ("2 N/m2", units.MODULUS, ["2 N/m^2"]),
        ("278 khz", units.FREQUENCY, ["278 kHz"]),
        ("1 Pas", units.VISCOSITY, ["1 Pa s"]),
        ("1 mPa.s", units.VISCOSITY, ["1 mPa·s"]),
        ("298 k", units.TEMPERATURE, ["298 K"]),
        ("1 MS", units.TIME, ["1 ms", "1 Ms"]),
        ("5 kg", units.LENGTH, []),
        ("1 rad/s", units.FREQUENCY, []),
        ("5.0.0 nm", units.LENGTH, []),
        ("nm 5", units.LENGTH, []),
        ("1e60 m", units.LENGTH, []),
        ("5 nm" + "," * 60, units.LENGTH, []),
    ],
)
def test_what_may_have_been_meant(written, kind, meant):
    with pytest.raises(ValueError, match="must be") as refused:
        read_quantity(written, kind)
    asked = str(refused.value).partition("; did you mean ")[2]
    assert asked == (" or ".join(f"'{spelling}'" for spelling in meant) + "?" if meant else "")
    for spelling in meant:
        assert read_quantity(spelling, kind) > -1


@pytest.mark.parametrize(
    ("written", "kind", "value"),
    [
        ("28 µN·m^-1", units.STIFFNESS, 28e-6),
        ("28 N m^-1", units.STIFFNESS, 28.0),
        ("10nm", units.LENGTH, 1e-8),
        ("1 Å", units.LENGTH, 1e-10),
        ("278kHz", units.FREQUENCY, 278e3),
        ("30 mJ/m²", units.ENERGY_PER_AREA, 0.03),
    ],
)
def test_spellings_that_are_unambiguous_are_read(written, kind, value):
    assert read_quantity(written, kind) == value
