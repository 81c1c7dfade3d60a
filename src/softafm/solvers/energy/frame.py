"""Frames of the energy solver: fields moved between meshes, and the ride on the contact edge."""

from math import asinh, exp, floor, hypot, log, sqrt

import numpy as np
from numba import float64

from softafm.compiled.functions import compile_for, inline
from softafm.solvers.energy.layout import (
    CLOCK,
    CONSTANT_VECTOR,
    CONTROLS,
    MATRIX,
    MESH,
    VECTOR,
)  # fmt: skip
from softafm.solvers.energy.tuning import AT_REST, FARTHEST_RIDE, OPENING, SMALLEST_FRAME


@compile_for((MATRIX, VECTOR, MATRIX, MATRIX))
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


@compile_for((MATRIX, float64, float64, float64, CONSTANT_VECTOR, MATRIX))
def _fade(fields, end, decay, stretch, nodes, out):
    """Continue fields beyond the ``end`` of their mesh as e^(−decay·r)/r, in units of its frame."""
    last = fields.shape[1] - 1
    for i in range(nodes.size - 1, -1, -1):
        r = nodes[i] * stretch
        if r <= end:
            break
        for m in range(fields.shape[0]):
            out[m, i] = fields[m, last] * end / r
            if decay > 0.0:
                out[m, i] *= exp(-decay * (r - end))


@compile_for((MATRIX, float64, float64, float64, float64, float64, CONSTANT_VECTOR, MATRIX, MATRIX))
def transfer(fields, end, edge_spacing, growth, decay, stretch, nodes, work, out):
    """Evaluate displacement fields of one mesh at radii ``stretch``·``nodes`` of another.

    ``fields`` (m, n) live on a mesh of this ``edge_spacing`` and ``growth`` whose last node is
    ``end``. They are smooth and even in the node index; beyond the last node they are those of a
    concentrated load, e^(−decay·r)/r with the ``decay`` of the body in their frame, 0 on a
    half-space. ``work`` (7, ...) is worked in.
    """
    scale = growth / edge_spacing
    for i in range(nodes.size):
        r = nodes[i] * stretch
        work[0, i] = (asinh(scale * (r - 1.0)) + asinh(scale * (r + 1.0))) / growth
    _interpolate(fields, work[0, : nodes.size], work[1:], out)
    _fade(fields, end, decay, stretch, nodes, out)


@compile_for((MATRIX, MESH, float64, float64, MATRIX, MATRIX))
def reframe(fields, mesh, frame, stretch, work, out):
    """As ``transfer``, from a ``frame``, m, to one ``stretch`` times larger on the same mesh.

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
    _fade(fields, mesh.nodes[n - 1], frame * mesh.decay, stretch, mesh.nodes, out)


@compile_for(float64(VECTOR, CONSTANT_VECTOR, float64))
def find_radius(gap, nodes, value):
    """Smallest radius (in units of the frame) where the gap reaches ``value``."""
    if gap[0] >= value:
        return 0.0
    for i in range(1, nodes.size):
        if gap[i] >= value:
            part = (value - gap[i - 1]) / (gap[i] - gap[i - 1])
            return nodes[i - 1] + part * (nodes[i] - nodes[i - 1])
    return nodes[nodes.size - 1]


@compile_for(float64(float64, float64))
def choose_frame(edge, open_frame):
    """Frame radius that suits a contact edge; a contact too small to fill the field of attraction
    is seen from a wider frame, ``open_frame`` when there is none."""
    return max(edge, open_frame - OPENING * edge)


@compile_for(float64(float64, CLOCK))
def foresee_frame(step, clock):
    """Frame radius where the edge will be after a step that rides with it."""
    history, edge = int(clock.history), clock.edge
    if clock.rides < history:
        ahead = (edge - clock.edge_earlier) * step / clock.taken
        return edge + min(max(ahead, -FARTHEST_RIDE * edge), FARTHEST_RIDE * edge)
    before, earliest = clock.frame_earlier, clock.frame_earliest
    frame = clock.frame
    if history > 1:
        frame += step * (clock.frame - before) / clock.taken
    if history > 2:
        bend = (clock.frame - before) / clock.taken - (before - earliest) / clock.taken_earlier
        frame += step * (step + clock.taken) * bend / (clock.taken + clock.taken_earlier)
    return min(max(frame, (1.0 - FARTHEST_RIDE) * edge), (1.0 + FARTHEST_RIDE) * edge)


@inline
def find_spacing(radius, frame, mesh):
    """Distance of the nodes at a radius, m: that of the map j(ξ) of the mesh."""
    inner = hypot(mesh.edge_spacing, mesh.growth * (radius / frame - 1.0))
    outer = hypot(mesh.edge_spacing, mesh.growth * (radius / frame + 1.0))
    return frame * inner * outer / (inner + outer)


@compile_for(float64(float64, CLOCK, MESH, CONTROLS))
def follow_edge(step, clock, mesh, controls):
    """Frame radius for the next step, which rides along with the edge.

    It moves as far as the edge will, and makes up for what it lags while the edge passes the
    nodes; it stands still while the edge hardly moves, so that short steps see the same mesh, and
    where nodes farther in resolve a receding edge: the memory keeps the old rim, sharp, and a
    surface that parts everywhere at once has an edge that runs without meaning.
    """
    frame, edge = clock.frame, clock.felt
    if clock.history < 2:
        return frame
    ahead = (edge - clock.felt_earlier) * step / clock.taken
    ahead = min(max(ahead, -FARTHEST_RIDE * edge), FARTHEST_RIDE * edge)
    suited = choose_frame(edge, controls.open_frame)
    node = mesh.edge_spacing * frame
    if edge > 0.0 and edge + ahead < frame:
        spacing = find_spacing(max(edge + ahead, 0.0), frame, mesh)
        if spacing < controls.held * clock.zone:
            return frame
    if abs(ahead) < AT_REST * node and abs(suited - frame) < controls.slack * node:
        return frame
    pace = min(1.0, abs(ahead) / (controls.slack * node))
    ridden = frame + choose_frame(edge + ahead, controls.open_frame) - suited
    covering = min(max(controls.cover * clock.widest, controls.least_frame), frame)
    return max(ridden + pace * (suited - frame), SMALLEST_FRAME * frame, covering)
