"""The check of a run: the same again, finer, and what changes."""

import json
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from softafm.checks.validate import one_of, tolerance_of
from softafm.errors import AccuracyWarning, DivergedError
from softafm.modes.start import solver_of
from softafm.progress import Progress, reporting
from softafm.results.datasets import describe

if TYPE_CHECKING:
    from xarray import Dataset

_FINEST, _LEAST = 1e-5, 2e-5
_TAP = 0.02
"""Part of force times amplitude below which the energy of a tap counts as none."""
_DOUBLED = ("steps", "nodes", "functions")


@dataclass(frozen=True)
class Finer:
    """How a run is repeated: the ``solver`` and ``tolerance``, and that ``in_words``."""

    solver: Any
    tolerance: float
    in_words: str


@dataclass(frozen=True)
class Scales:
    """Magnitudes below which differences of observables count as if these were their values.

    ``length``, m, times the largest force is an energy; ``reach``, m, and ``time``, s, are those of
    a contact that is just felt. Numbers, or arrays over (branch, amplitude_ratio).
    """

    length: Any
    reach: float
    time: Any = 0.0

    @classmethod
    def of_taps(cls, contact, amplitude, frequency: float) -> "Scales":
        """Scales of taps of an amplitude, m, shape (), or (n,)."""
        grazing = np.sqrt(2 * contact.reach / amplitude) / (np.pi * frequency)
        return cls(_TAP * amplitude, contact.reach, grazing)


class Difference(NamedTuple):
    """``value`` and ``finer`` of an observable where they differ most, and by how much."""

    relative: float
    value: float
    finer: float
    units: str


def finer_run(check: bool, solver, tolerance: float) -> Finer | None:
    """Return how to repeat a run of a solver (None: the default one); None without a check.

    A tenth of the tolerance, at least 1e-5; of a solver of fixed steps twice the steps, nodes and
    functions.

    Raises
    ------
    ValueError
        If there is nothing finer, or an argument is none such.
    """
    tolerance, solver = tolerance_of(tolerance), solver_of(solver)
    if not one_of("check", check, (True, False)):
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
        finer = replace(solver, **doubled)
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"check = True: the solver '{solver.kind}' cannot be run twice as fine: {error}"
        ) from None
    return Finer(finer, tolerance, ", ".join(f"{name} = {n}" for name, n in doubled.items()))


def checked(
    result: "Dataset",
    finer: Finer | None,
    tolerance: float,
    scales: Scales,
    repeat: Callable[..., "Dataset"],
    progress: bool | Progress | None,
) -> "Dataset":
    """Return a mode's result with what a finer run makes of it; as it is if ``finer`` is None.

    Written into its attributes: ``check_differences``, JSON, the largest difference of every
    observable from the finer run over its scale; ``check_largest`` of them, a magnitude;
    ``check_tolerance`` or ``check_solver``, that of the finer run; of an approach curve
    ``check_mean_height``, that of the heights in m. ``repeat`` calls the mode with
    ``solver``, ``tolerance`` and ``progress``. To be called by the mode itself, as a difference
    above the tolerance is warned of on its behalf.
    """
    if finer is None:
        return result
    if finer.solver.adaptive:
        result.attrs["check_tolerance"] = finer.tolerance
    else:
        result.attrs["check_solver"] = json.dumps(describe(finer.solver))
    found: dict[str, Difference] = {}
    problem = None
    try:
        other = _repeated(finer, repeat, progress)
    except DivergedError as error:
        problem = (
            f"the check, with {finer.in_words}, could not be finished: {error}; the error of this "
            "run is not known"
        )
    else:
        found = _differences(result, other, scales)
        problem = _amiss(found, tolerance, finer) or _doubt(other, finer)
    relative = {name: difference.relative for name, difference in found.items()}
    result.attrs["check_differences"] = json.dumps(relative)
    if "mean_height" in found:
        result.attrs["check_mean_height"] = scales.reach * abs(found["mean_height"].relative)
    result.attrs["check_largest"] = max(map(abs, relative.values()), default=np.nan)
    if problem is not None:
        told = result.attrs["warnings"]
        result.attrs["warnings"] = f"{told}\n{problem}" if told else problem
        warnings.warn(problem, AccuracyWarning, stacklevel=3)  # the caller of the mode
    return result


def _repeated(finer: Finer, repeat, progress) -> "Dataset":
    """Run again, without the warnings of that run."""
    with warnings.catch_warnings(), reporting(progress) as report:
        warnings.simplefilter("ignore", AccuracyWarning)

        def told(fraction: float, message: str) -> None:
            if report is not None:
                report(fraction, f"check: {message}")

        return repeat(
            solver=finer.solver,
            tolerance=finer.tolerance,
            progress=None if report is None else told,
        )


def _amiss(found: dict[str, Difference], tolerance: float, finer: Finer) -> str | None:
    """Tell of the largest difference, if it is above the tolerance."""
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


def _doubt(other: "Dataset", finer: Finer) -> str | None:
    """Tell if the finer run itself was not sure."""
    told = other.attrs["warnings"].splitlines()
    return f"the check, with {finer.in_words}, warns: {told[0]}" if told else None


def _differences(result: "Dataset", other: "Dataset", scales: Scales) -> dict[str, Difference]:
    """Compare all observables that are like ``force_max``: scalars, or those of branches."""
    dims = other["force_max"].dims
    force = np.maximum(np.abs(other["force_max"].values), np.abs(other["force_min"].values))
    least = {"N": force, "J": force * scales.length, "s": scales.time, "m": scales.reach}
    found = {}
    for name, variable in other.data_vars.items():
        units = variable.attrs["units"]
        if variable.dims != dims or units == "1":
            continue
        value, finer = result[name].values, variable.values
        if units == "degree":
            scale = np.degrees(1.0)
        elif name == "mean_height":
            scale = scales.reach
        else:
            scale = np.maximum(np.abs(finer), least[units])
        relative = np.where(value == finer, 0.0, (value - finer) / np.where(scale > 0, scale, 1.0))
        if np.isfinite(relative).any():
            worst = np.unravel_index(np.nanargmax(np.abs(relative)), relative.shape)
            found[str(name)] = Difference(
                float(relative[worst]), float(value[worst]), float(finer[worst]), units
            )
    if dims:
        found["solutions"] = _solutions(result, other)
    return found


def _solutions(result: "Dataset", other: "Dataset") -> Difference:
    """Compare how many solutions an approach curve has, and on which branches."""
    one, two = (np.isfinite(each["mean_height"].values) for each in (result, other))
    share = int(np.sum(one != two)) / max(1, int(np.sum(two)))
    return Difference(share, float(one.sum()), float(two.sum()), "in all")
