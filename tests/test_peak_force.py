"""Peak force tapping: forces held, ringing, and where the energy goes."""

import numpy as np
import pytest

import softafm as sa
from softafm.experiment.config import read_example

PS = sa.Contact(
    sa.Paraboloid(50e-9),
    sa.StandardLinearSolid(E0=4.25e9, E_inf=1.89e9, creep_time=1e-7, poisson=0.35),
    sa.LennardJones(2e-20, 0.15e-9),
)
LEVER = sa.Cantilever(4.0, 100, 150e3)


@pytest.fixture(scope="module")
def held():
    return sa.peak_force_tapping(PS, LEVER, 100e-9, 2e3, peak_force=20e-9)


def test_a_feedback_holds_the_peak_force(held):
    assert float(held.force_max[-1]) == pytest.approx(20e-9, rel=2e-3)
    assert float(held.force_max[1]) == pytest.approx(float(held.force_max[2]), rel=1e-3)
    base = float(held.mean_height) + 100e-9 * np.cos(2 * np.pi * 2e3 * held.time)
    assert np.abs(held.base_height - base).max() < 1e-15


def test_work_of_the_base_goes_into_contact_and_lever(held):
    last = held.isel(cycle=-1)
    assert float(last.drive_work) == pytest.approx(float(last.damping + last.dissipation), rel=1e-3)
    taken = float(last.viscous_loss + last.jump_loss)
    assert float(last.dissipation) == pytest.approx(taken, rel=0.02)
    assert float(last.damping) > float(last.dissipation)


def test_the_lever_rings_at_its_resonance_and_fades_as_its_quality_says(held):
    """After pull-off of the last period: zeros of the deflection, and how it falls off."""
    time, deflection = held.time.values, held.deflection.values
    third = time > 2 / 2e3
    torn = time[third][held.force.values[third].argmin()]
    free = time > torn + 5 / 150e3
    t, q = time[free], deflection[free]
    crossings = t[1:][np.diff(np.sign(q)) != 0]
    assert 0.5 / np.diff(crossings).mean() == pytest.approx(150e3, rel=5e-3)
    swings = [np.abs(q[(t >= a) & (t < a + 2 / 150e3)]).max() for a in (t[0], t[0] + 20 / 150e3)]
    assert swings[0] > 0.3e-9
    assert swings[1] / swings[0] == pytest.approx(np.exp(-np.pi * 20 / 100), rel=0.03)


def test_slow_and_damped_it_is_force_spectroscopy():
    """With a lever that does not ring, the loop is that of one in balance."""
    lever = sa.Cantilever(4.0, 0.5, 1e6)
    swung = sa.peak_force_tapping(PS, lever, 20e-9, 1e3, mean_height=16e-9, periods=1)
    time = np.linspace(0, 1e-3, 20001)
    path = sa.Trajectory(time, 16e-9 + 20e-9 * np.cos(2 * np.pi * 1e3 * time), smooth=True)
    still = sa.force_spectroscopy(PS, lever, path)
    assert float(swung.force_max[0]) == pytest.approx(float(still.force_max), rel=3e-3)
    assert float(swung.force_min[0]) == pytest.approx(float(still.force_min), rel=0.01)


def test_soft_rubber_loses_energy_in_jumps_only(tmp_path):
    path = tmp_path / "rubber.toml"
    text = (
        read_example("pdms-peak-force").replace("peak_force = ", "# ").replace("# mean_h", "mean_h")
    )
    path.write_text(text, encoding="utf-8")
    run = sa.run(path)
    last = run.isel(cycle=-1)
    assert run.jump_time.size == 4
    assert float(last.viscous_loss) == 0
    assert float(last.jump_loss) == pytest.approx(float(last.dissipation), rel=5e-3)
    sa.save(run, tmp_path / "rubber.nc")
    sa.plot(sa.load(tmp_path / "rubber.nc"))


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"peak_force": None}, "mean_height, peak_force: give one of them"),
        ({"mean_height": 1e-8}, "mean_height, peak_force: give one of them"),
        ({"frequency": 1e5}, r"frequency = 100000 Hz: must be at most 30000 Hz, a fifth"),
        ({"periods": 0}, "periods = 0: must be a whole number from 1"),
        ({"amplitude": 5e-9, "peak_force": 1e-6}, r"peak_force = 1e-06 N: is not reached"),
        ({"peak_force": None, "mean_height": -2e-7}, "start height = -1e-07 m: must be above"),
        ({"peak_force": -1e-9}, "peak_force = -1e-09 N: must be greater than 0"),
    ],
)  # fmt: skip
def test_bad_input_is_refused_in_a_line(changed, said):
    given = {"amplitude": 100e-9, "frequency": 2e3, "peak_force": 2e-8} | changed
    with pytest.raises(ValueError, match=f"^{said}"):
        sa.peak_force_tapping(PS, LEVER, **given)


def test_a_peak_that_is_not_held_is_told():
    from softafm.modes.peak_force import _doubt_peak

    assert _doubt_peak(np.array([2e-9, 1.005e-9]), 1e-9, 1e-2) == ()
    with pytest.warns(sa.AccuracyWarning, match=r"1\.05 nN where 1 nN"):
        _doubt_peak(np.array([1e-9, 1.05e-9]), 1e-9, 1e-2)
