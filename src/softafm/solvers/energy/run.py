"""One run of the energy solver: from stop to stop, through falls, into a history."""

from collections.abc import Iterator
from typing import Any, cast

import numpy as np

from softafm.compiled.functions import enter
from softafm.errors import DivergedError
from softafm.instrument.lever import Lever
from softafm.instrument.motion import (
    Motion,
    Turning,
    bound_speed,
    count_periods,
    find_setpoint,
    is_steady,
)
from softafm.solvers.energy.dent import Dent
from softafm.solvers.energy.doubts import list_doubts, suggest_longer_range
from softafm.solvers.energy.fall import creep_down, is_jump
from softafm.solvers.energy.landing import land
from softafm.solvers.energy.layout import (
    DEFORMATION,
    FALL,
    FINISHED,
    FULL,
    RECORD_FIELDS,
    REMESH,
    STUCK,
    TABULATE,
    TRIGGERED,
    Controls,
)
from softafm.solvers.energy.steadiness import Steadiness
from softafm.solvers.energy.step import advance
from softafm.solvers.energy.surface import Surface
from softafm.solvers.energy.tuning import (
    AFTER_A_BREAK,
    COVER,
    FEWEST_STEPS,
    FINEST_TARGET,
    FIRST_PART_OF_GAP,
    FIRST_STEP,
    FORCE_ERROR,
    LAG,
    MEMORY_ERROR,
    MOST_CYCLES,
    PREDICTION_ERROR,
    SHORTER,
    SHORTEST_STEP,
    SLIPS_AGAIN,
    STRICTER,
)
from softafm.solvers.history import History
from softafm.solvers.periodic import PeriodicMemory
from softafm.solvers.shapes import Shape, interpolate_to_common_radii

_advance = enter(advance)
_CHUNK = 256
"""Records that one call of the compiled loop may fill."""


class Run:
    """Carries a surface through a motion and keeps what happens."""

    def __init__(
        self,
        solver: Any,
        contact: Any,
        motion: Motion,
        lever: Lever,
        tolerance: float,
        keep_shapes: bool,
    ):
        self.solver, self.contact = solver, contact
        self._follow(motion)
        self.strictness = tolerance / 1e-2
        self.surface = Surface(contact, motion, lever, self.strictness, solver.finest_spacing)
        gap = self.surface.edge_gap
        fastest = min([gap / motion.top_speed, *self.surface.parameters.retardation])
        shortest, prediction = SHORTEST_STEP, PREDICTION_ERROR
        if self.surface.trace_from < np.inf:
            shortest *= SHORTER
            prediction *= STRICTER
        self.controls = Controls(
            end=0.0,
            shortest_step=shortest * self.strictness * fastest,
            longest_step=0.0,
            top_speed=motion.top_speed,
            open_frame=self.surface.open_frame,
            edge_gap=gap,
            open_gap=self.surface.open_gap,
            prediction=prediction * self.strictness**0.7,
            memory=min(MEMORY_ERROR * self._tighten(1.3), 0.05),
            force=FORCE_ERROR * self._tighten(1.2),
            newton=self.surface.accuracy,
            slack=LAG,
            held=0.0,
            cover=0.0 if contact.sticky else COVER,
            least_frame=self.surface.open_frame if self.surface.rimmed else 0.0,
            finest=0.0,
            coarsest=0.0,
            most_tries=float(solver.most_steps),
            trigger=np.inf,
            ride_from=self.surface.ride_from,
            trace_from=self.surface.trace_from,
        )
        self.target = self.surface.target
        self.records, self.count = np.empty(2 * _CHUNK, RECORD_FIELDS), 0
        self.keep_shapes = keep_shapes
        self.shapes: list[Shape] | None = [] if keep_shapes else None
        self.coarsest = 0.0, 0.0
        self.slips, self.end_of_slip = 0, -np.inf
        self.lands, self.creeps = contact.sticky, True
        self.cycle, self.unsteady = 1, 0.0
        self.steadiness = Steadiness(self.strictness)
        self.falls: list[int] = []  # the records that they led to
        self.jumps: list[int] = []
        self.gained = 0.0
        self.stored: dict[int, float] = {}  # J, by the record at which it was measured

    def steps(self) -> Iterator[float]:
        """Run, yielding the fraction of the motion done at every return of the compiled loop."""
        surface = self.surface
        tops = self._find_tops()
        if (returns := self._find_returns(tops)).size:
            lowest = float(self.motion.height(self._lowest_time()))
            surface.begin_archive(lowest, float(returns[0] - surface.time), self.strictness)
        self._settle()
        if surface.clock["edge"] > 0 and self.cycle == 1:
            self._fall_at_start()
        self._measure_stored()
        trigger = self._trigger(-np.inf)
        if surface.clock["force"] >= trigger:
            raise ValueError(
                f"setpoint_force = {trigger:g} N: must be above the force at "
                f"the start, {surface.clock['force']:.3g} N"
            )
        first = surface.time
        while (stop := self._next_stop()) is not None:
            if surface.time in self.breaks:
                self._begin_piece(stop)
            surface.target = self.target
            # However little happens, smooth curves need points.
            longest = (stop - surface.time) / FEWEST_STEPS * self.strictness**0.25
            self.controls = self.controls._replace(
                longest_step=longest, trigger=self._trigger(stop), top_speed=self._top_speed(stop)
            )
            outcome = FULL
            while outcome not in (FINISHED, TRIGGERED):
                outcome, records, shapes = self._advance(stop)
                self._keep(records, shapes)
                if outcome == STUCK:
                    advice = suggest_longer_range(self.contact)
                    raise DivergedError(
                        f"stopped at t = {surface.time:g} s after {surface.clock['tries']:.0f} "
                        f"attempted steps (most_steps = {self.solver.most_steps}){advice}",
                        self.history(0.0),
                    )
                if outcome == REMESH:
                    surface.remesh(records[-1]["coarseness"])
                if outcome == FALL:
                    self._fall(stop)
                if outcome == TRIGGERED:
                    self._turn()
                yield (surface.time - first) / (self.breaks[-1] - first)
            if stop in tops:
                self._measure_stored()
            if stop in returns and surface.clock["edge"] == 0:
                surface.put_aside()
        self._measure_stored()

    def cycles(self) -> Iterator[float]:
        """Run the motion over and over, until surface and memory end a cycle as they began it.

        Only the last cycle is kept. Yields as ``steps``.
        """
        surface, start = self.surface, self.surface.time
        elements, times = surface.parameters.compliance[1:], surface.parameters.retardation
        period = self.breaks[-1] - start
        periodic = PeriodicMemory(period, elements, times, surface.edge_gap)
        if times.max(initial=0) > period:  # small errors of a cycle add up
            surface.clock["contraction"] = np.inf
        memory: np.ndarray | None = None
        dent = Dent(surface, period)
        shapes: list[Shape] = self.shapes or []
        if dent.rules:
            self.shapes = shapes
            if (memory := dent.guess(self._lowest_time())) is not None:
                surface.remember(memory)
        for self.cycle in range(1, MOST_CYCLES + 1):
            self.count = 0
            self.falls.clear()
            self.jumps.clear()
            self.stored.clear()
            self.gained = 0.0
            if self.shapes is not None:
                self.shapes.clear()
            yield from self.steps()
            surface.clock["widest"] = self.records[: self.count]["edge"].max()
            gained = surface.rewind(start)
            memory = np.zeros_like(gained) if memory is None else memory
            if dent.rules:
                records = self.records[: self.count]
                memory, off = dent.next_start(memory, gained, records, shapes)
            else:
                memory, off = periodic.next_start(memory, gained)
            self.unsteady = off / surface.edge_gap
            self.steadiness.note(self.records[: self.count], self.unsteady)
            caught = surface.clock["edge"] > 0 and self.records[0]["edge"] == 0
            if not caught and (self.steadiness.reached or self.steadiness.stagnates):
                scatter = 0.0 if dent.rules else self.steadiness.scatter
                self.unsteady = max(self.unsteady, scatter)
                return
            surface.remember(memory)

    def _follow(self, motion: Motion) -> None:
        """Take a motion for what is to be done, and the instants that a step of it has to meet."""
        self.motion, self.breaks = motion, motion.breaks
        self.stops = np.sort(np.concatenate([motion.breaks, motion.landmarks]))

    def _lowest_time(self) -> float:
        """Return when the motion is lowest, s."""
        return float(self.stops[np.argmin(self.motion.height(self.stops))])

    def _tighten(self, power: float) -> float:
        """Return the strictness, which counts more where it is below 1."""
        return min(self.strictness, self.strictness**power)

    def _find_tops(self) -> np.ndarray:
        """Return the instants inside the motion at which the tip is highest and turns, s."""
        heights = self.motion.height(self.stops)
        tops = (heights[1:-1] > heights[:-2]) & (heights[1:-1] >= heights[2:])
        return self.stops[1:-1][tops]

    def _find_returns(self, tops: np.ndarray) -> np.ndarray:
        """Return those of the ``tops`` at which the tip, free of the sample, begins to come back.

        None if that is no matter, or where memory rides with the edge: what is gathered on a mesh
        of its own is filtered at fixed radii, too coarsely for such steps.
        """
        surface = self.surface
        if is_steady(self.motion) or surface.trace_from < np.inf or not surface.lag_energy.size:
            return np.empty(0)
        return tops[self.motion.height(tops) > self.contact.reach]

    def _next_stop(self) -> float | None:
        """Return the next instant that a step has to meet, s, or None at the end."""
        ahead = self.stops.searchsorted(self.surface.time, side="right")
        return float(self.stops[ahead]) if ahead < self.stops.size else None

    def _trigger(self, stop: float) -> float:
        """Return the force that turns the ramp before ``stop``, N."""
        force = find_setpoint(self.motion)
        return np.inf if force is None or stop > self.breaks[1] else force

    def _top_speed(self, stop: float) -> float:
        """Return how fast the motion gets until ``stop``, m/s."""
        return bound_speed(self.motion, self.surface.time, stop)

    def _turn(self) -> None:
        """Let the ramp turn now, its force having been reached."""
        surface = self.surface
        self._follow(cast(Turning, self.motion).turned_at(surface.time))
        height, parameters = self.motion.compiled_height
        surface.functions = surface.functions._replace(height=height)
        surface.parameters = surface.parameters._replace(height=parameters)
        surface.clock["time"] = self.breaks[1]
        self.records[self.count - 1]["time"] = surface.time

    def _begin_piece(self, stop: float) -> None:
        """Forget the past shapes: beyond a break of the motion they do not extrapolate."""
        clock = self.surface.clock
        clock["history"] = 1
        clock["rides"] = min(clock["rides"], 1.0)
        clock["step"] = AFTER_A_BREAK * clock["taken"] or FIRST_STEP * (stop - self.surface.time)
        speed = self._top_speed(stop)
        if clock["edge"] > 0 and speed > 0:
            # A first step has no past to tell the errors of its memory by.
            part = FIRST_PART_OF_GAP * self.strictness**0.5
            clock["step"] = min(clock["step"], part * self.surface.edge_gap / speed)

    def _advance(self, stop: float) -> tuple[int, np.ndarray, np.ndarray]:
        """Call the compiled loop once; return its outcome, records and shapes."""
        surface = self.surface
        finest, coarsest = surface.coarseness_allowed
        controls = self.controls._replace(
            end=float(stop), finest=finest, coarsest=coarsest, held=surface.spacing_held
        )
        records = self._free_records()
        shapes = np.empty((0 if self.shapes is None else _CHUNK, surface.mesh.nodes.size))
        outcome, count = _advance(
            *surface.functions[:-1], surface.parameters, surface.background, surface.mesh,
            surface.table, controls, surface.fields, surface.clock, surface.lever_state,
            surface.lag_energy, records, shapes, surface.room(),
            np.empty(surface.mesh.nodes.size + 2, np.int64),
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

    def _measure_stored(self) -> None:
        """Note the energy stored now: 0 in a steady cycle, which ends as it began."""
        now = 0.0 if is_steady(self.motion) else self.surface.stored_energy()
        self.stored[self.count - 1] = now

    def _settle(self) -> None:
        """Equilibrate at frozen memory, and keep a record of it."""
        self._note(self.surface.settle())

    def _note(self, record: tuple[float, ...]) -> None:
        """Keep a record of the surface as it is."""
        records = self._free_records()[:1]
        records[0] = record
        self._keep(records, self.surface.fields[DEFORMATION][None])

    def _fall_at_start(self) -> None:
        """Let a surface that is drawn into contact at once come to rest on a mesh that suits it."""
        surface, start = self.surface, self.surface.time
        creep_down(self, start, self.controls.shortest_step)
        surface.clock["time"] = start
        self.count = 0
        if self.shapes is not None:
            self.shapes.clear()
        self._settle()

    def _fall(self, stop: float) -> None:
        """Pass a short step where no stable shape is near, and note a jump if it is one."""
        surface, clock = self.surface, self.surface.clock
        start, gap, edge, force = surface.time, clock["axis_gap"], clock["edge"], clock["force"]
        before = surface.energy()
        # A slack contact may slip from node to node: pass such a stretch in growing steps.
        self.slips = min(self.slips + 1, 8) if start < self.end_of_slip else 0
        duration = min(2.0**self.slips * self.controls.shortest_step, stop - start)
        end = stop if duration == stop - start else start + duration
        self.end_of_slip = start + SLIPS_AGAIN * duration
        surface.functions.accept_force(
            end, duration, force, force, surface.parameters.lever, surface.lever_state
        )
        surface.let_pass(end)
        record = None
        if self.lands and self.slips == 0:
            record = land(surface, end, before, touching=edge > 0)
        if record is None and self.creeps:
            creep_down(self, end, duration)
        clock["time"], clock["step"] = end, 10 * self.controls.shortest_step
        self._settle() if record is None else self._note(record)
        self.falls.append(self.count - 1)
        if is_jump(clock, gap, edge):
            self._note_jump(before - surface.energy())
        else:
            # No fall but a slip: the edge is caught by nodes too far apart for a contact so slack.
            surface.target = max(surface.target / 2, FINEST_TARGET)

    def _note_jump(self, released: float) -> None:
        """Note a jump to the state just kept, by the energy that it ``released``, J.

        A fall cannot gain energy: what it seems to is an error of the two shapes.
        """
        if not np.isfinite(released):
            released = -np.inf
        self.jumps.append(self.count - 1)
        self.records[self.count - 1]["jump"] = max(released, 0.0)
        self.gained -= min(released, 0.0)

    def _keep(self, records: np.ndarray, shapes: np.ndarray) -> None:
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
        time = records["time"]
        breaks = np.searchsorted(time, self.breaks[1:-1])
        cuts = [(int(i), int(i) + 1) for i in breaks if i < time.size]
        cuts = sorted(cuts + [(i, i) for i in self.falls])
        starts = [0] + [start for start, _ in cuts]
        ends = [end for _, end in cuts] + [time.size]
        stored = np.full(time.size, np.nan)
        stored[list(self.stored)] = list(self.stored.values())
        return History(
            time=time,
            tip_height=records["height"],
            force=records["force"],
            contact_radius=records["edge"],
            axis_deformation=records["axis"],
            viscous_power=records["loss"],
            viscous_energy=records["lost"],
            stored_energy=stored,
            pieces=tuple(slice(a, b) for a, b in zip(starts, ends, strict=True)),
            motion=self.motion,
            jump_time=time[self.jumps],
            jump_energy=records["jump"][self.jumps],
            profiles=interpolate_to_common_radii(self.shapes or []) if self.keep_shapes else None,
            diagnostics={
                "steps": time.size - 1,
                "attempted_steps": int(surface.clock["tries"]),
                "newton_iterations": int(surface.clock["newtons"]),
                "meshes": surface.meshes,
                "most_nodes": surface.most_nodes,
                "finest_spacing": surface.finest_spacing,
                "growth": surface.growth,
                "cycles": max(self.cycle, count_periods(self.motion)),
                "stored_energy_start": self.stored.get(0, np.nan),
                "stored_energy_end": self.stored.get(time.size - 1, np.nan),
                "wall_time": seconds,
            },
            warnings=list_doubts(self),
        )
