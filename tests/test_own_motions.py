"""Motions of someone's own that contradict themselves are refused in one line, before a run."""

import re
from dataclasses import dataclass, replace
from math import exp

import numpy as np
import pytest

import softafm as sa
from softafm.compiled.functions import HEIGHT, compile_when_used
from softafm.instrument.agreement import check_motion

CONTACT = sa.Contact(
    sa.Paraboloid(10e-9), sa.Elastic(1e9, 0.3), sa.LennardJones(hamaker=1e-19, z0=0.3e-9)
)
RAMP = sa.Triangle(start=4e-9, turn=-2e-9, speed=1e-3, dwell=2e-6)
CORNERS = ((0.0, 6e-6, 8e-6, 14e-6), (4e-9, -2e-9, -2e-9, 4e-9))


class Copied:
    """A motion that says what another says, but for some attributes."""

    kind = "copied"

    def __init__(self, motion, **changed):
        self._motion = motion
        vars(self).update(changed)

    def __getattr__(self, name):
        return getattr(self._motion, name)


def test_a_motion_written_in_a_file_of_the_package_is_looked_at_too():
    class Inside(Copied):
        __module__ = "softafm.modes.inside"

    twice = sa.Triangle(start=8e-9, turn=-4e-9, speed=2e-3, dwell=2e-6).compiled_height
    with pytest.raises(ValueError, match=r"motion\.compiled_height at .* must be the height there"):
        sa.force_distance(CONTACT, Inside(RAMP, compiled_height=twice))


@pytest.mark.parametrize("motion", [RAMP, sa.Sine(5e-9, 4e-9, 1e3, 3), sa.Trajectory(*CORNERS)])
def test_motions_of_the_package_agree(motion):
    check_motion(Copied(motion))


def test_a_smooth_trajectory_and_one_that_begins_late_agree():
    time = np.linspace(3.0, 3.001, 101)
    check_motion(Copied(sa.Trajectory(time, 5e-9 + 4e-9 * np.cos(1e4 * time), smooth=True)))


@pytest.mark.parametrize("missing", [1, 2])
def test_a_corner_that_is_not_among_the_breaks_is_refused(missing):
    breaks = np.delete(RAMP.breaks, missing)
    said = (
        rf"motion\.breaks = .* must be all corners, and at {RAMP.breaks[missing]:g} s the velocity"
    )
    with pytest.raises(ValueError, match=said):
        check_motion(Copied(RAMP, breaks=breaks))


def test_a_smooth_motion_of_many_periods_in_one_piece_has_no_corner():
    check_motion(Copied(sa.Sine(5e-9, 4e-9, 1e3, 20_000)))


TRIGGERED = replace(RAMP, setpoint_force=2e-9)


@pytest.mark.parametrize(
    ("turned_at", "said"),
    [
        (lambda time: TRIGGERED, "motion.setpoint_force = 2e-09: of the motion 'copied' must be"),
        (lambda time: None, "motion = None: must be a motion such as softafm.Triangle"),
        (lambda time: RAMP, "must be [0 1.86e-06] s at first, as it turns there"),
        (lambda time: TRIGGERED.turned_at(2 * time), "s at first, as it turns there"),
        (
            lambda time: sa.Triangle(5e-9, 5e-9 - 1e-3 * time, 1e-3),
            "must be the height without a turn",
        ),
        (
            lambda time: Copied(TRIGGERED.turned_at(time), top_speed=1e-4),
            "motion.top_speed = 0.0001: of the motion 'copied' must be at least the speed",
        ),
    ],
)
def test_what_a_motion_turns_into_is_looked_at(turned_at, said):
    with pytest.raises(ValueError, match=r"^motion\.turned_at\(1\.86e-06 s\): ") as refused:
        sa.force_distance(CONTACT, Copied(TRIGGERED, turned_at=turned_at))
    assert said in str(refused.value)


def test_a_trigger_of_a_motion_of_ones_own_turns_it():
    own, same = (sa.force_distance(CONTACT, each) for each in (Copied(TRIGGERED), TRIGGERED))
    np.testing.assert_array_equal(own["force"], same["force"])
    assert float(own.force_max) == pytest.approx(2e-9, rel=1e-2)


def test_breaks_may_be_a_list():
    for motion in (Copied(TRIGGERED, breaks=list(RAMP.breaks)), Copied(RAMP, breaks=[0.0, 6e-6])):
        check_motion(motion)


def test_a_steady_motion_ends_where_it_began():
    falling = sa.Triangle(10e-9, -2e-9, 1e-3).breaks[:2]
    down = Copied(sa.Triangle(10e-9, -2e-9, 1e-3), breaks=falling, steady=True)
    said = "motion.steady = True: of the motion 'copied' must be False, as it begins at 1e-08 m"
    with pytest.raises(ValueError, match=re.escape(said)):
        sa.force_distance(CONTACT, down)
    check_motion(Copied(RAMP, steady=True))


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"top_speed": None}, "motion.top_speed = None: of the motion 'copied' must be above"),
        ({"top_speed": "fast"}, "motion.top_speed = 'fast': of the motion 'copied' must be"),
        ({"setpoint_force": "1 nN"}, "motion.setpoint_force = '1 nN': of the motion 'copied' must"),
        ({"setpoint_force": -1e-9}, "must be a number above 0 N, or None"),
        ({"setpoint_force": 1e-9, "turned_at": None}, "motion.turned_at = None: of the motion"),
        ({"description": "a ramp"}, "motion.description = 'a ramp': of the motion 'copied' must"),
        ({"description": {"heights": np.zeros(2)}}, "must be a dict of numbers, texts and lists"),
        ({"compiled_height": RAMP.compiled_height[0]}, "must be a compiled function and its"),
        (
            {"compiled_height": (RAMP.compiled_height[0], np.array([10, 10, -20]))},
            "= [ 10 10 -20]: of the motion 'copied' must be an array of floats, not of int64",
        ),
        ({"doubts": "hello"}, "motion.doubts = 'hello': of the motion 'copied' must be a tuple of"),
        ({"periods": 1.5}, "motion.periods = 1.5: of the motion 'copied' must be a whole number"),
        ({"top_speed_between": lambda a, b: 1e-5}, "motion.top_speed_between(0, 6e-06) = 1e-05: "),
        ({"top_speed_between": lambda a, b: None}, "must be a number, at least the speed between"),
    ],
)
def test_what_a_motion_states_wrongly_is_refused_in_one_line(changed, said):
    with pytest.raises(ValueError, match=r"^motion\.") as refused:
        sa.force_distance(CONTACT, Copied(RAMP, **changed))
    assert said in str(refused.value)
    assert len(str(refused.value).splitlines()) == 1


def test_a_trigger_without_a_turn_is_refused():
    @compile_when_used(HEIGHT)
    def landing(time, parameters):
        return parameters[0] + parameters[1] * exp(-time / parameters[2])

    @dataclass
    class Landing:
        kind, landmarks, top_speed = "landing", np.empty(0), 6e-5
        breaks = np.array([0.0, 1e-3])
        setpoint_force: float = 1e-9
        compiled_height = landing, np.array([-1e-9, 6e-9, 1e-4])

        def height(self, time):
            return -1e-9 + 6e-9 * np.exp(-np.asarray(time) / 1e-4)

        def velocity(self, time):
            return -6e-5 * np.exp(-np.asarray(time) / 1e-4)

    with pytest.raises(ValueError, match=r"motion\.turned_at = None: .* a setpoint_force$"):
        sa.force_distance(CONTACT, Landing())
    check_motion(Landing(setpoint_force=None))


def test_a_top_speed_that_is_far_too_high_is_doubted():
    with pytest.warns(sa.DoubtfulValueWarning, match=r"found nowhere faster than 0\.001 m/s"):
        check_motion(Copied(RAMP, top_speed=1.0))
