"""Read the measured profile of a tip from a CSV file."""

import csv
from pathlib import Path

from softafm.measured import _column, _text
from softafm.tips.measured import MeasuredTip
from softafm.units import LENGTH

HEADER = "radius (nm),height (nm)"


def read_tip_profile(path: str | Path) -> MeasuredTip:
    """Read a tip from columns ``radius`` (or ``r``) and ``height`` of a CSV file.

    The header names the units, for example ``radius (nm),height (nm)``; other columns are ignored.

    Raises
    ------
    ValueError
        If the file cannot be read, lacks a column or a unit, or holds what is no profile; the
        message names the line, or the entry counted from 0, of what is wrong.
    """
    try:
        rows = list(csv.reader(_text(Path(path)).splitlines()))
    except csv.Error as error:
        raise ValueError(f"is not a CSV file: {error}") from None
    header = rows[0] if rows else []
    names = {entry.strip().partition(" ")[0].lower() for entry in header}
    columns = [_named(header, "r" if "r" in names else "radius"), _named(header, "height")]
    values = []
    for line, row in enumerate(rows[1:], start=2):
        if not any(entry.strip() for entry in row):
            continue
        try:
            values.append([float(row[index]) * metre for index, metre in columns])
        except (ValueError, IndexError):
            shown = ",".join(row)[:60]
            raise ValueError(f"line {line} ({shown!r}) must hold a radius and a height") from None
    return MeasuredTip(tuple(r for r, _ in values), tuple(height for _, height in values))


def _named(header: list[str], name: str) -> tuple[int, float]:
    try:
        return _column(header, name, LENGTH)
    except ValueError as error:
        wrong = str(error).partition("; its first line")[0]
        raise ValueError(f"{wrong}; its first line must read, for example, '{HEADER}'") from None
