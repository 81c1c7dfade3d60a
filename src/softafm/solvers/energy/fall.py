"""A fall of the energy solver: from a shape that is no longer stable to the next one that is."""

from typing import TYPE_CHECKING

import numpy as np

from softafm.instrument.compiled_motions import still
from softafm.instrument.lever import Lever
from softafm.solvers.energy.layout import (
    CLOCK_FIELDS,
    FINISHED,
    FULL,
    LOAD,
    REMESH,
    Controls,
    Parameters,
)
from softafm.solvers.energy.tuning import (
    END_OF_FALL,
    ERROR_IN_A_FALL,
    FALL_DECADES,
    JUMP_OF_EDGE,
    JUMP_OF_GAP,
    MOST_PATIENCE,
    MOST_TRIES_IN_A_FALL,
    STIFF_SHARE,
)

if TYPE_CHECKING:
    from softafm.solvers.energy.run import Run
    from softafm.solvers.energy.surface import Surface


def creep_down(run: "Run", time: float, duration: float) -> None:
    """Follow a fall, ``duration`` long and under the tip height of ``time``, as a fast creep.

    The instantaneous compliance is given a retardation time of its own, far below the shortest
    step, but for a share too stiff to be unstable. The fall is then smooth in that time, and the
    same steps follow it on the same riding mesh to the shape that is stable without this aid. A
    fall that starts slowly, or still hangs where it began, gets more of the fictitious time. One
    that takes too many steps is left to the descent in energy that follows.
    """
    surface, controls = run.surface, run.controls
    functions, parameters, background = surface.functions, surface.parameters, surface.background
    lever, state = surface.lever, surface.lever_state
    before = surface.clock["axis_gap"], surface.clock["edge"]
    stiff, delayed = _split_compliance(parameters.compliance[0], run.contact.tabor_instantaneous)
    surface.functions = functions._replace(height=still)
    # The clock of the fall starts at 0; the past goes on fading from where it is.
    surface.background = background._replace(since=background.since - time)
    surface.fields = np.vstack([surface.fields, surface.fields[LOAD]])
    surface.lag_energy = np.append(surface.lag_energy, 0.0)
    for patience in range(MOST_PATIENCE):
        creep_time = 10.0 ** -(FALL_DECADES + patience) * duration
        surface.parameters = parameters._replace(
            height=np.array([functions.height(time, parameters.height)]),
            compliance=np.concatenate([[stiff], parameters.compliance[1:], [delayed]]),
            retardation=np.append(parameters.retardation, creep_time),
        )
        falling = lever.falling(creep_time)
        surface.mount(falling, falling.at_start())
        run.controls = _loosen(controls, creep_time, duration, surface.clock["tries"])
        if not _reach_end(run, creep_time, duration):
            break
        if not _is_done(surface, delayed):
            continue
        if is_jump(surface.clock, *before) or not _would_jump(surface, parameters, lever):
            break
    surface.mount(lever, state)
    surface.functions, surface.parameters, surface.background = functions, parameters, background
    surface.fields, surface.lag_energy = surface.fields[:-1].copy(), surface.lag_energy[:-1].copy()
    run.controls = controls


def is_jump(clock: np.void, axis_gap: float, edge: float) -> bool:
    """Whether the contact has changed so much since it had this gap and edge, m, by a jump."""
    return bool(
        abs(clock["axis_gap"] - axis_gap) > JUMP_OF_GAP * axis_gap
        or abs(clock["edge"] - edge) > JUMP_OF_EDGE * edge
    )


def _would_jump(surface: "Surface", parameters: Parameters, lever: Lever) -> bool:
    """Whether the surface, let go of on its mesh, would go on to jump; tried on a copy.

    Near a fold a creep is so slow that it seems to have ended.
    """
    kept = surface.fields, surface.lag_energy, surface.parameters, surface.lever
    clock = surface.clock.copy()
    surface.fields, surface.lag_energy = surface.fields[:-1].copy(), surface.lag_energy[:-1].copy()
    surface.parameters = parameters._replace(height=surface.parameters.height)
    surface.lever = lever
    surface.settle()
    jumps = is_jump(surface.clock, clock["axis_gap"], clock["edge"])
    surface.fields, surface.lag_energy, surface.parameters, surface.lever = kept
    for name in CLOCK_FIELDS.names or ():
        surface.clock[name] = clock[name]
    return jumps


def _split_compliance(instantaneous: float, tabor: float | None) -> tuple[float, float]:
    """Return the share of the instantaneous compliance that stays, and the share delayed, 1/Pa."""
    share = min(STIFF_SHARE, (0.4 / tabor) ** 1.5) if tabor else STIFF_SHARE
    stiff = instantaneous * share
    return stiff, instantaneous - stiff


def _loosen(controls: Controls, creep_time: float, duration: float, tries: float) -> Controls:
    """Return controls for a fall: only its end counts."""
    return controls._replace(
        shortest_step=1e-9 * creep_time, longest_step=duration, top_speed=1e-300,
        prediction=ERROR_IN_A_FALL, memory=ERROR_IN_A_FALL, force=1.0, trigger=np.inf,
        most_tries=min(controls.most_tries, tries + MOST_TRIES_IN_A_FALL),
    )  # fmt: skip


def _reach_end(run: "Run", creep_time: float, duration: float) -> bool:
    """Step through the fictitious time from 0 to ``duration``; whether its end was reached."""
    surface, clock = run.surface, run.surface.clock
    clock["time"], clock["step"], clock["history"] = 0.0, 1e-3 * creep_time, 1
    clock["rides"] = 0.0
    outcome = FULL
    while outcome in (FULL, REMESH):
        outcome, records, _ = run._advance(duration)
        if outcome == REMESH:
            surface.remesh(records[-1]["coarseness"])
    return outcome == FINISHED


def _is_done(surface: "Surface", delayed: float) -> bool:
    """Whether surface and lever have come to rest."""
    clock = surface.clock
    behind = delayed * np.abs(surface.fields[LOAD] - surface.fields[-1]).max()
    if surface.bends:
        unbalanced = clock["force"] / surface.lever.stiffness - clock["deflection"]
        behind = max(behind, abs(unbalanced))
    return behind < END_OF_FALL * surface.edge_gap
