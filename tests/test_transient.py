"""Cycles of a lever with inertia: what they come to, and how the mode behaves."""

import re
from dataclasses import replace

import numpy as np
import pytest

import softafm as sa

PS = sa.Contact(
    sa.Paraboloid(50e-9),
    sa.StandardLinearSolid(E0=4.25e9, E_inf=1.89e9, creep_time=1e-7, poisson=0.35),
    sa.LennardJones(2e-20, 0.15e-9),
)
LEVER, DRIVE, BASE = sa.Cantilever(28.1, 429.5, 278e3), sa.Drive(278e3, 15e-9), 8.491192e-9
QUICK = sa.Cantilever(28.1, 30, 278e3)


@pytest.fixture(scope="module")
def settled():
    return sa.tapping_transient(PS, LEVER, DRIVE, BASE, 700)


def test_a_lever_from_rest_settles_where_its_energy_balances(settled):
    """The state that tolerances of 1e-3 and 1e-4 give, too (``benchmarks/dynamics.py``)."""
    last = settled.isel(cycle=-1)
    assert float(last.amplitude[0]) / 15e-9 == pytest.approx(0.59964, abs=3e-5)
    assert float(last.phase[0]) == pytest.approx(49.782, abs=0.01)
    assert float(last.dissipation) == pytest.approx(4.548e-18, rel=1e-3)
    assert float(last.drive_work) == pytest.approx(float(last.damping + last.dissipation), rel=1e-4)
    taken = float(last.viscous_loss + last.jump_loss)
    assert float(last.dissipation) == pytest.approx(taken, rel=2e-3)
    # Equations (29) and (30) of Rajabifar et al. 2021; to the virial harmonics add k (1 − n²) a²/2.
    amplitude, phase = float(last.amplitude[0]), np.radians(float(last.phase[0]))
    force = 28.1 * 15e-9 / 429.5
    fed = np.pi * amplitude * force * np.sin(phase) - np.pi * 28.1 * amplitude**2 / 429.5
    assert float(last.dissipation) == pytest.approx(fed, rel=2e-3)
    higher, n = last.harmonic_amplitude.values[1:], last.harmonic.values[1:]
    virial = -0.5 * (amplitude * force * np.cos(phase) + 28.1 * ((n**2 - 1) @ higher**2))
    assert float(last.virial) == pytest.approx(virial, rel=5e-4)


def test_the_end_does_not_depend_on_the_start(settled):
    swinging = sa.tapping_transient(PS, LEVER, DRIVE, BASE, 700, "none", start="swinging")
    assert 13e-9 < float(swinging.amplitude[0, 0]) < 15e-9
    assert float(swinging.force_max[0]) > 20 * float(swinging.force_max[-1])
    for name in ("amplitude", "phase", "force_max"):
        end = float(swinging[name][-1].squeeze())
        assert end == pytest.approx(float(settled[name][-1].squeeze()), rel=1e-4)
    assert "time" not in swinging.dims


def test_the_taps_are_those_of_the_approach_curve(settled):
    """Whose base is the mean height of the tip, and whose tip moves as a sine."""
    amplitude = float(settled.amplitude[-1, 0])
    mean = BASE + float(settled.mean_deflection[-1])
    curve = sa.approach_curve(PS, LEVER, 15e-9, [amplitude / 15e-9]).sel(branch="repulsive")
    assert float(curve.mean_height[0]) == pytest.approx(mean, abs=20e-12)
    assert float(curve.phase[0]) == pytest.approx(float(settled.phase[-1, 0]), abs=0.3)
    assert float(curve.virial[0]) == pytest.approx(float(settled.virial[-1]), rel=5e-3)
    assert float(curve.dissipation[0]) == pytest.approx(float(settled.dissipation[-1]), rel=0.02)


def test_the_kept_path_gives_the_same_forces_to_a_tip_that_is_moved(settled):
    time, height = settled.time.values, settled.tip_height.values
    path = sa.Trajectory(time - time[0], height, smooth=True)
    moved = sa.force_distance(PS, path, tolerance=1e-3)
    assert float(moved.force_max) == pytest.approx(float(settled.force_max[-1]), rel=6e-3)
    assert float(moved.force_min) == pytest.approx(float(settled.force_min[-1]), rel=2e-3)


@pytest.mark.parametrize("by", ["tip", "base"])
@pytest.mark.parametrize("quality", [0.4, 3, 429.5])
def test_free_levers_have_the_amplitude_asked_for(by, quality):
    """Far from any force, at any detuning; what the drive feeds in is the lever's damping."""
    far = replace(PS, surface=sa.Repulsion(1e9, 0.05e-9))
    lever = sa.Cantilever(2.0, quality, 100e3, [sa.Eigenmode(80.0, 627e3, 2 * quality)])
    drive = sa.Drive(97e3, 5e-9, by)
    free = sa.tapping_transient(far, lever, drive, 1e-6, 40, start="swinging").isel(cycle=-1)
    assert float(free.harmonic_amplitude[0]) == pytest.approx(5e-9, rel=1e-6)
    assert float(free.drive_work) == pytest.approx(float(free.damping), rel=1e-4)
    ratio = 0.97
    lag = np.degrees(np.arctan2(ratio / quality, 1 - ratio**2))
    assert float(free.phase[0]) == pytest.approx(lag, abs=0.01)
    assert float(free.dissipation) == pytest.approx(0, abs=1e-3 * float(free.damping))


def test_two_drives_drive_two_modes():
    lever = sa.Cantilever(28.1, 60, 278e3, [sa.Eigenmode(1124, 1.743e6, 100)])
    both = [DRIVE, sa.Drive(1.743e6, 0.5e-9)]
    high = sa.tapping_transient(PS, lever, both, 60e-9, 30, start="swinging")
    assert high.sizes["eigenmode"] == 2
    assert high.amplitude[-1].values == pytest.approx([15e-9, 0.5e-9], rel=2e-2)
    assert high.phase[-1].values == pytest.approx([90, 90], abs=1)
    low = sa.tapping_transient(PS, lever, both, 9e-9, 200).isel(cycle=slice(-20, None))
    one = sa.tapping_transient(PS, lever, DRIVE, 9e-9, 200).isel(cycle=-1)
    assert 0.1e-9 < float(low.amplitude[:, 1].mean()) < 0.5e-9
    assert float(low.force_max.max()) > 1.2 * float(one.force_max)


def test_a_base_that_comes_down_and_goes_up():
    """A slow approach and retract: quasi-steady amplitudes, that of a base at rest at the turn."""
    lever, speed = sa.Cantilever(28.1, 100, 278e3), 9e-9 / (600 / 278e3)
    base = sa.Triangle(start=16e-9, turn=7e-9, speed=speed, dwell=300 / 278e3)
    run = sa.tapping_transient(PS, lever, DRIVE, base, keep="none", start="swinging")
    assert run.sizes["cycle"] == 1500
    assert float(run.base_height.min()) == pytest.approx(7e-9, abs=1e-15)
    rest = sa.tapping_transient(PS, lever, DRIVE, 7e-9, 400, "none").isel(cycle=-1)
    amplitude, turned = run.amplitude.values[:, 0], 890
    assert amplitude[turned] == pytest.approx(float(rest.amplitude[0]), rel=1e-4)
    assert float(run.phase[turned, 0]) == pytest.approx(float(rest.phase[0]), abs=0.02)
    assert amplitude[[0, -1]] == pytest.approx([15e-9, 15e-9], rel=0.01)
    # Attraction on the way down first: the lever lags by more than a quarter of a period.
    assert run.phase.values[50 : run.phase.values[:, 0].argmin(), 0].max() > 91


def test_an_interrupt_keeps_the_cycles_so_far():
    def stop(fraction, message):
        if fraction > 0.3:
            raise KeyboardInterrupt

    with pytest.warns(sa.AccuracyWarning, match=r"interrupted after \d+ of 100 cycles"):
        run = sa.tapping_transient(PS, QUICK, DRIVE, BASE, 100, progress=stop)
    whole = sa.tapping_transient(PS, QUICK, DRIVE, BASE, 100)
    done = run.sizes["cycle"]
    assert 30 <= done < 100
    assert np.array_equal(run.amplitude, whole.amplitude[:done])


def test_all_cycles_can_be_kept():
    run = sa.tapping_transient(PS, QUICK, DRIVE, BASE, 12, keep="all")
    assert float(run.time[-1]) == pytest.approx(12 / 278e3, rel=1e-12)
    assert (np.diff(run.time) > 0).all()
    assert np.diff(run.time).max() < 0.1 / 278e3
    inside = run.time.values > 11 / 278e3
    assert float(run.force[inside].max()) <= float(run.force_max[-1]) * (1 + 1e-12)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"cantilever": sa.Cantilever(28.1)}, "cantilever: needs quality_factor"),
        ({"drive": []}, r"drive = \[\]: must hold at least one softafm\.Drive"),
        ({"drive": 278e3}, r"drive = 278000\.0: must be a softafm\.Drive, or a list"),
        ({"drive": sa.Drive(1.7e6, 1e-9)}, "drive.frequency = 1.7e.06 Hz: must be at most twice"),
        ({"drive": sa.Drive(278e3, 1e-14)}, "free_amplitude = 1e-14 m: must be at least"),
        ({"base": 1e-10}, r"start height = 1e-10 m: must be above the equilibrium gap"),
        ({"base": "8 nm"}, "base = '8 nm': must be a number in m"),
        ({"base": sa.Triangle(2e-8, 1e-8, 1.0)}, "base: moves at up to 1 m/s; must be slower"),
        ({"base": sa.Sine(2e-8, 1e-9, 1e3, "steady")}, "base = .*: repeats itself; must be"),
        ({"cycles": 0}, "cycles = 0: must be a whole number from 1 to 1000000"),
        ({"keep": "some"}, "keep = 'some': must be 'last' or 'all' or 'none'"),
        ({"start": "up"}, "start = 'up': must be 'rest' or 'swinging'"),
        ({"solver": sa.solvers.Attard()}, "solver = 'attard': cannot carry a lever with inertia"),
    ],
)  # fmt: skip
def test_bad_input_is_refused_in_a_line(changed, said):
    given = {"cantilever": LEVER, "drive": DRIVE, "base": BASE} | changed
    with pytest.raises(ValueError, match=f"^{said}") as refused:
        sa.tapping_transient(PS, **given)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: sa.Eigenmode(0.0, 1e6, 100), "stiffness = 0 N/m: must be greater than 0"),
        (lambda: sa.Eigenmode(1.0, 1e6, -1), "quality_factor = -1: must be greater than 0"),
        (lambda: sa.Cantilever(1.0, 10, 2e5, sa.Eigenmode(1.0, 1e6, 10)),
         "higher_modes = .*: must be a list of softafm.Eigenmode"),
        (lambda: sa.Cantilever(1.0, 10, 2e5, [sa.Eigenmode(1.0, 1e5, 10)]),
         r"higher_modes\[0\]\.frequency = 100000 Hz: must be above .* 200000 Hz"),
        (lambda: sa.Cantilever(1.0, 10, 2e5, [1.0]), r"higher_modes\[0\] = 1\.0: must be"),
        (lambda: sa.Drive(-1.0, 1e-9), "frequency = -1 Hz: must be greater than 0"),
        (lambda: sa.Drive(1e5, 1e-9, "air"), "by = 'air': must be 'tip' or 'base'"),
    ],
)  # fmt: skip
def test_modes_and_drives_refuse_what_cannot_be(make, said):
    with pytest.raises(ValueError, match=said):
        make()


def test_a_file_is_the_function(tmp_path):
    document = sa.load_experiment(
        _write(tmp_path, "ps-transient"), ["motion.cycles=5", "cantilever.quality_factor=30"]
    )
    found = document.run()
    same = sa.tapping_transient(PS, QUICK, DRIVE, BASE, 5)
    assert np.array_equal(found.amplitude, same.amplitude)
    sa.save(found, tmp_path / "run.nc")
    again = sa.load(tmp_path / "run.nc")
    assert np.array_equal(again.force, found.force)
    figure = sa.plot(again)
    assert figure.axes[2].get_ylabel().startswith("Largest force")
    sa.export(again, tmp_path / "run.csv")
    rows = sa.regime(document).rows
    assert any(row.name == "memory of the lever" and "9.5" in row.words for row in rows)


def test_higher_modes_of_a_file(tmp_path):
    path = _write(tmp_path, "ps-transient")
    text = re.sub(r"^# (\[\[cant|stiff|freq|qual)", r"\1", path.read_text(), flags=re.M)
    path.write_text(text)
    lever = sa.load_experiment(path).cantilever
    assert lever.higher_modes == (sa.Eigenmode(1124.0, 1.743e6, 600),)
    path.write_text(text.replace('frequency = "1.743 MHz"', 'frequency = "1.743 m"'))
    with pytest.raises(ValueError, match=r"higher_modes\[0\].*frequency"):
        sa.load_experiment(path)


def _write(folder, name):
    from softafm.experiment.config import read_example

    path = folder / f"{name}.toml"
    path.write_text(read_example(name), encoding="utf-8")
    return path
