"""Closed-form indentation against the formulas of each tip."""

from math import asin, atan, gamma, inf, log, nan, pi, radians, sqrt, tan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

import softafm as sa
from softafm import indentation, tips

E = 1e6
R = 20e-9
RADII = R * np.geomspace(1e-3, 0.95, 13)


def test_a_paraboloid_follows_hertz():
    tip, a = sa.Paraboloid(R), R * np.geomspace(1e-3, 10, 9)
    deep = indentation.depth(tip, a)
    assert deep == pytest.approx(a**2 / R, rel=1e-10)
    assert indentation.load(tip, a, E) == pytest.approx(4 / 3 * E * a**3 / R, rel=1e-10)
    assert indentation.hertz_force(R, deep, E) == pytest.approx(4 / 3 * E * a**3 / R, rel=1e-10)
    assert indentation.force(tip, deep, E) == pytest.approx(4 / 3 * E * a**3 / R, rel=1e-9)


def test_a_sphere_follows_sneddon():
    # Sneddon 1965: δ = (a/2) ln((R+a)/(R−a)), F = E*[(a²+R²)/2 ln((R+a)/(R−a)) − aR]. The second
    # cancels at small a; its series is 4a³/3R·(1 + 2x²/5 + 9x⁴/35 + 4x⁶/21 + ...), x = a/R.
    a = RADII[RADII > 0.1 * R]
    spread = np.log((R + a) / (R - a))
    assert indentation.depth(tips.Sphere(R), a) == pytest.approx(a / 2 * spread, rel=1e-9)
    expected = E * ((a**2 + R**2) / 2 * spread - a * R)
    assert indentation.load(tips.Sphere(R), a, E) == pytest.approx(expected, rel=1e-9)
    a = RADII[RADII < 0.01 * R]
    expected = 4 / 3 * E * a**3 / R * (1 + 2 / 5 * (a / R) ** 2)
    assert indentation.load(tips.Sphere(R), a, E) == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("angle", [radians(20), radians(70.3)])
def test_a_sharp_cone_follows_sneddon(angle):
    # Sneddon 1965: δ = (π/2) a cot α, F = (π/2) E* a² cot α = (2/π) E* δ² tan α.
    a, sharp = 1e-6, tips.Cone(angle, 1e-15)
    assert indentation.depth(sharp, a) == pytest.approx(pi / 2 * a / tan(angle), rel=1e-8)
    assert indentation.load(sharp, a, E) == pytest.approx(pi / 2 * E * a**2 / tan(angle), rel=1e-8)
    deep = 1e-7
    expected = 2 / pi * E * deep**2 * tan(angle)
    assert indentation.force(sharp, deep, E) == pytest.approx(expected, rel=1e-7)


def test_a_rounded_cone_is_a_sphere_until_the_flank():
    # Beyond it δ = a ∫ g'(r)/√(a² − r²) dr of both parts, in closed form.
    angle, cone = radians(35), tips.Cone(radians(35), R)
    join = cone.joints[0]
    inside = 0.99 * join
    assert indentation.load(cone, inside, E) == indentation.load(tips.Sphere(R), inside, E)
    a = 1.7 * join
    # With t = √(a²−r²) + √(R²−r²): ∫ r/√((R²−r²)(a²−r²)) dr = −ln t.
    arc = a * log((a + R) / (sqrt(a**2 - join**2) + sqrt(R**2 - join**2)))
    flank = a / tan(angle) * (pi / 2 - asin(join / a))
    assert indentation.depth(cone, a) == pytest.approx(arc + flank, rel=1e-10)


def test_a_sharp_punch_follows_sneddon():
    # F = 2E*aδ for an edge of vanishing radius.
    a = 1e-7
    punch = tips.FlatPunch(a, 1e-6 * a)
    deep = 1e-3 * a
    assert indentation.force(punch, deep, E) == pytest.approx(2 * E * a * deep, rel=1e-4)
    assert indentation.contact_radius(punch, deep) == pytest.approx(a, rel=1e-5)


@pytest.mark.parametrize("n", [2.0, 3.0, 4.0, 7.5])
def test_a_power_follows_galin(n):
    # g = c rⁿ: δ = c n √π/2 Γ(n/2)/Γ((n+1)/2) aⁿ and F = 2E* a δ n/(n+1).
    tip, a = tips.PowerLawTip(n, 3e-9, R), R * np.array([0.01, 0.5, 3.0])
    expected = 3e-9 * (a / R) ** n * n * sqrt(pi) / 2 * gamma(n / 2) / gamma((n + 1) / 2)
    assert indentation.depth(tip, a) == pytest.approx(expected, rel=1e-10)
    forces = 2 * E * a * expected * n / (n + 1)
    assert indentation.load(tip, a, E) == pytest.approx(forces, rel=1e-10)


@pytest.mark.parametrize("ratio", [0.05, 1.0, 30.0])
def test_a_hyperboloid_follows_sun(ratio):
    # With b = R cot α: δ = (a A/b) atan(a/b), A = R cot²α, and
    # F = E* A [(a² − b²)/b atan(a/b) + a] (Sun, Akhremitchev and Walker 2004, rearranged).
    angle = radians(25)
    b, A = R / tan(angle), R / tan(angle) ** 2
    a, tip = ratio * b, tips.Hyperboloid(R, angle)
    assert indentation.depth(tip, a) == pytest.approx(a * A / b * atan(a / b), rel=1e-9)
    expected = E * A * ((a**2 - b**2) / b * atan(a / b) + a)
    assert indentation.load(tip, a, E) == pytest.approx(expected, rel=1e-8)


def test_joints_of_measured_tips_are_met():
    r = R * np.array([0, 0.1, 0.15, 0.4, 0.5, 0.9, 1.0])
    tip = tips.MeasuredTip(tuple(r), tuple(r**2 / (2 * R)))
    a = 1.7 * R
    expected = quad(lambda t: a * tip.slope(a * np.sin(t)), 0, pi / 2, points=np.arcsin(r / a))[0]
    assert indentation.depth(tip, a) == pytest.approx(expected, rel=1e-8)
    inside = 0.9 * R
    assert indentation.depth(tip, inside) == pytest.approx(inside**2 / R, rel=1e-10)


@given(
    st.sampled_from(
        [
            sa.Paraboloid(R),
            tips.Sphere(R),
            tips.Cone(0.5, R),
            tips.Hyperboloid(R, 0.3),
            tips.FlatPunch(R, 0.2 * R),
            tips.PowerLawTip(4.0, R, R),
        ]
    ),
    st.floats(-2, 1),
)
@settings(deadline=None, max_examples=40)
def test_the_stiffness_is_that_of_a_punch_of_the_contact(tip, size):
    # dF/dδ = 2E*a for all tips (Pharr, Oliver and Brotzen 1992): load and depth agree.
    a = R * 10.0**size * np.array([1 - 1e-4, 1, 1 + 1e-4])
    deep, force = indentation.depth(tip, a), indentation.load(tip, a, E)
    if deep[0] == 0:
        return
    assert (force[2] - force[0]) / (deep[2] - deep[0]) == pytest.approx(2 * E * a[1], rel=1e-4)
    assert indentation.contact_radius(tip, deep[1]) == pytest.approx(a[1], rel=1e-7)


def test_adhesive_contacts_of_a_paraboloid_follow_jkr():
    W, tip, a = 0.05, sa.Paraboloid(R), np.linspace(0, 3 * R, 3001)
    force = indentation.jkr_load(tip, a, E * 1e3, W)
    assert force.min() == pytest.approx(indentation.jkr_pull_off(R, W), rel=5e-6)  # of the radii
    assert indentation.jkr_pull_off(R, W) == pytest.approx(-1.5 * pi * W * R)
    assert indentation.dmt_pull_off(R, W) == pytest.approx(-2 * pi * W * R)
    last = (pi * R**2 * W / (8 * E * 1e3)) ** (1 / 3)
    assert indentation.jkr_depth(tip, last, E * 1e3, W) == pytest.approx(-3 * last**2 / R)
    # The depth is smallest there: the contact breaks under displacement control.
    at = indentation.jkr_depth(tip, last * np.array([0.99, 1, 1.01]), E * 1e3, W)
    assert at.argmin() == 1


def test_adhesive_punches_part_at_once():
    # F = −√(8πE*Wa³), Kendall, J. Phys. D 4, 1186 (1971).
    a, W, punch = 1e-7, 0.05, tips.FlatPunch(1e-7, 1e-12)
    force = indentation.jkr_load(punch, a - 1e-12, E, W)
    assert force == pytest.approx(-sqrt(8 * pi * E * W * a**3), rel=1e-4)


def test_shapes_and_refusals():
    tip = tips.Sphere(R)
    assert indentation.depth(tip, 0.0) == 0
    assert indentation.load(tip, np.zeros((2, 3)), E).shape == (2, 3)
    assert indentation.force(tip, [-1e-9, 0.0], E) == pytest.approx([0, 0])
    assert indentation.hertz_force(R, -1e-9, E) == 0
    for bad in (-1e-9, nan, inf):
        with pytest.raises(ValueError, match=r"^contact_radius = "):
            indentation.depth(tip, bad)
    with pytest.raises(ValueError, match=r"^depth = nan m"):
        indentation.contact_radius(tip, [1e-9, nan])
    with pytest.raises(ValueError, match=r"^modulus = 0 Pa"):
        indentation.load(tip, 1e-9, 0.0)
    with pytest.raises(ValueError, match=r"^work_of_adhesion = -1 J/m²"):
        indentation.jkr_depth(tip, 1e-9, E, -1)
    with pytest.raises(ValueError, match=r"^radius = 0 m"):
        indentation.dmt_pull_off(0.0, 0.05)
