"""What is observed of a tip that swings: integrals over each cycle, gathered step by step.

Over a step the force is a straight line and the deflection the cubic of its values and speeds at
both ends, so that products of both are integrated as they stand. What bends the force late is a
parabola of −b h³/12 in the middle of the step.
"""

from math import cos, inf, sin

from numba import float64, int64, types

from softafm.compiled.functions import INTERNAL, compile_for, fix, inline
from softafm.solvers.energy.layout import FINISHED, MATRIX, RECORDS, SWING, VECTOR, Controls
from softafm.solvers.energy.step import STEPPING, SWINGING, step_on

advance_swinging = compile_for(SWINGING, **INTERNAL)(fix(step_on, "advance_swinging", SWINGS=True))
"""``step_on`` for levers with inertia."""

# Entries of `sums`, of one cycle; then the damping of each mode, and the spectrum of the force.
FORCE, VIRIAL, WORK, BASE_WORK, DEFLECTION, LOST, JUMPED, LARGEST, SMALLEST, TRIES = range(10)
DAMPING = 10
# Entries of `last`, of the row before and the one before that; then deflections and speeds of the
# modes. After a faint force the turns of higher harmonics are not known.
TIME, PUSH, AT, SPEED, TIME_EARLIER, PUSH_EARLIER, AT_EARLIER, SPEED_EARLIER = range(8)
BASE, STEP, FAINTLY, MODES = 8, 9, 10, 11


@inline
def find_extreme(sign, time, force, middle, at_middle, earlier, at_earlier):
    """Largest (``sign`` 1) or smallest of three forces; of the middle one, of its parabola."""
    best = sign * at_middle
    after, before = time - middle, middle - earlier
    if best > sign * force and best > sign * at_earlier and after > 0.0 and before > 0.0:
        rise, fall = (at_middle - at_earlier) / before, (force - at_middle) / after
        bend = (fall - rise) / (after + before)
        slope = rise + bend * before
        best -= sign * 0.25 * slope * slope / bend
    return max(best, sign * force)


@inline
def add_turn(f0, f1, late, step, omega, now, turning, found):
    """Add ∫ F e^(−iωt) dt over a step to what was found; ``turning`` is as for ``watch``."""
    then = complex(turning[0], turning[1])
    g0, g1 = f0 * then, f1 * now
    bent = complex(0.0, -omega) * step * (g0 - g1) + (f1 - f0) * (then - now)
    part = step * (0.5 * (g0 + g1) + bent / 12.0) + late * complex(turning[2], turning[3])
    found[0] += part.real
    found[1] += part.imag
    turning[0], turning[1] = now.real, now.imag
    turning[2], turning[3] = 0.5 * (now.real + then.real), 0.5 * (now.imag + then.imag)


@compile_for((RECORDS, MATRIX, int64, VECTOR, VECTOR, VECTOR, VECTOR, int64, float64, MATRIX))
def watch(records, strokes, count, last, sums, tuned, drag, harmonics, faint, turning):
    """Add the first ``count`` records to the ``sums`` of a cycle.

    ``tuned`` (d,) are the angular frequencies of the drives, 1/s, ``drag`` (m,) the damping of the
    modes, N s/m; of the first drive as many ``harmonics`` of the force are found, the higher ones
    where it is not ``faint``, N. The columns of
    ``turning`` are e^(−iωt) in the row before and in the middle of the step to it.
    """
    modes = drag.size
    spectrum = DAMPING + modes
    for i in range(count):
        record, stroke = records[i], strokes[i]
        step, f0, f1, q0, q1 = (
            record.time - last[TIME],
            stroke[0],
            record.force,
            last[AT],
            stroke[2],
        )
        v0, v1 = last[SPEED], 0.0
        for k in range(modes):
            v1 += stroke[3 + modes + k]
        base, rise = record.height - q1, f1 - f0
        area = 0.5 * (q0 + q1) + step * (v0 - v1) / 12.0
        late = -stroke[1] * last[STEP] ** 3 / 12.0
        sums[FORCE] += 0.5 * step * (f0 + f1) + late
        sums[VIRIAL] += late * 0.5 * (last[AT_EARLIER] + q0) + step * (
            f0 * area + rise * (0.15 * q0 + 0.35 * q1 + step * (v0 / 30.0 - v1 / 20.0))
        )
        sums[WORK] -= f1 * q1 - f0 * q0 - rise * area
        sums[WORK] -= late * 0.5 * (last[SPEED_EARLIER] + v0)
        sums[BASE_WORK] -= 0.5 * (f0 + f1) * (base - last[BASE])
        sums[DEFLECTION] += step * area
        sums[LOST] += record.lost
        sums[JUMPED] += record.jump
        t0, t1, fell = last[TIME], record.time, f0 != last[PUSH]
        earlier, push = t0 if fell else last[TIME_EARLIER], last[PUSH_EARLIER]
        largest = find_extreme(1.0, t1, f1, t0, f0, earlier, push)
        smallest = -find_extreme(-1.0, t1, f1, t0, f0, earlier, push)
        sums[LARGEST] = max(sums[LARGEST], largest)
        sums[SMALLEST] = min(sums[SMALLEST], smallest)
        for k in range(modes):
            before, after = last[MODES + modes + k], stroke[3 + modes + k]
            middle = 1.5 * (stroke[3 + k] - last[MODES + k]) / step - 0.25 * (before + after)
            squares = before * before + 4.0 * middle * middle + after * after
            sums[DAMPING + k] += drag[k] * squares * step / 6.0
            last[MODES + k], last[MODES + modes + k] = stroke[3 + k], after
        faintly = abs(f0) < faint and abs(f1) < faint
        at = spectrum
        for d in range(tuned.size):
            found = (harmonics if d == 0 else 1), (1 if faintly else harmonics)
            turn = complex(cos(tuned[d] * record.time), -sin(tuned[d] * record.time))
            now = complex(1.0, 0.0)
            for k in range(1, min(found[0], found[1]) + 1):
                now *= turn
                omega, col = k * tuned[d], at + 2 * (k - 1)
                if k > 1 and last[FAINTLY] > 0.0:
                    turned = omega * last[TIME]
                    turning[0, col - spectrum] = turning[2, col - spectrum] = cos(turned)
                    turning[1, col - spectrum] = turning[3, col - spectrum] = -sin(turned)
                add_turn(
                    f0, f1, late, step, omega, now, turning[:, col - spectrum],
                    sums[col : col + 2],
                )  # fmt: skip
            at += 2 * found[0]
        last[FAINTLY] = 1.0 if faintly else 0.0
        last[TIME_EARLIER], last[PUSH_EARLIER] = last[TIME], f0
        last[AT_EARLIER], last[SPEED_EARLIER] = q0, v0
        last[TIME], last[PUSH], last[AT], last[SPEED] = record.time, f1, q1, v1
        last[BASE], last[STEP] = base, step


@inline
def begin_cycle(sums):
    """Empty the sums of a cycle."""
    for k in range(sums.size):
        sums[k] = 0.0
    sums[LARGEST], sums[SMALLEST] = -inf, inf


@compile_for(
    types.UniTuple(int64, 3)(
        VECTOR, MATRIX, VECTOR, VECTOR, VECTOR, VECTOR, int64, float64, MATRIX,
        *STEPPING, SWING, MATRIX, VECTOR,
    ),
)  # fmt: skip
def advance_cycles(
    ends, found, last, sums, tuned, drag, harmonics, faint, turning, height, profile, law, respond,
    accept_force, parameters, background, mesh, table, controls, fields, clock, lever_state,
    lag_energy, records, shapes, room, pivots, swing, strokes, turns,
):  # fmt: skip
    """Advance until a cycle cannot be ended, or to the last of the ``ends``, s.

    A row of ``found`` gets the ``sums`` of each cycle, and the state of the lever at its end.
    Returns why it stopped, the number of records filled since the last end, and that of cycles.
    """
    done, count, outcome = 0, 0, FINISHED
    while done < ends.size and outcome == FINISHED:
        steered = Controls(ends[done], *controls[1:])
        outcome, count = advance_swinging(
            height, profile, law, respond, accept_force, parameters, background, mesh, table,
            steered, fields, clock, lever_state, lag_energy, records, shapes, room, pivots, swing,
            strokes, turns,
        )  # fmt: skip
        watch(records, strokes, count, last, sums, tuned, drag, harmonics, faint, turning)
        if outcome == FINISHED:
            sums[TRIES], clock.tries = clock.tries, 0.0
            for k in range(sums.size):
                found[done, k] = sums[k]
            for k in range(lever_state.size):
                found[done, sums.size + k] = lever_state[k]
            begin_cycle(sums)
            done += 1
    return outcome, count, done
