"""Read the measured profile of a tip from a CSV file."""

from pathlib import Path

from softafm.files.tables import Table
from softafm.tips.measured import MeasuredTip
from softafm.units.quantities import LENGTH


def read_tip_profile(path: str | Path) -> MeasuredTip:
    """Read a tip from columns ``radius``, or ``r``, and ``height`` of a CSV file.

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
    table = Table(path, "radius (nm),height (nm)")
    r, height = (
        table.in_si(c, LENGTH) for c in (table.column("radius", "r"), table.column("height"))
    )
    return MeasuredTip(tuple(r.tolist()), tuple(height.tolist()))
