"""Taps in the steady state, reached by accelerated cycles."""

import numpy as np
import pytest
from scipy.special import ellipe, ellipk, i0e

import softafm as sa
from softafm.solvers.periodic import PeriodicMemory

FREQUENCY = 250e3
PERIOD = 1 / FREQUENCY
SCALARS = ("virial", "dissipation", "force_max", "force_min", "force_mean", "indentation")


def smooth(periods):
    """The sample of the smooth tap, which crosses no fold, with a creep time in periods."""
    return sa.Contact(
        sa.Paraboloid(12e-9),
        sa.StandardLinearSolid(2.5e9, 0.3e9, periods * PERIOD, 0.45),
        sa.LennardJones(1e-19, 0.3e-9),
    )


SMOOTH = {"amplitude": 40e-9, "mean_height": 36e-9, "frequency": FREQUENCY}


def sticky(periods):
    return sa.Contact(
        sa.Paraboloid(10e-9),
        sa.StandardLinearSolid(2e9, 0.1e9, periods * PERIOD, 0.49),
        sa.LennardJones(1e-19, 0.3e-9),
    )


STICKY = {"amplitude": 40e-9, "mean_height": 38e-9, "frequency": FREQUENCY}


def scale(result, name, amplitude):
    force = max(abs(float(result["force_max"])), abs(float(result["force_min"])))
    if name.startswith("force"):
        return force
    if name == "indentation":
        return 1e-9
    return max(abs(float(result[name])), 0.02 * force * amplitude)


def assert_alike(one, other, amplitude, tolerance, names=SCALARS):
    for name in names:
        allowed = tolerance * scale(other, name, amplitude)
        assert float(one[name]) == pytest.approx(float(other[name]), abs=allowed), name


# Against cycles without acceleration


@pytest.mark.parametrize(("contact", "tap"), [(smooth, SMOOTH), (sticky, STICKY)])
@pytest.mark.parametrize("periods", [1, 3])
def test_steady_is_where_many_cycles_lead(contact, tap, periods):
    steady = sa.tapping_cycle(contact(periods), **tap)
    many = sa.tapping_cycle(contact(periods), **tap, cycles=10 * periods + 10)
    assert_alike(steady, many, tap["amplitude"], 0.01)
    # Which is not where they start from.
    first = float(many["cycle_dissipation"][0])
    assert abs(first / float(many["dissipation"]) - 1) > 0.3
    assert 1 < int(steady["cycles_run"]) < 12
    assert steady["cycle_virial"].shape == (1,)
    assert float(steady["time"][0]) == 0
    assert float(steady["time"][-1]) == PERIOD


def test_steady_is_where_many_cycles_of_another_solver_lead():
    # Errors of its steps add up in the memory: Adams-Bashforth needs ten times as many.
    solver = sa.solvers.EnhancedAttard(
        functions=25, nodes=70, steps=40 * 1500, stepper=sa.solvers.RungeKutta4()
    )
    many = sa.tapping_cycle(smooth(10), **SMOOTH, cycles=40, solver=solver)
    steady = sa.tapping_cycle(smooth(10), **SMOOTH)
    assert_alike(steady, many, SMOOTH["amplitude"], 0.01)
    assert float(many["virial"]) == pytest.approx(float(many["cycle_virial"][-2]), rel=1e-3)


@pytest.mark.parametrize(("contact", "tap"), [(smooth, SMOOTH), (sticky, STICKY)])
def test_a_surface_that_recovers_needs_no_second_cycle(contact, tap):
    steady = sa.tapping_cycle(contact(0.02), **tap)
    once = sa.tapping_cycle(contact(0.02), **tap, cycles=1)
    assert int(steady["cycles_run"]) == 1
    for name in ("time", "force", "virial", "dissipation"):
        assert np.array_equal(steady[name].values, once[name].values)


def test_an_elastic_surface_has_no_memory():
    contact = sa.Contact(sa.Paraboloid(12e-9), sa.Elastic(1e9, 0.3), sa.LennardJones(1e-19, 3e-10))
    steady = sa.tapping_cycle(contact, **SMOOTH)
    assert int(steady["cycles_run"]) == 1
    assert float(steady["viscous_loss"]) == 0
    assert float(steady["dissipation"]) == pytest.approx(
        0, abs=1e-3 * scale(steady, "dissipation", SMOOTH["amplitude"])
    )


# Against the limit of slow creep


def rings(edges):
    """Middles of rings, and the displacement K there of unit pressures on them."""
    r = (edges[1:] + edges[:-1]) / 2

    def disc(a):
        inside = r[:, None] <= a
        x = np.where(inside, r[:, None] / np.where(inside, a, 1), a / r[:, None]) ** 2
        far = ellipe(x) - (1 - x) * ellipk(x)
        return 4 / np.pi * np.where(inside, a * ellipe(x), r[:, None] * far)

    outer = disc(edges[None, 1:])
    return r, outer - np.pad(outer[:, :-1], ((0, 0), (1, 0)))


def averaged_tap(contact, amplitude, mean_height, frequency):
    """Virial, largest and mean force, and loss·(creep time)/period of a tap on a slow surface.

    Where a period is too short for creep the memory is the mean pressure w, and the surface of
    every instant the elastic u = v − J_g K p(h0 + g − u) about v = −J_1 K w, found by Newton's
    method. w is found by relaxed repetition. What is lost is J_1/τ ∫∮(p − w) K (p − w).
    """
    edges = np.linspace(0, 25e-9, 121)
    r, influence = rings(edges)
    areas, tip = np.pi * np.diff(edges**2), contact.tip.profile(r)
    compliance = contact.body.compliance
    stiff, soft = compliance.instantaneous, compliance.elements[0]
    law = contact.surface
    angles = np.linspace(0, np.pi, 121)  # the way up is as the way down
    shares = np.full(angles.size, 1 / (angles.size - 1))
    shares[[0, -1]] /= 2
    heights = mean_height + amplitude * np.cos(angles)

    def slope(gap):
        return law.hamaker / (6 * np.pi * gap**4) * (3 - 9 * (law.z0 / gap) ** 6)

    w = np.zeros(r.size)
    pressures = np.zeros((angles.size, r.size))
    for _ in range(9):
        v = -soft * influence @ w
        u = v.copy()
        for i, height in enumerate(heights):
            for _ in range(50):
                gap = height + tip - u
                if gap.min() < 0.7 * law.z0:  # no repulsion is felt from within the tip
                    u = np.minimum(u, height + tip - 0.8 * law.z0)
                    continue
                miss = u - v + stiff * influence @ law.pressure(gap)
                if np.abs(miss).max() < 1e-6 * law.z0:
                    break
                jacobian = np.eye(r.size) - stiff * influence * slope(gap)
                change = np.linalg.solve(jacobian, -miss)
                u = u + change * min(1, 0.3 / np.abs(change / gap).max())
            pressures[i] = law.pressure(height + tip - u)
        mean = shares @ pressures
        w = (w + mean) / 2
    assert np.abs(soft * influence @ (w - mean)).max() < 2e-3 * law.z0
    force, lag = pressures @ areas, pressures - mean
    loss = soft * np.sum(shares * np.sum(lag * (lag @ influence.T) * areas, axis=1))
    virial = shares @ (force * amplitude * np.cos(angles))
    return {
        "virial": virial,
        "force_max": force.max(),
        "force_mean": shares @ force,
        "viscous_loss": loss,
    }


@pytest.fixture(scope="module")
def limit():
    return averaged_tap(smooth(1), **SMOOTH)


@pytest.mark.parametrize("periods", [100, 1e4, 1e6])
def test_slow_creep_leaves_the_mean_pressure_and_little_loss(limit, periods):
    result = sa.tapping_cycle(smooth(periods), **SMOOTH)
    assert int(result["cycles_run"]) < 60
    for name in ("virial", "force_max", "force_mean"):
        assert float(result[name]) == pytest.approx(limit[name], rel=0.01), name
    loss = limit["viscous_loss"] / periods
    assert float(result["viscous_loss"]) == pytest.approx(loss, rel=0.01)
    allowed = 0.01 * scale(result, "dissipation", SMOOTH["amplitude"])
    assert float(result["dissipation"]) == pytest.approx(loss, abs=allowed)


def test_a_tap_of_many_creep_times_between():
    # The loss as a function of creep time has one maximum: from the recovered surface to the slow.
    losses = [
        float(sa.tapping_cycle(smooth(periods), **SMOOTH)["viscous_loss"])
        for periods in (0.01, 0.1, 1, 10, 100)
    ]
    top = int(np.argmax(losses))
    assert 0 < top < 3
    assert np.all(np.diff(losses)[:top] > 0)
    assert np.all(np.diff(losses)[top:] < 0)


def test_any_chain_settles():
    # Modes of a nanosecond and of a second side by side.
    sample = sa.GeneralizedKelvinVoigt(
        2e9, (2e-9, 2e-9, 2e-9), (0.01 * PERIOD, PERIOD, 1e6 * PERIOD), 0.45
    )
    contact = sa.Contact(sa.Paraboloid(12e-9), sample, sa.LennardJones(1e-19, 0.3e-9))
    result = sa.tapping_cycle(contact, **SMOOTH, tolerance=3e-3)
    assert int(result["cycles_run"]) < 60
    assert float(result["dissipation"]) == pytest.approx(float(result["viscous_loss"]), rel=0.01)


# Taps of samples that take many cycles to come to rest, with sharp rims in their memory.

SOFT_TAPS = {  # sample, z0 in m, and the largest force at 1e-4, N
    "creep of 0.28 periods": (sa.StandardLinearSolid(2e9, 0.1e9, 1e-6, 0.49), 0.25e-9, 48.066e-9),
    "creep of a period": (sa.StandardLinearSolid(2e9, 0.1e9, 3.6e-6, 0.49), 0.25e-9, 83.230e-9),
    "creep of 100 periods": (sa.StandardLinearSolid(2e9, 0.1e9, 3.6e-4, 0.49), 0.25e-9, 92.062e-9),
    "ten times softer": (sa.StandardLinearSolid(2e8, 1e7, 1e-6, 0.49), 0.3e-9, 4.8397e-9),
}


@pytest.mark.parametrize("name", SOFT_TAPS)
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_taps_of_soft_samples_become_steady(name, tolerance):
    """The memory is read from a mesh that does not ride, so that cycles repeat."""
    sample, z0, largest = SOFT_TAPS[name]
    contact = sa.Contact(sa.Paraboloid(10e-9), sample, sa.LennardJones(1e-19, z0))
    tap = {"amplitude": 49.6e-9, "mean_height": 42.82e-9, "frequency": 278e3}
    result = sa.tapping_cycle(contact, **tap, tolerance=tolerance)  # warnings are errors
    assert int(result["cycles_run"]) < 10
    assert float(result["force_max"]) == pytest.approx(largest, rel=5e-4)
    released = float(result["viscous_loss"]) + float(result["jump_energy"].sum())
    assert float(result["dissipation"]) == pytest.approx(released, rel=3e-3)


# Energy


@pytest.mark.parametrize("mean_height", [36e-9, 40.2e-9])
@pytest.mark.parametrize("periods", [0.03, 0.3, 3])
def test_work_done_by_a_steady_tap_is_what_it_dissipates(mean_height, periods):
    # Of the first tap from flat it is not: there it also goes into the surface.
    tap = {**STICKY, "mean_height": mean_height}
    result = sa.tapping_cycle(sticky(periods), **tap)
    released = float(result["viscous_loss"]) + float(result["jump_energy"].sum())
    allowed = 0.01 * scale(result, "dissipation", tap["amplitude"])
    assert float(result["dissipation"]) == pytest.approx(released, abs=allowed)


# Taps that stay in contact


@pytest.mark.parametrize(
    ("mean_height", "periods"), [(-1e-9, 0.1), (-1e-9, 1), (-2.5e-9, 0.3), (-2.5e-9, 1)]
)
def test_a_tap_that_starts_in_contact(mean_height, periods):
    """As a tip that is lowered first and then tapped for many cycles."""
    amplitude, cycles, contact = 1e-9, 10 + 10 * periods, sticky(periods)
    top = mean_height + amplitude
    down = np.linspace(-2 * PERIOD, 0, 200, endpoint=False)
    time = np.linspace(0, cycles * PERIOD, int(200 * cycles) + 1)
    heights = mean_height + amplitude * np.cos(2 * np.pi * FREQUENCY * time)
    lowered = top + 10e-9 * (1 - np.cos(np.pi * down / (4 * PERIOD)))
    motion = sa.Trajectory(np.append(down, time), np.append(lowered, heights))
    many = sa.force_distance(contact, motion)

    fine = np.linspace((cycles - 1) * PERIOD, cycles * PERIOD, 5001)
    force, power = (
        np.interp(fine, many["time"].values, many[name].values)
        for name in ("force", "viscous_power")
    )
    phase = 2 * np.pi * FREQUENCY * fine
    speed = -2 * np.pi * FREQUENCY * amplitude * np.sin(phase)
    wanted = {
        "virial": FREQUENCY * np.trapezoid(force * amplitude * np.cos(phase), fine),
        "dissipation": -np.trapezoid(force * speed, fine),
        "viscous_loss": np.trapezoid(power, fine),
        "force_max": force.max(),
        "force_min": force.min(),
        "force_mean": FREQUENCY * np.trapezoid(force, fine),
    }
    result = sa.tapping_cycle(contact, amplitude, mean_height, FREQUENCY)
    assert_alike(result, wanted, amplitude, 0.015, names=wanted)
    # The tip never comes off, or only for a part of the period.
    assert float(result["contact_time"]) > 0.7 * PERIOD


@pytest.mark.parametrize("mean_height", [-2e-9, 2e-9])
def test_a_sample_that_hardly_moves_in_a_cycle_carries_the_mean_pressure(mean_height):
    """Over a sine an exponential is in the mean one of the same decay, higher up by λ ln I₀(A/λ).

    The mean force is that of an elastic contact at rest under such a law, at the mean height.
    """
    tip, law, amplitude = sa.Paraboloid(20e-9), sa.Repulsion(1e8, 0.5e-9), 5e-9
    tap = sa.tapping_cycle(
        sa.Contact(tip, sa.KelvinVoigt(1e6, 10.0, 0.4), law), amplitude, mean_height, 1e5
    )
    lift = amplitude + law.decay * np.log(i0e(amplitude / law.decay))
    rest = sa.Contact(tip, sa.Elastic(1e6, 0.4), law)
    pressed = sa.force_distance(rest, sa.Triangle(20e-9, mean_height - lift, 1e-6), tolerance=1e-3)
    assert float(tap.force_mean) == pytest.approx(float(pressed.force_max), rel=2e-3)
    assert float(tap.cycles_run) < 15


def test_a_slow_sample_that_adheres_finds_its_steady_cycle():
    """Repeated cycles throw it to and fro by many gaps."""
    contact = sa.Contact(
        sa.Hyperboloid(30e-9, 0.6), sa.KelvinVoigt(1e7, 1.0, 0.3), sa.Morse(0.002, 3e-10, 1e-10)
    )
    tap = sa.tapping_cycle(contact, 5e-9, 3e-9, 1e5)
    finer = sa.tapping_cycle(contact, 5e-9, 3e-9, 1e5, tolerance=1e-3)
    for name in ("force_max", "force_min", "force_mean", "virial", "viscous_loss"):
        assert float(tap[name]) == pytest.approx(float(finer[name]), rel=0.01), name


# The accelerator by itself


class Cycle:
    """A made-up cycle: loads as a function of the memory with which it starts."""

    times, compliances = np.array([0.5, 20.0]), np.array([2.0, 3.0])

    def __init__(self, gained):
        self.gained = gained

    def settle(self, memory, cycles):
        """Distances of the starts of all cycles from the periodic memory, and the last start."""
        seeker, offs = PeriodicMemory(1.0, self.compliances, self.times, np.inf), []
        for _ in range(cycles):
            start = memory
            memory, off = seeker.next_start(start, self.gained(start))
            offs.append(off)
        return np.array(offs), start


def test_a_load_without_feedback_is_periodic_after_one_cycle():
    load = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    offs, memory = Cycle(lambda memory: load).settle(np.zeros((2, 3)), 2)
    fading = np.exp(-1 / Cycle.times)[:, None]
    brute = np.zeros((2, 3))
    for _ in range(1000):  # every cycle the memory fades and is loaded anew
        brute = fading * brute + load
    assert memory == pytest.approx(brute)
    assert offs[1] < 1e-9 * offs[0]


def test_a_linear_feedback_is_found_exactly():
    # Feedback so strong that repetition alone would run away: Φ has slopes of −5 and −2.
    rng = np.random.default_rng(1)
    fading = np.exp(-1 / Cycle.times)[:, None]
    directions = rng.normal(size=(2, 6))
    partners = np.linalg.pinv(directions)
    feedback = partners @ np.diag([-5.0, -2.0]) @ directions
    load = rng.normal(size=(2, 3))

    def gained(memory):
        return (1 - fading) * (load + (feedback @ memory.ravel()).reshape(2, 3))

    offs, memory = Cycle(gained).settle(np.zeros((2, 3)), 6)
    # One cycle for each independent direction and two more.
    exact = np.linalg.solve(np.eye(6) - feedback, load.ravel()).reshape(2, 3)
    assert memory == pytest.approx(exact, rel=1e-6)
    assert offs[-1] < 1e-6 * offs[0]
    assert offs[:2].min() > 0.01 * offs[0]
    # What it tells is how far the displacement is off, at worst.
    miss = (gained(memory * 0) / (1 - fading)).T @ Cycle.compliances
    assert offs[0] == pytest.approx(np.abs(miss).max())


def test_a_nonlinear_feedback_is_found():
    # A load that saturates: y = tanh(2 − 4y), steeper there than repetition bears.
    fading = np.exp(-1 / Cycle.times)[:, None]
    shifts = np.array([[1.0, 2.0, 3.0], [0.5, 2.5, 2.0]])

    def gained(memory):
        return (1 - fading) * np.tanh(shifts - 4 * memory)

    offs, memory = Cycle(gained).settle(np.zeros((2, 3)), 40)
    assert memory == pytest.approx(np.tanh(shifts - 4 * memory), abs=1e-6)
    assert offs[-1] < 1e-6 * offs[0]


@pytest.mark.parametrize(
    ("misses", "scatter"),
    [
        ([7.3, 4.9, 3.3, 2.2, 0.19, 0.087, 0.134, 0.011], 0),  # as a tap settles
        ([3.0, 5.0, 2.0, 4.0, 1.5, 0.5, 0.1, 0.003], 0),
        ([8.4, 2.0, 0.5, 0.06, 0.17, 0.01, 0.05, 0.02, 0.06, 0.04, 0.05, 0.003], 0.045),
    ],
)
def test_cycles_that_scatter_are_not_steady_by_chance(misses, scatter):
    from softafm.solvers.energy.steadiness import Steadiness

    cycles = Steadiness(strictness=1.0)
    fields = [(name, float) for name in ("time", "force", "height", "lost", "jump")]
    cycle = np.array([(0.0, 1e-9, 1e-9, 0.0, 0.0), (1.0, 2e-9, 2e-9, 0.0, 0.0)], fields)
    for miss in misses:
        cycles.note(cycle, miss)
    assert cycles.scatter == pytest.approx(scatter)


@pytest.mark.parametrize(
    ("sample", "law", "tip", "tap"),
    [
        (  # its dent swung to and fro, less by an eighth each cycle, and was taken as steady
            sa.KelvinVoigt(2.2e8, 1.41e-5, 0.366),
            sa.Exponential(2.44e-3, 0.454e-9, 0.439e-9, 0.0454e-9),
            sa.Paraboloid(13e-9),
            (14.4e-9, 14.5e-9, 2e5),
        ),
        (  # its dent was found and lost again every third cycle
            sa.StandardLinearSolid(26.1e9, 0.109e9, 6.51e-6, 0.343),
            sa.LennardJones(6.05e-21, 0.358e-9),
            sa.Paraboloid(45.7e-9),
            (30.5e-9, 29.8e-9, 6.15e5),
        ),
    ],
)
def test_a_dent_that_overshoots_settles(sample, law, tip, tap):
    contact = sa.Contact(tip, sample, law)
    steady = sa.tapping_cycle(contact, *tap)
    assert steady.cycles_run < 12
    finer = sa.tapping_cycle(contact, *tap, tolerance=1e-3)
    for name in ("force_max", "force_mean", "virial", "viscous_loss"):
        assert float(steady[name]) == pytest.approx(float(finer[name]), rel=1e-2), name


def test_an_elastic_tap_that_never_comes_off_is_steady_only_once_it_is_caught():
    """Its first cycle falls into contact; the ones after it neither jump nor lose anything."""
    soft = sa.Contact(
        sa.Paraboloid(1e-6),
        sa.Elastic(2e6, 0.5),
        sa.LennardJones.from_work_of_adhesion(0.05, 0.3e-9).stretched(100),
    )
    tap = sa.tapping_cycle(soft, 35e-9, 91.57e-9, 5e4)
    assert tap.cycles_run == 2
    assert tap.contact_radius.values.min() > 0
    assert tap.jump_time.size == 0
    assert float(tap.dissipation) == 0


@pytest.mark.filterwarnings("ignore:audit")  # which is right, too
def test_cycles_that_find_no_steady_state_are_warned_of(monkeypatch):
    from softafm.solvers.energy import run as energy_run

    monkeypatch.setattr(energy_run, "MOST_CYCLES", 2)
    contact = sa.Contact(
        sa.Paraboloid(10e-9),
        sa.StandardLinearSolid(2e9, 0.1e9, 10 / 278e3, 0.49),
        sa.LennardJones(1e-19, 3e-10),
    )
    with pytest.warns(sa.AccuracyWarning, match="no steady cycle after 2: the surface starts"):
        result = sa.tapping_cycle(contact, 49.6e-9, 46e-9, 278e3)
    assert "no steady cycle" in result.attrs["warnings"]


def test_cycle_whose_forces_still_swing_is_no_steady_one():
    """Stiff walls: what is left of the dent is little in gaps, and was 3 % of the largest force."""
    contact = sa.Contact(
        sa.Hyperboloid(radius=49e-9, half_angle=0.31),
        sa.StandardLinearSolid(8.6e12, 9.4e9, creep_time=5e-5, poisson=0.2),
        sa.Repulsion(pressure_at_zero=4e12, decay=0.75e-9),
    )
    tap = {"amplitude": 58.9e-9, "mean_height": 58.55e-9, "frequency": 385.6e3}
    coarse, fine = (sa.tapping_cycle(contact, **tap, tolerance=t) for t in (1e-2, 1e-4))
    assert float(coarse["force_max"]) == pytest.approx(float(fine["force_max"]), rel=0.01)
