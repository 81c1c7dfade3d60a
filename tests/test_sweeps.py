"""Jumps of approach curves, and what is said of a driven lever before a run."""

from math import pi

import numpy as np
import pytest
import xarray as xr

import softafm as sa
from softafm.draw.approach_data import find_jumps
from softafm.modes.driven import estimate_deepest_tap, make_drive


@pytest.fixture(autouse=True)
def _strict_floating_point():
    with np.errstate(all="raise", under="ignore"):
        yield


def swept(amplitude, phase):
    """A sweep over falling heights whose retract is its approach."""
    data = {}
    for direction in ("approach", "retract"):
        data[f"{direction}_amplitude"] = ("sweep_height", np.asarray(amplitude, float))
        data[f"{direction}_phase"] = ("sweep_height", np.asarray(phase, float))
    return xr.Dataset(data, {"sweep_height": np.linspace(14e-9, 4e-9, len(amplitude))})


def fold(count, turn=0.0):
    """Upper branch of x = y³ − y up to its fold, and then the lower one: as steep as can be."""
    x = np.linspace(-1, 1, count) + turn / count
    edge = 2 / 3**1.5
    roots = [np.sort(np.roots([1, 0, -1, value]).real) for value in x]
    return np.array([r[2] if value < edge else r[0] for r, value in zip(roots, x, strict=True)])


@pytest.mark.parametrize("count", [20, 101, 241, 1001])
@pytest.mark.parametrize("turn", [0.0, 0.3, 0.7])
def test_a_fold_is_one_jump_however_steep_the_branch_before_it(count, turn):
    y = fold(count, turn)
    ((before, after),) = find_jumps(swept(10e-9 + 1e-9 * y, 90 + 30 * y), "approach")
    assert after == before + 1
    assert y[before] > 0.5
    assert y[after] < -1.1
    assert find_jumps(swept(10e-9 + 1e-9 * y, 90 + 30 * y), "retract") == [(after, before)]


def test_a_smooth_sweep_has_no_jumps():
    z = np.linspace(0, 1, 241)
    assert find_jumps(swept(15e-9 - 12e-9 * z, 90 + 60 * np.tanh(30 * (z - 0.5))), "approach") == []
    assert find_jumps(swept(np.full(50, 1e-8), np.full(50, 90.0)), "retract") == []


def test_leaving_and_entering_the_range_is_no_jump():
    amplitude, phase = np.linspace(14e-9, 4e-9, 60), np.linspace(100, 150, 60)
    amplitude[:5] = phase[:5] = amplitude[40:44] = phase[40:44] = np.nan
    assert find_jumps(swept(amplitude, phase), "approach") == []
    phase[20:] -= 90
    assert find_jumps(swept(amplitude, phase), "approach") == [(19, 20)]


@pytest.mark.parametrize("count", [0, 1, 2])
def test_hardly_any_heights_have_no_jumps(count):
    empty = np.full(count, np.nan)
    assert find_jumps(swept(empty, empty), "approach") == []


LEVER = sa.Cantilever(28.1, quality_factor=429.5, frequency=278e3)


@pytest.mark.parametrize("frequency", [277.5e3, 278e3, 278.4e3])
def test_the_strongest_push_and_the_most_dissipation_are_on_the_curve(frequency):
    drive, found = make_drive(LEVER, 15e-9, frequency)
    assert found == frequency
    amplitude = np.array([3e-9, 7e-9, 9e-9])
    push = drive.strongest_push(amplitude)
    assert drive.excess(amplitude, -push * amplitude / 2, 0.0) == pytest.approx(0, abs=1e-12)
    assert drive.strongest_push(40e-9) == 0
    # Fed into a tap whose virial cancels the detuning, more holds at no amplitude.
    amplitude = np.linspace(1e-9, 15e-9, 1401)
    virial = drive.stiffness * (1 - drive.detuning**2) * amplitude**2 / 2
    excess = drive.excess(amplitude, virial, drive.most_dissipation)
    assert excess.min() == pytest.approx(0, abs=1e-5)


def test_the_most_dissipation_at_resonance():
    drive, _ = make_drive(LEVER, 15e-9)
    assert drive.most_dissipation == pytest.approx(pi * 28.1 * 15e-9**2 / (4 * 429.5))


@pytest.mark.parametrize(("hamaker", "z0", "within"), [(1e-24, 2e-11, 0.05), (2e-20, 2e-10, 0.35)])
def test_the_deepest_tap_is_foreseen(hamaker, z0, within):
    """Closely where adhesion and its range count little, else by order of magnitude."""
    contact = sa.Contact(sa.Paraboloid(50e-9), sa.Elastic(2e9, 0.35), sa.LennardJones(hamaker, z0))
    ratios = np.linspace(0.95, 0.2, 16)
    drive, frequency = make_drive(LEVER, 15e-9)
    expected = estimate_deepest_tap(contact, drive, frequency, 15e-9 * ratios)
    found = sa.approach_curve(contact, LEVER, 15e-9, ratios, tolerance=0.05)
    repulsive = found.sel(branch="repulsive")
    lowest = float((repulsive.mean_height - 15e-9 * repulsive.amplitude_ratio).min())
    assert expected.mean_height - expected.amplitude == pytest.approx(lowest, rel=within)
    assert expected.steady
