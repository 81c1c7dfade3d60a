"""A step whose memory rides with the edge, for edges that cross many cohesive zones in a step.

What a point of the surface has borne while an edge passed it changes within the time in which the
edge crosses its own zone, and a filter at a fixed radius would need steps that short. Riding along,
ξ = r/a(s), the load hardly changes: over a step, s from 0 to 1,

    a(s) is quadratic through the last three frames,     q(r, s) = Σ_k ℓ_k(s) Q_k(r/a(s)),
    y⁺(r) = e^(−k) y(r) + ∫₀¹ k e^(−k(1 − s)) q(r, s) ds,     k = step/τ,

with the ℓ_k of the quadratic (or linear) filter and Q_k the last loads at equal ξ. The integral is
taken over panels that end where the path meets a node, so that it is as good as the interpolation
between nodes. The new load enters by a matrix, u = −(J_g + Σ J_m B_m) Q − Σ J_m (known)_m, which is
not symmetric: the equilibrium is that of ``softafm.solvers.energy.riding`` with Q and a for
unknowns, solved by Gauss's elimination. It is stable where the determinant is positive.
"""

from math import asinh, exp, sqrt

from numba import float64, int64

from softafm.compiled.dense import factorise_general, multiply, solve_general
from softafm.compiled.functions import INTERNAL, PRESSURE, PROFILE, compile_for, inline, pointer_to
from softafm.solvers.energy.equilibrium import integrate_beyond_mesh, raise_tip
from softafm.solvers.energy.layout import (
    BACKGROUND,
    CLOCK,
    LOAD,
    LOAD_EARLIER,
    MATRIX,
    MEMORY,
    MESH,
    PIVOTS,
    ROOM,
    VECTOR,
)
from softafm.solvers.energy.memory import CURVATURE, EARLIER, recall
from softafm.solvers.energy.riding import find_lean, lay_phase
from softafm.solvers.energy.tuning import (
    DAMPING,
    FARTHEST_RIDING_GUESS,
    FIRST_PANEL,
    FORGOTTEN_TIMES,
    MOST_ITERATIONS,
    NEXT_PANEL,
    OF_THE_EDGE,
    STRAIGHTEST,
)

# Gauss-Legendre with three points on [0, 1].
_OFF = 0.3872983346207417
_OUTER, _INNER = 5.0 / 18.0, 4.0 / 9.0


@inline
def _weigh_nodes(radius, mesh, decay, weights):
    """Six-point weights of a displacement at ``radius`` ξ, and the first node; see ``transfer``."""
    n = mesh.nodes.size
    end = mesh.nodes[n - 1]
    if radius > end:
        for m in range(5):
            weights[m] = 0.0
        weights[5] = end / radius
        if decay > 0.0:
            weights[5] *= exp(-decay * (radius - end))
        return n - 6
    scale = mesh.growth / mesh.edge_spacing
    index = (asinh(scale * (radius - 1.0)) + asinh(scale * (radius + 1.0))) / mesh.growth
    base = min(int(index) - 2, n - 6)
    t0 = index - base
    t1, t2, t3, t4, t5 = t0 - 1.0, t0 - 2.0, t0 - 3.0, t0 - 4.0, t0 - 5.0
    a, b, c = t0 * t1, t2 * t3, t4 * t5
    weights[0], weights[1] = b * c * t1 / -120.0, b * c * t0 / 24.0
    weights[2], weights[3] = a * c * t3 / -12.0, a * c * t2 / 12.0
    weights[4], weights[5] = a * b * t5 / -24.0, a * b * t4 / 120.0
    return base


@inline
def _bend_path(clock, step, frame):
    """Coefficients of a(s) = a0 + s (rise + bend (s − 1)), which never turns back."""
    rise, bend = frame - clock.frame, 0.0
    if clock.rides >= 2.0:
        ratio = step / clock.taken
        before = (clock.frame - clock.frame_earlier) * ratio
        bend = (rise - before) * ratio / (1.0 + ratio)
        most = STRAIGHTEST * abs(rise)
        bend = min(max(bend, -most), most)
    return rise, bend


@inline
def _curve(filters, m):
    """How much of a second difference the filter of an element takes: see find_memory_weights."""
    if filters[m, EARLIER] == 0.0:
        return 0.0
    return 1.0 if filters[m, EARLIER] * filters[m, CURVATURE] > 0.0 else -DAMPING


@compile_for(
    (
        float64, float64, CLOCK, VECTOR, VECTOR, MESH, MATRIX, MATRIX, int64, VECTOR, MATRIX,
        MATRIX, MATRIX, VECTOR, VECTOR,
    ),
)  # fmt: skip
def follow_load(
    step, frame, clock, compliance, retardation, mesh, fields, filters, adds, load_new, gain,
    known, gained, displaced, weights,
):  # fmt: skip
    """Carry the memory along the path of the edge to ``frame``, for the new load ``load_new``.

    Into ``known`` (elements, n) goes what does not depend on it, into ``gained`` what it adds, into
    ``displaced`` (n,) the displacement −u by both, of all elements, and if ``adds`` into ``gain``
    (n, n) the matrix Σ J_m B_m. ``filters`` are the memory's weights: how its second differences
    count. ``weights`` (6,) is worked in.
    """
    n, elements = mesh.nodes.size, retardation.size
    start, decay = clock.frame, clock.frame * mesh.decay
    rise, bend = _bend_path(clock, step, frame)
    last = clock.taken / step
    squared = clock.rides >= 2.0 and clock.history >= 2.0
    fastest, slowest = 0.0, 1e300
    for m in range(elements):
        fastest, slowest = max(fastest, step / retardation[m]), min(slowest, step / retardation[m])
    load, load_earlier = fields[LOAD], fields[LOAD_EARLIER]
    if adds > 0:
        for i in range(n):
            for j in range(n):
                gain[i, j] = 0.0
    for i in range(n):
        radius = frame * mesh.nodes[i]
        base = _weigh_nodes(radius / start, mesh, decay, weights)
        for m in range(elements):
            before = 0.0
            for o in range(6):
                before += weights[o] * fields[MEMORY + m, abs(base + o)]
            known[m, i] = exp(-step / retardation[m]) * before
            gained[m, i] = 0.0
        inward = 1 if rise > 0.0 else -1
        ahead = i + inward
        high, reach = 1.0, FIRST_PANEL / fastest
        while high > 0.0 and slowest * (1.0 - high) < FORGOTTEN_TIMES:
            low = max(1.0 - reach, 0.0)
            if i > 0 and 0 < ahead < n:
                off = radius / mesh.nodes[ahead] - start
                root = (rise - bend) * (rise - bend) + 4.0 * bend * off
                met = -1.0
                if off * inward > 0.0 and root > 0.0:
                    met = 2.0 * off / (rise - bend + inward * sqrt(root))
                if met > low:
                    low = min(met, high)
                    ahead += inward
                else:
                    reach *= NEXT_PANEL
            else:
                reach *= NEXT_PANEL
            width = high - low
            if width <= 0.0:
                continue
            for point in range(3):
                s = low + width * (0.5 + (point - 1) * _OFF)
                share = width * (_INNER if point == 1 else _OUTER)
                at = radius / (start + s * (rise + bend * (s - 1.0)))
                base = _weigh_nodes(at, mesh, decay, weights)
                now, earlier, new = 0.0, 0.0, 0.0
                for o in range(6):
                    place = abs(base + o)
                    now += weights[o] * load[place]
                    new += weights[o] * load_new[place]
                    earlier += weights[o] * load_earlier[place]
                total = 0.0
                for m in range(elements):
                    pace = step / retardation[m]
                    part = share * pace * exp(-pace * (1.0 - s))
                    curve = 0.0
                    if squared:
                        curve = _curve(filters, m) * s * (s - 1.0)
                    by_new = part * (s + curve / (1.0 + last))
                    known[m, i] += part * (1.0 - s - curve / last) * now
                    if squared:
                        known[m, i] += part * curve / (last * (1.0 + last)) * earlier
                    gained[m, i] += by_new * new
                    total += compliance[m + 1] * by_new
                if adds > 0:
                    for o in range(6):
                        gain[i, abs(base + o)] += total * weights[o]
            high = low
    for i in range(n):
        displaced[i] = 0.0
        for m in range(elements):
            displaced[i] += compliance[m + 1] * (known[m, i] + gained[m, i])


@inline
def _displace(
    step, frame, base, profile, tip_parameters, compliance, retardation, filters, background,
    mesh, fields, clock, u, load_new, known, gained, room,
):  # fmt: skip
    """Shape, gaps and their slope with the frame, rows 7 and 11 of ``room.rows``, under a load.

    The memory rides to the frame, ``room.gain`` is what a change of the load adds to it.
    """
    n, elements = mesh.nodes.size, retardation.size
    rows = room.rows
    displaced, tip, scratch, path = rows[3, :n], rows[4, :n], rows[6, :n], rows[10, :6]
    lean, radii, later = rows[11, :n], rows[12, :n], rows[15, :n]
    raise_tip(profile, tip_parameters, mesh, frame, scratch, tip, room.far[0])
    find_lean(profile, tip_parameters, mesh, frame, radii, scratch, lean)
    apart = 1e-3 * mesh.edge_spacing * frame
    follow_load(
        step, frame + apart, clock, compliance, retardation, mesh, fields, filters, 0, load_new,
        room.gain, known, gained, later, path,
    )  # fmt: skip
    follow_load(
        step, frame, clock, compliance, retardation, mesh, fields, filters, 1, load_new,
        room.gain, known, gained, displaced, path,
    )  # fmt: skip
    shifting, old = room.fields[2:9], room.fields[10 + elements : 10 + 2 * elements]
    recall(background, clock.time + step, frame, retardation, mesh.nodes, shifting, old)
    for i in range(n):
        lean[i] += (later[i] - displaced[i]) / apart
        below = compliance[0] * load_new[i] + displaced[i]
        for m in range(elements):
            below += compliance[m + 1] * old[m, i]
        u[i] = -below
        rows[7, i] = base + tip[i] + u[n] + below


@inline
def _assemble(frame, instant, edge_gap, mesh, load_new, room, last):
    """System of the changes of load, deflection (left out) and frame; its right-hand side."""
    n, rows, system, gain = mesh.nodes.size, room.rows, room.system, room.gain
    gap, pressure, slope, lean = rows[7], rows[8], rows[9], rows[11]
    strain, weights, change = rows[1, :n], rows[14, :6], room.change[0]
    multiply(mesh.stiffness, load_new, strain)
    for i in range(n):
        push = mesh.masses[i] * slope[i]
        row, stiff, answer = system[i], mesh.stiffness[i], gain[i]
        for j in range(n):
            row[j] = push * answer[j] - stiff[j] / frame
        row[i] += push * instant
        row[n] = push
        row[last] = strain[i] / (frame * frame) + push * lean[i]
        change[i] = strain[i] / frame - mesh.masses[i] * pressure[i]
    first = lay_phase(mesh, weights)
    # Of the size of the other rows, as pivots are compared.
    size = mesh.stiffness[first, first] / (frame * instant)
    phase, off, moved = system[last], edge_gap, 0.0
    for j in range(n):
        phase[j] = 0.0
    for m in range(6):
        i = first + m
        for j in range(n):
            phase[j] += size * weights[m] * gain[i, j]
        phase[i] += size * weights[m] * instant
        off -= weights[m] * gap[i]
        moved += weights[m] * lean[i]
    phase[n] = size
    phase[last] = size * moved
    change[last] = size * off


@inline
def _assemble_lever(frame, instant, lever, deflection, rest, mesh, law, parameters, room):
    """Row of the balance of the lever, and its right-hand side."""
    n, rows, gain = mesh.nodes.size, room.rows, room.gain
    gap, pressure, slope, lean = rows[7], rows[8], rows[9], rows[11]
    row = room.system[n]
    pull, draw = integrate_beyond_mesh(gap[n - 1], room.far[0], mesh, law, parameters, room.far[1:])
    border, leaning = lever + draw, -2.0 * lever / frame * (deflection - rest)
    for j in range(n):
        row[j] = 0.0
    for i in range(n):
        push, answer = mesh.masses[i] * slope[i], gain[i]
        for j in range(n):
            row[j] -= push * answer[j]
        row[i] -= push * instant
        border -= push
        leaning -= push * lean[i]
        pull += mesh.masses[i] * pressure[i]
    row[n], row[n + 1] = border, leaning
    room.change[0, n] = pull - lever * (deflection - rest)


@inline
def _change_gaps(instant, mesh, room, last, out):
    """Change of the gaps, into ``out``, by the changes of load, deflection and frame."""
    n, change, lean = mesh.nodes.size, room.change[0], room.rows[11]
    multiply(room.gain, change[:n], out)
    bent = change[n] if last > n else 0.0
    for i in range(n):
        out[i] += instant * change[i] + bent + lean[i] * change[last]


@compile_for(
    int64(
        float64, float64, float64, float64, float64, pointer_to(PROFILE), pointer_to(PRESSURE),
        VECTOR, VECTOR, VECTOR, VECTOR, MATRIX, BACKGROUND, MESH, MATRIX, CLOCK, float64, float64,
        float64, VECTOR, VECTOR, MATRIX, MATRIX, ROOM, PIVOTS,
    ),
    **INTERNAL,
)  # fmt: skip
def trace(
    step, guessed_frame, base, spring, rest, profile, law,
    tip_parameters, parameters, compliance, retardation, filters, background, mesh, fields, clock,
    edge_gap, smallest_gap, accuracy, u, load_new, known, gained, room, pivots,
):  # fmt: skip
    """Newton's method for load, deflection and frame from a good guess, in place.

    ``base`` is the height of an unbent lever's tip, m, from the origin of gaps; ``load_new`` the
    guessed load, q, and ``u[n]`` the guessed deflection; the rest as of ``ride``. Leaves the shape
    in u, memory in ``known`` + ``gained``, gap and pressure in rows 7 and 8 of the room's rows, the
    tip's rise beyond the mesh in its ``far``, the factor in its ``system`` and ``pivots``, and what
    it has found in ``clock.found``. Returns the iterations, negative if no stable shape is near the
    guess.
    """
    n, bends = mesh.nodes.size, spring > 0.0
    last = n + 1 if bends else n
    order = pivots[: last + 1]
    gap, pressure, slope = room.rows[7, :n], room.rows[8, :n], room.rows[9, :n]
    change, by = room.change[0], room.rows[13, :n]
    frame, previous, instant = guessed_frame, FARTHEST_RIDING_GUESS, compliance[0]
    for iteration in range(1, MOST_ITERATIONS + 1):
        _displace(
            step, frame, base, profile, tip_parameters, compliance, retardation, filters,
            background, mesh, fields, clock, u, load_new, known, gained, room,
        )  # fmt: skip
        for i in range(n):
            if not gap[i] > smallest_gap:
                return -iteration
        law(gap, parameters, pressure, slope, n)
        _assemble(frame, instant, edge_gap, mesh, load_new, room, last)
        if bends:
            lever = spring / (frame * frame)
            _assemble_lever(frame, instant, lever, u[n], rest, mesh, law, parameters, room)
        # Of n loads that press up, as many rows have another sign than in Newton's own system.
        sign = factorise_general(room.system, order) * (1 - 2 * (n % 2))
        if sign == 0:
            return -iteration
        solve_general(room.system, order, change)
        _change_gaps(instant, mesh, room, last, by)
        moved = change[last]
        largest = OF_THE_EDGE * abs(moved) / frame
        for i in range(n):
            largest = max(largest, abs(by[i]) / gap[i])
        if not largest < previous:
            return -iteration
        frame += moved
        if bends:
            u[n] += change[n]
        for i in range(n):
            load_new[i] += change[i]
        clock.found, clock.stability = frame, float(sign)
        if largest < accuracy:
            # The last correction is so small that it counts to first order.
            tip, path = room.rows[4, :n], room.rows[10, :6]
            raise_tip(profile, tip_parameters, mesh, frame, room.rows[6, :n], tip, room.far[0])
            for i in range(n):
                gap[i] += by[i]
                u[i] = base + tip[i] + u[n] - gap[i]
            law(gap, parameters, pressure, slope, n)
            follow_load(
                step, frame, clock, compliance, retardation, mesh, fields, filters, 0, load_new,
                room.gain, known, gained, room.rows[3, :n], path,
            )  # fmt: skip
            return iteration if sign > 0 else -iteration
        previous = largest
    return -MOST_ITERATIONS


@compile_for((VECTOR, float64, float64, int64, MESH, VECTOR, ROOM, PIVOTS), **INTERNAL)
def answer_shift(shift, instant, frame, bends, mesh, gaps, room, pivots):
    """Change of the gaps, into ``gaps``, by a small ``shift`` of the surface away from the tip, m.

    From what ``trace`` left.
    """
    n = mesh.nodes.size
    slope, weights, change = room.rows[9], room.rows[14, :6], room.change[0]
    change[n] = 0.0
    for i in range(n):
        push = mesh.masses[i] * slope[i] * shift[i]
        change[i] = -push
        change[n] += push
    first, last = lay_phase(mesh, weights), n + 1 if bends > 0 else n
    kept = 0.0
    for m in range(6):
        kept -= weights[m] * shift[first + m]
    change[last] = kept * mesh.stiffness[first, first] / (frame * instant)
    solve_general(room.system, pivots[: last + 1], change)
    _change_gaps(instant, mesh, room, last, gaps[:n])
    for i in range(n):
        gaps[i] += shift[i]
