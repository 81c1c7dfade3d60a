"""Descent in energy, to a stable shape where none is near."""

from numba import float64, int64

from softafm.compiled.dense import factorise, multiply, solve_factorised
from softafm.compiled.functions import POTENTIAL, PRESSURE, compile_for, inline, pointer_to
from softafm.solvers.energy.equilibrium import assemble, integrate_beyond_mesh
from softafm.solvers.energy.layout import MESH, ROOM, VECTOR
from softafm.solvers.energy.tuning import LARGEST_DESCENT, MOST_DESCENTS, SUFFICIENT


@inline
def _find_way_down(
    gradient, gap, mesh, scale, slope, shift, border, steepest, size, hessian, change
):  # fmt: skip
    """Shift the Hessian until it is positive and no gap changes too much; the step in ``change``.

    Returns the shift, the largest relative change of a gap, and the slope of Π along the step.
    """
    n = slope.size
    while True:
        for i in range(size):
            change[i] = -gradient[i]
        assemble(mesh, scale, slope, shift, border, hessian)
        if factorise(hessian, size):
            solve_factorised(hessian, change, size)
            if size == n:
                change[n] = 0.0
            largest, downhill = 0.0, change[n] * gradient[n]
            for i in range(n):
                largest = max(largest, abs(change[i] - change[n]) / gap[i])
                downhill += change[i] * gradient[i]
            if largest < LARGEST_DESCENT:
                break
        shift = max(8.0 * shift, 1e-10 * steepest)
    return shift, largest, downhill


@inline
def _search_line(
    u, v, change, value, downhill, standoff, lever, tail, mesh, scale, potential, parameters, rows
):  # fmt: skip
    """Part of a step that lowers Π far enough below its ``value``."""
    n = standoff.size
    gap, density, trial, strain = rows[0, :n], rows[3, :n], rows[6, :n], rows[7, :n]
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
        if lower <= value + SUFFICIENT * length * downhill + 1e-14 * abs(value):
            break
        length *= 0.5
    return length


@compile_for(
    int64(
        VECTOR, VECTOR, float64, VECTOR, float64, VECTOR,
        MESH, pointer_to(PRESSURE), pointer_to(POTENTIAL), VECTOR, float64, ROOM,
    ),
)  # fmt: skip
def descend(u, v, ac, standoff, lever, rise, mesh, law, potential, parameters, accuracy, room):
    """Descend in energy from ``u``, in place, to a stable shape of u = v − c K p(standoff + q − u).

    Newton's method on Π, its Hessian shifted until it is positive and no gap changes by more than
    ``LARGEST_DESCENT``, each step shortened until Π falls. Arguments as of ``equilibrate``, and a
    ``room`` to work in. Returns the iterations, or -1 if ``MOST_DESCENTS`` do not suffice.
    """
    n = standoff.size
    size = n + 1 if lever > 0.0 else n
    rows, hessian, far_work = room.rows, room.hessian, room.far[1:]
    gap, pressure, slope, density = rows[0, :n], rows[1, :n], rows[2, :n], rows[3, :n]
    gradient, change, trial, strain = rows[4], rows[5], rows[6, :n], rows[7, :n]
    scale = 1.0 / ac
    shift = 0.0
    for iteration in range(1, MOST_DESCENTS + 1):
        for i in range(n):
            gap[i] = standoff[i] + u[n] - u[i]
            trial[i] = u[i] - v[i]
        law(gap, parameters, pressure, slope, n)
        potential(gap, parameters, density, n)
        multiply(mesh.stiffness, trial, strain)
        tail, border = 0.0, lever
        if size > n:
            tail, draw = integrate_beyond_mesh(gap[n - 1], rise, mesh, law, parameters, far_work)
            border += draw
        value, steepest = 0.5 * lever * u[n] * u[n] - tail * u[n], 0.0
        gradient[n] = lever * u[n] - tail
        for i in range(n):
            push = mesh.masses[i] * pressure[i]
            value += 0.5 * trial[i] * strain[i] * scale + mesh.masses[i] * density[i]
            gradient[i] = strain[i] * scale + push
            gradient[n] -= push
            steepest = max(steepest, abs(slope[i]))
        shift, largest, downhill = _find_way_down(
            gradient, gap, mesh, scale, slope, shift, border, steepest, size, hessian, change
        )
        if shift == 0.0 and largest < accuracy:
            for i in range(n + 1):
                u[i] += change[i]
            return iteration
        length = _search_line(
            u, v, change, value, downhill, standoff, lever, tail, mesh, scale, potential,
            parameters, rows,
        )  # fmt: skip
        for i in range(n + 1):
            u[i] += length * change[i]
        shift = 0.25 * shift if shift > 4e-10 * steepest else 0.0
    return -1
