"""Taps at a setpoint: those that an approach curve finds, from a neighbour or from nothing."""

from dataclasses import replace

import numpy as np
import pytest

import softafm as sa
from softafm.maps.imaging import AmplitudeModulation
from softafm.maps.setpoint import ATTRACTIVE, BRANCHES, REPULSIVE
from softafm.maps.tapped_lines import find_engaged_branch, make_setpoint
from softafm.solvers import Energy

LEVER = sa.Cantilever(stiffness=28.1, quality_factor=429.5, frequency=278e3)
FREE = 15e-9
# Fig. 9 of Rajabifar et al. 2021: both branches exist from 0.71 to 0.93.
PS = sa.Contact(
    sa.Paraboloid(50e-9),
    sa.StandardLinearSolid(4.25e9, 1.89e9, 1e-7, 0.35),
    sa.LennardJones(2e-20, 0.15e-9),
)
RATIO = 0.8


@pytest.fixture(scope="module")
def curve():
    return sa.approach_curve(PS, LEVER, FREE, [RATIO])


@pytest.fixture
def setpoint():
    return make_setpoint(AmplitudeModulation(LEVER, FREE, RATIO), Energy(), 1e-2)


def assert_on_curve(curve, setpoint, point):
    values = curve.isel(amplitude_ratio=0).sel(branch=BRANCHES[point.branch])
    height = setpoint.amplitude + point.approach
    assert height == pytest.approx(float(values["mean_height"]), abs=3e-12)
    assert setpoint.phase(point.values) == pytest.approx(float(values["phase"]), abs=0.2)
    virial, dissipation, *_, indentation = point.values
    assert virial == pytest.approx(float(values["virial"]), rel=1e-2, abs=2e-20)
    assert dissipation == pytest.approx(float(values["dissipation"]), rel=1e-2)
    assert indentation == pytest.approx(float(values["indentation"]), abs=1e-12)


def test_a_survey_finds_what_a_feedback_can_hold(curve, setpoint):
    far, near = setpoint.survey(PS)
    assert (far.branch, near.branch) == (ATTRACTIVE, REPULSIVE)
    for point in (far, near):
        assert_on_curve(curve, setpoint, point)


@pytest.mark.parametrize("branch", [ATTRACTIVE, REPULSIVE])
def test_a_solution_is_followed_to_a_similar_contact_in_few_taps(curve, setpoint, branch):
    similar = replace(PS, sample=replace(PS.sample, E_inf=1.95e9, E0=4.4e9))
    start = setpoint.start_anew(similar, branch)
    before = setpoint.taps
    point = setpoint.carry(PS, start, start.approach, branch, np.nan)
    assert setpoint.taps - before <= 4
    assert point.branch == branch
    assert not point.surveyed
    assert_on_curve(curve, setpoint, point)


def test_a_bad_guess_still_ends_on_the_branch_asked_for(curve, setpoint):
    start = setpoint.start_anew(PS, REPULSIVE)
    for guess in (start.approach + 1e-9, start.approach - 0.6e-9):
        point = setpoint.carry(PS, start, guess, REPULSIVE, np.nan)
        assert point.branch == REPULSIVE
        assert_on_curve(curve, setpoint, point)


def test_the_lever_jumps_where_its_branch_is_gone():
    # At 0.6 only repulsion exists (Fig. 9).
    deeper = make_setpoint(AmplitudeModulation(LEVER, FREE, 0.6), Energy(), 1e-2)
    point = deeper.carry(PS, None, np.nan, ATTRACTIVE, np.nan)
    assert point.branch == REPULSIVE
    curve = sa.approach_curve(PS, LEVER, FREE, [0.6])
    assert np.isnan(curve["mean_height"].sel(branch="attractive")).all()
    assert_on_curve(curve, deeper, point)


def test_slopes_are_those_of_neighbouring_taps(setpoint):
    point = setpoint.survey(PS)[1]
    step = 0.01e-9
    taps = [setpoint.tap(PS, point.approach + s) for s in (step, -step)]
    slopes = (taps[0] - taps[1]) / (2 * step)
    np.testing.assert_allclose(point.slopes[:2], slopes[:2], rtol=0.1)
    excesses = [setpoint.excess(values) for values in taps]
    slope = setpoint._excess_slope((taps[0] + taps[1]) / 2, slopes)
    assert slope == pytest.approx((excesses[0] - excesses[1]) / (2 * step), rel=0.02)


@pytest.mark.parametrize(
    ("ratio", "branch"), [(0.8, ATTRACTIVE), (0.6, REPULSIVE), (0.35, REPULSIVE)]
)
def test_the_lever_engages_as_it_does_in_an_approach(ratio, branch):
    imaging = AmplitudeModulation(LEVER, FREE, ratio)
    assert find_engaged_branch(imaging, PS, Energy(), 1e-2) == branch


def test_the_lever_engages_as_asked():
    imaging = AmplitudeModulation(LEVER, FREE, 0.8, engaged="repulsive")
    assert find_engaged_branch(imaging, PS, Energy(), 1e-2) == REPULSIVE


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"setpoint": 1.0}, "setpoint = 1: must be above 0 and below 1"),
        ({"setpoint": "x"}, "setpoint = 'x': must be a number"),
        ({"free_amplitude": -1e-9}, "free_amplitude = -1e-09 m: must be greater than 0"),
        ({"cantilever": sa.Cantilever(2.0)}, "cantilever.quality_factor = None"),
        ({"cantilever": 2.0}, "must be a softafm.Cantilever"),
        ({"engaged": "far"}, "engaged = 'far': must be"),
        ({"drive_frequency": 0.0}, "drive_frequency = 0 Hz"),
    ],
)
def test_bad_imaging_is_refused(change, told):
    given = {"cantilever": LEVER, "free_amplitude": FREE, "setpoint": 0.8}
    with pytest.raises(ValueError, match="^.*" + told):
        AmplitudeModulation(**{**given, **change})
