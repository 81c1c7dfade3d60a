"""The check of a run: the same again, finer, and what changes."""

import json
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from softafm.checks.callers import warn_caller
from softafm.checks.validate import check_choice, check_tolerance
from softafm.errors import AccuracyWarning, DivergedError
from softafm.modes.start import choose_solver
from softafm.progress import Progress, make_reporter
from softafm.results.datasets import describe
from softafm.solvers.solver import Solver

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

    from softafm.modes.mode import Mode
    from softafm.modes.scales import Scales

_FINEST, _LEAST = 1e-5, 2e-5
_DOUBLED = ("steps", "nodes", "functions")


@dataclass(frozen=True)
class Finer:
    """How a run is repeated: the ``solver`` and ``tolerance``, and that ``in_words``."""

    solver: Solver
    tolerance: float
    in_words: str


class Difference(NamedTuple):
    """``value`` and ``finer`` of an observable where they differ most, and by how much."""

    relative: float
    value: float
    finer: float
    units: str


def plan_finer_run(check: bool, solver: Solver | None, tolerance: float) -> Finer | None:
    """Return how to repeat a run of a solver (None: the default one); None without a check.

    A tenth of the tolerance, at least 1e-5; of a solver of fixed steps twice the steps, nodes and
    functions.

    Raises
    ------
    ValueError
        If there is nothing finer, or an argument is none such.
    """
    tolerance, solver = check_tolerance(tolerance), choose_solver(solver)
    if not check_choice("check", check, (True, False)):
        return None
    if solver.adaptive:
        if tolerance < _LEAST:
            raise ValueError(
                f"check = True: a run of tolerance {tolerance:g} cannot be repeated at a tighter "
                f"one; take a tolerance of at least {_LEAST:g}"
            )
        tighter = max(tolerance / 10, _FINEST)
        return Finer(solver, tighter, f"tolerance = {tighter:.4g}")
    doubled = {name: 2 * getattr(solver, name) for name in _DOUBLED if hasattr(solver, name)}
    try:
        finer = replace(cast(Any, solver), **doubled)
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"check = True: the solver '{solver.kind}' cannot be run twice as fine: {error}"
        ) from None
    return Finer(finer, tolerance, ", ".join(f"{name} = {n}" for name, n in doubled.items()))


def compare_with_finer(
    mode: "Mode",
    result: "Dataset",
    finer: Finer,
    tolerance: float,
    scales: Callable[["Dataset"], "Scales"],
    repeat: Callable[..., "Dataset"],
    progress: bool | Progress | None,
) -> None:
    """Write into a result what a finer run makes of it, and warn of what exceeds the tolerance.

    Its attributes become ``check_differences``, JSON, the largest difference of every observable
    from the finer run over its scale; ``check_largest`` of them, a magnitude; ``check_tolerance``
    or ``check_solver``, that of the finer run; where heights are observed ``check_mean_height``,
    their largest difference in m.

    Parameters
    ----------
    mode, result, tolerance
        What was run, what it gave, and the tolerance it was run at.
    finer, repeat
        How to run it again, and the function that does, with ``solver``, ``tolerance`` and
        ``progress``.
    scales
        Function of the finer result that returns the ``Scales``.
    progress
        As for the mode.
    """
    if finer.solver.adaptive:
        result.attrs["check_tolerance"] = finer.tolerance
    else:
        result.attrs["check_solver"] = json.dumps(describe(finer.solver))
    found: dict[str, Difference] = {}
    try:
        again = partial(repeat, solver=finer.solver, tolerance=finer.tolerance)
        other = run_again(again, progress, "check")
    except DivergedError as error:
        problem: str | None = (
            f"the check, with {finer.in_words}, could not be finished: {error}; the error of this "
            "run is not known"
        )
    else:
        judged = scales(other)
        found = find_differences(mode, result, other, judged)
        problem = _say_largest(found, tolerance, finer) or _repeat_doubt(other, finer)
        if "mean_height" in found:
            height = judged.fixed["mean_height"] * abs(found["mean_height"].relative)
            result.attrs["check_mean_height"] = height
    result.attrs["check_differences"] = json.dumps({name: d.relative for name, d in found.items()})
    largest = max((abs(difference.relative) for difference in found.values()), default=np.nan)
    result.attrs["check_largest"] = largest
    if problem is not None:
        record_warning(result, AccuracyWarning(problem))


def record_warning(result: "Dataset", warning: AccuracyWarning) -> None:
    """Warn, and add the warning to those of a result."""
    before = result.attrs["warnings"]
    result.attrs["warnings"] = f"{before}\n{warning}" if before else str(warning)
    warn_caller(warning)


def run_again(
    repeat: Callable[..., "Dataset"], progress: bool | Progress | None, why: str
) -> "Dataset":
    """Run again, without the warnings of that run; its messages of progress begin with ``why``."""
    with warnings.catch_warnings(), make_reporter(progress) as report:
        warnings.simplefilter("ignore", AccuracyWarning)

        def pass_on(fraction: float, message: str) -> None:
            if report is not None:
                report(fraction, f"{why}: {message}")

        return repeat(progress=None if report is None else pass_on)


def _say_largest(found: dict[str, Difference], tolerance: float, finer: Finer) -> str | None:
    """Return a sentence on the largest difference, if it is above the tolerance."""
    if not found:
        return None
    name, worst = max(found.items(), key=lambda item: abs(item[1].relative))
    if abs(worst.relative) <= tolerance:
        return None
    above = [other for other, d in found.items() if abs(d.relative) > tolerance and other != name]
    too = f" (as do {', '.join(above)})" if above else ""
    return (
        f"{name} = {worst.value:.4g} {worst.units}, but {worst.finer:.4g} {worst.units} with "
        f"{finer.in_words}: they differ by {100 * abs(worst.relative):.3g} % of their scale, more "
        f"than the tolerance of {100 * tolerance:.4g} %{too}; run with {finer.in_words}, or finer"
    )


def _repeat_doubt(other: "Dataset", finer: Finer) -> str | None:
    """Return the first warning of the finer run, if it was not sure itself."""
    doubts = other.attrs["warnings"].splitlines()
    return f"the check, with {finer.in_words}, warns: {doubts[0]}" if doubts else None


def find_differences(
    mode: "Mode", result: "Dataset", other: "Dataset", scales: "Scales"
) -> dict[str, Difference]:
    """Compare all observables that have a unit, and how many solutions there are, by name."""
    found = {}
    for name in mode.observed:
        units = other[name].attrs["units"]
        if units == "1":
            continue
        value, finer = result[name].values, other[name].values
        scale = scales.of(name, units, finer)
        relative = np.where(value == finer, 0.0, (value - finer) / np.where(scale > 0, scale, 1.0))
        if np.isfinite(relative).any():
            worst = np.unravel_index(np.nanargmax(np.abs(relative)), relative.shape)
            found[name] = Difference(
                float(relative[worst]), float(value[worst]), float(finer[worst]), units
            )
    if mode.gaps:
        found["solutions"] = _compare_solutions(result[mode.observed[0]], other[mode.observed[0]])
    return found


def _compare_solutions(one: "DataArray", two: "DataArray") -> Difference:
    """Compare how many solutions there are, and where."""
    here, there = np.isfinite(one.values), np.isfinite(two.values)
    share = int(np.sum(here != there)) / max(1, int(np.sum(there)))
    return Difference(share, float(here.sum()), float(there.sum()), "in all")
