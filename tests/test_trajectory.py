"""Motions given by samples: straight, smooth or measured, and rests that cost nothing."""

import json
import re
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import softafm as sa
from softafm.files.measured import read_path, read_trajectory
from softafm.instrument.motions import find_lowest_height

CONTACT = sa.Contact(
    tip=sa.Paraboloid(10e-9),
    sample=sa.StandardLinearSolid(E0=2e9, E_inf=0.1e9, creep_time=1e-7, poisson=0.49),
    surface=sa.LennardJones(hamaker=1e-19, z0=0.25e-9),
)
LEVER = sa.Cantilever(stiffness=2.0)
RAMP = sa.Triangle(start=10e-9, turn=-5e-9, speed=1e-3)
SCALARS = ("force_max", "force_min", "loop_energy")


@pytest.fixture(scope="module")
def clean():
    return sa.force_distance(CONTACT, RAMP)


def record(motion, samples, noise, seed=1, uneven=False):
    rng = np.random.default_rng(seed)
    last = motion.breaks[-1]
    time = np.linspace(0, last, samples)
    if uneven:
        time = np.concatenate([[0], np.sort(rng.uniform(0, last, samples - 2)), [last]])
    return time, motion.height(time) + noise * rng.standard_normal(samples)


def assert_same_curve(found, expected, rel):
    for name in SCALARS:
        assert float(found[name]) == pytest.approx(float(expected[name]), rel=rel), name


# Straight lines


def test_a_ramp_given_by_its_corners_is_the_ramp(clean):
    motion = sa.Trajectory(RAMP.breaks, RAMP.height(RAMP.breaks))
    assert np.array_equal(motion.breaks, RAMP.breaks)
    assert motion.top_speed == pytest.approx(RAMP.speed, rel=1e-12)
    time = np.linspace(0, RAMP.breaks[-1], 1001)
    np.testing.assert_allclose(motion.height(time), RAMP.height(time), rtol=1e-12, atol=1e-22)
    found = sa.force_distance(CONTACT, motion)
    assert found.sizes["time"] == clean.sizes["time"]
    assert_same_curve(found, clean, 1e-3)


def test_a_dwell_given_by_its_corners_is_the_dwell():
    ramp = sa.Triangle(10e-9, -5e-9, 1e-3, dwell=2e-6)
    motion = sa.Trajectory(ramp.breaks, ramp.height(ramp.breaks))
    one, other = (sa.force_spectroscopy(CONTACT, LEVER, m) for m in (ramp, motion))
    assert_same_curve(other, one, 1e-6)


def test_two_equal_triangles_on_an_elastic_surface_press_equally():
    elastic = sa.Contact(CONTACT.tip, sa.Elastic(2e9, 0.49), CONTACT.surface)
    heights = np.array([5, -2, 5, -2, 5]) * 1e-9
    found = sa.force_distance(elastic, sa.Trajectory(1e-6 * np.arange(5.0), heights))
    time, force = found["time"].values, found["force"].values
    first, second = force[time <= 2e-6].max(), force[time >= 2e-6].max()
    assert second == pytest.approx(first, rel=1e-3)
    once = sa.force_distance(elastic, sa.Triangle(5e-9, -2e-9, 7e-3))
    assert first == pytest.approx(float(once["force_max"]), rel=1e-3)


@pytest.mark.parametrize(
    "solver",
    [
        sa.solvers.EnhancedAttard(functions=12, nodes=40, steps=4000),
        sa.solvers.Attard(nodes=30, method="explicit", steps=4000),
    ],
)
def test_the_explicit_solvers_follow_corners(solver):
    ramp = sa.Triangle(1.5e-9, 0.1e-9, 1e-3)
    contact = sa.Contact(CONTACT.tip, CONTACT.sample, sa.LennardJones(1e-20, 0.3e-9))
    motion = sa.Trajectory(ramp.breaks, ramp.height(ramp.breaks))
    one, other = (sa.force_distance(contact, m, solver=solver) for m in (ramp, motion))
    np.testing.assert_allclose(other["force"], one["force"], rtol=1e-9, atol=1e-18)


def test_between_the_samples_a_path_is_straight_or_smooth():
    time, heights = np.array([0.0, 1, 3]), np.array([1e-9, 0, 1e-9])
    straight, smooth = (sa.Trajectory(time, heights, smooth=s) for s in (False, True))
    assert straight.height([0.5, 2.0]) == pytest.approx([0.5e-9, 0.5e-9])
    assert straight.velocity([0.5, 1.0, 2.0]) == pytest.approx([-1e-9, 0.5e-9, 0.5e-9])
    assert smooth.height(0.5) < 0.45e-9
    assert smooth.velocity(1.0) == pytest.approx(0, abs=1e-22)
    assert straight != smooth
    assert hash(straight) != hash(smooth)
    with pytest.raises(ValueError, match=r"^smooth = 'yes': must be True or False$"):
        sa.Trajectory(time, heights, smooth="yes")


def test_the_lowest_height_of_a_slow_dip_with_a_flat_bottom_is_found():
    # All its changes of velocity are far below those of the fast approach.
    motion = sa.Trajectory([0, 1, 2, 3, 4], [9e-6, 9e-9, 1e-9, 1e-9, 9e-9])
    assert find_lowest_height(motion) == 1e-9


# Records with noise


@pytest.mark.parametrize("noise", [0.1e-9, 1e-9])
def test_a_noisy_record_costs_no_more_than_twice_the_ramp_and_gives_its_curve(clean, noise):
    motion = sa.Trajectory.from_measurement(*record(RAMP, 10_000, noise))
    assert motion.noise == pytest.approx(noise, rel=0.05)
    assert motion.breaks.size == 3
    found = sa.force_distance(CONTACT, motion)
    assert found.attrs["solver_attempted_steps"] <= 2 * clean.attrs["solver_attempted_steps"]
    assert found.attrs["solver_newton_iterations"] <= 2 * clean.attrs["solver_newton_iterations"]
    assert_same_curve(found, clean, 0.015)


MOTIONS = {
    "ramp": RAMP,
    "dwell": sa.Triangle(10e-9, -5e-9, 1e-3, dwell=5e-6),
    "sine": sa.Sine(5e-9, 8e-9, 1e5, cycles=3),
    "rest and peck": sa.Trajectory([0, 8, 9, 10], [1e-8, 1e-8, -5e-9, 1e-8]),
    "waves": sa.Trajectory(np.arange(11.0), np.array([10, -5] * 5 + [10]) * 1e-9),
}


@pytest.mark.parametrize("uneven", [False, True])
@pytest.mark.parametrize("noise", [0.0, 0.1e-9])
@pytest.mark.parametrize("name", MOTIONS)
def test_a_path_is_found_in_its_record_and_its_corners_stay_sharp(name, noise, uneven):
    motion = MOTIONS[name]
    time, heights = record(motion, 4000, noise, uneven=uneven)
    found = sa.Trajectory.from_measurement(time, heights)
    first, last = time[[0, -1]]
    span = last - first
    corners = motion.breaks[1:-1]
    assert found.corners.size == corners.size
    # A corner lies where neighbours cross: noise moves it by no more than a sample's part.
    assert np.all(np.abs(found.corners - corners) < max(2e-3 * noise / 1e-10, 1e-6) * span)
    instants = np.linspace(first, last, 5001)
    error = found.height(instants) - motion.height(instants)
    # Least squares of p parameters err by noise·√(p/n), root mean square; no path here needs more
    # than 24 of 4000 samples. At the ends of a spline they err several times as much.
    expected = noise * np.sqrt(24 / 4000) + 1e-15
    assert np.sqrt(np.mean(error**2)) < 2 * expected
    assert np.abs(error).max() < 8 * expected + 2e-14
    if noise:
        assert found.noise == pytest.approx(noise, rel=0.08)
    turning = motion.landmarks if isinstance(motion, sa.Sine) else corners
    assert found.breaks.size + found.landmarks.size <= 2 + corners.size + turning.size + 2


@pytest.mark.parametrize(("samples", "noise"), [(500, 0.1e-9), (2000, 1e-9)])
def test_a_turn_is_found_in_every_record_as_well_as_noise_allows(samples, noise):
    records = (record(RAMP, samples, noise, seed) for seed in range(20))
    paths = [sa.Trajectory.from_measurement(*given) for given in records]
    assert {path.breaks.size for path in paths} == {3}
    missed = [float(path.height(path.breaks[1])) - RAMP.turn for path in paths]
    # A line through m samples errs at its end by 2 noise/√m; where two cross, by that over √2.
    bound = 2 * noise / np.sqrt(samples / 2) / np.sqrt(2)
    assert np.sqrt(np.mean(np.square(missed))) < 1.5 * bound


def test_what_is_measured_of_drift_is_kept():
    time = np.linspace(0, 1, 3000)
    drifting = np.interp(time, [0, 0.5, 1], [1e-8, -5e-9, 1e-8]) + 2e-9 * time**2
    rng = np.random.default_rng(5)
    found = sa.Trajectory.from_measurement(time, drifting + 1e-10 * rng.standard_normal(3000))
    assert found.corners == pytest.approx([0.5], abs=1e-3)
    assert np.abs(found.height(time) - drifting).max() < 0.5e-10


@pytest.mark.parametrize("noise", [0.1e-9, 1e-9])
def test_a_dead_signal_is_still(noise):
    time = np.linspace(0, 1, 1000)
    heights = 5e-9 + noise * np.random.default_rng(2).standard_normal(1000)
    found = sa.Trajectory.from_measurement(time, heights)
    assert found.breaks.size == 2
    assert np.abs(found.height(time) - 5e-9).max() < 0.2 * noise


def test_noise_may_be_stated():
    # Of what a low-pass filter leaves neighbours tell too little.
    time = np.linspace(0, 1, 4000)
    white = np.random.default_rng(3).standard_normal(4010)
    heights = np.interp(time, [0, 0.5, 1], [1e-8, 0, 1e-8])
    heights = heights + 1e-10 * np.convolve(white, np.ones(11) / 11**0.5, mode="valid")
    assert sa.Trajectory.from_measurement(time, heights).noise < 0.3e-10
    stated = sa.Trajectory.from_measurement(time, heights, noise=3e-10)
    assert stated.noise == pytest.approx(3e-10)
    assert stated.corners == pytest.approx([0.5], abs=5e-3)
    assert np.abs(stated.height(time) - np.interp(time, [0, 0.5, 1], [1e-8, 0, 1e-8])).max() < 2e-10


SECOND = np.linspace(0, 1, 4000)
PECKED = np.interp(SECOND, [0, 0.5, 1], [1e-8, -5e-9, 1e-8])


def correlated(kind, seed, samples=4000):
    """Return noise in which neighbours are alike, m: 50 periods of hum, or means of 20 samples."""
    rng = np.random.default_rng(seed)
    if kind == "hum":
        hum = np.sin(np.linspace(0, 100 * np.pi, samples) + seed)
        return 0.3e-9 * hum + 0.1e-9 * rng.standard_normal(samples)
    white = rng.standard_normal(samples + 19)
    return 0.3e-9 * np.convolve(white, np.ones(20) / 20**0.5, mode="valid")


@pytest.mark.parametrize("stated", [False, True])
@pytest.mark.parametrize("kind", ["hum", "filter"])
def test_correlated_noise_is_not_taken_for_corners(kind, stated):
    for seed in range(2):
        noise = correlated(kind, seed)
        size = float(noise.std())
        path = sa.Trajectory.from_measurement(SECOND, PECKED + noise, size if stated else None)
        # Twenty samples of a mean count once: a line through 100 such errs at its ends by
        # 2 noise/√100, and by three times that once in hundreds of records.
        assert path.corners == pytest.approx([0.5], abs=0.02)
        missed = np.abs(path.height(SECOND) - PECKED).max()
        assert missed < 3 * 2 * 0.3e-9 / np.sqrt(100)
        # What neighbours tell is not all of the noise; what was stated is.
        assert len(path.doubts) == (not stated)
        for doubt in path.doubts:
            assert f"state noise = {np.std(path.height(SECOND) - path.heights):.2g} m" in doubt


def test_hum_of_many_samples_that_passes_for_motion_is_doubtful():
    time = np.linspace(0, 1, 20_000)
    clean = np.interp(time, [0, 0.5, 1], [1e-8, -5e-9, 1e-8])
    rng = np.random.default_rng(0)
    hum = 0.3e-9 * np.sin(100 * np.pi * time) + 0.1e-9 * rng.standard_normal(time.size)
    (doubt,) = sa.Trajectory.from_measurement(time, clean + hum).doubts
    assert "as one that follows hum: if there is hum, state the noise with that in it" in doubt
    stated = sa.Trajectory.from_measurement(time, clean + hum, noise=float(hum.std()))
    assert stated.doubts == ()
    assert stated.corners == pytest.approx([0.5], abs=0.005)


@pytest.mark.parametrize("samples", [40, 400, 4000])
def test_noise_stated_far_too_large_is_doubtful(samples):
    ramp = sa.Triangle(10e-9, -5e-9, 1e-6)
    time, heights = record(ramp, samples, 0.2e-9)
    path = sa.Trajectory.from_measurement(time, heights, noise=5e-9)
    assert path.height(time).min() > -4e-9  # it is flattened
    misfit = np.sqrt(np.mean((path.height(time) - heights) ** 2))
    (doubt,) = path.doubts
    assert "noise is taken to be 5e-09 m: so large a noise hides motion" in doubt
    assert doubt.endswith(f"state noise = {misfit:.2g} m, or leave it out")
    assert sa.Trajectory.from_measurement(time, heights, noise=0.2e-9).doubts == ()


def test_noise_estimated_far_too_large_is_doubtful_and_to_be_stated():
    ramp = sa.Triangle(10e-9, -5e-9, 1e-6)
    time, heights = record(ramp, 400, 0.0)
    heights[::2] += 0.3e-9  # two converters that take turns, with different offsets
    path = sa.Trajectory.from_measurement(time, heights)
    misfit = np.sqrt(np.mean((path.height(time) - heights) ** 2))
    assert path.noise > 2 * misfit
    (doubt,) = path.doubts
    assert "so large a noise hides motion" in doubt
    assert doubt.endswith(f"state noise = {misfit:.2g} m, in place of the estimate")
    assert sa.Trajectory.from_measurement(time, heights, noise=misfit).doubts == ()


def test_fast_waves_are_no_noise():
    for cycles in (30, 100):
        wave = 8e-9 * np.sin(2 * np.pi * cycles * SECOND)
        noise = 1e-10 * np.random.default_rng(cycles).standard_normal(4000)
        path = sa.Trajectory.from_measurement(SECOND, wave + noise)
        assert np.std(path.height(SECOND) - wave) < 1e-10
        assert path.doubts == ()


@given(
    st.integers(0, 2**32 - 1),
    st.integers(20, 300),
    st.floats(0, 3),
    st.sampled_from([0.0, 1e-10, 1e-6]),
)
@example(0, 234, 2.0, 1e-6)  # crossings that leave few samples between corners, or none
@example(0, 232, 2.0, 1e-6)
@settings(max_examples=60, deadline=None)
def test_any_record_gives_a_motion(seed, samples, unevenness, jump):
    rng = np.random.default_rng(seed)
    time = 1e3 + np.cumsum(1e-4 * rng.lognormal(0, unevenness, samples))
    heights = 1e-10 * rng.standard_normal(samples) + jump * (rng.random(samples) < 0.05)
    motion = sa.Trajectory.from_measurement(time, heights)
    assert np.all(np.isfinite(motion.height(time)))
    assert motion.breaks[0] == time[0]
    assert motion.breaks[-1] == time[-1]
    assert np.all(np.diff(motion.breaks) > 0)
    compiled, parameters = motion.compiled_height
    for t in rng.uniform(time[0], time[-1], 5):
        exact = float(motion.height(t))
        assert compiled(t, parameters) == pytest.approx(exact, rel=1e-9, abs=1e-18)
    # It is continuous, at corners, too.
    for corner in motion.corners:
        step = 1e-9 * (time[-1] - time[0])
        around = motion.height([corner - step, corner + step])
        assert np.ptp(around) <= 2.1 * step * motion.top_speed + 1e-18


@pytest.mark.parametrize(
    ("time", "height", "noise", "message"),
    [
        (np.arange(5.0), np.zeros(5), None, "time has 5 entries: a measurement must have at lea"),
        (np.zeros(30), np.zeros(30), None, r"time\[1\] = 0 s: must be later than time\[0\] = 0 s"),
        (-np.arange(30.0), np.zeros(30), None, r"time\[1\] = -1 s: must be later than time\[0\]"),
        (np.arange(30.0), np.full(30, np.nan), None, r"height\[0\] = nan m: must be a finite"),
        (np.arange(30.0), np.zeros(30), 0.0, "noise = 0 m: must be greater than 0"),
        (np.arange(30.0), np.zeros(30), "1 nm", "noise = '1 nm': must be a number in m"),
    ],
)
def test_no_record_is_refused(time, height, noise, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        sa.Trajectory.from_measurement(time, height, noise)


def masked(*values):
    return np.ma.masked_values(values, -1.0)


@pytest.mark.parametrize(
    ("take", "entry"),
    [
        (lambda: sa.Trajectory(masked(0, 1, -1), [0, 1e-9, 0]), "time[2]"),
        (lambda: sa.Trajectory([0, 1, 2], masked(0, -1, 0)), "height[1]"),
        (lambda: sa.Trajectory.from_measurement(np.arange(30.0), masked(*[0] * 29, -1)), "height"),
        (lambda: sa.MeasuredTip(masked(0, 1e-9, -1), (0, 1e-9, 2e-9)), "r[2]"),
        (lambda: sa.Tabulated((1e-10, 2e-10), masked(1e6, -1)), "pressures[1]"),
        (lambda: sa.GeneralizedMaxwell.from_dma(masked(1, -1), (1, 1), (1, 1), 0), "frequency[1]"),
        (lambda: sa.Paraboloid(masked(-1)[0]), "radius"),
        (lambda: CONTACT.sample.storage_modulus(masked(1, -1)), "frequency[1]"),
    ],
)  # fmt: skip
def test_masked_entries_are_refused(take, entry):
    with pytest.raises(ValueError, match=rf"^{re.escape(entry)}.* is masked: must be a number"):
        take()


def test_an_array_whose_mask_hides_nothing_is_taken():
    assert sa.Trajectory(masked(0, 1), masked(2e-9, 1e-9)).height(1.0) == 1e-9


def test_noise_taken_for_motion_is_doubtful():
    time, heights = record(RAMP, 2000, 0.1e-9)
    (doubt,) = sa.Trajectory(time, heights).doubts
    assert "samples of the motion are corners" in doubt
    assert "Trajectory.from_measurement" in doubt
    assert sa.Trajectory.from_measurement(time, heights).doubts == ()
    assert sa.Trajectory(time, RAMP.height(time)).doubts == ()
    short = sa.Trajectory(time[:200] + 1, 8e-9 + 0.01 * heights[:200])
    with pytest.warns(sa.AccuracyWarning, match="which costs some twenty steps each"):
        sa.force_distance(CONTACT, short, tolerance=0.1)


def test_a_record_that_its_path_leaves_is_doubtful():
    time, heights = record(RAMP, 300, 0.1e-9)
    heights[50::60] += 1e-7
    (doubt,) = sa.Trajectory.from_measurement(time, heights, noise=0.1e-9).doubts
    assert "remove outliers, or give steps by their corners to Trajectory" in doubt


def test_what_is_said_of_steps_is_true_of_them():
    rng = np.random.default_rng(1)
    steps = 5e-9 * ((SECOND > 0.3) + 1.0 * (SECOND > 0.6)) + 1e-10 * rng.standard_normal(4000)
    (doubt,) = sa.Trajectory.from_measurement(SECOND, steps).doubts
    assert "remove outliers, or give steps by their corners to Trajectory" in doubt
    corners = [0, 0.3, 0.30025, 0.6, 0.60025, 1]
    given_so = sa.Trajectory(corners, np.array([0, 0, 5, 5, 10, 10]) * 1e-9)
    assert np.std(given_so.height(SECOND) - steps) < 1.2e-10


def test_results_keep_how_a_path_was_drawn(clean):
    time, heights = record(RAMP, 60, 1e-12)
    for motion, kept in (
        (sa.Trajectory(time, heights), {"smooth": False}),
        (sa.Trajectory(time, heights, smooth=True), {"smooth": True}),
        (sa.Trajectory.from_measurement(time, heights, noise=1e-12), {"noise": 1e-12}),
    ):
        found = sa.force_distance(CONTACT, motion, tolerance=0.1)
        described = json.loads(found.attrs["experiment"])["motion"]
        assert described == {
            "kind": "trajectory", "time": time.tolist(), "height": heights.tolist(), **kept,
        }  # fmt: skip


# Rests


def later(rest, motion):
    """Return the corners of a motion after a rest at its first height, s."""
    time, heights = motion.breaks + rest, motion.height(motion.breaks)
    return np.append(0, time), np.append(heights[0], heights)


PECK = sa.Triangle(10e-9, -5e-9, 30e-6)
"""A peck of 1 ms."""


@pytest.fixture(scope="module")
def peck():
    return sa.force_distance(CONTACT, PECK)


@pytest.mark.parametrize("rest", [100.0, 1e6])
def test_a_rest_far_from_the_surface_costs_next_to_nothing(peck, rest):
    found = sa.force_distance(CONTACT, sa.Trajectory(*later(rest, PECK)))
    assert found.attrs["solver_attempted_steps"] < 1.2 * peck.attrs["solver_attempted_steps"] + 30
    assert_same_curve(found, peck, 2e-3)
    # All that was stored when the contact ended is lost in the rest.
    assert float(found.viscous_loss) == pytest.approx(float(found.loop_energy), rel=2e-2)


def test_rests_between_and_after_pecks_cost_next_to_nothing(peck):
    time, heights = later(100.0, PECK)
    once = time[-1]
    time = np.concatenate([time, once + time[1:], [2 * once + 100]])
    heights = np.concatenate([heights, heights[1:], [heights[-1]]])
    found = sa.force_distance(CONTACT, sa.Trajectory(time, heights))
    assert found.attrs["solver_attempted_steps"] < 2.4 * peck.attrs["solver_attempted_steps"] + 90
    assert_same_curve(found, peck.assign(loop_energy=2 * peck["loop_energy"]), 2e-3)


@pytest.mark.parametrize("smooth", [False, True])
def test_a_peck_without_a_corner_is_not_missed_after_a_rest(smooth):
    s = np.linspace(0, 1e-3, 401)
    heights = 10e-9 - 6.5e-9 * (1 - np.cos(2e3 * np.pi * s))
    alone = sa.force_distance(CONTACT, sa.Trajectory(s, heights, smooth))
    rested = sa.Trajectory(np.append(0, 100 + s), np.append(heights[0], heights), smooth)
    assert rested.breaks.size == 2
    found = sa.force_distance(CONTACT, rested)
    steps = alone.attrs["solver_attempted_steps"]
    assert found.attrs["solver_attempted_steps"] < 1.2 * steps + 30
    assert_same_curve(found, alone, 2e-3)


def test_a_fast_peck_after_a_slow_approach_is_not_missed(peck):
    time = np.concatenate([[0], 50 + PECK.breaks])
    heights = np.concatenate([[40e-9], PECK.height(PECK.breaks)])
    found = sa.force_distance(CONTACT, sa.Trajectory(time, heights))
    assert found.attrs["solver_attempted_steps"] < 2 * peck.attrs["solver_attempted_steps"]
    # Its energy, a small difference, differs by 1 % as its steps are others.
    assert_same_curve(found, peck.assign(loop_energy=found["loop_energy"]), 2e-3)
    assert float(found["loop_energy"]) == pytest.approx(float(peck["loop_energy"]), rel=0.012)


def test_a_rest_of_the_base_of_a_lever_costs_next_to_nothing():
    one = sa.force_spectroscopy(CONTACT, LEVER, PECK)
    other = sa.force_spectroscopy(CONTACT, LEVER, sa.Trajectory(*later(100.0, PECK)))
    steps = one.attrs["solver_attempted_steps"]
    assert other.attrs["solver_attempted_steps"] < 1.2 * steps + 60
    assert_same_curve(other, one, 5e-3)


def test_calm_stretches_are_landmarks():
    s = np.linspace(0, 1e-3, 401)
    heights = 10e-9 - 6.5e-9 * (1 - np.cos(2e3 * np.pi * s))
    motion = sa.Trajectory(np.append(0, 100 + s), np.append(heights[0], heights))
    stops = np.union1d(motion.breaks, motion.landmarks)
    speeds = [motion.top_speed_between(a, b) for a, b in pairwise(stops)]
    rest = speeds[int(np.argmax(np.diff(stops)))]
    assert rest < 1e-3 * motion.top_speed


# Curves that softafm wrote


@pytest.fixture(scope="module")
def curves():
    ramp = sa.Triangle(10e-9, -5e-9, 1e-3, dwell=1e-6)
    return {
        "force-distance": sa.force_distance(CONTACT, RAMP),
        "tapping-cycle": sa.tapping_cycle(CONTACT, 20e-9, 18e-9, 278e3, cycles=1),
        "force-spectroscopy": sa.force_spectroscopy(CONTACT, LEVER, ramp),
    }


@pytest.mark.parametrize("mode", ["force-distance", "tapping-cycle", "force-spectroscopy"])
def test_an_exported_curve_is_a_motion(curves, mode, tmp_path):
    curve, path = curves[mode], tmp_path / "c.csv"
    sa.export(curve, path)
    if mode == "force-spectroscopy":
        found = sa.force_spectroscopy(CONTACT, LEVER, read_trajectory(path, moves="base"))
    else:
        found = sa.force_distance(CONTACT, read_trajectory(path))
    for name in ("force_max", "force_min"):
        assert float(found[name]) == pytest.approx(float(curve[name]), rel=2e-3)
    time = curve["time"].values
    force = np.interp(time, found["time"].values, found["force"].values)
    largest = np.abs(curve["force"].values).max()
    assert np.mean(np.abs(force - curve["force"].values)) < 2e-3 * largest


def test_an_exported_curve_has_the_height_of_tip_and_base(curves, tmp_path):
    curve, path = curves["force-spectroscopy"], tmp_path / "c.csv"
    sa.export(curve, path)
    for moves in ("tip", "base"):
        time, heights = read_path(path, moves)
        np.testing.assert_array_equal(time, curve["time"])
        np.testing.assert_array_equal(heights, curve[f"{moves}_height"])


@pytest.mark.parametrize("moves", ["tip", "base"])
@pytest.mark.parametrize("name", ["height", "tip_height", "Base height"])
def test_a_height_that_stands_alone_is_the_motion(tmp_path, name, moves):
    path = tmp_path / "c.csv"
    path.write_text(f"time (s),{name} (nm)\n0,5\n1,2\n")
    assert read_path(path, moves)[1] == pytest.approx([5e-9, 2e-9])


def test_two_heights_one_of_which_is_just_called_height_are_refused(tmp_path):
    path = tmp_path / "c.csv"
    path.write_text("time (s),height (nm),tip_height (nm)\n0,5,4\n1,2,1\n")
    with pytest.raises(ValueError, match=r"^has columns 'height \(nm\)' and 'tip_height \(nm\)',"):
        read_path(path)
    with pytest.raises(ValueError, match=r"^moves = 'lever': must be 'tip' or 'base'$"):
        read_path(path, "lever")
