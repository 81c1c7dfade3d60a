"""Samples that are far softer in the long run than at first, and creep more slowly than the tip."""

import numpy as np
import pytest

import softafm as sa

TIP, LAW = sa.Paraboloid(10e-9), sa.LennardJones(1e-19, 0.3e-9)
RAMP = sa.Triangle(10e-9, -2e-9, 1e-3)

# A gel pressed for far longer than it takes to creep, and pulled off as fast as it cannot follow.
CREPT = sa.Contact(
    sa.Sphere(7.5e-8),
    sa.KelvinVoigt(1.23e8, creep_time=0.54, poisson=0.39),
    sa.DMT(2.89e-20, 1.676e-10, 0.176),
)
CREPT_RAMP = sa.Triangle(1.87e-8, -1.52e-8, 2.37e-6, dwell=1.47)
# One under 200 nm, whose whole contact parts at once.
CONFORMING = sa.Contact(
    sa.Paraboloid(2.127e-7),
    sa.KelvinVoigt(1.258e6, creep_time=8.984, poisson=0.313),
    sa.Exponential(0.07634, 2.811e-10, 4.0025e-10, 3.373e-11),
)
CONFORMING_RAMP = sa.Triangle(2.0337e-6, -1.8155e-6, 8.804e-7, dwell=2041)


def run(sample, motion=RAMP, tolerance=1e-2):
    return sa.force_distance(sa.Contact(TIP, sample, LAW), motion, tolerance=tolerance)


@pytest.mark.parametrize(("E0", "E_inf"), [(3e9, 1e4), (1e8, 1e5)])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_a_sample_that_has_no_time_to_creep_is_elastic(E0, E_inf, tolerance):
    slow = sa.StandardLinearSolid.from_relaxation_time(E0, E_inf, 1e12, 0.35)
    found, elastic = run(slow, tolerance=tolerance), run(sa.Elastic(E0, 0.35), tolerance=tolerance)
    for name in ("force_min", "force_max"):
        assert float(found[name]) == pytest.approx(float(elastic[name]), rel=1e-4)
    least = 1e-5 * float(elastic["force_max"]) * 10e-9
    assert float(found["loop_energy"]) == pytest.approx(
        float(elastic["loop_energy"]), rel=1e-3, abs=least
    )
    assert found["jump_time"].size == elastic["jump_time"].size


def test_pull_off_from_polyisobutylene():
    # -3.727 nN at 1e-3, 3e-4 and 1e-4, and with a mesh twice as wide.
    pull_off = float(run(sa.samples.polyisobutylene())["force_min"])
    assert pull_off == pytest.approx(-3.72e-9, rel=3e-3)


@pytest.mark.parametrize("speed", [1e-3, 1e-1])
def test_the_height_that_a_ramp_starts_from_does_not_matter(speed):
    """From far up no relaxed contact is expected, from near by one of many tip radii."""
    melt = sa.samples.polyisobutylene()
    moduli, times = melt.moduli[:27], melt.relaxation_times[:27]
    sample = sa.GeneralizedMaxwell(1e3, moduli, times, poisson=0.5)
    near, far = (run(sample, sa.Triangle(start, -2e-9, speed)) for start in (10e-9, 10e-6))
    assert sa.Contact(TIP, sample, LAW).contact_radius(10e-9) > 10 * TIP.radius
    assert sa.Contact(TIP, sample, LAW).contact_radius(10e-6) == 0
    for name in ("force_min", "force_max", "loop_energy"):
        assert float(near[name]) == pytest.approx(float(far[name]), rel=5e-3), name


def test_pull_off_from_a_gel_that_has_crept():
    # -3.705e-7 to -3.72e-7 N at 1e-3 and 3e-4.
    result = sa.force_distance(CREPT, CREPT_RAMP)
    assert float(result["force_min"]) == pytest.approx(-3.71e-7, rel=1e-2)
    assert result["jump_time"].size == 0


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_a_conforming_contact_parts_without_spikes(tolerance):
    result = sa.force_distance(CONFORMING, CONFORMING_RAMP, tolerance=tolerance, regularise=8)
    force, height = result["force"].values, result["tip_height"].values
    down = np.flatnonzero(height == height.min())
    assert force.argmax() <= down[0]  # pressed and held it only gives way
    assert force[down[-1] :].max() == force[down[-1]]
    assert float(result["force_min"]) == pytest.approx(-1.029e-5, rel=1e-2)
    assert result["jump_time"].size == 0


def test_a_contact_that_would_only_jump_after_creep_loses_its_energy_to_the_dashpots():
    """The solid is rigid at first and crept in 1e-5 of the time in which the tip comes near."""
    contact = sa.Contact(
        sa.Sphere(99e-9),
        sa.KelvinVoigt(E=1.02e7, creep_time=1.4e-7, poisson=0.28),
        sa.Morse(work_of_adhesion=4.6e-4, z0=0.49e-9, decay=0.21e-9),
    )
    result = sa.force_distance(contact, sa.Triangle(23e-9, -30e-9, 4.8e-8))
    assert result.sizes["jump"] == 0
    assert float(result["viscous_loss"]) == pytest.approx(float(result["loop_energy"]), rel=0.02)
