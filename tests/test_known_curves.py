"""Known answers of whole curves: JKR, Maugis-Dugdale, Lee and Radok, Ting."""

from dataclasses import dataclass
from math import acos, inf, pi, radians, sqrt, tan
from typing import ClassVar

import numpy as np
import pytest
from scipy.integrate import trapezoid
from scipy.optimize import brentq, minimize_scalar
from scipy.special import beta, dawsn

import softafm as sa
from softafm import indentation, tips
from softafm.bodies import HalfSpace, Layered

R, W, E = 100e-9, 0.05, 1e9
PARABOLOID = sa.Paraboloid(R)
PULL = pi * R * W

# JKR


def test_jkr_parts_at_the_forces_of_load_and_grip_control():
    # Johnson, Kendall and Roberts 1971: −3/2 πWR at a fixed load, −5/6 at fixed grips, where
    # a³ = πWR²/8E* and δ = −3a²/R.
    load = indentation.jkr_parting(PARABOLOID, E, W, 0)
    assert load.force / PULL == pytest.approx(-1.5, rel=1e-9)
    grips = indentation.jkr_parting(PARABOLOID, E, W)
    last = (pi * W * R**2 / (8 * E)) ** (1 / 3)
    assert grips.force / PULL == pytest.approx(-5 / 6, rel=1e-5)
    assert grips.contact_radius == pytest.approx(last, rel=1e-5)
    assert grips.depth == pytest.approx(-3 * last**2 / R, rel=1e-9)


@pytest.mark.parametrize("stiffness", [0.1, 3.0, 40.0])
def test_jkr_on_a_lever_parts_where_its_slope_is_that_of_the_lever(stiffness):
    # Of a paraboloid dδ = (2a/R − x) da and dF = 2E*(2a²/R − 3ax) da, with x = √(πW/(2E*a)): it
    # parts where dF/dδ = −k.
    def excess(a):
        x = sqrt(pi * W / (2 * E * a))
        return 2 * E * (2 * a**2 / R - 3 * a * x) + stiffness * (2 * a / R - x)

    radius = brentq(excess, 1e-10, 1e-7, xtol=1e-20)
    parting = indentation.jkr_parting(PARABOLOID, E, W, stiffness)
    assert parting.contact_radius == pytest.approx(radius, rel=1e-5)
    load, grips = (indentation.jkr_parting(PARABOLOID, E, W, k) for k in (0, inf))
    assert load.force < parting.force < grips.force


def test_a_jkr_curve_holds_both_branches_up_to_its_depth():
    curve = indentation.jkr(PARABOLOID, E, W, 20e-9)
    assert curve.depth[-1] == pytest.approx(20e-9, rel=1e-9)
    assert curve.force[0] == curve.depth[0] == curve.contact_radius[0] == 0
    assert np.all(np.diff(curve.contact_radius) > 0)
    assert np.array_equal(curve.height, -curve.depth)
    a = curve.contact_radius
    force = 4 / 3 * E * a**3 / R - np.sqrt(8 * pi * E * W * a**3)
    assert curve.force == pytest.approx(force, abs=1e-9 * PULL)
    last = indentation.jkr_parting(PARABOLOID, E, W)
    falling = a <= last.contact_radius
    assert np.all(np.diff(curve.depth[falling]) < 0)
    assert np.all(np.diff(curve.depth[~falling]) > 0)


def test_a_sharp_cone_in_jkr_follows_maugis_and_barquins():
    # F = (π/2)E*a² cot α − √(8πE*Wa³) is least at √a = 3√(8πE*W)/(2πE* cot α): there
    # F = −54 W² tan³α/(πE*) (Maugis and Barquins 1981).
    angle = radians(60)
    parting = indentation.jkr_parting(tips.Cone(angle, 1e-14), E, W, 0)
    assert parting.force == pytest.approx(-54 * W**2 * tan(angle) ** 3 / (pi * E), rel=1e-5)


def test_a_sphere_in_jkr_parts_at_its_least_force():
    least = minimize_scalar(
        lambda a: float(indentation.jkr_load(tips.Sphere(R), a, E, W)), (1e-9, 1.2e-8, 4e-8)
    )
    found = indentation.jkr_parting(tips.Sphere(R), E, W, 0)
    assert found.force == pytest.approx(least.fun, rel=1e-7)


def test_jkr_refuses_what_cannot_be():
    with pytest.raises(ValueError, match=r"^deepest = -1e-07 m: must be above -\S+e-09 m, where"):
        indentation.jkr(PARABOLOID, E, W, -1e-7)
    with pytest.raises(ValueError, match=r"^stiffness = -1 N/m: must be 0 \(fixed load\)"):
        indentation.jkr_parting(PARABOLOID, E, W, -1)
    with pytest.raises(ValueError, match=r"^stiffness = nan N/m"):
        indentation.jkr_parting(PARABOLOID, E, W, float("nan"))


def test_dmt_is_hertz_less_its_pull_off():
    depth = np.array([-1e-9, 0.0, 5e-9])
    hertz = indentation.hertz_force(R, depth, E)
    expected = hertz - np.array([0, 2 * PULL, 2 * PULL])
    assert indentation.dmt_force(R, depth, E, W) == pytest.approx(expected, rel=1e-12)


# Maugis and Dugdale


def find_tension(transition):
    """Tension of Maugis' λ = 2σ0 (R/(πWK²))^(1/3), with K = 4E*/3."""
    return transition / 2 / (R / (pi * W * (4 / 3 * E) ** 2)) ** (1 / 3)


@pytest.mark.parametrize("transition", [0.1, 0.5, 1, 3])
def test_a_paraboloid_follows_maugis(transition):
    # Maugis 1992, equations 6.13, 6.15 and 6.18: with A, D, P in units of (πWR²/K)^(1/3),
    # (π²W²R/K²)^(1/3) and πWR, and m = c/a.
    lam, K = transition, 4 / 3 * E
    unit, deep = (pi * W * R**2 / K) ** (1 / 3), (pi**2 * W**2 * R / K**2) ** (1 / 3)
    curve = indentation.maugis(PARABOLOID, E, W, find_tension(lam), 5 * deep)
    touching = np.flatnonzero(curve.contact_radius > 0.05 * unit)[::20]
    for i in touching:
        A = curve.contact_radius[i] / unit

        def gap(m, A=A):
            s, angle = sqrt(m * m - 1), acos(1 / m)
            one = lam * A**2 / 2 * (s + (m * m - 2) * angle)
            return one + 4 * lam**2 * A / 3 * (s * angle - m + 1) - 1

        m = brentq(gap, 1 + 1e-12, 1e4, xtol=1e-14)
        s, angle = sqrt(m * m - 1), acos(1 / m)
        assert curve.depth[i] / deep == pytest.approx(A**2 - 4 / 3 * A * lam * s, abs=1e-7)
        P = A**3 - lam * A**2 * (s + m * m * angle)
        assert curve.force[i] / PULL == pytest.approx(P, abs=1e-7)


def test_maugis_lies_between_dmt_and_jkr():
    forces = [
        indentation.maugis_parting(PARABOLOID, E, W, find_tension(lam), 0).force / PULL
        for lam in (0.01, 0.1, 1, 10, 100)
    ]
    assert forces == sorted(forces)
    assert forces[0] == pytest.approx(-2, rel=2e-3)
    assert forces[-1] == pytest.approx(-1.5, rel=1e-4)
    grips = indentation.maugis_parting(PARABOLOID, E, W, find_tension(100))
    jkr = indentation.jkr_parting(PARABOLOID, E, W)
    assert grips == pytest.approx(jkr, rel=1e-3)


@pytest.mark.parametrize(
    "tip",
    [tips.Cone(0.5, R), tips.Hyperboloid(R, 0.3), tips.PowerLawTip(4.0, R, R), tips.Sphere(R)],
)
def test_any_tip_in_maugis_tends_to_jkr(tip):
    tension = find_tension(200)
    curve = indentation.maugis(tip, E, W, tension, 5e-9)
    wide = curve.contact_radius > 0.3 * curve.contact_radius[-1]
    a = curve.contact_radius[wide]
    assert curve.force[wide] == pytest.approx(indentation.jkr_load(tip, a, E, W), abs=0.01 * PULL)
    assert np.all(np.isfinite(curve.force))


def test_maugis_of_a_rigid_sample_is_the_attraction_of_its_zone():
    # A disc of tension: F = −πσ0c² with g(c) = range − height, before the surfaces touch.
    tension = 1e8
    curve = indentation.maugis(PARABOLOID, 1e16, W, tension, 0.0)
    apart = curve.contact_radius == 0
    reached = 2 * R * (W / tension - curve.height[apart])
    assert curve.force[apart] == pytest.approx(-pi * tension * reached, abs=1e-6 * PULL)
    assert curve.force.min() == pytest.approx(-2 * PULL, rel=1e-6)
    parting = indentation.maugis_parting(PARABOLOID, 1e16, W, tension)
    assert parting.force == pytest.approx(0, abs=1e-6 * PULL)


def test_the_solver_tends_to_maugis_as_the_edges_of_a_dugdale_law_sharpen():
    excess = {}
    for smoothing in (0.14, 0.07):
        law = sa.Dugdale(W, 0.3e-9, tension=W / 1.5e-9, smoothing=smoothing)
        contact = sa.Contact(PARABOLOID, sa.Elastic(E, 0.0), law)
        run = sa.force_distance(contact, sa.Triangle(6e-9, -4e-9, 1e-6), tolerance=2e-3)
        known = indentation.maugis_parting(PARABOLOID, E, W, law.tension, 0).force
        excess[smoothing] = float(run.force_min) / known - 1
    assert 0 < excess[0.07] < 0.7 * excess[0.14] < 0.04
    assert 2 * excess[0.07] - excess[0.14] == pytest.approx(0, abs=0.015)


def test_maugis_refuses_heights_beyond_the_attraction():
    with pytest.raises(ValueError, match=r"^deepest = -1e-09 m: must be above -5e-10 m, where"):
        indentation.maugis(PARABOLOID, E, W, 1e8, -1e-9)
    with pytest.raises(ValueError, match=r"^tension = 0 Pa: must be greater than 0"):
        indentation.maugis(PARABOLOID, E, W, 0.0, 1e-9)


# Lee and Radok, and Ting

DEPTH, TIME, MODULUS = 10e-9, 1e-3, 1e7
SPEED = DEPTH / TIME
START = 0.3 * DEPTH
MET = START / SPEED
TRIANGLE = sa.Triangle(START, -DEPTH, SPEED)
ELASTIC = 4 / 3 * sqrt(R) * DEPTH**1.5

# k = E0/E_inf, q = relaxation time over that of the approach: forces at x = t/t_m = 0.5, 1, 1.05,
# 1.1, the end of contact in t_m, and the loop; forces and loop over those of an elastic sample of
# E_inf. Computed from Ting's formulas with Dawson's function, and by stepping, independently.
TING = {
    (10, 0.05): (0.8055358, 1.6576666, 0.7574299, 0.432382, 1.55001503, 0.67164812),
    (10, 0.2): (1.7734317, 3.3875963, 2.1976052, 1.2839526, 1.24643417, 1.42980651),
    (10, 1): (2.9808021, 7.2359267, 6.2080011, 5.2472764, 1.54209805, 1.62747831),
    (2, 0.5): (0.5985237, 1.5100045, 1.3170215, 1.139484, 1.72062116, 0.25567113),
}


def make_solid(ratio=10.0, share=0.2, poisson=0.0):
    return sa.StandardLinearSolid.from_relaxation_time(
        ratio * MODULUS, MODULUS, share * TIME, poisson
    )


def integrate_loop(curve):
    return -float(trapezoid(curve.force, curve.height))


@pytest.mark.parametrize(("ratio", "share"), TING)
def test_ting_on_a_standard_linear_solid(ratio, share):
    *forces, end, loop = TING[ratio, share]
    sample = make_solid(ratio, share)
    at = MET + TIME * np.array([0.5, 1, 1.05, 1.1])
    found = indentation.ting(PARABOLOID, sample, TRIANGLE, at)
    assert found.force / (ELASTIC * MODULUS) == pytest.approx(forces, abs=6e-8)
    curve = indentation.ting(PARABOLOID, sample, TRIANGLE)
    assert (curve.time[-1] - MET) / TIME == pytest.approx(end, abs=6e-9)
    assert curve.force[-1] == 0 == curve.force[0]
    assert integrate_loop(curve) / (ELASTIC * MODULUS * DEPTH) == pytest.approx(loop, rel=1e-4)


def test_ting_on_an_elastic_sample_is_sneddon_there_and_back():
    for tip in (PARABOLOID, tips.Cone(0.5, 1e-9), tips.Sphere(R), tips.FlatPunch(R, 0.2 * R)):
        curve = indentation.ting(tip, sa.Elastic(MODULUS, 0.3), TRIANGLE)
        modulus = MODULUS / (1 - 0.3**2)
        largest = curve.force.max()
        known = indentation.force(tip, curve.depth, modulus)
        assert curve.force == pytest.approx(known, abs=1e-7 * largest)
        assert curve.time[-1] == pytest.approx(MET + 2 * TIME, rel=1e-9)


def test_the_ratio_of_poisson_stiffens_as_in_a_half_space():
    loose, tight = (indentation.ting(PARABOLOID, make_solid(poisson=p), TRIANGLE) for p in (0, 0.5))
    assert tight.force == pytest.approx(loose.force / 0.75, rel=1e-9, abs=1e-18)


@pytest.mark.parametrize("exponent", [0.1, 0.3, 0.6])
def test_power_laws_follow_lee_and_radok_exactly(exponent):
    # E(t) = E1 (t/t0)^−a: F = (4/3)√R v^1.5 E1 t0^a (3/2) B(1 − a, 3/2) t^(3/2 − a).
    sample = sa.PowerLaw(MODULUS, exponent, (1e-6, 1e-2), 0.0, reference_time=TIME)
    t = TIME * np.array([1e-3, 0.1, 0.5, 1])
    found = indentation.lee_radok(PARABOLOID, sample, TRIANGLE, MET + t)
    growth = MODULUS * TIME**exponent * 1.5 * beta(1 - exponent, 1.5) * t ** (1.5 - exponent)
    assert found.force == pytest.approx(4 / 3 * sqrt(R) * SPEED**1.5 * growth, rel=1e-5)


@pytest.mark.parametrize(
    ("tip", "power"),
    [(PARABOLOID, 2), (tips.Cone(0.5, 1e-14), 1), (tips.PowerLawTip(4.0, R, R), 4)],
)
@pytest.mark.parametrize("exponent", [0.2, 0.5])
def test_power_laws_leave_all_tips_at_one_depth(tip, power, exponent):
    # ∫ E dδ = 0 from the first touch: (t_e)^(1−a) = 2 (t_e − t_m)^(1−a), whatever the tip. Of an
    # exponent of 0.2 contact ends at 0.2745 of the depth; F ~ t^(1 + 1/n − a) on the way in.
    sample = sa.PowerLaw(MODULUS, exponent, (1e-6, 1e-2), 0.0, reference_time=TIME)
    end = 1 / (1 - 2 ** (-1 / (1 - exponent)))
    curve = indentation.ting(tip, sample, TRIANGLE)
    assert (curve.time[-1] - MET) / TIME == pytest.approx(end, rel=1e-9)
    if exponent == 0.2:
        assert curve.depth[-1] / DEPTH == pytest.approx(0.2745, abs=2e-4)
    early, late = indentation.ting(tip, sample, TRIANGLE, MET + TIME * np.array([0.5, 1])).force
    assert late / early == pytest.approx(2 ** (1 + 1 / power - exponent), rel=1e-5)


def test_a_half_sine_of_a_power_law_leads_by_twelve_degrees():
    # Peak at t/T = 0.4331, 12.0° before the middle where loss tangents suggest 18°; end at 0.8867.
    sample = sa.PowerLaw(MODULUS, 0.2, (1e-6, 1e-2), 0.5, reference_time=TIME)
    times = np.linspace(0, TIME, 2001)
    heights = -DEPTH * np.sin(pi * times / TIME)
    path = sa.Trajectory(np.insert(times, 0, -1e-6), np.insert(heights, 0, 1e-12))
    curve = indentation.ting(PARABOLOID, sample, path)
    assert curve.time[-1] / TIME == pytest.approx(0.8867, abs=2e-4)
    near = np.linspace(0.42, 0.45, 301) * TIME
    force = indentation.ting(PARABOLOID, sample, path, near).force
    assert near[force.argmax()] / TIME == pytest.approx(0.4331, abs=2e-4)


def test_a_maxwell_fluid_follows_lee_and_radok():
    # F ~ ∫ E(t − s) (3/2)√s ds with E(t) = E0 exp(−t/λ); Daw is Dawson's function.
    relaxation = 1e-4
    t = TIME * np.array([0.5, 0.75, 1])
    found = indentation.lee_radok(
        PARABOLOID, sa.Maxwell(MODULUS, relaxation, 0.0), TRIANGLE, MET + t
    )
    root = np.sqrt(t / relaxation)
    wanted = MODULUS * 1.5 * relaxation**1.5 * (root - dawsn(root))
    assert found.force / (4 / 3 * sqrt(R) * SPEED**1.5) == pytest.approx(wanted, rel=1e-6)


def test_a_kelvin_voigt_solid_follows_lee_and_radok():
    t = TIME * np.array([0.5, 0.75, 1])
    found = indentation.lee_radok(PARABOLOID, sa.KelvinVoigt(MODULUS, 1e-4, 0.0), TRIANGLE, MET + t)
    wanted = MODULUS * (t**1.5 + 1.5 * 1e-4 * np.sqrt(t))
    assert found.force / (4 / 3 * sqrt(R) * SPEED**1.5) == pytest.approx(wanted, rel=1e-5)


@pytest.mark.parametrize("tip", [tips.Cone(0.6, 2e-9), tips.Hyperboloid(20e-9, 0.4)])
def test_lee_and_radok_is_the_hereditary_integral_for_any_tip(tip):
    # F(t) = ∫ E*(t − s) 2a(s) δ̇ ds, for dF_e = 2a dδ (Pharr, Oliver and Brotzen 1992).
    sample = sa.GeneralizedMaxwell(1e6, (5e6, 2e7), (1e-3, 1e-5), 0.4)
    t = 0.7 * TIME

    def rate(s):
        modulus = sample.relaxation_modulus(t - s) / (1 - 0.4**2)
        return 2 * modulus * indentation.contact_radius(tip, SPEED * s) * SPEED

    # Gauss-Legendre, ever finer towards the touch and towards the end, where moduli are high.
    x, weight = np.polynomial.legendre.leggauss(30)
    near = 4.0 ** -np.arange(1, 12)
    edges = t * np.unique(np.concatenate([[0.0, 1.0], near, 1 - near]))
    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
    wanted = np.sum(half[:, None] * weight * rate(middle[:, None] + half[:, None] * x))
    found = indentation.lee_radok(tip, sample, TRIANGLE, MET + np.array([t]))
    assert found.force[0] == pytest.approx(wanted, rel=1e-6)


def test_in_a_dwell_the_force_relaxes_and_the_contact_stays():
    sample, dwell = make_solid(), 3 * TIME
    motion = sa.Triangle(START, -DEPTH, SPEED, dwell=dwell)
    held = indentation.lee_radok(PARABOLOID, sample, motion, MET + TIME + np.linspace(0, dwell, 4))
    # The force of the hold is E_inf's Hertz plus what the ramp left, which decays as exp(−t/λ).
    rest = held.force / (ELASTIC * MODULUS) - 1
    assert rest / rest[0] == pytest.approx(np.exp(-np.linspace(0, dwell, 4) / (0.2 * TIME)))
    assert held.contact_radius == pytest.approx(sqrt(R * DEPTH), rel=1e-8)
    # After a long dwell the sample is that of E_inf, strained back at E(t): a short way out the
    # force falls as that of a punch of the contact at E0.
    out = MET + TIME + dwell + np.array([0, 1e-5 * TIME])
    first, second = indentation.ting(PARABOLOID, sample, motion, out).force
    punch = 2 * 10 * MODULUS * sqrt(R * DEPTH) * SPEED * 1e-5 * TIME
    assert first - second == pytest.approx(punch, rel=0.01)


def test_the_dissipation_of_a_loop_is_what_the_dashpots_lose():
    # After the tip has left, nothing is stored: slow and fast loops are elastic and lose nothing.
    lost = [
        integrate_loop(indentation.ting(PARABOLOID, make_solid(10, share), TRIANGLE))
        for share in (1e-4, 0.3, 1e4)
    ]
    assert lost[1] > 0
    for small, modulus in ((lost[0], MODULUS), (lost[2], 10 * MODULUS)):
        assert 0 <= small < 0.01 * ELASTIC * modulus * DEPTH


def test_a_solver_with_a_short_repulsion_follows_ting_for_a_cone():
    tip, sample, decay = tips.Cone(1.1, 30e-9), make_solid(), DEPTH / 2000
    law = sa.Repulsion(1e4 * MODULUS, decay)
    touching = decay * np.log(1e4 / (10 * 0.3 / tan(1.1)))
    contact = sa.Contact(tip, sample, law)
    run = sa.force_distance(contact, sa.Triangle(touching + START, touching - DEPTH, SPEED))
    known = indentation.ting(tip, sample, TRIANGLE, run.time.values)
    assert run.force.values == pytest.approx(known.force, abs=0.015 * known.force.max())


def test_a_triangle_and_its_corners_give_one_curve():
    sample = make_solid()
    corners = sa.Trajectory([0, MET + TIME, 2 * MET + 2 * TIME], [START, -DEPTH, START])
    at = MET + TIME * np.linspace(-0.2, 2.2, 31)
    one = indentation.ting(PARABOLOID, sample, TRIANGLE, at)
    other = indentation.ting(PARABOLOID, sample, corners, at)
    assert other.force == pytest.approx(one.force, abs=1e-9 * one.force.max())
    assert one.depth == pytest.approx(-TRIANGLE.height(at), abs=1e-15)
    assert one.force[0] == one.force[-1] == one.contact_radius[-1] == 0
    # A body of one sample is that sample.
    whole = indentation.ting(PARABOLOID, HalfSpace(sample), TRIANGLE, at)
    assert np.array_equal(whole.force, one.force)


def test_a_rest_on_the_way_in_is_the_limit_of_a_slow_stretch():
    sample, heights = make_solid(), np.array([1, -4, -4, -10, 1]) * 1e-9
    times = np.array([0, 5, 9, 15, 26]) * 1e-4
    resting = indentation.ting(PARABOLOID, sample, sa.Trajectory(times, heights))
    slow = heights - np.array([0, 0, 1e-15, 0, 0])
    crawling = indentation.ting(PARABOLOID, sample, sa.Trajectory(times, slow), resting.time)
    assert resting.force == pytest.approx(crawling.force, abs=1e-5 * resting.force.max())
    assert np.any(np.diff(resting.force[resting.time < times[2]]) < 0)


def test_a_motion_may_end_in_contact():
    sample = make_solid()
    whole = indentation.ting(PARABOLOID, sample, TRIANGLE)
    for share in (0.0, 0.05):
        times = np.unique([0, MET + TIME, MET + (1 + share) * TIME])
        path = sa.Trajectory(times, TRIANGLE.height(times))
        part = indentation.ting(PARABOLOID, sample, path)
        assert part.time[-1] == times[-1]
        known = np.interp(part.time, whole.time, whole.force)
        assert part.force == pytest.approx(known, abs=2e-3 * whole.force.max())
        assert part.force[-1] > 0.4 * part.force.max()


def test_a_sine_is_followed_as_closely_as_its_samples():
    motion, sample = sa.Sine(-2e-9, 10e-9, 200.0), make_solid()
    curve = indentation.ting(PARABOLOID, sample, motion)
    times = np.linspace(0, 1 / 200, 4001)
    fine = indentation.ting(
        PARABOLOID, sample, sa.Trajectory(times, motion.height(times)), curve.time[5:-5]
    )
    assert curve.force[5:-5] == pytest.approx(fine.force, abs=2e-5 * fine.force.max())


@pytest.mark.parametrize(
    ("motion", "said"),
    [
        (sa.Triangle(9e-9, 1e-9, 1e-6), r"lowest height is 1e-09 m; must come below the surface"),
        (sa.Trajectory([0, 1, 2], [-1e-9, -2e-9, 1e-9]), r"begins 1e-09 m below the surface"),
        (sa.Sine(0.0, 1e-8, 1e3, cycles=2), r"reverses at .* s; must press in once"),
        (sa.Sine(0.0, 1e-8, 1e3, cycles="steady"), r"must be one dent in a surface at rest"),
        (sa.Triangle(9e-9, -9e-9, 1e-6, setpoint_force=1e-9), r"turns at a force of 1e-09 N"),
        (1.0, r"must be a motion such as softafm.Triangle"),
    ],
)
def test_motions_that_are_no_dent_are_refused(motion, said):
    with pytest.raises(ValueError, match=said):
        indentation.ting(PARABOLOID, make_solid(), motion)


def test_a_surface_that_comes_back_faster_than_the_tip_is_refused():
    times = [0, MET + TIME, MET + 1.2 * TIME, MET + 9 * TIME, MET + 10 * TIME]
    heights = [START, -DEPTH, -0.7 * DEPTH, -0.7 * DEPTH, START]
    with pytest.raises(ValueError, match=r"more slowly than the surface comes back"):
        indentation.ting(PARABOLOID, make_solid(), sa.Trajectory(times, heights))


@dataclass(frozen=True)
class Slab(Layered):
    kind: ClassVar[str] = "slab"
    length: float = 1e-7

    def factor(self, wavenumber):
        return np.tanh(wavenumber)


def test_what_does_not_suit_lee_and_radok_and_ting_is_refused():
    sample = make_solid()
    with pytest.raises(ValueError, match=r"must not be after 0.0013 s, when the motion turns back"):
        indentation.lee_radok(PARABOLOID, sample, TRIANGLE, [MET + 1.1 * TIME])
    with pytest.raises(ValueError, match=r"^time = 1 s: must lie in the motion, 0 to 0.0026 s"):
        indentation.ting(PARABOLOID, sample, TRIANGLE, [1.0])
    with pytest.raises(ValueError, match=r"^sample: is the body 'slab'; must be a half-space"):
        indentation.ting(PARABOLOID, Slab(sample), TRIANGLE)
