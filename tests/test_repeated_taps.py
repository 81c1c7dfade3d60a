"""Taps that find the dent of the taps before, on samples that keep it."""

import pytest

import softafm as sa
from softafm.solvers import Attard

SCALARS = ("dissipation", "viscous_loss", "force_max", "force_min", "force_min_approach")


FLUID = (
    sa.Contact(
        sa.Sphere(17e-9),
        sa.Maxwell(E0=5.9e6, relaxation_time=4.4e-7, poisson=0.47),
        sa.DMT(hamaker=1.5e-21, z0=0.2e-9, wall=0.225),
    ),
    {"amplitude": 28e-9, "mean_height": 24e-9, "frequency": 230e3, "cycles": 3},
)
"""It lets go of the tip in a jump each time: a rim is left where the edge turned."""


def test_third_tap_on_a_fluid_is_converged():
    """It changed by 1 to 6 % with the tolerance: each frame blurred the dent a little more."""
    contact, options = FLUID
    coarse, fine = (
        sa.tapping_cycle(contact, **options, tolerance=tolerance) for tolerance in (1e-2, 1e-3)
    )
    for name in SCALARS:
        assert float(coarse[name]) == pytest.approx(float(fine[name]), rel=5e-3), name


def test_second_tap_on_a_fluid_is_that_of_attards_model():
    """Its steps are equal and its errors of first order in them, so two runs give the limit."""
    contact = sa.Contact(
        sa.Paraboloid(20e-9),
        sa.Maxwell(E0=1e9, relaxation_time=2e-7, poisson=0.4),
        sa.LennardJones(hamaker=3e-20, z0=0.4e-9),
    )
    options = {"amplitude": 20e-9, "mean_height": 19e-9, "frequency": 1e5, "cycles": 2}
    ours = sa.tapping_cycle(contact, **options)
    coarse, fine = (
        sa.tapping_cycle(contact, **options, solver=Attard(nodes=200, domain=60e-9, steps=steps))
        for steps in (10_000, 20_000)
    )
    for name in ("force_max", "force_min", "dissipation"):
        limit = 2 * float(fine[name]) - float(coarse[name])
        assert float(ours[name]) == pytest.approx(limit, rel=4e-3), name
