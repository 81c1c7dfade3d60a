"""Work done on a contact is dissipated in the sample, released in jumps, or stored at the end."""

import json
from pathlib import Path

import numpy as np
import pytest
from test_slow_and_soft import CONFORMING, CONFORMING_RAMP, CREPT, CREPT_RAMP

import softafm as sa

CASES = json.loads((Path(__file__).parent / "data" / "cases.json").read_text())
LDPE_TAP = {"amplitude": 49.6e-9, "mean_height": 46e-9, "frequency": 278e3}


def account(result):
    """Viscous loss, released energy and gain of stored energy."""
    stored = result.attrs["solver_stored_energy_end"] - result.attrs["solver_stored_energy_start"]
    return float(result["viscous_loss"]) + float(result["jump_energy"].sum()) + stored


@pytest.mark.parametrize("z0", [0.1e-9, 0.12e-9, 0.15e-9, 0.2e-9, 0.3e-9])
@pytest.mark.parametrize(("tolerance", "error"), [(1e-2, 1e-3), (1e-3, 3e-4)])
def test_taps_dissipate_the_work_done(z0, tolerance, error):
    """With z0 = 0.1 nm the edge recedes to a tenth within a jump."""
    contact = sa.Contact(
        sa.Paraboloid(10e-9), sa.samples.ldpe(), sa.LennardJones(hamaker=1e-19, z0=z0)
    )
    result = sa.tapping_cycle(contact, **LDPE_TAP, tolerance=tolerance)
    assert account(result) == pytest.approx(float(result["dissipation"]), rel=error)


@pytest.mark.filterwarnings("ignore:.*still in contact at the end:softafm.AccuracyWarning")
@pytest.mark.parametrize("name", ["soft-tabor-5", "soft-tabor-10", "soft-tabor-20"])
@pytest.mark.parametrize(("tolerance", "error"), [(1e-2, 1e-2), (1e-3, 1e-3)])
def test_ramps_that_end_in_contact_balance(name, tolerance, error):
    inputs = next(case["inputs"] for case in CASES if case["name"] == name)
    contact = sa.Contact(
        sa.Paraboloid(inputs["radius"]),
        sa.StandardLinearSolid(inputs["E0"], inputs["E_inf"], inputs["tau"], inputs["poisson"]),
        sa.LennardJones(inputs["hamaker"], inputs["z0"]),
    )
    motion = sa.Triangle(inputs["start"], inputs["turn"], inputs["speed"])
    result = sa.force_distance(contact, motion, tolerance=tolerance)
    assert account(result) == pytest.approx(float(result["loop_energy"]), rel=error)


@pytest.mark.parametrize(
    ("contact", "motion", "regularise"),
    [(CREPT, CREPT_RAMP, None), (CONFORMING, CONFORMING_RAMP, 8)],
)
def test_samples_that_have_not_recovered_balance(contact, motion, regularise):
    result = sa.force_distance(contact, motion, regularise=regularise)
    assert account(result) == pytest.approx(float(result["loop_energy"]), rel=2e-3)


def test_a_sample_that_flows_balances():
    contact = sa.Contact(
        sa.Paraboloid(10e-9), sa.samples.polyisobutylene(), sa.LennardJones(1e-19, 0.3e-9)
    )
    result = sa.force_distance(contact, sa.Triangle(10e-9, -2e-9, 1e-3), tolerance=1e-3)
    assert account(result) == pytest.approx(float(result["loop_energy"]), rel=2e-3)


@pytest.mark.parametrize(("relaxation_time", "speed"), [(1e-6, 1e-3), (1e-4, 1e-4)])
def test_a_maxwell_fluid_balances(relaxation_time, speed):
    """What flows away is dissipated; its dashpot stores nothing, however far it moves."""
    fluid = sa.Maxwell(1e9, relaxation_time, 0.49)
    contact = sa.Contact(sa.Paraboloid(50e-9), fluid, sa.LennardJones(1e-19, 0.3e-9))
    result = sa.force_distance(contact, sa.Triangle(20e-9, -5e-9, speed))
    assert account(result) == pytest.approx(float(result["loop_energy"]), rel=5e-3)


def test_a_lever_counts():
    contact = sa.Contact(
        sa.Paraboloid(10e-9), sa.samples.ldpe(), sa.LennardJones(hamaker=1e-19, z0=0.25e-9)
    )
    time = np.array([0, 0.11, 0.15])
    ends_pressed = sa.Trajectory(time, np.array([20e-9, -2e-9, -2e-9]))
    result = sa.force_spectroscopy(contact, sa.Cantilever(2.0), ends_pressed, tolerance=1e-3)
    assert float(result["contact_radius"][-1]) > 0
    assert account(result) == pytest.approx(float(result["loop_energy"]), rel=2e-3)


def test_a_relaxed_sample_stores_what_an_elastic_one_does():
    law = sa.LennardJones(1e-19, 0.3e-9)
    pressed = sa.Trajectory(np.array([0, 1e-3, 2e-3]), np.array([5e-9, -1e-9, -1e-9]))

    def stored(sample):
        contact = sa.Contact(sa.Paraboloid(10e-9), sample, law)
        result = sa.force_distance(contact, pressed, tolerance=1e-3)
        return result.attrs["solver_stored_energy_end"]

    creeping = sa.StandardLinearSolid(2e9, 0.5e9, creep_time=1e-5, poisson=0.4)
    assert stored(creeping) == pytest.approx(stored(sa.Elastic(0.5e9, 0.4)), rel=1e-3)


def test_ramp_balances_whose_tip_lets_go_of_a_wide_dent():
    """The surface is then seen from the frame of a new contact, a fortieth as wide.

    Twice what was left of the work went into dashpots, half of which there was not.
    """
    contact = sa.Contact(
        sa.Cone(half_angle=1.1, apex_radius=37e-9),
        sa.StandardLinearSolid(E0=5.9e5, E_inf=1.1e4, creep_time=1.67e-3, poisson=0.2),
        sa.LennardJones(hamaker=3.6e-22, z0=0.45e-9),
    )
    ramp = sa.Triangle(start=135e-9, turn=-192e-9, speed=3.4e-4)
    result = sa.force_spectroscopy(contact, sa.Cantilever(stiffness=0.45), ramp)
    assert result.sizes["jump"] == 2
    assert account(result) == pytest.approx(float(result["loop_energy"]), rel=2e-3)
