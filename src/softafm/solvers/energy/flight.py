"""Flight of the energy solver: a tip on a lever with inertia, far above the surface.

There the surface hardly yields, its memory fades, and the lever answers exactly to the force on a
rigid surface: no equilibrium is to be found. The fields stay those of the start until the tip comes
back; ``clock.flown`` tells for how long.
"""

from math import ceil, exp, inf, log, pi

from numba import boolean, int64

from softafm.compiled.functions import HEIGHT, INTERNAL, compile_for, inline, pointer_to
from softafm.instrument.compiled_oscillators import (
    FILTER,
    FILTERS,
    add_filters,
    begin_motion,
    bound_speed,
    find_fastest,
    find_moments,
    measure_motion,
)
from softafm.solvers.energy.layout import (
    CLOCK,
    CONTROLS,
    DEFORMATION,
    LOAD,
    MATRIX,
    MEMORY,
    MESH,
    ORIGIN,
    PARAMETERS,
    RECORDS,
    ROOM,
    SWING,
    VECTOR,
)
from softafm.solvers.energy.memory import DECAY, carry_lag_energy
from softafm.solvers.energy.proposal import furnish
from softafm.solvers.energy.tuning import (
    ALMOST,
    FLIGHT_ANGLE,
    FLIGHT_PART,
    HARDLY_SAGS,
    LANDED,
    STILL_FAR,
    TAKEN_OVER,
)


@inline
def find_pull(height, swing):
    """Force on the tip at a height above a surface that does not deform, N."""
    n = swing.pull.size
    place = (log(height) - swing.start) / swing.spacing
    i = int(min(max(place, 0.0), n - 2.0))
    part = min(place - i, 1.0)
    return (swing.pull[i] + part * (swing.pull[i + 1] - swing.pull[i])) / (height * height)


@inline
def find_lift(parameters, fields, flown):
    """Height of the surface on the axis, as its memory has it after a flight of some length, m."""
    lift = 0.0
    for m in range(parameters.retardation.size):
        faded = exp(-flown / parameters.retardation[m])
        lift -= parameters.compliance[m + 1] * fields[MEMORY + m, 0] * faded
    return lift


@compile_for(
    boolean(PARAMETERS, SWING, MATRIX, CLOCK, VECTOR, VECTOR),
    **INTERNAL,
)
def may_fly(parameters, swing, fields, clock, lever_state, motion):
    """Whether the tip is far from a surface that hardly yields to it, and leaves or stays so."""
    if clock.edge > 0.0 or not clock.axis_gap > swing.far:
        return False
    if clock.flown > 0.0:
        return True
    sag = abs(fields[DEFORMATION, 0] - find_lift(parameters, fields, 0.0))
    if sag > HARDLY_SAGS * clock.axis_gap:
        return False
    measure_motion(clock.time, parameters.lever, lever_state, motion)
    speed = 0.0
    for i in range(1 + motion.size // 2, motion.size):
        speed += motion[i]
    return speed > 0.0 or clock.axis_gap > STILL_FAR * swing.far


@inline
def _weigh(lever, filters, step, weights):
    """Write what a step makes of the filters: e^(λh), and the parts of the force at both ends.

    Returns the deflection at the end per force there, m/N.
    """
    gives = 0.0
    for j in range(filters):
        at, row = FILTERS + FILTER * j, weights[8 * j : 8 * j + 8]
        rate = complex(lever[at], lever[at + 1]) * step
        m0, m1, _ = find_moments(rate.real, rate.imag)
        decay, old, new = 1.0 + rate * m0, step * (m0 - m1), step * m1
        row[0], row[1], row[2], row[3] = decay.real, decay.imag, old.real, old.imag
        row[4], row[5] = new.real, new.imag
        gives += lever[at + 2] * new.real - lever[at + 3] * new.imag
    return gives


@compile_for(
    int64(
        pointer_to(HEIGHT), PARAMETERS, CONTROLS, SWING, MATRIX, CLOCK, VECTOR, VECTOR, RECORDS,
        MATRIX, int64, VECTOR,
    ),
    **INTERNAL,
)  # fmt: skip
def fly(
    height, parameters, controls, swing, fields, clock, lever_state, lag_energy, records, strokes,
    count, weights,
):  # fmt: skip
    """Let the tip fly until ``controls.end``, full records, or where the surface is to be felt.

    Fills records and strokes from ``count`` on; returns how many there are then. ``weights`` (8
    for each filter) is worked in.
    """
    lever, filters, elements = parameters.lever, int(parameters.lever[0]), lag_energy.size
    fastest, known, gives, first = find_fastest(lever), 0.0, 0.0, count
    while count < records.size:
        left = controls.end - clock.time
        if left <= 0.0:
            break
        speed = controls.top_speed + bound_speed(lever, lever_state)
        step = min(FLIGHT_ANGLE / fastest, FLIGHT_PART * clock.axis_gap / speed)
        step = left / ceil(left / step)
        if not abs(step - known) < 1e-11 * known:
            known, gives = step, _weigh(lever, filters, step, weights)
        end = controls.end if step == left else clock.time + step
        flown, before, stroke = clock.flown + step, clock.force, strokes[count]
        begin_motion(end, lever, stroke[2:])
        rest = stroke[2]
        for j in range(filters):
            real, imag = lever_state[2 * j], lever_state[2 * j + 1]
            row, at = weights[8 * j : 8 * j + 8], FILTERS + FILTER * j
            row[6] = row[0] * real - row[1] * imag + row[2] * before
            row[7] = row[0] * imag + row[1] * real + row[3] * before
            rest += lever[at + 2] * row[6] - lever[at + 3] * row[7]
        base, force = height(end, parameters.height), before
        lift = find_lift(parameters, fields, flown)
        for _ in range(2):
            guessed, above = force, base + rest + gives * force - lift
            gap = above - parameters.law[ORIGIN]
            if not gap > TAKEN_OVER * swing.far:
                break
            force = find_pull(above, swing)
            if abs(gives * (force - guessed)) < ALMOST * gap:
                break
        comes = gap < swing.far and gap < clock.axis_gap
        if comes or not gap > TAKEN_OVER * swing.far:
            break
        for j in range(filters):
            row = weights[8 * j : 8 * j + 8]
            lever_state[2 * j] = row[6] + row[4] * force
            lever_state[2 * j + 1] = row[7] + row[5] * force
        record = records[count]
        stroke[0], stroke[1] = before, 0.0
        add_filters(lever, lever_state, stroke[2:])
        clock.deflection, clock.force, clock.axis_gap = stroke[2], force, gap
        clock.time, clock.flown = end, flown
        record.time, record.height, record.force = end, base + stroke[2], force
        record.edge, record.axis, record.coarseness = 0.0, lift, 0.0
        record.frame, record.jump = clock.frame, 0.0
        record.loss, record.lost = 0.0, 0.0
        for m in range(elements):
            if lag_energy[m] > 0.0:
                energy = 2.0 * pi * parameters.compliance[m + 1] * lag_energy[m]
                now = exp(-2.0 * flown / parameters.retardation[m])
                then = exp(-2.0 * (flown - step) / parameters.retardation[m])
                record.loss += 2.0 * energy / parameters.retardation[m] * now
                record.lost += energy * (then - now)
        fading = clock.force_scale / (1.0 + step / swing.fading)
        clock.force_scale = max(fading, swing.least, -force)
        count += 1
    if count > first:
        speed = controls.top_speed + bound_speed(lever, lever_state)
        clock.step = LANDED * clock.axis_gap / speed
        clock.history, clock.rides, clock.grip, clock.bend = 1.0, 0.0, inf, 0.0
    return count


@compile_for((PARAMETERS, MESH, MATRIX, CLOCK, VECTOR, ROOM), **INTERNAL)
def end_flight(parameters, mesh, fields, clock, lag_energy, room):
    """Bring the fields from the start of a flight to its end, at a load that has stayed."""
    work, n = furnish(room), mesh.nodes.size
    for m in range(lag_energy.size):
        faded = exp(-clock.flown / parameters.retardation[m])
        work.weights[m, DECAY] = faded
        for i in range(n):
            load, memory = fields[LOAD, i], fields[MEMORY + m, i]
            fields[DEFORMATION, i] += parameters.compliance[m + 1] * memory * (1.0 - faded)
            work.left[m, i] = faded * (load - memory)
            work.lags[m, i] = load - faded * memory
            fields[MEMORY + m, i] = faded * memory
    if lag_energy.size > 0:
        carry_lag_energy(
            parameters.compliance, parameters.retardation, clock.flown, clock.frame, False,
            work.weights, work.left, work.lags, work.strained, mesh.stiffness, lag_energy,
        )  # fmt: skip
    clock.flown = 0.0
