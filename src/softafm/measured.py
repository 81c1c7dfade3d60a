"""Read measured columns, and motions, from CSV files whose headers name their units."""

import csv
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from softafm.motions import Trajectory
from softafm.units import LENGTH, TIME, Kind, read_quantity

LARGEST_FILE = 100_000_000
_COLUMN = re.compile(r"\s*(\w+)\s*[(\[](.*)[)\]]\s*")


def read_trajectory(path: Path) -> Trajectory:
    """Read a motion from columns ``time`` and ``height`` of a CSV file.

    Parameters
    ----------
    path
        CSV file whose header names the units, for example ``time (us),height (nm)``; other
        columns are ignored.

    Raises
    ------
    ValueError
        As ``read_columns``, and as ``Trajectory``.
    """
    time, height = read_columns(path, {"time": TIME, "height": LENGTH}, "time (us),height (nm)")
    return Trajectory(time, height)


def read_columns(path: str | Path, columns: Mapping[str, Kind], example: str) -> list[np.ndarray]:
    """Read columns of a CSV file by name, in SI, in the order that they are asked for.

    The header names the units, as ``example`` does; other columns are ignored.

    Raises
    ------
    ValueError
        If the file cannot be read, lacks a column or a unit, or holds something that is not a
        number; the message names the line.
    """
    try:
        rows = list(csv.reader(_text(Path(path)).splitlines()))
    except csv.Error as error:
        raise ValueError(f"is not a CSV file: {error}") from None
    if not rows:
        raise ValueError(f"is empty; its first line must read, for example, '{example}'")
    places = [_column(rows[0], name, kind, example) for name, kind in columns.items()]
    samples = []
    for line, row in enumerate(rows[1:], start=2):
        if not any(entry.strip() for entry in row):
            continue
        try:
            samples.append([float(row[index]) * unit for index, unit in places])
        except (ValueError, IndexError):
            shown = ",".join(row)[:60]
            wanted = " and a ".join(columns)
            raise ValueError(f"line {line} ({shown!r}) must hold a {wanted}") from None
    return list(np.array(samples, float).reshape(-1, len(places)).T)


def _text(path: Path) -> str:
    try:
        if not path.is_file():
            raise ValueError("is a directory" if path.is_dir() else "no such file")
        if path.stat().st_size > LARGEST_FILE:
            raise ValueError(f"is larger than {LARGEST_FILE // 1_000_000} MB")
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise ValueError(error.strerror or "cannot be read") from None
    except UnicodeDecodeError:
        raise ValueError("is not text in UTF-8") from None


def _column(header: list[str], name: str, kind: Kind, example: str) -> tuple[int, float]:
    """Return the index of the column ``name`` and its unit in SI."""
    for index, entry in enumerate(header):
        match = _COLUMN.fullmatch(entry)
        if match and match[1].lower() == name:
            try:
                return index, read_quantity(f"1 {match[2]}", kind)
            except ValueError:
                raise ValueError(
                    f"column {entry.strip()[:60]!r} must name a unit of {kind.noun}"
                ) from None
    raise ValueError(
        f"has no column '{name}' with a unit; its first line must read, for example, '{example}'"
    )
