"""The surface of the energy solver between calls of its compiled loop: mesh, fields, clock."""

from math import ceil, inf, isinf, log2, sqrt
from typing import Any

import numpy as np

from softafm.bodies.mesh import UnitMesh, unit_mesh
from softafm.bodies.stiffness import STEP, Stiffness
from softafm.errors import DivergedError
from softafm.instrument.lever import Lever
from softafm.instrument.motion import Motion, is_steady
from softafm.instrument.motions import find_lowest_height
from softafm.solvers.energy.descent import descend
from softafm.solvers.energy.equilibrium import raise_tip, tip_force
from softafm.solvers.energy.frame import choose_frame, find_radius, transfer
from softafm.solvers.energy.layout import (
    DEFORMATION,
    LOAD,
    MEMORY,
    ORIGIN,
    Background,
    Functions,
    Mesh,
    Parameters,
    Room,
    Table,
    make_mesh,
    new_clock,
    new_room,
    no_background,
)
from softafm.solvers.energy.memory import recall
from softafm.solvers.energy.stiffness import find_stiffness
from softafm.solvers.energy.tuning import (
    APEX,
    ARCHIVE_GROWTH,
    ARCHIVE_SPACING,
    AT_ONCE,
    CLOSEST,
    COARSER_THAN_NEEDED,
    COARSEST_SPACING,
    EQUILIBRIUM_ERROR,
    EXTENT,
    FAR_SOFTER,
    FINER_THAN_NEEDED,
    FINEST_GROWTH,
    GROWTH,
    GROWTH_IF_SLACK,
    GROWTH_IF_SOFTER,
    GROWTH_IF_STEEP,
    HARDLY_SOFTER,
    HELD,
    HELD_IF_FAR_SOFTER,
    RIDE_FROM,
    SLACK,
    SLACKER,
    SOFTER,
    SPACING,
    SPACING_IF_FAR_SOFTER,
    TOO_SLOW,
    TRACE_FROM,
)

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(16)


class Surface:
    """A deformed surface on the mesh of the moment.

    Meshes form levels, each with half the edge spacing of the one before. ``target`` is the edge
    spacing aimed at, as a part of the width of the cohesive zone.
    """

    def __init__(
        self, contact: Any, motion: Motion, lever: Lever, strictness: float, finest_spacing: float
    ):
        self.contact = contact
        breaks = motion.breaks
        compliance = contact.body.compliance.chain(breaks[-1] - breaks[0])
        # An edge of a slack contact is faster than the tip by about the Tabor number.
        fastest = motion.top_speed * max(1.0, contact.tabor_softened)
        compliance = compliance.without_faster(AT_ONCE * contact.reach / fastest)
        height, height_parameters = motion.compiled_height
        profile, tip_parameters = contact.tip.compiled_profile
        law, potential, law_parameters = contact.surface.compiled_pressure
        respond, accept_force, lever_parameters = lever.compiled_response
        self.functions = Functions(height, profile, law, respond, accept_force, potential)
        self.parameters = Parameters(
            height_parameters,
            tip_parameters,
            law_parameters,
            np.append(compliance.instantaneous, compliance.elements),
            np.array(compliance.retardation_times, float),
            lever_parameters,
        )
        self.lever, self.lever_state = lever, lever.at_start()
        origin = find_gap_origin(contact)
        law_parameters[ORIGIN] = origin
        self.edge_gap = contact.edge_gap - origin
        # Where the cohesive zone ends: of a Lennard-Jones law the gap is twice that at the edge.
        opens = 3 ** (1 / 6) * contact.reach if contact.sticky else self.edge_gap
        self.open_gap = self.edge_gap + opens
        self.open_frame = contact.open_radius
        # Loose steps cost accuracy, a coarse mesh catches the edge: loops would be 15 % off.
        at_least = min(strictness, 1.0)
        self.accuracy = EQUILIBRIUM_ERROR * at_least
        sharpness = contact.surface.sharpness if contact.sticky else 1.0
        finer = at_least**0.25
        self.target = SPACING * finer / max(1.0, sharpness)
        self.growth = GROWTH * finer * find_fineness(contact, motion)
        # A stiff punch parts everywhere at once: the mesh stays at its rim, wherever the edge is.
        self.rimmed = contact.steep and contact.tabor_softened < SLACK
        if contact.steep and not self.rimmed:
            self.growth = min(self.growth, GROWTH_IF_STEEP * finer)
        period = float(breaks[-1] - breaks[0])
        duration = inf if is_steady(motion) else period
        softening = find_softening(self.parameters, duration)
        if softening > SOFTER:  # little elastic answer evens out what the nodes do not resolve
            self.growth = min(self.growth, GROWTH_IF_SOFTER * finer)
        if softening > FAR_SOFTER:
            self.target *= SPACING_IF_FAR_SOFTER
        # Where the tip rises steeply, at the rim of a punch, it holds the edge; and a sample that
        # is all memory parts evenly, without an edge.
        free = not contact.steep and find_softening(self.parameters, period) < FAR_SOFTER
        tabor = contact.tabor_after(period) if free and contact.sticky else 0.0
        slack = tabor > SLACK
        self.ride_from = RIDE_FROM * self.open_frame if slack else inf
        # What a steady cycle gathers is filtered at fixed radii, and a trace knows one stiffness.
        traced = tabor > SLACKER and not is_steady(motion) and isinf(contact.body.length)
        self.trace_from = TRACE_FROM if traced else inf
        if slack and find_softening(self.parameters, period) < HARDLY_SOFTER:
            self.growth = min(self.growth, GROWTH_IF_SLACK * finer)
        self.too_slow = TOO_SLOW[1 if is_steady(motion) else 0] * period
        self.held = choose_spacing_held(self.parameters, duration)
        self.finest_level = max(0, ceil(log2(COARSEST_SPACING / finest_spacing)))
        self.level = self.first_level = self.find_level(0.4 * contact.open_width / self.open_frame)
        self.meshes = self.most_nodes = 0
        self.finest_spacing, self.finest_used = inf, 0
        self._grids: dict[float, tuple[Mesh, Stiffness, Table]] = {}
        self.lay(self.build_mesh(self.level))
        self.archive = self.build_mesh(self.level), 0.0
        elements = self.parameters.retardation.size
        self._rooms: dict[tuple[int, int, int], Room] = {}
        self.fields = np.zeros((MEMORY + elements, self.mesh.nodes.size))
        self.lag_energy = np.zeros(elements)
        self.clock = new_clock()
        self.clock["time"] = breaks[0]
        self.clock["contraction"] = 0.0 if contact.tabor_instantaneous < SLACK else np.inf
        # The flat relaxed surface answers the first instant with its short-term modulus.
        first = contact.contact_radius_instantaneous(float(motion.height(breaks[0])))
        self.clock["frame"] = choose_frame(first, self.open_frame)
        self.background = no_background()
        self.clock["force_scale"] = contact.force_scale

    def build_mesh(self, level: int) -> UnitMesh:
        return unit_mesh(COARSEST_SPACING * 2.0**-level, self.growth, EXTENT)

    def lay(self, mesh: UnitMesh) -> None:
        """Take a mesh, that of the level, with the stiffness of the body on it."""
        self.meshes += 1
        self.most_nodes = max(self.most_nodes, mesh.nodes.size)
        self.finest_spacing = min(self.finest_spacing, mesh.edge_spacing)
        self.finest_used = max(self.finest_used, self.level)
        if mesh.edge_spacing not in self._grids:
            self._grids[mesh.edge_spacing] = self._make_grid(mesh)
        self.mesh, self.stiffness, self.table = self._grids[mesh.edge_spacing]

    def _make_grid(self, mesh: UnitMesh) -> tuple[Mesh, Stiffness, Table]:
        """Return a mesh as the kernels take it, and the stiffness of the body on it."""
        body = self.contact.body
        stiffness = Stiffness(body, mesh)
        shown = stiffness.uniform
        found = np.empty((0, 0) if shown is not None else stiffness.entries.shape[1:])
        if shown is None:
            shown = found.view()
            shown.setflags(write=False)
        table = Table(stiffness.entries, 0.0, STEP, found)
        return make_mesh(mesh, shown, body.decay), stiffness, table

    def tabulate(self, frame: float) -> None:
        """Let the mesh have the stiffness in a frame, m, and the table reach to it."""
        if self.stiffness.uniform is not None:
            return
        self.stiffness.reach(frame)
        start = np.log(self.contact.body.length) + STEP * self.stiffness.first
        self.table = self.table._replace(entries=self.stiffness.entries, start=float(start))
        find_stiffness(self.table, frame)

    def find_level(self, spacing: float) -> int:
        """Level of the mesh whose edge spacing, in contact radii, is at most this."""
        level = ceil(log2(COARSEST_SPACING / spacing) - 1e-9)
        return min(max(level, 0), self.finest_level)

    @property
    def time(self) -> float:
        """The instant, s."""
        return float(self.clock["time"])

    @property
    def bends(self) -> bool:
        """Whether the lever follows a force at once."""
        return self.lever.stiffness < inf

    def let_pass(self, time: float) -> None:
        """Let a lever that knows its deflection at a time, s, have it: one with inertia."""
        deflection_at = getattr(self.lever, "deflection_at", None)
        if deflection_at is not None:
            self.clock["deflection"] = deflection_at(time, self.lever_state)

    def mount(self, lever: Lever, state: np.ndarray) -> None:
        """Let another lever carry the tip, one that remembers ``state``, bent as it is now."""
        respond, accept_force, parameters = lever.compiled_response
        self.functions = self.functions._replace(respond=respond, accept_force=accept_force)
        self.parameters = self.parameters._replace(lever=parameters)
        self.lever, self.lever_state = lever, state

    def room(self) -> Room:
        """Return memory for the compiled loops to work in."""
        size = self.mesh.nodes.size, self.mesh.far.size, len(self.fields) - MEMORY
        if size not in self._rooms:
            self._rooms[size] = new_room(*size)
        return self._rooms[size]

    @property
    def spacing_held(self) -> float:
        """Spacing of the nodes under a receding edge, in zones, up to which the frame stays."""
        return self.held * self.target

    @property
    def coarseness_allowed(self) -> tuple[float, float]:
        """Bounds of the coarseness within which the mesh is kept."""
        coarsest_level = self.first_level if self.rimmed else 0
        finest = FINER_THAN_NEEDED * self.target if self.level > coarsest_level else 0.0
        return (
            finest,
            COARSER_THAN_NEEDED * self.target if self.level < self.finest_level else np.inf,
        )

    def remesh(self, coarseness: float) -> None:
        """Carry all fields to the mesh that suits a cohesive zone seen ``coarseness`` from here."""
        self.level = self.first_level
        if coarseness > 0:
            self.level = self.find_level(self.mesh.edge_spacing * self.target / coarseness)
        if self.rimmed:
            self.level = max(self.level, self.first_level)
        mesh = self.build_mesh(self.level)
        self.fields = self._carry(self.fields, mesh, 1.0)
        self.lay(mesh)

    def open(self) -> None:
        """Let go of the surface: it is as its memory has it, in the frame of a contact to come."""
        self.fields = self.fields.copy()  # which may be kept
        self._bear(np.zeros_like(self.fields[LOAD]))  # while the mesh still covers the contact
        self.level = self.first_level
        mesh, stretch = self.build_mesh(self.level), self.open_frame / self.clock["frame"]
        self.fields = self._carry(self.fields, mesh, stretch)
        self.lay(mesh)
        self.clock["frame"] = self.open_frame
        if self.bends:
            self.clock["deflection"] = 0.0
        self.fields[DEFORMATION] = -self.parameters.compliance[1:] @ self.memory()

    def keep(self) -> tuple[Any, ...]:
        """Return what ``restore`` needs to undo what happens from now on."""
        grid = self.level, self.mesh, self.stiffness, self.table
        return self.fields, self.lag_energy.copy(), self.clock.copy(), *grid

    def restore(self, kept: tuple[Any, ...]) -> None:
        """Be again as ``kept``."""
        self.fields, self.lag_energy, clock, *grid = kept
        self.level, self.mesh, self.stiffness, self.table = grid
        for name in clock.dtype.names:
            self.clock[name] = clock[name]

    def begin_archive(self, lowest: float, duration: float, strictness: float) -> None:
        """Gather memory on a mesh of its own, too, about the contact at the ``lowest`` height, m.

        There ``put_aside`` finds it as sharp as it was when the edge was there; ``duration``, s, is
        that of one visit of the tip.
        """
        finer = min(1.0, strictness**0.2)
        mesh = unit_mesh(ARCHIVE_SPACING * finer, ARCHIVE_GROWTH * finer, EXTENT)
        radius = self.contact.contact_radius_after(lowest, duration)
        self.archive = mesh, max(radius, self.open_frame)
        self.remember(np.zeros((len(self.lag_energy), mesh.nodes.size)))

    def put_aside(self) -> None:
        """Take the memory gathered so far for one from before now, which only fades."""
        old = self.background
        elements = len(old.values)
        fading = np.exp(-(self.time - old.since) / self.parameters.retardation)
        self.remember(fading[:, None] * old.values + old.gained[2 : 2 + elements])
        self.background.gained[:2] = old.gained[:2]
        self.fields[MEMORY:] = 0

    def rewind(self, time: float) -> np.ndarray:
        """Go back to ``time``; return the memory gained since, (elements, n) in Pa·m.

        It is returned on a mesh of its own, always the same, that of the finest level in the first
        cycle about its widest edge. From the second on it was gathered there. The surface keeps its
        mesh if it is in contact. To go on, ``remember`` first, then ``settle``.
        """
        clock, elements = self.clock, len(self.background.values)
        if elements:
            gained = self.background.gained[2 : 2 + elements]
        else:
            if self.archive[1] == 0:
                widest = max(float(clock["widest"]), self.open_frame)
                self.archive = self.build_mesh(self.finest_used), widest
            stretch = self.archive[1] / clock["frame"]
            gained = self._carry(self.fields[MEMORY:], self.archive[0], stretch)
        if clock["edge"] == 0:
            self.level = self.first_level
            mesh = self.build_mesh(self.level)
            self.fields = self._carry(self.fields, mesh, self.open_frame / clock["frame"])
            self.lay(mesh)
            clock["frame"] = self.open_frame
        self.fields[MEMORY:] = 0
        clock["time"] = time
        return gained

    def remember(self, memory: np.ndarray) -> None:
        """Take ``memory``, as ``rewind`` returned it, for that of all that was before now."""
        mesh, frame = self.archive
        self.background = Background(
            memory, frame, mesh.nodes[-1], mesh.edge_spacing, mesh.growth,
            frame * self.mesh.decay, self.time, mesh.nodes,
            np.zeros((len(memory) + 10, mesh.nodes.size)),
        )  # fmt: skip

    def memory(self) -> np.ndarray:
        """Return the memory fields now, (elements, n) in Pa·m."""
        memory = np.zeros((self.parameters.retardation.size, self.mesh.nodes.size))
        recall(
            self.background, self.time, self.clock["frame"], self.parameters.retardation,
            self.mesh.nodes, np.empty((7, self.mesh.nodes.size)), memory,
        )  # fmt: skip
        return memory + self.fields[MEMORY:]

    def _carry(self, fields: np.ndarray, mesh: UnitMesh, stretch: float) -> np.ndarray:
        """Return fields (m, n) on another mesh, in a frame ``stretch`` times larger."""
        old, n = self.mesh, mesh.nodes.size
        result = np.empty((len(fields), n))
        transfer(
            fields, old.nodes[-1], old.edge_spacing, old.growth, self.clock["frame"] * old.decay,
            stretch, mesh.nodes, np.empty((7, n)), result,
        )  # fmt: skip
        return result

    def settle(self) -> tuple[float, ...]:
        """Equilibrate at frozen memory and return the state as ``RECORD_FIELDS`` lists it."""
        mesh, clock = self.mesh, self.clock
        self.tabulate(float(clock["frame"]))
        height_at, profile, law, *_, potential = self.functions
        n, frame = mesh.nodes.size, clock["frame"]
        tip, scratch, rise = np.empty(n), np.empty(n), np.empty(mesh.far.size)
        raise_tip(profile, self.parameters.tip, mesh, frame, scratch, tip, rise)
        h0 = height_at(self.time, self.parameters.height)
        base = h0 - self.parameters.law[ORIGIN] + tip
        memory = self.memory()
        instantaneous, elements = self.parameters.compliance[0], self.parameters.compliance[1:]
        v = -elements @ memory
        standoff = base + clock["deflection"]
        shape = self.fields[DEFORMATION]
        # A tip that starts inside the surface pushes it away.
        pierced = standoff - shape < CLOSEST * self.edge_gap
        shape = np.where(pierced, standoff - self.edge_gap, shape)
        unknowns = np.append(shape, clock["deflection"])
        lever = self.lever.stiffness / (2 * np.pi * frame**2) if self.bends else 0.0
        iterations = descend(
            unknowns, v, frame * instantaneous, base, lever, rise, mesh,
            law, potential, self.parameters.law, self.accuracy, self.room(),
        )  # fmt: skip
        if iterations < 0:
            raise DivergedError(f"no stable surface found at height {h0:g} m")
        clock["deflection"] = unknowns[-1]
        return self.take(unknowns[:-1], v)

    def take(self, u: np.ndarray, v: np.ndarray) -> tuple[float, ...]:
        """Take a shape in equilibrium on a surface displaced by v, m, and return its record."""
        mesh, clock = self.mesh, self.clock
        height_at, profile, law, *_ = self.functions
        n, frame = mesh.nodes.size, clock["frame"]
        tip, pressure, scratch = np.empty(n), np.empty(n), np.empty(n)
        rise, far_work = np.empty(mesh.far.size), np.empty((3, mesh.far.size))
        raise_tip(profile, self.parameters.tip, mesh, frame, scratch, tip, rise)
        h0 = height_at(self.time, self.parameters.height)
        elements = self.parameters.compliance[1:]
        self.fields[DEFORMATION] = u
        load = (v - u) / self.parameters.compliance[0]
        self._bear(load)
        if len(self.background.values):
            mesh_there, frame_there = self.archive
            there = self._carry(self.fields[LOAD : LOAD + 1], mesh_there, frame_there / frame)
            self.background.gained[1] = there[0]
        gap = h0 - self.parameters.law[ORIGIN] + tip + clock["deflection"] - u
        law(gap, self.parameters.law, pressure, scratch, n)
        force = tip_force(pressure, gap, rise, mesh, frame, law, self.parameters.law, far_work)
        edge = frame * find_radius(gap, mesh.nodes, self.edge_gap)
        zone = frame * find_radius(gap, mesh.nodes, self.open_gap) - edge
        clock["frame_earlier"] = clock["frame_earliest"] = frame
        clock["edge"], clock["axis_gap"], clock["force"] = edge, gap[0], force
        clock["felt"] = edge
        clock["zone"] = zone if edge else 0.0
        clock["force_scale"] = max(clock["force_scale"], -force)
        clock["history"] = 1
        clock["rides"] = 0.0
        loss = 4 * np.pi * (elements / self.parameters.retardation) @ self.lag_energy
        spacing = frame * mesh.edge_spacing
        coarseness = spacing / max(zone, 1e-9 * frame) if edge else 0.0
        height = h0 + clock["deflection"]
        return self.time, height, force, edge, u[0], loss, 0.0, coarseness, frame, 0.0

    def _bear(self, load: np.ndarray) -> None:
        """Take a load q, Pa·m, at once: the lags q − y_m change by as much."""
        change, mean = load - self.fields[LOAD], 0.5 * (load + self.fields[LOAD])
        strained = self.clock["frame"] * (self.mesh.stiffness @ change)
        self.lag_energy += (mean - self.memory()) @ strained
        self.fields[LOAD] = load

    def energy(self) -> float:
        """Energy of the contact as an instantaneous elastic one, to infinity, and the lever, J."""
        mesh, frame, deflection = self.mesh, self.clock["frame"], self.clock["deflection"]
        h0 = self.functions.height(self.time, self.parameters.height) + deflection
        load = self.fields[LOAD]
        self.tabulate(float(frame))
        elastic = np.pi * frame * self.parameters.compliance[0] * (load @ mesh.stiffness @ load)

        end = frame * mesh.nodes[-1]
        beyond = 2 * end / (1 + _POINTS)
        # There the surface is as high as at the last node, as for the force: in a wide dent the tip
        # would be inside one that is flat.
        shape = self.fields[DEFORMATION]
        shape = np.concatenate([shape, np.full(beyond.size, shape[-1])])
        radius = np.concatenate([frame * mesh.nodes, beyond])
        gap = h0 + self.contact.tip.profile(radius) - shape - self.parameters.law[ORIGIN]
        density = np.empty(gap.size)
        self.functions.potential(gap, self.parameters.law, density, gap.size)
        areas = np.concatenate([frame**2 * mesh.masses, _WEIGHTS * beyond**3 / (2 * end)])
        bending = 0.5 * self.lever.stiffness * deflection**2 if self.bends else 0.0
        return float(elastic + bending + 2 * np.pi * areas @ density)

    def stored_energy(self) -> float:
        """Energy stored in sample, surfaces and lever, J.

        That of ``energy``, and ½ J_m ⟨y_m, K⁻¹ y_m⟩ of the elements. Old rims in y_m may lie on
        coarse nodes; as y_m is q less a lag, ⟨q, K⁻¹ (y_m − ½ q)⟩ and the energy of the lag is the
        same, but of elements too slow to move a small difference.
        """
        load, memory, frame = self.fields[LOAD], self.memory(), self.clock["frame"]
        summed = 0.5 * frame * np.sum((memory @ self.mesh.stiffness) * memory, axis=1)
        carried = frame * (memory - 0.5 * load) @ self.mesh.stiffness @ load + self.lag_energy
        elements = np.where(self.parameters.retardation > self.too_slow, summed, carried)
        return self.energy() + float(2 * np.pi * self.parameters.compliance[1:] @ elements)


def find_fineness(contact: Any, motion: Motion) -> float:
    """Return by how much less nodes may grow apart for the apex of a tip to be resolved.

    The nodes at the axis see the apex. In the radius of the contact, its own is half the height at
    the edge in that of the paraboloid that the apex begins as.
    """
    height = contact.reach - find_lowest_height(motion)
    if height <= 0:
        return 1.0
    radius = contact.tip.radius_at(height)
    apex = contact.effective_radius * height / radius**2
    return float(min(max(APEX * apex, FINEST_GROWTH), 1.0))


def find_softening(parameters: Parameters, duration: float) -> float:
    """Return the compliance that a sample gains in a ``duration``, s, in instantaneous ones."""
    elements, times = parameters.compliance[1:], parameters.retardation
    return float(-elements @ np.expm1(-duration / times) / parameters.compliance[0])


def choose_spacing_held(parameters: Parameters, duration: float) -> float:
    """Return the spacing under a receding edge, in that aimed at, up to which the frame stays.

    By how much softer the sample gets in a ``duration``, s: one that does not has no memory.
    """
    softened = find_softening(parameters, duration)
    if softened < HARDLY_SOFTER:
        return 0.0
    return HELD if softened < FAR_SOFTER else HELD_IF_FAR_SOFTER


def find_gap_origin(contact: Any) -> float:
    """Return where the solver counts gaps from, m, so that pressures change alike in all of them.

    Steps, errors and the mesh are judged relative to the gap. That suits a Lennard-Jones law, whose
    pressure changes as a power of the gap. Any other law is counted from where a Lennard-Jones law
    has its zero that is as stiff at its equilibrium and has the same largest tension; one that only
    repels so that its pressure changes as it does there. Laws that go on below a gap of zero are
    counted from farther in if they only there resist as much as the sample can.
    """
    law, edge = contact.surface, contact.edge_gap
    if contact.pulled:
        gap = law.equilibrium_gap
        origin = gap + 9 * sqrt(3) * law.largest_tension / float(law.slope(gap))
    else:
        origin = edge - 20 * contact.reach
    hardest = 1 / contact.body.compliance.instantaneous
    while law.overlaps and law.pressure(origin + CLOSEST * (edge - origin)) < hardest:
        origin -= 0.2 * (edge - origin)
    return max(origin, law.closest_gap)
