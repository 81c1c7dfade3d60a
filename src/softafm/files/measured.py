"""Read measured columns, and motions, from CSV files that name their units."""

from collections.abc import Mapping
from pathlib import Path
from typing import Literal

import numpy as np

from softafm.files.tables import Table, quote
from softafm.instrument.motions import Trajectory
from softafm.units.quantities import LENGTH, TIME, Kind

Moves = Literal["tip", "base"]


def read_trajectory(path: str | Path, moves: Moves = "tip") -> Trajectory:
    """Read a motion from columns ``time`` and ``height`` of a CSV file, straight between its rows.

    Parameters
    ----------
    path
        CSV file that names the units, for example ``time (us),height (nm)``, or a curve that
        ``softafm.export`` wrote; other columns are ignored.
    moves
        As in ``read_path``.

    Raises
    ------
    ValueError
        As ``read_path`` and ``Trajectory``.
    """
    return Trajectory(*read_path(path, moves))


def read_base_trajectory(path: str | Path) -> Trajectory:
    """Read a motion of the base of a lever, as ``read_trajectory``."""
    return read_trajectory(path, "base")


def read_path(path: str | Path, moves: Moves = "tip") -> tuple[np.ndarray, np.ndarray]:
    """Read times (s) and heights (m) from a CSV file, to draw a ``Trajectory`` by.

    Parameters
    ----------
    path
        As in ``read_trajectory``.
    moves
        ``"tip"``, or ``"base"`` for that of a lever: whose height it is, ``tip_height`` or
        ``base_height``, if the file has both. If it has one, or ``height`` instead, that is taken.

    Raises
    ------
    ValueError
        As ``Table``, its ``column`` and ``in_si``; if it has ``height`` and another of them; if the
        times do not rise.
    """
    if moves not in ("tip", "base"):
        raise ValueError(f"moves = {moves!r}: must be 'tip' or 'base'")
    table = Table(path, "time (us),height (nm)")
    found = [c for c in map(table.find, ("height", "tip_height", "base_height")) if c is not None]
    if len(found) > 1 and found[0].name == "height":
        titles = " and ".join(quote(column.title) for column in found)
        raise ValueError(f"has columns {titles}, any of which may be the motion; leave one")
    name = found[0].name if len(found) == 1 else f"{moves}_height" if found else "height"
    time = table.in_si(table.column("time"), TIME)
    for row in np.flatnonzero(np.diff(time) <= 0).tolist():
        raise ValueError(f"{table.place(row + 1)}: 'time' must be later than in {table.place(row)}")
    return time, table.in_si(table.column(name), LENGTH)


def read_columns(path: str | Path, columns: Mapping[str, Kind], example: str) -> list[np.ndarray]:
    """Read columns of a text file in SI, in the order that they are asked for.

    Parameters
    ----------
    path
        File as ``softafm.files.tables.Table`` reads it; further columns are ignored.
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
