"""One run of a fixed-step solver: a discretised surface, pieces of a motion, a history."""

from collections.abc import Callable, Iterator
from itertools import pairwise
from time import perf_counter
from typing import Any, NamedTuple, NoReturn

import numpy as np

from softafm.bodies.mesh import beyond
from softafm.checks.callers import warn_caller
from softafm.checks.validate import check_tolerance
from softafm.errors import AccuracyWarning, DivergedError
from softafm.instrument.motion import Motion, count_periods, is_steady
from softafm.instrument.motions import find_lowest_height
from softafm.solvers.history import History, Profiles
from softafm.solvers.paper import kernel as k

_CHUNK = 500
_MOST_CYCLES = 100


class Discretisation(NamedTuple):
    """A surface as the compiled loop takes it, coefficients of the flat one, and its radius, m."""

    setup: k.Setup
    flat: np.ndarray
    domain: float


class Iteration(NamedTuple):
    """Limits of the fixed-point iteration of setup A; ``relaxation`` 0 is chosen every time."""

    tolerance: float = 1.0
    relaxation: float = 0.0
    most: int = 1


class _Piece(NamedTuple):
    """A smooth stretch of the motion, in equal steps, with heights and speeds at half steps."""

    time: np.ndarray
    step: float
    heights: np.ndarray
    speeds: np.ndarray


def choose_domain(contact: Any, motion: Motion) -> float:
    """Radius of the computational domain, m: the largest contact expected and what acts around it.

    The contact is that of the relaxed JKR theory at the lowest tip height. Around it the domain
    reaches to where the tip has risen by 12 reaches of the surface law or thrice its lowest height.
    """
    lowest, tip = find_lowest_height(motion), contact.tip
    rise = max(12 * contact.reach, 3 * lowest)
    return float(tip.radius_at(float(tip.profile(contact.contact_radius(lowest))) + rise))


def list_beyond_domain(tip: Any, domain: float, last: float) -> tuple[np.ndarray, np.ndarray]:
    """Heights of the tip above radius ``last``, and 2πr dr, at radii beyond the domain."""
    radius, masses = beyond(domain)
    return tip.profile(radius) - tip.profile(last), 2 * np.pi * masses


def march(
    discretisation: Discretisation,
    contact: Any,
    motion: Motion,
    solver: Any,
    *,
    stiffness: float | None = None,
    tolerance: float = 1e-2,
    iteration: Iteration | None = None,
    profiles: bool = False,
    progress: Callable[[float, str], None] | None = None,
) -> History:
    """Carry a surface, flat and relaxed at first, through the motion in ``solver.steps`` steps.

    With ``stiffness``, N/m, the motion is that of the base of a lever that carries the tip. A
    steady motion is repeated until the surface returns to within ``tolerance``.

    Raises
    ------
    ValueError
        If ``tolerance`` is not from 1e-5 to 0.1.
    DivergedError
        If the tip runs into the surface, a number overflows or an iteration does not converge.
    """
    started, tolerance = perf_counter(), check_tolerance(tolerance)
    run = _Run(
        discretisation,
        contact,
        motion,
        solver,
        stiffness or 0.0,
        iteration or Iteration(),
        profiles,
    )
    for fraction in run.cycles(tolerance) if is_steady(motion) else run.steps():
        if progress is not None:
            progress(fraction, f"{fraction:.0%} of the motion")
    history = run.history(perf_counter() - started)
    for warning in history.warnings:
        warn_caller(warning)
    return history


class _Run:
    """Carries a discretised surface through a motion and keeps what happens."""

    def __init__(
        self,
        discretisation: Discretisation,
        contact: Any,
        motion: Motion,
        solver: Any,
        stiffness: float,
        iteration: Iteration,
        keep_shapes: bool,
    ):
        self.setup, self.solver, self.motion = discretisation.setup, solver, motion
        self.stiffness = stiffness
        self.law, _, law_parameters = contact.surface.compiled_pressure
        creep = contact.body.compliance.chain(motion.breaks[-1] - motion.breaks[0])
        self.material = k.Material(
            law_parameters,
            np.concatenate([[creep.instantaneous], creep.elements]),
            np.array(creep.retardation_times, float),
        )
        self.edge_gap = contact.edge_gap
        self.domain = discretisation.domain
        unknowns = self.setup.shapes.shape[0]
        self.largest_pressure = _find_largest_pressure(contact, self.domain, unknowns)
        self.iteration = iteration
        self.pieces = list(_divide(motion, solver.steps))
        modes = creep.retardation_times.size
        equations, nodes = self.setup.influence.shape
        rows = max(1, modes)
        self.state = np.zeros((rows, equations))
        self.state[0, : discretisation.flat.size] = discretisation.flat
        self.past = np.zeros((max(2, solver.stepper.weights.size), rows, equations))
        self.work = _make_workspace(
            self.past.shape, modes, nodes, unknowns, self.setup.far_rise.size
        )
        self.work.tip[0] = motion.height(motion.breaks[0])
        total = 1 + sum(piece.time.size - 1 for piece in self.pieces)
        self.records = np.empty((total, k.RECORD_WIDTH))
        self.shapes = np.empty((total if keep_shapes else 0, nodes))
        self.counters = np.zeros(k.COUNTERS, np.int64)
        self.done = 0
        self.cycle, self.unsteady = 1, 0.0

    def cycles(self, tolerance: float) -> Iterator[float]:
        """Repeat the motion until the surface ends it as it began it; only the last is kept."""
        period = self.motion.breaks[-1] - self.motion.breaks[0]
        slowest = self.material.retardation.max(initial=0.0)
        gained = -np.expm1(-period / slowest) if slowest else 1.0
        for self.cycle in range(1, _MOST_CYCLES + 1):
            before = self.state[0].copy()
            self.done, self.work.step_before[0] = 0, 0.0
            yield from self.steps()
            change = self.state[0] - before
            if self.setup.kind > k.NODAL:
                unknowns = self.setup.shapes.shape[0]
                change = change[:unknowns] @ self.setup.shapes
            self.unsteady = float(np.abs(change).max()) / (gained * self.edge_gap)
            if self.unsteady <= tolerance:
                return

    def steps(self) -> Iterator[float]:
        """Run, yielding the fraction of the motion done after every few hundred steps."""
        last_step = self.records.shape[0] - 1
        for piece in self.pieces:
            steps, offset = piece.time.size - 1, self.done
            stop = steps + 1 if piece is self.pieces[-1] else steps
            controls = self._controls(piece.step)
            self.counters[[k.INSTANT, k.PAST]] = 0
            while self.counters[k.INSTANT] < stop:
                outcome = k.march(
                    self.setup, self.law, self.material, controls,
                    piece.heights, piece.speeds, min(stop, self.counters[k.INSTANT] + _CHUNK),
                    self.state, self.past, self.work,
                    self.records[offset:], self.shapes[offset:], self.counters,
                )  # fmt: skip
                self.done = offset + int(self.counters[k.INSTANT])
                if outcome != k.FINISHED:
                    self._give_up(outcome, piece)
                yield min(1.0, self.done / last_step)

    def _controls(self, step: float) -> k.Controls:
        weights = self.solver.stepper.weights
        return k.Controls(
            step=step,
            always_runge_kutta=weights.size == 0,
            weights=weights,
            tolerance=self.iteration.tolerance,
            relaxation=self.iteration.relaxation,
            most_iterations=self.iteration.most,
            edge_gap=self.edge_gap,
            largest_pressure=self.largest_pressure,
            stiffness=self.stiffness,
        )

    def _give_up(self, outcome: int, piece: _Piece) -> NoReturn:
        instant = int(self.counters[k.INSTANT])
        where = (
            f"t = {piece.time[instant]:.4g} s (step {self.done} of {self.records.shape[0] - 1}, "
            f"tip height {piece.heights[2 * instant]:.3g} m)"
        )
        if outcome == k.NOT_CONVERGED:
            reason = (
                f"the rates did not converge within most_iterations = {self.iteration.most} at "
                f"{where}: the surface is unstable there, or the relaxation too large"
            )
        else:
            reason = (
                f"blew up at {where}: the surface ran into the tip, or its pressure or rates are "
                "beyond bounds. More steps help if they are too long; an elastic instability "
                "needs solvers.Energy()"
            )
        raise DivergedError(reason, self.history(0.0))

    def history(self, seconds: float) -> History:
        """Collect what was recorded so far; ``seconds`` is the time the run took."""
        time = np.concatenate([*(p.time[:-1] for p in self.pieces), self.pieces[-1].time[-1:]])
        ends = np.cumsum([0] + [p.time.size - 1 for p in self.pieces])
        count = self.done
        records = self.records[:count]
        nodes = self.setup.radius
        profiles = Profiles(nodes.copy(), self.shapes[:count]) if self.shapes.size else None
        return History(
            time=time[:count],
            tip_height=records[:, k.R_HEIGHT],
            force=records[:, k.R_FORCE],
            contact_radius=records[:, k.R_EDGE],
            axis_deformation=records[:, k.R_AXIS],
            viscous_power=records[:, k.R_LOSS],
            pieces=tuple(slice(int(a), int(b) + 1) for a, b in pairwise(ends) if a < count),
            jump_time=np.empty(0),
            jump_energy=np.empty(0),
            motion=self.motion,
            profiles=profiles,
            diagnostics={
                "steps": max(0, count - 1),
                "nodes": nodes.size,
                "unknowns": self.setup.shapes.shape[0],
                "domain": self.domain,
                "rates": int(self.counters[k.RATES]),
                "iterations": int(self.counters[k.ITERATIONS]),
                "rates_beyond_fold": int(self.counters[k.BEYOND_FOLD]),
                "cycles": max(self.cycle, count_periods(self.motion)),
                "wall_time": seconds,
            },
            warnings=tuple(self._warnings(records)),
        )

    def _warnings(self, records: np.ndarray) -> Iterator[AccuracyWarning]:
        beyond = int(self.counters[k.BEYOND_FOLD])
        if beyond:
            yield AccuracyWarning(
                f"the surface was beyond an elastic instability in {beyond} of "
                f"{self.counters[k.RATES]} rates: steps of fixed length cross one by luck, and "
                "forces and energies depend on their number. solvers.Energy() follows such jumps",
                beyond / self.counters[k.RATES],
            )
        if self.cycle == _MOST_CYCLES:
            yield AccuracyWarning(
                f"no steady cycle after {self.cycle}: the surface still drifts by "
                f"{self.unsteady:.2g} gaps of largest tension. solvers.Energy() looks ahead",
                self.unsteady,
            )
        edge, domain = float(records[:, k.R_EDGE].max(initial=0.0)), self.domain
        if edge > 0.9 * domain:
            yield AccuracyWarning(
                f"the contact reaches to {edge:.3g} m, the rim of the domain of {domain:.3g} m: "
                "choose a larger domain",
                edge / domain,
            )


def _find_largest_pressure(contact: Any, domain: float, unknowns: int) -> float:
    """Return a pressure that no contact within the domain reaches, Pa.

    Twice the peak of a Hertz contact that fills the domain at the instantaneous modulus and the
    largest tension: contacts that did not blow up stay below a quarter of it. A surface that can
    only rise and sink as a whole bears more.
    """
    slope = 2 * contact.tip.profile(domain) / domain
    hertz = 2 / np.pi * slope / contact.body.compliance.instantaneous
    share = 2 if unknowns > 1 else 20
    return share * float(hertz + contact.surface.largest_tension)


def _divide(motion: Motion, steps: int) -> Iterator[_Piece]:
    """Divide ``steps`` among the smooth pieces of a motion by their duration."""
    breaks = motion.breaks
    shares = np.round(steps * (breaks - breaks[0]) / (breaks[-1] - breaks[0])).astype(int)
    for (start, end), count in zip(pairwise(breaks), np.maximum(1, np.diff(shares)), strict=True):
        time = np.linspace(start, end, 2 * count + 1)
        # At a corner the velocity that counts is the one before it.
        inside = np.minimum(time, np.nextafter(end, start))
        yield _Piece(
            time[::2].copy(),
            (end - start) / count,
            np.array(motion.height(time), float),
            np.array(motion.velocity(inside), float),
        )


def _make_workspace(
    past: tuple[int, int, int], modes: int, nodes: int, unknowns: int, far: int
) -> k.Work:
    """Return the arrays that a run with a ring of ``past`` rates keeps."""
    rates, rows, equations = past
    sizes: dict[str, Any] = {
        "displacement": nodes, "gap": nodes, "pressure": nodes, "slope": nodes,
        "load": equations, "pull": equations, "creep": (modes, equations),
        "filtered": (modes, nodes), "pressure_before": nodes, "step_before": 1,
        "right": equations, "solution": equations, "scratch": nodes,
        "stiffened": (equations, nodes), "matrix": (unknowns, equations),
        "normal": (unknowns, unknowns), "trial": (rows, equations),
        "far": (3, far), "stages": (4, rows, equations), "free": (rows, equations),
        "dragged": (rows, equations),
        "tip": 2, "past_tip": rates,
    }  # fmt: skip
    arrays = {name: np.zeros(size) for name, size in sizes.items()}
    return k.Work(**arrays, pivots=np.zeros(equations, np.int64))
