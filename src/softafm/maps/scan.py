"""Maps: a sample that varies over x and y, imaged pixel by pixel."""

import json
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from multiprocessing import get_context
from typing import TYPE_CHECKING, Any

import numpy as np

from softafm.checks.gathering import Placed, gather
from softafm.checks.kinds import refuse_other
from softafm.checks.validate import check_tolerance, check_whole
from softafm.contact import Contact
from softafm.errors import AccuracyWarning
from softafm.maps import curve_pixels, tapped_lines
from softafm.maps.imaging import AmplitudeModulation, ForceVolume
from softafm.maps.sample_map import SampleMap
from softafm.maps.soft_pixels import doubt_soft_pixels, estimate_errors, regularise_further
from softafm.modes import Mode, approach, force_distance
from softafm.modes.regularise import Regularise, choose_tabor, regularise_contact
from softafm.modes.start import (
    choose_solver,
    refuse_start_inside,
    refuse_tapped_flow,
    refuse_unable,
)
from softafm.progress import Progress, make_reporter
from softafm.results.datasets import assemble_history, describe, describe_misfit
from softafm.solvers.solver import Solver

if TYPE_CHECKING:
    from xarray import Dataset

_CURVES_A_TASK = 8
_REHEARSED = 4
"""Lines, one of eight at most, taken before all others, which start from what these found."""
_UNITS = {
    "E": "Pa", "E0": "Pa", "E_inf": "Pa", "creep_time": "s", "hamaker": "J", "z0": "m",
    "work_of_adhesion": "J/m²", "poisson": "1",
}  # fmt: skip

_Taken = tuple[Sequence[str], np.ndarray, list[list[Any]], list[Placed], dict[str, int]]
"""Names and values of the maps, failures, doubts, and what was done, counted."""


def scan(
    sample: SampleMap,
    imaging: AmplitudeModulation | ForceVolume,
    *,
    solver: Solver | None = None,
    tolerance: float = 1e-2,
    regularise: Regularise = "auto",
    workers: int = 1,
    progress: bool | Progress | None = None,
) -> "Dataset":
    """Image a sample that varies over x and y.

    Every pixel is taken as a flat half-space with its own properties. In ``AmplitudeModulation``
    the lever follows one branch from pixel to pixel while that exists and a feedback can hold it,
    and else jumps to the other: down the first column, and from there along every line. In
    ``ForceVolume`` pixels do not depend on each other. Pixels alike are computed once.

    Parameters
    ----------
    sample
        What lies where.
    imaging
        How it is imaged.
    solver, tolerance, regularise
        As for ``force_distance``, at every pixel.
    workers
        Processes at work. Results are the same, to the last bit, with any number. Several need a
        script that begins with ``if __name__ == "__main__":``.
    progress
        As for ``force_distance``.

    Returns
    -------
    xarray.Dataset
        Over (``y``, ``x``), centres of the pixels in m, y downwards: ``topography``, the height at
        which the feedback, or the turn of the curve, leaves the lever: ``mean_height`` or
        ``lowest_height`` above the local surface plus ``sample_height``. Of amplitude modulation
        ``phase``, ``branch`` (0 attractive, 1 repulsive) and the observables of
        ``approach_curve``; of a force volume ``force_max``, ``force_min`` (the pull-off),
        ``force_min_approach``, ``loop_energy``, ``viscous_loss``, ``indentation``. The fields of
        the sample, by their names. All SI but the phase. NaN where a pixel has no result, with the
        reasons in the attribute ``failures``, JSON of [row, column, reason].

    Raises
    ------
    ValueError
        If an argument is out of range, or the properties of a pixel are.
    """
    refuse_other("sample", sample, SampleMap, "a softafm.SampleMap")
    kinds = AmplitudeModulation, ForceVolume
    refuse_other("imaging", imaging, kinds, "an AmplitudeModulation or a ForceVolume")
    tolerance, workers = check_tolerance(tolerance), check_whole("workers", workers, 1, 1024)
    solver = choose_solver(solver)
    given, number = sample.pixels.contacts, sample.pixels.number
    moved: tuple[Regularise, Mode, Any] = regularise, approach.MODE, None
    if isinstance(imaging, ForceVolume):
        moved = regularise, force_distance.MODE, imaging.motion
    tabors = [choose_tabor(contact, *moved) for contact in given]
    contacts, coarser = (
        [_call_at_pixel(sample, i, choose, each, *moved) for i, each in enumerate(given)]
        for choose in (regularise_contact, regularise_further)
    )
    options = solver, tolerance, workers
    take: Callable[[list[Contact], Progress | None], _Taken]
    refuse: Callable[[Contact], None]
    if isinstance(imaging, AmplitudeModulation):
        take = partial(_tap_map, sample, imaging, *options)
        refuse = refuse_tapped_flow
    else:
        refuse_unable(solver, imaging.motion)
        take = partial(_take_curves, sample, imaging, *options)
        refuse = partial(refuse_start_inside, motion=imaging.motion)
    for i, contact in enumerate(contacts):
        _call_at_pixel(sample, i, refuse, contact)
    with make_reporter(progress) as report:
        names, values, failures, doubts, done = take(contacts, report)
        doubts = [*doubt_soft_pixels(contacts, *moved[1:]), *doubts]
        if coarser != contacts:
            other = take(coarser, report)[1]
            doubts += estimate_errors(given, contacts, number, names, values, other)
    warned = _collect_warnings(failures, doubts, sample)
    for warning in warned:
        warnings.warn(warning, stacklevel=2)
    result = _assemble(sample, imaging, solver, tolerance, names, values, warned, done)
    result.attrs["failures"] = json.dumps(failures)
    asked = [tabor for tabor in tabors if tabor is not None]
    if asked:
        result.attrs["regularised_tabor"] = asked[0]
    return result


def _call_at_pixel(
    sample: SampleMap, number: int, function: Callable[..., Any], *arguments: Any
) -> Any:
    """Call a function on behalf of a contact; its ValueError names the first such pixel."""
    try:
        return function(*arguments)
    except ValueError as error:
        i, j = np.argwhere(sample.pixels.number == number)[0]
        raise ValueError(f"pixel ({i}, {j}): {error}") from None


def _tap_map(
    sample: SampleMap,
    imaging: AmplitudeModulation,
    solver: Solver,
    tolerance: float,
    workers: int,
    contacts: list[Contact],
    report: Progress | None,
) -> _Taken:
    """Go down the first column, along a few lines, then along all others."""
    pixels = sample.pixels
    spots = [
        tapped_lines.Spot(i, *each)
        for i, each in enumerate(zip(contacts, pixels.place, pixels.label.tolist(), strict=True))
    ]
    setpoint, known = tapped_lines.make_setpoint(imaging, solver, tolerance), tapped_lines.Known()
    first = contacts[pixels.number[0, 0]]
    branch = tapped_lines.find_engaged_branch(imaging, first, solver, tolerance)
    column = tapped_lines.walk(setpoint, [spots[i] for i in pixels.number[:, 0]], branch, known)
    branches = [branch, *column.values[:, tapped_lines.NAMES.index("branch")]]
    for row in range(1, len(branches)):  # where a pixel failed, the branch is that before it
        if np.isnan(branches[row]):
            branches[row] = branches[row - 1]
    starts = [int(each) for each in branches[:-1]]
    lines = [[spots[i] for i in row] for row in pixels.number]
    few = min(_REHEARSED, len(lines) // 8)
    rehearsed = np.linspace(0, len(lines) - 1, few + 2).astype(int)[1:-1].tolist()
    by_row = {row: tapped_lines.walk(setpoint, lines[row], starts[row], known) for row in rehearsed}
    others = [row for row in range(len(lines)) if row not in by_row]
    tasks = [(lines[row], starts[row], known) for row in others]
    found = _run_each(partial(_tap_line, setpoint), tasks, workers, report, "line")
    by_row |= dict(zip(others, found, strict=True))
    taken = [by_row[row] for row in range(len(lines))]
    values = np.array([each.values for each in taken])
    failures = [
        [row, column, reason]
        for row, each in enumerate(taken)
        for column, reason in each.reasons.items()
    ]
    doubts = [placed for each in [column, *taken] for placed in each.warned]
    taps = column.taps + sum(each.taps for each in taken)
    return tapped_lines.NAMES, values, failures, doubts, {"taps": taps}


def _tap_line(
    setpoint: tapped_lines.Setpoint, task: tuple[list[tapped_lines.Spot], int, tapped_lines.Known]
) -> tapped_lines.Taken:
    """Take one line, from what is known of the first column and the lines rehearsed."""
    spots, branch, known = task
    return tapped_lines.walk(setpoint, spots, branch, known.copy())


def _take_curves(
    sample: SampleMap,
    imaging: ForceVolume,
    solver: Solver,
    tolerance: float,
    workers: int,
    contacts: list[Contact],
    report: Progress | None,
) -> _Taken:
    """Take a force curve of each different contact."""
    tasks = [contacts[i : i + _CURVES_A_TASK] for i in range(0, len(contacts), _CURVES_A_TASK)]
    curves = curve_pixels.Curves(imaging, solver, tolerance)
    taken = list(_run_each(curves, tasks, workers, report, "curves"))
    table = np.concatenate([values for values, _, _ in taken])
    reasons = {
        task * _CURVES_A_TASK + i: reason
        for task, (_, failed, _) in enumerate(taken)
        for i, reason in failed.items()
    }
    number = sample.pixels.number
    failures = [
        [int(i), int(j), reasons[int(number[i, j])]]
        for i, j in np.argwhere(np.isin(number, list(reasons)))
    ]
    doubts = [
        (task * _CURVES_A_TASK + i, each)
        for task, (_, _, warned) in enumerate(taken)
        for i, each in warned
    ]
    return curve_pixels.NAMES, table[number], failures, doubts, {"curves": len(contacts)}


def _run_each(
    function: Callable[[Any], Any],
    tasks: Sequence[Any],
    workers: int,
    report: Progress | None,
    noun: str,
) -> Iterator[Any]:
    """Yield what a function makes of tasks, in their order, from so many processes."""

    def count(results: Iterable[Any]) -> Iterator[Any]:
        for done, result in enumerate(results, start=1):
            if report is not None:
                report(done / len(tasks), f"{noun} {done} of {len(tasks)}")
            yield result

    workers = min(workers, len(tasks))
    if workers == 1:
        yield from count(map(function, tasks))
        return
    try:
        # Not forked: threads of libraries would be cut in the middle of what they do.
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            yield from count(pool.map(function, tasks))
    except BrokenProcessPool:
        raise RuntimeError(
            f"workers = {workers}: a process of them ended. Does the script begin its work under "
            "'if __name__ == \"__main__\":'? workers=1 needs none"
        ) from None


def _collect_warnings(
    failures: list[list[Any]], doubts: list[Placed], sample: SampleMap
) -> list[AccuracyWarning]:
    """What to warn of: pixels without a result, and what solvers said."""
    number = sample.pixels.number

    def where(contact: int) -> str:
        i, j = np.argwhere(number == contact)[0]
        return f"pixel ({i}, {j})"

    failed = []
    if failures:
        i, j, reason = failures[0]
        text = (
            f"{len(failures)} of {number.size} pixels have no result and are NaN; the first, "
            f"({i}, {j}): {reason}"
        )
        failed = [AccuracyWarning(text, len(failures))]
    return [*failed, *gather(doubts, len(sample.pixels.contacts), "different pixels", where)]


def _assemble(
    sample: SampleMap,
    imaging: AmplitudeModulation | ForceVolume,
    solver: Solver,
    tolerance: float,
    names: Sequence[str],
    values: np.ndarray,
    warned: list[AccuracyWarning],
    done: dict[str, int],
) -> "Dataset":
    """Assemble the maps, the fields of the sample and the provenance."""
    from xarray import Variable

    dims, (ny, nx), (width, depth) = ("y", "x"), sample.shape, sample.size
    data = {name: (dims, values[..., i]) for i, name in enumerate(names)}
    data["topography"] = (dims, values[..., 0] + sample.height)
    data["sample_height"] = (dims, sample.height)
    if len(sample.materials) > 1:
        data["material"] = (dims, sample.labels)
    coordinates = {
        "y": ("y", (np.arange(ny) + 0.5) * depth / ny),
        "x": ("x", (np.arange(nx) + 0.5) * width / nx),
    }
    parts = {
        "materials": {str(i): _describe(each) for i, each in enumerate(sample.materials)},
        "map": {"size": [width, depth], "fields": list(sample.fields)},
        "imaging": describe(imaging),
    }
    result = assemble_history(
        imaging.kind, sample.materials[0], parts, solver, tolerance, data, coordinates, warned, done
    )
    for name, array in sample.fields.items():
        entry = name.partition(".")[2]
        described = {"units": _UNITS.get(entry, ""), "long_name": f"{name} of the sample map"}
        result[name] = Variable(dims, array, described)
    if "branch" in result:
        result["branch"].attrs |= {
            "long_name": "branch of solutions, 0 attractive, 1 repulsive",
            "flag_values": [0.0, 1.0],
            "flag_meanings": "attractive repulsive",
        }
    of_one = ("tabor_instantaneous", "tabor_relaxed", "cohesive_length")
    for name in (*of_one, *describe_misfit(sample.materials[0].rheology)):
        del result.attrs[name]  # there is not one of them
    result.attrs["different_pixels"] = len(sample.pixels.contacts)
    return result


def _describe(contact: Contact) -> dict[str, Any]:
    parts = {name: describe(getattr(contact, name)) for name in ("tip", "sample", "surface")}
    return {**parts, **describe_misfit(contact.rheology)}
