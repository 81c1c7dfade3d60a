"""The check of a run: what a finer run makes of it."""

import json
import warnings
from dataclasses import replace

import numpy as np
import pytest

import softafm as sa
from softafm.solvers import Attard, EnhancedAttard

CONTACT = sa.Contact(
    sa.Paraboloid(10e-9),
    sa.StandardLinearSolid(2e9, 0.5e9, 1e-7, 0.49),
    sa.LennardJones(1e-19, 0.3e-9),
)
LEVER = sa.Cantilever(28.1, quality_factor=430, frequency=278e3)
RAMP = sa.Triangle(4e-9, -0.5e-9, 1e-3)
RATIOS = [0.9, 0.6]


def ramp(**options):
    return sa.force_distance(CONTACT, RAMP, **options)


def spectroscopy(**options):
    return sa.force_spectroscopy(CONTACT, LEVER, RAMP, **options)


def tap(**options):
    return sa.tapping_cycle(CONTACT, 10e-9, 10.2e-9, 278e3, **options)


def approach(**options):
    return sa.approach_curve(CONTACT, LEVER, 15e-9, RATIOS, **options)


MODES = {"ramp": ramp, "spectroscopy": spectroscopy, "tap": tap, "approach": approach}


def assert_same(result, other):
    for name, variable in other.data_vars.items():
        np.testing.assert_array_equal(result[name].values, variable.values)


@pytest.mark.parametrize("name", ["ramp", "spectroscopy", "tap"])
def test_the_differences_are_those_of_a_run_at_a_tenth_of_the_tolerance(name):
    run = MODES[name]
    result, same, finer = run(check=True, tolerance=2e-2), run(tolerance=2e-2), run(tolerance=2e-3)
    assert_same(result, same)  # what was asked for, not the finer one
    found = json.loads(result.attrs["check_differences"])
    assert result.attrs["check_tolerance"] == pytest.approx(2e-3)
    assert result.attrs["check_largest"] == max(map(abs, found.values())) <= 2e-2
    force = max(abs(float(finer["force_max"])), abs(float(finer["force_min"])))
    length = 0.02 * 10e-9 if name == "tap" else 0.3e-9
    least = {"N": 0.01 * force, "J": 0.02 * force * length}
    for observable, relative in found.items():
        value, other = float(result[observable]), float(finer[observable])
        units = finer[observable].attrs["units"]
        if units in least:
            scale = max(abs(other), least[units])
            assert relative == pytest.approx((value - other) / scale, abs=1e-15)
        elif observable == "indentation":
            assert relative == pytest.approx((value - other) / max(other, 0.3e-9))
        else:
            assert observable == "contact_time"
            graze = np.sqrt(2 * 0.3e-9 / 10e-9) / (np.pi * 278e3)
            assert relative == pytest.approx((value - other) / max(other, graze))
    scalars = {str(n) for n, v in finer.data_vars.items() if v.ndim == 0} - {"cycles_run"}
    assert set(found) == scalars


def test_an_approach_curve_tells_the_difference_of_its_heights():
    result, same, finer = approach(check=True), approach(), approach(tolerance=1e-3)
    assert_same(result, same)
    found = json.loads(result.attrs["check_differences"])
    heights = np.abs(result["mean_height"].values - finer["mean_height"].values)
    assert result.attrs["check_mean_height"] == pytest.approx(np.nanmax(heights), rel=1e-6)
    assert abs(found["mean_height"]) == pytest.approx(np.nanmax(heights) / 0.3e-9, rel=1e-6)
    phases = np.abs(result["phase"].values - finer["phase"].values)
    assert abs(found["phase"]) == pytest.approx(np.radians(np.nanmax(phases)), rel=1e-6)
    amplitude = 15e-9 * np.array(RATIOS)
    force = np.fmax(np.abs(finer["force_max"].values), np.abs(finer["force_min"].values))
    scale = np.fmax(np.abs(finer["virial"].values), 0.02 * force * 0.02 * amplitude)
    virial = (result["virial"].values - finer["virial"].values) / scale
    assert abs(found["virial"]) == pytest.approx(np.nanmax(np.abs(virial)), rel=1e-6)
    assert found["solutions"] == 0
    assert result.attrs["check_largest"] < 1e-2


def loose(**options):
    """Eight cosines cannot hold the edge of this contact."""
    solver = EnhancedAttard(functions=8, nodes=30, steps=2000)
    return sa.force_distance(CONTACT, RAMP, solver=solver, **options)


def test_a_loose_solver_is_warned_of_with_both_values_and_the_remedy():
    with pytest.warns(sa.AccuracyWarning) as warned:
        result = loose(check=True)
    (warning,) = warned
    text = str(warning.message)
    assert warning.filename == __file__
    assert len(text.splitlines()) == 1
    assert result.attrs["warnings"] == text
    finer = sa.force_distance(CONTACT, RAMP, solver=EnhancedAttard(16, 60, steps=4000))
    found = json.loads(result.attrs["check_differences"])
    name = max(found, key=lambda name: abs(found[name]))
    unit = finer[name].attrs["units"]
    value, other = float(result[name]), float(finer[name])
    assert text.startswith(f"{name} = {value:.4g} {unit}, but {other:.4g} {unit} with steps = 4000")
    assert text.endswith("run with steps = 4000, nodes = 60, functions = 16, or finer")
    assert "more than the tolerance of 1 %" in text
    used = json.loads(result.attrs["check_solver"])
    assert (used["steps"], used["nodes"], used["functions"]) == (4000, 60, 16)
    assert "check_tolerance" not in result.attrs


class OffWhenPulled:
    """The default solver, but what pulls is 5 % too strong at tolerances above 5e-3."""

    kind, adaptive = "off-when-pulled", True

    def solve(self, contact, motion, *, tolerance=1e-2, **options):
        history = sa.solvers.Energy().solve(contact, motion, tolerance=tolerance, **options)
        force = history.force
        wrong = force * np.where(force < 0, 1.05 if tolerance > 5e-3 else 1.0, 1.0)
        return replace(history, force=wrong)


def test_a_pull_off_is_checked_against_itself_however_hard_the_tip_is_pressed():
    motion = sa.Triangle(4e-9, -8e-9, 1e-3)
    with pytest.warns(sa.AccuracyWarning, match=r"force_min = .* differ by 5[.\d]* % of"):
        result = sa.force_distance(CONTACT, motion, solver=OffWhenPulled(), check=True)
    assert float(result.force_max) > 10 * abs(float(result.force_min))
    found = json.loads(result.attrs["check_differences"])
    assert found["force_min"] == pytest.approx(-0.05, rel=0.1)


def test_every_mode_warns_its_caller():
    """At a tolerance of 10 % with a mesh so coarse that the finer run has to warn."""
    solver = sa.solvers.Energy(finest_spacing=0.3)
    soft = sa.Contact(
        sa.Paraboloid(1e-7), sa.Elastic(1e7, 0.5), sa.LennardJones.from_work_of_adhesion(0.05, 1e-9)
    )
    options = {"solver": solver, "tolerance": 0.1, "check": True}
    motion = sa.Triangle(20e-9, -10e-9, 1e-6)
    for run in (
        lambda: sa.force_distance(soft, motion, **options),
        lambda: sa.force_spectroscopy(soft, sa.Cantilever(10.0), motion, **options),
        lambda: sa.tapping_cycle(soft, 20e-9, 10e-9, 1e4, 1, **options),
    ):
        with pytest.warns(sa.AccuracyWarning) as warned:
            result = run()
        assert [warning.filename for warning in warned] == [__file__] * len(warned)
        assert result.attrs["warnings"].splitlines() == [str(w.message) for w in warned]


def test_a_finer_run_that_gives_up_leaves_the_result_and_says_so():
    solver = sa.solvers.Energy(most_steps=ramp().attrs["solver_attempted_steps"] + 1)
    with pytest.warns(sa.AccuracyWarning, match=r"^the check, with .* could not be finished"):
        result = ramp(solver=solver, check=True)
    assert np.isnan(result.attrs["check_largest"])
    assert json.loads(result.attrs["check_differences"]) == {}
    assert_same(result, ramp())


def test_no_check_no_attributes():
    assert not [name for name in ramp().attrs if name.startswith("check")]


def test_results_with_a_check_are_saved_and_loaded(tmp_path):
    result = ramp(check=True)
    sa.save(result, tmp_path / "ramp.nc")
    assert sa.load(tmp_path / "ramp.nc").attrs == result.attrs


def test_progress_tells_of_both_runs():
    told = []
    ramp(check=True, progress=lambda fraction, message: told.append((fraction, message)))
    first = [fraction for fraction, message in told if not message.startswith("check: ")]
    second = [fraction for fraction, message in told if message.startswith("check: ")]
    assert first == sorted(first)
    assert second == sorted(second)
    assert (first[-1], second[-1]) == (1, 1)


class Plain:
    """A solver of fixed steps of the user's own that cannot be refined."""

    kind, adaptive = "plain", False

    def solve(self, contact, motion, **options):
        raise AssertionError("it was to be refused before any run")


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"tolerance": 1e-5}, "check = True: a run of tolerance 1e-05 cannot be repeated"),
        ({"solver": Plain()}, "check = True: the solver 'plain' cannot be run twice as fine"),
        ({"solver": Attard(nodes=1500)}, "check = True: the solver 'attard' cannot be run twice"),
        ({"check": "yes"}, "check = 'yes': must be True or False"),
        ({"tolerance": 1.0}, "tolerance = 1: must be between"),
    ],
)
@pytest.mark.parametrize("run", MODES.values(), ids=MODES)
def test_what_cannot_be_checked_is_refused_before_any_run(run, options, text):
    with pytest.raises(ValueError, match="^" + text) as refused:
        run(**{"check": True, **options})
    assert len(str(refused.value).splitlines()) == 1


def test_no_warning_where_the_tolerance_is_kept():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert ramp(check=True).attrs["check_largest"] < 1e-2
