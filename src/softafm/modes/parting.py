"""At what height a tip parts from a sample."""

from math import floor, log10, pi, sqrt
from typing import TYPE_CHECKING

import numpy as np

from softafm import indentation

if TYPE_CHECKING:
    from softafm.contact import Contact

_RADII = np.geomspace(1e-4, 1e4, 321)


def estimate_parting_height(
    contact: "Contact", work_of_adhesion: float, stiffness: float | None = None
) -> float:
    """Return the height from which on a relaxed contact has parted, m; 0 without adhesion.

    It is that of the tip, or of the unbent tip of a lever of some ``stiffness``, N/m: the highest
    of all contacts that adhere as JKR's with a ``work_of_adhesion``, J/m², or pulled with 2πRW as a
    stiff one's.
    """
    if not contact.adhesive:
        return 0.0
    radius = contact.tip.radius_at(contact.reach) * _RADII
    modulus, work = contact.softened_modulus, work_of_adhesion
    heights = -contact.body.depth(contact.tip, radius, modulus, work)
    bent = 0.0
    if stiffness is not None:
        heights -= indentation.jkr_load(contact.tip, radius, modulus, work) / stiffness
        bent = 2 * pi * contact.effective_radius * work / stiffness
    return float(max(heights.max(), bent)) + contact.edge_gap + contact.reach


def estimate_work_at_speed(contact: "Contact", speed: float) -> float:
    """Return the work of adhesion, J/m², that parting at a speed, m/s, takes, about; 0 of none.

    The edge of a contact that opens faster than its cohesive zone creeps takes more, at most in the
    ratio of the moduli: about the root of that in which the sample is stiffer at the time in which
    the edge crosses the zone (Persson and Brener 2005, Physical Review E 71, 036123).
    """
    if not contact.adhesive:
        return 0.0
    creep, work = contact.body.compliance, contact.surface.work_of_adhesion
    modulus, R = contact.softened_modulus, contact.effective_radius
    zone = modulus * contact.surface.range**2 / work
    radius = (6 * pi * work * R**2 / modulus) ** (1 / 3)
    crossing = zone / (speed * R / radius)
    return work * max(1.0, sqrt(1 / (modulus * float(creep.at(crossing)))))


def find_apparent_work(contact: "Contact", radius: float, tip_height: float) -> float:
    """Return the work of adhesion, J/m², that holds a relaxed contact of a radius at a height, m.

    That of JKR: a contact that is pulled fast bears more than the sample's own.
    """
    modulus = contact.softened_modulus
    depth = float(contact.body.depth(contact.tip, np.array([radius]), modulus, 0.0)[0])
    return modulus * max(depth + tip_height, 0.0) ** 2 / (2 * pi * radius)


def round_up(value: float) -> float:
    """Return a number above zero with two digits, or the next above it."""
    unit = 10.0 ** (floor(log10(value)) - 1)
    return float(np.ceil(value / unit)) * unit
