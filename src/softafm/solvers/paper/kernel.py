"""Compiled loops of the paper's solvers: rates of the surface, and fixed steps along them.

All setups solve one equation for the rate of the surface displacement,

    (I − J_g K P') u̇ = −R − ḣ0 J_g K p',     R = Σ_m (J_m/τ_m) (q − y_m),     q = K p,

with P' = diag(p'(h)): Rajabifar et al. 2021, equation (14), for any Kelvin-Voigt chain. The memory
y_m follows τ_m ẏ_m = q − y_m; that of the last mode is what is left of u = −(J_g q + Σ J_m y_m), so
that a standard linear solid has no unknowns besides u. The setups differ in where the equation is
posed (at nodes, or projected on functions) and in what u is written with:

    u = carried·(h0 + g) + sign·Σ a_i f_i

(carried 0 for an expanded deformation, 1 for an expanded gap). Lengths in m, pressures in Pa, times
in s.

Functions called once a step are inlined: to hand over so many arrays takes as long as their work.
"""

from functools import partial
from math import exp
from typing import NamedTuple

import numpy as np
from numba import boolean, float64, int64, types

from softafm.compiled.dense import (
    factorise,
    factorise_general,
    multiply,
    multiply_rows,
    solve_factorised,
    solve_general,
)
from softafm.compiled.functions import PRESSURE, compile_for, pointer_to

_V = float64[::1]
_M = float64[:, ::1]
_CUBE = float64[:, :, ::1]
_CONST = types.Array(float64, 1, "C", readonly=True)
_compile_for = partial(compile_for, error_model="python", _nrt=True)
"""Here divisions by zero are errors, and NumPy's functions take memory."""

# How the rates are found: at nodes by fixed-point iteration or by a linear solve; for coefficients
# by least squares over the nodes or by projection on orthogonal functions.
ITERATIVE, NODAL, LEAST_SQUARES, ORTHOGONAL = range(4)

# Why `march` came back.
FINISHED, BLOWN_UP, NOT_CONVERGED = range(3)

# Columns of a record.
R_HEIGHT, R_FORCE, R_EDGE, R_AXIS, R_LOSS = range(5)
RECORD_WIDTH = 5

# Entries of `counters`: instants reached in this piece of the motion, of these those with rates to
# look back on, rates that were computed, iterations, and rates found beyond a fold.
INSTANT, PAST, RATES, ITERATIONS, BEYOND_FOLD = range(5)
COUNTERS = 5


class Setup(NamedTuple):
    """The discretised surface: n nodes, N unknowns, e equations.

    ``influence`` (e, n) takes a pressure to q, m; ``shapes`` (N, n) are the functions at the nodes
    (unused at nodes), ``unity`` and ``profile_image`` (e,) the constant 1 and the tip profile where
    the equations are posed, ``profile`` (n,) at the nodes. ``area`` (n,) holds 2πr dr. Beyond the
    domain, where the surface counts as level with the last node, ``far_area`` (far,) does, and
    ``far_rise`` is the height of the tip above that node. ``axis`` extrapolates to r = 0 from the
    first two nodes.
    """

    kind: int
    carried: float
    sign: float
    influence: np.ndarray
    shapes: np.ndarray
    unity: np.ndarray
    profile: np.ndarray
    profile_image: np.ndarray
    radius: np.ndarray
    area: np.ndarray
    far_rise: np.ndarray
    far_area: np.ndarray
    axis: np.ndarray


class Material(NamedTuple):
    """Parameters of the surface law; J_g, J_1, ... in 1/Pa; τ_1, ... in s."""

    law: np.ndarray
    compliance: np.ndarray
    retardation: np.ndarray


class Controls(NamedTuple):
    """Step, s; Runge-Kutta steps throughout or not; weights of past rates; the iteration's limits;
    the stiffness of the lever that carries the tip, N/m, 0 for a tip that is moved itself.

    ``relaxation`` 0 stands for the largest that is sure to converge in repulsion; a surface under
    more than ``largest_pressure`` has blown up.
    """

    step: float
    always_runge_kutta: bool
    weights: np.ndarray
    tolerance: float
    relaxation: float
    most_iterations: int
    edge_gap: float
    largest_pressure: float
    stiffness: float


class Work(NamedTuple):
    """Arrays that a run keeps between calls: the surface as last observed, and scratch."""

    displacement: np.ndarray  # (n,)
    gap: np.ndarray  # (n,)
    pressure: np.ndarray  # (n,)
    slope: np.ndarray  # (n,)
    load: np.ndarray  # (e,)  q
    pull: np.ndarray  # (e,)  K p'
    creep: np.ndarray  # (modes, e)  (q − y_m)/τ_m
    filtered: np.ndarray  # (modes, n)  w_m, the pressure filtered with τ_m
    pressure_before: np.ndarray  # (n,)
    step_before: np.ndarray  # (1,)
    right: np.ndarray  # (e,)
    solution: np.ndarray  # (e,)
    scratch: np.ndarray  # (n,)
    stiffened: np.ndarray  # (e, n)  −J_g K P'
    matrix: np.ndarray  # (N, e)
    normal: np.ndarray  # (N, N)
    trial: np.ndarray  # (rows, e)
    stages: np.ndarray  # (4, rows, e)
    free: np.ndarray  # (rows, e)  rates under a tip that stands still
    dragged: np.ndarray  # (rows, e)  rates under a tip that moves at unit speed
    far: np.ndarray  # (3, far)  gap, pressure, slope beyond the domain
    tip: np.ndarray  # (2,)  height of a tip on a lever, and its rate
    past_tip: np.ndarray  # (rates,)  past rates of its height
    pivots: np.ndarray  # (e,) int


SETUP = types.NamedTuple((int64, float64, float64, _M, _M, _V, _V, _V, _V, _V, _V, _V, _V), Setup)
MATERIAL = types.NamedUniTuple(_V, 3, Material)
CONTROLS = types.NamedTuple(
    (float64, boolean, _V, float64, float64, int64, float64, float64, float64), Controls
)
WORK = types.NamedTuple(
    (
        _V, _V, _V, _V, _V, _V, _M, _M, _V, _V, _V, _V, _V, _M, _M, _M, _M, _CUBE, _M, _M, _M, _V,
        _V, int64[::1],
    ),
    Work,
)  # fmt: skip


@_compile_for(
    boolean(SETUP, pointer_to(PRESSURE), MATERIAL, CONTROLS, float64, _M, WORK),
    inline="always",
)
def observe(setup, law, material, controls, height, state, work):
    """Find gap and pressure of a state; False if the tip is in the surface or p beyond bounds."""
    n = setup.profile.size
    u, gap = work.displacement, work.gap
    if setup.kind <= NODAL:
        u[:] = state[0]
    else:
        for i in range(n):
            u[i] = setup.carried * (height + setup.profile[i])
        for j in range(setup.shapes.shape[0]):
            coefficient = setup.sign * state[0, j]
            for i in range(n):
                u[i] += coefficient * setup.shapes[j, i]
    for i in range(n):
        gap[i] = height + setup.profile[i] - u[i]
        if not gap[i] > 0.0:  # NaN, too
            return False
    law(gap, material.law, work.pressure, work.slope, n)
    return work.pressure.max() <= controls.largest_pressure


@_compile_for(int64(SETUP, float64, CONTROLS, float64, _V, WORK, int64[::1]))
def _iterate(setup, instantaneous, controls, speed, guess, work, counters):
    """Adjust the guessed rates until equation (10) holds: setup A.

    v ← v + ω (right + J_g K (p' v) − v). The eigenvalues of I − J_g K P' lie between 0 and
    1 + ‖J_g K p'‖ where the surface is stable.
    """
    n = guess.size
    relaxation = controls.relaxation
    if relaxation == 0.0:
        for i in range(n):
            work.scratch[i] = instantaneous * abs(work.slope[i])
        multiply(setup.influence, work.scratch, work.solution)
        relaxation = 2.0 / (2.0 + work.solution.max())
    for iteration in range(controls.most_iterations):
        for i in range(n):
            work.scratch[i] = instantaneous * work.slope[i] * guess[i]
        multiply(setup.influence, work.scratch, work.solution)
        largest, off = abs(speed), 0.0
        for i in range(n):
            miss = work.right[i] + work.solution[i] - guess[i]
            guess[i] += relaxation * miss
            off = max(off, abs(miss))
            largest = max(largest, abs(guess[i]))
        if not off < 1e100:  # far beyond any speed, or NaN
            break
        if off <= controls.tolerance * largest:
            counters[ITERATIONS] += iteration + 1
            return FINISHED
    return NOT_CONVERGED


@_compile_for(
    int64(SETUP, MATERIAL, CONTROLS, float64, float64, _M, _M, WORK, int64[::1]),
)
def rates(setup, material, controls, height, speed, state, out, work, counters):
    """Rates of the state last observed into ``out``, which holds the guess for an iteration."""
    unknowns = setup.shapes.shape[0]
    equations, n = setup.influence.shape
    modes = material.retardation.size
    instantaneous = material.compliance[0]
    load, pull, right = work.load, work.pull, work.right
    multiply(setup.influence, work.pressure, load)
    multiply(setup.influence, work.slope, pull)

    for i in range(equations):
        right[i] = -setup.carried * speed * setup.unity[i]
        right[i] -= (1.0 - setup.carried) * speed * instantaneous * pull[i]
    if modes > 0:
        last = work.creep[modes - 1]
        share = material.compliance[modes]
        for i in range(equations):
            if setup.kind == ORTHOGONAL:
                surface = setup.sign * state[0, i]
                surface += setup.carried * (height * setup.unity[i] + setup.profile_image[i])
            else:
                surface = work.displacement[i]
            last[i] = surface + (instantaneous + share) * load[i]
        for m in range(modes - 1):
            compliance, rate = material.compliance[m + 1], 1.0 / material.retardation[m]
            creep, memory = work.creep[m], state[m + 1]
            for i in range(equations):
                creep[i] = rate * (load[i] - memory[i])
                last[i] += compliance * memory[i]
                right[i] -= compliance * creep[i]
                out[m + 1, i] = creep[i]
        rate = 1.0 / (share * material.retardation[modes - 1])
        for i in range(equations):
            last[i] *= rate
            right[i] -= share * last[i]

    counters[RATES] += 1
    if setup.kind == ITERATIVE:
        return _iterate(setup, instantaneous, controls, speed, out[0], work, counters)
    for i in range(n):
        work.scratch[i] = -instantaneous * work.slope[i]
    for i in range(equations):
        for j in range(n):
            work.stiffened[i, j] = setup.influence[i, j] * work.scratch[j]
    if setup.kind == LEAST_SQUARES:
        # Columns of I − J_g K P' in rows, applied to every function.
        multiply_rows(setup.shapes, work.stiffened, work.matrix)
        for j in range(unknowns):
            for i in range(equations):
                work.matrix[j, i] += setup.shapes[j, i]
        multiply_rows(work.matrix, work.matrix, work.normal)
        multiply(work.matrix, right, work.solution)
        if not factorise(work.normal, unknowns):
            return BLOWN_UP
        solve_factorised(work.normal, work.solution, unknowns)
    else:
        matrix = work.stiffened
        if setup.kind == ORTHOGONAL:
            multiply_rows(work.stiffened, setup.shapes, work.matrix)
            matrix = work.matrix
        for i in range(equations):
            matrix[i, i] += 1.0
        sign = factorise_general(matrix, work.pivots)
        if sign == 0:
            return BLOWN_UP
        if sign < 0:
            counters[BEYOND_FOLD] += 1
        work.solution[:] = right
        solve_general(matrix, work.pivots, work.solution)
    for j in range(unknowns):
        out[0, j] = setup.sign * work.solution[j]
    return FINISHED


@_compile_for(float64(SETUP, pointer_to(PRESSURE), MATERIAL, WORK))
def tip_force(setup, law, material, work):
    """Force on the tip, N; leaves gap, pressure and slope beyond the domain in ``work.far``."""
    far, last = setup.far_rise.size, work.gap.size - 1
    for i in range(far):
        work.far[0, i] = work.gap[last] + setup.far_rise[i]
    law(work.far[0], material.law, work.far[1], work.far[2], far)
    total = 0.0
    for i in range(far):
        total += setup.far_area[i] * work.far[1, i]
    for i in range(setup.area.size):
        total += setup.area[i] * work.pressure[i]
    return total


@_compile_for(
    int64(
        SETUP, MATERIAL, CONTROLS, float64, float64, float64, float64, _M, _M, WORK, int64[::1]
    ),
)  # fmt: skip
def rates_on_lever(
    setup, material, controls, height, force, base, base_speed, state, out, work, counters
):
    """Rates of a state and, into ``work.tip[1]``, the speed of a tip on a lever, m/s.

    The rates of the surface are linear in that speed, u̇ = α + β ḣ0, so that with a base that moves
    at Ż the derivative of k (h0 − Z) = F is one equation for ḣ0:

        k (ḣ0 − Ż) = 2π ∫ p' (ḣ0 − u̇) r dr − (k (h0 − Z) − F)/10 dt,

    where the last term takes back in ten steps what steps leave of k (h0 − Z) − F.
    """
    n = work.gap.size
    outcome = rates(setup, material, controls, height, 0.0, state, work.free, work, counters)
    if outcome != FINISHED:
        return outcome
    outcome = rates(setup, material, controls, height, 1.0, state, work.dragged, work, counters)
    if outcome != FINISHED:
        return outcome
    resisting, driving = controls.stiffness, controls.stiffness * base_speed
    for i in range(n):
        alpha, beta = work.free[0, i], work.dragged[0, i] - work.free[0, i]
        if setup.kind > NODAL:
            alpha, beta = 0.0, setup.carried
            for j in range(setup.shapes.shape[0]):
                alpha += setup.sign * setup.shapes[j, i] * work.free[0, j]
                change = work.dragged[0, j] - work.free[0, j]
                beta += setup.sign * setup.shapes[j, i] * change
        gradient = setup.area[i] * work.slope[i]
        if i == n - 1:  # and the surface beyond, which moves with it
            for j in range(setup.far_area.size):
                gradient += setup.far_area[j] * work.far[2, j]
        resisting -= gradient * (1.0 - beta)
        driving -= gradient * alpha
    if resisting < 0.0:
        counters[BEYOND_FOLD] += 1
    else:
        driving -= (controls.stiffness * (height - base) - force) / (10.0 * controls.step)
    speed = driving / resisting
    work.tip[1] = speed
    rows, width = state.shape
    for row in range(rows):
        for i in range(width):
            change = work.dragged[row, i] - work.free[row, i]
            out[row, i] = work.free[row, i] + speed * change
    return FINISHED


@_compile_for(
    (SETUP, MATERIAL, CONTROLS, float64, float64, WORK, _V),
    inline="always",
)
def note(setup, material, controls, height, force, work, record):
    """Write height, force, contact radius, axis deformation and viscous power of a surface with
    rates."""
    n = work.gap.size
    record[R_HEIGHT] = height
    record[R_FORCE] = force
    record[R_AXIS] = setup.axis[0] * work.displacement[0] + setup.axis[1] * work.displacement[1]

    edge = setup.radius[n - 1]
    for i in range(n):
        if work.gap[i] >= controls.edge_gap:
            edge = 0.0
            if i > 0:
                inner = work.gap[i - 1]
                part = (controls.edge_gap - inner) / (work.gap[i] - inner)
                edge = setup.radius[i - 1] + part * (setup.radius[i] - setup.radius[i - 1])
            break
    record[R_EDGE] = edge

    loss = 0.0
    for m in range(material.retardation.size):
        for i in range(n):
            work.scratch[i] = setup.area[i] * (work.pressure[i] - work.filtered[m, i])
        force = work.scratch
        if setup.kind == ORTHOGONAL:
            multiply(setup.shapes, work.scratch, work.solution)
            force = work.solution
        rate = 0.0
        for i in range(force.size):
            rate += force[i] * work.creep[m, i]
        loss += material.compliance[m + 1] * rate
    record[R_LOSS] = loss


@_compile_for((float64, _V, _V, _V, _M))
def filter_pressure(step, retardation, before, pressure, filtered):
    """Carry w_m, τ_m ẇ_m = p − w_m, over a step in which the pressure is linear in time."""
    for m in range(retardation.size):
        k = step / retardation[m]
        decay = exp(-k)
        mean = 1.0 - k / 2.0 + k * k / 6.0 if k < 1e-4 else (1.0 - decay) / k
        for i in range(pressure.size):
            filtered[m, i] = (
                decay * filtered[m, i] + (mean - decay) * before[i] + (1.0 - mean) * pressure[i]
            )


@_compile_for(
    int64(
        SETUP, pointer_to(PRESSURE), MATERIAL, CONTROLS,
        _CONST, _CONST, int64, _M, _M, WORK, int64[::1],
    ),
)  # fmt: skip
def take_runge_kutta(
    setup, law, material, controls, heights, speeds, instant, state, now, work, counters
):
    """Advance a state, whose rates are ``now``, by a step of the classical Runge-Kutta method."""
    rows, width = state.shape
    lever = controls.stiffness > 0.0
    tip, stages = work.tip, work.stages
    stages[0] = now
    start, climb = tip[0], tip[1]
    for stage in range(1, 4):
        part = 0.5 if stage < 3 else 1.0
        for row in range(rows):
            for i in range(width):
                work.trial[row, i] = (
                    state[row, i] + part * controls.step * stages[stage - 1, row, i]
                )
        at = 2 * instant + (1 if stage < 3 else 2)
        height = start + part * controls.step * tip[1] if lever else heights[at]
        if not observe(setup, law, material, controls, height, work.trial, work):
            return BLOWN_UP
        stages[stage] = stages[stage - 1]
        if lever:
            force = tip_force(setup, law, material, work)
            outcome = rates_on_lever(
                setup, material, controls, height, force, heights[at], speeds[at],
                work.trial, stages[stage], work, counters,
            )  # fmt: skip
        else:
            outcome = rates(
                setup, material, controls, height, speeds[at],
                work.trial, stages[stage], work, counters,
            )  # fmt: skip
        if outcome != FINISHED:
            return outcome
        climb += 2.0 * tip[1] if stage < 3 else tip[1]
    tip[0] = start + controls.step / 6.0 * climb
    for row in range(rows):
        for i in range(width):
            state[row, i] += (controls.step / 6.0) * (
                stages[0, row, i]
                + 2.0 * (stages[1, row, i] + stages[2, row, i])
                + stages[3, row, i]
            )
    return FINISHED


@_compile_for((CONTROLS, int64, _M, _CUBE, WORK))
def extrapolate(controls, instant, state, past, work):
    """Advance a state by a step of the Adams-Bashforth method, from its rates in the past."""
    ring = past.shape[0]
    rows, width = state.shape
    for back in range(controls.weights.size):
        weight = controls.step * controls.weights[back]
        rate = past[(instant - back) % ring]
        work.tip[0] += weight * work.past_tip[(instant - back) % ring]
        for row in range(rows):
            for i in range(width):
                state[row, i] += weight * rate[row, i]


@_compile_for(
    int64(
        SETUP, pointer_to(PRESSURE), MATERIAL, CONTROLS,
        _CONST, _CONST, int64, _M, _CUBE, WORK, _M, _M, int64[::1],
    ),
)  # fmt: skip
def march(
    setup, law, material, controls,
    heights, speeds, stop, state, past, work, records, shapes, counters,
):  # fmt: skip
    """Step through a piece of the motion from instant ``counters[INSTANT]`` to before ``stop``.

    ``heights`` and ``speeds`` hold those of the tip, or of the base of its lever, at instants and
    midpoints. ``state`` (rows, e) is advanced in place; ``past`` (rates, rows, e) is a ring of past
    rates. Row i of ``records`` and, if there is one, of ``shapes`` takes instant i of the piece.
    """
    ring = past.shape[0]
    instants = heights.size // 2
    lever = controls.stiffness > 0.0
    tip, past_tip = work.tip, work.past_tip
    while counters[INSTANT] < stop:
        instant = counters[INSTANT]
        height = tip[0] if lever else heights[2 * instant]
        if not observe(setup, law, material, controls, height, state, work):
            return BLOWN_UP
        filter_pressure(
            work.step_before[0], material.retardation, work.pressure_before, work.pressure,
            work.filtered,
        )  # fmt: skip
        work.pressure_before[:] = work.pressure
        force = tip_force(setup, law, material, work)
        now = past[instant % ring]
        now[:] = past[(instant - 1) % ring]
        if lever:
            outcome = rates_on_lever(
                setup, material, controls, height, force, heights[2 * instant],
                speeds[2 * instant], state, now, work, counters,
            )  # fmt: skip
        else:
            outcome = rates(
                setup, material, controls, height, speeds[2 * instant], state, now, work, counters
            )
        if outcome != FINISHED:
            return outcome
        past_tip[instant % ring] = tip[1]
        note(setup, material, controls, height, force, work, records[instant])
        if shapes.shape[0] > 0:
            shapes[instant] = work.displacement
        counters[PAST] += 1
        counters[INSTANT] += 1
        if instant == instants:
            break
        work.step_before[0] = controls.step

        if controls.always_runge_kutta or counters[PAST] < controls.weights.size:
            outcome = take_runge_kutta(
                setup, law, material, controls, heights, speeds, instant, state, now, work, counters
            )
            if outcome != FINISHED:
                return outcome
        else:
            extrapolate(controls, instant, state, past, work)
    return FINISHED
