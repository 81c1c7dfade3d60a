"""Contacts of Tabor numbers far above ten, whose edges yield to the smallest of errors."""

import numpy as np
import pytest
from scipy.integrate import trapezoid

import softafm as sa
from softafm import solvers

R, W, Z0 = 20e-9, 0.05, 0.3e-9
LAW = sa.LennardJones.from_work_of_adhesion(W, Z0)


def elastic(tabor):
    """A contact of this Tabor number, and a ramp from above its pull-off to below snap-in."""
    modulus = np.sqrt(R * W**2 / (tabor * Z0) ** 3)
    start = max(2 * tabor, 1.5 * 2.641 * tabor ** (3 / 7)) * Z0
    turn = -((0.75 * np.pi**2) ** (1 / 3)) * tabor * Z0
    return sa.Contact(sa.Paraboloid(R), sa.Elastic(modulus, 0.0), LAW), sa.Triangle(
        start, turn, 1e-6
    )


# Pull-off/(πRW), energy released at it and on the whole loop, over μ z0 R W: from a continuation in
# the contact radius through both folds, on meshes four times as fine (no jumps are followed there).
CONTINUED = {
    30: (1.50146, 0.6706, 5.576),
    64: (1.50045, 0.6731, 6.097),
    200: (1.50008, 0.6739, 6.568),
    640: (1.50004, 0.6741, 6.8217),
    1000: (1.50002, 0.6741, 6.8826),
}


@pytest.mark.parametrize("tabor", CONTINUED)
def test_soft_elastic_contacts_part_as_they_must(tabor):
    contact, ramp = elastic(tabor)
    history = solvers.Energy().solve(contact, ramp)
    pull_off, parted, loop = CONTINUED[tabor]
    unit = tabor * Z0 * R * W
    assert -history.force.min() / (np.pi * R * W) == pytest.approx(pull_off, rel=2e-3)
    assert history.jump_energy.size == 2
    assert history.jump_energy[1] / unit == pytest.approx(parted, rel=5e-3)
    assert history.jump_energy.sum() / unit == pytest.approx(loop, rel=5e-3)
    work = -trapezoid(history.force, history.tip_height)
    assert work / unit == pytest.approx(loop, rel=1e-2)
    assert history.diagnostics["attempted_steps"] < 1000
    assert not history.warnings


def test_the_force_where_a_soft_contact_parts_tends_to_that_of_jkr():
    """Controlled height: −(5/6)πRW at δ = −(3/2)(π/8)^(2/3)·2 μ z0 (Johnson, Kendall, Roberts)."""
    contact, ramp = elastic(1000)
    history = solvers.Energy().solve(contact, ramp)
    before = np.searchsorted(history.time, history.jump_time[1]) - 1
    assert history.tip_height[before] / (1000 * Z0) == pytest.approx(1.6088, rel=2e-3)
    assert history.force[before] / (np.pi * R * W) == pytest.approx(-5 / 6, rel=2e-2)


def test_silicone_rubber_on_a_soft_lever_just_runs():
    contact = sa.Contact(sa.Paraboloid(R), sa.samples.pdms(), LAW)
    ramp = sa.Triangle(300e-9, -300e-9, 1e-6, setpoint_force=5e-9)
    result = sa.force_spectroscopy(contact, sa.Cantilever(0.4), ramp)
    assert float(result.force_min) == pytest.approx(-1.5 * np.pi * R * W, rel=5e-3)
    assert float(result.force_max) == pytest.approx(5e-9, rel=2e-3)
    assert result.sizes["jump"] == 2
    assert not result.attrs["warnings"]


def test_a_soft_viscoelastic_contact_parts_as_slow_steps_have_it():
    """E0/E_inf = 20 at a Tabor number of 100: 3.909 πRW by 52 000 steps of one zone each."""
    radius, tabor = 100e-9, 100
    modulus = np.sqrt(radius * W**2 / (tabor * Z0) ** 3)
    solid = sa.StandardLinearSolid(20 * modulus, modulus, 3e-5, 0.0)
    contact = sa.Contact(sa.Paraboloid(radius), solid, LAW)
    turn = -((0.75 * np.pi**2) ** (1 / 3)) * tabor * Z0
    history = solvers.Energy().solve(contact, sa.Triangle(6 * tabor * Z0, turn, 1e-6))
    assert -history.force.min() / (np.pi * radius * W) == pytest.approx(3.909, rel=5e-3)
    work = -trapezoid(history.force, history.tip_height)
    lost = trapezoid(history.viscous_power, history.time) + history.jump_energy.sum()
    assert lost == pytest.approx(work, rel=1e-2)
    assert history.jump_energy.size == 2
    assert history.diagnostics["attempted_steps"] < 2000


def test_a_tip_is_pressed_through_a_double_layer_with_a_faint_outer_minimum():
    """Its attraction is nothing to the sample, and what presses this acts a tenth as far out."""
    law = sa.DLVO(1.148e-21, 3.64e-10, 0.0438, 1.4217e-9)
    contact = sa.Contact(sa.Paraboloid(1e-7), sa.Elastic(1.6e9, 0.34), law)
    pressed = sa.force_distance(contact, sa.Triangle(60e-9, -2e-9, 1e-6))
    finer = sa.force_distance(contact, sa.Triangle(60e-9, -2e-9, 1e-6), tolerance=1e-3)
    assert float(pressed.force_max) == pytest.approx(float(finer.force_max), rel=1e-3)
    # Before it is pressed the sample hardly gives way: Derjaguin's force on a rigid one.
    for gap in (2e-9, 4e-9):
        near = sa.force_distance(contact, sa.Triangle(60e-9, gap, 1e-6))
        rigid = 2 * np.pi * 1e-7 * float(law.potential(gap))
        assert float(near.force_max) == pytest.approx(rigid, rel=3e-3)
    lowest = 2 * np.pi * 1e-7 * float(law.potential(law.equilibrium_gap))
    assert float(pressed.force_min) == pytest.approx(lowest, rel=2e-3)
