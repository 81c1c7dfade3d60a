"""Known answers for the contact of a result, by name, where they suit it."""

from collections.abc import Callable
from dataclasses import replace
from math import isinf, pi

import numpy as np
import xarray as xr

from softafm import indentation
from softafm.contact import Contact
from softafm.draw.described import read_contact, read_sine
from softafm.instrument.motion import Motion
from softafm.instrument.motions import Trajectory
from softafm.tips import Paraboloid

Line = tuple[np.ndarray, np.ndarray]
"""Heights of the tip, m, and forces on it, N."""

_POINTS = 401
_MOST_STEPS = 2000
_HALVINGS = 80


def find_answer(name: str, run: xr.Dataset) -> Line:
    """Return heights and forces of the known answer of a name, for the contact of a result.

    Heights are those at which the surfaces rest on each other: at a gap of no pressure, or of a law
    that only repels, of the mean pressure under the largest force.

    Raises
    ------
    ValueError
        If the answer does not suit the contact, or its motion.
    """
    try:
        contact = read_contact(run)
        if not isinf(contact.body.length):
            raise ValueError(
                f"is of a half-space, and the sample is the body '{contact.body.kind}'"
            )
        gap = _find_resting_gap(contact, run)
        depth, force = ANSWERS[name][1](contact, run, gap)
    except ValueError as error:
        raise ValueError(f"reference = '{name}': {error}") from None
    return gap - depth, force


def _find_resting_gap(contact: Contact, run: xr.Dataset) -> float:
    law = contact.surface
    if law.attracts:
        return law.equilibrium_gap
    deep = contact.edge_gap - float(run["tip_height"].min())
    area = pi * float(indentation.contact_radius(contact.tip, deep)) ** 2
    if area == 0:
        return contact.edge_gap
    pressure = float(run["force"].max()) / area
    low, high = max(law.closest_gap, 0.0), contact.edge_gap
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if law.pressure(middle) > pressure else (low, middle)
    return high


def _press(contact: Contact, run: xr.Dataset, gap: float) -> np.ndarray:
    """Return depths from the start of a run to its lowest height, m."""
    height = run["tip_height"].values
    return np.linspace(gap - height.max(), gap - height.min(), _POINTS)


def _find_modulus(contact: Contact) -> float:
    creep = contact.body.compliance
    if creep.elements.size or creep.fluidity:
        raise ValueError(
            f"is of an elastic sample, and '{contact.rheology.kind}' creeps; 'ting' and "
            "'lee-radok' are of such samples, and softafm.indentation takes any modulus"
        )
    return 1 / float(creep.instantaneous)


def _find_work(contact: Contact) -> float:
    if not contact.adhesive:
        raise ValueError(
            f"is of an adhesive contact, and the law '{contact.surface.kind}' has no adhesion; "
            "take 'hertz'"
        )
    return contact.surface.work_of_adhesion


def _find_hertz(contact: Contact, run: xr.Dataset, gap: float) -> Line:
    depth = _press(contact, run, gap)
    return depth, indentation.force(contact.tip, depth, _find_modulus(contact))


def _find_dmt(contact: Contact, run: xr.Dataset, gap: float) -> Line:
    if not isinstance(contact.tip, Paraboloid):
        raise ValueError(
            f"is of a paraboloid, and the tip is a '{contact.tip.kind}'; take 'maugis'"
        )
    depth = np.sort(np.append(_press(contact, run, gap), [-1e-15, 0.0]))
    modulus, work = _find_modulus(contact), _find_work(contact)
    return depth, indentation.dmt_force(contact.tip.radius, depth, modulus, work)


def _find_jkr(contact: Contact, run: xr.Dataset, gap: float) -> Line:
    modulus, work = _find_modulus(contact), _find_work(contact)
    deepest = _press(contact, run, gap)[-1]
    curve = indentation.jkr(contact.tip, modulus, work, deepest)
    return curve.depth, curve.force


def _find_maugis(contact: Contact, run: xr.Dataset, gap: float) -> Line:
    modulus, work = _find_modulus(contact), _find_work(contact)
    tension, deepest = contact.surface.largest_tension, _press(contact, run, gap)[-1]
    curve = indentation.maugis(contact.tip, modulus, work, tension, deepest)
    return curve.depth, curve.force


def _find_lee_radok(contact: Contact, run: xr.Dataset, gap: float) -> Line:
    curve = indentation.lee_radok(contact.tip, contact.sample, _find_motion(run, gap))
    return curve.depth, curve.force


def _find_ting(contact: Contact, run: xr.Dataset, gap: float) -> Line:
    curve = indentation.ting(contact.tip, contact.sample, _find_motion(run, gap))
    return curve.depth, curve.force


def _find_motion(run: xr.Dataset, gap: float) -> Motion:
    """Return how the tip of a run moved, counted from where surfaces rest on each other."""
    sine = read_sine(run)
    if sine is not None:
        cycles = run.attrs.get("solver_cycles", 1)
        if sine.steady and cycles > 1:
            raise ValueError(
                f"is of one dent in a surface at rest, and this is cycle {cycles:g}, before which "
                "the surface had not come to rest; take a run with cycles = 1"
            )
        return replace(sine, mean_height=sine.mean_height - gap, cycles=sine.periods)
    time, height = run["time"].values, run["tip_height"].values - gap
    if time.size > _MOST_STEPS:
        kept = np.union1d(np.linspace(0, time.size - 1, _MOST_STEPS).astype(int), height.argmin())
        time, height = time[kept], height[kept]
    # Between steps ramps are straight, and the tip of a lever follows a curve.
    return Trajectory(time, height, smooth="base_height" in run)


ANSWERS: dict[str, tuple[str, Callable[[Contact, xr.Dataset, float], Line]]] = {
    "hertz": ("Hertz (no adhesion)", _find_hertz),
    "dmt": ("DMT", _find_dmt),
    "jkr": ("JKR", _find_jkr),
    "maugis": ("Maugis-Dugdale", _find_maugis),
    "lee-radok": ("Lee-Radok (no adhesion)", _find_lee_radok),
    "ting": ("Ting (no adhesion)", _find_ting),
}
"""By name what a legend calls an answer, and depths (m) and forces of it."""
