"""Levers as objects: what they remember, what they are asked, and one of the user's own."""

import re
from dataclasses import dataclass
from math import cos, inf, pi, sin

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import softafm as sa
from softafm.compiled.functions import ACCEPTANCE, RESPONSE, compile_when_used
from softafm.instrument.compiled_levers import remember_nothing
from softafm.instrument.lever import Rigid, Spring

LAW = sa.LennardJones(1e-19, 0.25e-9)
R = 10e-9
SOFT = sa.Contact(sa.Paraboloid(R), sa.StandardLinearSolid(2e9, 0.1e9, 1e-5, 0.49), LAW)
STIFF = sa.Contact(sa.Paraboloid(R), sa.Elastic(1e13, 0.3), LAW)


@compile_when_used(RESPONSE)
def ring(time, step, deflection, force, parameters, state):
    """A mass on a spring, without friction, under a force that is linear in time over the step."""
    k, omega = parameters
    theta = omega * step
    if theta < 0.1:
        early, late = theta**2 / 3 - theta**4 / 30, theta**2 / 6 - theta**4 / 120
    else:
        early, late = sin(theta) / theta - cos(theta), 1 - sin(theta) / theta
    free = state[0] * cos(theta) + state[1] / omega * sin(theta)
    return free + early * force / k, k / late


@compile_when_used(ACCEPTANCE)
def ring_on(time, step, before, force, parameters, state):
    k, omega = parameters
    theta, rate = omega * step, (force - before) / step
    q, v = state[0] - before / k, state[1] - rate / k
    state[0] = q * cos(theta) + v / omega * sin(theta) + force / k
    state[1] = v * cos(theta) - q * omega * sin(theta) + rate / k


@dataclass(frozen=True)
class Ringing:
    """An oscillator of stiffness k, N/m, and frequency, Hz; it remembers deflection and speed."""

    spring: float
    frequency: float
    stiffness = inf

    @property
    def compiled_response(self):
        return ring, ring_on, np.array([self.spring, 2 * pi * self.frequency])

    def at_start(self):
        return np.zeros(2)

    def falling(self, creep_time):
        return Rigid()


@compile_when_used(ACCEPTANCE)
def count(time, step, before, force, parameters, state):
    """Remember the time passed, the last instant, and how often the force was not the last one."""
    state[0] += step
    state[1] = time
    state[3] += 0.0 if before == state[2] else 1.0
    state[2] = force


class Counting(Spring):
    """A spring whose ``kept`` shows what it was asked to remember."""

    @property
    def compiled_response(self):
        respond, _, parameters = super().compiled_response
        return respond, count, parameters

    def at_start(self):
        state = np.zeros(4)
        object.__setattr__(self, "kept", state)
        return state


def test_a_lever_of_ones_own_with_inertia_rings_as_newton_says():
    """A tip that comes near a rigid sample in two periods: m q̈ + k q = F(base + q)."""
    k, f = 1.0, 1e6
    motion = sa.Triangle(3e-9, 1.3e-9, 1e-3)

    def force(h):
        return LAW.hamaker * R / 6 * (LAW.z0**6 / (4 * h**8) - 1 / h**2)

    def motion_of(t, y):
        return y[1], (2 * pi * f) ** 2 * (force(motion.height(t) + y[0]) / k - y[0])

    off = []
    for tolerance in (1e-2, 1e-4):
        lever = Ringing(k, f)
        history = sa.solvers.Energy().solve(STIFF, motion, lever=lever, tolerance=tolerance)
        exact = solve_ivp(motion_of, (0, motion.breaks[-1]), (0.0, 0.0), rtol=1e-10, atol=1e-20,
                          t_eval=history.time, max_step=1e-8).y[0]  # fmt: skip
        largest, still = np.abs(exact).max(), force(history.tip_height) / k
        assert np.abs(exact - still).max() > 0.3 * largest
        off.append(np.abs(history.tip_height - motion.height(history.time) - exact).max() / largest)
    assert off[0] < 1e-2
    assert off[1] < 0.1 * off[0]


def test_a_stiffness_is_a_spring():
    motion, solver = sa.Triangle(1e-8, -2e-9, 2e-6), sa.solvers.Energy()
    one = solver.solve(SOFT, motion, stiffness=2.0)
    two = solver.solve(SOFT, motion, lever=Spring(2.0))
    assert one.jump_time.size > 0
    for name in ("time", "tip_height", "force"):
        assert np.array_equal(getattr(one, name), getattr(two, name))


def test_only_steps_that_are_accepted_are_remembered():
    """Also those of falls, in which the lever is another one, but time passes."""
    lever, motion = Counting(2.0), sa.Triangle(1e-8, -2e-9, 2e-6)
    history = sa.solvers.Energy().solve(SOFT, motion, lever=lever)
    assert history.diagnostics["attempted_steps"] > history.diagnostics["steps"]
    assert history.jump_time.size > 0
    passed, instant, force, breaks = lever.kept
    assert passed == pytest.approx(motion.breaks[-1], rel=1e-12)
    assert instant == motion.breaks[-1]
    assert force == history.force[-1]
    # The force jumps in falls and where the surface settles at the start, nowhere else.
    assert 1 + history.jump_time.size <= breaks <= 1 + len(history.pieces)


@pytest.mark.parametrize(
    ("lever", "stiffness", "said"),
    [
        (2.0, None, r"lever = 2\.0: must be a lever such as softafm"),
        (Spring, None, "lever = <class Spring>: must be a lever"),
        (type("Bare", (), {"stiffness": 1.0, "at_start": None})(), None,
         "it has no compiled_response and falling"),
        (Spring(1.0), 2.0, "stiffness = 2 N/m: must be left out where there is a lever"),
    ],
)  # fmt: skip
def test_what_is_no_lever_is_refused(lever, stiffness, said):
    with pytest.raises(ValueError, match=said):
        sa.solvers.Energy().solve(
            SOFT, sa.Triangle(1e-8, -2e-9, 2e-6), lever=lever, stiffness=stiffness
        )


@compile_when_used(RESPONSE)
def swapped(time, step, deflection, force, parameters, state):
    return parameters[0], deflection


@compile_when_used(RESPONSE)
def meddling(time, step, deflection, force, parameters, state):
    state[0] = time
    return deflection, parameters[0]


@compile_when_used(RESPONSE)
def uncompilable(time, step, deflection, force, parameters, state):
    return undefined(time), 1.0  # noqa: F821


@compile_when_used(ACCEPTANCE)
def spoiling(time, step, before, force, parameters, state):
    state[0] = inf


class Own(Spring):
    """A spring of which a test states one thing anew."""

    def at_start(self):
        return np.zeros(1)


RESPONDING, KEEPING, PARAMETERS = Counting(2.0).compiled_response
DECORATED = r"must be a function decorated with softafm\.compiled\.functions\.compile_when_used"


@pytest.mark.parametrize(
    ("stated", "said"),
    [
        ({"stiffness": -1.0}, r"stiffness = -1 N/m: must be greater than 0"),
        ({"stiffness": "0.5 N/m"}, "stiffness = '0.5 N/m': must be a number in N/m"),
        ({"falling": lambda self: self}, "falling: must take a creep time, s: "),
        ({"falling": lambda self, creep_time: None}, r"falling\(\.\.\.\) = None: must be a lever"),
        ({"at_start": lambda self: 0.0}, r"at_start\(\) = 0.0: must be an array of finite floats"),
        ({"compiled_response": lambda self: 0}, "compiled_response = <.*: must be a property that"),
        ({"compiled_response": (RESPONDING, PARAMETERS)}, "compiled_response = .* three things"),
        ({"compiled_response": (cos, KEEPING, PARAMETERS)},
         rf"compiled_response\[0\] = .*{DECORATED}"),
        ({"compiled_response": (RESPONDING, RESPONDING, PARAMETERS)},
         rf"compiled_response\[1\] = .*{DECORATED}\(ACCEPTANCE\)"),
        ({"compiled_response": (RESPONDING, remember_nothing, [2.0, 0.0])},
         r"compiled_response\[2\] = \[2.0, 0.0\]: must be an array of finite floats"),
        ({"compiled_response": (swapped, remember_nothing, PARAMETERS)},
         r"compiled_response\[0\] = \(2 m, 0 N/m\) .*: must be a finite rest, then a stiffness"),
        ({"compiled_response": (meddling, remember_nothing, PARAMETERS)}, "changes the state"),
        ({"compiled_response": (RESPONDING, spoiling, PARAMETERS)}, "the state after .* = .*inf"),
        ({"compiled_response": (uncompilable, remember_nothing, PARAMETERS)},
         "must be a function that numba compiles: .*'undefined'"),
    ],
)  # fmt: skip
def test_a_lever_whose_functions_do_not_do_their_part_is_refused(stated, said):
    own = type("Stated", (Own,), {**stated, "__init__": lambda self: None, "creep_time": 0.0})
    if "stiffness" not in stated:
        own.stiffness = 2.0
    with pytest.raises(ValueError, match=r"^(lever\.|the state)") as refused:
        sa.solvers.Energy().solve(SOFT, sa.Triangle(1e-8, -2e-9, 2e-6), lever=own())
    assert re.search(said, str(refused.value))
    assert str(refused.value).isprintable()


def test_a_cantilever_in_place_of_a_lever_is_told_of_its_spring():
    said = r"goes into modes; .* must be softafm\.instrument\.lever\.Spring\(2\)$"
    with pytest.raises(ValueError, match=said):
        sa.solvers.Energy().solve(SOFT, sa.Triangle(1e-8, -2e-9, 2e-6), lever=sa.Cantilever(2.0))


def test_a_spring_needs_a_stiffness():
    with pytest.raises(ValueError, match="stiffness = 0 N/m"):
        Spring(0.0)
    assert Rigid().falling(1e-9) == Rigid()
    assert Spring(2.0).falling(1e-9) == Spring(2.0, 1e-9)
    assert remember_nothing(0.0, 1.0, 0.0, 1.0, np.empty(0), np.empty(0)) is None
