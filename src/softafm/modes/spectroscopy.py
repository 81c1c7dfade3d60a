"""Force spectroscopy: the base of a cantilever is moved, and the lever bends."""

from functools import partial
from typing import TYPE_CHECKING, Any

from softafm.contact import Contact
from softafm.instrument.cantilever import Cantilever
from softafm.instrument.motions import Sine, Trajectory, Triangle
from softafm.modes.check import Scales, checked, finer_run
from softafm.modes.force_distance import ramp_observables
from softafm.modes.start import carry, refuse_other_than_cantilever, regularised
from softafm.progress import Progress
from softafm.results.datasets import dataset, record_regularisation

if TYPE_CHECKING:
    from xarray import Dataset


def force_spectroscopy(
    contact: Contact,
    cantilever: Cantilever,
    motion: Triangle | Sine | Trajectory,
    *,
    solver: Any = None,
    tolerance: float = 1e-2,
    profiles: bool = False,
    progress: bool | Progress | None = None,
    check: bool = False,
    regularise: float | None = None,
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
    refuse_other_than_cantilever(cantilever)
    finer = finer_run(check, solver, tolerance)
    given, contact = contact, regularised(contact, regularise)
    solver, tolerance, history = carry(
        contact, motion, solver, tolerance, profiles, progress, stiffness=cantilever.stiffness
    )
    base = history.motion.height(history.time)
    observables = {
        "base_height": ("time", base),
        "deflection": ("time", history.tip_height - base),
        **ramp_observables(history, base),
    }
    result = dataset(
        "force-spectroscopy", contact, motion, solver, tolerance, history, observables, cantilever
    )
    record_regularisation(result, given, contact, regularise)
    repeat = partial(force_spectroscopy, contact, cantilever, motion)
    scales = Scales(contact.reach, contact.reach)
    return checked(result, finer, tolerance, scales, repeat, progress)
