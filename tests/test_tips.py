"""Tips: profiles, their compiled twins, what they refuse, and what the solver makes of them."""

import pickle
from dataclasses import FrozenInstanceError
from math import cos, exp, inf, nan, radians, sqrt, tan

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import softafm as sa
from softafm import indentation, tips
from softafm.draw.tip import plot_tip
from softafm.surfaces.repulsion import Repulsion

R = 20e-9
SAMPLES = np.linspace(0, 3 * R, 40)


def blunted(radius, R, slope):
    """A paraboloid that is cut off where it gets as steep as ``slope``."""
    if radius < slope * R:
        return radius * radius / (2 * R)
    return slope * (radius - slope * R / 2)


@numba.njit
def quartic(radius, height, width):
    return height * (radius / width) ** 4


TIPS = [
    tips.Paraboloid(R),
    tips.Sphere(R),
    tips.Cone(radians(35), R),
    tips.Cone(radians(70), 0.1 * R),
    tips.Hyperboloid(R, radians(20)),
    tips.Hyperboloid(R, radians(75)),
    tips.FlatPunch(R, 0.1 * R),
    tips.FlatPunch(R, R),
    tips.PowerLawTip(2.0, R / 2, R),
    tips.PowerLawTip(3.3, 10e-9, R),
    tips.PowerLawTip(50.0, 10e-9, R),
    tips.MeasuredTip(tuple(SAMPLES), tuple(2e-9 + SAMPLES**2 / (2 * R))),
    tips.CustomTip(blunted, R=R, slope=2.0),
    tips.CustomTip(quartic, height=10e-9, width=R),
]
NAMES = [f"{i}-{tip.kind}" for i, tip in enumerate(TIPS)]
every_tip = pytest.mark.parametrize("tip", TIPS, ids=NAMES)
CURVED = [tip for tip in TIPS if not isinstance(tip, tips.FlatPunch | tips.PowerLawTip)][:-1]


# Profiles


@every_tip
def test_profiles_start_at_the_apex_never_fall_and_reach_far(tip):
    r = np.append(0, R * np.geomspace(1e-5, 1e4, 4001))
    height = tip.profile(r)
    assert height[0] == 0
    assert np.all(np.isfinite(height))
    assert np.all(np.diff(height) >= -1e-15 * height[1:])
    assert height[-1] > height[-2] > height[-3]
    assert tip.profile(R) == pytest.approx(np.interp(R, r, height), rel=1e-2, abs=1e-12)
    assert np.ndim(tip.profile(R)) == 0
    assert tip.profile(np.full((2, 3), R)).shape == (2, 3)


@every_tip
def test_compiled_profiles_equal_the_readable_ones(tip):
    profile, parameters = tip.compiled_profile
    r = np.append(0, R * np.geomspace(1e-5, 1e4, 500))
    out = np.full(r.size, 7.0)
    profile(r, parameters, out, r.size - 1)
    assert out[:-1] == pytest.approx(tip.profile(r[:-1]), rel=1e-13, abs=0)
    assert out[-1] == 7.0


@every_tip
def test_the_slope_is_even_and_has_no_corner(tip):
    r = R * np.geomspace(1e-4, 1e3, 2001)
    slope = tip.slope(r)
    rise = np.diff(tip.profile(r))
    # The slope integrates to the profile (Simpson's rule in steps of 0.8 %).
    middle = (r[1:] + r[:-1]) / 2
    simpson = (slope[1:] + slope[:-1] + 4 * tip.slope(middle)) * np.diff(r) / 6
    smooth = ~np.any([(r[:-1] <= joint) & (r[1:] >= joint) for joint in (0, *tip.joints)], axis=0)
    assert simpson[smooth] == pytest.approx(rise[smooth], rel=2e-3, abs=1e-9 * R)
    assert tip.slope(0.0) == 0
    assert tip.slope(1e-4 * R) <= 1.1e-3
    for joint in tip.joints:
        before, at, after = tip.slope(joint * np.array([1 - 1e-7, 1, 1 + 1e-7]))
        assert before == pytest.approx(after, rel=1e-4, abs=2e-5)
        assert at == pytest.approx(after, rel=1e-4, abs=2e-5)


@pytest.mark.parametrize("tip", CURVED, ids=lambda tip: tip.kind)
def test_apex_radii_are_those_asked_for(tip):
    apex = getattr(tip, "apex_radius", R)
    r = 1e-5 * apex
    assert r**2 / (2 * float(tip.profile(r))) == pytest.approx(apex, rel=1e-8)


@every_tip
@given(st.floats(-6, 3))
@settings(max_examples=15, deadline=None)
def test_the_radius_at_a_height_has_that_height(tip, decades):
    height = R * 10.0**decades
    radius = tip.radius_at(height)
    assert tip.profile(radius) == pytest.approx(height, rel=1e-9)


def test_formulas_of_the_profiles():
    r = R * np.array([0.1, 0.5, 0.9])
    assert tips.Sphere(R).profile(r) == pytest.approx(R - np.sqrt(R**2 - r**2), rel=1e-12)
    angle = radians(35)
    cone, apart = tips.Cone(angle, R), R * (1 / np.sin(angle) - 1)
    # Far out the flank points to the tip of the sharp cone, R (1/sin α − 1) below the cap.
    assert cone.profile(10 * R) == pytest.approx(10 * R / tan(angle) - apart)
    assert cone.joints == pytest.approx((R * cos(angle),))
    A = R / tan(angle) ** 2
    expected = A * (np.sqrt(1 + (r * tan(angle) / R) ** 2) - 1)
    assert tips.Hyperboloid(R, angle).profile(r) == pytest.approx(expected, rel=1e-12)
    assert tips.Hyperboloid(R, angle).slope(1e4 * R) == pytest.approx(1 / tan(angle), rel=1e-6)
    punch = tips.FlatPunch(R, 0.2 * R)
    assert np.all(punch.profile(np.array([0, 0.5, 0.8]) * R) <= 1e-20)
    assert punch.profile(0.9 * R) == pytest.approx(0.2 * R - sqrt(0.03) * R)
    assert punch.radius_at(0.0) == pytest.approx(0.8 * R)
    power = tips.PowerLawTip(4.0, 1e-9, R)
    assert power.profile(3 * R) == pytest.approx(81e-9)
    square = tips.PowerLawTip(2.0, R / 2, R)
    assert square.profile(r) == pytest.approx(tips.Paraboloid(R).profile(r), rel=1e-14)
    assert tips.FlatPunch(R, R).profile(r) == pytest.approx(tips.Sphere(R).profile(r), rel=1e-14)


@every_tip
def test_heights_below_the_apex_have_no_radius(tip):
    for bad in (-1e-9, nan, inf):
        with pytest.raises(ValueError, match=r"^height = "):
            tip.radius_at(bad)


# Measured profiles


def test_measured_paraboloids_are_met_exactly_and_others_closely():
    r = R * np.array([0, 0.3, 0.35, 1.0, 2.0])
    tip = tips.MeasuredTip(tuple(r), tuple(5e-9 + r**2 / (2 * R)))
    fine = np.linspace(0, 2 * R, 300)
    assert tip.profile(fine) == pytest.approx(fine**2 / (2 * R), rel=1e-12)
    assert tip.slope(3 * R) == pytest.approx(2, rel=1e-9)
    cone = tips.Cone(radians(35), R)
    for points, close in ((20, 1e-2), (200, 1e-4)):
        r = np.linspace(0, 3 * R, points)
        measured = tips.MeasuredTip(tuple(r), tuple(cone.profile(r)))
        off = measured.profile(fine) - cone.profile(fine)
        assert np.abs(off).max() < close * R
        assert measured.profile(9 * R) == pytest.approx(cone.profile(9 * R), rel=close)


def test_profiles_are_read_from_files(tmp_path):
    path = tmp_path / "tip.csv"
    path.write_text("Radius (nm),note,Height (nm)\n0,a,1\n1,b,1.5\n\n2,c,3\n3,d,5.5\n")
    tip = tips.read_tip_profile(path)
    assert tip.r == pytest.approx((0.0, 1e-9, 2e-9, 3e-9), rel=1e-15)
    assert tip.height == pytest.approx((1e-9, 1.5e-9, 3e-9, 5.5e-9), rel=1e-15)
    assert tip == tips.read_tip_profile(str(path))
    assert hash(tip) == hash(tips.MeasuredTip(list(tip.r), np.array(tip.height)))
    path.write_text("radius (um),height (um)\n0,0\n1,0.5\n2,2\n3,4.5\n")
    assert tips.read_tip_profile(path).profile(1e-6) == pytest.approx(0.5e-6)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"is empty; its header must read, .* 'radius \(nm\),height \(nm\)'"),
        ("radius,height\n0,0\n", "column 'radius' has no unit"),
        ("radius (nm)\n0\n", "has no column 'height'; its header, line 1, reads 'radius"),
        ("radius (nm),height (kg)\n0,0\n", r"'height \(kg\)' must name a unit of a length"),
        (
            "radius (nm),height (nm)\n0,0\n1,high\n",
            r"line 3 \('1,high'\): 'height' must be a finite number",
        ),
        ("radius (nm),height (nm)\n0,0\n1,1\n2\n", r"line 4 \('2'\) has no 'height'"),
        ("radius (nm),height (nm)\n0,0\n1,1\n2,3\n", r"r has 3 entries: must have at least 4"),
    ],
)
def test_files_without_a_profile_are_refused(tmp_path, text, message):
    path = tmp_path / "tip.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=message) as caught:
        tips.read_tip_profile(path)
    assert len(str(caught.value).splitlines()) == 1
    with pytest.raises(ValueError, match="no such file"):
        tips.read_tip_profile(tmp_path / "none.csv")


RISING = (0, 0.1, 0.2, 0.3)


@pytest.mark.filterwarnings("ignore::softafm.errors.DoubtfulValueWarning")
@pytest.mark.parametrize(
    ("r", "height", "message"),
    [
        ((0, 0.1, 0.2), (0, 0.1, 0.2), r"^r has 3 entries: must have at least 4"),
        (RISING, (0, 0.1, 0.2), r"^height has 3 entries: must have as many as r, 4"),
        ((0.1, 0.2, 0.3, 0.4), RISING, r"^r\[0\] = 0.1 m: must be 0"),
        ((0, 0.1, 0.1, 0.2), RISING, r"^r\[2\] = 0.1 m: must be above r\[1\] = 0.1 m"),
        ((0, 0.2, 0.1, 0.3), RISING, r"^r\[2\] = 0.1 m: must be above r\[1\] = 0.2 m"),
        (
            RISING,
            (0, 0.1, 0.05, 0.2),
            r"^height\[2\] = 0.05 m at r = 0.2 m: .* height\[1\] = 0.1 m",
        ),
        (RISING, (0, 0.1, nan, 0.2), r"^height\[2\] = nan m: must be a finite number"),
        ((0, 0.1, inf, 0.3), RISING, r"^r\[2\] = inf m: must be a finite number"),
        (RISING, (0.1, 0.1, 0.1, 0.1), r"^height = 0.1 m at all r: must rise"),
        (RISING, (0, 0.1, 0.2, 0.2), r"^height\[3\] = 0.2 m: must be above the height before it"),
        ((0, 0.1, 0.2, "3 nm"), RISING, r"^r\[3\] = '3 nm': must be a number in m"),
        (None, RISING, r"^r = None: must be a list of numbers in m"),
        (RISING, [[0, 1], [2, 3]], r"^height\[0\] = \[0, 1\]: must be a number in m"),
    ],
)
def test_what_is_no_profile_is_refused(r, height, message):
    with pytest.raises(ValueError, match=message) as caught:
        tips.MeasuredTip(r, height)
    assert len(str(caught.value).splitlines()) == 1


# Functions of the user's own


def test_custom_tips_know_their_parameters():
    tip = tips.CustomTip(blunted, slope=2.0, R=R)
    assert tip.parameters == (("R", R), ("slope", 2.0))
    assert tip == tips.CustomTip(blunted, R=R, slope=2.0)
    assert hash(tip) == hash(tips.CustomTip(blunted, R=R, slope=2.0))
    assert tip != tips.CustomTip(blunted, R=R, slope=2.1)
    assert pickle.loads(pickle.dumps(tip)) == tip
    assert tip.profile(R) == pytest.approx(R / 2)
    assert tip.profile(3 * R) == pytest.approx(4 * R)
    with pytest.raises(FrozenInstanceError):
        tip.parameters = ()


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"R": R}, r"^slope: missing; must have a value; those of blunted are R, slope"),
        ({"R": R, "slope": 1.0, "angle": 2.0}, r"^angle: must be a parameter of the function"),
        ({"R": "20 nm", "slope": 1.0}, r"^R = '20 nm': must be a number in SI units"),
        ({"R": nan, "slope": 1.0}, r"^R = nan SI units: must be a finite number"),
    ],
)
def test_parameters_that_do_not_fit_the_function_are_refused(parameters, message):
    with pytest.raises(ValueError, match=message):
        tips.CustomTip(blunted, **parameters)


def falls(radius):
    return radius * radius / 2e-8 if radius < 1e-8 else 4e-9 + (radius - 1e-8)


def corner(radius, slope):
    return slope * radius


def starts_high(radius):
    return 1e-9 + radius * radius / 2e-8


def spike(radius):
    return 1e4 * radius**1.5


def bump(radius):
    return 1e-9 * (1 - exp(-radius * radius / 1e-16))


def breaks(radius):
    return radius * radius * (1e-4 - radius) ** 0.5


def text(radius):
    return "high" + radius


@pytest.mark.parametrize(
    ("function", "parameters", "message"),
    [
        (falls, {}, r"= falls: 4e-09 m at 1e-08 m, but 4.*e-09 m at 9.*e-09 m: must never fall"),
        (corner, {"slope": 0.01}, r"corner: rises as radius\^1 at radius 0"),
        (spike, {}, r"spike: rises as radius\^1.5 at radius 0"),
        (starts_high, {}, r"starts_high: 1e-09 m at radius 0: must be 0"),
        (bump, {}, r"bump: 1e-09 m from .* m to 0.01 m: must go on rising"),
        (breaks, {}, r"breaks: nan m at .* m: must be finite"),
        (text, {}, r"text: must be one that numba compiles .*: TypingError"),
        (3.0, {}, r"= 3.0: must be a Python function"),
        (lambda *radii: 0.0, {}, r"must take \(radius, parameter, ...\)"),
    ],
)
def test_functions_that_are_no_profiles_are_refused(function, parameters, message):
    with pytest.raises(ValueError, match=message) as caught:
        tips.CustomTip(function, **parameters)
    assert str(caught.value).startswith("function = ")
    assert len(str(caught.value).splitlines()) == 1


# Refusals of the others


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: tips.Sphere(0), r"^radius = 0 m: must be greater than 0"),
        (lambda: tips.Cone(35, R), r"^half_angle = 35 rad: .* below pi/2 rad, that is 90 degrees"),
        (lambda: tips.Cone(0.0, R), r"^half_angle = 0 rad: must be above 0"),
        (lambda: tips.Cone(0.5, -R), r"^apex_radius = -2e-08 m: must be greater than 0"),
        (lambda: tips.Hyperboloid(R, 2.0), r"^half_angle = 2 rad: .* \(2 rad are 114.6 degrees"),
        (lambda: tips.Hyperboloid(nan, 0.5), r"^radius = nan m: must be a finite number"),
        (
            lambda: tips.FlatPunch(R, 2 * R),
            r"^edge_radius = 4e-08 m: must be at most radius = 2e-08",
        ),
        (lambda: tips.FlatPunch(R, 0.0), r"^edge_radius = 0 m: must be greater than 0"),
        (lambda: tips.PowerLawTip(1.5, R, R), r"^exponent = 1.5: must be from 2 to 50 .* Cone"),
        (lambda: tips.PowerLawTip(51.0, R, R), r"^exponent = 51: must be from 2 to 50"),
        (lambda: tips.PowerLawTip(4.0, -R, R), r"^height = -2e-08 m: must be greater than 0"),
        (lambda: tips.PowerLawTip(4.0, R, None), r"^radius = None: must be a number in m"),
    ],
)
def test_bad_numbers_are_refused(build, message):
    with pytest.raises(ValueError, match=message):
        build()


# Figures


def test_tips_are_drawn_with_the_paraboloid_of_the_apex():
    figure = plot_tip(tips.Sphere(R), 1.2 * R)
    (ax,) = figure.axes
    profile, fit = (line.get_ydata() for line in ax.get_lines())
    x = ax.get_lines()[0].get_xdata()
    assert profile == pytest.approx(1e9 * tips.Sphere(R).profile(1e-9 * np.abs(x)))
    assert fit == pytest.approx(1e9 * (1e-9 * x) ** 2 / (2 * R))
    assert ax.get_xlabel() == "Radius (nm)"
    several = plot_tip([tips.Sphere(R), tips.FlatPunch(R, 0.1 * R)], R, labels=["ball", "post"])
    shown = [text.get_text() for text in several.axes[0].get_legend().get_texts()]
    assert shown == ["ball", "paraboloid of the apex", "post"]


def test_what_cannot_be_drawn_is_refused():
    with pytest.raises(ValueError, match="tips is empty"):
        plot_tip([], R)
    with pytest.raises(ValueError, match="labels has 2 entries: must have one a tip, 1"):
        plot_tip(tips.Sphere(R), R, labels=["a", "b"])
    with pytest.raises(ValueError, match="extent = 0 m"):
        plot_tip(tips.Sphere(R), 0.0)


# The solver

HARD = 1e4
MODULUS = 1e7


def depths(tip, contact_radius):
    return float(indentation.depth(tip, contact_radius))


@pytest.mark.parametrize(
    ("tip", "depth"),
    [
        (tips.Sphere(R), depths(tips.Sphere(R), 0.5 * R)),
        (tips.Sphere(R), depths(tips.Sphere(R), 0.8 * R)),
        (tips.Cone(radians(35), 0.5e-9), 0.5 * R),
        (tips.Hyperboloid(R, radians(20)), 1.5 * R),
        (tips.FlatPunch(R, 0.05 * R), 0.4 * R),
        (tips.PowerLawTip(4.0, 10e-9, R), 0.4 * R),
        (tips.MeasuredTip(tuple(SAMPLES), tuple(SAMPLES**2 / (2 * R))), 0.3 * R),
    ],
    ids=lambda value: getattr(value, "kind", ""),
)
def test_short_ranged_repulsion_indents_as_sneddon_says(tip, depth):
    # Galin and Sneddon, at the depth of the surface below the apex: the tip itself is as much
    # higher as repulsion keeps the surfaces apart. That distance makes the rest, as CHECKS.md says.
    law = Repulsion(HARD * MODULUS, depth / 500)
    contact = sa.Contact(tip, sa.Elastic(MODULUS, 0.0), law)
    curve = sa.force_distance(contact, sa.Triangle(0.05 * depth, -depth, 1e-6))
    at = int(curve.tip_height.values.argmin())
    deep = -float(curve.axis_deformation[at])
    assert deep == pytest.approx(depth, rel=0.03)
    assert float(curve.force[at]) == pytest.approx(indentation.force(tip, deep, MODULUS), rel=0.01)


RIGID = [
    tips.Sphere(R),
    tips.Cone(radians(35), 0.2 * R),
    tips.Hyperboloid(R, radians(20)),
    tips.PowerLawTip(4.0, 10e-9, R),
    tips.FlatPunch(R, 0.1 * R),
]


@pytest.mark.parametrize("tip", RIGID, ids=lambda tip: tip.kind)
def test_a_rigid_sample_feels_the_sum_of_all_pressures(tip):
    law = sa.LennardJones.from_work_of_adhesion(W=0.05, z0=3e-10)
    contact = sa.Contact(tip, sa.Elastic(1e16, 0.0), law)
    curve = sa.force_distance(contact, sa.Triangle(3e-9, 0.28e-9, 1e-6), tolerance=1e-3)
    rigid = contact.rigid_force(curve.tip_height.values)
    assert np.abs(curve.force.values - rigid).max() < 1e-3 * np.abs(rigid).max()
