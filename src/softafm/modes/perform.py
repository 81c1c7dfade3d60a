"""What every mode does: the run, its dataset, and the finer run that checks it."""

from collections.abc import Mapping
from functools import partial
from inspect import Parameter, signature
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from softafm.checks.callers import warn_caller
from softafm.checks.refusals import show, suggest
from softafm.contact import Contact
from softafm.instrument.cantilever import Cantilever
from softafm.modes.audit import audit
from softafm.modes.check import compare_with_finer, plan_finer_run
from softafm.modes.mode import MODES, Mode
from softafm.modes.parts import Inputs, Outcome, Settings
from softafm.modes.refusals import refuse_observed, refuse_strange
from softafm.modes.regularise import Regularise, choose_tabor, doubt_softness, estimate_error
from softafm.modes.start import carry, refuse_other_than_cantilever
from softafm.progress import Progress
from softafm.results.content import HISTORY
from softafm.results.datasets import assemble_history, history_variables, record_regularisation
from softafm.solvers.solver import Solver

if TYPE_CHECKING:
    from xarray import Dataset

_OPTIONS = ("solver", "tolerance", "profiles", "progress", "check", "regularise")


def perform(
    mode: Mode,
    contact: Contact,
    motion: Any,
    cantilever: Cantilever | None = None,
    *,
    tables: Mapping[str, Any] = MappingProxyType({}),
    solver: Solver | None = None,
    tolerance: float = 1e-2,
    profiles: bool = False,
    progress: bool | Progress | None = None,
    check: bool = False,
    regularise: Regularise = "auto",
    **unknown: Any,
) -> "Dataset":
    """Run a mode and return its result, as the public functions of all modes do.

    Parameters
    ----------
    mode
        The record of the mode, which has been registered.
    contact, motion, cantilever, tables
        The ``Inputs``.
    solver, tolerance, profiles, progress, check, regularise
        As for ``force_distance``.

    Raises
    ------
    ValueError
        If an argument is out of range, the mode is not registered, or what it observed is not what
        its record says.
    TypeError
        If there is no such option.
    DivergedError
        If the solver cannot continue.
    """
    if unknown:
        name = next(iter(unknown))
        parameters = signature(mode.function).parameters.values()
        named = [each.name for each in parameters if each.kind is not Parameter.VAR_KEYWORD]
        raise TypeError(
            f"{mode.function.__name__}() got {name} = {show(unknown[name])}, which is no argument "
            f"of it: {suggest(name, list(dict.fromkeys([*named, *_OPTIONS])))}"
        )
    if MODES.get(mode.name) is not mode:
        raise ValueError(f"mode '{mode.name}' is not known: call softafm.modes.register with it")
    finer = plan_finer_run(check, solver, tolerance)
    tabor, given = choose_tabor(contact, regularise, mode, motion), contact
    contact = given if tabor is None else given.regularised(tabor)
    if mode.lever:
        refuse_other_than_cantilever(cantilever)
    elif cantilever is not None:
        raise ValueError(
            f"cantilever = {show(cantilever)}: must be left out, or lever of the mode "
            f"'{mode.name}' be 'stiffness' or 'resonator'"
        )
    inputs = Inputs(contact, motion, cantilever, tables)
    doubts = doubt_softness(contact, mode, motion)
    for doubt in doubts:
        warn_caller(doubt)
    found = simulate(mode, inputs, Settings(solver, tolerance, profiles, progress))
    refuse_observed(mode, found)
    found = found._replace(warnings=(*doubts, *found.warnings))
    result = assemble_history(mode.name, contact, *found)
    record_regularisation(result, given, contact, tabor)
    scales = partial(mode.scales, inputs)
    repeat = partial(
        perform, mode, motion=motion, cantilever=cantilever, tables=tables, regularise=None
    )
    if tabor is not None and regularise == "auto":
        again = partial(repeat, solver=solver, tolerance=tolerance)
        estimate_error(mode, result, given, scales, again, progress)
    if finer is not None:
        again = partial(repeat, contact)
        compare_with_finer(mode, result, finer, found.tolerance, scales, again, progress)
    return result


def simulate(mode: Mode, inputs: Inputs, settings: Settings) -> Outcome:
    """Run a mode on a contact as it is; return what it gave, of which no dataset is made."""
    if mode.simulate is not None:
        return mode.simulate(inputs, settings)
    contact, motion, cantilever, _ = inputs
    lever = {} if cantilever is None else {"stiffness": cantilever.stiffness}
    solver, tolerance, history = carry(contact, mode.path(motion), *settings, **lever)
    data, coordinates = history_variables(contact, history)
    assert mode.observe is not None
    values = mode.observe(contact, motion, history)
    refuse_strange(mode, values)
    audited = audit(contact, history, tolerance, **lever)
    for warning in audited.problems:
        warn_caller(warning)
    observed = {name: (mode.observables[name].dims, each) for name, each in values.items()}
    data = {name: data[name] for name in HISTORY} | observed | data  # shapes of the surface last
    warnings = (*history.warnings, *audited.problems)
    return Outcome(
        inputs.parts, solver, tolerance, data, coordinates, warnings, history.diagnostics,
        audited.write(),
    )  # fmt: skip
