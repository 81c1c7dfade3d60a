"""The compiled kernels of the energy solver against readable twins in NumPy and SciPy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

import softafm as sa
from softafm.bodies import HalfSpace
from softafm.bodies.mesh import node_index, unit_mesh
from softafm.bodies.stiffness import Stiffness
from softafm.instrument.compiled_levers import hold, remember_nothing
from softafm.solvers.energy.descent import descend
from softafm.solvers.energy.equilibrium import equilibrate, tip_force
from softafm.solvers.energy.frame import find_radius, reframe, transfer
from softafm.solvers.energy.layout import (
    FULL,
    LOAD,
    MEMORY,
    RECORD_FIELDS,
    Background,
    Controls,
    Parameters,
    Table,
    make_mesh,
    new_clock,
    new_room,
)
from softafm.solvers.energy.memory import find_memory_weights
from softafm.solvers.energy.proposal import find_extrapolation_weights
from softafm.solvers.energy.step import advance
from softafm.solvers.energy.tracing import follow_load

R, W, Z0 = 10e-9, 0.05, 0.3e-9
LAW = sa.LennardJones.from_work_of_adhesion(W, Z0)
TIP = sa.Paraboloid(R)
FRAME = 1.5 * np.sqrt(R * Z0)
seeds = st.integers(0, 2**32 - 1)


def mesh_with_stiffness(mesh):
    """A mesh on a half-space."""
    return make_mesh(mesh, Stiffness(HalfSpace(sa.Elastic(1e9, 0.3)), mesh).uniform, 0.0)


UNIFORM = Table(np.empty((0, 1, 1)), 0.0, 1.0, np.empty((0, 0)))
"""The stiffness is the same in all frames."""


# Fields from mesh to mesh


def carried(values, old, new, stretch=1.0, decay=0.0):
    out = np.empty((1, new.nodes.size))
    work = np.empty((7, new.nodes.size))
    transfer(
        values[None], old.nodes[-1], old.edge_spacing, old.growth, decay, stretch, new.nodes, work,
        out,
    )  # fmt: skip
    return out[0]


OLD, NEW = unit_mesh(0.1, 0.25, 8.0), unit_mesh(0.03, 0.2, 8.0)


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, 1), st.floats(0.5, 1.5))
@settings(deadline=None)
def test_transfer_is_exact_for_even_polynomials(a, b, c, stretch):
    # Even in the node index j, of degree 4.
    def polynomial(j):
        return a + b * (j / 20) ** 2 + c * (j / 20) ** 4

    values = polynomial(np.arange(OLD.nodes.size))
    radius = stretch * NEW.nodes
    inside = radius <= OLD.nodes[-1]
    found = carried(values, OLD, NEW, stretch)[inside]
    wanted = polynomial(node_index(radius[inside], OLD.edge_spacing, OLD.growth))
    assert np.allclose(found, wanted, rtol=0, atol=1e-12 * (1 + np.abs(values).max()))


@pytest.mark.parametrize("stretch", [0.5, 1.0, 1.1, 2.0])
def test_transfer_of_a_smooth_field(stretch):
    def field(r):
        return 1 / np.sqrt(1 + r**2)

    radius = stretch * NEW.nodes
    found = carried(field(OLD.nodes), OLD, NEW, stretch)
    inside = radius <= OLD.nodes[-1]
    assert np.allclose(found[inside], field(radius[inside]), rtol=3e-5)
    beyond = field(OLD.nodes[-1]) * OLD.nodes[-1] / radius[~inside]
    assert np.allclose(found[~inside], beyond, rtol=1e-14)
    assert stretch <= 1 or np.any(~inside)


def test_fields_fall_beyond_their_mesh_as_their_body_says():
    field, frame, decay, stretch = 1 / (1 + OLD.nodes), 3e-9, 2e7, 1.7
    radius = stretch * OLD.nodes
    outside = radius > OLD.nodes[-1]
    end, beyond = OLD.nodes[-1], radius[outside]
    fallen = field[-1] * end / beyond * np.exp(-decay * frame * (beyond - end))
    transferred = carried(field, OLD, OLD, stretch, decay * frame)
    reframed, work = np.empty((1, field.size)), np.empty((7, field.size))
    mesh = mesh_with_stiffness(OLD)._replace(decay=decay)
    reframe(field[None], mesh, frame, stretch, work, reframed)
    for found in (transferred, reframed[0]):
        assert np.count_nonzero(outside) > 2
        np.testing.assert_allclose(found[outside], fallen, rtol=1e-12)
    np.testing.assert_array_equal(
        transferred[~outside], carried(field, OLD, OLD, stretch)[~outside]
    )


def test_transfer_error_falls_with_a_high_power_of_the_growth():
    def error(growth):
        mesh = unit_mesh(growth / 2, growth, 8.0)
        found = carried(np.exp(-(mesh.nodes**2)), mesh, NEW)
        inside = mesh.nodes[-1] >= NEW.nodes
        return np.abs(found - np.exp(-(NEW.nodes**2)))[inside].max()

    growths = np.array([0.4, 0.2, 0.1])
    order = np.polyfit(np.log(growths), np.log([error(g) for g in growths]), 1)[0]
    assert order > 5


@pytest.mark.parametrize("stretch", [0.7, 0.9, 0.999, 1.0, 1.0001, 1.01, 1.2, 1.4])
def test_reframing_is_a_transfer_to_the_same_mesh(stretch):
    field = 1 / np.sqrt(1 + OLD.nodes[None] ** 2)
    found, work = np.empty(field.shape), np.empty((7, field.size))
    reframe(field, mesh_with_stiffness(OLD), 1.0, stretch, work, found)
    assert np.allclose(found[0], carried(field[0], OLD, OLD, stretch), rtol=1e-10, atol=0)
    assert stretch != 1 or np.array_equal(found, field)


# Memory


def lagrange(instants, which):
    """The polynomial that is 1 at instants[which] and 0 at the others."""
    others = np.delete(instants, which)
    return np.poly1d(np.poly(others)) / np.prod(instants[which] - others)


def filtered(ratio, instants):
    """Weights of y⁺ = decay·y + Σ weight·q(instants) for q interpolated, step 1, τ = 1/ratio."""
    weights = []
    for which in range(len(instants)):
        basis = lagrange(np.array(instants), which)
        # Beyond 50 retardation times nothing is remembered.
        start = max(0.0, 1 - 50 / ratio)
        weights.append(
            quad(
                lambda s, basis=basis: ratio * np.exp(-ratio * (1 - s)) * basis(s),
                start,
                1,
                epsabs=1e-14,
                epsrel=1e-12,
            )[0]
        )
    return np.exp(-ratio), weights


def weights_of(step, last, order, compliance, retardation):
    weights = np.empty((len(retardation), 5))
    find_memory_weights(
        step, last, order, np.array(compliance, float), np.array(retardation, float), weights
    )
    return weights[:, :4]


RATIOS = np.geomspace(1e-6, 1e3, 19)


@pytest.mark.parametrize("ratio", RATIOS)
def test_memory_of_a_linear_load(ratio):
    decay, (now, new) = filtered(ratio, [0.0, 1.0])
    (found,) = weights_of(2e-6, 1e-6, 1, [1.0, 5.0], [2e-6 / ratio])
    assert found == pytest.approx([decay, 0, now, new], rel=1e-8, abs=1e-13)


@pytest.mark.parametrize("last", [0.3, 1.0, 4.0])
@pytest.mark.parametrize("ratio", RATIOS[RATIOS < 2])
def test_memory_of_a_quadratic_load(ratio, last):
    decay, (earlier, now, new) = filtered(ratio, [-last, 0.0, 1.0])
    (found,) = weights_of(2e-6, last * 2e-6, 2, [1.0, 0.1], [2e-6 / ratio])
    assert found == pytest.approx([decay, earlier, now, new], rel=1e-8, abs=1e-13)


@pytest.mark.parametrize("order", [1, 2])
@given(st.floats(-6, 3), st.floats(0.2, 5), st.floats(0, 3))
@settings(deadline=None)
def test_every_memory_formula_is_exact_for_linear_loads(order, log_ratio, last, log_lag):
    # q = 1 + s, also where long steps ask for other weights than the quadratic's.
    ratio = 10**log_ratio
    decay, (now, new) = filtered(ratio, [0.0, 1.0])
    (found,) = weights_of(1.0, last, order, [1.0, 10**log_lag], [1 / ratio])
    response = found[1:] @ np.array([1 - last, 1.0, 2.0])
    assert found[0] == pytest.approx(decay, rel=1e-8, abs=1e-13)
    assert response == pytest.approx(now + 2 * new, rel=1e-8, abs=1e-13)


def test_modes_do_not_touch_each_other():
    both = weights_of(1e-6, 2e-6, 2, [1.0, 0.3, 0.1], [1e-6, 1e-4])
    for mode, (compliance, time) in enumerate([(0.3, 1e-6), (0.1, 1e-4)]):
        (alone,) = weights_of(1e-6, 2e-6, 2, [1.0, compliance], [time])
        assert np.array_equal(both[mode], alone)


@pytest.mark.parametrize("lag", [1, 3, 10, 30, 100, 300, 1000])
def test_memory_of_a_contact_held_rigidly_never_grows(lag):
    # u = -(J_g q + J_1 y) = 0, so q = -λ y with λ = J_1/J_g: both relax.
    for ratio in np.geomspace(1e-3, 1e2, 101):
        (first,) = weights_of(1.0, 1.0, 1, [1.0, lag], [1 / ratio])
        (later,) = weights_of(1.0, 1.0, 2, [1.0, lag], [1 / ratio])
        before, y = 1.0, (first[0] - lag * first[2]) / (1 + lag * first[3])
        assert abs(y) <= 1
        decay, earlier, now, new = later
        recursion = np.array([[decay - lag * now, -lag * earlier], [1 + lag * new, 0]])
        recursion[0] /= 1 + lag * new
        recursion[1] = 1, 0
        assert np.abs(np.linalg.eigvals(recursion)).max() < 1
        largest = 1.0
        for _ in range(400):
            before, y = y, recursion[0] @ [y, before]
            largest = max(largest, abs(y))
        assert largest <= 1
        assert abs(y) <= 1


# Equilibrium


MESH = mesh_with_stiffness(unit_mesh(0.15, 0.25, 8.0))
GAPS = TIP.profile(FRAME * MESH.nodes)
PRESSURE, POTENTIAL, PARAMETERS = LAW.compiled_pressure


def slope(gap):
    step = 1e-5 * gap
    return (LAW.pressure(gap + step) - LAW.pressure(gap - step)) / (2 * step)


RISE = TIP.profile(FRAME * MESH.far) - GAPS[-1]
BEYOND = MESH.nodes[-1] ** 2 / (2 * GAPS[-1])
"""Force beyond the mesh over 2πa², per unit of Φ there: r dr = (r²/2g) dh on a paraboloid."""


def newton_step(u, v, ac, h0, lever):
    """Displacement to the stationary point of Π, over the gap; lowest eigenvalue of its Hessian.

    ``u`` (n + 1,) ends with the deflection of a lever; ``lever`` 0 leaves its equation out.
    """
    n = MESH.nodes.size
    gap = h0 + GAPS + u[n] - u[:n]
    gradient, hessian = np.empty(n + 1), np.zeros((n + 1, n + 1))
    push, bend = MESH.masses * LAW.pressure(gap), MESH.masses * slope(gap)
    gradient[:n] = MESH.stiffness @ (u[:n] - v) / ac + push
    gradient[n] = lever * u[n] - push.sum() - BEYOND * LAW.potential(gap[-1])
    hessian[:n, :n] = MESH.stiffness / ac - np.diag(bend)
    hessian[n, :n] = hessian[:n, n] = bend
    hessian[n, n] = lever - bend.sum() + BEYOND * LAW.pressure(gap[-1])
    size = n + 1 if lever else n
    hessian = hessian[:size, :size]
    scale = 1 / np.sqrt(np.append(np.diag(MESH.stiffness) / ac, lever or 1.0))[:size]
    lowest = np.linalg.eigvalsh(hessian * np.outer(scale, scale))[0]
    step = np.zeros(n + 1)
    step[:size] = np.linalg.solve(hessian, gradient[:size])
    return (step[:n] - step[n]) / gap, lowest


def energy(u, v, ac, h0, lever):
    """Π on the mesh; the lever feels a constant force from beyond it."""
    n = MESH.nodes.size
    strain = (u[:n] - v) @ MESH.stiffness @ (u[:n] - v) / (2 * ac) + lever * u[n] ** 2 / 2
    return strain + MESH.masses @ LAW.potential(h0 + GAPS + u[n] - u[:n])


surfaces = st.tuples(
    st.floats(8, 11).map(lambda x: 10**x),  # modulus
    st.floats(-3, 6).map(lambda x: x * Z0),  # height of the base
    st.floats(-3, 1).map(lambda x: x * Z0),  # depth of the memory
    st.floats(0.5, 3),  # its width
    st.one_of(  # stiffness of the lever, over 2πa²
        st.just(0.0), st.floats(-2, 3).map(lambda x: 10**x / (2 * np.pi * FRAME**2))
    ),
)


def settled(modulus, h0, depth, width, lever):
    """Inputs of an equilibrium and the stable shape the surface falls to from a gap of 1.1 z0."""
    v = depth / np.sqrt(1 + (MESH.nodes / width) ** 2)
    ac = FRAME / modulus
    u = np.append(np.minimum(v, h0 + GAPS - 1.1 * Z0), 0.0)
    before = energy(u, v, ac, h0, lever)
    iterations = descend(
        u,
        v,
        ac,
        h0 + GAPS,
        lever,
        RISE,
        MESH,
        PRESSURE,
        POTENTIAL,
        PARAMETERS,
        1e-9,
        new_room(MESH.nodes.size, RISE.size, 0),
    )
    assert iterations > 0
    return v, ac, u, before


@given(surfaces)
@settings(deadline=None, max_examples=100)
def test_surfaces_settle_in_a_minimum_of_the_energy(surface):
    h0, lever, n = surface[1], surface[4], MESH.nodes.size
    v, ac, u, before = settled(*surface)
    error, lowest = newton_step(u, v, ac, h0, lever)
    assert np.abs(error).max() < 1e-8
    assert lowest > 0
    gap = h0 + GAPS + u[n] - u[:n]
    tail = BEYOND * LAW.potential(gap[-1])
    after = energy(u, v, ac, h0, lever)
    assert after - min(0, tail) * abs(u[n]) <= before + 1e-9 * abs(before) + 2 * abs(tail * u[n])
    # The stationary point is the contact problem itself: u = v - c K p, and k q = F.
    pressure = LAW.pressure(gap)
    influenced = ac * np.linalg.solve(MESH.stiffness, MESH.masses * pressure)
    wanted = v - influenced
    assert np.allclose(u[:n], wanted, rtol=0, atol=1e-6 * (Z0 + np.abs(influenced).max()))
    if lever:
        force = MESH.masses @ pressure + tail
        assert lever * u[n] == pytest.approx(force, rel=1e-6, abs=1e-6 * abs(tail))
    else:
        assert u[n] == 0


def newton(u, v, ac, h0, lever=0.0, rest=0.0, accuracy=1e-7, clock=None):
    n = MESH.nodes.size
    work = np.empty((4, n + 1))
    if clock is None:
        clock = new_clock()
        clock["contraction"] = np.inf
    iterations = equilibrate(
        u, v, ac, h0 + GAPS, lever, rest, RISE,
        MESH, PRESSURE, PARAMETERS, 0.3 * Z0, accuracy, clock, np.empty((n + 1, n + 1)),
        work, np.empty((3, RISE.size)),
    )  # fmt: skip
    return iterations, work[0, :n], work[1, :n]


@given(surfaces, st.floats(-0.02, 0.02), seeds)
@settings(deadline=None, max_examples=100)
def test_newton_returns_to_a_stable_shape(surface, disturbance, seed):
    h0, lever, n = surface[1], surface[4], MESH.nodes.size
    v, ac, u, _ = settled(*surface)
    _, lowest = newton_step(u, v, ac, h0, lever)
    gap = h0 + GAPS + u[n] - u[:n]
    guess = u.copy()
    guess[:n] += min(1, 10 * lowest) * disturbance * gap * np.exp(-(MESH.nodes**2))
    iterations, found_gap, found_pressure = newton(guess, v, ac, h0, lever)
    if iterations < 0:
        # Near a fold the disturbed shape may already be unstable: that must be true then.
        assert lowest < 0.1
        return
    error, lowest = newton_step(guess, v, ac, h0, lever)
    assert np.abs(error).max() < 1e-8
    assert lowest > 0
    assert np.allclose(found_gap, h0 + GAPS + guess[n] - guess[:n], rtol=1e-12)
    scale = np.abs(LAW.pressure(found_gap)).max()
    assert np.allclose(found_pressure, LAW.pressure(found_gap), rtol=1e-7, atol=1e-7 * scale)


@pytest.mark.parametrize(("modulus", "needed"), [(1e8, 2), (1e10, 1), (1e13, 1)])
def test_newton_stops_after_one_iteration_where_a_second_is_known_to_bring_little(modulus, needed):
    """Of a soft contact it brings more; of a stiff one it moves no node, but may change p."""
    accuracy, clock = 1e-3, new_clock()
    v, ac, u, _ = settled(modulus, 0.5 * Z0, -Z0, 1.5, 0.0)
    gap = 0.5 * Z0 + GAPS - u[:-1]
    for disturbance, most in ((0.05, 3), (0.004, needed)):
        guess = u.copy()
        guess[:-1] += disturbance * gap * np.exp(-(MESH.nodes**2))
        iterations, found, pressure = newton(guess, v, ac, 0.5 * Z0, accuracy=accuracy, clock=clock)
        assert 1 <= iterations <= most
        assert np.abs(found / gap - 1).max() < accuracy
        scale = MESH.masses @ np.abs(LAW.pressure(gap))
        assert MESH.masses @ np.abs(pressure - LAW.pressure(gap)) < 5 * accuracy * scale
    assert clock["contraction"] > 0


def test_a_lever_bent_before_pulls_from_there():
    """κ (q − rest) = F: with the force of a far surface negligible, q stays at its rest."""
    u = np.zeros(MESH.nodes.size + 1)
    iterations, *_ = newton(u, u[:-1].copy(), FRAME / 1e10, 40 * Z0, 1e16, 2 * Z0)
    assert iterations > 0
    assert u[-1] == pytest.approx(2 * Z0, rel=1e-2)


def test_newton_refuses_unstable_and_pierced_guesses():
    n = MESH.nodes.size
    soft = FRAME / 1e7

    def attempt(h0):
        return newton(np.zeros(n + 1), np.zeros(n), soft, h0)[0]

    assert newton_step(np.zeros(n + 1), np.zeros(n), soft, 1.5 * Z0, 0.0)[1] < 0
    assert attempt(1.5 * Z0) < 0
    assert attempt(0.2 * Z0) < 0
    assert attempt(-Z0) < 0
    assert attempt(30 * Z0) > 0


def test_newton_refuses_a_lever_about_to_snap():
    """Stable on a stiff lever, not on one softer than the gradient of the attraction."""
    n, stiff = MESH.nodes.size, FRAME / 1e11
    total = MESH.masses @ slope(3 * Z0 + GAPS)
    assert total > 0
    for factor, stable in ((20.0, True), (0.3, False)):
        iterations, *_ = newton(np.zeros(n + 1), np.zeros(n), stiff, 3 * Z0, factor * total)
        assert (iterations > 0) == stable


def test_force_has_the_tail_of_a_flat_surface():
    # PHYSICS: F = (HR/6)(z0⁶/(4h⁸) - 1/h²) for all beyond the gap h; a rigid sample everywhere.
    for h0 in (1.2 * Z0, 3 * Z0, 8 * Z0):
        gap = h0 + GAPS
        found = tip_force(
            LAW.pressure(gap), gap, RISE, MESH, FRAME, PRESSURE, PARAMETERS,
            np.empty((3, RISE.size)),
        )  # fmt: skip
        exact = LAW.hamaker * R / 6 * (Z0**6 / (4 * h0**8) - 1 / h0**2)
        assert found == pytest.approx(exact, rel=1e-4)


def test_radius_of_a_gap():
    gap = Z0 * (0.5 + MESH.nodes**2)
    radius = find_radius(gap, MESH.nodes, 1.5 * Z0)
    assert radius == pytest.approx(1.0, abs=0.01)
    assert find_radius(gap, MESH.nodes, 0.4 * Z0) == 0
    assert find_radius(gap, MESH.nodes, 1e3 * Z0) == MESH.nodes[-1]


@given(st.floats(0.1, 3), st.floats(0.1, 3), st.floats(0.1, 3))
def test_extrapolation_continues_parabolas(step, last, before):
    times = np.array([0.0, -last, -last - before])
    weights = np.empty(3)
    for history in (1, 2, 3):
        find_extrapolation_weights(history, step, last, before, weights)
        for power in range(history):
            assert weights @ times**power == pytest.approx(step**power, rel=1e-9, abs=1e-9)


# Memory that rides with the edge


@pytest.mark.parametrize("to", [1.02, 1.3, 0.97, 0.8])
@pytest.mark.parametrize("step", [1e-3, 0.3, 8.0])
def test_a_load_that_rides_is_filtered_along_its_path(to, step):
    """At fixed ξ the load is f(ξ)(1 + b s) at every instant s of the step; a(s) is straight."""
    mesh = mesh_with_stiffness(unit_mesh(1e-3, 0.2, 8.0))
    tau, grows, start = np.array([1.0, 0.02]), 0.4, 1e-7
    compliance = np.array([1.0, 3.0, 0.5])

    def sharp(xi):
        return 1 / np.hypot(1, np.abs(xi) ** 3) + 0.3 * np.arctan((1 - xi**2) / 0.02)

    def relaxed(xi):
        return 1 / (1 + xi**2)

    n = mesh.nodes.size
    fields = np.zeros((MEMORY + 2, n))
    fields[LOAD], fields[MEMORY:] = sharp(mesh.nodes), relaxed(mesh.nodes)
    clock = new_clock()
    clock["frame"], clock["rides"], clock["history"], clock["taken"] = start, 1, 1, step
    known, gained, gain = np.empty((2, n)), np.empty((2, n)), np.empty((n, n))
    displaced, new = np.empty(n), (1 + grows) * sharp(mesh.nodes)
    follow_load(
        step, to * start, clock, compliance, tau, mesh, fields, np.zeros((2, 5)), 1, new, gain,
        known, gained, displaced, np.empty(6),
    )  # fmt: skip
    assert np.allclose(gain @ new, compliance[1:] @ gained, atol=1e-12)
    assert np.allclose(displaced, compliance[1:] @ (known + gained), atol=1e-12)
    for i in np.flatnonzero(mesh.nodes < 3)[::7]:
        radius = to * mesh.nodes[i]
        for m, k in enumerate(step / tau):
            points = np.clip((radius - 1) / (to - 1) + np.array([-0.02, 0, 0.02]), 0, 1)
            wanted = np.exp(-k) * relaxed(radius) + quad(
                lambda s, k=k, r=radius: k * np.exp(-k * (1 - s)) * (1 + grows * s)
                * sharp(r / (1 + s * (to - 1))),
                max(0.0, 1 - 40 / k), 1, points=points[points > max(0.0, 1 - 40 / k)], limit=400,
            )[0]  # fmt: skip
            assert known[m, i] + gained[m, i] == pytest.approx(wanted, abs=2e-4)


# Whole steps


def test_steps_equal_those_of_a_plain_newton_method():
    compliance = np.array([1 / 2e9, 1 / 0.2e9, 1 / 1e9])
    retardation = np.array([2e-7, 3e-6])
    step, count = 2e-8, 6
    motion = sa.Sine(1.5e-9, 0.3e-9, 1e6)
    height, height_parameters = motion.compiled_height
    profile, tip_parameters = TIP.compiled_profile
    parameters = Parameters(
        height_parameters, tip_parameters, PARAMETERS, compliance, retardation, np.empty(0)
    )
    controls = Controls(
        end=1.0, shortest_step=step / 10, longest_step=step, top_speed=1e-300, open_frame=FRAME,
        edge_gap=LAW.gap_of_largest_tension, open_gap=1.0, prediction=1e3, memory=1e3, force=1e3,
        newton=1e-11, slack=2.0, held=0.0, cover=0.0, least_frame=0.0, finest=0.0,
        coarsest=np.inf, most_tries=1e6, trigger=np.inf, ride_from=np.inf, trace_from=np.inf,
    )  # fmt: skip
    n, modes = MESH.nodes.size, retardation.size
    past = 0.2 / np.array([[3e-9], [1e-9]]) * np.array([[Z0], [-Z0]]) / (1 + MESH.nodes**2)
    gained = np.zeros((modes + 10, n))
    background = Background(
        past, FRAME, MESH.nodes[-1], MESH.edge_spacing, MESH.growth, 0.0, -1e-7, MESH.nodes, gained
    )
    fields, clock = np.zeros((MEMORY + modes, n)), new_clock()
    clock["step"], clock["history"] = step, 1
    clock["frame"] = clock["frame_earlier"] = clock["frame_earliest"] = FRAME
    clock["axis_gap"] = motion.height(0.0)
    records, shapes = np.zeros(count, RECORD_FIELDS), np.zeros((count, n))
    outcome, taken = advance(
        height, profile, PRESSURE, hold, remember_nothing, parameters, background, MESH, UNIFORM,
        controls, fields, clock, np.empty(0), np.zeros(modes), records, shapes,
        new_room(n, MESH.far.size, modes), np.empty(n + 2, np.int64),
    )  # fmt: skip
    assert outcome == FULL
    assert taken == count
    assert clock["time"] == pytest.approx(count * step)

    # u = -K (J_g p + Σ J_m w_m), w the pressure filtered exactly, K = frame·S⁻¹ on unit masses.
    K = FRAME * np.linalg.inv(MESH.stiffness) * MESH.masses
    first = [filtered(step / tau, [0.0, 1.0]) for tau in retardation]
    later = [filtered(step / tau, [-1.0, 0.0, 1.0]) for tau in retardation]
    p_before, p, w, u = None, np.zeros(n), np.zeros((modes, n)), np.zeros(n)
    for number in range(1, count + 1):
        standoff = motion.height(number * step) + GAPS
        known, share = np.empty((modes, n)), np.empty(modes)
        for m in range(modes):
            decay, weights = (first if number == 1 else later)[m]
            share[m] = weights[-1]
            known[m] = decay * w[m] + weights[-2] * p
            if number > 1:
                known[m] += weights[0] * p_before
        c = compliance[0] + compliance[1:] @ share
        faded = past * np.exp(-(number * step + 1e-7) / retardation)[:, None]
        v = -K @ (compliance[1:] @ known) - compliance[1:] @ faded
        for _ in range(30):
            gap = standoff - u
            residual = u - v + c * K @ LAW.pressure(gap)
            u = u - np.linalg.solve(np.eye(n) - c * K * slope(gap), residual)
        p_before, p = p, LAW.pressure(standoff - u)
        w = known + share[:, None] * p
        lag = p - w - np.linalg.solve(K, faded.T).T
        loss = (
            2
            * np.pi
            * FRAME**2
            * sum(
                compliance[m + 1] / retardation[m] * (MESH.masses * lag[m]) @ (K @ lag[m])
                for m in range(modes)
            )
        )
        end = standoff[-1] - u[-1]
        tail = LAW.hamaker * R / 6 * (Z0**6 / (4 * end**8) - 1 / end**2)
        force = 2 * np.pi * FRAME**2 * MESH.masses @ p + tail
        row = records[number - 1]
        scale = np.abs(u).max()
        assert np.abs(shapes[number - 1] - u).max() < 1e-10 * scale
        assert row["time"] == pytest.approx(number * step)
        assert row["height"] == pytest.approx(motion.height(number * step), rel=1e-12)
        assert row["force"] == pytest.approx(force, rel=1e-10)
        assert row["axis"] == pytest.approx(u[0], rel=1e-10)
        assert row["loss"] == pytest.approx(loss, rel=1e-8)
        assert row["frame"] == FRAME
        assert row["edge"] == row["jump"] == 0
    assert np.abs(fields[LOAD] - K @ p).max() < 1e-9 * np.abs(K @ p).max()
    for m in range(modes):
        assert np.abs(fields[MEMORY + m] - K @ w[m]).max() < 1e-9 * np.abs(K @ w[m]).max()
        assert np.abs(gained[2 + m] - fields[MEMORY + m]).max() < 1e-9 * np.abs(K @ w[m]).max()


def test_steps_stop_exactly_at_the_end():
    motion = sa.Sine(3e-9, 0.3e-9, 1e6)
    result = sa.force_distance(sa.Contact(TIP, sa.Elastic(1e9, 0.3), LAW), motion)
    assert result["time"].values[-1] == motion.breaks[-1]
    assert np.all(np.isin(motion.landmarks, result["time"].values))
    spline = CubicSpline(result["time"], result["force"])
    middle = (result["time"].values[1:] + result["time"].values[:-1]) / 2
    assert np.abs(spline(middle)).max() <= 1.01 * np.abs(result["force"].values).max()
