"""Force spectroscopy: the base of a cantilever is moved, and the lever bends."""

from typing import TYPE_CHECKING, Any

from softafm.contact import Contact
from softafm.instrument.cantilever import Cantilever
from softafm.instrument.motion import Motion
from softafm.modes.force_distance import MOTIONS, measure_ramp
from softafm.modes.mode import Mode
from softafm.modes.parts import Layout
from softafm.modes.perform import perform
from softafm.modes.regularise import Regularise
from softafm.progress import Progress
from softafm.results.content import RAMPED, observables
from softafm.solvers.history import History
from softafm.solvers.solver import Solver

if TYPE_CHECKING:
    from xarray import Dataset


def force_spectroscopy(
    contact: Contact,
    cantilever: Cantilever,
    motion: Motion,
    *,
    solver: Solver | None = None,
    tolerance: float = 1e-2,
    profiles: bool = False,
    progress: bool | Progress | None = None,
    check: bool = False,
    regularise: Regularise = "auto",
) -> "Dataset":
    """Force and deflection of a cantilever whose base moves far slower than it vibrates.

    The tip is at h0 = Z + q with the quasi-static deflection k q = F (Rajabifar et al. 2021,
    equation 28). Deflection and surface are found together, so that where a stable equilibrium of
    both ends, they jump together.

    Parameters
    ----------
    contact
        Tip, sample and surface law.
    cantilever
        Its stiffness k counts.
    motion
        Motion of the base, Z(t), by the height of the unbent tip above the undeformed surface:
        ``Triangle`` (perhaps with ``setpoint_force`` and ``dwell``), ``Sine`` or ``Trajectory``.
    solver, tolerance, profiles, progress, check, regularise
        As for ``force_distance``.

    Returns
    -------
    xarray.Dataset
        The curves and scalars of ``force_distance``, and over ``time`` ``base_height`` Z and
        ``deflection`` q, positive away from the sample. ``loop_energy`` is −∮F dZ. All SI.

    Raises
    ------
    ValueError
        If the tip starts inside the surface or an argument is out of range.
    DivergedError
        If the solver cannot continue.
    """
    return perform(
        MODE, contact, motion, cantilever, solver=solver, tolerance=tolerance, profiles=profiles,
        progress=progress, check=check, regularise=regularise,
    )  # fmt: skip


def observe_lever(contact: Contact, motion: Any, history: History) -> dict[str, Any]:
    """Return base height and deflection over time, and the scalars of a force curve."""
    base = history.motion.height(history.time)
    return {
        "base_height": base,
        "deflection": history.tip_height - base,
        **measure_ramp(history, base),
    }


MODE = Mode(
    name="force-spectroscopy",
    function=force_spectroscopy,
    motions=MOTIONS,
    observables=observables("base_height", "deflection", over=("time",)) | observables(*RAMPED),
    observe=observe_lever,
    lever="stiffness",
    figure=Layout((("time", "deflection"), ("base_height", "force"), ("tip_height", "force"))),
    other_names="forcecurve fz",
)
