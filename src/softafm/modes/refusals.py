"""Why a record of a mode is refused, and what a mode observed."""

import re
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from softafm.checks.kinds import refuse_other
from softafm.checks.refusals import join_with_and, show, suggest
from softafm.checks.validate import check_choice
from softafm.instrument.motions import Trajectory
from softafm.modes.parts import Outcome
from softafm.results.check import refuse_values
from softafm.results.content import UNNUMBERED, Observable, find_unit

if TYPE_CHECKING:
    from softafm.modes.mode import Mode

_SURELY = 100.0
"""Every unit allows numbers below this."""
_NAME = re.compile("[a-z][a-z0-9]*(-[a-z0-9]+)*")


def refuse_record(mode: "Mode") -> None:
    """Raise ValueError if what a record states cannot be a mode, whatever else is known."""
    if not isinstance(mode.name, str) or not _NAME.fullmatch(mode.name):
        raise ValueError(
            f"mode {mode.name!r}: its name must be of small letters and digits, with hyphens "
            "between words, such as 'force-distance'"
        )
    where = f"mode '{mode.name}'"
    if (mode.observe is None) == (mode.simulate is None):
        raise ValueError(f"{where}: must have either observe or simulate")
    check_choice(f"{where}: lever", mode.lever, ("", "stiffness", "resonator"))
    needs_kind = mode.observe is not None
    _refuse_other_than_dataclasses(f"{where}: motions", mode.motions, needs_kind)
    _refuse_other_than_dataclasses(f"{where}: tables", mode.tables, True)
    if not mode.motions:
        raise ValueError(f"{where}: motions is empty; must hold at least one")
    refuse_other(f"{where}: observables", mode.observables, Mapping, "a dict of Observable by name")
    for name, each in mode.observables.items():
        if not isinstance(name, str) or not name.isidentifier():
            raise ValueError(f"{where}: observable {name!r}: must be named as a variable in Python")
        wanted = "an Observable(unit, words, dimensions)"
        refuse_other(f"{where}: observables['{name}']", each, Observable, wanted)
    _refuse_arguments(mode)


def _refuse_other_than_dataclasses(name: str, classes: Any, needs_kind: bool) -> None:
    """Raise ValueError if ``classes`` are not dataclasses by name, or ``Trajectory``."""
    refuse_other(name, classes, Mapping, "a dict of dataclasses by name")
    for key, each in classes.items():
        fits = isinstance(each, type) and (is_dataclass(each) or each is Trajectory)
        if not fits or (needs_kind and not hasattr(each, "kind")):
            raise ValueError(f"{name}['{key}'] = {show(each)}: must be a dataclass with a kind")


def _refuse_arguments(mode: "Mode") -> None:
    """Raise ValueError if the function does not take what it is called with."""
    where, function = f"mode '{mode.name}': {mode.function.__name__}", mode.parameters
    asked = () if mode.takes_motion else mode.motions.values()
    wanted = dict.fromkeys(
        (each.name for motion in asked if is_dataclass(motion) for each in fields(motion)),
        "is a field of its motion; must have one, or take motion",
    )
    wanted |= dict.fromkeys(mode.tables, "is one of its tables; must have one")
    if mode.lever:
        wanted["cantilever"] = f"lever = '{mode.lever}' needs; must have one"
    elif "cantilever" in function:
        raise ValueError(f"{where} takes cantilever; lever must be 'stiffness' or 'resonator'")
    for name, words in wanted.items():
        if name not in function:
            raise ValueError(f"{where} has no argument {name}, which {words}")
    first = ("cantilever",) * bool(mode.lever) + ("motion",) * mode.takes_motion
    if function[0] in (*wanted, "motion") or function[1 : 1 + len(first)] != first:
        must = join_with_and(["a contact", *first])
        raise ValueError(f"{where} takes {function[0]} first; its first arguments must be {must}")


def refuse_unknown_names(mode: "Mode", variables: Mapping[str, tuple[str, ...]]) -> None:
    """Raise ValueError if a dimension has no meaning, or a figure shows what no result holds.

    ``variables`` are those of a result, with their dimensions.
    """
    where = f"mode '{mode.name}'"
    for name in (*mode.axes.dims, *(d for each in mode.observables.values() for d in each.dims)):
        if name not in (*mode.observables, *UNNUMBERED) and find_unit(name) is None:
            raise ValueError(
                f"{where}: the dimension {name} must be among the observables, as "
                f"Observable(unit, words, ('{name}',))"
            )
    if mode.figure is type(mode).figure:  # one that fits, or is not drawn
        return
    held = list(dict.fromkeys([*variables, *(d for dims in variables.values() for d in dims)]))
    shown = [name for panel in mode.figure.panels for name in panel]
    for name in (*shown, *(name for name, _ in mode.figure.title)):
        if name not in held:
            raise ValueError(f"{where}: its figure shows {name!r}: {suggest(name, held)}")


def refuse_strange(mode: "Mode", values: Any) -> None:
    """Raise ValueError if what ``observe`` returned is no dict of observables."""
    where = f"mode '{mode.name}': observe returns"
    if not isinstance(values, Mapping):
        raise ValueError(f"{where} {show(values)}: must be a dict of the observables by name")
    strange = [str(name) for name in values if name not in mode.observables]
    if strange:
        raise ValueError(f"{where} {join_with_and(strange)}: must be among its observables")


def refuse_observed(mode: "Mode", found: Outcome) -> None:
    """Raise ValueError if an observable is missing, over other dimensions, or no number."""
    where = f"mode '{mode.name}': {'simulate' if mode.observe is None else 'observe'}"
    refuse_other(where, found, Outcome, "a function that returns an Outcome")
    variables = {**found.data, **found.coordinates}
    missing = [name for name in mode.observables if name not in variables]
    if missing:
        raise ValueError(
            f"{where} returns no {join_with_and(missing)}: must return all its observables"
        )
    lengths: dict[str, int] = {}
    # Coordinates last, but looked at first: they say how long the others must be.
    for name, (along, values) in reversed(variables.items()):
        dims = (along,) if isinstance(along, str) else tuple(along)
        known = mode.observables.get(name)
        # Nearly all are: to look closer at each would take a hundredth of a tap's time.
        plain = isinstance(values, float | int) and abs(values) < _SURELY
        if plain and dims == () and (known is None or known.dims == ()):
            continue
        if known is not None:
            _refuse_shape(mode, name, dims, values, lengths)
        for dim, length in zip(dims, np.shape(values), strict=False):
            lengths.setdefault(dim, length)


def _refuse_shape(
    mode: "Mode", name: str, dims: tuple[Any, ...], values: Any, lengths: dict[Any, Any]
) -> None:
    where, wanted = f"mode '{mode.name}': observable '{name}'", mode.observables[name].dims
    array = _make_array(where, values)
    if dims != wanted or array.ndim != len(wanted):
        over = f"over ({', '.join(wanted)})" if wanted else "a single number"
        raise ValueError(f"{where} has the shape {array.shape}: must be {over}")
    for dim, length in zip(dims, array.shape, strict=True):
        if lengths.get(dim, length) != length:
            raise ValueError(f"{where} has {length} values along {dim}: must have {lengths[dim]}")
    if array.dtype.kind == "U" and dims == (name,):  # names along an axis
        return
    if array.dtype.kind == "f" and np.abs(array).max(initial=0.0) < _SURELY:
        return
    try:
        refuse_values(name, array, gaps=mode.gaps)
    except ValueError as error:
        raise ValueError(f"mode '{mode.name}': {error}") from None


def _make_array(where: str, values: Any) -> np.ndarray:
    try:
        return np.asarray(values)
    except ValueError:  # lists of several lengths
        raise ValueError(f"{where} = {show(values)}: must be numbers") from None
