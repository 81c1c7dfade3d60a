#!/usr/bin/env bash
# A NetCDF-4 file may keep the values of a variable in any other file (HDF5's external storage, or a
# virtual data set), and nothing tells: xarray with h5netcdf loads them as its own, dimensions and
# all. A program that
# loads what others send and gives it back gives away files of its own machine.
#
# Seen with h5py 3.16.0 (HDF5 2.0.0), h5netcdf 1.8.2, xarray 2026.9.0, numpy 2.4.6:
#   external storage: b'not for others'
#   virtual data set: [1.0, 2.0, 3.0]
set -euo pipefail

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    h5py==3.16.0 h5netcdf==1.8.2 xarray==2026.9.0 numpy==2.4.6
"$folder/venv/bin/python" - "$folder" <<'PYTHON'
import sys
from pathlib import Path

import h5py
import numpy as np
import xarray

folder = Path(sys.argv[1])
(folder / "other.txt").write_bytes(b"not for others")
with h5py.File(folder / "other.h5", "w") as other:
    other["x"] = np.array([1.0, 2.0, 3.0])
with h5py.File(folder / "sent.nc", "w") as sent:
    text = sent.create_dataset("t", (14,), "u1", external=[(str(folder / "other.txt"), 0, 14)])
    text.make_scale("t")
    layout = h5py.VirtualLayout((3,), "f8")
    layout[:] = h5py.VirtualSource(str(folder / "other.h5"), "x", (3,))
    sent.create_virtual_dataset("x", layout).make_scale("x")

found = xarray.load_dataset(folder / "sent.nc", engine="h5netcdf")
print("external storage:", bytes(found["t"].values))
print("virtual data set:", found["x"].values.tolist())
assert bytes(found["t"].values) == b"not for others"
assert found["x"].values.tolist() == [1.0, 2.0, 3.0]
PYTHON
