"""The default solver: implicit energy-minimising steps on a mesh that follows the contact edge."""

import warnings
from dataclasses import dataclass
from math import ceil, log2, sqrt
from time import perf_counter
from typing import ClassVar

import numpy as np

from softafm.compiled import announced_compilation
from softafm.errors import AccuracyWarning, DivergedError
from softafm.halfspace.mesh import node_index, unit_mesh
from softafm.solvers.history import History, Profiles

_COARSEST_SPACING = 0.3
EXTENT = 8.0
_FIRST_LEVEL = 1
_CHUNK = 256
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(16)


@dataclass(frozen=True)
class Energy:
    """Implicit steps that minimise the energy, with exact memory and elastic jumps.

    Each step solves an elastic adhesion problem whose compliance is that of the step and whose
    offset is the memory, by Newton's method; the memory is integrated exactly for a pressure
    quadratic in time. Steps adapt to the tolerance. Where no stable shape is near, the surface
    falls to the next one at frozen memory, and the jump is recorded. The mesh is scaled to the
    contact edge at every step and its spacing there follows the width of the cohesive zone.

    Parameters
    ----------
    finest_spacing
        Smallest node spacing at the contact edge, in contact radii. A cohesive zone that asks for
        less raises ``AccuracyWarning``.
    most_steps
        Attempted steps after which a run is given up with ``DivergedError``.
    """

    kind: ClassVar[str] = "energy"
    finest_spacing: float = 5e-6
    most_steps: int = 2_000_000

    def solve(self, contact, motion, *, tolerance=1e-2, profiles=False, progress=None) -> History:
        """Carry the contact, flat and relaxed at first, through the motion.

        Parameters
        ----------
        contact, motion
            ``softafm.Contact`` and a motion, e.g. ``softafm.Triangle``.
        tolerance
            Target relative error of forces and energies.
        profiles
            Keep the surface shapes.
        progress
            Callable of (fraction done, message), or None.

        Raises
        ------
        DivergedError
            If ``most_steps`` do not suffice or no stable shape is found.
        """
        started = perf_counter()
        with announced_compilation():
            from softafm.solvers import energy_kernel as kernel

            run = _Run(self, kernel, contact, motion, tolerance, profiles)
        run.rest()
        stops = np.union1d(motion.breaks, motion.landmarks)
        span = stops[-1] - stops[0]
        for stop in stops[1:]:
            if run.time in motion.breaks:
                run.start_piece(stop)
            run.most_per_step((stop - run.time) / 12)
            while not run.advance(stop):
                if progress is not None:
                    progress((run.time - stops[0]) / span, f"{run.time - stops[0]:.3g} s")
        if progress is not None:
            progress(1.0, "done")
        history = run.history(perf_counter() - started)
        for text in history.warnings:
            warnings.warn(text, AccuracyWarning, stacklevel=4)
        return history


class _Run:
    """The state of one run between calls of the compiled loop."""

    def __init__(self, solver, kernel, contact, motion, tolerance, keep_shapes):
        self.solver, self.kernel, self.contact, self.motion = solver, kernel, contact, motion
        compliance = contact.sample.reduced_compliance
        surface = contact.surface
        height, height_parameters = motion.compiled_height
        profile, tip_parameters = contact.tip.compiled_profile
        law, potential, law_parameters = surface.compiled_pressure
        self.functions = height, profile, law, potential
        self.parameters = kernel.Parameters(
            height_parameters,
            tip_parameters,
            law_parameters,
            np.concatenate([[compliance.instantaneous], compliance.modes]),
            np.array(compliance.retardation_times, float),
        )
        gap = surface.gap_of_largest_tension
        width = sqrt(contact.tip.radius * surface.equilibrium_gap)
        fastest = min([gap / motion.top_speed, *compliance.retardation_times])
        self.strictness = strictness = tolerance / 1e-2
        self.target = 0.2 * strictness**0.2
        self.growth = 0.25 * min(1.0, strictness**0.1)
        self.finest_level = max(0, ceil(log2(_COARSEST_SPACING / solver.finest_spacing)))
        self.level = min(_FIRST_LEVEL, self.finest_level)
        self.mesh = self._mesh(self.level)
        self.controls = kernel.Controls(
            end=0.0,
            shortest_step=1e-4 * strictness * fastest,
            longest_step=0.0,
            top_speed=motion.top_speed,
            open_frame=1.5 * width,
            gap_of_tension=gap,
            prediction=0.03 * strictness**0.7,
            memory=0.01 * strictness,
            force=0.01 * strictness,
            newton=1e-3 * strictness,
            slack=2.0,
            finest=0.0,
            coarsest=0.0,
            most_tries=float(solver.most_steps),
        )
        n = self.mesh.nodes.size
        self.fields = np.zeros((kernel.MEMORY + self.parameters.retardation.size, n))
        self.clock = np.zeros(kernel.CLOCK_SIZE)
        self.records = np.empty((_CHUNK, kernel.RECORD_WIDTH))
        self.keep_shapes = keep_shapes
        self.chunks: list[np.ndarray] = []
        self.shapes: list[tuple] = []
        self.meshes, self.most_nodes, self.finest_spacing = 1, n, self.mesh.edge_spacing
        self.coarsest = 0.0, 0.0

    @property
    def time(self) -> float:
        return self.clock[self.kernel.TIME]

    def _mesh(self, level):
        spacing = _COARSEST_SPACING * 2.0 ** -level
        return self.kernel.Mesh(*unit_mesh(spacing, self.growth, EXTENT))

    def rest(self):
        """Put the surface in equilibrium with the tip at its first height, without memory."""
        k, clock = self.kernel, self.clock
        work = self.contact.surface.work_of_adhesion
        clock[k.TIME] = self.motion.breaks[0]
        clock[k.FRAME] = self.controls.open_frame
        clock[k.FORCE_SCALE] = 0.2 * np.pi * self.contact.tip.radius * work
        row = np.zeros(k.RECORD_WIDTH)
        self._settle(row)
        self._keep(row[None], self.fields[k.DEFORMATION][None])

    def _settle(self, row):
        """Equilibrate at frozen memory and note the state in ``row`` of the records."""
        k, mesh, clock = self.kernel, self.mesh, self.clock
        height, profile, law, potential = self.functions
        n, frame = mesh.nodes.size, clock[k.FRAME]
        tip, pressure, scratch = np.empty(n), np.empty(n), np.empty(n)
        profile(frame * mesh.nodes, self.parameters.tip, tip, n)
        h0 = height(clock[k.TIME], self.parameters.height)
        u, memory = self.fields[k.DEFORMATION], self.fields[k.MEMORY :]
        instantaneous, modes = self.parameters.compliance[0], self.parameters.compliance[1:]
        v = -modes @ memory
        iterations = k.settle(
            u, v, frame * instantaneous, h0 + tip, mesh, law, potential, self.parameters.law,
            self.controls.newton,
        )  # fmt: skip
        if iterations < 0:
            raise DivergedError(f"no stable surface at tip height {h0:g} m", self.history(0.0))
        self.fields[k.LOAD] = (v - u) / instantaneous
        gap = h0 + tip - u
        law(gap, self.parameters.law, pressure, scratch, n)
        force = k.tip_force(
            pressure, gap, mesh, frame, tip[-1], potential, self.parameters.law, scratch
        )
        edge = frame * k.radius_of_gap(gap, mesh.nodes, self.controls.gap_of_tension)
        zone = frame * k.radius_of_gap(gap, mesh.nodes, 2 * self.controls.gap_of_tension) - edge
        lag = self.fields[k.LOAD] - memory
        rates = modes / self.parameters.retardation
        clock[k.FRAME_EARLIER] = clock[k.FRAME_EARLIEST] = frame
        clock[k.EDGE], clock[k.AXIS_GAP], clock[k.FORCE] = edge, gap[0], force
        clock[k.FORCE_SCALE] = max(clock[k.FORCE_SCALE], abs(force))
        clock[k.HISTORY] = 1
        row[k.R_TIME], row[k.R_HEIGHT], row[k.R_FORCE] = clock[k.TIME], h0, force
        row[k.R_EDGE], row[k.R_AXIS], row[k.R_FRAME] = edge, u[0], frame
        row[k.R_LOSS] = 2 * np.pi * frame * np.sum(rates * np.sum((lag @ mesh.stiffness) * lag, 1))
        row[k.R_COARSENESS] = frame * mesh.edge_spacing / zone if edge else 0.0

    def _energy(self) -> float:
        """Energy of the instantaneous elastic contact, to infinity, J."""
        k, mesh = self.kernel, self.mesh
        frame = self.clock[k.FRAME]
        h0 = self.functions[0](self.time, self.parameters.height)
        load = self.fields[k.LOAD]
        elastic = np.pi * frame * self.parameters.compliance[0] * (load @ mesh.stiffness @ load)

        def density(radius, deformation):
            gap = h0 + self.contact.tip.profile(radius) - deformation
            return self.contact.surface.potential(gap)

        near = frame**2 * mesh.masses @ density(frame * mesh.nodes, self.fields[k.DEFORMATION])
        end = frame * mesh.nodes[-1]
        r = 2 * end / (1 + _POINTS)
        beyond = np.sum(_WEIGHTS * density(r, 0.0) * r**3 / (2 * end))
        return float(elastic + 2 * np.pi * (near + beyond))

    def fall(self):
        """Pass the shortest step where no stable shape is near, and note a jump if it is one.

        The instantaneous compliance is given a retardation time of its own, far below the step,
        but for a share too stiff to be unstable. The fall is then a fast creep, which the same
        steps follow on the same riding mesh, down to the shape that is stable without that aid.
        """
        from softafm.kernels import still

        k, clock = self.kernel, self.clock
        start, gap, edge, before = self.time, clock[k.AXIS_GAP], clock[k.EDGE], self._energy()
        duration = self.controls.shortest_step
        stiff = min(0.2, (0.4 / self.contact.tabor_instantaneous) ** 1.5)
        functions, parameters, controls = self.functions, self.parameters, self.controls
        h0 = functions[0](start + duration, parameters.height)
        instantaneous, modes = parameters.compliance[0], parameters.compliance[1:]
        delayed = (1 - stiff) * instantaneous
        self.functions = (still, *functions[1:])
        self.fields = np.vstack([self.fields, self.fields[k.LOAD]])
        compliance = np.concatenate([[stiff * instantaneous], modes, [delayed]])
        for patience in range(8):
            creep_time = 10.0 ** (-4 - patience) * duration
            self.parameters = parameters._replace(
                height=np.array([h0]),
                compliance=compliance,
                retardation=np.append(parameters.retardation, creep_time),
            )
            self.controls = controls._replace(
                shortest_step=1e-9 * creep_time, longest_step=duration, top_speed=1e-300,
                prediction=0.2, memory=0.2, force=1.0,
            )  # fmt: skip
            clock[k.TIME], clock[k.STEP], clock[k.HISTORY] = 0.0, 1e-3 * creep_time, 1
            outcome = k.FULL
            while outcome in (k.FULL, k.REMESH):
                outcome, records, _ = self._call(duration)
                if outcome == k.REMESH:
                    self._remesh(records)
            lag = delayed * np.abs(self.fields[k.LOAD] - self.fields[-1]).max()
            if outcome != k.FINISHED or lag < 1e-4 * self.controls.gap_of_tension:
                break
        self.functions, self.parameters, self.controls = functions, parameters, controls
        self.fields = self.fields[:-1].copy()
        clock[k.TIME], clock[k.STEP] = start + duration, 10 * duration
        row = np.zeros(k.RECORD_WIDTH)
        self._settle(row)
        if abs(clock[k.AXIS_GAP] - gap) > 0.1 * gap or abs(clock[k.EDGE] - edge) > 0.05 * edge:
            row[k.R_JUMP] = before - self._energy()
        else:
            # No fall but a slip: the edge is caught by nodes too far apart for a contact so slack.
            self.target = max(self.target / 2, 0.02)
        self._keep(row[None], self.fields[k.DEFORMATION][None])

    def most_per_step(self, seconds):
        """Let no step be longer, however little happens: smooth curves need points."""
        self.target = 0.2 * self.strictness**0.2
        longest = seconds * self.strictness**0.25
        self.controls = self.controls._replace(longest_step=longest)

    def start_piece(self, stop):
        """Forget the past shapes: beyond a break of the motion they do not extrapolate."""
        k = self.kernel
        self.clock[k.HISTORY] = 1
        last = self.clock[k.LAST]
        self.clock[k.STEP] = 0.1 * last if last > 0 else 0.005 * (stop - self.time)

    def advance(self, stop) -> bool:
        """Run the compiled loop once; True if it reached ``stop``."""
        k = self.kernel
        outcome, records, shapes = self._call(stop)
        self._keep(records, shapes)
        if outcome == k.STUCK:
            raise DivergedError(
                f"stopped at t = {self.time:g} s after {self.clock[k.TRIES]:.0f} attempted steps "
                f"(most_steps = {self.solver.most_steps})",
                self.history(0.0),
            )
        if outcome == k.REMESH:
            self._remesh(records)
        if outcome == k.FALL:
            self.fall()
        return outcome == k.FINISHED

    def _call(self, stop):
        """Call the compiled loop once; return its outcome, records and shapes."""
        k = self.kernel
        controls = self.controls._replace(
            end=float(stop),
            finest=0.35 * self.target if self.level > 0 else 0.0,
            coarsest=1.3 * self.target if self.level < self.finest_level else np.inf,
        )
        shapes = np.empty((_CHUNK if self.keep_shapes else 0, self.mesh.nodes.size))
        outcome = k.advance(
            *self.functions, self.parameters, self.mesh, controls,
            self.fields, self.clock, self.records, shapes,
        )  # fmt: skip
        count = int(self.records[0, 0])
        return outcome, self.records[1:count], shapes[1:count]

    def _remesh(self, records):
        """Change to the mesh that suits the cohesive zone of the last record."""
        self._move_to(self._level_for(records[-1, self.kernel.R_COARSENESS]), 1.0)

    def _keep(self, records, shapes):
        k = self.kernel
        self.chunks.append(records.copy())
        if self.keep_shapes:
            for row, shape in zip(records, shapes, strict=True):
                self.shapes.append((row[k.R_FRAME], self.mesh, shape.copy()))
        if self.level == self.finest_level and len(records):
            worst = records[records[:, k.R_COARSENESS].argmax()]
            if worst[k.R_COARSENESS] > self.coarsest[0]:
                self.coarsest = float(worst[k.R_COARSENESS]), float(worst[k.R_EDGE])

    def _level_for(self, coarseness) -> int:
        """Level of the mesh that suits the cohesive zone, seen ``coarseness`` from this one."""
        if coarseness == 0:
            return min(_FIRST_LEVEL, self.finest_level)
        spacing = self.mesh.edge_spacing * self.target / coarseness
        level = ceil(log2(_COARSEST_SPACING / spacing) - 1e-9)
        return min(max(level, 0), self.finest_level)

    def _move_to(self, level, stretch):
        """Carry all fields to the mesh of this level, in frames ``stretch`` times larger."""
        k, old = self.kernel, self.mesh
        self.level, self.mesh = level, self._mesh(level)
        fields = np.empty((self.fields.shape[0], self.mesh.nodes.size))
        for before, after in zip(self.fields, fields, strict=True):
            k.transfer(
                before, old.nodes.size, old.nodes[-1], old.edge_spacing, old.growth, stretch,
                self.mesh.nodes, after,
            )  # fmt: skip
        self.fields = fields
        self.clock[k.FRAME : k.FRAME_EARLIEST + 1] *= stretch
        self.meshes += 1
        self.most_nodes = max(self.most_nodes, self.mesh.nodes.size)
        self.finest_spacing = min(self.finest_spacing, self.mesh.edge_spacing)

    def history(self, seconds) -> History:
        """Collect what was recorded."""
        k = self.kernel
        records = np.concatenate(self.chunks)
        time, jumped = records[:, k.R_TIME], records[:, k.R_JUMP] != 0
        breaks = np.flatnonzero(np.isin(time, self.motion.breaks[1:-1]))
        cuts = sorted([(i, i + 1) for i in breaks] + [(i, i) for i in np.flatnonzero(jumped)])
        starts = [0] + [start for start, _ in cuts]
        ends = [end for _, end in cuts] + [time.size]
        return History(
            time=time,
            tip_height=records[:, k.R_HEIGHT],
            force=records[:, k.R_FORCE],
            contact_radius=records[:, k.R_EDGE],
            axis_deformation=records[:, k.R_AXIS],
            viscous_power=records[:, k.R_LOSS],
            pieces=tuple(slice(int(a), int(b)) for a, b in zip(starts, ends, strict=True)),
            jump_time=time[jumped],
            jump_energy=records[jumped, k.R_JUMP],
            profiles=self._profiles() if self.keep_shapes else None,
            diagnostics={
                "steps": time.size - 1,
                "attempted_steps": int(self.clock[k.TRIES]),
                "newton_iterations": int(self.clock[k.NEWTONS]),
                "meshes": self.meshes,
                "most_nodes": self.most_nodes,
                "finest_spacing": self.finest_spacing,
                "growth": self.growth,
                "wall_time": seconds,
            },
            warnings=self._warnings(),
        )

    def _warnings(self) -> tuple[str, ...]:
        coarseness, edge = self.coarsest
        if coarseness <= 1.3 * self.target:
            return ()
        spacing = self.mesh.edge_spacing * edge
        surface = self.contact.surface
        factor = sqrt(coarseness / self.target)
        return (
            f"the cohesive zone at the contact edge, {spacing / coarseness:.2g} m wide, is resolved "
            f"by nodes {spacing:.2g} m apart (finest_spacing = {self.solver.finest_spacing:g} contact "
            f"radii) where {self.target * spacing / coarseness:.2g} m is needed: forces and above all "
            f"the loop energy may be wrong. Lower solvers.Energy(finest_spacing=...), or enlarge z0 "
            f"at fixed work of adhesion, LennardJones.from_work_of_adhesion("
            f"W={surface.work_of_adhesion:.4g}, z0={factor * surface.equilibrium_gap:.2g})",
        )

    def _profiles(self) -> Profiles:
        """Interpolate every shape to radii common to all."""
        from scipy.interpolate import make_interp_spline

        widest = max(frame for frame, _, _ in self.shapes)
        radius = 3 * widest * np.linspace(0, 1, 301)
        deformation = np.empty((len(self.shapes), radius.size))
        for row, (frame, mesh, shape) in zip(deformation, self.shapes, strict=True):
            spline = make_interp_spline(np.arange(1 - shape.size, shape.size), mirrored(shape), k=5)
            index = node_index(radius / frame, mesh.edge_spacing, mesh.growth)
            last = shape.size - 1
            end = frame * mesh.nodes[-1]
            row[:] = np.where(
                index <= last, spline(np.minimum(index, last)), shape[-1] * end / np.fmax(radius, end)
            )
        return Profiles(radius, deformation)


def mirrored(values):
    """Continue values at nodes 0 .. n−1 evenly to nodes 1−n .. n−1."""
    return np.concatenate([values[:0:-1], values])
