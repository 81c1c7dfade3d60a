"""Tips, surface laws, samples and motions: their formulas, and what they refuse."""

import itertools
from dataclasses import FrozenInstanceError, fields
from math import inf, nan, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

import softafm as sa
from softafm import bodies

positive = st.floats(-3, 3).map(lambda x: 10.0**x)
poisson = st.floats(-0.99, 0.5)
laws = st.builds(
    sa.LennardJones,
    hamaker=positive.map(lambda x: 1e-19 * x),
    z0=positive.map(lambda x: 3e-10 * x),
)
GOOD = {
    sa.Paraboloid: {"radius": 1e-8},
    sa.LennardJones: {"hamaker": 1e-19, "z0": 3e-10},
    sa.LennardJones.from_work_of_adhesion: {"W": 0.05, "z0": 3e-10},
    sa.Elastic: {"E": 1e9, "poisson": 0.3},
    sa.StandardLinearSolid: {"E0": 2e9, "E_inf": 1e8, "creep_time": 1e-5, "poisson": 0.3},
    sa.StandardLinearSolid.from_relaxation_time: {
        "E0": 2e9,
        "E_inf": 1e8,
        "relaxation_time": 1e-6,
        "poisson": 0.3,
    },
    sa.StandardLinearSolid.from_shear: {
        "G0": 1e9,
        "G_inf": 1e8,
        "creep_time": 1e-5,
        "poisson": 0.3,
    },
    sa.Triangle: {
        "start": 1e-8,
        "turn": -1e-9,
        "speed": 1e-6,
        "dwell": 1e-3,
        "setpoint_force": 1e-9,
    },
    sa.Triangle.from_frequency: {"mean_height": 1e-8, "amplitude": 1e-8, "frequency": 1.0},
    sa.Cantilever: {"stiffness": 28.1, "quality_factor": 430.0, "frequency": 278e3},
    sa.Sine: {"mean_height": 1e-8, "amplitude": 1e-8, "frequency": 1e5, "cycles": 2},
}
SIGNED = {"poisson", "start", "turn", "mean_height"}
OPTIONAL = {"setpoint_force", "quality_factor"}
MAY_BE_ZERO = {"dwell"}


def relaxed_times(sample, count=9):
    return np.geomspace(1e-3, 1e2, count) * sample.creep_time


# Surface laws


@given(laws, st.floats(0.7, 8))
@settings(deadline=None)
def test_pressure_is_minus_the_slope_of_the_potential(law, ratio):
    h, dh = ratio * law.z0, 1e-5 * law.z0
    slope = (law.potential(h + dh) - law.potential(h - dh)) / (2 * dh)
    scale = law.work_of_adhesion / law.z0
    assert law.pressure(h) == pytest.approx(-slope, rel=1e-7, abs=1e-7 * scale)


@given(laws)
@settings(deadline=None)
def test_work_of_adhesion_is_the_work_to_separate(law):
    # W = H/(16πz0²), Rajabifar et al. 2021, equation (6); in units of z0 and W.
    W, z0 = law.work_of_adhesion, law.z0
    work, _ = quad(lambda x: -law.pressure(x * z0) * z0 / W, 1, np.inf, epsabs=1e-12)
    assert work == pytest.approx(1, rel=1e-9)
    assert law.potential(z0) == pytest.approx(-W)
    assert law.pressure(z0) == pytest.approx(0, abs=1e-12 * W / z0)
    assert law.equilibrium_gap == z0
    assert law.pressure(0.9 * z0) > 0 > law.pressure(1.1 * z0)


@given(laws)
def test_tension_is_largest_where_the_law_says(law):
    gap = law.gap_of_largest_tension
    around = law.pressure(gap * np.linspace(0.8, 1.3, 2001))
    assert np.all(law.pressure(gap) <= around * (1 - 1e-12))
    assert law.pressure(gap) == pytest.approx(around.min(), rel=1e-6)


@pytest.mark.filterwarnings("ignore::softafm.errors.DoubtfulValueWarning")
@given(positive, positive)
def test_law_from_its_work_of_adhesion(w, z):
    law = sa.LennardJones.from_work_of_adhesion(W=0.05 * w, z0=3e-10 * z)
    assert law.work_of_adhesion == pytest.approx(0.05 * w, rel=1e-14)
    assert law.z0 == 3e-10 * z
    again = sa.LennardJones(law.hamaker, law.z0)
    assert again == law


@given(laws, st.lists(st.floats(0.6, 50), min_size=2, max_size=30), st.integers(1, 30))
@settings(deadline=None)
def test_compiled_law_equals_the_readable_one(law, ratios, count):
    pressure, potential, parameters = law.compiled_pressure
    gap = law.z0 * np.array(ratios)
    n = min(count, gap.size)
    p, slope, phi = (np.full(gap.size, 7.0) for _ in range(3))
    pressure(gap, parameters, p, slope, n)
    potential(gap, parameters, phi, n)
    W, z0 = law.work_of_adhesion, law.z0
    assert p[:n] == pytest.approx(law.pressure(gap[:n]), rel=1e-11, abs=1e-14 * W / z0)
    assert phi[:n] == pytest.approx(law.potential(gap[:n]), rel=1e-11, abs=1e-14 * W)
    near, far = (
        (law.pressure(gap[:n] * (1 + x)) - law.pressure(gap[:n] * (1 - x))) / (2 * x * gap[:n])
        for x in (5e-4, 1e-3)
    )
    numeric = (4 * near - far) / 3
    assert slope[:n] == pytest.approx(numeric, rel=1e-7, abs=1e-9 * W / z0**2)
    for beyond in (p[n:], slope[n:], phi[n:]):
        assert np.all(beyond == 7.0)


# Tips


@given(positive, st.lists(st.floats(0, 10), min_size=1, max_size=20))
@settings(deadline=None)
def test_paraboloid(scale, radii):
    tip = sa.Paraboloid(1e-8 * scale)
    r = tip.radius * np.array(radii)
    assert tip.profile(0.0) == 0
    assert tip.profile(tip.radius) == pytest.approx(tip.radius / 2)
    assert tip.profile(r) == pytest.approx(r**2 / (2 * tip.radius))
    compiled, parameters = tip.compiled_profile
    out = np.empty(r.size)
    compiled(r, parameters, out, r.size)
    assert out == pytest.approx(tip.profile(r), rel=1e-14)


# Samples


@given(positive, st.floats(0.01, 1), positive, poisson)
def test_creep_from_the_short_to_the_long_term_modulus(E0, ratio, creep_time, nu):
    sample = sa.StandardLinearSolid(E0, E0 * ratio, creep_time, nu)
    creep = sample.compliance
    reduced = 1 - nu**2
    assert creep.at(0.0) == pytest.approx(1 / sample.E0)
    assert creep.at(1e3 * creep_time) == pytest.approx(1 / sample.E_inf)
    assert creep.relaxed == pytest.approx(1 / sample.E_inf)
    half_space = bodies.HalfSpace(sample)
    assert half_space.compliance.relaxed == pytest.approx(reduced / sample.E_inf)
    assert half_space.compliance.at(creep_time) == pytest.approx(reduced * creep.at(creep_time))
    assert sample.reduced_modulus_instantaneous == pytest.approx(sample.E0 / reduced)
    assert sample.reduced_modulus_relaxed == pytest.approx(sample.E_inf / reduced)
    # Rajabifar et al. 2021, equation (4): a share 1 - 1/e of the creep is done at τ.
    done = creep.at(creep_time) - creep.at(0.0)
    assert done == pytest.approx((creep.relaxed - creep.at(0.0)) * -np.expm1(-1), abs=1e-12)


def test_creep_of_arrays_of_times_has_their_shape():
    creep = sa.StandardLinearSolid(2e9, 1e8, 1e-5, 0.3).compliance
    times = np.linspace(0, 5e-5, 12).reshape(3, 4)
    assert creep.at(times).shape == (3, 4)
    assert np.all(np.diff(creep.at(times.ravel())) > 0)


@given(positive, st.floats(0.01, 0.99), positive, st.floats(0.01, 100))
def test_relaxation_time_is_that_of_stress_at_constant_strain(E0, ratio, relaxation_time, rate):
    # Creep compliance J and relaxation modulus E of one solid obey s J(s) · s E(s) = 1. For
    # E(t) = E_inf + (E0 - E_inf) exp(-t/τσ), s E(s) = E_inf + (E0 - E_inf) s τσ/(1 + s τσ).
    E_inf = E0 * ratio
    sample = sa.StandardLinearSolid.from_relaxation_time(E0, E_inf, relaxation_time, 0.3)
    assert (sample.E0, sample.E_inf, sample.poisson) == (E0, E_inf, 0.3)
    s = rate / relaxation_time
    share = s * relaxation_time / (1 + s * relaxation_time)
    modulus = E_inf + (E0 - E_inf) * share
    creep = sample.compliance
    compliance = creep.instantaneous + np.sum(creep.elements / (1 + s * creep.retardation_times))
    assert compliance * modulus == pytest.approx(1, rel=1e-12)


def test_stress_relaxation_by_the_volterra_equation():
    # ∫ J(t - t') dE(t') = 1 for all t: a strain step, stress solved for step by step.
    E0, E_inf, relaxation_time = 5.0, 1.0, 2.0
    sample = sa.StandardLinearSolid.from_relaxation_time(E0, E_inf, relaxation_time, 0.0)
    creep = sample.compliance.at
    time = np.linspace(0, 8, 801)
    middle = (time[1:] + time[:-1]) / 2
    stress = np.empty(time.size)
    stress[0] = 1 / creep(0.0)
    for i in range(1, time.size):
        past = creep(time[i]) * stress[0]
        past += creep(time[i] - middle[: i - 1]) @ np.diff(stress[:i])
        stress[i] = stress[i - 1] + (1 - past) / creep(time[i] - middle[i - 1])
    exact = E_inf + (E0 - E_inf) * np.exp(-time / relaxation_time)
    assert stress == pytest.approx(exact, rel=1e-4)


@given(positive, st.floats(0.01, 1), poisson)
def test_shear_moduli(G0, ratio, nu):
    sample = sa.StandardLinearSolid.from_shear(G0, G0 * ratio, 1e-3, nu)
    assert sample.E0 / (2 * (1 + nu)) == pytest.approx(G0)
    assert sample.E_inf / (2 * (1 + nu)) == pytest.approx(G0 * ratio)
    # Incompressible: a reduced modulus of 4G.
    rubber = sa.StandardLinearSolid.from_shear(G0, G0 * ratio, 1e-3, 0.5)
    assert rubber.reduced_modulus_instantaneous == pytest.approx(4 * G0)


@given(positive, st.floats(0.01, 0.99), positive, poisson)
def test_chain_of_one_is_the_standard_linear_solid(E0, ratio, creep_time, nu):
    solid = sa.StandardLinearSolid(E0, E0 * ratio, creep_time, nu)
    chain = sa.GeneralizedKelvinVoigt(
        E0, (1 / solid.E_inf - 1 / solid.E0,), (creep_time,), poisson=nu
    )
    times = relaxed_times(solid)
    assert chain.compliance.at(times) == pytest.approx(solid.compliance.at(times))


@given(st.lists(st.tuples(positive, positive), min_size=1, max_size=5), poisson)
def test_chain_adds_its_elements(elements, nu):
    compliances, times = zip(*elements, strict=True)
    chain = sa.GeneralizedKelvinVoigt(2.0, compliances, times, poisson=nu)
    creep = chain.compliance
    assert creep.at(0.0) == pytest.approx(1 / 2.0)
    assert creep.at(1e3 * max(times)) == pytest.approx(1 / 2.0 + sum(compliances))
    assert chain.reduced_modulus_relaxed == pytest.approx(1 / (1 - nu**2) / creep.relaxed)
    shuffled = sa.GeneralizedKelvinVoigt(2.0, compliances[::-1], times[::-1], poisson=nu)
    at = np.geomspace(1e-4, 1e4, 15)
    assert shuffled.compliance.at(at) == pytest.approx(creep.at(at))


@given(positive, poisson)
def test_equal_moduli_and_empty_chains_are_elastic(E, nu):
    for sample in (
        sa.Elastic(E, nu),
        sa.StandardLinearSolid(E, E, 1.0, nu),
        sa.GeneralizedKelvinVoigt(E, (), (), nu),
    ):
        creep = sample.compliance
        assert creep.at(np.array([0.0, 1.0, 1e9])) == pytest.approx(1 / E)
        assert sample.reduced_modulus_relaxed == pytest.approx(E / (1 - nu**2))


# Motions

motions = st.one_of(
    st.builds(
        lambda turn, depth, speed, rest: sa.Triangle(
            *(1e-9 * (turn + depth), 1e-9 * turn, 1e-6 * speed), dwell=rest * 1e-3 * depth / speed
        ),
        st.floats(-20, 20),
        st.floats(0.1, 50),
        positive,
        st.one_of(st.just(0.0), st.floats(0.01, 10)),
    ),
    st.builds(
        lambda mean, amplitude, frequency, cycles: sa.Sine(
            1e-9 * mean, 1e-9 * amplitude, 1e5 * frequency, cycles
        ),
        st.floats(-20, 20),
        st.floats(0.1, 50),
        positive,
        st.integers(1, 5),
    ),
    st.builds(
        lambda start, steps, heights, smooth: sa.Trajectory(
            start + np.concatenate([[0], np.cumsum(steps)]), 1e-9 * np.array(heights), smooth
        ),
        st.floats(-10, 10),
        st.lists(st.floats(0.01, 10), min_size=7, max_size=7),
        st.lists(st.integers(-20000, 20000), min_size=8, max_size=8)
        .filter(lambda h: np.all(np.diff(h) != 0))
        .map(lambda h: [1e-3 * x for x in h]),
        st.booleans(),
    ),
)


@given(motions, st.lists(st.floats(0, 1), min_size=1, max_size=20))
@settings(deadline=None)
def test_compiled_height_equals_the_readable_one(motion, parts):
    compiled, parameters = motion.compiled_height
    first, last = motion.breaks[[0, -1]]
    for part in [0.0, 1.0, *parts]:
        time = min(first + part * (last - first), last)
        assert compiled(time, parameters) == pytest.approx(
            float(motion.height(time)), rel=1e-9, abs=1e-20
        )


@given(motions, st.floats(0.001, 0.999))
def test_velocity_is_the_slope_of_the_height(motion, part):
    for a, b in zip(motion.breaks, motion.breaks[1:], strict=False):
        edges = motion.time if isinstance(motion, sa.Trajectory) else np.array([a, b])
        i = min(int(part * (edges.size - 1)), edges.size - 2)
        share = 0.05 + 0.9 * (part * (edges.size - 1) - i)
        step = 1e-4 * (edges[i + 1] - edges[i]) / getattr(motion, "cycles", 1)
        t = edges[i] + share * (edges[i + 1] - edges[i])
        slope = (motion.height(t + step) - motion.height(t - step)) / (2 * step)
        assert float(motion.velocity(t)) == pytest.approx(
            float(slope), rel=1e-5, abs=1e-6 * motion.top_speed
        )


@given(motions)
def test_top_speed_bounds_the_velocity(motion):
    time = np.linspace(*motion.breaks[[0, -1]], 2001)
    fastest = np.abs(motion.velocity(time)).max()
    if isinstance(motion, sa.Trajectory):
        # The instants may miss a short piece that is the fastest.
        assert fastest <= motion.top_speed * (1 + 1e-9)
        assert np.abs(motion.velocity(motion.time)).max() <= motion.top_speed * (1 + 1e-9)
    else:
        assert fastest == pytest.approx(motion.top_speed, rel=1e-3)


@given(motions, st.floats(0, 1), st.floats(0, 1))
def test_top_speed_for_a_while_bounds_the_velocity_then(motion, one, other):
    if isinstance(motion, sa.Sine) or one == other:
        return
    first, last = motion.breaks[[0, -1]]
    start, end = (first + part * (last - first) for part in sorted((one, other)))
    if not start < end:
        return
    bound = motion.top_speed_between(start, end)
    time = np.linspace(start, end, 501)[1:-1]
    assert np.abs(motion.velocity(time)).max() <= bound * (1 + 1e-9)
    assert bound <= motion.top_speed


@given(motions)
def test_breaks_and_landmarks_are_times_of_the_motion(motion):
    assert np.all(np.diff(motion.breaks) > 0)
    assert np.all(np.diff(motion.landmarks) > 0)
    assert np.all(motion.breaks[0] < motion.landmarks)
    assert np.all(motion.landmarks < motion.breaks[-1])
    # Between these times the height is monotonic, so no extreme is missed.
    stops = np.union1d(motion.breaks, motion.landmarks)
    for a, b in itertools.pairwise(stops):
        height = motion.height(np.linspace(a, b, 50))
        steps = np.diff(height)
        slack = 1e-12 * np.ptp(height) + 1e-22
        assert np.all(steps <= slack) or np.all(steps >= -slack)


def test_triangle_and_sine_pass_their_named_points():
    triangle = sa.Triangle(start=10e-9, turn=-5e-9, speed=1e-6)
    assert triangle.breaks == pytest.approx([0, 15e-3, 30e-3])
    assert triangle.height(triangle.breaks) == pytest.approx([10e-9, -5e-9, 10e-9])
    assert triangle.velocity([1e-3, 29e-3]) == pytest.approx([-1e-6, 1e-6])
    sine = sa.Sine(mean_height=10e-9, amplitude=4e-9, frequency=100.0, cycles=2)
    assert sine.breaks == pytest.approx([0, 0.02])
    assert sine.landmarks == pytest.approx([0.005, 0.01, 0.015])
    assert sine.height([0, 0.0025, 0.005, 0.02]) == pytest.approx([14e-9, 10e-9, 6e-9, 14e-9])


def test_a_ramp_rests_at_its_lowest_height():
    ramp = sa.Triangle(start=10e-9, turn=-5e-9, speed=1e-6, dwell=4e-3)
    assert ramp.breaks == pytest.approx([0, 15e-3, 19e-3, 34e-3])
    assert ramp.height(ramp.breaks) == pytest.approx([10e-9, -5e-9, -5e-9, 10e-9])
    assert np.all(ramp.height(np.linspace(15.001e-3, 18.999e-3, 50)) == -5e-9)
    assert ramp.velocity([1e-3, 17e-3, 30e-3]) == pytest.approx([-1e-6, 0, 1e-6])
    assert ramp.velocity(ramp.breaks[:-1]) == pytest.approx([-1e-6, 0, 1e-6])


def test_a_ramp_turned_on_its_way_keeps_its_start_speed_and_rest():
    ramp = sa.Triangle(10e-9, -5e-9, 1e-6, dwell=4e-3, setpoint_force=1e-9)
    turned = ramp.turned_at(12e-3)
    assert turned == sa.Triangle(10e-9, turned.turn, 1e-6, dwell=4e-3)
    assert turned.breaks == pytest.approx([0, 12e-3, 16e-3, 28e-3])
    before = np.linspace(0, 12e-3, 20)
    assert turned.height(before) == pytest.approx(ramp.height(before))


@given(st.floats(-100, 100), positive, positive)
def test_a_triangular_wave_lasts_a_period(mean, amplitude, frequency):
    mean, amplitude = 1e-9 * mean, 1e-7 * amplitude
    wave = sa.Triangle.from_frequency(mean, amplitude, frequency, dwell=0.0)
    assert wave.breaks[-1] == pytest.approx(1 / frequency, rel=1e-6)
    highest, lowest = mean + amplitude, mean - amplitude
    rounding = 1e-12 * amplitude  # where mean and amplitude cancel
    assert wave.height(wave.breaks) == pytest.approx([highest, lowest, highest], abs=rounding)


def test_a_triangular_wave_takes_the_options_of_a_ramp():
    wave = sa.Triangle.from_frequency(0.0, 1e-8, 1.0, dwell=0.2, setpoint_force=1e-9)
    assert (wave.dwell, wave.setpoint_force) == (0.2, 1e-9)
    assert wave.speed == pytest.approx(4e-8)
    assert wave.breaks[-1] == pytest.approx(1.2)


@pytest.mark.parametrize("smooth", [False, True])
def test_trajectory_passes_its_samples_and_does_not_overshoot(smooth):
    time = np.array([-1.0, 0.0, 0.5, 2.0, 2.1])
    heights = np.array([5.0, 1.0, 1.0, 4.0, 3.9]) * 1e-9
    motion = sa.Trajectory(time, heights, smooth)
    assert motion.height(time) == pytest.approx(heights)
    fine = motion.height(np.linspace(-1, 2.1, 1001))
    assert fine.min() >= 1e-9 * (1 - 1e-12)
    assert fine.max() <= 5e-9 * (1 + 1e-12)
    assert motion.landmarks == pytest.approx([0.0, 2.0])
    time[0], heights[0] = -5, 0  # the caller's arrays stay the caller's
    assert motion.breaks[0] == -1
    assert motion.height(-1.0) == pytest.approx(5e-9)
    with pytest.raises(ValueError, match="read-only"):
        motion.heights[0] = 0


def test_trajectories_compare_by_value():
    same = [sa.Trajectory([0, 1, 2], [3e-9, 2e-9, 3e-9]) for _ in range(2)]
    other = sa.Trajectory([0, 1, 2], [3e-9, 2e-9, 4e-9])
    assert same[0] == same[1]
    assert hash(same[0]) == hash(same[1])
    assert same[0] != other
    assert same[0] != "a trajectory"
    assert "3 points" in repr(other)


# Refusals

CASES = [(build, field) for build, values in GOOD.items() for field in values]
NAMES = [f"{build.__qualname__}-{field}" for build, field in CASES]


def is_number(text):
    try:
        return np.isfinite(float(text))
    except ValueError:
        return False


not_numbers = st.one_of(
    st.sampled_from([nan, inf, -inf, None, "", "10 nm", "soft", [1e-9, 2e-9], {}, 1j]),
    st.text(max_size=5).filter(lambda text: not is_number(text)),
)
not_positive = st.one_of(st.just(0), st.just(-0.0), st.floats(max_value=0, allow_nan=False))


def refusal(build, **values):
    """The message with which ``build`` refuses ``values``."""
    with pytest.raises(ValueError, match=r".") as caught:
        build(**values)
    return str(caught.value)


def assert_one_line_naming(field, message):
    assert message.startswith(field)
    assert len(message.splitlines()) == 1
    assert "must" in message


@pytest.mark.parametrize(("build", "field"), CASES, ids=NAMES)
@given(data=st.data())
@settings(max_examples=25, deadline=None)
def test_what_is_no_number_is_refused(build, field, data):
    optional = field in OPTIONAL or (build, field) == (sa.Cantilever, "frequency")
    value = data.draw(not_numbers.filter(lambda x: x is not None or not optional))
    message = refusal(build, **{**GOOD[build], field: value})
    assert_one_line_naming(field, message)


@pytest.mark.parametrize(("build", "field"), [c for c in CASES if c[1] not in SIGNED])
@given(data=st.data())
@settings(max_examples=15, deadline=None)
def test_what_is_not_positive_is_refused(build, field, data):
    value = data.draw(not_positive.filter(lambda x: x != 0 or field not in MAY_BE_ZERO))
    message = refusal(build, **{**GOOD[build], field: value})
    assert_one_line_naming(field, message)


@given(st.one_of(st.floats(max_value=-1), st.floats(min_value=0.5, exclude_min=True)))
def test_impossible_poisson_ratios_are_refused(nu):
    for build, values in GOOD.items():
        if "poisson" in values:
            assert_one_line_naming("poisson", refusal(build, **{**values, "poisson": nu}))
    chain = {"E0": 1e9, "compliances": (1e-9,), "retardation_times": (1.0,)}
    assert_one_line_naming("poisson", refusal(sa.GeneralizedKelvinVoigt, **chain, poisson=nu))


@given(positive, st.floats(1.0001, 1e6))
def test_a_solid_that_stiffens_as_it_relaxes_is_refused(E0, factor):
    values = {"E0": E0, "E_inf": E0 * factor, "creep_time": 1.0, "poisson": 0.3}
    assert_one_line_naming("E_inf", refusal(sa.StandardLinearSolid, **values))


@given(
    st.sampled_from(["E0", "compliances", "retardation_times"]),
    st.sampled_from([0, 1]),
    st.one_of(not_positive, not_numbers),
)
@settings(deadline=None)
def test_bad_chains_are_refused(field, index, bad):
    good = {"E0": 1e9, "compliances": [1e-9, 2e-9], "retardation_times": [1.0, 2.0]}
    if field == "E0":
        named, values = "E0", {**good, "E0": bad}
    else:
        named, entries = f"{field}[{index}]", list(good[field])
        entries[index] = bad
        values = {**good, field: entries}
    assert_one_line_naming(named, refusal(sa.GeneralizedKelvinVoigt, **values, poisson=0.3))


def test_chains_of_unequal_lengths_are_refused():
    values = {"E0": 1e9, "compliances": [1e-9], "retardation_times": [1.0, 2.0], "poisson": 0.3}
    assert_one_line_naming("retardation_times", refusal(sa.GeneralizedKelvinVoigt, **values))


@pytest.mark.parametrize("cycles", [0, -1, 1.5, True, "2", None, nan, inf])
def test_cycles_are_whole(cycles):
    message = refusal(sa.Sine, **{**GOOD[sa.Sine], "cycles": cycles})
    assert_one_line_naming("cycles", message)


def test_whole_floats_count_cycles():
    assert sa.Sine(1e-8, 1e-9, 1e5, 3.0).cycles == 3


@pytest.mark.filterwarnings("ignore::softafm.errors.DoubtfulValueWarning")
@given(st.floats(-0.5, 0.5), st.floats(0, 0.5))
def test_a_turn_above_the_start_is_refused(start, rise):
    message = refusal(sa.Triangle, start=start, turn=start + rise, speed=1.0)
    assert_one_line_naming("turn", message)


@given(
    st.lists(st.floats(-10, 10), min_size=2, max_size=10),
    st.integers(0, 9),
    st.sampled_from([nan, inf, -inf]),
    st.booleans(),
)
def test_trajectories_with_gaps_are_refused(heights, index, bad, in_time):
    index %= len(heights)
    time = np.arange(float(len(heights)))
    (time if in_time else heights)[index] = bad
    name = f"{'time' if in_time else 'height'}[{index}]"
    assert_one_line_naming(name, refusal(sa.Trajectory, time=time, height=heights))


@given(st.lists(st.floats(-10, 10), min_size=2, max_size=10))
def test_trajectories_whose_times_do_not_increase_are_refused(time):
    if np.all(np.diff(time) > 0):
        time = time[::-1]
    message = refusal(sa.Trajectory, time=time, height=np.zeros(len(time)))
    first = int(np.flatnonzero(np.diff(time) <= 0)[0]) + 1
    assert_one_line_naming(f"time[{first}]", message)


@pytest.mark.parametrize(
    ("time", "height"),
    [
        ([], []),
        ([0.0], [1.0]),
        ([0.0, 1.0], [1.0]),
        ([[0.0, 1.0], [2.0, 3.0]], [[1.0, 1.0], [1.0, 1.0]]),
        (0.0, 1.0),
        (None, None),
        ([0.0, "late"], [1.0, 1.0]),
        ([0.0, 1.0], [1.0, "high"]),
        ([[0.0], [1.0, 2.0]], [1.0, 1.0]),
    ],
)
def test_misshapen_trajectories_are_refused(time, height):
    message = refusal(sa.Trajectory, time=time, height=height)
    assert len(message.splitlines()) == 1
    assert "time" in message or "height" in message


@pytest.mark.parametrize("build", [b for b in GOOD if isinstance(b, type)])
def test_objects_are_frozen(build):
    thing = build(**GOOD[build])
    with pytest.raises(FrozenInstanceError):
        setattr(thing, fields(thing)[0].name, 1.0)
    assert thing == build(**GOOD[build])
    assert hash(thing) == hash(build(**GOOD[build]))


# Contacts and what modes refuse


def lab(E=1e9):
    return sa.Contact(
        sa.Paraboloid(1e-8), sa.Elastic(E, 0.0), sa.LennardJones.from_work_of_adhesion(0.05, 3e-10)
    )


def test_scales_of_a_contact():
    # μ = (R W²/(E² z0³))^(1/3) and ℓ = E z0²/W.
    contact = lab()
    assert contact.tabor_relaxed == pytest.approx((1e-8 * 0.05**2 / (1e18 * 27e-30)) ** (1 / 3))
    assert contact.cohesive_length == pytest.approx(1e9 * 9e-20 / 0.05)
    soft = sa.Contact(contact.tip, sa.StandardLinearSolid(8e9, 1e9, 1.0, 0.0), contact.surface)
    assert soft.tabor_relaxed == pytest.approx(4 * soft.tabor_instantaneous)
    assert soft.cohesive_length_instantaneous == pytest.approx(8 * soft.cohesive_length)


def test_steepest_attraction_is_that_of_the_tip_above_the_flat_surface():
    contact = lab()
    R, z0 = 1e-8, 3e-10

    def force(height):
        pressed = quad(
            lambda x: x * float(contact.surface.pressure(height + (x * z0) ** 2 / (2 * R))), 0, 200
        )
        return 2 * pi * z0**2 * pressed[0]

    heights = z0 * np.linspace(1.05, 1.4, 36)
    slopes = np.diff([force(height) for height in heights]) / np.diff(heights)
    assert contact.steepest_attraction == pytest.approx(slopes.max(), rel=2e-3)


def test_cantilevers_need_no_resonance_to_bend():
    lever = sa.Cantilever(2)
    assert (lever.stiffness, lever.quality_factor, lever.frequency) == (2.0, None, None)
    for other in (None, 2.0, sa.Triangle(4e-9, 1e-9, 1e-6)):
        with pytest.raises(ValueError, match=r"^cantilever = .*: must be a softafm.Cantilever"):
            sa.force_spectroscopy(lab(), other, sa.Triangle(4e-9, 1e-9, 1e-6))


@pytest.mark.parametrize("solver", [sa.solvers.Attard(), sa.solvers.EnhancedAttard()])
def test_fixed_steps_refuse_setpoints(solver):
    ramp, lever = sa.Triangle(4e-9, 1e-9, 1e-6, setpoint_force=1e-9), sa.Cantilever(2.0)
    with pytest.raises(ValueError, match=r"^setpoint_force = 1e-09 N: the solver"):
        sa.force_spectroscopy(lab(), lever, ramp, solver=solver)
    with pytest.raises(ValueError, match=r"^setpoint_force = 1e-09 N: the solver"):
        sa.force_distance(lab(), ramp, solver=solver)


def test_expected_contact_radius_is_that_of_jkr():
    # At zero load a³ = 6πR²W·3/(4E) and -h0 = a²/(3R); at the snap a³ = πR²W/(8E), h0 > 0.
    contact = lab()
    R, W, E = 1e-8, 0.05, 1e9
    unloaded = (4.5 * pi * R**2 * W / E) ** (1 / 3)
    assert contact.contact_radius(-(unloaded**2) / (3 * R)) == pytest.approx(unloaded)
    last = (pi * R**2 * W / (8 * E)) ** (1 / 3)
    breaks_at = 3 * last**2 / R
    assert contact.contact_radius(breaks_at * (1 - 1e-8)) == pytest.approx(last, rel=1e-3)
    assert contact.contact_radius(breaks_at * (1 + 1e-8)) == 0
    # Deep in, Hertz: a² = R·indentation, up to the adhesion.
    assert contact.contact_radius(-R) == pytest.approx(R, rel=0.1)


@given(st.floats(-5, 5))
def test_contacts_shrink_as_the_tip_rises(height):
    radii = [lab().contact_radius(1e-9 * (height + rise)) for rise in (0, 0.1, 0.2)]
    assert radii[0] >= radii[1] >= radii[2] >= 0


@pytest.mark.parametrize("tolerance", [0, -1e-3, 1e-6, 0.2, 1, nan, inf, None, "tight"])
def test_tolerances_out_of_range_are_refused(tolerance):
    with pytest.raises(ValueError, match=r"^tolerance") as caught:
        sa.force_distance(lab(), sa.Triangle(5e-9, 1e-9, 1e-6), tolerance=tolerance)
    assert_one_line_naming("tolerance", str(caught.value))
    with pytest.raises(ValueError, match=r"^tolerance"):
        sa.tapping_cycle(lab(), 2e-9, 4e-9, 1e5, tolerance=tolerance)


@given(st.floats(-10, 1))
@settings(deadline=None)
def test_a_start_inside_the_surface_is_refused(ratio):
    start, z0 = ratio * 3e-10, 3e-10
    assert start <= z0
    for motion in (
        sa.Triangle(start, start - 1e-9, 1e-6),
        sa.Sine(start - 1e-9, 1e-9, 1e5),
        sa.Trajectory([0, 1], [start, 5e-9]),
    ):
        if float(motion.height(motion.breaks[0])) > z0:
            continue  # the sum of mean and amplitude has been rounded up
        with pytest.raises(ValueError, match=r"^start height = .* m: must be above") as caught:
            sa.force_distance(lab(), motion)
        assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("amplitude", -1e-9),
        ("amplitude", nan),
        ("mean_height", inf),
        ("frequency", 0.0),
        ("frequency", None),
        ("cycles", 0),
        ("cycles", 2.5),
    ],
)
def test_taps_with_bad_numbers_are_refused(field, value):
    values = {"amplitude": 2e-9, "mean_height": 4e-9, "frequency": 1e5, "cycles": 1, field: value}
    with pytest.raises(ValueError, match=rf"^{field}") as caught:
        sa.tapping_cycle(lab(), **values)
    assert_one_line_naming(field, str(caught.value))
