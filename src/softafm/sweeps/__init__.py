"""Sweeps: an experiment for many values of its fields, on Dask, in a Zarr store."""
