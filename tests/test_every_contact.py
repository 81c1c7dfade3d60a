"""Every law, tip and rheology in the solvers against closed forms and published limits."""

from math import pi, sqrt

import numpy as np
import pytest
from scipy.special import beta, dawsn

import softafm as sa

W, Z0, R = 0.05, 3e-10, 20e-9


def morse(gap, work, z0, decay):
    far = np.exp(-(gap - z0) / decay)
    near = far * far
    return (
        2 * work / decay * (near - far),
        2 * work / decay**2 * (far - 2 * near),
        work * (near - 2 * far),
    )


LENNARD_JONES = sa.LennardJones.from_work_of_adhesion(W, Z0)
GAPS = np.geomspace(1.5e-10, 3e-8, 200)
LAWS = {
    "lennard-jones": LENNARD_JONES,
    "van-der-waals": sa.VanDerWaals.from_work_of_adhesion(W, Z0, exponent=12.0),
    "dmt": sa.DMT.from_work_of_adhesion(W, Z0),
    "exponential": sa.Exponential(W, Z0, decay=1.5e-10, core=0.5e-10),
    "morse": sa.Morse(W, Z0, decay=1.2e-10),
    "dugdale": sa.Dugdale(W, Z0, tension=W / Z0, smoothing=0.2),
    "dlvo": sa.DLVO(16 * pi * W * Z0**2, Z0, surface_potential=0.02, debye_length=5e-9),
    "tabulated": sa.Tabulated(tuple(GAPS), tuple(LENNARD_JONES.pressure(GAPS))),
    "sum": sa.VanDerWaals.from_work_of_adhesion(W / 2, Z0) + sa.Morse(W / 2, Z0, decay=1.2e-10),
    "custom": sa.CustomSurface(morse, work=W, z0=Z0, decay=1.2e-10),
}


def pull_off(law, tabor):
    """Force at pull-off over πRW of an elastic sample of this Tabor number."""
    work, reach = law.work_of_adhesion, law.range
    modulus = sqrt(R * work**2 / reach**3 / tabor**3)
    contact = sa.Contact(sa.Paraboloid(R), sa.Elastic(modulus, 0.0), law)
    assert contact.tabor_relaxed == pytest.approx(tabor, rel=1e-3)
    depth = contact.contact_radius(0.0) ** 2 / R
    far = max(12 * reach + law.equilibrium_gap, depth)
    motion = sa.Triangle(far, 0.95 * law.equilibrium_gap - 0.2 * depth, speed=1e-6)
    return float(sa.force_distance(contact, motion).force_min) / (-pi * work * R)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_stiff_contacts_part_at_twice_pi_r_w(law):
    # Derjaguin: 2πRW of a rigid sphere whatever the law; CHECKS: 1.98865 at μ = 0.05.
    assert pull_off(law, 0.02) == pytest.approx(2, rel=5e-3)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_soft_contacts_part_as_jkr(law):
    # JKR: 1.5πRW. A Lennard-Jones law is 1.5 % above at μ = 5 (CHECKS: 1.527).
    assert 1.5 * 0.995 < pull_off(law, 5.0) < 1.5 * 1.03


def test_contacts_of_one_tabor_number_are_alike_whatever_the_law():
    # Lennard-Jones at μ = 0.3 and 1: 1.87018, 1.67067 (CHECKS). Others differ by a few per cent.
    for tabor, lennard_jones in ((0.3, 1.87018), (1.0, 1.67067)):
        for law in LAWS.values():
            assert pull_off(law, tabor) == pytest.approx(lennard_jones, rel=0.035)


def test_a_function_of_ones_own_gives_what_the_built_in_law_gives():
    curves = []
    for law in (LAWS["morse"], LAWS["custom"]):
        sample = sa.StandardLinearSolid(2e9, 0.3e9, 1e-6, 0.4)
        contact = sa.Contact(sa.Paraboloid(R), sample, law)
        motion = sa.Sine(mean_height=9.5e-9, amplitude=10e-9, frequency=1e5)
        curves.append(sa.force_distance(contact, motion))
    built_in, own = curves
    assert float(own.force_max) == pytest.approx(float(built_in.force_max), rel=5e-3)
    assert float(own.loop_energy) == pytest.approx(float(built_in.loop_energy), rel=1e-2)


def test_a_law_that_ends_too_sharply_warns():
    law = sa.Dugdale(W, Z0, tension=W / Z0, smoothing=0.03)
    contact = sa.Contact(sa.Paraboloid(R), sa.Elastic(1e11, 0.3), law)
    with pytest.warns(sa.AccuracyWarning, match=r"'dugdale' ends 7 times as sharply"):
        sa.force_distance(contact, sa.Triangle(3e-9, 0.35e-9, 1e-6))


# Viscoelastic indentation without adhesion: a short-ranged repulsion, contact at its own gap.

RADIUS, DEPTH, TIME = 1e-6, 10e-9, 1e-3
SPEED = DEPTH / TIME
MODULUS = 1e7


def indent(sample, stiffness, decay=DEPTH / 2000):
    """Force over (4/3)√R v^1.5 as a function of time since contact, and the curve.

    ``stiffness`` is a modulus that tells at which gap the surfaces touch.
    """
    law = sa.Repulsion(1e3 * stiffness, decay)
    touching = decay * np.log(1e3 / (0.3 * sqrt(DEPTH / RADIUS)))
    contact = sa.Contact(sa.Paraboloid(RADIUS), sample, law)
    start = touching + contact.edge_gap + 0.3 * DEPTH
    curve = sa.force_distance(contact, sa.Triangle(start, touching - DEPTH, SPEED))
    first = (start - touching) / SPEED
    force = curve.force.values / (4 / 3 * sqrt(RADIUS) * SPEED**1.5)
    return lambda time: np.interp(time + first, curve.time.values, force), curve


# k = E0/E_inf, q = relaxation time over that of the approach: f(.5), f(1), f(1.05), f(1.1) and the
# loop, all over their value for an elastic sample of E_inf (CHECKS: Ting 1966, Lee and Radok 1960).
TING = {
    (10, 0.05): (0.8055358, 1.6576666, 0.7574299, 0.432382, 0.67164812),
    (10, 0.2): (1.7734317, 3.3875963, 2.1976052, 1.2839526, 1.42980651),
    (10, 1): (2.9808021, 7.2359267, 6.2080011, 5.2472764, 1.62747831),
    (2, 0.5): (0.5985237, 1.5100045, 1.3170215, 1.139484, 0.25567113),
}


@pytest.mark.parametrize(("ratio", "share"), TING)
def test_indentation_and_retraction_follow_ting(ratio, share):
    *forces, loop = TING[ratio, share]
    sample = sa.StandardLinearSolid.from_relaxation_time(
        ratio * MODULUS, MODULUS, share * TIME, poisson=0.0
    )
    force, curve = indent(sample, ratio * MODULUS)
    found = force(TIME * np.array([0.5, 1, 1.05, 1.1])) / (MODULUS * TIME**1.5)
    assert found == pytest.approx(forces, rel=0.015)
    elastic = 4 / 3 * sqrt(RADIUS) * MODULUS * DEPTH**2.5
    assert float(curve.loop_energy) / elastic == pytest.approx(loop, rel=3e-3)


@pytest.mark.parametrize("relaxation_time", [1e-4, 1e-3, 1e-2])
def test_a_maxwell_fluid_follows_lee_and_radok(relaxation_time):
    # F ~ ∫ E(t − s) (3/2)√s ds with E(t) = E0 exp(−t/λ); Daw is Dawson's function.
    force, _ = indent(sa.Maxwell(MODULUS, relaxation_time, 0.0), MODULUS)
    t = TIME * np.array([0.5, 0.75, 1])
    root = np.sqrt(t / relaxation_time)
    wanted = MODULUS * 1.5 * relaxation_time**1.5 * (root - dawsn(root))
    assert force(t) == pytest.approx(wanted, rel=5e-3)


@pytest.mark.parametrize("creep_time", [1e-5, 1e-4, 1e-3])
def test_a_kelvin_voigt_solid_follows_lee_and_radok(creep_time):
    # Stress E ε + E τ dε/dt: F ~ E (t^1.5 + τ (3/2) √t).
    stiffness = MODULUS * (1 + 3 * creep_time / TIME)
    force, _ = indent(sa.KelvinVoigt(MODULUS, creep_time, 0.0), stiffness)
    t = TIME * np.array([0.5, 0.75, 1])
    assert force(t) == pytest.approx(MODULUS * (t**1.5 + 1.5 * creep_time * np.sqrt(t)), rel=5e-3)


@pytest.mark.parametrize("exponent", [0.1, 0.3, 0.6])
def test_a_power_law_follows_lee_and_radok(exponent):
    # E(t) = E1 (t/t0)^−a: F ~ E1 t0^a (3/2) B(1 − a, 3/2) t^(3/2 − a).
    sample = sa.PowerLaw(MODULUS, exponent, (1e-6, 1e-2), 0.0, reference_time=TIME)
    force, _ = indent(sample, MODULUS)
    t = TIME * np.array([0.5, 0.75, 1])
    wanted = MODULUS * TIME**exponent * 1.5 * beta(1 - exponent, 1.5) * t ** (1.5 - exponent)
    assert force(t) == pytest.approx(wanted, rel=0.015)  # 1 % of it is the series


# One sample written in several ways


def tap(sample, **options):
    contact = sa.Contact(sa.Paraboloid(10e-9), sample, sa.LennardJones(1e-19, 0.25e-9))
    return sa.tapping_cycle(contact, 49.6e-9, 46e-9, 278e3, cycles=1, **options)


def test_one_term_series_are_the_standard_linear_solid():
    solid = sa.samples.ldpe()
    E0, E_inf, nu = solid.E0, solid.E_inf, solid.poisson
    relaxation = solid.creep_time * E_inf / E0
    expected = tap(solid)
    for twin in (
        sa.GeneralizedMaxwell(E_inf, (E0 - E_inf,), (relaxation,), nu),
        sa.GeneralizedKelvinVoigt(E0, (1 / E_inf - 1 / E0,), (solid.creep_time,), nu),
    ):
        found = tap(twin)
        assert found.force.values == pytest.approx(
            expected.force.values, abs=1e-7 * float(expected.force_max)
        )
        assert float(found.dissipation) == pytest.approx(float(expected.dissipation), rel=1e-7)


def test_an_ever_stiffer_spring_makes_the_kelvin_voigt_solid():
    relaxed = sa.KelvinVoigt(1e8, 1e-7, 0.49)
    limit = tap(relaxed)
    off = []
    for stiffness in (1e10, 1e11, 1e12):
        found = tap(sa.StandardLinearSolid(stiffness, 1e8, 1e-7, 0.49))
        off.append(abs(float(found.dissipation / limit.dissipation) - 1))
    assert off[2] < 0.01
    assert off[2] < off[0]


def test_fluids_have_no_steady_cycle():
    fluid = sa.Contact(sa.Paraboloid(10e-9), sa.Maxwell(1e9, 1e-6, 0.5), LENNARD_JONES)
    with pytest.raises(ValueError, match=r"cycles = 'steady': the sample 'maxwell' flows"):
        sa.tapping_cycle(fluid, 50e-9, 48e-9, 278e3)
    lever = sa.Cantilever(28.1, 430, 278e3)
    with pytest.raises(ValueError, match=r"no height .* the sample 'maxwell' flows"):
        sa.approach_curve(fluid, lever, 15e-9, [0.5])


# The paper's solvers

CONTACTS = {
    "cone, Morse, Prony": (
        sa.Cone(0.6, 10e-9),
        sa.GeneralizedMaxwell(1e9, (1e9, 2e9), (1e-7, 1e-6), 0.35),
        sa.Morse(0.02, Z0, 1.2e-10),
    ),
    "sphere, DLVO, Maxwell": (
        sa.Sphere(10e-9),
        sa.Maxwell(3e9, 1e-6, 0.35),
        sa.DLVO(16 * pi * 0.02 * Z0**2, Z0, surface_potential=0.02, debye_length=5e-9),
    ),
    "punch, no adhesion, Kelvin-Voigt chain": (
        sa.Hyperboloid(10e-9, 0.5),
        sa.GeneralizedKelvinVoigt(4e9, (1e-10, 2e-10), (1e-7, 1e-5), 0.35),
        sa.Repulsion(1e12, 3e-11),
    ),
}


@pytest.mark.parametrize("parts", CONTACTS.values(), ids=CONTACTS)
def test_the_solvers_of_the_paper_take_them_all(parts):
    contact = sa.Contact(*parts)
    motion = sa.Sine(mean_height=10.2e-9, amplitude=10e-9, frequency=278e3)
    expected = sa.force_distance(contact, motion, tolerance=1e-3)
    scale = float(np.abs(expected.force.values).max())
    for solver in (
        sa.solvers.EnhancedAttard(functions=50, nodes=150, steps=20_000),
        sa.solvers.Attard(nodes=150, method="explicit", steps=20_000),
    ):
        found = sa.force_distance(contact, motion, solver=solver)
        assert float(found.force_max) == pytest.approx(float(expected.force_max), abs=0.01 * scale)
        assert float(found.force_min) == pytest.approx(float(expected.force_min), abs=0.01 * scale)
        span = scale * 10 * Z0
        assert float(found.loop_energy - expected.loop_energy) == pytest.approx(0, abs=0.01 * span)
