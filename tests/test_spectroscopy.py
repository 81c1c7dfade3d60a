"""Force spectroscopy: a lever that bends while its base moves."""

import numpy as np
import pytest
from scipy.optimize import brentq

import softafm as sa

LDPE = sa.Contact(
    sa.Paraboloid(10e-9),
    sa.StandardLinearSolid(2e9, 0.1e9, 1e-5, 0.49),
    sa.LennardJones(1e-19, 0.25e-9),
)
RAMP = sa.Triangle(20e-9, -5e-9, 200e-9)
SPECTROSCOPY = ("ldpe-spectroscopy-k28.1", "ldpe-spectroscopy-k2.0")


def ldpe(creep_time=1e-5, z0=0.25e-9, hamaker=1e-19):
    sample = sa.StandardLinearSolid(2e9, 0.1e9, creep_time, 0.49)
    return sa.Contact(LDPE.tip, sample, sa.LennardJones(hamaker, z0))


def released(result):
    return float(result["viscous_loss"]) + float(result["jump_energy"].sum())


def assert_lever_bends(result, stiffness):
    """k q = F and h0 = Z + q at all times."""
    force, deflection = result["force"].values, result["deflection"].values
    # The deflection is a difference of heights, each known to the last bit.
    rounding = 1e-15 * stiffness * np.abs(result["base_height"].values).max()
    scale = np.abs(force).max()
    assert stiffness * deflection == pytest.approx(force, abs=1e-6 * scale + rounding)
    height = result["base_height"].values + deflection
    assert result["tip_height"].values == pytest.approx(height, abs=1e-18)


@pytest.mark.parametrize("name", SPECTROSCOPY)
def test_reference_case(name, reference_cases):
    inputs = reference_cases[name]["inputs"]
    expected = {key: e["value"] for key, e in reference_cases[name]["expected"].items()}
    contact = sa.Contact(
        sa.Paraboloid(inputs["radius"]),
        sa.StandardLinearSolid(inputs["E0"], inputs["E_inf"], inputs["tau"], inputs["poisson"]),
        sa.LennardJones(inputs["hamaker"], inputs["z0"]),
    )
    lever = sa.Cantilever(inputs["stiffness"])
    motion = sa.Triangle(inputs["start"], inputs["turn"], inputs["speed"])
    result = sa.force_spectroscopy(contact, lever, motion)
    largest = max(abs(expected["force_max"]), abs(expected["force_min"]))
    for key in ("force_max", "force_min", "force_min_approach"):
        assert float(result[key]) == pytest.approx(expected[key], abs=0.01 * largest)
    scale = max(abs(expected["loop_energy"]), largest * inputs["z0"])
    for loop in (float(result["loop_energy"]), released(result)):
        assert loop == pytest.approx(expected["loop_energy"], abs=0.02 * scale)
    assert result["base_height"].values == pytest.approx(motion.height(result["time"].values))
    assert_lever_bends(result, inputs["stiffness"])


def test_a_stiff_lever_moves_the_tip_itself():
    one = sa.force_spectroscopy(LDPE, sa.Cantilever(1e6), RAMP, tolerance=1e-3)
    other = sa.force_distance(LDPE, RAMP, tolerance=1e-3)
    for key in ("force_max", "force_min", "force_min_approach", "loop_energy", "viscous_loss"):
        assert float(one[key]) == pytest.approx(float(other[key]), rel=2e-3), key
    assert_lever_bends(one, 1e6)


# Elastic instabilities of lever and surface


class RigidSample:
    """Derjaguin's force F = 2πRΦ(h) on a paraboloid over a rigid Lennard-Jones sample."""

    R, H, z0 = 100e-9, 1e-19, 0.3e-9
    contact = sa.Contact(sa.Paraboloid(R), sa.Elastic(1e20, 0.3), sa.LennardJones(H, z0))

    def force(self, h):
        return self.H * self.R / 6 * (self.z0**6 / (4 * h**8) - 1 / h**2)

    def slope(self, h):
        return self.H * self.R / 6 * (2 / h**3 - 2 * self.z0**6 / h**9)

    def energy(self, h):  # −∫F dh from infinity
        return self.H * self.R / 6 * (self.z0**6 / (28 * h**7) - 1 / h)

    def jumps(self, k):
        """Base height and energy released of jump-in and jump-out under a lever of k."""
        steepest = 3 ** (1 / 6) * self.z0  # Φ'' = −p' is zero where tension is largest

        def base(h):
            return h - self.force(h) / k

        def total(h, z):
            return k * (h - z) ** 2 / 2 + self.energy(h)

        out_at, in_at = (
            brentq(lambda h: self.slope(h) - k, *ends, xtol=1e-20)
            for ends in ((0.9 * self.z0, steepest), (steepest, 100 * self.z0))
        )
        for fold, ends in ((in_at, (0.5 * self.z0, out_at)), (out_at, (in_at, 1e4 * self.z0))):
            z = base(fold)
            landing = brentq(lambda h, z=z: base(h) - z, *ends, xtol=1e-20)
            yield z, total(fold, z) - total(landing, z)


@pytest.mark.parametrize("share", [0.02, 0.2, 0.7, 1.05])
def test_snap_in_and_out_of_a_rigid_sample(share):
    rigid = RigidSample()
    k = share * rigid.contact.steepest_attraction
    wanted = list(rigid.jumps(k)) if share < 1 else []
    start = 1.2 * max([2e-9, *(z for z, _ in wanted)])
    motion = sa.Triangle(start, -1e-9, 1e-6)
    result = sa.force_spectroscopy(rigid.contact, sa.Cantilever(k), motion, tolerance=1e-3)
    found = motion.height(result["jump_time"].values)
    assert found == pytest.approx([z for z, _ in wanted], rel=1e-3)
    assert result["jump_energy"].values == pytest.approx([e for _, e in wanted], rel=2e-3)
    # Nothing else is lost, on the way round a hysteresis or on one and the same curve.
    largest = abs(float(result["force_min"]))
    loop = sum(e for _, e in wanted)
    assert float(result["loop_energy"]) == pytest.approx(
        loop, rel=1e-3, abs=1e-3 * largest * rigid.z0
    )
    derjaguin = rigid.force(result["tip_height"].values)
    assert result["force"].values == pytest.approx(derjaguin, abs=1e-4 * largest)
    assert_lever_bends(result, k)


def test_soft_levers_pull_off_at_the_force_of_jkr():
    # Load control: the contact breaks at its largest tension, 1.5 πWR, not at 5/6 πWR as for a
    # prescribed height. From Tabor 5 to 10 the excess over JKR is 1.7 to 0.6 %.
    R, W, z0, tabor = 100e-9, 0.05, 0.3e-9, 8.0
    contact = sa.Contact(
        sa.Paraboloid(R),
        sa.Elastic(np.sqrt(R * W**2 / (tabor**3 * z0**3)), 0.0),
        sa.LennardJones.from_work_of_adhesion(W, z0),
    )
    k, unit = 0.2, np.pi * W * R
    motion = sa.Triangle(1.7 * unit / k, -3e-9, 1e-6)
    result = sa.force_spectroscopy(contact, sa.Cantilever(k), motion)
    before = np.searchsorted(result["time"].values, result["jump_time"].values[-1]) - 1
    assert float(result["force"][before]) / unit == pytest.approx(-1.5, rel=0.015)
    assert float(result["force_min"]) / unit == pytest.approx(-1.5, rel=0.015)
    assert result.sizes["jump"] == 2
    # The bent lever springs back: nearly all of its energy is in the last jump.
    assert float(result["jump_energy"][-1]) > 0.9 * (1.5 * unit) ** 2 / (2 * k)
    assert float(result["loop_energy"]) == pytest.approx(released(result), rel=5e-3)


@pytest.mark.parametrize("stiffness", [28.1, 0.5, 0.05])
@pytest.mark.parametrize("creep_time", [1e-6, 1e-3])
def test_work_done_is_what_sample_and_jumps_dissipate(stiffness, creep_time):
    motion = sa.Triangle(20e-9 + 4e-9 / stiffness, -5e-9, 200e-9)
    result = sa.force_spectroscopy(ldpe(creep_time), sa.Cantilever(stiffness), motion)
    assert float(result["contact_radius"][-1]) == 0
    assert abs(float(result["force"][-1])) < 1e-3 * abs(float(result["force_min"]))
    assert float(result["loop_energy"]) == pytest.approx(released(result), rel=0.02)
    # The softer lever loses its grip where the stiffer one follows the contact.
    assert (result.sizes["jump"] == 0) == (stiffness > 10)


# The ramp: trigger, dwell, frequency

SLOW = ldpe(creep_time=1e-2)
LEVER = sa.Cantilever(28.1)


def test_a_ramp_turns_at_its_setpoint_and_rests_there():
    setpoint, dwell = 2e-9, 0.05
    motion = sa.Triangle(20e-9, -5e-9, 2e-7, dwell=dwell, setpoint_force=setpoint)
    result = sa.force_spectroscopy(SLOW, LEVER, motion)
    time, base, force = (result[name].values for name in ("time", "base_height", "force"))
    arrived = int(np.flatnonzero(base < base.min() + 1e-18)[0])  # it rests there, to round-off
    assert force[arrived] == pytest.approx(setpoint, rel=1e-3)
    assert force[:arrived].max() < setpoint
    assert base[arrived] > motion.turn + 1e-9
    # Down, at rest and up again at the same speed.
    turned = time[arrived]
    assert base[: arrived + 1] == pytest.approx(20e-9 - 2e-7 * time[: arrived + 1], abs=1e-15)
    leaves = np.searchsorted(time, turned + dwell * (1 - 1e-9))
    assert time[leaves] == pytest.approx(turned + dwell)
    assert base[arrived : leaves + 1] == pytest.approx(base[arrived], abs=1e-15)
    assert base[leaves:] == pytest.approx(
        base[arrived] + 2e-7 * (time[leaves:] - time[leaves]), abs=1e-15
    )
    assert base[-1] == pytest.approx(20e-9)
    # At rest the sample creeps away under the lever, which follows: the force only falls.
    rest = force[arrived : leaves + 1]
    assert rest.size > 10
    assert np.all(np.diff(rest) < 1e-4 * setpoint)
    assert rest[-1] < 0.9 * setpoint
    assert_lever_bends(result, LEVER.stiffness)
    # A base at rest does no work.
    assert float(result["loop_energy"]) == pytest.approx(released(result), rel=0.02)


def test_a_trigger_does_not_depend_on_steps_or_lever():
    # The rigid lever sees the setpoint at the same tip height, and finer steps see it, too.
    motion = sa.Triangle(20e-9, -8e-9, 2e-7, setpoint_force=2e-9)
    lowest = []
    for stiffness in (1.0, 28.1, 1e5):
        for tolerance in (1e-2, 1e-3):
            result = sa.force_spectroscopy(
                ldpe(1e-8), sa.Cantilever(stiffness), motion, tolerance=tolerance
            )
            arrived = result["base_height"].values.argmin()
            assert float(result["force"][arrived]) == pytest.approx(2e-9, rel=1e-3)
            lowest.append(float(result["tip_height"][arrived]))
    # Creep in 10 ns: the curve of the approach is elastic, whatever the speed of the tip.
    assert np.ptp(lowest) < 2e-3 * abs(lowest[0]) + 2e-12


def test_a_setpoint_that_is_not_reached_does_not_turn():
    with_trigger, without = (
        sa.force_spectroscopy(SLOW, LEVER, sa.Triangle(20e-9, -2e-9, 2e-7, setpoint_force=force))
        for force in (1e-6, None)
    )
    assert float(with_trigger["base_height"].min()) == pytest.approx(-2e-9, abs=1e-15)
    for name in ("time", "force", "deflection", "loop_energy"):
        assert np.array_equal(with_trigger[name].values, without[name].values)


def test_a_trigger_works_without_a_lever():
    motion = sa.Triangle(20e-9, -5e-9, 2e-7, setpoint_force=2e-9)
    result = sa.force_distance(SLOW, motion)
    arrived = result["tip_height"].values.argmin()
    assert float(result["force"][arrived]) == pytest.approx(2e-9, rel=1e-3)
    assert float(result["tip_height"][arrived]) > -5e-9 + 1e-9


class Repelling(sa.LennardJones):
    """A law that calls its gaps of repulsion allowed, so that a ramp may start there."""

    kind = "repelling"
    equilibrium_gap = 0.1e-9


def test_a_setpoint_below_the_force_at_the_start_is_refused():
    contact = sa.Contact(LDPE.tip, sa.Elastic(1e12, 0.3), Repelling(1e-19, 0.25e-9))
    ramp = {"start": 0.15e-9, "turn": 0.12e-9, "speed": 1e-9}
    stiff = sa.Cantilever(1e3)
    start = float(sa.force_spectroscopy(contact, stiff, sa.Triangle(**ramp))["force"][0])
    assert start > 0
    with pytest.raises(ValueError, match=r"^setpoint_force = .* N: must be above") as caught:
        sa.force_spectroscopy(contact, stiff, sa.Triangle(**ramp, setpoint_force=0.9 * start))
    assert f"{start:.3g} N" in str(caught.value)
    sa.force_spectroscopy(contact, stiff, sa.Triangle(**ramp, setpoint_force=1.1 * start))


def test_a_ramp_by_frequency_is_the_ramp_by_speed():
    motion = sa.Triangle.from_frequency(mean_height=7.5e-9, amplitude=12.5e-9, frequency=4.0)
    one, other = (sa.force_spectroscopy(LDPE, LEVER, m) for m in (motion, RAMP))
    for name in ("force_max", "force_min", "loop_energy"):
        assert float(one[name]) == pytest.approx(float(other[name]), rel=1e-6)


def test_sines_and_trajectories_move_the_base():
    sine = sa.Sine(6e-9, 8e-9, 5.0)
    time = np.linspace(0, 0.2, 801)
    one, other = (
        sa.force_spectroscopy(LDPE, LEVER, m)
        for m in (sine, sa.Trajectory(time, sine.height(time)))
    )
    assert_lever_bends(one, LEVER.stiffness)
    assert float(one["loop_energy"]) == pytest.approx(released(one), rel=0.02)
    for name in ("force_max", "force_min", "loop_energy"):
        assert float(other[name]) == pytest.approx(float(one[name]), rel=0.01)


@pytest.mark.parametrize("lever", [28.1, None])
def test_what_is_no_cantilever_is_refused(lever):
    with pytest.raises(ValueError, match=r"^cantilever = "):
        sa.force_spectroscopy(LDPE, lever, RAMP)


# Stress


@pytest.mark.parametrize(
    ("contact", "stiffness", "speed"),
    [
        (ldpe(1e-9), 0.05, 2e-7),
        (ldpe(10.0), 0.05, 2e-7),
        (ldpe(0.1), 28.1, 2e-7),
        (ldpe(), 28.1, 1e-8),
        (ldpe(), 0.05, 1e-3),
        (ldpe(1e-3), 2.0, 1e-3),
        (ldpe(z0=0.15e-9), 0.05, 2e-7),
        (ldpe(z0=0.1e-9, hamaker=1.6e-20), 0.05, 2e-7),
        (ldpe(z0=0.1e-9, hamaker=1.6e-20), 28.1, 2e-7),
    ],
)
def test_extremes_run_to_their_end(contact, stiffness, speed):
    motion = sa.Triangle(20e-9 + 4e-9 / stiffness, -5e-9, speed)
    result = sa.force_spectroscopy(contact, sa.Cantilever(stiffness), motion)
    for name in result.variables:
        assert np.all(np.isfinite(result[name].values)), name
    assert float(result["time"][-1]) == motion.breaks[-1]
    assert result.attrs["warnings"] == ""
    assert np.all(result["viscous_power"].values >= 0)
    assert np.all(result["jump_energy"].values >= 0)
    assert_lever_bends(result, stiffness)
    if float(result["contact_radius"][-1]) == 0:
        assert float(result["loop_energy"]) == pytest.approx(released(result), rel=0.02)
