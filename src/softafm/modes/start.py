"""What all modes begin with: checks, and a run of the solver."""

from softafm._validate import tolerance_of
from softafm.progress import reporting
from softafm.solvers.energy import Energy


def carry(contact, motion, solver, tolerance, profiles, progress, **options):
    """Carry a contact through a motion; return the solver, the tolerance and the history.

    ``solver`` None stands for ``Energy()``. ``options`` go to the solver.
    """
    tolerance = tolerance_of(tolerance)
    solver = Energy() if solver is None else solver
    refuse_start_inside(contact, motion)
    with reporting(progress) as report:
        history = solver.solve(
            contact, motion, tolerance=tolerance, profiles=profiles, progress=report, **options
        )
    return solver, tolerance, history


def refuse_start_inside(contact, motion) -> None:
    """Raise ValueError if the tip starts below the equilibrium gap, inside the surface."""
    start = float(motion.height(motion.breaks[0]))
    gap = contact.surface.equilibrium_gap
    if start <= gap:
        raise ValueError(
            f"start height = {start:g} m: must be above the equilibrium gap, {gap:g} m "
            "(the tip would start inside the surface)"
        )
