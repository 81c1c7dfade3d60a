"""Equilibrium with the radius of the contact edge as an unknown, for contacts whose edge is slack.

The shift of a soft and sticky contact's edge costs so little energy that the nodes of a fixed frame
decide where it stops, and a guess of it has to be good to a part of the cohesive zone. Here the
nodes ride: at fixed ξ, r = aξ, the frame a is solved for together with the surface,

    F_i = [S(u − v)]_i/(a c) + m_i p(h_i) = 0,     h(ξ = 1) = the gap of largest tension,

by Newton's method on the bordered system [H, f; r', d][du; da] = [−F; e] with f = ∂F/∂a, r the
derivative of h(1) with u and the deflection, d = ∂h(1)/∂a and e what h(1) misses. Solved by
Cholesky with H + κ r r', in which κ holds the edge still, and one more back-substitution. The
contact is stable as long as s = (d − r'H⁻¹f)/d is positive; s → 0 is the fold where it lets go.
"""

from math import asinh

from numba import float64, int64

from softafm.compiled.dense import factorise, multiply, solve_factorised
from softafm.compiled.functions import PRESSURE, PROFILE, compile_for, inline, pointer_to
from softafm.solvers.energy.equilibrium import assemble, integrate_beyond_mesh, raise_tip
from softafm.solvers.energy.layout import CLOCK, MATRIX, MESH, VECTOR
from softafm.solvers.energy.tuning import (
    FARTHEST_RIDING_GUESS,
    LARGEST_LANDING,
    MOST_ITERATIONS,
    MOST_LANDING,
    OF_THE_EDGE,
)


@inline
def lay_phase(mesh, weights):
    """Six-point Lagrange weights of the value at ξ = 1; returns the first node they belong to."""
    at = asinh(2.0 * mesh.growth / mesh.edge_spacing) / mesh.growth
    first = int(at) - 2
    for m in range(6):
        weights[m] = 1.0
        for o in range(6):
            if o != m:
                weights[m] *= (at - first - o) / (m - o)
    return first


@inline
def find_lean(profile, parameters, mesh, frame, radii, higher, lean):
    """Slope of the tip's height at the nodes with the frame, ξ g'(aξ), by central differences."""
    n = mesh.nodes.size
    for i in range(n):
        radii[i] = frame * (1.0 + 1e-5) * mesh.nodes[i]
    profile(radii, parameters, higher, n)
    for i in range(n):
        radii[i] = frame * (1.0 - 1e-5) * mesh.nodes[i]
    profile(radii, parameters, lean, n)
    for i in range(n):
        lean[i] = (higher[i] - lean[i]) / (2e-5 * frame)


@inline
def _hold_edge(mesh, slope, first, weights, off, moved, hessian, change, column):
    """Add κ r r' to the Hessian and what belongs to it to both right-hand sides."""
    n = mesh.nodes.size
    kappa = 0.0
    for m in range(6):
        i = first + m
        kappa = max(kappa, mesh.masses[i] * abs(slope[i]) + hessian[i, i])
    for m in range(6):
        for o in range(m, 6):
            hessian[first + m, first + o] += kappa * weights[m] * weights[o]
        hessian[first + m, n] -= kappa * weights[m]
        change[first + m] -= kappa * off * weights[m]
        column[first + m] -= kappa * moved * weights[m]
    hessian[n, n] += kappa
    change[n] += kappa * off
    column[n] += kappa * moved


@inline
def _assemble(
    u, v, slide, frame, compliance, lifts, spring, rest, rise, mesh, profile, tip_parameters,
    law, parameters, edge_gap, hessian, work, rows, far_work,
):  # fmt: skip
    """H + κ r r' into the Hessian, both right-hand sides into ``change`` and ``column``; returns d.

    The slope of the gaps with the frame, or with the height of the tip, is left in row 1 of rows.
    """
    n = mesh.nodes.size
    gap, pressure, slope, change = work[0, :n], work[1, :n], work[2, :n], work[3]
    column, lean, radii = rows[0], rows[1, :n], rows[2, :n]
    scratch, weights = rows[3, :n], rows[4, :6]
    scale, lever = 1.0 / (frame * compliance), spring / (frame * frame)
    for i in range(n):
        scratch[i] = u[i] - v[i]
    multiply(mesh.stiffness, scratch, change[:n])
    change[n] = column[n] = 0.0
    if lifts > 0:
        for i in range(n):
            lean[i] = 1.0
            column[i] = mesh.masses[i] * slope[i]
    else:
        find_lean(profile, tip_parameters, mesh, frame, radii, scratch, lean)
        multiply(mesh.stiffness, slide, column[:n])
        for i in range(n):
            leant = mesh.masses[i] * slope[i] * lean[i]
            column[i] = leant - scale * (change[i] / frame + column[i])
            column[n] -= leant
    for i in range(n):
        push = mesh.masses[i] * pressure[i]
        change[i] = -(change[i] * scale + push)
        change[n] += push
    border = lever
    if lever > 0.0:
        tail, draw = integrate_beyond_mesh(gap[n - 1], rise, mesh, law, parameters, far_work)
        change[n] += tail - lever * (u[n] - rest)
        column[n] -= 2.0 * lever / frame * (u[n] - rest)
        border += draw
    assemble(mesh, scale, slope, 0.0, border, hessian)
    first = lay_phase(mesh, weights)
    off, moved = edge_gap, 0.0
    for m in range(6):
        off -= weights[m] * gap[first + m]
        moved += weights[m] * lean[first + m]
    _hold_edge(mesh, slope, first, weights, off, moved, hessian, change, column)
    return moved


@compile_for(
    int64(
        VECTOR, VECTOR, VECTOR, float64, float64, int64, VECTOR, VECTOR, float64, float64, VECTOR,
        MESH, pointer_to(PROFILE), VECTOR, pointer_to(PRESSURE), VECTOR, float64, float64, float64,
        CLOCK, MATRIX, MATRIX, MATRIX, MATRIX,
    ),
)  # fmt: skip
def ride(
    u, v, slide, frame, compliance, lifts, standoff, tip, spring, rest, rise,
    mesh, profile, tip_parameters, law, parameters, edge_gap, smallest_gap, accuracy,
    clock, hessian, work, rows, far_work,
):  # fmt: skip
    """Newton's method for surface, deflection and frame from a good guess, in place.

    ``slide`` is dv/da at fixed ξ, ``spring`` the stiffness of the lever over 2π, 0 if it holds the
    tip; else as ``equilibrate``. With ``lifts`` the frame is kept, and the height of the tip is
    found that makes a contact of this radius, its change in u[n]. ``standoff`` and ``tip`` are
    brought to the new frame, and v to first order. Leaves the frame in ``clock.found``, s in
    ``clock.stability``, du/da in row 0 of ``rows`` and dg/da in row 1, the factor in ``hessian``.
    Returns the iterations, negative if no such contact is near the guess.
    """
    n = standoff.size
    size = n + 1 if spring > 0.0 else n
    gap, pressure, slope, change = work[0, :n], work[1, :n], work[2, :n], work[3]
    column, lean, radii = rows[0], rows[1, :n], rows[2, :n]
    weights = rows[4, :6]
    first = lay_phase(mesh, weights)
    for i in range(n):
        gap[i] = standoff[i] + u[n] - u[i]
        if not gap[i] > smallest_gap:
            return -1
    previous = FARTHEST_RIDING_GUESS
    for iteration in range(1, (MOST_LANDING if lifts > 0 else MOST_ITERATIONS) + 1):
        law(gap, parameters, pressure, slope, n)
        moved = _assemble(
            u, v, slide, frame, compliance, lifts, spring, rest, rise, mesh, profile,
            tip_parameters, law, parameters, edge_gap, hessian, work, rows, far_work,
        )  # fmt: skip
        if not factorise(hessian, size):
            return -iteration
        solve_factorised(hessian, change, size)
        solve_factorised(hessian, column, size)
        if size == n:
            change[n] = column[n] = 0.0
        top, bottom = edge_gap - change[n], moved - column[n]
        for m in range(6):
            top += weights[m] * (change[first + m] - gap[first + m])
            bottom += weights[m] * column[first + m]
        clock.stability = bottom / moved
        step = top / bottom
        largest = 0.0 if lifts > 0 else OF_THE_EDGE * abs(step) / frame
        for i in range(n + 1):
            change[i] -= step * column[i]
        for i in range(n):
            largest = max(largest, abs(change[i] - change[n] - lean[i] * step) / gap[i])
        if lifts > 0:
            part = min(1.0, LARGEST_LANDING / largest)
            step *= part
            for i in range(n + 1):
                change[i] *= part
        elif not largest < previous:
            return -iteration
        u[n] += change[n]
        if lifts > 0:
            u[n] += step
        else:
            frame += step
            for i in range(n):
                v[i] += slide[i] * step
                standoff[i] -= tip[i]
            raise_tip(profile, tip_parameters, mesh, frame, radii, tip, rise)
            for i in range(n):
                standoff[i] += tip[i]
        for i in range(n):
            u[i] += change[i]
            gap[i] = standoff[i] + u[n] - u[i]
            if not gap[i] > smallest_gap:
                return -iteration
        clock.found = frame
        if largest < accuracy:
            law(gap, parameters, pressure, slope, n)
            return iteration if lifts > 0 or clock.stability > 0.0 else -iteration
        previous = largest
    return -MOST_LANDING
