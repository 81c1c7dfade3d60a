"""Tables of measured moduli, as rheometers and papers give them."""

from collections.abc import Mapping
from math import pi
from pathlib import Path
from typing import NamedTuple

import numpy as np

from softafm.checks.validate import check_poisson_ratio
from softafm.files.tables import Column, Table, quote
from softafm.rheology.closest import refuse_impossible
from softafm.rheology.dma import sort_moduli
from softafm.units.quantities import (
    ANGLE,
    ANGULAR_FREQUENCY,
    FREQUENCY,
    MODULUS,
    Kind,
    read_quantity,
)

EXAMPLE = "frequency (Hz),storage (MPa),loss (MPa)"
_FREQUENCY = "frequency", "freq", "freq.", "f", "oscillation frequency", "test frequency"
_ANGULAR = (
    *("angular frequency", "ang. frequency", "angular freq.", "circular frequency"),
    *("omega", "ω", "frequency ω", "angular frequency ω", "w"),
)
_TANGENT = (
    *("tan δ", "tanδ", "tan(δ)", "tan delta", "tandelta", "tan(delta)"),
    *("loss factor", "loss tangent", "damping factor"),
)
_PHASE = "δ", "delta", "phase angle", "phase angle δ", "phase shift", "loss angle", "phase lag"
_MARKS = {"storage": "'", "loss": "''", "complex": "*"}
_WITHOUT_UNIT = "", "1", "-", "–", "δ", "delta"
"""Units of tan δ; the last two stand in the brackets of its name."""


class DynamicModuli(NamedTuple):
    """Moduli by rising frequency (Hz): storage and loss (Pa), in shear or of Young, each (n,)."""

    frequency: np.ndarray
    storage: np.ndarray
    loss: np.ndarray
    shear: bool

    def young(self, poisson: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return frequency, and Young's moduli: E = 2(1 + ν)G."""
        factor = 2 * (1 + check_poisson_ratio(poisson)) if self.shear else 1.0
        return self.frequency, factor * self.storage, factor * self.loss


def read_dma(
    path: str | Path, poisson: float | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Read frequency (Hz), and Young's storage and loss modulus (Pa), from a CSV file.

    Parameters
    ----------
    path
        CSV file whose header names the units, for example
        ``frequency (Hz),storage (MPa),loss (MPa)``. The frequency may be in rad/s, the moduli E',
        E'' or G', G'', or one of them, or the magnitude of E* or G*, with tan δ or δ. A modulus
        that is not said to be in shear is Young's. Other columns are ignored.
    poisson
        Poisson's ratio, by which shear moduli become Young's, E = 2(1 + ν)G; in (-1, 0.5].

    Returns
    -------
    frequency, storage, loss
        Of shape (n,), by rising frequency.

    Raises
    ------
    ValueError
        If the file cannot be read, lacks a column or a unit, or holds what no passive solid has; or
        if it holds shear moduli and there is no Poisson's ratio.
    """
    moduli = read_moduli(path)
    if not moduli.shear:
        return moduli[:3]
    if poisson is None:
        raise ValueError("holds shear moduli: needs poisson, Poisson's ratio, for E = 2(1 + ν)G")
    return moduli.young(poisson)


def read_moduli(path: str | Path) -> DynamicModuli:
    """Read moduli in shear, or Young's, as ``read_dma``."""
    table = Table(path, EXAMPLE)
    named = {
        letter: {word: table.find(*_find_names(letter, word)) for word in _MARKS} for letter in "EG"
    }
    unsaid = {word: table.find(word, f"{word} modulus") for word in _MARKS}
    shear = any(named["G"].values()) and not any(named["E"].values())
    for letter in "EG":
        columns = named[letter]
        if shear == (letter == "G"):
            columns = {word: column or unsaid[word] for word, column in columns.items()}
        moduli = _read_storage_and_loss(table, columns)
        if moduli:
            data = sort_moduli(_read_frequency(table), *moduli)
            refuse_impossible(*data)
            return DynamicModuli(*data, letter == "G")
    if not any([*unsaid.values(), *named["E"].values(), *named["G"].values()]):
        table.column("storage")
    raise ValueError(
        "has not two columns that belong together: it needs E' and E'', or G' and G'', or one of "
        "them or |E*| or |G*| with tan δ or δ"
    )


def _find_names(letter: str, word: str) -> tuple[str, ...]:
    """Return what a modulus is called that is said to be Young's (E) or in shear (G)."""
    symbol, name = f"{letter}{_MARKS[word]}", f"{word} modulus"
    kinds = ("shear",) if letter == "G" else ("tensile", "Young's")
    return (
        *(symbol, f"|{symbol}|", f"{name} {symbol}", f"{symbol} {name}", f"{name}, {symbol}"),
        *(f"{kind} {name}" for kind in kinds),
        *(f"{word} {kind} modulus" for kind in kinds),
    )


def _read_storage_and_loss(
    table: Table, columns: Mapping[str, Column | None]
) -> tuple[np.ndarray, np.ndarray] | None:
    """Return storage and loss modulus, Pa, of the columns of one kind, if they suffice."""
    moduli = {word: table.in_si(c, MODULUS) for word, c in columns.items() if c is not None}
    if {"storage", "loss"} <= moduli.keys():
        return moduli["storage"], moduli["loss"]
    tangent = _read_tangent(table) if moduli else None
    if tangent is None:
        return None
    if "storage" in moduli:
        return moduli["storage"], tangent * moduli["storage"]
    if "loss" in moduli:
        return moduli["loss"] / tangent, moduli["loss"]
    storage = moduli["complex"] / np.hypot(1, tangent)
    return storage, tangent * storage


def _read_tangent(table: Table) -> np.ndarray | None:
    """Return tan δ, if the table has it or the angle."""
    column = table.find(*_TANGENT)
    if column is not None:
        if column.unit not in _WITHOUT_UNIT:
            raise ValueError(
                f"column {quote(column.title)} must have no unit, not {quote(column.unit)}"
            )
        tangent = table.numbers(column)
        _refuse(table, column.name, tangent, "", tangent > 0, "above 0")
        return tangent
    column = table.find(*_PHASE)
    if column is None:
        return None
    angle = table.in_si(column, ANGLE)
    sharp = (angle > 0) & (angle < pi / 2)
    _refuse(table, column.name, np.degrees(angle), " deg", sharp, "above 0 and below 90")
    return np.tan(angle)


def _refuse(
    table: Table, name: str, values: np.ndarray, unit: str, valid: np.ndarray, words: str
) -> None:
    for row in np.flatnonzero(~valid).tolist():
        raise ValueError(f"{table.place(row)}: {name} = {values[row]:g}{unit}: must be {words}")


def _read_frequency(table: Table) -> np.ndarray:
    """Return frequencies in Hz; what may be in rad/s or in Hz is refused."""
    column = table.find(*_FREQUENCY)
    angular = table.find(*_ANGULAR) if column is None else None
    if angular is not None:
        per_second = _measures(angular.unit, FREQUENCY) and "hz" not in angular.unit.casefold()
        return table.in_si(angular, FREQUENCY if per_second else ANGULAR_FREQUENCY) / (2 * pi)
    column = table.column(*_FREQUENCY)
    if _measures(column.unit, ANGULAR_FREQUENCY):
        return table.in_si(column, ANGULAR_FREQUENCY) / (2 * pi)
    if _measures(column.unit, FREQUENCY) and "hz" not in column.unit.casefold():
        raise ValueError(
            f"column {quote(column.title)} may be in Hz or in rad/s: write which of them"
        )
    return table.in_si(column, FREQUENCY)


def _measures(unit: str, kind: Kind) -> bool:
    try:
        read_quantity(f"1 {unit}", kind)
    except ValueError:
        return False
    return True
