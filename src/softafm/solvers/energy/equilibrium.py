"""Equilibrium of the energy solver: stable shapes of the surface, and the force on the tip.

With the stiffness S = G⁻¹ and masses m of the unit mesh, u = v − c K p reads
S (u − v)/(a c) + m p(h) = 0: the stationarity of

    Π/(2πa²) = (u − v)ᵀ S (u − v)/(2 a c) + Σ m_i Φ(h_i),     h = h0 + g − u.

A tip on a lever of stiffness k adds its deflection q to h0 and k q²/2 to the energy: one unknown
more, solved for together with the surface. Where q is listed with u it stands in u[n].
"""

from math import inf, pi

from numba import float64, int64

from softafm.compiled.dense import factorise, multiply, solve_factorised
from softafm.compiled.functions import PRESSURE, PROFILE, compile_for, inline, pointer_to
from softafm.solvers.energy.layout import CLOCK, MATRIX, MESH, VECTOR
from softafm.solvers.energy.tuning import (
    FARTHEST_GUESS,
    FORGOTTEN,
    MOST_ITERATIONS,
    TRUSTED,
)


@compile_for((MESH, float64, VECTOR, float64, float64, MATRIX))
def assemble(mesh, scale, slope, shift, lever, hessian):
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


@compile_for((float64, VECTOR, MESH, pointer_to(PRESSURE), VECTOR, MATRIX))
def integrate_beyond_mesh(gap, rise, mesh, law, parameters, work):
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


@inline
def _fall_of_energy(u, v, scale, mesh, pressure, change):
    """Write minus the gradient of Π/(2πa²) into ``change``, its last entry without the lever."""
    n = pressure.size
    for i in range(n):
        u[i] -= v[i]
    multiply(mesh.stiffness, u[:n], change[:n])
    change[n] = 0.0
    for i in range(n):
        u[i] += v[i]
        push = mesh.masses[i] * pressure[i]
        change[i] = -(change[i] * scale + push)
        change[n] += push


@inline
def _move_surface(u, change, standoff, gap, pressure, slope):
    """Add a change to the shape and the deflection, and to first order to the pressure."""
    n = pressure.size
    u[n] += change[n]
    for i in range(n):
        u[i] += change[i]
        gap[i] = standoff[i] + u[n] - u[i]
    for i in range(n):
        pressure[i] += slope[i] * (change[n] - change[i])


@inline
def _missed_force(mesh, exact, pressure):
    """Sums over the mesh of |exact − pressure| and |exact|."""
    missed, whole = 0.0, 0.0
    for i in range(pressure.size):
        missed += mesh.masses[i] * abs(exact[i] - pressure[i])
        whole += mesh.masses[i] * abs(exact[i])
    return missed, whole


@compile_for(
    int64(
        VECTOR, VECTOR, float64, VECTOR, float64, float64, VECTOR,
        MESH, pointer_to(PRESSURE), VECTOR, float64, float64, CLOCK, MATRIX, MATRIX, MATRIX,
    ),
)  # fmt: skip
def equilibrate(
    u, v, ac, standoff, lever, rest, rise,
    mesh, law, parameters, smallest_gap, accuracy, clock, hessian, work, far_work,
):  # fmt: skip
    """Newton's method for u = v − c K p(standoff + q − u) from a good guess, in place.

    ``ac`` is frame radius times compliance, ``standoff`` the gap to the flat surface of an unbent
    lever. Its deflection q balances ``lever``·(q − ``rest``) against the force, of which some acts
    beyond the mesh (see ``integrate_beyond_mesh``); ``lever`` 0 holds q still. Leaves the gap and
    the pressure in rows 0 and 1 of ``work``. Returns the iterations, negative if no stable shape
    was near the guess (an indefinite Hessian, or no convergence).
    """
    n = standoff.size
    size = n + 1 if lever > 0.0 else n
    gap, pressure, slope, change = work[0, :n], work[1, :n], work[2, :n], work[3]
    scale = 1.0 / ac
    for i in range(n):
        gap[i] = standoff[i] + u[n] - u[i]
        if not gap[i] > smallest_gap:
            return -1
    previous = FARTHEST_GUESS
    for iteration in range(1, MOST_ITERATIONS + 1):
        law(gap, parameters, pressure, slope, n)
        _fall_of_energy(u, v, scale, mesh, pressure, change)
        border = lever
        if size > n:
            tail, draw = integrate_beyond_mesh(gap[n - 1], rise, mesh, law, parameters, far_work)
            change[n] += tail - lever * (u[n] - rest)
            border += draw
        assemble(mesh, scale, slope, 0.0, border, hessian)
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
        _move_surface(u, change, standoff, gap, pressure, slope)
        if iteration == 2 and clock.contraction < inf:
            clock.contraction = largest / (previous * previous)
        if largest < accuracy:
            return iteration
        if iteration == 1 and 0.0 < clock.contraction * largest * largest < TRUSTED * accuracy:
            law(gap, parameters, change, slope, n)
            missed, whole = _missed_force(mesh, change, pressure)
            if missed < TRUSTED * accuracy * whole:
                clock.contraction *= FORGOTTEN
                return 1
        previous = largest
    return -MOST_ITERATIONS


@compile_for(float64(VECTOR, VECTOR, VECTOR, MESH, float64, pointer_to(PRESSURE), VECTOR, MATRIX))
def tip_force(pressure, gap, rise, mesh, frame, law, parameters, far_work):
    """Force on the tip, N: the mesh's share and that of the flat surface beyond it."""
    n = gap.size
    total, _ = integrate_beyond_mesh(gap[n - 1], rise, mesh, law, parameters, far_work)
    for i in range(n):
        total += mesh.masses[i] * pressure[i]
    return 2.0 * pi * frame * frame * total


@compile_for(float64(float64, float64), fastmath=False)
def spring_constant(stiffness, frame):
    """Stiffness of a lever, N/m, in units of Π/q² of a frame; 0 if it holds the tip still.

    Rounded as it stands, whatever code it is compiled into.
    """
    return stiffness / (2.0 * pi * frame * frame) if stiffness < inf else 0.0


@compile_for((pointer_to(PROFILE), VECTOR, MESH, float64, VECTOR, VECTOR, VECTOR))
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
