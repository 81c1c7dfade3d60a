"""What a solver is: what modes ask of one, and whether an object keeps to it."""

from inspect import Parameter, signature
from typing import Any, Protocol

from softafm.checks.kinds import members, refuse_incomplete
from softafm.checks.refusals import join_with_and
from softafm.instrument.motion import Motion
from softafm.progress import Progress
from softafm.solvers.history import History

_OPTIONS = ("stiffness", "tolerance", "profiles", "progress")


class Solver(Protocol):
    """Carries a contact through a motion.

    A solver whose steps do not adapt to the tolerance has ``steps`` and ``nodes`` among its fields;
    no tolerance is kept with its results, and experiment files refuse one. One of experiment files
    also states ``expected_seconds(contact, motion)``, the order of magnitude of the time of a run,
    s, which ``softafm info`` shows.
    """

    @property
    def kind(self) -> str:
        """Its name."""

    @property
    def adaptive(self) -> bool:
        """Whether its steps adapt to the tolerance."""

    def solve(
        self,
        contact: Any,
        motion: Motion,
        *,
        stiffness: float | None = None,
        tolerance: float = 1e-2,
        profiles: bool = False,
        progress: Progress | None = None,
    ) -> History:
        """Carry a contact, flat and relaxed at first, through a motion, a steady one until it is
        periodic.

        ``stiffness`` is that of a lever whose base moves so, N/m, or None where the tip does.
        ``progress`` is called with the fraction done and a message.

        Raises
        ------
        DivergedError
            If the run cannot go on.
        """


def check_solver(solver: Any) -> None:
    """Raise ValueError if an object is no solver; the line says what it lacks."""
    refuse_incomplete(
        "solver", solver, members(Solver), "a solver such as softafm.solvers.Energy()"
    )
    known = signature(solver.solve).parameters.values()
    if any(each.kind is Parameter.VAR_KEYWORD for each in known):
        return
    names = {each.name for each in known}
    if missing := [name for name in _OPTIONS if name not in names]:
        raise ValueError(
            f"solver.solve: of the solver '{solver.kind}' must take {join_with_and(missing)}; "
            "softafm.solvers.solver.Solver states its arguments"
        )
