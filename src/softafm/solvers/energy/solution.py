"""A step solved: surface and lever in equilibrium, in a frame given or together with its edge."""

from numba import int64, types

from softafm.compiled.dense import solve_factorised
from softafm.compiled.functions import (
    HEIGHT,
    INTERNAL,
    PRESSURE,
    PROFILE,
    compile_for,
    inline,
    pointer_to,
)
from softafm.solvers.energy.equilibrium import equilibrate
from softafm.solvers.energy.layout import (
    BACKGROUND,
    CLOCK,
    CONTROLS,
    LOAD,
    LOAD_EARLIER,
    MATRIX,
    MESH,
    ORIGIN,
    PARAMETERS,
    PIVOTS,
    ROOM,
    TABLE,
)
from softafm.solvers.energy.memory import NEW
from softafm.solvers.energy.proposal import (
    TRIAL,
    Trial,
    carry_past,
    find_extrapolation_weights,
    furnish,
)
from softafm.solvers.energy.riding import lay_phase, ride
from softafm.solvers.energy.stiffness import find_stiffness
from softafm.solvers.energy.tracing import trace
from softafm.solvers.energy.tuning import CLOSEST, MOST_REFRAMES, RIDING_ERROR

STABLE, UNSTABLE, UNKNOWN = 1, 0, -1
SOLUTION = types.Tuple((TRIAL, int64))

KEEPS, RIDES, TRACES = 0, 1, 2
"""How a trial ``rides``: the frame is kept, solved for, or solved for with a memory that rides."""


@inline
def solve(
    trial, height, profile, law, parameters, background, mesh, table, controls, fields, clock, work,
    room, pivots,
):  # fmt: skip
    """Bring a trial into equilibrium; returns it in the frame found, and STABLE or what else."""
    if trial.rides == TRACES:
        return solve_tracing(
            trial, profile, law, parameters, background, mesh, controls, fields, clock, room, pivots
        )  # fmt: skip
    if trial.rides == RIDES:
        return solve_riding(
            trial, height, profile, law, parameters, background, mesh, table, controls, fields,
            clock, room,
        )  # fmt: skip
    return trial, solve_kept(trial, law, parameters, mesh, controls, clock, work)


@inline
def solve_kept(trial, law, parameters, mesh, controls, clock, work):
    """Bring surface and lever into equilibrium, with the load, in the frame of the trial."""
    iterations = equilibrate(
        work.u, work.v, trial.frame * trial.compliance, work.standoff, trial.lever, trial.rest,
        work.rise, mesh, law, parameters.law, CLOSEST * controls.edge_gap, controls.newton,
        clock, work.hessian, work.newton, work.far,
    )  # fmt: skip
    clock.newtons += abs(iterations)
    if iterations > 0:
        for i in range(mesh.nodes.size):
            work.load_new[i] = (work.v[i] - work.u[i]) / trial.compliance
    return STABLE if iterations > 0 else UNSTABLE


@inline
def find_slide(v, mesh, frame, slide):
    """Change of a displacement with the frame at fixed ξ, (ξ/a) ∂v/∂ξ, by differences in j."""
    n = mesh.nodes.size
    for i in range(n - 3):
        near, middle = v[i + 1] - v[abs(i - 1)], v[i + 2] - v[abs(i - 2)]
        bend = (45.0 * near - 9.0 * middle + v[i + 3] - v[abs(i - 3)]) / 60.0
        density = (1.0 / mesh.slopes[0, i] + 1.0 / mesh.slopes[1, i]) / mesh.edge_spacing
        slide[i] = bend * density * mesh.nodes[i] / frame
    for i in range(n - 3, n):  # a concentrated load's
        slide[i] = -v[i] / frame


@compile_for(
    SOLUTION(
        TRIAL, pointer_to(HEIGHT), pointer_to(PROFILE), pointer_to(PRESSURE), PARAMETERS,
        BACKGROUND, MESH, TABLE, CONTROLS, MATRIX, CLOCK, ROOM,
    ),
    **INTERNAL,
)  # fmt: skip
def solve_riding(
    trial, height, profile, law, parameters, background, mesh, table, controls, fields, clock, room
):  # fmt: skip
    """As ``solve``, with the edge, from a guess whose gaps are left in ``work.shape``.

    Returns the trial in the frame found, and STABLE, UNSTABLE, or UNKNOWN if the stiffness in
    ``clock.wanted`` is to be tabulated.
    """
    work = furnish(room)
    n, elements = mesh.nodes.size, parameters.retardation.size
    slide, kept = work.strained[0] if elements > 0 else work.scratch, work.riding[2, :n]
    for i in range(n):
        work.shape[0, i] = work.standoff[i] + work.u[n] - work.u[i]
        slide[i] = 0.0
    frame, spring = trial.frame, trial.lever * trial.frame * trial.frame
    outcome = UNSTABLE
    for _ in range(MOST_REFRAMES):
        if elements > 0:
            find_slide(work.v, mesh, frame, slide)
        iterations = ride(
            work.u, work.v, slide, frame, trial.compliance, 0, work.standoff, work.tip, spring,
            trial.rest, work.rise, mesh, profile, parameters.tip, law, parameters.law,
            controls.edge_gap, CLOSEST * controls.edge_gap, RIDING_ERROR * controls.newton, clock,
            work.hessian, work.newton, work.riding, work.far,
        )  # fmt: skip
        clock.newtons += abs(iterations)
        if iterations < 0:
            break
        moved = abs(clock.found - frame) / frame
        frame = clock.found
        for i in range(n):
            kept[i] = work.v[i]
        carry_past(
            trial.step, frame, height, profile, parameters, background, mesh, fields, clock, work
        )
        off = 0.0
        for i in range(n):
            off = max(off, abs(work.v[i] - kept[i]) / work.newton[0, i])
        if table.found.shape[0] > 0:
            off = max(off, moved)
            if not find_stiffness(table, frame):
                clock.wanted = frame
                outcome = UNKNOWN
                break
        if off < controls.newton:
            outcome = STABLE
            break
    for i in range(n):
        work.load_new[i] = (work.v[i] - work.u[i]) / trial.compliance
    found = Trial(
        trial.step, frame, trial.height, trial.compliance, trial.deflection,
        spring / (frame * frame), trial.rest, trial.history, trial.rides,
    )  # fmt: skip
    return found, outcome


@compile_for(
    SOLUTION(
        TRIAL, pointer_to(PROFILE), pointer_to(PRESSURE), PARAMETERS, BACKGROUND, MESH, CONTROLS,
        MATRIX, CLOCK, ROOM, PIVOTS,
    ),
    **INTERNAL,
)  # fmt: skip
def solve_tracing(
    trial, profile, law, parameters, background, mesh, controls, fields, clock, room, pivots
):  # fmt: skip
    """As ``solve_riding``, with a memory that rides too."""
    work = furnish(room)
    n, elements = mesh.nodes.size, parameters.retardation.size
    known = min(int(clock.rides), trial.history)
    for i in range(n):
        work.shape[0, i] = work.standoff[i] + work.u[n] - work.u[i]
        work.past[0, i], work.load_earlier[0, i] = fields[LOAD, i], fields[LOAD_EARLIER, i]
        work.load_new[i] = 0.0
    find_extrapolation_weights(
        known, trial.step, clock.taken, clock.taken_earlier, work.past_weights
    )
    for k in range(known):
        for i in range(n):
            work.load_new[i] += work.past_weights[k] * fields[LOAD - k, i]
    find_extrapolation_weights(
        trial.history, trial.step, clock.taken, clock.taken_earlier, work.past_weights
    )
    spring = trial.lever * trial.frame * trial.frame
    iterations = trace(
        trial.step, trial.frame, trial.height - parameters.law[ORIGIN], spring, trial.rest,
        profile, law, parameters.tip, parameters.law, parameters.compliance,
        parameters.retardation, work.weights, background, mesh, fields, clock, controls.edge_gap,
        CLOSEST * controls.edge_gap, RIDING_ERROR * controls.newton, work.u, work.load_new,
        work.past[1:], work.lags, room, pivots,
    )  # fmt: skip
    clock.newtons += abs(iterations)
    for m in range(elements):
        work.weights[m, NEW] = 0.0
        for i in range(n):
            work.past[m + 1, i] += work.lags[m, i]
    frame = clock.found if iterations > 0 else trial.frame
    found = Trial(
        trial.step, frame, trial.height, trial.compliance, trial.deflection,
        spring / (frame * frame), trial.rest, trial.history, trial.rides,
    )  # fmt: skip
    return found, STABLE if iterations > 0 else UNSTABLE


@inline
def find_response(trial, pull, mesh, work, change):
    """Change of the gaps by a change of the surface at no load, c S⁻¹ times ``pull``.

    Left in ``change`` with its sign turned and the deflection's last: gap i changes by
    change[n] − change[i].
    """
    n = mesh.nodes.size
    for i in range(n):
        change[i] = pull[i]
    change[n] = 0.0
    solve_factorised(work.hessian, change, n + 1 if trial.lever > 0.0 else n)
    if trial.rides > 0:
        column, lean, weights = work.riding[0], work.riding[1], work.riding[4, :6]
        first = lay_phase(mesh, weights)
        top, bottom = -change[n], -column[n]
        for m in range(6):
            top += weights[m] * change[first + m]
            bottom += weights[m] * (column[first + m] + lean[first + m])
        moved = top / bottom
        for i in range(n):
            change[i] -= moved * (column[i] + lean[i])
        change[n] -= moved * column[n]
