"""Read a surface law from a CSV file."""

from pathlib import Path

from softafm.files.measured import read_columns
from softafm.surfaces.tabulated import Tabulated
from softafm.units.quantities import LENGTH, PRESSURE


def read_law(path: str | Path) -> Tabulated:
    """Read a law from columns ``gap`` and ``pressure`` of a CSV file, positive = repulsive.

    Parameters
    ----------
    path
        CSV file whose header names the units, for example ``gap (nm),pressure (MPa)``; other
        columns are ignored.

    Raises
    ------
    ValueError
        If the file cannot be read, lacks a column or a unit, or holds what is no law; the message
        names the line, or the entry counted from 0, of what is wrong.
    """
    columns = {"gap": LENGTH, "pressure": PRESSURE}
    gap, pressure = read_columns(path, columns, "gap (nm),pressure (MPa)")
    return Tabulated(tuple(gap.tolist()), tuple(pressure.tolist()))
