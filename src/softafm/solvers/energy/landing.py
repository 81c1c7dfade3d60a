"""The far side of a jump, solved for at once where its shape can be foreseen.

A soft and sticky contact jumps over so many cohesive zones that a creep from shape to shape takes
thousands of steps. Both ends are known beforehand: a contact of JKR's kind on the surface as its
memory has left it, and the open surface. A landing is taken if it is stable and lower in energy.
"""

from math import inf, pi
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from softafm.errors import DivergedError
from softafm.solvers.energy.equilibrium import raise_tip, tip_force
from softafm.solvers.energy.fall import is_jump
from softafm.solvers.energy.frame import transfer
from softafm.solvers.energy.layout import LOAD, MEMORY, ORIGIN
from softafm.solvers.energy.riding import ride
from softafm.solvers.energy.tuning import CLOSEST, RIDING_ERROR

if TYPE_CHECKING:
    from softafm.solvers.energy.surface import Surface

_ANGLES, _WEIGHTS = (pi / 4 * x for x in np.polynomial.legendre.leggauss(24))
_SINES = np.sin(_ANGLES + pi / 4)
_MOST_SECANTS = 20
_FARTHEST_STEP = 0.15
"""Largest step of the contact radius between two shapes of a search, relative to it."""


class Landing:
    """A surface at the height of the tip at ``time``, on a mesh that suits a contact to come."""

    def __init__(self, surface: "Surface", time: float):
        self.surface = surface
        # A lever with inertia holds the tip where it is, bent.
        self.held = 0.0 if surface.bends else float(surface.clock["deflection"])
        self.base = surface.functions.height(time, surface.parameters.height) + self.held
        self.compliance = float(surface.parameters.compliance[0])
        self.lever = surface.lever.stiffness if surface.bends else inf
        law = surface.contact.surface
        self.closed_gap = float(law.equilibrium_gap) - surface.parameters.law[ORIGIN]
        self.work = law.work_of_adhesion
        self.memory = surface.memory()
        self.mesh, self.frame = surface.mesh, float(surface.clock["frame"])

    def displacement(self, radius: np.ndarray) -> np.ndarray:
        """What the memory displaces the surface by at some radii, m, shape (n,)."""
        elements = self.surface.parameters.compliance[1:]
        if not elements.size:
            return np.zeros(radius.size)
        known = -(elements @ self.memory)[None]
        found, mesh = np.empty((1, radius.size)), self.mesh
        transfer(
            known, mesh.nodes[-1], mesh.edge_spacing, mesh.growth, self.frame * mesh.decay,
            1 / self.frame, radius, np.empty((7, radius.size)), found,
        )  # fmt: skip
        return found[0]

    def heights(self, radius: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Height of the tip, m, and force on it, N, in contacts of JKR's kind of some radii, m."""
        contact, modulus = self.surface.contact, 1 / self.compliance
        depth = contact.body.depth(contact.tip, radius, modulus, self.work)
        at = (radius[:, None] * _SINES).ravel()
        step = 1e-4 * at
        leaning = (self.displacement(at + step) - self.displacement(at - step)) / (2 * step)
        depth -= radius * (leaning.reshape(radius.size, -1) @ _WEIGHTS)
        origin = self.surface.parameters.law[ORIGIN] + self.closed_gap
        # dF = 2 E a dδ along the contacts of no adhesion; adhesion pulls by what it does to δ.
        whole = depth + np.sqrt(2 * pi * self.work / modulus * radius)
        thin = np.concatenate(
            [[whole[0] * radius[0] / 2], np.diff(whole) * (radius[1:] + radius[:-1]) / 2]
        )
        force = 2 * modulus * np.cumsum(thin)
        force -= np.sqrt(8 * pi * self.work * modulus * radius**3)
        return origin + self.displacement(np.zeros(1))[0] - depth, force

    def expected_radius(self) -> float:
        """Radius of the stable contact at this height, m; 0 if there is none."""
        radius = self.surface.open_frame * np.geomspace(1e-2, 1e4, 100)
        for closer in (True, False):
            height, force = self.heights(radius)
            miss = height - self.base - force / self.lever
            above = np.flatnonzero((miss[:-1] > 0) & (miss[1:] <= 0))
            if not above.size:
                return 0.0
            i = above[0]
            if closer:
                radius = np.append(radius[:i], np.linspace(radius[i], radius[i + 1], 10))
        return float(radius[i] + (radius[i + 1] - radius[i]) * miss[i] / (miss[i] - miss[i + 1]))

    def crack(self, radius: float, height: float) -> np.ndarray:
        """Displacement of the surface pressed to a closed gap inside a radius and free outside."""
        mesh, surface = self.surface.mesh, self.surface
        inside = mesh.nodes <= 1.0
        tip = surface.contact.tip.profile(radius * mesh.nodes)
        v = self.displacement(radius * mesh.nodes)
        offset = height - surface.parameters.law[ORIGIN] - self.closed_gap + tip - v
        free = mesh.stiffness[~inside]
        outside = cho_solve(cho_factor(free[:, ~inside]), -free[:, inside] @ offset[inside])
        result = v.copy()
        result[inside] += offset[inside]
        result[~inside] += outside
        return result

    def solve(self, radius: float, shape: np.ndarray, height: float, lifts: bool) -> Any:
        """Newton's method from a shape: radius, shape, height and force found, or None.

        With ``lifts`` the radius is kept and the height is found; else the lever holds the tip.
        """
        surface, mesh, n = self.surface, self.surface.mesh, self.surface.mesh.nodes.size
        law, parameters = surface.functions.pressure, surface.parameters
        room, clock = surface.room(), surface.clock
        tip, rise, scratch = np.empty(n), np.empty(mesh.far.size), np.empty(n)
        surface.tabulate(radius)
        raise_tip(surface.functions.profile, parameters.tip, mesh, radius, scratch, tip, rise)
        start = height if lifts else self.base
        u = np.append(shape, height - start)
        v = self.displacement(radius * mesh.nodes)
        step = 1e-4 * mesh.edge_spacing
        slide = self.displacement(radius * (1 + step) * mesh.nodes) - v
        standoff = start - parameters.law[ORIGIN] + tip
        spring = 0.0 if lifts or self.lever == inf else self.lever / (2 * pi)
        iterations = ride(
            u, v, slide / (radius * step), radius, self.compliance, int(lifts), standoff, tip,
            spring, 0.0, rise, mesh, surface.functions.profile, parameters.tip, law,
            parameters.law, surface.edge_gap, CLOSEST * surface.edge_gap,
            RIDING_ERROR * surface.accuracy, clock, room.hessian, room.rows[7:11],
            room.rows[11:16], room.far[1:],
        )  # fmt: skip
        clock["newtons"] += abs(iterations)
        if iterations < 0:
            return None
        radius = radius if lifts else float(clock["found"])
        raise_tip(surface.functions.profile, parameters.tip, mesh, radius, scratch, tip, rise)
        force = tip_force(
            room.rows[8, :n].copy(), room.rows[7, :n].copy(), rise, mesh, radius, law,
            parameters.law, room.far[1:],
        )  # fmt: skip
        return radius, u[:n], start + u[n], force, v

    def search(self) -> Any:
        """Contact at the height of the tip: what ``solve`` returns, or None if none is found."""
        radius = self.expected_radius()
        if radius == 0:
            return None
        surface = self.surface
        law = surface.contact.surface
        zone = 0.85 * law.range**2 / (self.compliance * self.work)
        surface.level = surface.find_level(surface.target * zone / radius)
        surface.lay(surface.build_mesh(surface.level))
        height = float(self.heights(np.geomspace(0.5, 1, 64) * radius)[0][-1])
        surface.tabulate(radius)
        crack = self.crack(radius, height)
        shape, last = crack, None
        for _ in range(_MOST_SECANTS):
            found = self.solve(radius, shape, height, True)
            if found is None:
                return None
            _, shape, height, force, _ = found
            miss = height - self.base - force / self.lever
            if abs(miss) < 1e-3 * surface.edge_gap:
                break
            if last is None or last[1] == miss:
                beside = np.geomspace(0.99, 1, 33) * radius
                heights, forces = self.heights(beside)
                all_missed = heights - forces / self.lever
                slope = (all_missed[-1] - all_missed[-2]) / (beside[-1] - beside[-2])
            else:
                slope = (miss - last[1]) / (radius - last[0])
            last = radius, miss
            change = float(
                np.clip(-miss / slope, -_FARTHEST_STEP * radius, _FARTHEST_STEP * radius)
            )
            next_height = height + slope * change
            following = self.crack(radius + change, next_height)
            shape = shape + following - self.crack(radius, height)
            radius, height = radius + change, next_height
        else:
            return None
        return self.solve(radius, shape, self.base if self.lever == inf else height, False)


def land(
    surface: "Surface", time: float, before: float, touching: bool
) -> tuple[float, ...] | None:
    """Bring a surface that has lost its hold to where it goes; return its record, None if unknown.

    ``before`` is its energy, J, at the start of the jump, ``touching`` whether it was in contact
    there and so may part.
    """
    kept = surface.keep()
    start = float(surface.clock["axis_gap"]), float(surface.clock["edge"])
    for go in (_part, _snap_in) if touching else (_snap_in,):
        surface.clock["time"] = time
        record = go(surface)
        if record and surface.energy() < before and is_jump(surface.clock, *start):
            return record
        surface.restore(kept)
    return None


def _snap_in(surface: "Surface") -> tuple[float, ...] | None:
    landing = Landing(surface, surface.time)
    try:
        found = landing.search()
    except LinAlgError:
        return None
    if found is None:
        return None
    radius, shape, height, _, v = found
    old, mesh = landing.mesh, surface.mesh
    fields = np.zeros((surface.fields.shape[0], mesh.nodes.size))
    if fields.shape[0] > MEMORY:
        transfer(
            surface.fields[LOAD:].copy(), old.nodes[-1], old.edge_spacing, old.growth,
            landing.frame * old.decay, radius / landing.frame, mesh.nodes,
            np.empty((7, mesh.nodes.size)), fields[LOAD:],
        )  # fmt: skip
    surface.fields = fields
    surface.clock["frame"] = radius
    surface.clock["deflection"] = landing.held + height - landing.base
    record = surface.take(shape, v)
    surface.clock["edge"] = surface.clock["edge_earlier"] = radius
    surface.clock["felt"] = surface.clock["felt_earlier"] = radius
    surface.clock["rides"] = 1.0
    return record


def _part(surface: "Surface") -> tuple[float, ...] | None:
    surface.open()
    try:
        return surface.settle()
    except DivergedError:
        return None
