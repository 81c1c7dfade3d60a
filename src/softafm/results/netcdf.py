"""The NetCDF-4 file of a result, with all that xarray would write into it.

Where dask is installed xarray imports it before it writes anything, which takes half a second.
"""

from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from xarray import Dataset, Variable


def make_file_content(result: "Dataset") -> bytes:
    """Return the content of a NetCDF-4 file that holds a dataset."""
    if not _is_plain(result):
        return bytes(result.to_netcdf(engine="h5netcdf"))
    import h5netcdf

    content = BytesIO()
    with h5netcdf.File(content, "w") as file:
        file.dimensions = dict(result.sizes)
        file.attrs.update(result.attrs)
        for name in (*result.data_vars, *result.coords):
            _write(file, str(name), result.variables[name])
    return content.getvalue()


def _is_plain(result: "Dataset") -> bool:
    """Return whether a dataset is like those that modes return: nothing about it to be encoded."""
    return set(result.coords) <= set(result.dims) and all(
        isinstance(variable.values, np.ndarray)
        and variable.dtype.kind in "fU"
        and not variable.encoding
        and "_FillValue" not in variable.attrs
        for variable in result.variables.values()
    )


def _write(file: Any, name: str, variable: "Variable") -> None:
    import h5py

    text = variable.dtype.kind == "U"
    values = variable.values.astype(object) if text else variable.values
    written = file.create_variable(
        name,
        variable.dims,
        dtype=h5py.string_dtype() if text else variable.dtype,
        fillvalue=None if text else np.nan,
    )
    written[...] = values
    written.attrs.update(variable.attrs)
