"""Maps as files of Gwyddion, the program in which AFM images are looked at (gwyddion.net)."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from softafm.checks.kinds import refuse_non_dataset
from softafm.results.datasets import write_whole

if TYPE_CHECKING:
    from xarray import Dataset

_UNITS = {"degree": "deg", "1": "", "J/m²": "J/m^2"}
_FIRST = ("topography", "phase", "dissipation", "force_min", "loop_energy")
_GOLD = "Gold"


def export_gwyddion(result: "Dataset", path: str | Path, *, overwrite: bool = False) -> None:
    """Write the maps of a ``scan`` to a .gwy file, a channel each; pixels of NaN are masked.

    The file appears whole or not at all.

    Raises
    ------
    ValueError
        If the suffix is not .gwy, or the dataset holds no map.
    ImportError
        If the package gwyfile is missing.
    FileExistsError
        If the path exists and ``overwrite`` is False.
    OSError
        If the folder does not exist or cannot be written.
    """
    if not str(path).lower().endswith(".gwy"):
        raise ValueError(f"{path}: suffix must be .gwy")
    refuse_non_dataset("result", result)
    names = [str(name) for name, each in result.data_vars.items() if each.dims == ("y", "x")]
    if not names:
        raise ValueError("the dataset holds no maps over (y, x): only those of a scan have a .gwy")
    try:
        from gwyfile.objects import GwyContainer, GwyDataField, GwySIUnit
    except ImportError:
        raise ImportError(
            "gwyfile is missing, which writes .gwy files: pip install 'softafm[maps]'"
        ) from None

    x, y = result["x"].values, result["y"].values
    extent = {"xreal": float(x[0] + x[-1]), "yreal": float(y[0] + y[-1])}

    def channel(values: np.ndarray, unit: str) -> Any:
        return GwyDataField(
            np.ascontiguousarray(values, float), **extent,
            si_unit_xy=GwySIUnit(unitstr="m"), si_unit_z=GwySIUnit(unitstr=unit),
        )  # fmt: skip

    content = GwyContainer()
    first = [name for name in _FIRST if name in names]
    for number, name in enumerate(first + [name for name in names if name not in first]):
        variable = result[name]
        values, missing = variable.values, ~np.isfinite(variable.values)
        unit = variable.attrs.get("units", "")
        middle = float(values[~missing].mean()) if not missing.all() else 0.0
        content[f"/{number}/data"] = channel(
            np.where(missing, middle, values), _UNITS.get(unit, unit)
        )
        content[f"/{number}/data/title"] = name
        if missing.any():
            content[f"/{number}/mask"] = channel(missing, "")
        if variable.attrs.get("units") == "m":
            content[f"/{number}/base/palette"] = _GOLD
        texts = {
            "long_name": variable.attrs.get("long_name", name),
            **{key: str(result.attrs.get(key, "")) for key in _META},
        }
        content[f"/{number}/meta"] = GwyContainer(
            {key: text for key, text in texts.items() if text}
        )
    write_whole(path, overwrite, content.tofile)


_META = ("mode", "experiment", "solver", "softafm_version", "created", "warnings")
