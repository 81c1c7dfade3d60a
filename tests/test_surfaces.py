"""Surface laws: formulas, what follows from them, data, sums, users' functions, refusals."""

import pickle
from dataclasses import FrozenInstanceError
from itertools import pairwise
from math import cosh, exp, inf, log, nan, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit
from scipy.integrate import quad

import softafm as sa
from softafm import surfaces
from softafm.draw.law import plot_surface
from softafm.solvers.energy.surface import find_gap_origin

W, Z0 = 0.05, 3e-10
LJ = surfaces.LennardJones.from_work_of_adhesion(W, Z0)

works = st.floats(-4, 0).map(lambda x: 10.0**x)
lengths = st.floats(0.1, 1).map(lambda x: 1e-9 * x)
shares = st.floats(0.05, 0.9)


def lennard_jones(gap, hamaker, z0):
    """The Lennard-Jones law as a user might write it."""
    if gap > 1.0:
        return 0.0, 0.0, 0.0
    attraction = hamaker / (6 * pi * gap**3)
    repulsion = attraction * (z0 / gap) ** 6
    slope = (3 * attraction - 9 * repulsion) / gap
    return repulsion - attraction, slope, gap * (repulsion / 8 - attraction / 2)


def sampled(law):
    return surfaces.Tabulated.from_function(law.pressure, 0.3 * law.equilibrium_gap, 3e-8, 60)


def hard_and_soft(hamaker, z0):
    """Van der Waals attraction with a separate repulsion, as a sum."""
    core = 0.08 * z0
    contact = hamaker / (6 * pi * z0**3) * exp(z0 / core)
    return surfaces.VanDerWaalsAttraction(hamaker, 0.6 * z0) + surfaces.Repulsion(contact, core)


BUILD = surfaces.LennardJones.from_work_of_adhesion
hamakers = works.map(lambda w: 1e-18 * w)
WELLS = {
    "lennard-jones": st.builds(BUILD, works, lengths),
    "van-der-waals": st.builds(
        surfaces.VanDerWaals.from_work_of_adhesion, works, lengths, st.floats(3.5, 20)
    ),
    "dmt": st.builds(surfaces.DMT.from_work_of_adhesion, works, lengths, st.floats(0.02, 0.25)),
    "exponential": st.builds(
        lambda w, z, decay, share: surfaces.Exponential(w, z, decay, share * decay),
        works, lengths, lengths, shares,
    ),
    "morse": st.builds(surfaces.Morse, works, lengths, lengths),
    "dugdale": st.builds(
        lambda w, z, reach, smoothing: surfaces.Dugdale(w, z, w / reach, smoothing),
        works, lengths, lengths, st.floats(0.02, 0.3),
    ),
    "dlvo": st.builds(
        surfaces.DLVO, st.just(4e-20), lengths, st.floats(-0.02, 0.02), st.floats(1e-9, 3e-8)
    ),
    "tabulated": st.builds(BUILD, works, lengths).map(sampled),
    "sum": st.builds(hard_and_soft, hamakers, lengths),
    "custom": st.builds(
        lambda H, z0: surfaces.CustomSurface(lennard_jones, hamaker=H, z0=z0), hamakers, lengths
    ),
}  # fmt: skip
laws = st.sampled_from(list(WELLS)).flatmap(WELLS.get)
each = pytest.mark.parametrize("kind", WELLS)


def gaps_of(law, ratios):
    """Gaps from the hard core outwards, by numbers from −1 to 1."""
    well, width = law.equilibrium_gap, law.range
    inner = min(0.3 * width, 0.4 * well)
    ratios = np.asarray(ratios)
    return well + np.where(ratios < 0, inner * ratios, width * np.expm1(4 * np.abs(ratios)))


def derivative(function, gap, step):
    """A central difference of fourth order."""
    near = function(gap + step) - function(gap - step)
    return (8 * near - (function(gap + 2 * step) - function(gap - 2 * step))) / (12 * step)


# What every law keeps


@each
@given(data=st.data(), ratios=st.lists(st.floats(-1, 1), min_size=1, max_size=20))
@settings(deadline=None, max_examples=15)
def test_compiled_law_equals_the_readable_one(kind, data, ratios):
    law = data.draw(WELLS[kind])
    gap = gaps_of(law, ratios)
    pressure, potential, parameters = law.compiled_pressure
    p, slope, phi = np.empty((3, gap.size))
    pressure(gap, parameters, p, slope, gap.size)
    potential(gap, parameters, phi, gap.size)
    work, length = law.work_of_adhesion, law.range
    assert p == pytest.approx(law.pressure(gap), rel=1e-11, abs=1e-11 * work / length)
    assert slope == pytest.approx(law.slope(gap), rel=1e-11, abs=1e-11 * work / length**2)
    assert phi == pytest.approx(law.potential(gap), rel=1e-11, abs=1e-11 * work)


@each
@given(data=st.data(), ratio=st.floats(-1, 1))
@settings(deadline=None, max_examples=25)
def test_slope_and_pressure_are_derivatives(kind, data, ratio):
    law = data.draw(WELLS[kind])
    gap, step = float(gaps_of(law, ratio)), 1e-4 * law.range / law.sharpness
    if kind == "tabulated":  # cubics, whose second derivative jumps
        away = np.abs(np.array(law.gaps) - gap).min()
        if away < 3 * step:
            return
    tension, width = law.largest_tension, law.range
    force = derivative(law.potential, gap, step)
    assert law.pressure(gap) == pytest.approx(-force, rel=1e-6, abs=1e-6 * tension)
    slope = derivative(law.pressure, gap, step)
    assert law.slope(gap) == pytest.approx(slope, rel=1e-6, abs=1e-6 * tension / width)


@each
@given(data=st.data())
@settings(deadline=None, max_examples=8)
def test_work_of_adhesion_is_the_work_to_separate(kind, data):
    law = data.draw(WELLS[kind])
    work, width, well = law.work_of_adhesion, law.range, law.equilibrium_gap
    assert work > 0
    edges = well + width * np.concatenate([[0], np.geomspace(0.01, 1e5, 60)])
    points, weights = np.polynomial.legendre.leggauss(40 if kind == "tabulated" else 12)
    half = np.diff(edges)[:, None] / 2
    done = -np.sum(law.pressure(edges[:-1, None] + half * (1 + points)) * weights * half)
    assert done == pytest.approx(work, rel=1e-4 if kind == "tabulated" else 3e-6)
    assert law.potential(well) == pytest.approx(-work)
    assert abs(law.pressure(well)) <= 1e-9 * law.largest_tension
    assert law.pressure(well - 1e-3 * width) > 0 > law.pressure(well + 1e-3 * width)


@each
@given(data=st.data())
@settings(deadline=None, max_examples=10)
def test_tension_is_largest_where_the_law_says(kind, data):
    law = data.draw(WELLS[kind])
    gap, tension = law.gap_of_largest_tension, law.largest_tension
    everywhere = law.pressure(law.equilibrium_gap + law.range * np.geomspace(1e-3, 1e2, 2001))
    assert tension == pytest.approx(-everywhere.min(), rel=1e-5)
    assert law.pressure(gap) == -tension <= everywhere.min() * (1 - 1e-12)


@each
@given(data=st.data())
@settings(deadline=None, max_examples=15)
def test_laws_repel_ever_more_at_all_gaps_that_the_solver_tries(kind, data):
    law = data.draw(WELLS[kind])
    origin = max(
        find_gap_origin(sa.Contact(sa.Paraboloid(1e-8), sa.Elastic(1e9, 0.3), law)), law.closest_gap
    )
    tried = origin + (law.equilibrium_gap - origin) * np.linspace(0.1, 0.999, 500)
    pressure = law.pressure(tried)
    assert np.all(pressure > 0)
    assert np.all(np.diff(pressure) < 0)
    assert np.all(np.isfinite(law.potential(tried)))
    assert pressure[0] > 100 * law.largest_tension


@each
@given(data=st.data())
@settings(deadline=None, max_examples=5)
def test_pull_off_from_a_rigid_sample_is_that_of_derjaguin(kind, data):
    law = data.draw(WELLS[kind])
    contact = sa.Contact(sa.Paraboloid(1e-8), sa.Elastic(1e9, 0.3), law)
    force = contact.rigid_force(law.equilibrium_gap + law.range * np.linspace(-0.02, 0.02, 201))
    assert force.min() == pytest.approx(-2 * pi * 1e-8 * law.work_of_adhesion, rel=2e-5)


@given(laws)
@settings(deadline=None)
def test_range_is_z0_of_the_lennard_jones_law_of_the_same_work_and_tension(law):
    like = BUILD(law.work_of_adhesion, law.range)
    assert like.largest_tension == pytest.approx(law.largest_tension)


@given(laws)
@settings(deadline=None, max_examples=20)
def test_laws_are_values(law):
    again = law if law.kind == "custom" else pickle.loads(pickle.dumps(law))
    assert again == law
    assert hash(again) == hash(law)
    with pytest.raises(FrozenInstanceError):
        law.kind = "other"


@each
def test_a_soft_contact_runs_with_every_law(kind):
    law = EXAMPLES[kind]
    contact = sa.Contact(sa.Paraboloid(1e-8), sa.Elastic(2e9, 0.3), law)
    motion = sa.Triangle(start=3e-9, turn=0.1e-9, speed=1e-6)
    history = sa.solvers.Energy().solve(contact, motion, tolerance=1e-3)
    pull_off = -history.force.min() / (pi * 1e-8 * law.work_of_adhesion)
    assert 1.5 < pull_off < 2.0


EXAMPLES = {
    "lennard-jones": LJ,
    "van-der-waals": surfaces.VanDerWaals.from_work_of_adhesion(W, Z0, 6),
    "dmt": surfaces.DMT.from_work_of_adhesion(W, Z0),
    "exponential": surfaces.Exponential(W, Z0, 3e-10, 5e-11),
    "morse": surfaces.Morse(W, Z0, 1.5e-10),
    "dugdale": surfaces.Dugdale(W, Z0, 1e8),
    "dlvo": surfaces.DLVO(LJ.hamaker, Z0, 0.05, 3e-9),
    "tabulated": sampled(LJ),
    "sum": hard_and_soft(LJ.hamaker, Z0),
    "custom": surfaces.CustomSurface(lennard_jones, hamaker=LJ.hamaker, z0=Z0),
}


def test_work_by_adaptive_quadrature():
    law = EXAMPLES["dlvo"]
    ends = law.equilibrium_gap / Z0, 3, 30, 300, inf
    work = sum(
        quad(lambda x: -float(law.pressure(x * Z0)) * Z0, start, end, epsabs=1e-14)[0]
        for start, end in pairwise(ends)
    )
    assert work == pytest.approx(law.work_of_adhesion, rel=1e-8)


# Laws that are special cases of others

PROBES = Z0 * np.geomspace(0.6, 40, 200)


def assert_same(one, other, rel=1e-12):
    for quantity in ("pressure", "slope", "potential"):
        mine, others = (getattr(law, quantity)(PROBES) for law in (one, other))
        scale = np.abs(others[PROBES > Z0]).max()
        assert mine == pytest.approx(others, rel=rel, abs=1e-12 * scale)


def test_power_nine_is_lennard_jones():
    law = surfaces.VanDerWaals(LJ.hamaker, Z0)
    assert_same(law, LJ)
    assert law.work_of_adhesion == pytest.approx(LJ.work_of_adhesion)
    assert law.gap_of_largest_tension == pytest.approx(LJ.gap_of_largest_tension)
    assert law.range == pytest.approx(Z0)
    assert LJ.sharpness == pytest.approx(1, abs=1e-6)


@given(st.floats(3.5, 30))
def test_separate_repulsion(n):
    strength = 1e-19 / (6 * pi) * Z0 ** (n - 3)
    law = surfaces.VanDerWaals.from_repulsion(1e-19, strength, n)
    assert law.z0 == pytest.approx(Z0)
    gap = 0.8 * Z0
    assert law.pressure(gap) == pytest.approx(strength / gap**n - 1e-19 / (6 * pi * gap**3))


def test_morse_is_exponential_with_a_core_of_half_its_decay():
    assert_same(surfaces.Morse(W, Z0, 2e-10), surfaces.Exponential(W, Z0, 2e-10, 1e-10))


def test_hard_walls_leave_the_work_of_van_der_waals_attraction():
    # W of the bare attraction from z0 to infinity is H/(12πz0²).
    for wall in (0.1, 0.02):
        share = surfaces.DMT(1e-19, Z0, wall).work_of_adhesion * 12 * pi * Z0**2 / 1e-19
        assert share == pytest.approx(1 - 2 * wall)
    assert surfaces.DMT(1e-19, Z0).pressure(3 * Z0) == pytest.approx(
        -1e-19 / (6 * pi * 27 * Z0**3), rel=1e-7
    )


@pytest.mark.parametrize("smoothing", [0.02, 0.05, 0.1])
def test_smoothing_vanishes_from_dugdale(smoothing):
    # Maugis 1992: tension σ0 from z0 to z0 + W/σ0, and Φ falls in a straight line.
    law = surfaces.Dugdale(W, Z0, 1e8, smoothing)
    end = W / 1e8
    inside = Z0 + end * np.linspace(0.35, 0.65, 50)
    assert law.pressure(inside) == pytest.approx(-1e8, rel=5 * exp(-0.3 / smoothing))
    assert law.potential(inside) == pytest.approx(-W + 1e8 * (inside - Z0), abs=1.1 * smoothing * W)
    assert law.cohesive_range == pytest.approx((1 + smoothing) * end, rel=1e-3)
    assert law.pressure(Z0 + law.cohesive_range) == pytest.approx(-5e7, rel=1e-3)
    far = Z0 + end * (1 + 10 * smoothing)
    assert abs(law.pressure(far)) < 2e-4 * 1e8


def test_dlvo_without_charges_is_lennard_jones():
    assert_same(surfaces.DLVO(LJ.hamaker, Z0, 0.0, 1e-8), LJ)


def test_double_layer():
    # Israelachvili 2011, chapter 14: λ = 0.304 nm/√c in water at 25 °C; a 1:1 salt of number
    # density n, 64 kT n tanh²(eψ/4kT) exp(−κh); small charges, 2 ε κ² ψ² exp(−κh).
    for concentration in (1e-3, 0.1):
        law = surfaces.DLVO.from_concentration(1e-20, Z0, 0.1, concentration)
        assert law.debye_length == pytest.approx(0.304e-9 / concentration**0.5, rel=2e-3)
        n, kT = 6.02214e26 * concentration, 1.380649e-23 * 298.15
        gamma = np.tanh(1.602177e-19 * 0.1 / (4 * kT))
        assert law.double_layer_pressure == pytest.approx(64 * kT * n * gamma**2, rel=1e-5)
        gap = 3 * law.debye_length
        layers = law.pressure(gap) - surfaces.LennardJones(1e-20, Z0).pressure(gap)
        assert layers == pytest.approx(law.double_layer_pressure * exp(-3), rel=1e-10)
    weak = surfaces.DLVO(1e-20, Z0, 1e-3, 1e-8)
    assert weak.double_layer_pressure == pytest.approx(
        2 * 78.4 * 8.8541878e-12 * 1e-6 / 1e-16, rel=1e-3
    )
    opposite = surfaces.DLVO(1e-20, Z0, 0.02, 1e-8, tip_potential=-0.02)
    assert opposite.double_layer_pressure < 0
    assert surfaces.DLVO(1e-20, Z0, 0.02, 1e-8, tip_potential=0.0).double_layer_pressure == 0


def test_of_two_wells_the_deeper_tension_is_the_contact():
    law = surfaces.DLVO.from_concentration(5e-21, Z0, 0.03, 0.01)
    assert law.equilibrium_gap == pytest.approx(Z0, rel=0.05)
    far = np.linspace(2e-9, 6e-8, 2000)
    assert law.pressure(far)[0] > 0 > law.pressure(far).min() > -law.largest_tension
    barred = surfaces.DLVO.from_concentration(2e-21, Z0, 0.2, 0.5)
    assert barred.equilibrium_gap > 5 * Z0


def test_the_width_of_a_well_does_not_count_the_barrier_outside():
    law = sa.DLVO(2e-20, 0.3e-9, 0.04, 2e-9)
    gaps = np.linspace(law.equilibrium_gap, 5e-9, 200_001)
    tension = np.fmax(-law.pressure(gaps), 0.0)
    work = float(tension.sum() * (gaps[1] - gaps[0]))
    assert work > 1.05 * law.work_of_adhesion
    width = 16 / (9 * np.sqrt(3)) * work / law.largest_tension
    assert law.width_of_well == pytest.approx(width, rel=1e-3)
    smooth = sa.Morse(0.05, 0.3e-9, 0.1e-9)
    assert smooth.width_of_well == pytest.approx(smooth.range)


def test_a_barrier_that_outweighs_the_well_leaves_no_adhesion():
    law = surfaces.DLVO.from_concentration(5e-21, Z0, 0.05, 0.1)
    assert law.attracts
    assert law.work_of_adhesion < 0
    contact = sa.Contact(sa.Paraboloid(1e-8), sa.Elastic(1e9, 0.3), law)
    assert not contact.adhesive
    assert contact.tabor_relaxed == 0
    with pytest.raises(ValueError, match=r"work of adhesion is -.* a range needs one above 0"):
        _ = law.range
    assert len(plot_surface(law).axes) == 2


def test_repulsion():
    law = surfaces.Repulsion(1e7, 2e-9)
    assert law.pressure(0.0) == 1e7
    assert law.pressure(2e-9) == pytest.approx(1e7 / np.e)
    assert law.potential(0.0) == pytest.approx(0.02)
    assert not law.attracts
    assert law.work_of_adhesion == law.largest_tension == 0
    contact = sa.Contact(sa.Paraboloid(1e-8), sa.Elastic(1e9, 0.3), law)
    assert contact.tabor_relaxed == 0
    assert contact.reach == pytest.approx(2e-9)


def test_attraction_alone_is_a_part():
    part = surfaces.VanDerWaalsAttraction(1e-19, 2e-10)
    gap = 2e-10 * np.array([1.0, 1.5, 10.0])
    assert part.pressure(gap) == pytest.approx(-1e-19 / (6 * pi * gap**3))
    assert part.potential(gap) == pytest.approx(-1e-19 / (12 * pi * gap**2))
    inside = 2e-10 * np.linspace(-1, 1.2, 401)
    assert part.slope(inside) == pytest.approx(derivative(part.pressure, inside, 1e-14), rel=1e-5)
    with pytest.raises(ValueError, match=r"must repel .* add a repulsion"):
        _ = part.work_of_adhesion


# Sums


def test_two_halves_make_a_whole():
    half = surfaces.LennardJones(LJ.hamaker / 2, Z0)
    whole = half + half
    assert whole == surfaces.SumOfLaws((half, half))
    assert_same(whole, LJ)
    assert whole.work_of_adhesion == pytest.approx(W)
    assert whole.equilibrium_gap == pytest.approx(Z0, rel=1e-12)
    assert whole.range == pytest.approx(Z0)
    assert whole.sharpness == pytest.approx(1, abs=1e-6)


def test_sums_are_flat_and_sum_all_that_parts_say():
    parts = LJ, surfaces.Repulsion(1e7, 1e-9), EXAMPLES["custom"], EXAMPLES["tabulated"]
    law = parts[0] + parts[1] + (parts[2] + parts[3])
    assert law.parts == parts
    assert len(law.terms) == 4
    for quantity in ("pressure", "slope", "potential"):
        total = sum(getattr(part, quantity)(PROBES) for part in parts)
        assert getattr(law, quantity)(PROBES) == pytest.approx(total, rel=1e-13)
    compiled, _, parameters = law.compiled_pressure
    p, slope = np.empty((2, PROBES.size))
    compiled(PROBES, parameters, p, slope, PROBES.size)
    assert p == pytest.approx(law.pressure(PROBES), rel=1e-10, abs=1e-4)
    assert law.closest_gap == 0
    assert (parts[1] + EXAMPLES["morse"]).closest_gap == -inf


# Data


@pytest.mark.parametrize(("points", "error"), [(50, 2e-3), (400, 1e-6), (1600, 1e-8)])
def test_tables_of_lennard_jones(points, error):
    table = surfaces.Tabulated.from_function(LJ.pressure, 0.5 * Z0, 1e-8, points)
    assert table.work_of_adhesion == pytest.approx(W, rel=error)
    assert table.equilibrium_gap == pytest.approx(Z0, rel=max(error, 2e-6))
    assert table.range == pytest.approx(Z0, rel=10 / points**1.5)
    beyond = np.geomspace(1e-8, 1e-6, 20)
    assert table.pressure(beyond) == pytest.approx(LJ.pressure(beyond), rel=1e-6)
    assert table.potential(beyond) == pytest.approx(LJ.potential(beyond), rel=1e-6)


def test_tables_pass_their_points_without_bumps_and_join_smoothly():
    gaps = 1e-10 * np.array([1, 1.5, 2, 4, 4.5, 9])
    pressures = np.array([5e8, 1e8, -1e8, -1e8, -2e7, -1e6])
    law = surfaces.Tabulated(gaps, list(pressures))
    assert law.pressure(gaps) == pytest.approx(pressures)
    between = law.pressure(np.linspace(1e-10, 9e-10, 5001))
    assert -1e8 * (1 + 1e-12) <= between.min() < between.max() <= 5e8 * (1 + 1e-12)
    for joint in gaps:
        for quantity in (law.pressure, law.slope, law.potential):
            before, after = quantity(joint * (1 - 1e-9)), quantity(joint * (1 + 1e-9))
            assert before == pytest.approx(after, rel=1e-6, abs=1e-6 * abs(quantity(1e-10)))
    inside = law.pressure(np.linspace(-2e-10, 1e-10, 50))
    assert np.all(np.diff(inside) < 0)
    power = log(20) / log(2)
    assert law.pressure(9e-9) == pytest.approx(-1e6 * 10**-power)


def test_tables_that_end_at_zero_stay_there():
    law = surfaces.Tabulated((1e-10, 2e-10, 3e-10, 5e-10), (1e8, 0.0, -5e7, 0.0))
    assert law.pressure(5e-10) == law.slope(5e-10) == 0
    assert law.potential(5e-10) == pytest.approx(0, abs=1e-15)
    assert law.pressure(1e-8) == 0
    assert law.potential(1e-8) == pytest.approx(0, abs=1e-15)
    assert law.work_of_adhesion > 0


def test_tails_fall_fast_enough_to_have_a_potential():
    gaps = np.geomspace(1e-10, 1e-8, 40)
    slow = 1e8 * np.exp(1 - gaps / 1e-10) - 1e6 * (1e-10 / gaps) ** 1.2
    law = surfaces.Tabulated(gaps, slow)
    assert law.pressure(4e-8) == pytest.approx(law.pressure(1e-8) / 4**1.5)


def test_laws_from_files(tmp_path):
    path = tmp_path / "law.csv"
    path.write_text("gap (nm),pressure (MPa),note\n0.2,900,a\n0.3,0,\n\n0.5,-100,\n1,-5,\n")
    law = surfaces.read_law(path)
    assert law.gaps == pytest.approx((2e-10, 3e-10, 5e-10, 1e-9))
    assert law.pressures == pytest.approx((9e8, 0.0, -1e8, -5e6))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "its header must read, for example, 'gap .nm"),
        ("gap (nm),pressure\n", "column 'pressure' has no unit"),
        ("gap (s),pressure (Pa)\n", r"column 'gap \(s\)' must name a unit of a length"),
        ("gap (nm),pressure (nm)\n", r"column 'pressure \(nm\)' must name a unit of a pressure"),
        (
            "gap (nm),pressure (Pa)\n0.1,5\n0.2,much\n",
            r"line 3 \('0.2,much'\): 'pressure' must be a finite number",
        ),
        ("gap (nm),pressure (Pa)\n0.1,5\n", "gaps has 1 entries: must have at least 4"),
    ],
)
def test_bad_files_are_refused(tmp_path, text, message):
    path = tmp_path / "law.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=message):
        surfaces.read_law(path)


# Users' functions


def test_a_users_function_has_the_numbers_of_a_built_in_law():
    mine = EXAMPLES["custom"]
    assert_same(mine, LJ, rel=1e-11)
    assert mine.pressure(Z0).shape == ()
    assert mine.slope(np.ones((2, 3)) * 1e-9).shape == (2, 3)
    assert mine.work_of_adhesion == pytest.approx(W)
    assert mine.gap_of_largest_tension == pytest.approx(LJ.gap_of_largest_tension)


def test_users_functions_are_known_by_function_and_parameters():
    same = surfaces.CustomSurface(lennard_jones, z0=Z0, hamaker=LJ.hamaker)
    assert same == EXAMPLES["custom"]
    assert hash(same) == hash(EXAMPLES["custom"])
    assert same.parameters == (("hamaker", LJ.hamaker), ("z0", Z0))
    assert same != surfaces.CustomSurface(lennard_jones, z0=1e-10, hamaker=LJ.hamaker)


def test_compiled_functions_defaults_and_kinks_are_welcome():
    @njit
    def bilinear(gap, stiffness=1e18, reach=1e-9):
        if gap > reach:
            return 0.0, 0.0, 0.0
        if gap > 0.5 * reach:
            left = reach - gap
            return -0.2 * stiffness * left, 0.2 * stiffness, -0.1 * stiffness * left**2
        depth, end = 0.5 * reach - gap, -0.1 * stiffness * reach
        energy = -0.025 * stiffness * reach**2 + end * depth + 0.5 * stiffness * depth**2
        return end + stiffness * depth, -stiffness, energy

    law = surfaces.CustomSurface(bilinear)
    assert law.equilibrium_gap == pytest.approx(0.4e-9)
    assert law.largest_tension == pytest.approx(1e8, rel=1e-3)
    assert law.work_of_adhesion == pytest.approx(0.03)


def test_rounding_and_underflow_are_no_inconsistency():
    def rounded(gap, tension, width):
        x = np.exp((3e-10 - gap) / width)
        inside = x / (x + 1e-3)
        wall = x / 1.001
        energy = tension * width * (wall - np.log(1 + 1e3 * x))
        return tension * (wall - inside), tension / width * (inside * (1 - inside) - wall), energy

    law = surfaces.CustomSurface(rounded, tension=1e8, width=3e-11)
    assert law.equilibrium_gap == pytest.approx(3e-10)


def wrong_slope(gap, a):
    return a / gap**3, -a / gap**4, a / (2 * gap**2)


def wrong_potential(gap, a):
    return a / gap**3, -3 * a / gap**4, a / gap**2


def no_limit(gap, a):
    return a / gap**3, -3 * a / gap**4, a / (2 * gap**2) + 1e3


def two_results(gap, a):
    return a / gap**3, a


def not_a_number(gap, a):
    return a / gap**3, -3 * a / gap**4, a / (2 * gap**2) if gap < 1e-8 else np.nan


@pytest.mark.parametrize(
    ("function", "parameters", "message"),
    [
        (wrong_slope, {"a": 1e-20}, r"wrong_slope: slope -.* Pa/m at .* m: must be dp/dh = -"),
        (wrong_potential, {"a": 1e-20}, r"pressure .* Pa at .* m: must be −dΦ/dh = "),
        (no_limit, {"a": 1e-20}, r"potential 1000 J/m² at 1 m: must vanish"),
        (two_results, {"a": 1e-20}, r"two_results: must be one that numba compiles and that ret"),
        (not_a_number, {"a": 1e-20}, r"potential nan at .* m: must be finite"),
        (wrong_slope, {}, r"^a: missing"),
        (wrong_slope, {"a": 1.0, "b": 2.0}, r"^b: must be a parameter of the function"),
        (wrong_slope, {"a": nan}, r"^a = nan"),
        (3.0, {}, r"^function = 3.0: must be a Python function"),
    ],
)
def test_inconsistent_functions_are_refused(function, parameters, message):
    with pytest.raises(ValueError, match=message) as caught:
        surfaces.CustomSurface(function, **parameters)
    assert len(str(caught.value).splitlines()) == 1


# Refusals

GOOD = {
    surfaces.VanDerWaals: {"hamaker": 1e-19, "z0": Z0, "exponent": 9},
    surfaces.VanDerWaals.from_repulsion: {"hamaker": 1e-19, "strength": 4e-78, "exponent": 9},
    surfaces.VanDerWaals.from_work_of_adhesion: {"W": W, "z0": Z0, "exponent": 9},
    surfaces.VanDerWaalsAttraction: {"hamaker": 1e-19, "cutoff": 2e-10},
    surfaces.DMT: {"hamaker": 1e-19, "z0": Z0, "wall": 0.1},
    surfaces.DMT.from_work_of_adhesion: {"W": W, "z0": Z0, "wall": 0.1},
    surfaces.Exponential: {"work_of_adhesion": W, "z0": Z0, "decay": 2e-10, "core": 1e-10},
    surfaces.Morse: {"work_of_adhesion": W, "z0": Z0, "decay": 2e-10},
    surfaces.Dugdale: {"work_of_adhesion": W, "z0": Z0, "tension": 1e8, "smoothing": 0.1},
    surfaces.DLVO: {
        "hamaker": 1e-20, "z0": Z0, "surface_potential": 0.05, "debye_length": 1e-9,
        "temperature": 300, "permittivity": 80,
    },
    surfaces.DLVO.from_concentration: {
        "hamaker": 1e-20, "z0": Z0, "surface_potential": 0.05, "concentration": 0.1,
    },
    surfaces.Repulsion: {"pressure_at_zero": 1e8, "decay": 1e-9},
}  # fmt: skip
CASES = [(build, field) for build, values in GOOD.items() for field in values]


@pytest.mark.parametrize(
    ("build", "field"), CASES, ids=[f"{build.__qualname__}-{field}" for build, field in CASES]
)
@pytest.mark.parametrize("bad", [nan, inf, -1e9, None, "", "0.3 nm", [1.0], True])
def test_bad_numbers_are_refused(build, field, bad):
    build(**GOOD[build])
    with pytest.raises(ValueError, match=r"must") as caught:
        build(**{**GOOD[build], field: bad})
    assert str(caught.value).startswith(field)
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize(
    ("build", "change", "message"),
    [
        (surfaces.VanDerWaals, {"exponent": 3.0}, "exponent = 3: must be above 3"),
        (surfaces.VanDerWaals, {"z0": 0.3}, "z0 = 0.3 m: must be between 2e-12 and 1e-06"),
        (surfaces.VanDerWaals.from_repulsion, {"strength": 1.0}, r"^strength = 1 Pa m\^n: .*must"),
        (surfaces.DMT, {"wall": 0.3}, "wall = 0.3: must be between 0.02 and 0.25"),
        (surfaces.Exponential, {"core": 3e-10}, "core = 3e-10 m: must be shorter than decay"),
        (surfaces.Dugdale, {"smoothing": 0.5}, "smoothing = 0.5: must be between 0.02 and 0.3"),
        (surfaces.Dugdale, {"tension": 100.0}, "tension = 100 Pa: .* must be between"),
        (surfaces.DLVO, {"surface_potential": 25}, "surface_potential = 25 V: must be between"),
        (surfaces.DLVO, {"tip_potential": "x"}, "tip_potential = 'x': must be a number in V"),
        (surfaces.DLVO, {"temperature": 25}, "temperature = 25 K: must be between 200"),
    ],
)
def test_values_that_make_no_law_are_refused(build, change, message):
    with pytest.raises(ValueError, match=message):
        build(**{**GOOD[build], **change})


GAPS, PRESSURES = (1e-10, 2e-10, 3e-10, 4e-10), (1e8, 0.0, -5e7, -1e7)


@pytest.mark.parametrize(
    ("gaps", "pressures", "message"),
    [
        (GAPS[:3], PRESSURES[:3], "gaps has 3 entries: must have at least 4"),
        (GAPS, PRESSURES[:3], "pressures has 3 entries: must have as many as gaps, 4"),
        ((0.0, *GAPS[1:]), PRESSURES, r"gaps\[0\] = 0 m: must be greater than 0"),
        ((*GAPS[:2], 2e-10, 4e-10), PRESSURES, r"gaps\[2\] = 2e-10 m: must be above gaps\[1\]"),
        (GAPS, (-1e8, *PRESSURES[1:]), r"pressures\[0\] = -1e\+08 Pa at 1e-10 m: must repel"),
        (GAPS, (1e8, 2e8, -5e7, -1e7), r"pressures\[1\] = 2e\+08 Pa: must be below"),
        (GAPS, (1e8, nan, -5e7, -1e7), r"pressures\[1\] = nan Pa: must be a finite"),
        (GAPS, (1e8, 0.0, -5e7, -6e7), r"pressures\[3\] = -6e\+07 Pa after .*: must fade"),
        (GAPS, (1e8, 0.0, -5e7, 1e5), r"pressures\[3\] = 100000 Pa after .*: must fade"),
        ("0.1", PRESSURES, "gaps = '0.1': must be a list of numbers in m"),
        (GAPS, 3.0, "pressures = 3.0: must be a list of numbers in Pa"),
    ],
)
def test_tables_that_make_no_law_are_refused(gaps, pressures, message):
    with pytest.raises(ValueError, match=message):
        surfaces.Tabulated(gaps, pressures)


def test_samples_out_of_range_are_refused():
    for shortest, longest, points, name in (
        (1e-12, 1e-8, 400, "shortest"),
        (1e-10, 1e-10, 400, "longest"),
        (1e-10, 1e-8, 3, "points"),
    ):
        with pytest.raises(ValueError, match=rf"^{name} = .* must"):
            surfaces.Tabulated.from_function(LJ.pressure, shortest, longest, points)


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ((), "parts is empty"),
        (LJ, "must be a list of surface laws"),
        ("lj", "must be a list of surface laws"),
        ((LJ, 3.0), r"parts\[1\] = 3.0: must be a surface law"),
    ],
)
def test_sums_of_what_is_no_law_are_refused(parts, message):
    with pytest.raises(ValueError, match=message):
        surfaces.SumOfLaws(parts)
    with pytest.raises(TypeError):
        _ = LJ + 3.0


@pytest.mark.parametrize("name", ["equilibrium_gap", "gap_of_largest_tension", "range"])
def test_where_there_is_no_well_adhesion_is_refused(name):
    with pytest.raises(ValueError, match=r"^surface law 'repulsion': has no attractive well"):
        getattr(surfaces.Repulsion(1e8, 1e-9), name)


def test_attraction_that_does_not_fade_is_refused():
    def steady(gap, tension):
        wall = exp(-gap / 2e-11) * 1e12
        fall = 1 / cosh(gap / 1e-4)
        p = wall - tension * gap * fall
        return p, 0.0 * gap, 0.0 * gap

    law = object.__new__(surfaces.CustomSurface)  # whose potential would not pass
    object.__setattr__(law, "function", steady)
    object.__setattr__(law, "parameters", (("tension", 1e12),))
    with pytest.raises(ValueError, match="attracts ever more up to a gap of 1e-06 m"):
        _ = law.equilibrium_gap


# Drawing


def test_drawings_mark_what_a_law_says():
    figure = plot_surface(LJ)
    shown = [text.get_text() for ax in figure.axes for text in ax.texts]
    assert shown == [
        "equilibrium gap 300 pm",
        "largest tension 171.1 MPa\nat 360.3 pm",
        "work of adhesion 50 mJ/m²",
    ]
    pressure, potential = figure.axes
    assert pressure.get_xlabel() == "Gap (nm)"
    assert (pressure.get_ylabel(), potential.get_ylabel()) == (
        "Pressure (MPa)", "Potential (mJ/m²)",
    )  # fmt: skip
    low, high = pressure.get_ylim()
    assert low < -171 < 0 < high


def test_drawings_of_many_laws_have_a_legend():
    many = [*EXAMPLES.values(), surfaces.Repulsion(1e8, 1e-9)]
    figure = plot_surface(many, largest_gap=2e-9)
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [law.kind for law in many]
    assert figure.axes[0].get_xlim()[1] == pytest.approx(2)
    assert not plot_surface(surfaces.Repulsion(1e8, 1e-9)).legends


@pytest.mark.parametrize(("drawn", "labels"), [([], None), ([LJ], ["a", "b"])])
def test_drawings_of_nothing_are_refused(drawn, labels):
    with pytest.raises(ValueError, match="must"):
        plot_surface(drawn, labels)


# The page


def test_the_page_on_surface_laws_runs(tmp_path):
    from test_docs import example_module

    page = example_module("surfaces.md", tmp_path)
    assert page.contact.surface.work_of_adhesion == pytest.approx(0.05)
    assert 0 < page.coated.work_of_adhesion < 0.05
    for law in (page.table, page.solvation, page.own):
        assert law.work_of_adhesion > 0
    assert page.figure.axes
