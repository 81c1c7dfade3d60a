"""The compiled loop of the energy solver: propose a step, solve it, judge it, accept it."""

from typing import NamedTuple

import numpy as np
from numba import float64, int64, types

from softafm.compiled.dense import multiply, row_products, solve_factorised
from softafm.compiled.functions import (
    ACCEPTANCE,
    HEIGHT,
    PRESSURE,
    PROFILE,
    RESPONSE,
    compile_for,
    inlined,
    pointer,
)
from softafm.solvers.energy.equilibrium import equilibrate, raise_tip, spring_constant, tip_force
from softafm.solvers.energy.frame import following_frame, radius_of_gap, reframe
from softafm.solvers.energy.layout import (
    BACKGROUND,
    CLOCK,
    CONTROLS,
    DEFORMATION,
    EARLIER,
    EARLIEST,
    FALL,
    FINISHED,
    FULL,
    LOAD,
    LOAD_EARLIER,
    MATRIX,
    MEMORY,
    MESH,
    ORIGIN,
    PARAMETERS,
    RECORDS,
    REMESH,
    ROOM,
    STUCK,
    TABLE,
    TABULATE,
    TRIGGERED,
    VECTOR,
)  # fmt: skip
from softafm.solvers.energy.memory import (
    CURVATURE,
    NEW,
    displace_by_memory,
    dissipated_power,
    memory_weights,
    recall,
)  # fmt: skip
from softafm.solvers.energy.stiffness import find_stiffness
from softafm.solvers.energy.tuning import (
    APPROACH,
    AT_TRIGGER,
    CLOSEST,
    FELT,
    LEAST_GROWTH,
    LEAST_RETRY,
    MOST_GROWTH,
    REFUSED,
    RETRIED,
    SAFETY,
    SMALLEST_FRAME,
)  # fmt: skip


class Work(NamedTuple):
    """Views of a ``Room``: what a step works in, for n nodes, f radii beyond and m modes.

    ``memory`` (m, n) is that of the run, at first without the part of the new load; ``old`` that of
    the background. ``past`` (m + 1, n) holds load and memory of the instant before. Of ``u``
    (n + 1,) the last is the deflection of the lever. The rows of ``newton`` (4, n + 1) are gap,
    pressure, slope, and a change of u.
    """

    u: np.ndarray
    v: np.ndarray
    guess: np.ndarray
    standoff: np.ndarray
    tip: np.ndarray
    load_new: np.ndarray
    scratch: np.ndarray
    newton: np.ndarray
    shape: np.ndarray
    load_earlier: np.ndarray
    shifting: np.ndarray
    past: np.ndarray
    old: np.ndarray
    lags: np.ndarray
    strained: np.ndarray
    hessian: np.ndarray
    rise: np.ndarray
    far: np.ndarray
    weights: np.ndarray
    past_weights: np.ndarray


class Trial(NamedTuple):
    """A step that is tried: s, m, 1/Pa; lever and rest as ``equilibrate`` takes them."""

    step: float
    frame: float
    height: float
    compliance: float
    deflection: float
    lever: float
    rest: float
    history: int


@inlined
def furnish(room):
    """Return the views of a room that a step works in."""
    rows, fields, n, m = room.rows, room.fields, room.fields.shape[1], room.weights.shape[0] - 1
    return Work(
        rows[0], rows[1, :n], rows[2, :n], rows[3, :n], rows[4, :n], rows[5, :n], rows[6, :n],
        rows[7:11], fields[0:1], fields[1:2], fields[2:9], fields[9 : 10 + m],
        fields[10 + m : 10 + 2 * m], fields[10 + 2 * m : 10 + 3 * m], fields[10 + 3 * m :],
        room.hessian, room.far[0], room.far[1:], room.weights[:m], room.weights[m],
    )  # fmt: skip


@inlined
def choose_step(clock, controls, left):
    """Length of the next step, s, of which ``left`` are left; the last two are of equal length."""
    step = min(clock.step, controls.longest_step)
    if clock.axis_gap > FELT * controls.edge_gap:
        # Do not leap over a contact that has not been felt yet.
        step = min(step, APPROACH * clock.axis_gap / controls.top_speed)
    if step > 0.5 * left:
        step = left if step >= left else 0.5 * left
    return step


@compile_for((int64, float64, float64, float64, VECTOR))
def extrapolation_weights(history, step, last, before, weights):
    """Weights of the last shapes that extrapolate them by ``step``: order ``history`` − 1."""
    weights[0], weights[1], weights[2] = 1.0, 0.0, 0.0
    if history == 2:
        weights[0], weights[1] = 1.0 + step / last, -step / last
    elif history == 3:
        near, far = step + last, step + last + before
        weights[0] = near * far / (last * (last + before))
        weights[1] = -step * far / (last * before)
        weights[2] = step * near / (before * (last + before))


@compile_for((float64, float64, int64, MATRIX, CLOCK, MESH, VECTOR, VECTOR, MATRIX, MATRIX))
def predict(frame, step, history, fields, clock, mesh, weights, guess, work, shape):
    """Extrapolate the last ``history`` shapes to the new frame, as seen riding on the edge."""
    n = mesh.nodes.size
    speed = 0.0
    if history > 1:
        speed = (clock.edge - clock.edge_earlier) / clock.taken
    frames = (clock.frame, clock.frame_earlier, clock.frame_earliest)
    ago = (step, step + clock.taken, step + clock.taken + clock.taken_earlier)
    for i in range(n):
        guess[i] = 0.0
    for k in range(history):
        riding = max(frame - speed * ago[k], SMALLEST_FRAME * frame)
        row = DEFORMATION + k
        reframe(fields[row : row + 1], mesh, frames[k], riding / frames[k], work, shape)
        for i in range(n):
            guess[i] += weights[k] * shape[0, i]


@inlined
def propose(
    step, frame, height, profile, respond, parameters, background, mesh, fields, clock,
    lever_state, work,
):  # fmt: skip
    """Move the past to the frame of a step, and guess the shape at its end: ``work.u``."""
    n, modes = mesh.nodes.size, parameters.retardation.size
    history = int(clock.history)
    stretch = frame / clock.frame
    reframe(fields[LOAD : MEMORY + modes], mesh, clock.frame, stretch, work.shifting, work.past)
    order = min(history, 2)
    if order == 2:
        earlier = frame / clock.frame_earlier
        reframe(
            fields[LOAD_EARLIER:LOAD], mesh, clock.frame_earlier, earlier, work.shifting,
            work.load_earlier,
        )  # fmt: skip
    else:
        for i in range(n):
            work.load_earlier[0, i] = 0.0
    memory_weights(
        step, clock.taken, order, parameters.compliance, parameters.retardation, work.weights
    )
    time = clock.time + step
    recall(background, time, frame, parameters.retardation, mesh.nodes, work.shifting, work.old)
    compliance = displace_by_memory(
        parameters.compliance, work.weights, work.load_earlier[0], work.past[0], work.past[1:],
        work.old, work.v,
    )  # fmt: skip
    raise_tip(profile, parameters.tip, mesh, frame, work.scratch, work.tip, work.rise)
    h0 = height(time, parameters.height)
    for i in range(n):
        work.standoff[i] = h0 - parameters.law[ORIGIN] + work.tip[i]

    extrapolation_weights(history, step, clock.taken, clock.taken_earlier, work.past_weights)
    predict(
        frame, step, history, fields, clock, mesh, work.past_weights, work.guess, work.shifting,
        work.shape,
    )  # fmt: skip
    past = clock.deflection, clock.deflection_earlier, clock.deflection_earliest
    deflection = 0.0
    for k in range(history):
        deflection += work.past_weights[k] * past[k]
    for i in range(n):
        work.u[i] = work.guess[i]
    work.u[n] = deflection
    rest, stiffness = respond(
        time, step, clock.deflection, clock.force, parameters.lever, lever_state
    )
    lever = spring_constant(stiffness, frame)
    return Trial(step, frame, h0, compliance, deflection, lever, rest, history)


@inlined
def solve(trial, law, parameters, mesh, controls, clock, work):
    """Bring surface and lever into equilibrium, with the load; whether a stable shape was near."""
    iterations = equilibrate(
        work.u, work.v, trial.frame * trial.compliance, work.standoff, trial.lever, trial.rest,
        work.rise, mesh, law, parameters.law, CLOSEST * controls.edge_gap, controls.newton,
        clock, work.hessian, work.newton, work.far,
    )  # fmt: skip
    clock.newtons += abs(iterations)
    if iterations > 0:
        for i in range(mesh.nodes.size):
            work.load_new[i] = (work.v[i] - work.u[i]) / trial.compliance
    return iterations > 0


@inlined
def judge(trial, force, parameters, mesh, controls, clock, work):
    """Error of a solved step, in units of the one aimed at."""
    n, modes = mesh.nodes.size, parameters.retardation.size
    u, gap, history = work.u, work.newton[0], trial.history
    error = 0.0
    for i in range(n):
        found = u[i] - u[n] + trial.deflection
        error = max(error, abs(found - work.guess[i]) / (controls.prediction * gap[i]))
    if history >= 2:
        ratio = clock.taken / trial.step
        curvature = 0.0
        for m in range(modes):
            curvature += parameters.compliance[m + 1] * work.weights[m, CURVATURE]
        for i in range(n):
            bend = (work.load_new[i] + work.load_earlier[0, i] / ratio) / (1.0 + ratio)
            bend -= work.past[0, i] / ratio
            work.scratch[i] = curvature * bend / (trial.frame * trial.compliance)
            # What is lost in a stiff contact stays in the memory, and comes out later.
            error = max(error, abs(curvature * bend) / (controls.memory * gap[i]))
        # What an error of the memory does to the surface now, which is much near a fold.
        miss = work.newton[3]
        multiply(mesh.stiffness, work.scratch, miss[:n])
        miss[n] = 0.0
        solve_factorised(work.hessian, miss, n + 1 if trial.lever > 0.0 else n)
        for i in range(n):
            error = max(error, abs(miss[i] - miss[n]) / (controls.memory * gap[i]))
    past = clock.force, clock.force_earlier, clock.force_earliest
    foreseen = 0.0
    for k in range(history):
        foreseen += work.past_weights[k] * past[k]
    scale = max(clock.force_scale, abs(force))
    return max(error, abs(force - foreseen) / (controls.force * scale))


@inlined
def accept(trial, force, growth, parameters, mesh, controls, fields, clock, work, record):
    """Make a step's end the state, and write it into a record."""
    n, modes = mesh.nodes.size, parameters.retardation.size
    gap, frame, memory = work.newton[0, :n], trial.frame, work.past[1:]
    for m in range(modes):
        for i in range(n):
            memory[m, i] += work.weights[m, NEW] * work.load_new[i]
            work.lags[m, i] = work.load_new[i] - memory[m, i] - work.old[m, i]
            fields[MEMORY + m, i] = memory[m, i]
    row_products(work.lags, mesh.stiffness, work.strained)
    for i in range(n):
        fields[EARLIEST, i] = fields[EARLIER, i]
        fields[EARLIER, i] = fields[DEFORMATION, i]
        fields[DEFORMATION, i] = work.u[i]
        fields[LOAD_EARLIER, i] = fields[LOAD, i]
        fields[LOAD, i] = work.load_new[i]
    edge = frame * radius_of_gap(gap, mesh.nodes, controls.edge_gap)
    move_clock(clock, trial.step, frame, edge, force, work.u[n])
    clock.step = max(
        trial.step * min(MOST_GROWTH, max(LEAST_GROWTH, growth)), 0.999 * controls.shortest_step
    )
    clock.history = min(trial.history + 1, 3)
    clock.axis_gap = gap[0]

    record.time, record.height = clock.time, trial.height + work.u[n]
    record.force, record.edge, record.axis = force, edge, work.u[0]
    record.loss = dissipated_power(
        frame, parameters.compliance, parameters.retardation, work.lags, work.strained
    )
    # The cohesive zone as it is now: where the gap opens outside the edge.
    record.coarseness = 0.0
    if edge > 0.0:
        zone = frame * radius_of_gap(gap, mesh.nodes, controls.open_gap) - edge
        record.coarseness = frame * mesh.edge_spacing / max(zone, 1e-9 * frame)
    record.frame, record.jump = frame, 0.0


@compile_for((CLOCK, float64, float64, float64, float64, float64))
def move_clock(clock, step, frame, edge, force, deflection):
    """Let a step have been taken; its time is for the caller to set."""
    clock.deflection_earliest, clock.deflection_earlier = clock.deflection_earlier, clock.deflection
    clock.force_earliest, clock.force_earlier = clock.force_earlier, clock.force
    clock.frame_earliest, clock.frame_earlier = clock.frame_earlier, clock.frame
    clock.edge_earlier, clock.taken_earlier = clock.edge, clock.taken
    clock.deflection, clock.force, clock.frame = deflection, force, frame
    clock.edge, clock.taken = edge, step
    clock.force_scale = max(clock.force_scale, abs(force))


@compile_for(
    types.UniTuple(int64, 2)(
        pointer(HEIGHT), pointer(PROFILE), pointer(PRESSURE), pointer(RESPONSE),
        pointer(ACCEPTANCE), PARAMETERS, BACKGROUND, MESH, TABLE, CONTROLS, MATRIX, CLOCK, VECTOR,
        RECORDS, MATRIX, ROOM,
    ),
)  # fmt: skip
def advance(
    height, profile, law, respond, accept_force, parameters, background, mesh, table, controls,
    fields, clock, lever_state, records, shapes, room,
):  # fmt: skip
    """Step the surface in time until ``controls.end``, full records, a need to remesh, TABULATE: a
    frame is wanted whose stiffness the table does not reach, or FALL: no stable shape within the
    shortest step, which is not taken.

    ``fields`` (MEMORY + modes, n), ``clock`` and ``lever_state`` hold the state and are updated,
    by accepted steps only. Every accepted step
    fills one of ``records``, and a row of ``shapes`` (the deformation) if that has rows. Returns
    why it stopped, and the number of steps accepted. ``room`` is overwritten.
    """
    n = mesh.nodes.size
    work = furnish(room)
    shortest = controls.shortest_step
    count, tabulated = 0, 0.0
    while count < records.size:
        left = controls.end - clock.time
        if left <= 0.0:
            return FINISHED, count
        if clock.tries >= controls.most_tries:
            return STUCK, count
        step = choose_step(clock, controls, left)
        frame = following_frame(step, clock, mesh, controls)
        if frame != tabulated:
            if not find_stiffness(table, frame):
                clock.wanted = frame
                return TABULATE, count
            tabulated = frame
        clock.tries += 1
        trial = propose(
            step, frame, height, profile, respond, parameters, background, mesh, fields, clock,
            lever_state, work,
        )  # fmt: skip
        stable = solve(trial, law, parameters, mesh, controls, clock, work)
        if not stable:
            if step <= shortest:
                return FALL, count
            clock.step = max(RETRIED * step, 0.999 * shortest)
            continue
        force = tip_force(
            work.newton[1, :n], work.newton[0, :n], work.rise, mesh, trial.frame, law,
            parameters.law, work.far,
        )  # fmt: skip
        error = judge(trial, force, parameters, mesh, controls, clock, work)
        growth = SAFETY * max(error, 1e-6) ** (-1.0 / trial.history)
        if error > REFUSED and step > shortest:
            clock.step = max(step * max(LEAST_RETRY, growth), 0.999 * shortest)
            continue
        excess = force - controls.trigger
        allowed = AT_TRIGGER * controls.force * abs(controls.trigger)
        if excess > allowed and step > shortest:
            part = 1.0 - excess / (force - clock.force)
            clock.step = max(step * max(0.1, part), 0.999 * shortest)
            continue

        clock.time = controls.end if step == left else clock.time + step
        accept_force(clock.time, step, clock.force, force, parameters.lever, lever_state)
        record = records[count]
        accept(trial, force, growth, parameters, mesh, controls, fields, clock, work, record)
        if shapes.shape[0] > count:
            for i in range(n):
                shapes[count, i] = work.u[i]
        count += 1
        if excess > 0.0:
            return TRIGGERED, count
        if record.edge > 0.0 and not controls.finest <= record.coarseness <= controls.coarsest:
            return REMESH, count
    return FULL, count
