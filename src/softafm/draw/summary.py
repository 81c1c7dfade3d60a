"""A table for people: what a run found."""

import json
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.table import Table

from softafm.draw.approach_data import DIRECTIONS, find_jumps
from softafm.units.quantities import write_quantity

if TYPE_CHECKING:
    from xarray import Dataset

_TINY = 1e-5


def list_observables(dataset: "Dataset") -> Table:
    """Return a table of every scalar of a result, or of the branches and jumps of a sweep."""
    table = make_table(str(dataset.attrs.get("mode", "result")))
    differences = json.loads(dataset.attrs.get("check_differences", "{}"))
    for name, variable in dataset.data_vars.items():
        if variable.ndim == 0 and np.issubdtype(variable.dtype, np.number):
            value = write_quantity(float(variable), variable.attrs.get("units", ""))
            words = str(variable.attrs.get("long_name", ""))
            if name in differences:
                words += f"; check {_write_percent(differences[name])}"
            table.add_row(str(name), value, words)
    if {"y", "x"} <= set(dataset.dims):
        _add_map(table, dataset)
    if "jump_time" in dataset:
        table.add_row("jumps", str(dataset["jump_time"].size), "elastic instabilities crossed")
    if "branch" in dataset.dims:
        _add_branches(table, dataset)
    if "audit" in dataset.attrs:
        _add_audit(table, json.loads(dataset.attrs["audit"]))
    if "check_largest" in dataset.attrs:
        _add_check(table, dataset.attrs, differences)
    if "dma_misfit_largest" in dataset.attrs:
        attributes = dataset.attrs
        row = describe_misfit(attributes["dma_misfit_largest"], attributes["dma_misfit_rms"])
        table.add_row(*row)
    if "regularised_range" in dataset.attrs:
        words = describe_regularisation(
            *(dataset.attrs[name] for name in ("given_tabor", "given_range", "regularised_range"))
        )
        words += describe_slowing(dataset.attrs["edge_slowed"])
        if "regularised_error" in dataset.attrs:
            words += f"; estimated error {_write_percent(dataset.attrs['regularised_error'])}"
        table.add_row("range", write_quantity(dataset.attrs["regularised_range"], "m"), words)
    return table


def _add_audit(table: Table, found: dict[str, Any]) -> None:
    """Add whether a run, or all of many, passed its audit, and how well energy is balanced."""
    passed = "passed" if found["passed"] else "failed"
    if not found["passed"] and "runs" in found:
        passed = f"{found['failed_runs']} of {found['runs']} failed"
    imbalance = found["imbalance"]
    words = "signs, bounds and the end"
    if imbalance is not None:
        words += f"; energy balanced to {_write_percent(imbalance)}"
    table.add_row("audit", passed, words)


def _add_check(table: Table, attributes: dict[str, Any], differences: dict[str, float]) -> None:
    """Add how far a run is from the finer one."""
    if "check_tolerance" in attributes:
        against = f"at tolerance {attributes['check_tolerance']:.4g}"
    else:
        against = "with twice the steps and nodes"
    if not differences:
        table.add_row("check", "failed", f"the run {against} could not be finished")
        return
    worst = max(differences, key=lambda name: abs(differences[name]))
    words = f"largest difference from a run {against}, of {worst}, over its scale"
    table.add_row("check", _write_percent(differences[worst]), words)
    if "check_mean_height" in attributes:
        height = write_quantity(attributes["check_mean_height"], "m")
        table.add_row("check of heights", height, "largest difference")


def _write_percent(share: float) -> str:
    return f"{100 * share:+.2g} %" if abs(share) >= _TINY else f"under {100 * _TINY:g} %"


def _add_branches(table: Table, dataset: "Dataset") -> None:
    """Add how far each branch reaches, and where the lever jumps on approach and retract."""
    branches = map(str, dataset["branch"].values)
    columns = (dataset[name].values for name in ("mean_height", "dissipation", "phase"))
    for branch, height, dissipation, phase in zip(branches, *columns, strict=True):
        found = np.isfinite(height)
        count = int(found.sum())
        words = "amplitudes"
        if count:
            most = write_quantity(float(dissipation[found].max()), "J")
            words += f"; {_write_degrees(phase[found])}, at most {most}"
        table.add_row(branch, f"{count} of {dataset.sizes['amplitude_ratio']}", words)
    for direction in DIRECTIONS:
        for before, after in find_jumps(dataset, direction):
            height = write_quantity(float(dataset["sweep_height"].values[after]), "m")
            amplitude, phase = (
                dataset[f"{direction}_{name}"].values[[before, after]]
                for name in ("amplitude", "phase")
            )
            lengths = " to ".join(write_quantity(value, "m") for value in amplitude)
            words = f"{lengths}, {phase[0]:.0f}° to {phase[1]:.0f}°"
            table.add_row(f"jump on {direction}", height, words)
    table.add_row("taps", str(int(dataset.attrs["solver_taps"])), "that were run")


def _add_map(table: Table, dataset: "Dataset") -> None:
    """Add mean and range of every map."""
    for name, variable in dataset.data_vars.items():
        values = variable.values[np.isfinite(variable.values)]
        if variable.dims != ("y", "x") or not values.size:
            continue
        low, mean, high = (
            write_quantity(float(each), variable.attrs.get("units", ""))
            for each in (values.min(), values.mean(), values.max())
        )
        table.add_row(str(name), mean, "everywhere" if low == high else f"{low} to {high}")
    failed = len(json.loads(dataset.attrs.get("failures", "[]")))
    words = f"{dataset.attrs['different_pixels']} different"
    words += f"; {failed} without a result" if failed else ""
    table.add_row("pixels", f"{dataset.sizes['x']} × {dataset.sizes['y']}", words)


def _write_degrees(phase: np.ndarray) -> str:
    return f"{phase.min():.0f}° to {phase.max():.0f}°"


def describe_slowing(slower: float) -> str:
    """Return how much slower the edge of a viscoelastic contact is in cohesive lengths."""
    if slower == 1:
        return ""
    return f"; the edge crosses its cohesive length {slower:.2g} times more slowly"


def describe_regularisation(tabor: float, before: float, length: float) -> str:
    """Return what Tabor number and range, m, a contact had whose range is now ``length``, m."""
    if before == length:
        return f"of the law; a Tabor number of {tabor:.3g} needs no other"
    was = f"it was {write_quantity(before, 'm')} at a Tabor number of {tabor:.3g}"
    return f"of the law, regularised; {was}"


def describe_misfit(largest: float, rms: float) -> tuple[str, str, str]:
    """Return a row that says how well a sample fits the measured moduli it was fitted to."""
    words = f"from the measured moduli, at most; {100 * rms:.2g} % root mean square"
    return "fit off by", f"{100 * largest:.2g} %", words


def make_table(title: str) -> Table:
    table = Table(title=title, title_justify="left", show_header=False, box=None)
    table.add_column(no_wrap=True)
    table.add_column(justify="right", no_wrap=True)
    table.add_column(style="dim")
    return table
