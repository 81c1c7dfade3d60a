"""Levers with inertia, against closed forms, an integrator of ODEs and quasi-static levers."""

from functools import cache
from math import pi, sin

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.linalg import expm

import softafm as sa
from softafm.instrument.motions import Sine, Still
from softafm.instrument.resonator import Resonator
from softafm.solvers.energy.swinging import Swinging

F, A0, K = 278e3, 15e-9, 28.1
PS = sa.Contact(
    sa.Paraboloid(50e-9),
    sa.StandardLinearSolid(E0=4.25e9, E_inf=1.89e9, creep_time=1e-7, poisson=0.35),
    sa.LennardJones(2e-20, 0.15e-9),
)
"""Polystyrene of Table 3 of Rajabifar et al. 2021."""
ELASTIC = sa.Contact(PS.tip, sa.Elastic(4.25e9, 0.35), PS.surface)
FREE = sa.Contact(PS.tip, PS.sample, sa.Repulsion(1e9, 0.05e-9))


def swing(contact, lever, base, cycles, tolerance=1e-2, before=None):
    """Return a run of some cycles."""
    motion = Still(base, cycles / F)
    run = Swinging(
        sa.solvers.Energy(), contact, lever, motion, Sine(base, A0, F, "steady"), tolerance
    )
    if before is not None:
        before(run.surface.lever_state)
    list(run.pass_cycles(np.arange(1, cycles + 1) / F, 0))
    return run


@pytest.mark.parametrize("theta", [1e-3, 0.1, 1.0, 7.0, 1e6])
def test_a_step_yields_as_an_undamped_mode_does(theta):
    """C = (1 − sin θ/θ)/k: h²/6m in short steps, 1/k in long ones."""
    lever = Resonator((sa.Eigenmode(K, F, 1e12),))
    respond, _, parameters = lever.compiled_response
    step = theta / (2 * pi * F)
    rest, stiffness = respond(step, step, 0.0, 0.0, parameters, lever.at_start())
    exact = theta**2 / 6 if theta < 1e-2 else 1 - sin(theta) / theta
    assert rest == 0
    assert K / stiffness == pytest.approx(exact, rel=1e-6)


def test_a_lever_that_presses_on_a_spring_neither_gains_nor_loses():
    """Eigenvalues of a step of Ωh = 1 against a spring of 25 k: magnitude 1."""
    lever = Resonator((sa.Eigenmode(K, F, 1e15),))
    respond, accept, parameters = lever.compiled_response
    stiff, step = 25 * K, 1 / (2 * pi * F * 26**0.5)
    columns = []
    for deflection, speed in ((1e-9, 0.0), (0.0, 1e-2)):
        state = np.zeros(2)
        lever.push(state, 0, deflection, speed)
        before = -stiff * deflection
        rest, k = respond(step, step, deflection, before, parameters, state)
        after = -stiff * rest / (1 + stiff / k)
        accept(step, step, before, after, parameters, state)
        columns.append(lever.measure(step, state)[1:])
    matrix = np.transpose(columns) / [1e-9, 1e-2]
    assert np.abs(np.linalg.eigvals(matrix)) == pytest.approx([1, 1], abs=1e-12)


@pytest.mark.parametrize("quality", [0.2, 0.5, 0.8, 30, 429.5, 1e4])
def test_free_levers_ring_down_as_they_should(quality):
    """300 cycles from a deflection and a speed, beside the matrix exponential."""
    lever = Resonator(
        (sa.Eigenmode(K, F, quality), sa.Eigenmode(40 * K, 6.27 * F, 2 * quality)),
        (sa.Drive(F, 1e-15),),
    )

    def push(state):
        lever.push(state, 0, A0, 0.3 * A0 * 2 * pi * F)
        lever.push(state, 1, -0.1 * A0, 0.0)

    run = swing(FREE, lever, 1e-6, 300, before=push)
    for cycle in (0, 1, 299):
        state = run.found[cycle, run.sums.size :]
        exact = 0.0
        for mode, start in zip(
            lever.modes, ((A0, 0.3 * A0 * 2 * pi * F), (-0.1 * A0, 0)), strict=True
        ):
            w = 2 * pi * mode.frequency
            system = np.array([[0, 1], [-(w**2), -w / mode.quality_factor]]) * (cycle + 1) / F
            exact += (expm(system) @ start)[0]
        found = lever.deflection_at((cycle + 1) / F, state)
        assert found == pytest.approx(exact, abs=1e-8 * A0)


@cache
def static_force():
    """Force of the elastic contact against height, by a slow ramp at a hundredth of the tolerance,
    and the attraction of a rigid surface above."""
    ramp = sa.force_distance(ELASTIC, sa.Triangle(6e-9, -3e-9, 1e-6), tolerance=1e-4)
    half = int(ramp.tip_height.values.argmin()) + 1
    height, force = ramp.tip_height.values[:half][::-1], ramp.force.values[:half][::-1]
    near = CubicSpline(height, force)
    last = height[-1]
    return lambda h: np.where(h < last, near(np.minimum(h, last)), ELASTIC.rigid_force(h))


@pytest.mark.parametrize(
    ("modes", "cycles", "allowed"),
    [
        ([sa.Eigenmode(K, F, 30)], 40, 1e-4),
        ([sa.Eigenmode(K, F, 2)], 12, 4e-4),
        ([sa.Eigenmode(K, F, 0.45)], 4, 4e-4),
        ([sa.Eigenmode(K, F, 30), sa.Eigenmode(40 * K, 6.27 * F, 60)], 20, 1e-4),
    ],
)
def test_driven_levers_move_as_an_integrator_of_odes_has_them(modes, cycles, allowed):
    """On an elastic sample, whose force is one of the height alone, from rest."""
    lever = Resonator(tuple(modes), (sa.Drive(F, A0),))
    base = 0.7 * A0
    run = swing(ELASTIC, lever, base, cycles)
    forces, pull = lever.find_forces(lever.drives[0]), static_force()
    k = np.array([m.stiffness for m in modes])
    w = 2 * pi * np.array([m.frequency for m in modes])
    q = np.array([m.quality_factor for m in modes])

    def move(t, y):
        deflection, speed = y[: k.size], y[k.size :]
        whole = float(pull(base + deflection.sum())) + forces * np.cos(2 * pi * F * t)
        return np.concatenate([speed, w**2 * (whole / k - deflection) - w / q * speed])

    curves = run.collect_curves()
    time = curves["time"][1:]  # begun by a flight, or a surface that settles
    exact = solve_ivp(
        move, (0, cycles / F), np.zeros(2 * k.size), "DOP853", rtol=1e-9, atol=1e-19, t_eval=time
    ).y[: k.size].sum(axis=0)  # fmt: skip
    largest = np.abs(curves["force"]).max()
    assert largest > 5e-9
    assert np.abs(curves["deflection"][1:] - exact).max() < allowed * A0


def test_the_tip_does_not_move_while_the_surface_falls():
    """It has inertia: no step, of a fall either, moves it faster than it can swing."""
    run = swing(PS, Resonator((sa.Eigenmode(K, F, 30),), (sa.Drive(F, A0),)), 8.49e-9, 60)
    curves = run.collect_curves()
    step, late = np.diff(curves["time"]), slice(2000, None)
    fallen = np.abs(np.diff(curves["force"])) > 1e-2 * curves["force"].max()
    fallen &= step < 1e-5 / F
    assert fallen[late].any()
    fastest = 1.2 * A0 * 2 * pi * F
    assert (np.abs(np.diff(curves["deflection"])) < fastest * step + 1e-15)[late].all()
