"""Proposal of a step: its length, its frame, the past in that frame, and a guess of the shape."""

from math import inf
from typing import NamedTuple

import numpy as np
from numba import float64, int64, types

from softafm.compiled.functions import (
    compile_for,
    inline,
)
from softafm.solvers.energy.equilibrium import raise_tip, spring_constant
from softafm.solvers.energy.frame import reframe
from softafm.solvers.energy.layout import (
    CLOCK,
    DEFORMATION,
    LOAD,
    LOAD_EARLIER,
    MATRIX,
    MEMORY,
    MESH,
    ORIGIN,
    VECTOR,
)  # fmt: skip
from softafm.solvers.energy.memory import (
    displace_by_memory,
    find_memory_weights,
    recall,
)  # fmt: skip
from softafm.solvers.energy.tuning import (
    APPROACH,
    FELT,
    SMALLEST_FRAME,
)  # fmt: skip


class Work(NamedTuple):
    """Views of a ``Room``: what a step works in, for n nodes, f radii beyond and m elements.

    ``memory`` (m, n) is that of the run, at first without the part of the new load; ``old`` that of
    the background. ``past`` (m + 1, n) holds load and memory of the instant before, ``left`` (m, n)
    what the step leaves of their lags. Of ``u``
    (n + 1,) the last is the deflection of the lever. The rows of ``newton`` (4, n + 1) are gap,
    pressure, slope, and a change of u; ``riding`` (5, n + 1) is the work of ``ride``.
    """

    u: np.ndarray
    v: np.ndarray
    guess: np.ndarray
    standoff: np.ndarray
    tip: np.ndarray
    load_new: np.ndarray
    scratch: np.ndarray
    newton: np.ndarray
    riding: np.ndarray
    shape: np.ndarray
    load_earlier: np.ndarray
    shifting: np.ndarray
    past: np.ndarray
    old: np.ndarray
    left: np.ndarray
    lags: np.ndarray
    strained: np.ndarray
    hessian: np.ndarray
    rise: np.ndarray
    far: np.ndarray
    weights: np.ndarray
    past_weights: np.ndarray


class Trial(NamedTuple):
    """A step that is tried: s, m, 1/Pa; lever and rest as ``equilibrate`` takes them.

    ``rides`` is 1 if surface and edge are solved for together, else 0.
    """

    step: float
    frame: float
    height: float
    compliance: float
    deflection: float
    lever: float
    rest: float
    history: int
    rides: int


TRIAL = types.NamedTuple((*[float64] * 7, int64, int64), Trial)


@inline
def furnish(room):
    """Return the views of a room that a step works in."""
    rows, fields, n, m = room.rows, room.fields, room.fields.shape[1], room.weights.shape[0] - 1
    return Work(
        rows[0], rows[1, :n], rows[2, :n], rows[3, :n], rows[4, :n], rows[5, :n], rows[6, :n],
        rows[7:11], rows[11:16], fields[0:1], fields[1:2], fields[2:9], fields[9 : 10 + m],
        fields[10 + m : 10 + 2 * m], fields[10 + 2 * m : 10 + 3 * m],
        fields[10 + 3 * m : 10 + 4 * m], fields[10 + 4 * m :],
        room.hessian, room.far[0], room.far[1:], room.weights[:m], room.weights[m],
    )  # fmt: skip


@inline
def choose_step(clock, controls, left, speed):
    """Length of the next step, s, of which ``left`` are left; the last two are of equal length.

    ``speed`` is that of the tip at most, m/s.
    """
    step = min(clock.step, controls.longest_step)
    if clock.axis_gap > FELT * controls.edge_gap:
        # Do not leap over a contact that has not been felt yet.
        step = min(step, APPROACH * clock.axis_gap / speed)
    if step > 0.5 * left:
        step = left if step >= left else 0.5 * left
    return step


@compile_for((int64, float64, float64, float64, VECTOR))
def find_extrapolation_weights(history, step, last, before, weights):
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
    """Extrapolate the last ``history`` shapes to the new frame, as seen riding on the edge.

    From a frame that stays behind a receding edge they are seen at rest.
    """
    n = mesh.nodes.size
    speed = 0.0
    if history > 1 and not (frame == clock.frame and clock.felt < clock.felt_earlier):
        speed = (clock.felt - clock.felt_earlier) / clock.taken
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


@inline
def carry_past(
    step, frame, height, profile, parameters, background, mesh, fields, clock, work
):  # fmt: skip
    """Move tip, load and memory to a frame, the memory to the end of a step as far as known.

    Returns the height of the unbent lever's tip and the compliance of the step.
    """
    n, elements = mesh.nodes.size, parameters.retardation.size
    stretch = frame / clock.frame
    reframe(fields[LOAD : MEMORY + elements], mesh, clock.frame, stretch, work.shifting, work.past)
    order = min(int(clock.history), 2)
    if order == 2:
        earlier = frame / clock.frame_earlier
        reframe(
            fields[LOAD_EARLIER:LOAD], mesh, clock.frame_earlier, earlier, work.shifting,
            work.load_earlier,
        )  # fmt: skip
    else:
        for i in range(n):
            work.load_earlier[0, i] = 0.0
    find_memory_weights(
        step, clock.taken, order, parameters.compliance, parameters.retardation, work.weights
    )
    time = clock.time + step
    recall(background, time, frame, parameters.retardation, mesh.nodes, work.shifting, work.old)
    compliance = displace_by_memory(
        parameters.compliance, work.weights, work.load_earlier[0], work.past[0], work.past[1:],
        work.old, work.left, work.v,
    )  # fmt: skip
    raise_tip(profile, parameters.tip, mesh, frame, work.scratch, work.tip, work.rise)
    h0 = height(time, parameters.height)
    for i in range(n):
        work.standoff[i] = h0 - parameters.law[ORIGIN] + work.tip[i]
    return h0, compliance


@inline
def propose(
    step, frame, rides, swings, height, profile, respond, parameters, background, mesh, fields,
    clock, lever_state, work,
):  # fmt: skip
    """Move the past to the frame of a step, and guess the shape at its end: ``work.u``.

    The deflection of a lever that ``swings``, or that holds the tip, is foreseen by the lever.
    """
    n, history = mesh.nodes.size, int(clock.history)
    h0, compliance = carry_past(
        step, frame, height, profile, parameters, background, mesh, fields, clock, work
    )
    find_extrapolation_weights(history, step, clock.taken, clock.taken_earlier, work.past_weights)
    if rides > 0 and clock.rides >= history:
        for i in range(n):
            work.guess[i] = 0.0
        for k in range(history):
            for i in range(n):
                work.guess[i] += work.past_weights[k] * fields[DEFORMATION + k, i]
    else:
        predict(
            frame, step, history, fields, clock, mesh, work.past_weights, work.guess,
            work.shifting, work.shape,
        )  # fmt: skip
    past = clock.deflection, clock.deflection_earlier, clock.deflection_earliest
    deflection = 0.0
    for k in range(history):
        deflection += work.past_weights[k] * past[k]
    rest, stiffness = respond(
        clock.time + step, step, clock.deflection, clock.force, parameters.lever, lever_state
    )
    if swings or stiffness == inf:
        deflection, forces = rest, (clock.force, clock.force_earlier, clock.force_earliest)
        for k in range(history):
            deflection += work.past_weights[k] * forces[k] / stiffness
    for i in range(n):
        work.u[i] = work.guess[i]
    work.u[n] = deflection
    lever = spring_constant(stiffness, frame)
    return Trial(step, frame, h0, compliance, deflection, lever, rest, history, rides)
