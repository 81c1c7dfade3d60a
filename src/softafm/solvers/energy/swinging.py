"""One run of the energy solver with a lever that has inertia: cycle after cycle."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from softafm.compiled.functions import enter
from softafm.errors import AccuracyWarning, DivergedError
from softafm.instrument.motion import Motion
from softafm.instrument.motions import Sine
from softafm.instrument.resonator import Resonator
from softafm.solvers.energy.cycles import HARMONICS, observe_cycles
from softafm.solvers.energy.doubts import list_doubts, suggest_longer_range
from softafm.solvers.energy.layout import (
    FALL,
    RECORD_FIELDS,
    REMESH,
    STUCK,
    TABULATE,
    Swing,
)
from softafm.solvers.energy.run import Run
from softafm.solvers.energy.tuning import (
    FAINT,
    FEWEST_STEPS,
    FIRST_STEP,
    FLIES_FROM,
    REMEMBERED,
    TAKEN_OVER,
)
from softafm.solvers.energy.watch import (
    AT,
    BASE,
    DAMPING,
    LARGEST,
    MODES,
    PUSH,
    SMALLEST,
    SPEED,
    TIME,
    TIME_EARLIER,
    TRIES,
    advance_cycles,
    watch,
)

_advance_cycles = enter(advance_cycles)
_NO_SHAPES = np.empty((0, 0))
_ROWS = 1024
"""Records that one call of the compiled loop may fill."""
_CHUNK = 16
"""Cycles that it may take, so that an interrupt is heard."""
_HEIGHTS = np.geomspace(1.0, 1e5, 500)
"""Where the pull on a rigid surface is known, in the lowest such height."""


class Swinging(Run):
    """Carries surface and lever from cycle to cycle of the first drive.

    The mesh and the steps are those of a prescribed tap like it, ``likeness``.
    """

    def __init__(
        self,
        solver: Any,
        contact: Any,
        lever: Resonator,
        base: Motion,
        likeness: Sine,
        tolerance: float,
    ):
        super().__init__(solver, contact, likeness, lever, tolerance, keep_shapes=False)
        self.resonator, self.base = lever, base
        surface = self.surface
        height, parameters = base.compiled_height
        surface.functions = surface.functions._replace(height=height)
        surface.parameters = surface.parameters._replace(height=parameters)
        surface.clock["grip"] = np.inf
        # Contacts that are not slack fall a short way, which a creep finds at once.
        self.lands = self.creeps = surface.ride_from < np.inf
        period = 1 / likeness.frequency
        fastest = max(mode.frequency for mode in lever.modes)
        self.controls = self.controls._replace(
            longest_step=self.strictness**0.25 / (FEWEST_STEPS * fastest),
            top_speed=base.top_speed,
        )
        far = FLIES_FROM * surface.edge_gap
        heights = TAKEN_OVER * far * _HEIGHTS
        self.swing = Swing(
            contact.rigid_force(heights) * heights**2, float(np.log(heights[0])),
            float(np.log(_HEIGHTS[1])), far, REMEMBERED * period, float(contact.force_scale),
        )  # fmt: skip
        modes, filters = len(lever.modes), len(lever.list_filters())
        omegas = [2 * np.pi * drive.frequency for drive in lever.drives]
        self.tuned = np.array(omegas)
        self.drag = np.array(
            [m.stiffness / (2 * np.pi * m.frequency * m.quality_factor) for m in lever.modes]
        )
        self.faint = FAINT * float(contact.force_scale)
        self.turns = np.empty(8 * filters)
        self.last = np.zeros(MODES + 2 * modes)
        spectrum = 2 * (HARMONICS + len(omegas) - 1)
        self.sums = np.zeros(DAMPING + modes + spectrum)
        self.turning = np.zeros((4, spectrum))
        self.records = np.empty(_ROWS, RECORD_FIELDS)
        self.strokes = np.empty((_ROWS, 3 + 2 * modes))
        self.kept: list[tuple[np.ndarray, np.ndarray]] | None = None
        self.done = 0

    def begin(self) -> None:
        """Settle the surface under the tip at the start, and begin the first cycle."""
        surface = self.surface
        surface.let_pass(surface.time)
        self._settle()
        if surface.clock["edge"] > 0:
            self._fall_at_start()
        surface.clock["history"] = 1
        surface.clock["step"] = FIRST_STEP / max(m.frequency for m in self.resonator.modes)
        motion = self.resonator.measure(surface.time, surface.lever_state)
        self.last[TIME] = self.last[TIME_EARLIER] = surface.time
        self.last[PUSH], self.last[AT] = surface.clock["force"], motion[0]
        self.last[BASE] = self.base.height(surface.time)
        self.last[MODES:] = motion[1:]
        self.last[SPEED] = motion[1 + len(self.drag) :].sum()
        turns = np.concatenate([self.tuned[0] * np.arange(1, HARMONICS + 1), self.tuned[1:]])
        turned = np.exp(-1j * turns * surface.time)
        self.turning[0, ::2], self.turning[1, ::2] = turned.real, turned.imag
        self.sums[:] = 0.0
        self.sums[LARGEST], self.sums[SMALLEST] = -np.inf, np.inf

    def pass_cycles(self, ends: np.ndarray, kept: int) -> Iterator[int]:
        """Run to the ``ends`` of cycles, s, and keep the curves of those from ``kept`` on.

        Yields the number of cycles done, now and then; ``done`` says it, too.
        """
        self.times = np.append(self.surface.time, ends)
        self.found = np.empty((ends.size, self.sums.size + self.surface.lever_state.size))
        self.at_start = self.surface.lever_state.copy()
        self.begin()
        for first, last in ((0, kept), (kept, ends.size)):
            if first == kept and kept < ends.size:
                self.kept = []
            for done in self.pass_through(ends[first:last], self.found[first:last]):
                self.done = first + done
                yield self.done

    def observe(self) -> dict[str, np.ndarray]:
        """Return the observables of all cycles done, by name."""
        found = self.found[: self.done]
        states = np.vstack([self.at_start, found[:, self.sums.size :]])
        times, sums = self.times[: self.done + 1], found[:, : self.sums.size]
        return observe_cycles(self.resonator, times, states, sums)

    def list_doubts(self) -> tuple[AccuracyWarning, ...]:
        """Return the warnings that a finished run deserves."""
        self.count = 0
        return list_doubts(self)

    @property
    def tries(self) -> int:
        """Steps attempted in the cycles done."""
        return int(self.found[: self.done, TRIES].sum())

    def collect_curves(self) -> dict[str, np.ndarray] | None:
        """Return what was kept over time, by name; None if nothing was."""
        if not self.kept:
            return None
        records, strokes = (np.concatenate(each) for each in zip(*self.kept, strict=True))
        names = {"tip_height": "height", "force": "force", "contact_radius": "edge"}
        names |= {"axis_deformation": "axis", "viscous_power": "loss", "time": "time"}
        curves = {name: records[key] for name, key in names.items()}
        return curves | {"deflection": strokes[:, 2]}

    def collect_jumps(self) -> tuple[np.ndarray, np.ndarray]:
        """Return when elastic jumps took place in what was kept, s, and what they released, J."""
        records = np.concatenate([each for each, _ in self.kept or ()])
        jumped = records["jump"] > 0
        return records["time"][jumped], records["jump"][jumped]

    def pass_through(self, ends: np.ndarray, found: np.ndarray) -> Iterator[int]:
        """Run to the ``ends`` of cycles, s; a row of ``found`` gets what is observed of each.

        Yields the number of cycles done, now and then.
        """
        surface, done = self.surface, 0
        while done < ends.size:
            surface.target = self.target
            # What the loop fills more than once in a call cannot be kept.
            stop = min(done + (_CHUNK if self.kept is None else 1), ends.size)
            while done < stop:
                outcome, records, more = self._advance_cycles(ends[done:stop], found[done:stop])
                done += more
                if outcome == STUCK:
                    advice = suggest_longer_range(self.contact)
                    raise DivergedError(
                        f"stopped at t = {surface.time:g} s after "
                        f"{surface.clock['tries']:.0f} attempted steps in a cycle "
                        f"(most_steps = {self.solver.most_steps}){advice}"
                    )
                if outcome == REMESH:
                    surface.remesh(records[-1]["coarseness"])
                if outcome == FALL:
                    self._fall(float(ends[done]))
                if outcome == TABULATE:
                    surface.tabulate(float(surface.clock["wanted"]))
                yield done

    def _advance_cycles(self, ends: np.ndarray, found: np.ndarray) -> tuple[int, np.ndarray, int]:
        """Call the compiled loop once; return its outcome, records and the cycles it has ended."""
        surface = self.surface
        finest, coarsest = surface.coarseness_allowed
        controls = self.controls._replace(
            end=0.0, finest=finest, coarsest=coarsest, held=surface.spacing_held
        )
        outcome, count, done = _advance_cycles(
            ends, found, self.last, self.sums, self.tuned, self.drag, HARMONICS, self.faint,
            self.turning,
            *surface.functions[:-1], surface.parameters, surface.background, surface.mesh,
            surface.table, controls, surface.fields, surface.clock, surface.lever_state,
            surface.lag_energy, self.records, _NO_SHAPES, surface.room(),
            np.empty(surface.mesh.nodes.size + 2, np.int64), self.swing, self.strokes, self.turns,
        )  # fmt: skip
        self._keep_rows(count)
        if surface.level == surface.finest_level and count:
            worst = self.records[self.records["coarseness"][:count].argmax()]
            self.coarsest = max(self.coarsest, (float(worst["coarseness"]), float(worst["edge"])))
        return outcome, self.records[:count], done

    def _keep_rows(self, count: int) -> None:
        if self.kept is not None and count:
            self.kept.append((self.records[:count].copy(), self.strokes[:count].copy()))

    def _fall(self, stop: float) -> None:
        self.count = 0
        force = float(self.surface.clock["force"])
        super()._fall(stop)
        surface = self.surface
        row = self.strokes[0]
        row[0], row[1] = force, 0.0
        row[2:] = self.resonator.measure(surface.time, surface.lever_state)
        self._keep_rows(1)
        after = self.records[0]["force"]
        self.records[0]["force"] = force  # until the fall
        watch(
            self.records, self.strokes, 1, self.last, self.sums, self.tuned, self.drag, HARMONICS,
            self.faint, self.turning,
        )  # fmt: skip
        self.records[0]["force"] = after
        surface.clock["grip"], surface.clock["bend"] = np.inf, 0.0
        self.gained = 0.0  # told by the balance of energy

    def _free_records(self) -> np.ndarray:
        return self.records[self.count :]
