"""Compiled loops of the energy solver: equilibrate, settle, and advance.

Lengths in m, pressures in Pa, times in s. The surface is known on nodes r_i = a ξ_i of a unit mesh
(softafm.halfspace.mesh) in a frame of radius a that follows the contact edge. With the stiffness
S = G⁻¹ and masses m of the unit mesh, u = v − c K p reads S (u − v)/(a c) + m p(h) = 0: the
stationarity of

    Π/(2πa²) = (u − v)ᵀ S (u − v)/(2 a c) + Σ m_i Φ(h_i),     h = h0 + g − u.

A tip on a lever of stiffness k adds its deflection q to h0 and k q²/2 to the energy: one unknown
more, solved for together with the surface. Where q is listed with u it stands in u[n].

Memory is carried as displacements: q = K p and y_m = K w_m with τ_m ẏ_m = q − y_m, so that
u = −(J_g q + Σ J_m y_m), and a change of frame is an interpolation of smooth fields.
"""

from math import asinh, exp, floor, inf, log, pi, sqrt
from typing import NamedTuple

import numpy as np
from numba import float64, int64, types

from softafm.compiled import HEIGHT, POTENTIAL, PRESSURE, PROFILE, compile_for, pointer
from softafm.solvers.dense import factorise, multiply, row_products, solve_factorised

_V = float64[::1]
_M = float64[:, ::1]
_CONST = types.Array(float64, 1, "C", readonly=True)
_CONST2 = types.Array(float64, 2, "C", readonly=True)

# Why `advance` came back.
FINISHED, FULL, REMESH, FALL, STUCK, TRIGGERED = range(6)

# Rows of `fields`: the last three shapes, the load q before and now, then one per memory mode y_m.
DEFORMATION, EARLIER, EARLIEST, LOAD_EARLIER, LOAD, MEMORY = range(6)

# Entries of `clock`: the instant, the step to try, the last two steps; radii of the frames of the
# last three shapes; contact-edge radius, now and before; gap on the axis; the last three forces and
# the largest so far; the number of past shapes fit for extrapolation; attempted steps and
# Newton iterations so far; the last three deflections of the lever; how large a second correction
# of Newton's was for the square of the first, 0 if that is not known, inf if it is no guide.
TIME, STEP, LAST, BEFORE = range(4)
FRAME, FRAME_EARLIER, FRAME_EARLIEST, EDGE, EDGE_EARLIER, AXIS_GAP = range(4, 10)
FORCE, FORCE_EARLIER, FORCE_EARLIEST, FORCE_SCALE = range(10, 14)
HISTORY, TRIES, NEWTONS = range(14, 17)
DEFLECTION, DEFLECTION_EARLIER, DEFLECTION_EARLIEST = range(17, 20)
CONTRACTION = 20
CLOCK_SIZE = 21

# Columns of a record. COARSENESS is the node spacing at the edge over the width of the cohesive
# zone; JUMP the energy released if an elastic jump led there, else 0.
R_TIME, R_HEIGHT, R_FORCE, R_EDGE, R_AXIS, R_LOSS, R_COARSENESS, R_FRAME, R_JUMP = range(9)
RECORD_WIDTH = 9

# The smallest gap of a sound surface, in gaps at the contact edge.
CLOSEST = 0.1

# By how much a contraction of Newton's counts as larger with every step that trusts it.
_FORGOTTEN = 1.2

# Entry of the law's parameters: where its gaps are counted from. The solver's gaps are above it.
ORIGIN = 0

# Columns of the memory weights.
_DECAY, _EARLIER, _NOW, _NEW, _CURVATURE = range(5)


class Mesh(NamedTuple):
    """A ``softafm.halfspace.mesh.UnitMesh`` as the kernels take it."""

    nodes: np.ndarray
    masses: np.ndarray
    stiffness: np.ndarray
    edge_spacing: float
    growth: float
    far: np.ndarray
    far_masses: np.ndarray
    slopes: np.ndarray


class Parameters(NamedTuple):
    """Parameters of height, tip profile and surface law; J_g, J_1, ... in 1/Pa; τ_1, ... in s.

    ``lever`` holds its stiffness, N/m, 0 for a rigid one, and the time in which it relaxes, s.
    """

    height: np.ndarray
    tip: np.ndarray
    law: np.ndarray
    compliance: np.ndarray
    retardation: np.ndarray
    lever: np.ndarray


class Background(NamedTuple):
    """Memory from before ``since``, s, which only fades: y_m = values_m e^(−(t − since)/τ_m).

    ``values`` (modes, nodes), or none, live on a mesh of this edge spacing and growth that ends at
    ``end`` in a frame of radius ``frame``, m.
    """

    values: np.ndarray
    frame: float
    end: float
    edge_spacing: float
    growth: float
    since: float


class Controls(NamedTuple):
    """What steers ``advance``: times s, lengths m, speed m/s, the rest dimensionless.

    ``prediction``, ``memory`` and ``force`` are the errors allowed per step, ``newton`` that of an
    equilibrium; all relative to the gap, but ``force`` to the largest force so far.
    ``slack`` is how far the edge moves, in edge spacings, while the frame catches up with it.
    Remeshing is asked for when the coarseness of a record leaves ``finest`` to ``coarsest``.
    The step in which the force reaches ``trigger``, N, is the last.
    """

    end: float
    shortest_step: float
    longest_step: float
    top_speed: float
    open_frame: float
    edge_gap: float
    open_gap: float
    prediction: float
    memory: float
    force: float
    newton: float
    slack: float
    finest: float
    coarsest: float
    most_tries: float
    trigger: float


MESH = types.NamedTuple((_CONST, _CONST, _CONST2, float64, float64, _CONST, _CONST, _CONST2), Mesh)
PARAMETERS = types.NamedUniTuple(_V, len(Parameters._fields), Parameters)
BACKGROUND = types.NamedTuple((_M, float64, float64, float64, float64, float64), Background)
CONTROLS = types.NamedUniTuple(float64, len(Controls._fields), Controls)


@compile_for((_M, _V, _M, _M))
def _interpolate(fields, index, weights, out):
    """Fields (m, n), even in the node index, at fractional indices: six-point Lagrange.

    ``weights`` (6, ...) is worked in.
    """
    rows, n = fields.shape
    for i in range(index.size):
        t0 = index[i] - min(floor(index[i]) - 2.0, n - 6.0)
        t1, t2, t3, t4, t5 = t0 - 1.0, t0 - 2.0, t0 - 3.0, t0 - 4.0, t0 - 5.0
        a, b, c = t0 * t1, t2 * t3, t4 * t5
        weights[0, i], weights[1, i] = b * c * t1 / -120.0, b * c * t0 / 24.0
        weights[2, i], weights[3, i] = a * c * t3 / -12.0, a * c * t2 / 12.0
        weights[4, i], weights[5, i] = a * b * t5 / -24.0, a * b * t4 / 120.0
    # Unsigned where it cannot be negative, or each access would ask whether it is.
    for m in range(rows):
        field, found = fields[m], out[m]
        for i in range(index.size):
            base = min(int(index[i]) - 2, n - 6)
            found[i] = (
                weights[0, i] * field[abs(base)]
                + weights[1, i] * field[abs(base + 1)]
                + weights[2, i] * field[np.uint64(base + 2)]
                + weights[3, i] * field[np.uint64(base + 3)]
                + weights[4, i] * field[np.uint64(base + 4)]
                + weights[5, i] * field[np.uint64(base + 5)]
            )


@compile_for((_M, float64, float64, _CONST, _M))
def _fade(fields, end, stretch, nodes, out):
    """Continue fields beyond the ``end`` of their mesh as 1/r."""
    last = fields.shape[1] - 1
    for i in range(nodes.size - 1, -1, -1):
        r = nodes[i] * stretch
        if r <= end:
            break
        for m in range(fields.shape[0]):
            out[m, i] = fields[m, last] * end / r


@compile_for((_M, float64, float64, float64, float64, _CONST, _M, _M))
def transfer(fields, end, edge_spacing, growth, stretch, nodes, work, out):
    """Evaluate displacement fields of one mesh at radii ``stretch``·``nodes`` of another.

    ``fields`` (m, n) live on a mesh of this ``edge_spacing`` and ``growth`` whose last node is
    ``end``. They are smooth and even in the node index; beyond the last node they are those of a
    concentrated load, 1/r. ``work`` (7, ...) is worked in.
    """
    scale = growth / edge_spacing
    for i in range(nodes.size):
        r = nodes[i] * stretch
        work[0, i] = (asinh(scale * (r - 1.0)) + asinh(scale * (r + 1.0))) / growth
    _interpolate(fields, work[0, : nodes.size], work[1:], out)
    _fade(fields, end, stretch, nodes, out)


@compile_for((_M, MESH, float64, _M, _M))
def reframe(fields, mesh, stretch, work, out):
    """As ``transfer``, to a frame ``stretch`` times larger on the same mesh.

    Half the change of an asinh is artanh((y − x)/(√(1 + x²) + √(1 + y²))); so is the sum of those
    of both in the index of a node, by a series if it is small, to 1e-10.
    """
    n = mesh.nodes.size
    moved = stretch - 1.0
    if abs(moved) < 1e-12:
        for m in range(fields.shape[0]):
            for i in range(n):
                out[m, i] = fields[m, i]
        return
    index, scale, halves = work[0, :n], mesh.growth / mesh.edge_spacing, 2.0 / mesh.growth
    for i in range(n):
        before, by = scale * mesh.nodes[i], scale * mesh.nodes[i] * moved
        inner, outer = before + by - scale, before + by + scale
        inner, outer = sqrt(1.0 + inner * inner), sqrt(1.0 + outer * outer)
        inner, outer = inner + mesh.slopes[0, i], outer + mesh.slopes[1, i]
        index[i] = by * (inner + outer) / (inner * outer + by * by)
    if abs(scale * moved) < 0.6:
        for i in range(n):
            z = index[i] * index[i]
            series = 1.0 / 9 + z * (1.0 / 11 + z * (1.0 / 13 + z / 15))
            series = 1.0 + z * (1.0 / 3 + z * (1.0 / 5 + z * (1.0 / 7 + z * series)))
            index[i] = i + halves * index[i] * series
    else:
        for i in range(n):
            index[i] = i + 0.5 * halves * log((1.0 + index[i]) / (1.0 - index[i]))
    _interpolate(fields, index, work[1:], out)
    _fade(fields, mesh.nodes[n - 1], stretch, mesh.nodes, out)


@compile_for(float64(_V, _CONST, float64))
def radius_of_gap(gap, nodes, value):
    """Smallest radius (in units of the frame) where the gap reaches ``value``."""
    if gap[0] >= value:
        return 0.0
    for i in range(1, nodes.size):
        if gap[i] >= value:
            part = (value - gap[i - 1]) / (gap[i] - gap[i - 1])
            return nodes[i - 1] + part * (nodes[i] - nodes[i - 1])
    return nodes[nodes.size - 1]


@compile_for((MESH, float64, _V, float64, float64, _M))
def _assemble(mesh, scale, slope, shift, lever, hessian):
    """Upper triangle of S·scale − diag(m (p' − shift)), bordered by a lever's row if it has one.

    ``lever`` is its stiffness in units of Π/q², 0 for a rigid one.
    """
    n = mesh.nodes.size
    total = lever
    stiffness = mesh.stiffness
    for i in range(n):
        for j in range(n):
            hessian[i, j] = stiffness[i, j] * scale
        curvature = mesh.masses[i] * slope[i]
        hessian[i, i] += mesh.masses[i] * shift - curvature
        hessian[i, n] = curvature
        total -= curvature
    hessian[n, n] = total + shift


@compile_for((float64, _V, MESH, pointer(PRESSURE), _V, _M))
def beyond_mesh(gap, rise, mesh, law, parameters, work):
    """Force that acts beyond the last node and minus its derivative with the gap, both over 2πa².

    ``gap`` is that at the last node. There the surface counts as flat, and the gap grows by
    ``rise`` (far,), as the tip does. ``work`` has three rows.
    """
    n = rise.size
    for i in range(n):
        work[0, i] = gap + rise[i]
    law(work[0], parameters, work[1], work[2], n)
    force, stiffness = 0.0, 0.0
    for i in range(n):
        force += mesh.far_masses[i] * work[1, i]
        stiffness -= mesh.far_masses[i] * work[2, i]
    return force, stiffness


@compile_for(
    int64(
        _V, _V, float64, _V, float64, float64, _V,
        MESH, pointer(PRESSURE), _V, float64, float64, _V, _M, _M, _M,
    ),
)  # fmt: skip
def equilibrate(
    u, v, ac, standoff, lever, rest, rise,
    mesh, law, parameters, smallest_gap, accuracy, clock, hessian, work, far_work,
):  # fmt: skip
    """Newton's method for u = v − c K p(standoff + q − u) from a good guess, in place.

    ``ac`` is frame radius times compliance, ``standoff`` the gap to the flat surface of an unbent
    lever. Its deflection q balances ``lever``·(q − ``rest``) against the force, of which some acts
    beyond the mesh (see ``beyond_mesh``); ``lever`` 0 holds q still. Leaves the gap and the
    pressure in rows 0 and 1 of ``work``. Returns the iterations, negative if no stable shape was
    near the guess (an indefinite Hessian, or no convergence).
    """
    n = standoff.size
    size = n + 1 if lever > 0.0 else n
    gap, pressure, slope, change = work[0, :n], work[1, :n], work[2, :n], work[3]
    scale = 1.0 / ac
    for i in range(n):
        gap[i] = standoff[i] + u[n] - u[i]
        if not gap[i] > smallest_gap:
            return -1
    previous = 0.5
    for iteration in range(1, 9):
        law(gap, parameters, pressure, slope, n)
        for i in range(n):
            u[i] -= v[i]
        multiply(mesh.stiffness, u[:n], change[:n])
        change[n] = 0.0
        for i in range(n):
            u[i] += v[i]
            push = mesh.masses[i] * pressure[i]
            change[i] = -(change[i] * scale + push)
            change[n] += push
        border = lever
        if size > n:
            tail, draw = beyond_mesh(gap[n - 1], rise, mesh, law, parameters, far_work)
            change[n] += tail - lever * (u[n] - rest)
            border += draw
        _assemble(mesh, scale, slope, 0.0, border, hessian)
        if not factorise(hessian, size):
            return -iteration
        solve_factorised(hessian, change, size)
        if size == n:
            change[n] = 0.0
        largest = 0.0
        for i in range(n):
            largest = max(largest, abs(change[i] - change[n]) / gap[i])
        if not largest < previous:
            return -iteration
        u[n] += change[n]
        for i in range(n):
            u[i] += change[i]
            gap[i] = standoff[i] + u[n] - u[i]
        for i in range(n):
            pressure[i] += slope[i] * (change[n] - change[i])
        if iteration == 2 and clock[CONTRACTION] < inf:
            clock[CONTRACTION] = largest / (previous * previous)
        if largest < accuracy:
            return iteration
        if iteration == 1 and 0.0 < clock[CONTRACTION] * largest * largest < 0.1 * accuracy:
            law(gap, parameters, change, slope, n)
            missed, whole = 0.0, 0.0
            for i in range(n):
                missed += mesh.masses[i] * abs(change[i] - pressure[i])
                whole += mesh.masses[i] * abs(change[i])
            if missed < 0.1 * accuracy * whole:
                clock[CONTRACTION] *= _FORGOTTEN
                return 1
        previous = largest
    return -8


@compile_for(
    int64(
        _V, _V, float64, _V, float64, _V,
        MESH, pointer(PRESSURE), pointer(POTENTIAL), _V, float64,
    ),
)  # fmt: skip
def settle(u, v, ac, standoff, lever, rise, mesh, law, potential, parameters, accuracy):
    """Descend from ``u``, in place, to a stable shape of u = v − c K p(standoff + q − u).

    Newton's method on Π, its Hessian shifted until it is positive and no gap changes by more than
    40 %, each step shortened until Π falls. Arguments as of ``equilibrate``. Returns the number of
    iterations, or -1 if 10 000 do not suffice.
    """
    n = standoff.size
    size = n + 1 if lever > 0.0 else n
    hessian = np.empty((n + 1, n + 1))
    gap, pressure, slope, density = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    gradient, change, trial, strain = np.empty(n + 1), np.empty(n + 1), np.empty(n), np.empty(n)
    far_work = np.empty((3, rise.size))
    scale = 1.0 / ac
    shift = 0.0
    for iteration in range(1, 10001):
        for i in range(n):
            gap[i] = standoff[i] + u[n] - u[i]
            trial[i] = u[i] - v[i]
        law(gap, parameters, pressure, slope, n)
        potential(gap, parameters, density, n)
        multiply(mesh.stiffness, trial, strain)
        tail, border = 0.0, lever
        if size > n:
            tail, draw = beyond_mesh(gap[n - 1], rise, mesh, law, parameters, far_work)
            border += draw
        value, steepest = 0.5 * lever * u[n] * u[n] - tail * u[n], 0.0
        gradient[n] = lever * u[n] - tail
        for i in range(n):
            push = mesh.masses[i] * pressure[i]
            value += 0.5 * trial[i] * strain[i] * scale + mesh.masses[i] * density[i]
            gradient[i] = strain[i] * scale + push
            gradient[n] -= push
            steepest = max(steepest, abs(slope[i]))
        while True:
            for i in range(size):
                change[i] = -gradient[i]
            _assemble(mesh, scale, slope, shift, border, hessian)
            if factorise(hessian, size):
                solve_factorised(hessian, change, size)
                if size == n:
                    change[n] = 0.0
                largest, downhill = 0.0, change[n] * gradient[n]
                for i in range(n):
                    largest = max(largest, abs(change[i] - change[n]) / gap[i])
                    downhill += change[i] * gradient[i]
                if largest < 0.4:
                    break
            shift = max(8.0 * shift, 1e-10 * steepest)
        if shift == 0.0 and largest < accuracy:
            for i in range(n + 1):
                u[i] += change[i]
            return iteration
        length = 1.0
        while length > 1e-8:
            q = u[n] + length * change[n]
            for i in range(n):
                trial[i] = u[i] + length * change[i]
                gap[i] = standoff[i] + q - trial[i]
                trial[i] -= v[i]
            potential(gap, parameters, density, n)
            multiply(mesh.stiffness, trial, strain)
            lower = 0.5 * lever * q * q - tail * q
            for i in range(n):
                lower += 0.5 * trial[i] * strain[i] * scale + mesh.masses[i] * density[i]
            if lower <= value + 1e-4 * length * downhill + 1e-14 * abs(value):
                break
            length *= 0.5
        for i in range(n + 1):
            u[i] += length * change[i]
        shift = 0.25 * shift if shift > 4e-10 * steepest else 0.0
    return -1


@compile_for(float64(_V, _V, _V, MESH, float64, pointer(PRESSURE), _V, _M))
def tip_force(pressure, gap, rise, mesh, frame, law, parameters, far_work):
    """Force on the tip, N: the mesh's share and that of the flat surface beyond it."""
    n = gap.size
    total, _ = beyond_mesh(gap[n - 1], rise, mesh, law, parameters, far_work)
    for i in range(n):
        total += mesh.masses[i] * pressure[i]
    return 2.0 * pi * frame * frame * total


@compile_for((pointer(PROFILE), _V, MESH, float64, _V, _V, _V))
def raise_tip(profile, parameters, mesh, frame, scratch, tip, rise):
    """Heights of the tip above its apex at the nodes, and above the last node beyond the mesh."""
    n, far = mesh.nodes.size, mesh.far.size
    for i in range(far):
        scratch[i] = frame * mesh.far[i]
    profile(scratch, parameters, rise, far)
    for i in range(n):
        scratch[i] = frame * mesh.nodes[i]
    profile(scratch, parameters, tip, n)
    for i in range(far):
        rise[i] -= tip[n - 1]


@compile_for((float64, float64, int64, _V, _V, _M))
def memory_weights(step, last, order, compliance, retardation, weights):
    """Weights of y⁺ = decay·y + earlier·q₋ + now·q + new·q⁺ over a step, one row per mode.

    Exact for q linear in time, or with ``order`` 2, quadratic through the instant ``last`` before.
    With k = step/τ: moments M_j = ∫₀¹ k e^(−k(1−s)) s^j ds; the quadratic adds M_2 − M_1 times the
    second difference of q. In a contact held rigidly q itself relaxes, in τ J_g/(J_g + J_m). Over
    steps longer than a few such times the quadratic formula, like Adams and Moulton's, would grow
    without bound: there the linear one serves, or where that would ring, one with −3/2 of the
    quadratic's correction, which is of second order too. ``curvature`` is the error allowed for per
    second difference of q: for the quadratic formula that of the linear one, else thrice theirs.
    """
    for m in range(retardation.size):
        k = step / retardation[m]
        if k < 1e-2:
            m0 = k * (1.0 - k * (1.0 / 2 - k * (1.0 / 6 - k / 24)))
            m1 = k * (1.0 / 2 - k * (1.0 / 6 - k * (1.0 / 24 - k / 120)))
            m2 = k * (1.0 / 3 - k * (1.0 / 12 - k * (1.0 / 60 - k / 360)))
        else:
            m0 = 1.0 - exp(-k)
            m1 = 1.0 - m0 / k
            m2 = 1.0 - 2.0 * m1 / k
        row = weights[m]
        bend = m2 - m1
        row[_DECAY], row[_EARLIER], row[_NOW], row[_NEW] = 1.0 - m0, 0.0, m0 - m1, m1
        row[_CURVATURE] = bend
        if order == 2:
            ratio = last / step
            lag = compliance[m + 1] / compliance[0]
            if k * (1.0 + lag) > 4.5:
                ringing = abs(row[_DECAY] - row[_NOW] * lag) / (1.0 + row[_NEW] * lag)
                damping = 1.5 if ringing > 0.7 else 0.0
                row[_CURVATURE] = 3.0 * (1.0 + damping) * bend
                bend *= -damping
            row[_EARLIER] += bend / (ratio * (1.0 + ratio))
            row[_NOW] -= bend / ratio
            row[_NEW] += bend / (1.0 + ratio)


@compile_for((int64, float64, float64, float64, _V))
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


@compile_for(float64(float64, float64))
def frame_for(edge, open_frame):
    """Frame radius that suits a contact edge; a contact too small to fill the field of attraction
    is seen from a wider frame, ``open_frame`` when there is none."""
    return max(edge, open_frame - 1.5 * edge)


@compile_for(float64(float64, _V, MESH, CONTROLS))
def following_frame(step, clock, mesh, controls):
    """Frame radius for the next step, which rides along with the edge.

    It moves as far as the edge will, and makes up for what it lags while the edge passes the
    nodes; it stands still while the edge hardly moves, so that short steps see the same mesh.
    """
    frame, edge = clock[FRAME], clock[EDGE]
    if clock[HISTORY] < 2:
        return frame
    ahead = (edge - clock[EDGE_EARLIER]) * step / clock[LAST]
    ahead = min(max(ahead, -0.2 * edge), 0.2 * edge)
    suited = frame_for(edge, controls.open_frame)
    node = mesh.edge_spacing * frame
    if abs(ahead) < 0.2 * node and abs(suited - frame) < controls.slack * node:
        return frame
    pace = min(1.0, abs(ahead) / (controls.slack * node))
    ridden = frame + frame_for(edge + ahead, controls.open_frame) - suited
    return max(ridden + pace * (suited - frame), 0.5 * frame)


@compile_for((float64, float64, int64, _M, _V, MESH, _V, _V, _M, _M))
def predict(frame, step, history, fields, clock, mesh, weights, guess, work, shape):
    """Extrapolate the last ``history`` shapes to the new frame, as seen riding on the edge."""
    n = mesh.nodes.size
    speed = 0.0
    if history > 1:
        speed = (clock[EDGE] - clock[EDGE_EARLIER]) / clock[LAST]
    ago = step
    guess[:] = 0.0
    for k in range(history):
        riding = max(frame - speed * ago, 0.5 * frame)
        row = DEFORMATION + k
        reframe(fields[row : row + 1], mesh, riding / clock[FRAME + k], work, shape)
        for i in range(n):
            guess[i] += weights[k] * shape[0, i]
        ago += clock[LAST + k]


@compile_for((_V, float64, float64, float64, float64, float64))
def _move_clock(clock, step, frame, edge, force, deflection):
    clock[DEFLECTION_EARLIEST], clock[DEFLECTION_EARLIER], clock[DEFLECTION] = (
        clock[DEFLECTION_EARLIER],
        clock[DEFLECTION],
        deflection,
    )
    clock[FORCE_EARLIEST], clock[FORCE_EARLIER], clock[FORCE] = (
        clock[FORCE_EARLIER],
        clock[FORCE],
        force,
    )
    clock[FORCE_SCALE] = max(clock[FORCE_SCALE], abs(force))
    clock[FRAME_EARLIEST], clock[FRAME_EARLIER], clock[FRAME] = (
        clock[FRAME_EARLIER],
        clock[FRAME],
        frame,
    )
    clock[EDGE_EARLIER], clock[EDGE] = clock[EDGE], edge
    clock[BEFORE], clock[LAST] = clock[LAST], step


@compile_for((BACKGROUND, float64, float64, _V, _CONST, _M, _M))
def recall(background, time, frame, retardation, nodes, work, memory):
    """Memory of the background at ``time`` on the nodes of a frame, into rows of ``memory``."""
    modes = background.values.shape[0]
    if modes == 0:
        return
    transfer(
        background.values, background.end, background.edge_spacing, background.growth,
        frame / background.frame, nodes, work, memory,
    )  # fmt: skip
    for m in range(modes):
        fading = exp(-(time - background.since) / retardation[m])
        for i in range(nodes.size):
            memory[m, i] *= fading


@compile_for(
    int64(
        pointer(HEIGHT), pointer(PROFILE), pointer(PRESSURE), PARAMETERS,
        BACKGROUND, MESH, CONTROLS, _M, _V, _M, _M,
    ),
)  # fmt: skip
def advance(
    height, profile, law, parameters, background, mesh, controls, fields, clock, records, shapes,
):  # fmt: skip
    """Step the surface in time until ``controls.end``, full records, a need to remesh, or FALL: no
    stable shape within the shortest step, which is not taken.

    ``fields`` (MEMORY + modes, n) and ``clock`` hold the state and are updated. Every accepted step
    fills a row of ``records``, from row 1 on, and of ``shapes`` (the deformation) if that has rows;
    ``records[0, 0]`` receives the number of rows used. Returns why it stopped.
    """
    n = mesh.nodes.size
    compliance, retardation = parameters.compliance, parameters.retardation
    modes = retardation.size
    hessian = np.empty((n + 1, n + 1))
    newton_work = np.empty((4, n + 1))
    far_work = np.empty((3, mesh.far.size))
    rise = np.empty(mesh.far.size)
    gap, pressure = newton_work[0, :n], newton_work[1, :n]
    work = np.empty((8, n))
    v, guess, standoff, scratch = work[0], work[1], work[2], work[3]
    shape, load_earlier, load_new, tip = work[4:5], work[5], work[6], work[7]
    u = np.empty(n + 1)
    shifting = np.empty((7, n))
    past, old = np.empty((modes + 1, n)), np.zeros((modes, n))
    load, memory = past[0], past[1:]
    lags, strained = np.empty((modes, n)), np.empty((modes, n))
    remember = np.empty((modes, 5))
    weights = np.empty(3)
    count = 1
    outcome = FULL

    while count < records.shape[0]:
        left = controls.end - clock[TIME]
        if left <= 0.0:
            outcome = FINISHED
            break
        if clock[TRIES] >= controls.most_tries:
            outcome = STUCK
            break
        clock[TRIES] += 1
        step = min(clock[STEP], controls.longest_step)
        if clock[AXIS_GAP] > 3.0 * controls.edge_gap:
            # Do not leap over a contact that has not been felt yet.
            step = min(step, 0.3 * clock[AXIS_GAP] / controls.top_speed)
        if step > 0.5 * left:
            step = left if step >= left else 0.5 * left
        history = int(clock[HISTORY])

        frame = following_frame(step, clock, mesh, controls)
        stretch = frame / clock[FRAME]
        reframe(fields[LOAD : MEMORY + modes], mesh, stretch, shifting, past)
        order = min(history, 2)
        if order == 2:
            earlier = frame / clock[FRAME_EARLIER]
            reframe(fields[LOAD_EARLIER:LOAD], mesh, earlier, shifting, work[5:6])
        else:
            load_earlier[:] = 0.0
        memory_weights(step, clock[LAST], order, compliance, retardation, remember)

        recall(background, clock[TIME] + step, frame, retardation, mesh.nodes, shifting, old)

        # The step is an elastic contact of compliance c on a surface displaced by v.
        c = compliance[0]
        v[:] = 0.0
        for m in range(modes):
            c += compliance[m + 1] * remember[m, _NEW]
            for i in range(n):
                memory[m, i] = (
                    remember[m, _DECAY] * memory[m, i]
                    + remember[m, _EARLIER] * load_earlier[i]
                    + remember[m, _NOW] * load[i]
                )
                v[i] -= compliance[m + 1] * (memory[m, i] + old[m, i])
        raise_tip(profile, parameters.tip, mesh, frame, scratch, tip, rise)
        h0 = height(clock[TIME] + step, parameters.height)
        for i in range(n):
            standoff[i] = h0 - parameters.law[ORIGIN] + tip[i]

        extrapolation_weights(history, step, clock[LAST], clock[BEFORE], weights)
        predict(frame, step, history, fields, clock, mesh, weights, guess, shifting, shape)
        deflection = 0.0
        for k in range(history):
            deflection += weights[k] * clock[DEFLECTION + k]
        u[:n] = guess
        u[n] = deflection
        # A lever that relaxes in a time of its own resists as one so much stiffer, bent before.
        drag = parameters.lever[1] / step
        lever = parameters.lever[0] * (1.0 + drag) / (2.0 * pi * frame * frame)
        rest = clock[DEFLECTION] * drag / (1.0 + drag)
        iterations = equilibrate(
            u, v, frame * c, standoff, lever, rest, rise,
            mesh, law, parameters.law,
            CLOSEST * controls.edge_gap, controls.newton, clock, hessian, newton_work, far_work,
        )  # fmt: skip
        clock[NEWTONS] += abs(iterations)

        if iterations < 0:
            if step <= controls.shortest_step:
                outcome = FALL
                break
            clock[STEP] = max(0.2 * step, 0.999 * controls.shortest_step)
            continue

        for i in range(n):
            load_new[i] = (v[i] - u[i]) / c
        force = tip_force(pressure, gap, rise, mesh, frame, law, parameters.law, far_work)

        error = 0.0
        for i in range(n):
            found = u[i] - u[n] + deflection
            error = max(error, abs(found - guess[i]) / (controls.prediction * gap[i]))
        if order == 2:
            ratio = clock[LAST] / step
            curvature = 0.0
            for m in range(modes):
                curvature += compliance[m + 1] * remember[m, _CURVATURE]
            for i in range(n):
                bend = (load_new[i] + load_earlier[i] / ratio) / (1.0 + ratio) - load[i] / ratio
                scratch[i] = curvature * bend / (frame * c)
                # What is lost in a stiff contact stays in the memory, and comes out later.
                error = max(error, abs(curvature * bend) / (controls.memory * gap[i]))
            # What an error of the memory does to the surface now, which is much near a fold.
            miss = newton_work[3]
            multiply(mesh.stiffness, scratch, miss[:n])
            miss[n] = 0.0
            solve_factorised(hessian, miss, n + 1 if lever > 0.0 else n)
            for i in range(n):
                error = max(error, abs(miss[i] - miss[n]) / (controls.memory * gap[i]))
        foreseen = 0.0
        for k in range(history):
            foreseen += weights[k] * clock[FORCE + k]
        scale = max(clock[FORCE_SCALE], abs(force))
        error = max(error, abs(force - foreseen) / (controls.force * scale))
        growth = 0.85 * max(error, 1e-6) ** (-1.0 / history)
        if error > 1.5 and step > controls.shortest_step:
            clock[STEP] = max(step * max(0.25, growth), 0.999 * controls.shortest_step)
            continue
        excess = force - controls.trigger
        if excess > 0.1 * controls.force * abs(controls.trigger) and step > controls.shortest_step:
            part = 1.0 - excess / (force - clock[FORCE])
            clock[STEP] = max(step * max(0.1, part), 0.999 * controls.shortest_step)
            continue

        # Accept the step.
        for m in range(modes):
            for i in range(n):
                memory[m, i] += remember[m, _NEW] * load_new[i]
                lags[m, i] = load_new[i] - memory[m, i] - old[m, i]
                fields[MEMORY + m, i] = memory[m, i]
        row_products(lags, mesh.stiffness, strained)
        loss = 0.0
        for m in range(modes):
            product = 0.0
            for i in range(n):
                product += lags[m, i] * strained[m, i]
            loss += 2.0 * pi * frame * compliance[m + 1] / retardation[m] * product
        for i in range(n):
            fields[EARLIEST, i] = fields[EARLIER, i]
            fields[EARLIER, i] = fields[DEFORMATION, i]
            fields[DEFORMATION, i] = u[i]
            fields[LOAD_EARLIER, i] = fields[LOAD, i]
            fields[LOAD, i] = load_new[i]
        edge = frame * radius_of_gap(gap, mesh.nodes, controls.edge_gap)
        _move_clock(clock, step, frame, edge, force, u[n])
        clock[TIME] = controls.end if step == left else clock[TIME] + step
        clock[STEP] = max(step * min(2.5, max(0.3, growth)), 0.999 * controls.shortest_step)
        clock[HISTORY] = min(history + 1, 3)
        clock[AXIS_GAP] = gap[0]

        # The cohesive zone as it is now: where the gap opens outside the edge.
        coarseness = 0.0
        if edge > 0.0:
            zone = frame * radius_of_gap(gap, mesh.nodes, controls.open_gap) - edge
            coarseness = frame * mesh.edge_spacing / max(zone, 1e-9 * frame)
        row = records[count]
        row[R_TIME], row[R_HEIGHT], row[R_FORCE], row[R_EDGE] = clock[TIME], h0 + u[n], force, edge
        row[R_AXIS], row[R_LOSS], row[R_COARSENESS] = u[0], loss, coarseness
        row[R_FRAME], row[R_JUMP] = frame, 0.0
        if shapes.shape[0] > count:
            for i in range(n):
                shapes[count, i] = u[i]
        count += 1
        if excess > 0.0:
            outcome = TRIGGERED
            break
        if edge > 0.0 and not controls.finest <= coarseness <= controls.coarsest:
            outcome = REMESH
            break

    records[0, 0] = count
    return outcome
