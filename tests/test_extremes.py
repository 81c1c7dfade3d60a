"""The largest and smallest forces between the steps of a history."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import lagrange

import softafm as sa
from softafm.solvers import History


def history_of(time, force):
    nothing, none = np.zeros(time.size), np.empty(0)
    motion = sa.Trajectory(time, np.linspace(1e-9, 0, time.size))
    pieces = (slice(0, time.size),)
    return History(
        time, nothing, force, nothing, nothing, nothing, pieces, none, none, motion
    )  # fmt: skip


def well(height):
    """Derjaguin's force of a Lennard-Jones law: -2πRW at its deepest, W = R = z0 = 1."""
    return 2 * pi * (1 / height**8 - 4 / height**2) / 3


@given(st.lists(st.floats(0.03, 0.3), min_size=8, max_size=20), st.floats(0, 1))
@settings(max_examples=200, deadline=None)
def test_an_extreme_lies_on_a_local_cubic(steps, shift):
    """Steps differ by up to ten times, where a parabola overshoots."""
    time = 0.8 + 0.2 * shift + np.cumsum([0.0, *steps])
    force = well(time)
    found = history_of(time, force).extreme(force, -1)
    low = int(force.argmin())
    assert found <= force[low]
    if 0 < low < time.size - 1:
        dense = [force[low]]
        for left in (low - 1, low):
            first = min(max(left - 1, 0), time.size - 4)
            near = slice(first, first + 4)
            middle = time[near].mean()
            cubic = lagrange(time[near] - middle, force[near])
            dense.append(cubic(np.linspace(time[left], time[left + 1], 999) - middle).min())
        assert found >= min(dense) - 1e-6 * abs(min(dense))


@pytest.mark.parametrize("longer", [1.0, 2.0, 4.0])
def test_extremes_between_uneven_steps(longer):
    short = 0.02
    errors = []
    for part in np.linspace(0, 1, 21):
        lengths = np.where(np.arange(-12, 12) < 0, short, short * longer)
        time = 1 - part * short + np.cumsum(lengths) - lengths[:12].sum()
        force = well(time)
        errors.append(history_of(time, force).extreme(force, -1) / (-2 * pi) - 1)
    assert np.abs(errors).max() < 1e-3


@pytest.mark.parametrize("tabor", [0.05, 0.07, 0.1])
@pytest.mark.parametrize("tolerance", [1e-2, 3e-3])
def test_a_stiff_contact_pulls_no_more_than_a_rigid_one(tabor, tolerance):
    R, W, modulus = 10e-9, 0.05, 10e9 / 0.91
    z0 = (R * W**2 / modulus**2 / tabor**3) ** (1 / 3)
    law = sa.LennardJones.from_work_of_adhesion(W, z0)
    contact = sa.Contact(sa.Paraboloid(R), sa.Elastic(10e9, 0.3), law)
    motion = sa.Triangle(20 * z0, -5 * z0, 1e-6)
    result = sa.force_distance(contact, motion, tolerance=tolerance)
    # 1.989, 1.981 and 1.969 at 1e-4.
    expected = {0.05: 1.989, 0.07: 1.981, 0.1: 1.969}[tabor]
    assert float(result["force_min"]) / (-pi * R * W) == pytest.approx(expected, abs=2e-3)


LARGE_LOADS = {
    "elastic, under a load of 34 pull-offs": (
        sa.Paraboloid(2.778e-8),
        sa.Elastic(3.714e8, 0.4),
        sa.DMT(7.8e-20, 8.691e-10, 0.2),
        sa.Triangle(9.177e-9, -1.6646e-9, 2.206e-4),
        -2.846e-10,
    ),
    "melting away under the load": (
        sa.Paraboloid(1.0911e-6),
        sa.StandardLinearSolid(9.3235e9, 6.3535e7, 0.82477, 0.4),
        sa.DMT(1.1887e-19, 6.41e-10, 0.2),
        sa.Triangle(1.706e-8, -1.0017e-8, 1.2806e-7),
        -2.445e-7,
    ),
}


@pytest.mark.parametrize("name", LARGE_LOADS)
def test_a_pull_off_is_right_in_itself(name):
    """Expected values at a tolerance of 1e-3 and, on another course of steps, of 3e-4."""
    tip, sample, law, motion, expected = LARGE_LOADS[name]
    result = sa.force_distance(sa.Contact(tip, sample, law), motion)
    assert float(result["force_min"]) == pytest.approx(expected, rel=3e-3)
    assert float(result["force_max"]) > -7 * expected
