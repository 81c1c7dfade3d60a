"""What somebody may have meant who wrote a quantity that cannot be read, such as ``"5,0 um"``."""

import re
from collections.abc import Iterator
from itertools import islice, product

from softafm.units.plain import PATTERN, SYMBOL, SYMBOLS, parse

_LONGEST = 60
_MOST_CASES = 64
_NUMBER = re.compile(
    r"([+\-−]?[\d.,]*\d[\d.,]*)(?: ?[·×*x] ?10\^?([+\-−]?\d{1,3})|([eE][+\-−]?\d{1,3}))?"
)
_SIGNS = str.maketrans("−⋅×.", "-···")
_AROUND = " .,;:[](){}\"'"


def respell(text: str, si: str) -> list[str]:
    """Return quantities that measure what the unit ``si`` does and are written nearly as ``text``.

    An ambiguous one gives several, such as a comma that may group thousands; most give none.
    """
    joined = _join_thousands(text)
    number = _NUMBER.match(joined) if len(text) <= _LONGEST else None
    if number is None:
        return []
    units = _respell_unit(joined[number.end() :].strip(_AROUND), si)
    found = [f"{value} {unit}" for value in _respell_digits(*number.groups()) for unit in units]
    return [spelling for spelling in found if spelling != text]


def respell_number(text: str) -> list[str]:
    """Return plain numbers that are written nearly as ``text``, such as 0.49 for ``"0,49"``."""
    number = _NUMBER.fullmatch(_join_thousands(text)) if len(text) <= _LONGEST else None
    if number is None:
        return []
    # As TOML has them: with digits on both sides of the point.
    found = [re.sub(r"^([+-]?)\.", r"\g<1>0.", each) for each in _respell_digits(*number.groups())]
    found = [re.sub(r"\.(?=e|$)", "", each) for each in found]
    return [spelling for spelling in found if spelling != text]


def _join_thousands(text: str) -> str:
    """Return a text without the spaces that group the thousands of its number."""
    grouped = re.match(r"[+\-−]?\d{1,3}(?: \d{3})+(?!\d)", text)
    return text if grouped is None else grouped[0].replace(" ", "") + text[grouped.end() :]


def _respell_digits(digits: str, power: str | None, exponent: str | None) -> list[str]:
    """Return a number with a decimal point in place of a comma, and an exponent after an e."""
    digits = digits.replace("−", "-")
    end = (f"e{int(power.replace('−', '-'))}" if power else exponent or "").replace("−", "-")
    whole, comma, rest = digits.partition(",")
    if not comma:
        return [digits + end] if digits.count(".") < 2 else []
    if "." in whole and "," not in rest:
        return [whole.replace(".", "") + "." + rest + end]
    grouped = re.fullmatch(r"[+-]?\d{1,3}(,\d{3})+(\.\d*)?", digits)
    decimal = "," not in rest and "." not in rest
    readings = [f"{whole}.{rest}"] * decimal + [digits.replace(",", "")] * bool(grouped)
    return [reading + end for reading in readings]


def _respell_unit(unit: str, si: str) -> list[str]:
    """Return the units like ``unit`` that measure what ``si`` does: of its own case if any is."""
    tidy = re.sub(rf"(?<={SYMBOL[:-1]})(-?\d)", r"^\1", unit.translate(_SIGNS))
    shapes = [
        tidy,
        tidy.replace(" ", ""),
        re.sub(r"(?<=\w)(s)$", r" \1", tidy, flags=re.IGNORECASE),
    ]
    for spellings in (shapes, [cased for shape in shapes for cased in _list_cases(shape)]):
        fitting = [spelling for spelling in spellings if _measures(spelling, si)]
        if fitting:
            return list(dict.fromkeys(fitting))
    return []


def _list_cases(unit: str) -> Iterator[str]:
    """Yield the unit with its symbols in all cases in which they are known."""
    parts = re.split(f"({SYMBOL})", unit)
    choices = [_BY_CASELESS.get(part.casefold(), [part]) for part in parts]
    yield from islice(map("".join, product(*choices)), _MOST_CASES)


def _measures(unit: str, si: str) -> bool:
    plain, wanted = parse(unit) if PATTERN.fullmatch(unit) else None, parse(si)
    return plain is not None and wanted is not None and plain.roots == wanted.roots


_BY_CASELESS: dict[str, list[str]] = {}
for _symbol in SYMBOLS:
    _BY_CASELESS.setdefault(_symbol.casefold(), []).append(_symbol)
