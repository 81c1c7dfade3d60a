"""Read measured columns, and motions, from CSV files that name their units."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from softafm.motions import Trajectory
from softafm.tables import Table
from softafm.units import LENGTH, TIME, Kind


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
    """Read columns of a text file in SI, in the order that they are asked for.

    Parameters
    ----------
    path
        File as ``softafm.tables.Table`` reads it; further columns are ignored.
    columns
        The kind of quantity for the name of each column.
    example
        A header as it should be.

    Raises
    ------
    ValueError
        As ``Table`` and its ``column`` and ``in_si``; the message names the line.
    """
    table = Table(path, example)
    found = [(table.column(name), kind) for name, kind in columns.items()]
    return [table.in_si(column, kind) for column, kind in found]
