"""Closed forms and published values that any correct solver must meet."""

import numpy as np
import pytest

import softafm as sa

R, W, Z0 = 100e-9, 0.05, 0.3e-9

# F_min/(πRW), then tip height/z0 at jump-in and jump-out of an elastic Lennard-Jones paraboloid
# under displacement control; two independent programs, mesh-converged to 1e-4.
ELASTIC = {
    0.05: (-1.98865, None, None),
    0.1: (-1.96895, None, None),
    0.2: (-1.92014, None, None),
    0.3: (-1.87018, None, None),
    0.5: (-1.78748, None, None),
    0.7: (-1.72892, 2.2355, 2.2357),
    1.0: (-1.67067, 2.6292, 2.7434),
    1.5: (-1.61488, 3.1375, 3.5707),
    2.0: (-1.58361, 3.5520, 4.3818),
    3.0: (-1.55107, 4.2279, 5.9885),
}


def elastic_contact(tabor):
    modulus = np.sqrt(R * W**2 / (tabor**3 * Z0**3))
    return sa.Contact(
        sa.Paraboloid(R), sa.Elastic(modulus, 0.0), sa.LennardJones.from_work_of_adhesion(W, Z0)
    )


@pytest.mark.parametrize("tabor", ELASTIC)
def test_elastic_pull_off_and_jumps(tabor):
    pull_off, jump_in, jump_out = ELASTIC[tabor]
    contact = elastic_contact(tabor)
    assert contact.tabor_relaxed == pytest.approx(tabor)
    motion = sa.Triangle(start=8 * Z0, turn=-2 * Z0, speed=1e-6)
    result = sa.force_distance(contact, motion, tolerance=1e-3)
    assert float(result["force_min"]) / (np.pi * R * W) == pytest.approx(pull_off, rel=1e-3)
    heights = motion.height(result["jump_time"].values) / Z0
    # At 0.7 the two jumps are 0.0002 z0 apart and release next to nothing.
    if tabor != 0.7:
        wanted = [] if jump_in is None else [jump_in, jump_out]
        assert heights == pytest.approx(wanted, rel=1e-3)
    if jump_in is None:
        assert float(result["loop_energy"]) == pytest.approx(0, abs=1e-3 * 2 * np.pi * R * W * Z0)


def test_large_tabor_numbers_tend_to_jkr():
    # JKR: smallest force -1.5 πRW; under displacement control the contact breaks at -(5/6) πRW.
    # Jump-in at h0 = 2.641 μ^(3/7) z0 (Wu 2010).
    pull_off = []
    for tabor in (3.0, 5.0, 10.0):
        motion = sa.Triangle(start=(2 * tabor + 3) * Z0, turn=-0.5 * tabor * Z0, speed=1e-6)
        result = sa.force_distance(elastic_contact(tabor), motion, tolerance=1e-3)
        pull_off.append(-float(result["force_min"]) / (np.pi * R * W))
        jump_in = float(motion.height(result["jump_time"].values[0])) / Z0
        assert jump_in == pytest.approx(2.641 * tabor ** (3 / 7), rel=4e-3)
        assert float(result["loop_energy"]) == pytest.approx(
            float(result["jump_energy"].sum()), rel=2e-3
        )
    assert pull_off[0] > pull_off[1] > pull_off[2] > 1.5
    assert pull_off[2] == pytest.approx(1.5, rel=0.01)
    before_last_jump = np.searchsorted(result["time"], result["jump_time"].values[-1]) - 1
    broke_at = float(result["force"][before_last_jump]) / (np.pi * R * W)
    assert broke_at == pytest.approx(-5 / 6, rel=0.03)


def test_rigid_sample_is_derjaguin():
    law = sa.LennardJones(1e-19, Z0)
    contact = sa.Contact(sa.Paraboloid(R), sa.Elastic(1e20, 0.3), law)
    result = sa.force_distance(contact, sa.Triangle(3e-9, 0.27e-9, 1e-6), tolerance=1e-5)
    h0 = result["tip_height"].values
    exact = law.hamaker * R / 6 * (law.z0**6 / (4 * h0**8) - 1 / h0**2)
    assert result["force"].values == pytest.approx(exact, abs=1e-6 * np.abs(exact).max())
    smallest = -2 * np.pi * R * law.work_of_adhesion
    assert float(result["force_min"]) == pytest.approx(smallest, rel=1e-6)


@pytest.mark.parametrize(
    ("mean_height", "amplitude", "virial"),
    [
        (50.5e-9, 50e-9, 1.16397182626e-18),
        (50.3e-9, 50e-9, 2.25889088641e-18),
        (11e-9, 10e-9, 1.73174656831e-19),
    ],
)
def test_virial_of_a_rigid_sample(mean_height, amplitude, virial):
    contact = sa.Contact(sa.Paraboloid(10e-9), sa.Elastic(1e20, 0.3), sa.LennardJones(1e-19, Z0))
    result = sa.tapping_cycle(contact, amplitude, mean_height, 278e3, tolerance=1e-4)
    assert float(result["virial"]) == pytest.approx(virial, rel=2e-6)
    assert float(result["dissipation"]) == pytest.approx(0, abs=1e-5 * virial)


@pytest.mark.parametrize("h0", [3e-9, 5e-9])
def test_bulge_far_from_the_tip(h0):
    # Weak coupling: u(0) = H√R/(8√2 E* h0^(5/2)).
    sample = sa.Elastic(2e9, 0.49)
    contact = sa.Contact(sa.Paraboloid(10e-9), sample, sa.LennardJones(1e-19, 0.25e-9))
    result = sa.force_distance(contact, sa.Triangle(1.01 * h0, h0, 1e-6))
    lowest = np.argmin(result["tip_height"].values)
    modulus = sample.reduced_modulus_relaxed
    exact = 1e-19 * np.sqrt(10e-9) / (8 * np.sqrt(2) * modulus * h0**2.5)
    assert float(result["axis_deformation"][lowest]) == pytest.approx(exact, rel=0.02)


def test_dissipation_out_of_contact():
    # Small oscillation about a gap D: E = 0.153744 A² J'' H² R^(3/2) D^(-13/2).
    sample = sa.StandardLinearSolid(2e9, 0.1e9, 1e-7, 0.49)
    contact = sa.Contact(sa.Paraboloid(10e-9), sample, sa.LennardJones(1e-19, 0.25e-9))
    amplitude, gap, frequency = 0.1e-9, 5e-9, 278e3
    result = sa.tapping_cycle(contact, amplitude, gap, frequency, cycles=3, tolerance=1e-3)
    rate = 2 * np.pi * frequency * sample.creep_time
    compliance = 1 / sample.reduced_modulus_relaxed - 1 / sample.reduced_modulus_instantaneous
    loss = compliance * rate / (1 + rate**2)
    exact = 0.153744 * amplitude**2 * loss * 1e-38 * (10e-9) ** 1.5 * gap**-6.5
    assert float(result["dissipation"]) == pytest.approx(exact, rel=0.02)
    assert float(result["viscous_loss"]) == pytest.approx(exact, rel=0.02)


def test_fast_and_slow_limits_are_elastic():
    tip, law = sa.Paraboloid(10e-9), sa.LennardJones(1e-19, 0.25e-9)
    sample = sa.StandardLinearSolid(4e9, 2e9, 1e-6, 0.3)
    for speed, modulus in ((10.0, sample.E0), (1e-9, sample.E_inf)):
        motion = sa.Triangle(5e-9, -0.5e-9, speed)
        visco = sa.force_distance(sa.Contact(tip, sample, law), motion)
        elastic = sa.force_distance(sa.Contact(tip, sa.Elastic(modulus, 0.3), law), motion)
        largest = float(elastic["force_max"])
        for name in ("force_max", "force_min"):
            assert float(visco[name]) == pytest.approx(float(elastic[name]), abs=0.01 * largest)
