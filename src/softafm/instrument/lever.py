"""What carries the tip, as a solver sees it: it bends under the force and may remember.

The deflection q of a lever adds to the height of its base. At the end of a step it is

    q = rest + F/k,

F being the force on the tip, positive = repulsive. The rest and the stiffness k of the step follow
from its length and from what the lever remembers; the solver finds q and F together with the shape
of the surface, and lets the lever remember F once the step is accepted.
"""

from dataclasses import dataclass
from math import inf, isfinite
from typing import Any, Protocol

import numpy as np

from softafm.checks.kinds import is_built_in, members, refuse_incomplete
from softafm.checks.refusals import show
from softafm.checks.validate import check_positive
from softafm.compiled.formulas import find_first_line
from softafm.instrument.cantilever import Cantilever

_WANTED = "a lever such as softafm.instrument.lever.Spring(1)"
_INSTANT = 1e-9
"""A step and a creep time to try a lever of the user's with, s."""


class Lever(Protocol):
    """A lever that a solver can take along."""

    @property
    def stiffness(self) -> float:
        """Force per deflection with which it answers at once, N/m; inf if it cannot move at once,
        as a mass cannot: then the tip holds still while the surface falls and settles."""

    @property
    def compiled_response(self) -> tuple[Any, Any, np.ndarray]:
        """How it responds, how it accepts a force, and the parameters of both, shape (p,).

        Two functions decorated with ``softafm.compiled.functions.compile_when_used``, for
        ``RESPONSE`` and ``ACCEPTANCE``.
        """

    def at_start(self) -> np.ndarray:
        """Return what it remembers before the first step, shape (s,); none if it remembers nothing.

        The compiled functions know it as ``state``; only that of ``ACCEPTANCE`` may change it.
        """

    def falling(self, creep_time: float) -> "Lever":
        """Return the lever that moves while the surface creeps fast, in ``creep_time`` (s), from a
        shape that has become unstable to the next stable one."""


class Inert(Protocol):
    """Power of a lever with inertia: it knows where its tip is while the surface falls."""

    def deflection_at(self, time: float, state: np.ndarray) -> float:
        """Return the deflection, m, at a time, s, at which it remembers ``state``."""


@dataclass(frozen=True)
class Rigid:
    """A lever that does not bend."""

    stiffness = inf

    @property
    def compiled_response(self) -> tuple[Any, Any, np.ndarray]:
        from softafm.instrument.compiled_levers import hold, remember_nothing

        return hold, remember_nothing, np.empty(0)

    def at_start(self) -> np.ndarray:
        return np.empty(0)

    def falling(self, creep_time: float) -> "Rigid":
        return self


@dataclass(frozen=True)
class Spring:
    """A lever that is always in balance with the force, q = F/k: quasi-static.

    Parameters
    ----------
    stiffness
        k, N/m.
    creep_time
        Time in which a dashpot beside the spring lets it relax, s; 0 for none. A step dt of
        backward Euler then has the stiffness k (1 + T/dt), and its rest follows from the deflection
        before.

    Raises
    ------
    ValueError
        If the stiffness is not a finite number above zero.
    """

    stiffness: float
    creep_time: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "stiffness", check_positive("stiffness", self.stiffness, "N/m"))

    @property
    def compiled_response(self) -> tuple[Any, Any, np.ndarray]:
        from softafm.instrument.compiled_levers import bend, remember_nothing

        return bend, remember_nothing, np.array([self.stiffness, self.creep_time])

    def at_start(self) -> np.ndarray:
        return np.empty(0)

    def falling(self, creep_time: float) -> "Spring":
        return Spring(self.stiffness, creep_time)


def check_lever(lever: Any) -> None:
    """Raise ValueError if an object is no lever, or its functions do not do what is asked of them.

    Those of a class of the user's own are tried once.
    """
    if isinstance(lever, Cantilever):
        raise ValueError(
            f"lever = {lever!r}: goes into modes; for a solver it must be "
            f"softafm.instrument.lever.Spring({lever.stiffness:g})"
        )
    refuse_incomplete("lever", lever, members(Lever), _WANTED)
    if is_built_in(lever):
        return
    state = lever.at_start()
    _check_array("lever.at_start()", state)
    _check_response("lever", lever, state)
    try:
        falling = lever.falling(_INSTANT)
    except TypeError as error:
        raise ValueError(f"lever.falling: must take a creep time, s: {error}") from None
    refuse_incomplete("lever.falling(...)", falling, members(Lever), _WANTED)
    if type(falling) is not type(lever):
        _check_response("lever.falling(...)", falling, state)


def _check_array(name: str, value: Any) -> None:
    plain = isinstance(value, np.ndarray) and value.dtype == float and value.ndim == 1
    if not (plain and value.flags.c_contiguous and np.isfinite(value).all()):
        shown = " ".join(show(value).split())
        raise ValueError(f"{name} = {shown}: must be an array of finite floats, of shape (n,)")


def _check_response(of: str, lever: Any, state: np.ndarray) -> None:
    """Try both compiled functions in one short step without deflection and force."""
    from softafm.compiled.functions import ACCEPTANCE, RESPONSE, CompiledFunction

    if lever.stiffness != inf:
        check_positive(f"{of}.stiffness", lever.stiffness, "N/m")
    found, name = lever.compiled_response, f"{of}.compiled_response"
    if not (isinstance(found, tuple) and len(found) == 3):
        raise ValueError(
            f"{name} = {show(found)}: must be a property that returns three things: two functions "
            "decorated with compile_when_used, for RESPONSE and ACCEPTANCE, and an array"
        )
    for i, (wanted, signature) in enumerate((("RESPONSE", RESPONSE), ("ACCEPTANCE", ACCEPTANCE))):
        if not (isinstance(found[i], CompiledFunction) and found[i].signature() == signature):
            raise ValueError(
                f"{name}[{i}] = {found[i]!r}: must be a function decorated with "
                f"softafm.compiled.functions.compile_when_used({wanted})"
            )
    _check_array(f"{name}[2]", found[2])
    results = []
    for i, function in enumerate(found[:2]):
        kept = state.copy()
        try:
            results.append(function(_INSTANT, _INSTANT, 0.0, 0.0, found[2], kept))
        except Exception as error:  # numba raises many types
            raise ValueError(
                f"{name}[{i}]: must be a function that numba compiles: {find_first_line(error)}"
            ) from error
        if i == 0 and not np.array_equal(kept, state):
            raise ValueError(f"{name}[0]: changes the state: only the second function may")
    _check_array(f"the state after {name}[1]", kept)
    rest, stiffness = results[0]
    if not (isfinite(rest) and stiffness > 0):
        raise ValueError(
            f"{name}[0] = ({rest:g} m, {stiffness:g} N/m) in a step of {_INSTANT:g} s without "
            "deflection and force: must be a finite rest, then a stiffness above 0"
        )


def make_lever(stiffness: float | None) -> Rigid | Spring:
    """Return the quasi-static lever of this stiffness, N/m; a rigid one for None."""
    return Rigid() if stiffness is None else Spring(stiffness)
