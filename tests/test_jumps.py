"""Elastic jumps: their number, the energy they release, and where that goes."""

from math import pi

import numpy as np
import pytest

import softafm as sa
from softafm.instrument.lever import make_lever
from softafm.solvers.energy.run import Run

RUBBER = sa.Contact(
    sa.Paraboloid(1e-6), sa.Elastic(10e6, 0.5), sa.LennardJones.from_work_of_adhesion(0.02, 2e-9)
)
RUBBER_RAMP = sa.Triangle(60e-9, -20e-9, 1e-6)
LDPE_TAP = {"amplitude": 49.6e-9, "mean_height": 46e-9, "frequency": 278e3}


def elastic(tabor, tolerance):
    """A sphere of 20 nm and 50 mJ/m² pulled off a sample of some Tabor number, in units of z0."""
    R, W, z0 = 20e-9, 0.05, 0.3e-9
    modulus = (R * W**2 / (tabor**3 * z0**3)) ** 0.5
    law = sa.LennardJones.from_work_of_adhesion(W, z0)
    contact = sa.Contact(sa.Paraboloid(R), sa.Elastic(0.75 * modulus, 0.5), law)
    assert contact.tabor_relaxed == pytest.approx(tabor)
    depth = (0.75 * pi**2) ** (1 / 3) * tabor * z0
    motion = sa.Triangle((4 + 2.5 * tabor) * z0, -depth, 1e-6)
    return sa.force_distance(contact, motion, tolerance=tolerance)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 3e-5])
def test_the_same_jumps_at_every_tolerance(tolerance):
    result = sa.force_distance(RUBBER, RUBBER_RAMP, tolerance=tolerance)
    assert result["jump_time"].size == 2
    assert result["jump_energy"].values == pytest.approx([8.102e-16, 1.642e-16], rel=1e-3)


@pytest.mark.parametrize("tabor", [2, 5, 8])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_the_loop_of_an_elastic_contact_is_what_its_jumps_release(tabor, tolerance):
    result = elastic(tabor, tolerance)
    assert float(result["contact_radius"][-1]) == 0
    released = float(result["jump_energy"].sum())
    assert float(result["loop_energy"]) == pytest.approx(released, rel=1e-3)
    assert result["jump_time"].size == 2


@pytest.mark.parametrize("tolerance", [0.1, 0.05])
def test_a_loose_tolerance_is_kept_in_a_slack_contact(tolerance):
    loop = float(elastic(13, tolerance)["loop_energy"])
    assert loop == pytest.approx(float(elastic(13, 1e-3)["loop_energy"]), rel=tolerance / 2)


@pytest.mark.parametrize("z0", [0.12e-9, 0.15e-9, 0.2e-9])
def test_taps_jump_as_often_at_every_tolerance(z0):
    contact = sa.Contact(
        sa.Paraboloid(10e-9), sa.samples.ldpe(), sa.LennardJones(hamaker=1e-19, z0=z0)
    )
    loose, strict = (sa.tapping_cycle(contact, **LDPE_TAP, tolerance=t) for t in (1e-2, 1e-3))
    assert loose["jump_time"].size == strict["jump_time"].size == 2
    assert (strict["jump_energy"].values > 0).all()
    last = float(strict["jump_energy"][-1])
    assert float(loose["jump_energy"][-1]) == pytest.approx(last, rel=1e-2)


def test_a_wide_dent_has_the_energy_of_the_layers_above_it():
    """The tip is inside the level of the flat surface, far outside the mesh."""
    contact = sa.Contact(
        sa.Sphere(7.556e-6),
        sa.StandardLinearSolid(7.075e6, 4.7458e5, 1.1973e-4, 0.373),
        sa.Repulsion(1.872e8, 3.36e-10),
    )
    motion = sa.Triangle(7.07e-9, -2.267e-7, 7.0817e-3)
    run = Run(sa.solvers.Energy(), contact, motion, make_lever(None), 1e-2, False)
    bent = []
    for _ in run.steps():
        bent.append(run.surface.energy())
    work = np.abs(run.records["force"][: run.count]).max() * 2.34e-7
    assert min(bent) >= 0
    assert max(bent) < work


def test_a_fall_that_seems_to_gain_energy_counts_as_none_and_is_warned_of():
    run = Run(sa.solvers.Energy(), RUBBER, RUBBER_RAMP, make_lever(None), 1e-2, False)
    for _ in run.steps():
        pass
    assert run.history(0.0).warnings == ()
    run._note_jump(-1e-16)
    history = run.history(0.0)
    assert history.jump_energy.min() == 0
    assert any("can only lose energy" in str(doubt) for doubt in history.warnings)


@pytest.mark.filterwarnings("ignore:.*still in contact at the end:softafm.AccuracyWarning")
def test_after_a_jump_the_tip_is_where_the_motion_has_it():
    """It went on 0.15 pm above, by what the search for the far side of the jump had missed."""
    law = sa.LennardJones(8.2e-19, 0.976e-9)
    contact = sa.Contact(sa.Paraboloid(1e-6), sa.Elastic(1e8, 0.0), law)
    ramp = sa.Triangle(5 * law.z0, 0.0, 5e-6)
    curve = sa.force_distance(contact, ramp)
    assert curve.jump_time.size == 1
    height = ramp.height(curve.time.values)
    np.testing.assert_allclose(curve.tip_height.values, height, rtol=0, atol=1e-9 * law.z0)
