"""One run of the energy solver: from stop to stop, through falls, into a history."""

from collections.abc import Iterator
from itertools import pairwise
from math import sqrt

import numpy as np

from softafm.errors import AccuracyWarning, DivergedError
from softafm.instrument.compiled_motions import still
from softafm.instrument.motion import bound_speed, count_periods, find_setpoint
from softafm.solvers.energy.layout import (
    DEFORMATION,
    FALL,
    FINISHED,
    FULL,
    LOAD,
    RECORD_FIELDS,
    REMESH,
    STUCK,
    TABULATE,
    TRIGGERED,
    Controls,
)
from softafm.solvers.energy.step import advance
from softafm.solvers.energy.surface import Surface
from softafm.solvers.history import History
from softafm.solvers.periodic import PeriodicMemory
from softafm.solvers.shapes import Shape, on_common_radii

_CHUNK = 256
_MOST_CYCLES = 150
_PATIENCE = 8
_SHARPEST = 3.2
_MOST_TRIES_IN_A_FALL = 5000.0
_SLACKEST = 18.0
"""Fast Tabor number up to which an edge lets go between nodes as it would in a continuum."""


class Run:
    """Carries a surface through a motion and keeps what happens."""

    def __init__(self, solver, contact, motion, lever, tolerance: float, keep_shapes: bool):
        self.solver, self.contact = solver, contact
        self._follow(motion)
        self.strictness = tolerance / 1e-2
        self.surface = Surface(contact, motion, lever, self.strictness, solver.finest_spacing)
        gap = self.surface.edge_gap
        fastest = min([gap / motion.top_speed, *self.surface.parameters.retardation])
        self.controls = Controls(
            end=0.0,
            shortest_step=1e-4 * self.strictness * fastest,
            longest_step=0.0,
            top_speed=motion.top_speed,
            open_frame=self.surface.open_frame,
            edge_gap=gap,
            open_gap=self.surface.open_gap,
            prediction=0.03 * self.strictness**0.7,
            memory=min(0.01 * self.strictness, 0.05),
            force=0.01 * self.strictness,
            newton=self.surface.accuracy,
            slack=2.0,
            finest=0.0,
            coarsest=0.0,
            most_tries=float(solver.most_steps),
            trigger=np.inf,
        )
        self.target = self.surface.target
        self.records, self.count = np.empty(2 * _CHUNK, RECORD_FIELDS), 0
        self.shapes: list[Shape] | None = [] if keep_shapes else None
        self.coarsest = 0.0, 0.0
        self.slips, self.end_of_slip = 0, -np.inf
        self.cycle, self.unsteady = 1, 0.0
        # How well a memory can be found is limited by the errors of a cycle.
        self.steadiness = 1e-2 * self.strictness**0.5
        self.falls: list[float] = []

    def steps(self) -> Iterator[float]:
        """Run, yielding the fraction of the motion done at every return of the compiled loop."""
        surface = self.surface
        self._settle()
        if surface.clock["force"] >= self._trigger(-np.inf):
            raise ValueError(
                f"setpoint_force = {self.motion.setpoint_force:g} N: must be above the force at "
                f"the start, {surface.clock['force']:.3g} N"
            )
        first = surface.time
        while (stop := self._next_stop()) is not None:
            if surface.time in self.breaks:
                self._begin_piece(stop)
            surface.target = self.target
            # However little happens, smooth curves need points.
            longest = (stop - surface.time) / 12 * self.strictness**0.25
            self.controls = self.controls._replace(
                longest_step=longest, trigger=self._trigger(stop), top_speed=self._top_speed(stop)
            )
            outcome = FULL
            while outcome not in (FINISHED, TRIGGERED):
                outcome, records, shapes = self._advance(stop)
                self._keep(records, shapes)
                if outcome == STUCK:
                    raise DivergedError(
                        f"stopped at t = {surface.time:g} s after {surface.clock['tries']:.0f} "
                        f"attempted steps (most_steps = {self.solver.most_steps}){self._softer()}",
                        self.history(0.0),
                    )
                if outcome == REMESH:
                    surface.remesh(records[-1]["coarseness"])
                if outcome == FALL:
                    self._fall(stop)
                if outcome == TRIGGERED:
                    self._turn()
                yield (surface.time - first) / (self.breaks[-1] - first)

    def cycles(self) -> Iterator[float]:
        """Run the motion over and over, until the memory ends a cycle as it began it.

        Only the last cycle is kept. Yields as ``steps``.
        """
        surface, start = self.surface, self.surface.time
        modes, times = surface.parameters.compliance[1:], surface.parameters.retardation
        period = self.breaks[-1] - start
        periodic = PeriodicMemory(period, modes, times, surface.edge_gap)
        if times.max(initial=0) > period:  # small errors of a cycle add up
            surface.clock["contraction"] = np.inf
        memory, misses = None, []
        for self.cycle in range(1, _MOST_CYCLES + 1):
            self.count = 0
            self.falls.clear()
            if self.shapes is not None:
                self.shapes.clear()
            yield from self.steps()
            gained = surface.rewind(start)
            memory = np.zeros_like(gained) if memory is None else memory
            memory, off = periodic.next_start(memory, gained)
            self.unsteady = off / surface.edge_gap
            misses.append(self.unsteady)
            if self.unsteady <= self.steadiness or _stagnates(misses):
                self.unsteady = max(self.unsteady, _scatter(misses))
                return
            surface.remember(memory)

    def _follow(self, motion):
        """Take a motion for what is to be done, and the instants that a step of it has to meet."""
        self.motion, self.breaks = motion, motion.breaks
        self.stops = np.sort(np.concatenate([motion.breaks, motion.landmarks]))

    def _next_stop(self):
        """Return the next instant that a step has to meet, s, or None at the end."""
        ahead = np.searchsorted(self.stops, self.surface.time, side="right")
        return float(self.stops[ahead]) if ahead < self.stops.size else None

    def _trigger(self, stop) -> float:
        """Return the force that turns the ramp before ``stop``, N."""
        force = find_setpoint(self.motion)
        return np.inf if force is None or stop > self.breaks[1] else force

    def _top_speed(self, stop) -> float:
        """Return how fast the motion gets until ``stop``, m/s."""
        return bound_speed(self.motion, self.surface.time, stop)

    def _turn(self):
        """Let the ramp turn now, its force having been reached."""
        surface = self.surface
        self._follow(self.motion.turned_at(surface.time))
        height, parameters = self.motion.compiled_height
        surface.functions = surface.functions._replace(height=height)
        surface.parameters = surface.parameters._replace(height=parameters)
        surface.clock["time"] = self.breaks[1]
        self.records[self.count - 1]["time"] = surface.time

    def _begin_piece(self, stop):
        """Forget the past shapes: beyond a break of the motion they do not extrapolate."""
        clock = self.surface.clock
        clock["history"] = 1
        clock["step"] = 0.1 * clock["taken"] or 0.005 * (stop - self.surface.time)

    def _advance(self, stop):
        """Call the compiled loop once; return its outcome, records and shapes."""
        surface = self.surface
        finest, coarsest = surface.coarseness_allowed
        controls = self.controls._replace(end=float(stop), finest=finest, coarsest=coarsest)
        records = self._free_records()
        shapes = np.empty((0 if self.shapes is None else _CHUNK, surface.mesh.nodes.size))
        outcome, count = advance(
            *surface.functions[:-1], surface.parameters, surface.background, surface.mesh,
            surface.table, controls, surface.fields, surface.clock, surface.lever_state, records,
            shapes, surface.room(),
        )  # fmt: skip
        if outcome == TABULATE:
            surface.tabulate(float(surface.clock["wanted"]))
            outcome = FULL
        return outcome, records[:count], shapes[:count]

    def _free_records(self) -> np.ndarray:
        """Return records that are yet to be filled."""
        if self.count + _CHUNK > self.records.size:
            longer = np.empty(2 * self.records.size, RECORD_FIELDS)
            longer[: self.count] = self.records[: self.count]
            self.records = longer
        return self.records[self.count : self.count + _CHUNK]

    def _settle(self):
        """Equilibrate at frozen memory, and keep a record of it."""
        records = self._free_records()[:1]
        records[0] = self.surface.settle()
        self._keep(records, self.surface.fields[DEFORMATION][None])

    def _fall(self, stop):
        """Pass a short step where no stable shape is near, and note a jump if it is one."""
        surface, clock = self.surface, self.surface.clock
        start, gap, edge, force = surface.time, clock["axis_gap"], clock["edge"], clock["force"]
        before = surface.energy()
        # A slack contact may slip from node to node: pass such a stretch in growing steps.
        self.slips = min(self.slips + 1, 8) if start < self.end_of_slip else 0
        duration = min(2.0**self.slips * self.controls.shortest_step, stop - start)
        end = stop if duration == stop - start else start + duration
        self.end_of_slip = start + 20 * duration
        self._creep_down(end, duration)
        surface.functions.accept_force(
            end, duration, force, force, surface.parameters.lever, surface.lever_state
        )
        clock["time"], clock["step"] = end, 10 * self.controls.shortest_step
        self._settle()
        self.falls.append(surface.time)
        if abs(clock["axis_gap"] - gap) > 0.1 * gap or abs(clock["edge"] - edge) > 0.05 * edge:
            self.records[self.count - 1]["jump"] = before - surface.energy()
        else:
            # No fall but a slip: the edge is caught by nodes too far apart for a contact so slack.
            surface.target = max(surface.target / 2, 0.02)

    def _creep_down(self, time, duration):
        """Follow a fall, ``duration`` long and under the tip height of ``time``, as a fast creep.

        The instantaneous compliance is given a retardation time of its own, far below the shortest
        step, but for a share too stiff to be unstable. The fall is then smooth in that time, and
        the same steps follow it on the same riding mesh to the shape that is stable without this
        aid. A fall that starts slowly gets more of the fictitious time. One that takes too many
        steps is left to the descent in energy that follows.
        """
        surface, clock, controls = self.surface, self.surface.clock, self.controls
        functions, parameters, background, lever, state = (
            surface.functions, surface.parameters, surface.background, surface.lever,
            surface.lever_state,
        )  # fmt: skip
        instantaneous, modes = parameters.compliance[0], parameters.compliance[1:]
        tabor = self.contact.tabor_instantaneous
        stiff = instantaneous * min(0.2, (0.4 / tabor) ** 1.5 if tabor else 0.2)
        delayed = instantaneous - stiff
        surface.functions = functions._replace(height=still)
        # The clock of the fall starts at 0; the past goes on fading from where it is.
        surface.background = background._replace(since=background.since - time)
        surface.fields = np.vstack([surface.fields, surface.fields[LOAD]])
        for patience in range(8):
            creep_time = 10.0 ** (-4 - patience) * duration
            surface.parameters = parameters._replace(
                height=np.array([functions.height(time, parameters.height)]),
                compliance=np.concatenate([[stiff], modes, [delayed]]),
                retardation=np.append(parameters.retardation, creep_time),
            )
            falling = lever.falling(creep_time)
            surface.mount(falling, falling.at_start())
            self.controls = controls._replace(
                shortest_step=1e-9 * creep_time, longest_step=duration, top_speed=1e-300,
                prediction=0.2, memory=0.2, force=1.0, trigger=np.inf,
                most_tries=min(controls.most_tries, clock["tries"] + _MOST_TRIES_IN_A_FALL),
            )  # fmt: skip
            clock["time"], clock["step"], clock["history"] = 0.0, 1e-3 * creep_time, 1
            outcome = FULL
            while outcome in (FULL, REMESH):
                outcome, records, _ = self._advance(duration)
                if outcome == REMESH:
                    surface.remesh(records[-1]["coarseness"])
            behind = delayed * np.abs(surface.fields[LOAD] - surface.fields[-1]).max()
            if surface.bends:
                unbalanced = clock["force"] / falling.stiffness - clock["deflection"]
                behind = max(behind, abs(unbalanced))
            if outcome != FINISHED or behind < 1e-4 * surface.edge_gap:
                break
        surface.mount(lever, state)
        surface.functions, surface.parameters, self.controls = functions, parameters, controls
        surface.background = background
        surface.fields = surface.fields[:-1].copy()

    def _keep(self, records, shapes):
        """Keep the records just filled, shapes, and the worst coarseness of the finest mesh."""
        surface = self.surface
        self.count += records.size
        if self.shapes is not None:
            for record, shape in zip(records, shapes, strict=True):
                self.shapes.append(Shape(record["frame"], surface.mesh, shape.copy()))
        if surface.level == surface.finest_level and len(records):
            worst = records[records["coarseness"].argmax()]
            found = float(worst["coarseness"]), float(worst["edge"])
            self.coarsest = max(self.coarsest, found)

    def history(self, seconds: float) -> History:
        """Collect what was recorded; ``seconds`` is the time the run took."""
        surface = self.surface
        records = self.records[: self.count]
        time, jumped = records["time"], records["jump"] != 0
        breaks = np.flatnonzero(np.isin(time, self.breaks[1:-1]))
        fallen = np.flatnonzero(np.isin(time, self.falls))
        cuts = sorted([(i, i + 1) for i in breaks] + [(i, i) for i in fallen])
        starts = [0] + [start for start, _ in cuts]
        ends = [end for _, end in cuts] + [time.size]
        return History(
            time=time,
            tip_height=records["height"],
            force=records["force"],
            contact_radius=records["edge"],
            axis_deformation=records["axis"],
            viscous_power=records["loss"],
            pieces=tuple(slice(int(a), int(b)) for a, b in zip(starts, ends, strict=True)),
            motion=self.motion,
            jump_time=time[jumped],
            jump_energy=records["jump"][jumped],
            profiles=None if self.shapes is None else on_common_radii(self.shapes),
            diagnostics={
                "steps": time.size - 1,
                "attempted_steps": int(surface.clock["tries"]),
                "newton_iterations": int(surface.clock["newtons"]),
                "meshes": surface.meshes,
                "most_nodes": surface.most_nodes,
                "finest_spacing": surface.finest_spacing,
                "growth": surface.growth,
                "cycles": max(self.cycle, count_periods(self.motion)),
                "wall_time": seconds,
            },
            warnings=self._warnings(),
        )

    def _warnings(self) -> tuple[AccuracyWarning, ...]:
        return (
            *self._unsteady(), *self._too_coarse(), *self._too_slack(), *self._too_sharp(),
            *self._too_wide(),
        )  # fmt: skip

    def _unsteady(self) -> tuple[AccuracyWarning, ...]:
        if self.unsteady <= self.steadiness:
            return ()
        text = (
            f"no steady cycle after {self.cycle}: the surface starts the last ones off by up to "
            f"{self.unsteady:.2g} gaps of largest tension from where they would end. Choose a "
            "number of cycles instead"
        )
        return (AccuracyWarning(text, self.unsteady),)

    def _too_coarse(self) -> tuple[AccuracyWarning, ...]:
        coarseness, edge = self.coarsest
        if coarseness <= 1.3 * self.target:
            return ()
        spacing = self.surface.mesh.edge_spacing * edge
        law, remedy = self.contact.surface, ""
        if self.contact.adhesive:
            # Seen through coarse nodes the zone looks wide; the softened cohesive length bounds it.
            length = self.contact.softened_modulus * law.range**2 / law.work_of_adhesion
            wide = max(coarseness, 2 * spacing / length) / self.target
            remedy = (
                ", or enlarge the range of the attraction at fixed work of adhesion, regularise="
                f"{self.contact.tabor_softened / sqrt(wide):.2g}"
            )
        text = (
            f"the cohesive zone at the contact edge, {spacing / coarseness:.2g} m wide, is "
            f"resolved by nodes {spacing:.2g} m apart (finest_spacing = "
            f"{self.solver.finest_spacing:g} contact radii) where "
            f"{self.target * spacing / coarseness:.2g} m is needed: forces and above all the loop "
            f"energy may be wrong. Lower solvers.Energy(finest_spacing=...){remedy}"
        )
        return (AccuracyWarning(text, coarseness / self.target),)

    def _too_slack(self) -> tuple[AccuracyWarning, ...]:
        tabor = self.contact.tabor_instantaneous
        if not self.contact.adhesive or tabor <= _SLACKEST or len(self.falls) < 2:
            return ()
        text = (
            "the contact is soft for its adhesion even when loaded fast (Tabor number "
            f"{tabor:.3g}): beyond {_SLACKEST:g} its edge catches on the nodes before it lets go. "
            "Forces hold, but the loop energy may be wrong, by 2 % at 20 and entirely at 60; try "
            "regularise=8"
        )
        return (AccuracyWarning(text, tabor),)

    def _softer(self) -> str:
        """Advise a longer range where the contact is too soft for its own."""
        tabor = self.contact.tabor_softened
        return f"; its Tabor number is {tabor:.3g}: try regularise=8" if tabor > 30 else ""

    def _too_sharp(self) -> tuple[AccuracyWarning, ...]:
        law = self.contact.surface
        if not self.contact.adhesive or law.sharpness <= _SHARPEST:
            return ()
        text = (
            f"the tension of the surface law '{law.kind}' ends {law.sharpness:.2g} times as sharply"
            f" as that of a Lennard-Jones law of its range; beyond {_SHARPEST:g} times the contact "
            "edge may catch on the nodes, and forces be off by several per cent. Smooth the law"
        )
        return (AccuracyWarning(text, law.sharpness),)

    def _too_wide(self) -> tuple[AccuracyWarning, ...]:
        body = self.contact.body
        widest = float(self.records["frame"][: self.count].max(initial=0.0))
        if widest <= body.widest:
            return ()
        text = (
            f"the contact and what acts around it reach to {widest:.3g} m, and on the body "
            f"'{body.kind}' the mesh is good for contacts of up to {body.widest:.3g} m: forces and "
            "energies may be wrong. Indent less, or take a sharper tip"
        )
        return (AccuracyWarning(text, widest / body.widest),)


def _stagnates(misses: list[float]) -> bool:
    """Whether misses, in gaps, are small and fall no more: what is left are errors of a cycle."""
    if len(misses) < 2 * _PATIENCE or misses[-1] > 1:
        return False
    before, recent = misses[-2 * _PATIENCE : -_PATIENCE], misses[-_PATIENCE:]
    return min(recent) > 0.5 * min(before)


def _scatter(misses: list[float]) -> float:
    """How far off cycles are that do not settle, in gaps, even if one is near by chance; else 0.

    The misses of cycles that settle fall, once they are small, but for one or two.
    """
    small = misses[next((i for i, miss in enumerate(misses) if miss < 1), len(misses)) :]
    rises = sum(later > earlier for earlier, later in pairwise(small))
    return float(np.median(small[-_PATIENCE:])) if rises > 2 else 0.0
