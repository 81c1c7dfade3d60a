"""The cost of a run, estimated before it: from its cycles, and the lengths its edge crosses."""

import numpy as np
import pytest

import softafm as sa
from softafm.instrument.motions import Sine
from softafm.solvers.energy import Energy
from softafm.solvers.energy.solver import estimate_cycles

TIP = sa.Paraboloid(20e-9)
RAMP = sa.Triangle(20e-9, -2e-9, 1e-6)
TAPS = Sine(19.5e-9, 20e-9, 1e5, "steady")


def law(W=0.05):
    return sa.LennardJones.from_work_of_adhesion(W, 0.3e-9)


def solid(softening=10.0, creep_time=1e-5, modulus=1e9):
    return sa.StandardLinearSolid(modulus, modulus / softening, creep_time, 0.4)


def forecast(sample, motion, tip=TIP, W=0.05):
    return Energy().expected_seconds(sa.Contact(tip, sample, law(W)), motion)


@pytest.mark.parametrize(
    "sample", [sa.Elastic(2e9, 0.4), solid(3.0, 1e-7), solid(2.0), solid(5.0), solid(10.0, 1e-4)]
)
def test_as_many_cycles_are_expected_as_it_takes(sample):
    contact = sa.Contact(TIP, sample, law(0.02))
    taken = int(sa.tapping_cycle(contact, 20e-9, 19.5e-9, 1e5).cycles_run)
    assert taken / 3 <= estimate_cycles(contact, TAPS) <= 3 * taken


def test_the_more_creep_a_cycle_leaves_the_more_cycles_it_takes():
    def cycles(softening, creep_time, motion=TAPS):
        return estimate_cycles(sa.Contact(TIP, solid(softening, creep_time), law()), motion)

    softer = [cycles(softening, 1e-2) for softening in (1.0001, 2.0, 10.0, 100.0, 1000.0)]
    assert 1 < softer[0] < 1.1
    assert (np.diff(softer) > 0).all()
    assert cycles(1000.0, 1e-7) == pytest.approx(1)
    assert cycles(1e6, 1e-2) == cycles(1e9, 1e-2)  # both fill the search
    assert cycles(1000.0, 1e-2, Sine(19.5e-9, 20e-9, 1e5, 3)) == 3
    assert cycles(1000.0, 1e-2, RAMP) == 1


def test_softer_and_deeper_contacts_cost_more_and_none_costs_nothing():
    for motion in (RAMP, TAPS):
        softer = [forecast(sa.Elastic(E, 0.4), motion) for E in (1e11, 1e9, 1e8, 1e7)]
        assert (np.diff(softer) > 0).all()
        assert softer[0] > 4e-3
    deeper = [forecast(sa.Elastic(1e7, 0.4), sa.Triangle(2e-8, -d, 1e-6)) for d in (1e-9, 1e-8)]
    assert deeper[1] > deeper[0]


def test_where_an_edge_cannot_ride_it_costs_more():
    """Elastic or parting evenly it rides best; with a memory less; at a steep rim not at all."""
    elastic, viscoelastic, steep = (
        forecast(sample, RAMP, tip)
        for sample, tip in (
            (sa.Elastic(2e6, 0.4), TIP),
            (solid(10.0, 1e-7, 2e7), TIP),
            (sa.Elastic(2e6, 0.4), sa.FlatPunch(200e-9, 2e-9)),
        )
    )
    assert elastic < viscoelastic < steep
