"""The compiled loop of the energy solver: propose a step, solve it, judge it, accept it.

An implicit predictor-corrector method. The predictor extrapolates shape and force, the corrector is
an equilibrium, and their difference, with the error of the memory, sets the length of the step.
"""

from math import exp, inf, pi

from numba import float64, int64, types

from softafm.compiled.dense import multiply
from softafm.compiled.functions import (
    ACCEPTANCE,
    HEIGHT,
    INTERNAL,
    PRESSURE,
    PROFILE,
    RESPONSE,
    compile_for,
    fix,
    inline,
    pointer_to,
)
from softafm.instrument.compiled_oscillators import bend_late, bound_speed, measure_motion
from softafm.solvers.energy.equilibrium import tip_force
from softafm.solvers.energy.flight import end_flight, fly, may_fly
from softafm.solvers.energy.frame import find_radius, follow_edge, foresee_frame
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
    LOAD_EARLIEST,
    MATRIX,
    MEMORY,
    MESH,
    PARAMETERS,
    PIVOTS,
    RECORDS,
    REMESH,
    ROOM,
    STUCK,
    SWING,
    TABLE,
    TABULATE,
    TRIGGERED,
    VECTOR,
    Swing,
)  # fmt: skip
from softafm.solvers.energy.memory import (
    CURVATURE,
    NEW,
    carry_lag_energy,
    dissipated_power,
    gather,
)  # fmt: skip
from softafm.solvers.energy.proposal import choose_step, furnish, propose
from softafm.solvers.energy.solution import (
    KEEPS,
    RIDES,
    TRACES,
    UNKNOWN,
    UNSTABLE,
    find_response,
    solve,
)
from softafm.solvers.energy.stiffness import find_stiffness
from softafm.solvers.energy.tracing import answer_shift
from softafm.solvers.energy.tuning import (
    AS_WIDE,
    AT_TRIGGER,
    LATE,
    LEAST_GROWTH,
    LEAST_RETRY,
    MOST_GROWTH,
    REFUSED,
    RETRIED,
    SAFETY,
)  # fmt: skip


@inline
def judge(trial, force, parameters, mesh, controls, clock, work, room, pivots):
    """Error of a solved step, in units of the one aimed at."""
    n, elements = mesh.nodes.size, parameters.retardation.size
    u, gap, history = work.u, work.newton[0], trial.history
    error = 0.0
    if trial.rides > 0:
        for i in range(n):
            error = max(error, abs(gap[i] - work.shape[0, i]) / (controls.prediction * gap[i]))
    else:
        for i in range(n):
            found = u[i] - u[n] + trial.deflection
            error = max(error, abs(found - work.guess[i]) / (controls.prediction * gap[i]))
    if history >= 2 and elements > 0:
        ratio = clock.taken / trial.step
        curvature = 0.0
        for m in range(elements):
            curvature += parameters.compliance[m + 1] * work.weights[m, CURVATURE]
        for i in range(n):
            bend = (work.load_new[i] + work.load_earlier[0, i] / ratio) / (1.0 + ratio)
            bend -= work.past[0, i] / ratio
            work.scratch[i] = curvature * bend
            # What is lost in a stiff contact stays in the memory, and comes out later.
            error = max(error, abs(curvature * bend) / (controls.memory * gap[i]))
        # What an error of the memory does to the surface now, which is much near a fold.
        miss = work.newton[3]
        if trial.rides == TRACES:
            bends = 1 if trial.lever > 0.0 else 0
            answer_shift(
                work.scratch, parameters.compliance[0], trial.frame, bends, mesh, miss, room, pivots
            )
            miss[n] = 0.0
        else:
            for i in range(n):
                work.scratch[i] /= trial.frame * trial.compliance
            multiply(mesh.stiffness, work.scratch, work.newton[2, :n])
            find_response(trial, work.newton[2], mesh, work, miss)
        for i in range(n):
            error = max(error, abs(miss[i] - miss[n]) / (controls.memory * gap[i]))
    past = clock.force, clock.force_earlier, clock.force_earliest
    foreseen = 0.0
    for k in range(history):
        foreseen += work.past_weights[k] * past[k]
    scale = max(clock.force_scale, abs(force))
    return max(error, abs(force - foreseen) / (controls.force * scale))


@inline
def accept(
    trial, force, growth, parameters, background, mesh, controls, fields, clock, lag_energy, work,
    record,
):  # fmt: skip
    """Make a step's end the state, and write it into a record."""
    n, elements = mesh.nodes.size, parameters.retardation.size
    gap, frame, memory = work.newton[0, :n], trial.frame, work.past[1:]
    for m in range(elements):
        for i in range(n):
            memory[m, i] += work.weights[m, NEW] * work.load_new[i]
            work.lags[m, i] = work.load_new[i] - memory[m, i] - work.old[m, i]
            fields[MEMORY + m, i] = memory[m, i]
    for i in range(n):
        fields[EARLIEST, i] = fields[EARLIER, i]
        fields[EARLIER, i] = fields[DEFORMATION, i]
        fields[DEFORMATION, i] = work.u[i]
        fields[LOAD_EARLIEST, i] = fields[LOAD_EARLIER, i]
        fields[LOAD_EARLIER, i] = fields[LOAD, i]
        fields[LOAD, i] = work.load_new[i]
    gather(background, work.weights, fields[LOAD : LOAD + 1], mesh, frame)
    if trial.rides > 0:
        edge = frame
        clock.rides += 1.0
    else:
        edge = frame * find_radius(gap, mesh.nodes, controls.edge_gap)
        clock.rides = 0.0
    # A contact about as wide as ever has no old rim outside its edge; a load that was traced has
    # left none that is sharp.
    anew = edge >= AS_WIDE * clock.widest or trial.rides == TRACES
    clock.widest = max(clock.widest, edge)
    clock.felt_earlier = clock.felt
    clock.felt = find_dent(edge, force, gap, work.u[0], frame, mesh, controls)
    record.lost = carry_lag_energy(
        parameters.compliance, parameters.retardation, trial.step, frame, anew, work.weights,
        work.left, work.lags, work.strained, mesh.stiffness, lag_energy,
    )  # fmt: skip
    move_clock(clock, trial.step, frame, edge, force, work.u[n])
    clock.step = max(
        trial.step * min(MOST_GROWTH, max(LEAST_GROWTH, growth)), 0.999 * controls.shortest_step
    )
    clock.history = min(trial.history + 1, 3)
    clock.axis_gap = gap[0]

    record.time, record.height = clock.time, trial.height + work.u[n]
    record.force, record.edge, record.axis = force, edge, work.u[0]
    record.loss = dissipated_power(parameters.compliance, parameters.retardation, lag_energy)
    # The cohesive zone as it is now: where the gap opens outside the edge.
    clock.zone, record.coarseness = 0.0, 0.0
    if edge > 0.0:
        clock.zone = frame * find_radius(gap, mesh.nodes, controls.open_gap) - edge
        record.coarseness = frame * mesh.edge_spacing / max(clock.zone, 1e-9 * frame)
    record.frame, record.jump = frame, 0.0


@inline
def find_dent(edge, force, gap, axis, frame, mesh, controls):
    """Radius of the contact edge, m, or where a tip dents a surface that it does not touch, that at
    which the gap is twice that on the axis."""
    if edge > 0.0 or force <= 0.0 or axis > -controls.edge_gap:
        return edge
    return frame * find_radius(gap, mesh.nodes, 2.0 * gap[0])


@inline
def choose_ride(step, parameters, clock, mesh, controls):
    """Frame of the next step, and whether it is solved for: KEEPS, RIDES, or TRACES, in which the
    memory rides, too, as the edge will move far."""
    known = clock.history > 1.0 or clock.rides > 0.0
    if not (known and clock.edge > controls.ride_from):
        return follow_edge(step, clock, mesh, controls), KEEPS
    frame = foresee_frame(step, clock)
    moved = abs(frame - clock.frame) / (mesh.edge_spacing * frame)
    unknown = clock.history < 2.0 and controls.trace_from < inf
    far = clock.rides > 0.0 and (unknown or moved > controls.trace_from)
    return frame, TRACES if far and parameters.retardation.size > 0 else RIDES


@inline
def find_force(trial, swings, law, parameters, mesh, work):
    """Force on the tip, N: that of a lever's own balance, if it bends, but for what that misses.

    To a short step a lever that swings is so stiff that its deflection does not tell the force.
    """
    n = mesh.nodes.size
    if trial.lever > 0.0 and not swings:
        return 2.0 * pi * trial.frame**2 * trial.lever * (work.u[n] - trial.rest)
    return tip_force(
        work.newton[1, :n], work.newton[0, :n], work.rise, mesh, trial.frame, law,
        parameters.law, work.far,
    )  # fmt: skip


@inline
def correct_lever(trial, force, parameters, clock, lever_state, work):
    """Bend the force on a swinging lever over the step before this one, as seen from both sides.

    That is of fourth order, while the straight line that the lever knows so far is of second.
    Returns the second derivative used, N/s².
    """
    n, grip = work.hessian.shape[0] - 1, inf
    if trial.rides == 0 and trial.lever > 0.0:
        grip = abs(1.0 / (work.hessian[n, n] * trial.lever) - 1.0)
    allowed = trial.history >= 2 and max(grip, clock.grip) < LATE
    clock.grip = grip
    if not allowed:
        clock.bend = 0.0
        return 0.0
    last, step = clock.taken, trial.step
    bend = (force - clock.force) / step - (clock.force - clock.force_earlier) / last
    bend *= 2.0 / (step + last)
    mean = 0.5 * (bend + clock.bend) if trial.history >= 3 and clock.bend != 0.0 else bend
    clock.bend = bend
    work.u[n] += bend_late(step, last, mean, parameters.lever, lever_state)
    return mean


@compile_for((CLOCK, float64, float64, float64, float64, float64))
def move_clock(clock, step, frame, edge, force, deflection):
    """Let a step have been taken; its time is for the caller to set."""
    clock.deflection_earliest, clock.deflection_earlier = clock.deflection_earlier, clock.deflection
    clock.force_earliest, clock.force_earlier = clock.force_earlier, clock.force
    clock.frame_earliest, clock.frame_earlier = clock.frame_earlier, clock.frame
    clock.edge_earlier, clock.taken_earlier = clock.edge, clock.taken
    clock.deflection, clock.force, clock.frame = deflection, force, frame
    clock.edge, clock.taken = edge, step
    clock.force_scale = max(clock.force_scale, -force)


SWINGS = False
"""Whether the lever has inertia: constant in each of the two loops that ``step_on`` becomes."""


def step_on(
    height, profile, law, respond, accept_force, parameters, background, mesh, table, controls,
    fields, clock, lever_state, lag_energy, records, shapes, room, pivots, swing, strokes, turns,
):  # fmt: skip
    """Step the surface in time until ``controls.end``, full records, a need to remesh, TABULATE: a
    frame is wanted whose stiffness the table does not reach, or FALL: no stable shape within the
    shortest step, which is not taken.

    ``fields`` (MEMORY + elements, n), ``clock``, ``lever_state`` and ``lag_energy`` (elements,)
    hold the state and are updated, by accepted steps only. Every accepted step fills one of
    ``records``, and a row of ``shapes`` (the deformation) if that has rows. Returns why it stopped,
    and the number of steps accepted. ``room`` is overwritten. What a tip that swings does besides
    fills ``strokes``, as ``layout.Swing`` says; ``turns`` (8 for each filter of the lever)
    is overwritten.
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
        speed = controls.top_speed
        if SWINGS:
            if may_fly(parameters, swing, fields, clock, lever_state, strokes[count, 2:]):
                before = count
                count = fly(
                    height, parameters, controls, swing, fields, clock, lever_state, lag_energy,
                    records, strokes, count, turns,
                )  # fmt: skip
                if count > before:
                    continue
            if clock.flown > 0.0:
                end_flight(parameters, mesh, fields, clock, lag_energy, room)
            speed += bound_speed(parameters.lever, lever_state)
        step = choose_step(clock, controls, left, speed)
        frame, rides = choose_ride(step, parameters, clock, mesh, controls)
        if frame != tabulated:
            if not find_stiffness(table, frame):
                clock.wanted = frame
                return TABULATE, count
            tabulated = frame
        clock.tries += 1
        trial = propose(
            step, frame, rides, SWINGS, height, profile, respond, parameters, background, mesh,
            fields, clock, lever_state, work,
        )  # fmt: skip
        trial, found = solve(
            trial, height, profile, law, parameters, background, mesh, table, controls, fields,
            clock, work, room, pivots,
        )  # fmt: skip
        tabulated = trial.frame
        if found == UNKNOWN:
            return TABULATE, count
        if found == UNSTABLE:
            if step <= shortest:
                return FALL, count
            clock.step = max(RETRIED * step, 0.999 * shortest)
            continue
        force = find_force(trial, SWINGS, law, parameters, mesh, work)
        error = judge(trial, force, parameters, mesh, controls, clock, work, room, pivots)
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
        if SWINGS:
            stroke = strokes[count]
            stroke[0] = clock.force
            stroke[1] = correct_lever(trial, force, parameters, clock, lever_state, work)
            measure_motion(clock.time, parameters.lever, lever_state, stroke[2:])
        accept(
            trial, force, growth, parameters, background, mesh, controls, fields, clock, lag_energy,
            work, record,
        )  # fmt: skip
        if SWINGS:
            fading = clock.force_scale * exp(-trial.step / swing.fading)
            clock.force_scale = max(fading, swing.least, -force)
        if shapes.shape[0] > count:
            for i in range(n):
                shapes[count, i] = work.u[i]
        count += 1
        if excess > 0.0:
            return TRIGGERED, count
        if record.edge > 0.0 and not controls.finest <= record.coarseness <= controls.coarsest:
            return REMESH, count
    return FULL, count


STEPPING = (
    pointer_to(HEIGHT), pointer_to(PROFILE), pointer_to(PRESSURE), pointer_to(RESPONSE),
    pointer_to(ACCEPTANCE), PARAMETERS, BACKGROUND, MESH, TABLE, CONTROLS, MATRIX, CLOCK,
    VECTOR, VECTOR, RECORDS, MATRIX, ROOM, PIVOTS,
)  # fmt: skip
STEPPED = types.UniTuple(int64, 2)
SWINGING = STEPPED(*STEPPING, SWING, MATRIX, VECTOR)

_advance_rigidly = compile_for(SWINGING, **INTERNAL)(fix(step_on, "advance_rigidly", SWINGS=False))


@compile_for(STEPPED(*STEPPING))
def advance(
    height, profile, law, respond, accept_force, parameters, background, mesh, table, controls,
    fields, clock, lever_state, lag_energy, records, shapes, room, pivots,
):  # fmt: skip
    """``step_on`` for a tip that is moved, and for levers without inertia."""
    none = lag_energy[:0]
    return _advance_rigidly(
        height, profile, law, respond, accept_force, parameters, background, mesh, table, controls,
        fields, clock, lever_state, lag_energy, records, shapes, room, pivots,
        Swing(none, 0.0, 1.0, 0.0, 1.0, 0.0), shapes[:0], none,
    )  # fmt: skip
