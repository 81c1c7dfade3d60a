"""The scales of a contact against values worked out by hand and the theory of JKR."""

from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import softafm as sa

# Radii up to a metre: scales hold for all sizes.
pytestmark = pytest.mark.filterwarnings("ignore::softafm.errors.DoubtfulValueWarning")

LDPE = sa.Contact(
    tip=sa.Paraboloid(radius=10e-9),
    sample=sa.StandardLinearSolid(E0=2e9, E_inf=0.1e9, creep_time=1e-7, poisson=0.49),
    surface=sa.LennardJones(hamaker=1e-19, z0=0.25e-9),
)


def decades(low, high):
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


contacts = st.builds(
    lambda R, E, W, z0: sa.Contact(
        sa.Paraboloid(R), sa.Elastic(E, 0.3), sa.LennardJones.from_work_of_adhesion(W, z0)
    ),
    decades(-10, 0),
    decades(0, 13),
    decades(-8, 3),
    decades(-11, -7),
)


def scales(contact):
    """Radius R of the tip, the adhesion 2πW/E of JKR in m, and pull-off (radius, height) in m."""
    R = contact.tip.radius
    pull = 2 * pi * contact.surface.work_of_adhesion * contact.body.compliance.relaxed
    radius = (R**2 * pull / 16) ** (1 / 3)
    return R, pull, radius, 3 * radius**2 / R


def test_ldpe():
    # W = H/(16πz0²) = 0.1/π J/m², 1 - ν² = 0.7599, so E = 0.13160 and 2.6319 GPa.
    assert LDPE.tabor_relaxed == pytest.approx(3.3456, rel=1e-4)
    assert LDPE.tabor_instantaneous == pytest.approx(0.45406, rel=1e-4)
    assert LDPE.cohesive_length == pytest.approx(0.25839e-9, rel=1e-4)
    assert LDPE.cohesive_length_instantaneous == pytest.approx(5.1678e-9, rel=1e-4)


@given(contacts)
def test_tabor_number_and_cohesive_length_are_one_scale(contact):
    # ℓ μ² = (R² W/E)^(1/3), the width of a contact at pull-off but for a number.
    R, pull, _, _ = scales(contact)
    width = (R**2 * pull / (2 * pi)) ** (1 / 3)
    assert contact.cohesive_length * contact.tabor_relaxed**2 == pytest.approx(width)


@given(contacts, st.one_of(st.just(0.0), decades(-15, 12)))
def test_contact_radius_solves_the_equation_of_jkr(contact, indentation):
    R, pull, smallest, pull_off = scales(contact)
    height = -indentation * pull_off
    a = contact.contact_radius(height)
    assert a > smallest  # the stable branch
    size = a**2 / R
    assert a**2 / R - sqrt(pull * a) + height == pytest.approx(0, abs=1e-9 * size)


@given(contacts, st.floats(0, 1))
def test_a_risen_tip_stays_in_contact_up_to_pull_off(contact, rise):
    assume(rise < 1 - 1e-6)
    R, pull, smallest, pull_off = scales(contact)
    a = contact.contact_radius(rise * pull_off)
    assert a > smallest
    assert a**2 / R + rise * pull_off == pytest.approx(sqrt(pull * a), rel=1e-9)


@given(contacts, decades(-6, 6))
def test_no_contact_above_pull_off(contact, beyond):
    assert contact.contact_radius((1 + beyond) * scales(contact)[3]) == 0


@given(contacts)
def test_known_radii(contact):
    # h0 = 0: a³ = R²·2πW/E; no load: a³ = 9πR²W/(2E) and h0 = -a²/3R.
    R, pull, _, _ = scales(contact)
    assert contact.contact_radius(0.0) == pytest.approx((R**2 * pull) ** (1 / 3))
    unloaded = (9 / 4 * R**2 * pull) ** (1 / 3)
    assert contact.contact_radius(-(unloaded**2) / (3 * R)) == pytest.approx(unloaded)


@given(contacts)
def test_deep_contacts_are_those_of_hertz(contact):
    R, _, _, pull_off = scales(contact)
    depth = 1e12 * pull_off
    assert contact.contact_radius(-depth) == pytest.approx(sqrt(R * depth), rel=1e-6)


def test_heights_far_out_of_scale():
    for height in (-1e6, -1e-300, 0.0, 1e-300, 1e6):
        assert np.isfinite(LDPE.contact_radius(height))


def test_any_object_with_these_attributes_is_a_sample():
    class Rubber:
        kind = "rubber"
        compliance = LDPE.sample.compliance
        poisson = LDPE.sample.poisson

    contact = sa.Contact(LDPE.tip, Rubber(), LDPE.surface)
    assert contact.tabor_relaxed == LDPE.tabor_relaxed
    assert contact.contact_radius(-1e-9) == LDPE.contact_radius(-1e-9)
    ramp = sa.Triangle(4e-9, 2e-9, 1e-3)
    np.testing.assert_array_equal(
        sa.force_distance(contact, ramp)["force"], sa.force_distance(LDPE, ramp)["force"]
    )
