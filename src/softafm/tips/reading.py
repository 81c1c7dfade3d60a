"""Read the measured profile of a tip from a CSV file."""

from pathlib import Path

from softafm.measured import read_columns
from softafm.tips.measured import MeasuredTip
from softafm.units import LENGTH


def read_tip_profile(path: str | Path) -> MeasuredTip:
    """Read a tip from columns ``radius`` and ``height`` of a CSV file.

    Parameters
    ----------
    path
        CSV file whose header names the units, for example ``radius (nm),height (nm)``; other
        columns are ignored.

    Raises
    ------
    ValueError
        If the file cannot be read, lacks a column or a unit, or holds what is no profile; the
        message names the line, or the entry counted from 0, of what is wrong.
    """
    columns = {"radius": LENGTH, "height": LENGTH}
    r, height = read_columns(path, columns, "radius (nm),height (nm)")
    return MeasuredTip(tuple(r.tolist()), tuple(height.tolist()))
