"""Read a surface law from a CSV file."""

import csv
from pathlib import Path

from softafm.measured import _column, _text
from softafm.surfaces.tabulated import Tabulated
from softafm.units import LENGTH, MODULUS

HEADER = "gap (nm),pressure (MPa)"


def read_law(path: str | Path) -> Tabulated:
    """Read a law from columns ``gap`` and ``pressure`` of a CSV file, positive = repulsive.

    The header names the units, for example ``gap (nm),pressure (MPa)``; other columns are ignored.

    Raises
    ------
    ValueError
        If the file cannot be read, lacks a column or a unit, or holds what is no law; the message
        names the line, or the entry counted from 0, of what is wrong.
    """
    try:
        rows = list(csv.reader(_text(Path(path)).splitlines()))
    except csv.Error as error:
        raise ValueError(f"is not a CSV file: {error}") from None
    header = rows[0] if rows else []
    columns = [_named(header, "gap", LENGTH), _named(header, "pressure", MODULUS)]
    values = []
    for line, row in enumerate(rows[1:], start=2):
        if not any(entry.strip() for entry in row):
            continue
        try:
            values.append([float(row[index]) * unit for index, unit in columns])
        except (ValueError, IndexError):
            shown = ",".join(row)[:60]
            raise ValueError(f"line {line} ({shown!r}) must hold a gap and a pressure") from None
    return Tabulated(tuple(gap for gap, _ in values), tuple(pressure for _, pressure in values))


def _named(header: list[str], name: str, kind) -> tuple[int, float]:
    try:
        return _column(header, name, kind)
    except ValueError as error:
        wrong = str(error).partition("; its first line")[0].replace("a modulus", "a pressure")
        raise ValueError(f"{wrong}; its first line must read, for example, '{HEADER}'") from None
