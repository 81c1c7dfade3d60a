"""Where the energy of a motion goes: work against dashpots, jumps and what is stored."""

import numpy as np
import pytest

import softafm as sa
from softafm.solvers.energy import Energy
from softafm.solvers.history import History

LAW = sa.LennardJones.from_work_of_adhesion(0.03, 0.3e-9)
TIP = sa.Paraboloid(10e-9)


def solid(E0=2e9, E_inf=0.1e9, creep_time=1e-5):
    return sa.StandardLinearSolid(E0, E_inf, creep_time, 0.4)


@pytest.mark.parametrize("law", [LAW, sa.Repulsion(1e9, 0.3e-9), sa.DMT(1e-19, 0.3e-9)])
@pytest.mark.parametrize("stiffness", [None, 2.0])
def test_an_elastic_ramp_without_a_jump_loses_nothing(law, stiffness):
    contact, ramp = sa.Contact(TIP, sa.Elastic(5e10, 0.3), law), sa.Triangle(6e-9, -2e-10, 1e-6)
    if stiffness is None:
        curve = sa.force_distance(contact, ramp)
    else:
        curve = sa.force_spectroscopy(contact, sa.Cantilever(200.0), ramp)
    assert curve.jump_time.size == 0
    assert curve.force_max > 1e-10
    assert float(curve.loop_energy) == 0.0


def test_elastic_taps_without_a_jump_lose_nothing():
    contact = sa.Contact(TIP, sa.Elastic(1e11, 0.3), LAW)
    for cycles in ("steady", 2):
        tap = sa.tapping_cycle(contact, 20e-9, 19.9e-9, 1e5, cycles)
        assert tap.jump_time.size == 0
        assert float(tap.dissipation) == 0.0
        assert not tap.cycle_dissipation.values.any()


def test_an_elastic_jump_in_and_out_loses_what_both_release():
    contact = sa.Contact(TIP, sa.Elastic(0.2e9, 0.3), LAW)
    curve = sa.force_distance(contact, sa.Triangle(20e-9, -3e-9, 1e-6))
    assert curve.jump_time.size == 2
    assert float(curve.loop_energy) == pytest.approx(float(curve.jump_energy.sum()), rel=1e-2)


@pytest.mark.parametrize(
    ("E0", "E_inf", "creep_time", "amplitude", "mean_height", "frequency"),
    [
        (2e9, 1.9e9, 1e-6, 20e-9, 19e-9, 1e5),
        (5e9, 4.5e9, 1e-4, 10e-9, 9.5e-9, 3e5),
        (1e9, 0.5e9, 1e-2, 20e-9, 18.5e-9, 1e5),
        (3e9, 2.0e9, 1.0, 30e-9, 29e-9, 7e4),
    ],
)
def test_nearly_elastic_taps_keep_the_tolerance_of_their_own_dissipation(
    E0, E_inf, creep_time, amplitude, mean_height, frequency
):
    """Down to parts of 1e-6 of the largest force times the amplitude, and never below zero."""
    contact = sa.Contact(TIP, solid(E0, E_inf, creep_time), LAW)
    rough, fine = (
        sa.tapping_cycle(contact, amplitude, mean_height, frequency, tolerance=tolerance)
        for tolerance in (1e-2, 1e-4)
    )
    assert 0 < float(fine.dissipation) < 0.1 * float(fine.force_max) * 1e-9
    assert float(rough.dissipation) == pytest.approx(float(fine.dissipation), rel=1e-2)


@pytest.mark.filterwarnings("ignore:.*still in contact at the end:softafm.AccuracyWarning")
def test_a_surface_drawn_into_contact_at_once_starts_where_it_ends():
    """From within the height of jump-in: an elastic contact then has one force at one height."""
    z0 = 1e-9
    law, tip = sa.LennardJones.from_work_of_adhesion(0.02, z0), sa.Paraboloid(1e-6)
    curve = sa.force_distance(
        sa.Contact(tip, sa.Elastic(1e8, 0.3), law), sa.Triangle(3 * z0, 0, 1e-6)
    )
    force = curve.force.values
    assert force[0] == pytest.approx(force[-1], rel=1e-3)
    assert curve.jump_time.size == 0
    assert float(curve.loop_energy) == 0.0


@pytest.mark.parametrize(("stiffness", "start"), [(0.05, 20e-9), (0.05, 50e-9), (28.1, 20e-9)])
def test_work_is_what_is_lost_and_stored_whether_the_tip_parts_or_not(stiffness, start):
    law = sa.LennardJones(1e-19, 0.25e-9)
    contact, ramp = sa.Contact(TIP, solid(), law), sa.Triangle(start, -5e-9, 2e-7)
    history = Energy().solve(contact, ramp, stiffness=stiffness, tolerance=1e-3)
    energies = history.energies()
    assert energies.spent == pytest.approx(energies.work, rel=2e-3)
    assert (energies.stored > 0.1 * energies.work) == (history.contact_radius[-1] > 0)


def test_a_dented_surface_holds_energy_at_the_end():
    """Tip 10 nm up again after 0.1 ms: the dent of a slow solid is still there."""
    contact = sa.Contact(TIP, solid(creep_time=1e-4), sa.Repulsion(1e9, 0.2e-9))
    energies = Energy().solve(contact, sa.Triangle(8e-9, -4e-9, 2.4e-4), tolerance=1e-3).energies()
    assert energies.stored > 0.02 * energies.work
    assert energies.spent == pytest.approx(energies.work, rel=3e-3)


NOTHING = {"stored_energy_start": 1e-18, "stored_energy_end": 1e-18}


def made_history(power, jump_energy=(), stored=NOTHING):
    """A force that falls and rises on the same curve, on the way down and up."""
    time = np.append(np.linspace(0, 1, 21), 1 + np.linspace(0, 1, 21)[1:] ** 1.2)
    ramp = sa.Triangle(1e-9, 0.0, 1e-9)
    jumps = np.array(jump_energy)
    return History(
        time=time, tip_height=ramp.height(time), force=1e-9 * np.exp(-ramp.height(time) / 1e-9),
        contact_radius=0 * time, axis_deformation=0 * time, viscous_power=power + 0 * time,
        pieces=(slice(0, 21), slice(20, 41)), jump_time=np.linspace(0.5, 1, jumps.size),
        jump_energy=jumps, motion=ramp, diagnostics=stored,
    )  # fmt: skip


def test_small_losses_are_taken_from_where_they_are_known():
    energies = made_history(1e-25).energies()
    assert energies.balanced
    assert energies.best == pytest.approx(2e-25)
    assert abs(energies.work) < 1e-22


@pytest.mark.parametrize("stored", [NOTHING, {}])
def test_work_that_nothing_accounts_for_stays_as_it_is(stored):
    energies = made_history(1e-19, [3e-20], stored).energies()
    assert not energies.balanced
    assert energies.best == energies.work
    assert energies.imbalance == (0.0 if not stored else pytest.approx(-2.3e-19, rel=1e-3))


def test_a_tap_that_is_not_the_first_loses_what_its_dashpots_take():
    """On a fluid far slower than taps the work of one is a small difference of large numbers.

    Stresses are nearly those of Hertz on an elastic body, of energy 2/5 F d, and the dashpots
    take 2/τ of that.
    """
    contact = sa.Contact(TIP, sa.Maxwell(1e8, 10.0, 0.4), sa.Repulsion(1e9, 0.05e-9))
    tap = {"amplitude": 20e-9, "mean_height": 18e-9, "frequency": 1e3, "cycles": 2}
    second = sa.tapping_cycle(contact, **tap)
    force = second["force"].values
    depth = (force / (4 / 3 * 1e8 / (1 - 0.4**2) * TIP.radius**0.5)) ** (2 / 3)
    lost = np.trapezoid(2 / 10.0 * 2 / 5 * force * depth, second["time"].values) / 2
    assert float(second["dissipation"]) == pytest.approx(lost, rel=0.05)
    finer = sa.tapping_cycle(contact, **tap, tolerance=1e-4)
    assert float(second["dissipation"]) == pytest.approx(float(finer["dissipation"]), rel=3e-3)
