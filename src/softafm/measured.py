"""Read a measured motion from a CSV file."""

import csv
import re
from pathlib import Path

import numpy as np

from softafm.motions import Trajectory
from softafm.units import LENGTH, TIME, read_quantity

LARGEST_FILE = 100_000_000
_COLUMN = re.compile(r"\s*(\w+)\s*[(\[](.*)[)\]]\s*")


def read_trajectory(path: Path) -> Trajectory:
    """Read columns ``time`` and ``height`` of a CSV file whose header names their units.

    The header reads, for example, ``time (us),height (nm)``; other columns are ignored.

    Raises
    ------
    ValueError
        If the file cannot be read, lacks a column or a unit, or holds something that is not a
        motion; the message names the line.
    """
    try:
        rows = list(csv.reader(_text(path).splitlines()))
    except csv.Error as error:
        raise ValueError(f"is not a CSV file: {error}") from None
    if not rows:
        raise ValueError("is empty; its first line must read, for example, 'time (us),height (nm)'")
    (i, second), (j, metre) = _column(rows[0], "time", TIME), _column(rows[0], "height", LENGTH)
    samples = []
    for line, row in enumerate(rows[1:], start=2):
        if not any(entry.strip() for entry in row):
            continue
        try:
            samples.append((float(row[i]), float(row[j])))
        except (ValueError, IndexError):
            shown = ",".join(row)[:60]
            raise ValueError(f"line {line} ({shown!r}) must hold a time and a height") from None
    time, height = np.array(samples, float).reshape(-1, 2).T
    return Trajectory(time * second, height * metre)


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


def _column(header: list[str], name: str, kind) -> tuple[int, float]:
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
        f"has no column '{name}' with a unit; its first line must read, for example, "
        "'time (us),height (nm)'"
    )
