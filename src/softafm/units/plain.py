"""Units written by their symbols, such as ``"mJ/m^2"``, read without a library for units.

To import one and to fill its registry takes longer than most runs.
"""

import re
from collections import Counter
from decimal import Decimal
from functools import cache
from typing import NamedTuple

SYMBOL = "[A-Za-zµμΩÅ°%]+"
_POWER = r"(?:\^|\*\*)-?\d|⁻?[¹²³]"
_POWERED = f"{SYMBOL}(?:{_POWER})?"
PATTERN = re.compile(rf"(?:1? ?/ ?)?{_POWERED}(?: ?[*/·] ?{_POWERED}| {_POWERED})*")
"""How any unit is written: symbols with powers, after ``*``, ``/``, ``·`` or a space."""

_FACTOR = re.compile(rf"([*/·]?) ?({SYMBOL})({_POWER})?")
_DIGITS = str.maketrans("⁻¹²³", "-123", "^*")
_PREFIXES = {
    "": 0, "a": -18, "f": -15, "p": -12, "n": -9, "u": -6, "µ": -6, "μ": -6, "m": -3, "c": -2,
    "d": -1, "k": 3, "M": 6, "G": 9, "T": 12,
}  # fmt: skip
_BASES: dict[str, tuple[str, dict[str, int]]] = {
    "m": ("1", {"m": 1}),
    "Å": ("1e-10", {"m": 1}),
    "g": ("1e-3", {"kg": 1}),
    "s": ("1", {"s": 1}),
    "K": ("1", {"K": 1}),
    "mol": ("1", {"mol": 1}),
    "rad": ("1", {"rad": 1}),
    "deg": ("0.0174532925199433", {"rad": 1}),
    "°": ("0.0174532925199433", {"rad": 1}),
    "Hz": ("1", {"s": -1}),
    "N": ("1", {"kg": 1, "m": 1, "s": -2}),
    "J": ("1", {"kg": 1, "m": 2, "s": -2}),
    "Pa": ("1", {"kg": 1, "m": -1, "s": -2}),
    "V": ("1", {"kg": 1, "m": 2, "s": -3, "A": -1}),
    "L": ("1e-3", {"m": 3}),
    "l": ("1e-3", {"m": 3}),
}
"""Of each symbol how many SI units it is, and the powers of the SI's base units and the radian."""

SYMBOLS = {
    prefix + base: (Decimal(factor).scaleb(exponent), roots)
    for base, (factor, roots) in _BASES.items()
    for prefix, exponent in _PREFIXES.items()
}
"""All symbols with all prefixes."""


class Plain(NamedTuple):
    """How many SI units a unit is, and the powers of the base units it consists of.

    The radian is one of them: an angular frequency is no frequency.
    """

    factor: Decimal
    roots: frozenset[tuple[str, int]]


@cache
def parse(unit: str) -> Plain | None:
    """Return what a unit that matches ``PATTERN`` is; None if it has an unknown symbol."""
    value, powers = Decimal(1), Counter[str]()
    for operator, symbol, power in _FACTOR.findall(unit):
        if symbol not in SYMBOLS:
            return None
        factor, roots = SYMBOLS[symbol]
        exponent = int(power.translate(_DIGITS) or 1) * (-1 if operator == "/" else 1)
        value *= factor**exponent
        for root, times in roots.items():
            powers[root] += times * exponent
    return Plain(value, frozenset((root, times) for root, times in powers.items() if times))
