"""What carries the tip, as a solver sees it: it bends under the force and may remember.

The deflection q of a lever adds to the height of its base. At the end of a step it is

    q = rest + F/k,

F being the force on the tip, positive = repulsive. The rest and the stiffness k of the step follow
from its length and from what the lever remembers; the solver finds q and F together with the shape
of the surface, and lets the lever remember F once the step is accepted.
"""

from dataclasses import dataclass
from math import inf
from typing import Any, Protocol

import numpy as np

from softafm.checks.kinds import refuse_incomplete
from softafm.checks.validate import check_positive


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
    """Raise ValueError if an object is no lever; the line says what it lacks."""
    needed = "stiffness", "compiled_response", "at_start", "falling"
    refuse_incomplete("lever", lever, needed, "a lever such as softafm.instrument.lever.Spring(1)")


def make_lever(stiffness: float | None) -> Rigid | Spring:
    """Return the quasi-static lever of this stiffness, N/m; a rigid one for None."""
    return Rigid() if stiffness is None else Spring(stiffness)
