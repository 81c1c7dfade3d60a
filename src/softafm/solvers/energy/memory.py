"""Memory of the energy solver: filters of the load, exact over a step, and the fading past."""

from math import exp, pi

from numba import float64, int64

from softafm.compiled.dense import multiply_rows
from softafm.compiled.functions import compile_for, inline
from softafm.solvers.energy.frame import transfer
from softafm.solvers.energy.layout import BACKGROUND, CONSTANT_VECTOR, MATRIX, VECTOR
from softafm.solvers.energy.tuning import DAMPING, RINGING, SHORT, STIFF

# Columns of the memory weights.
DECAY, EARLIER, NOW, NEW, CURVATURE = range(5)


@compile_for((float64, float64, int64, VECTOR, VECTOR, MATRIX))
def find_memory_weights(step, last, order, compliance, retardation, weights):
    """Weights of y⁺ = decay·y + earlier·q₋ + now·q + new·q⁺ over a step, one row per element.

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
        if k < SHORT:
            m0 = k * (1.0 - k * (1.0 / 2 - k * (1.0 / 6 - k / 24)))
            m1 = k * (1.0 / 2 - k * (1.0 / 6 - k * (1.0 / 24 - k / 120)))
            m2 = k * (1.0 / 3 - k * (1.0 / 12 - k * (1.0 / 60 - k / 360)))
        else:
            m0 = 1.0 - exp(-k)
            m1 = 1.0 - m0 / k
            m2 = 1.0 - 2.0 * m1 / k
        row = weights[m]
        bend = m2 - m1
        row[DECAY], row[EARLIER], row[NOW], row[NEW] = 1.0 - m0, 0.0, m0 - m1, m1
        row[CURVATURE] = bend
        if order == 2:
            ratio = last / step
            lag = compliance[m + 1] / compliance[0]
            if k * (1.0 + lag) > STIFF:
                ringing = abs(row[DECAY] - row[NOW] * lag) / (1.0 + row[NEW] * lag)
                damping = DAMPING if ringing > RINGING else 0.0
                row[CURVATURE] = 3.0 * (1.0 + damping) * bend
                bend *= -damping
            row[EARLIER] += bend / (ratio * (1.0 + ratio))
            row[NOW] -= bend / ratio
            row[NEW] += bend / (1.0 + ratio)


@compile_for((BACKGROUND, float64, float64, VECTOR, CONSTANT_VECTOR, MATRIX, MATRIX))
def recall(background, time, frame, retardation, nodes, work, memory):
    """Memory of the background at ``time`` on the nodes of a frame, into ``memory`` (m, n).

    Rows of elements that the background has not are zero.
    """
    elements = background.values.shape[0]
    for m in range(elements, memory.shape[0]):
        for i in range(nodes.size):
            memory[m, i] = 0.0
    if elements == 0:
        return
    transfer(
        background.values, background.end, background.edge_spacing, background.growth,
        background.decay, frame / background.frame, nodes, work, memory,
    )  # fmt: skip
    for m in range(elements):
        fading = exp(-(time - background.since) / retardation[m])
        for i in range(nodes.size):
            memory[m, i] *= fading


@inline
def gather(background, weights, load, mesh, frame):
    """Carry the memory that a background gathers over a step to a ``load`` (1, n) of a frame."""
    elements, n = background.values.shape
    if elements > 0:
        gained = background.gained
        new = gained[elements + 2]
        transfer(
            load, mesh.nodes[mesh.nodes.size - 1], mesh.edge_spacing, mesh.growth,
            frame * mesh.decay, background.frame / frame, background.nodes,
            gained[elements + 3 :], gained[elements + 2 : elements + 3],
        )  # fmt: skip
        for m in range(elements):
            for i in range(n):
                gained[2 + m, i] = (
                    weights[m, DECAY] * gained[2 + m, i]
                    + weights[m, EARLIER] * gained[0, i]
                    + weights[m, NOW] * gained[1, i]
                    + weights[m, NEW] * new[i]
                )
        for i in range(n):
            gained[0, i], gained[1, i] = gained[1, i], new[i]


@inline
def displace_by_memory(compliance, weights, load_earlier, load, memory, old, lags, v):
    """Carry the memory over a step as far as it is known; return the compliance of the step.

    The step is an elastic contact of that compliance on a surface displaced by ``v``, which is
    overwritten, as is ``memory`` (elements, n) of the instant before; ``old`` is that of the
    background at the end of the step. The part of the new load is left out. ``lags`` (elements, n)
    gets what the step leaves of the lags q − y_m.
    """
    elements, n = memory.shape
    total = compliance[0]
    for i in range(n):
        v[i] = 0.0
    for m in range(elements):
        total += compliance[m + 1] * weights[m, NEW]
        for i in range(n):
            lags[m, i] = weights[m, DECAY] * (load[i] - memory[m, i]) - old[m, i]
            memory[m, i] = (
                weights[m, DECAY] * memory[m, i]
                + weights[m, EARLIER] * load_earlier[i]
                + weights[m, NOW] * load[i]
            )
            v[i] -= compliance[m + 1] * (memory[m, i] + old[m, i])
    return total


@inline
def carry_lag_energy(
    compliance, retardation, step, frame, anew, weights, left, lags, strained, stiffness, energies
):
    """Carry ``energies`` L_m = ½⟨e_m, K⁻¹ e_m⟩ of the lags e_m = q − y_m, Pa² m³, over a step.

    With what the step ``left`` of the old lags, ε e with ε = e^(−dt/τ_m), and d = e⁺ − ε e,

        L⁺ = ε² L + ⟨½ (e⁺ + ε e), K⁻¹ d⟩,

    where K⁻¹ d is smooth at the old rims in e, which may lie on coarse nodes. ``anew`` sums up e⁺
    itself, which serves as long as it has no rim but the edge. ``lags`` (elements, n), those at the
    end, and ``left`` are overwritten.

    Returns what the dashpots take over the step, J: 2π J_m (L − L⁺ + 2k (L⁺ − ε² L)/(1 − ε²)) with
    k = dt/τ_m, exact for a lag that relaxes, or approaches what a steady motion drives it to.
    """
    elements, n = lags.shape
    lost = 0.0
    for m in range(elements):
        for i in range(n):
            end, start = lags[m, i], 0.0 if anew else left[m, i]
            lags[m, i], left[m, i] = end - start, 0.5 * (end + start)
    multiply_rows(lags, stiffness, strained)
    for m in range(elements):
        product = 0.0
        for i in range(n):
            product += left[m, i] * strained[m, i]
        pace, before = step / retardation[m], energies[m]
        faded = weights[m, DECAY] * weights[m, DECAY]
        kept = 0.0 if anew else faded * before
        # Where a lag has all but died away, what rounding leaves may be below zero.
        energies[m] = max(kept + frame * product, 0.0)
        driven = 2.0 * pace / max(1.0 - faded, 1e-300) * (energies[m] - faded * before)
        if pace < SHORT:  # the straight line between, as the difference above would cancel
            driven = energies[m] - before + pace * (energies[m] + before)
        lost += 2.0 * pi * compliance[m + 1] * (before - energies[m] + driven)
    return lost


@inline
def dissipated_power(compliance, retardation, energies):
    """Power that the dashpots of all elements take, W, by the energies of their lags."""
    power = 0.0
    for m in range(energies.size):
        power += 4.0 * pi * compliance[m + 1] / retardation[m] * energies[m]
    return power
