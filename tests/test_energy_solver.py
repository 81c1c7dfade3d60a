"""Properties of whole runs of the energy solver."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import softafm as sa

# As the paper's Fig. 3, under a tip of a tenth of the radius.
ATTARD = sa.Contact(
    sa.Paraboloid(1e-6),
    sa.StandardLinearSolid(5e9, 0.5e9, 1e-3, 0.0),
    sa.LennardJones(1e-19, 5e-10),
)
ATTARD_RAMP = sa.Triangle(10e-9, -5e-9, 5e-6)
LDPE = sa.Contact(
    sa.Paraboloid(10e-9),
    sa.StandardLinearSolid(2e9, 0.1e9, 1e-7, 0.49),
    sa.LennardJones(1e-19, 3e-10),
)
LDPE_TAP = {"amplitude": 40e-9, "mean_height": 38e-9, "frequency": 278e3}
DATA = Path(__file__).parent / "data" / "cases.json"
SCALARS = ("force_max", "force_min", "force_min_approach", "loop_energy", "viscous_loss")


def sticky(start=None):
    """The reference case of Tabor number 10; it ends attached unless the tip starts higher."""
    inputs = next(
        case["inputs"] for case in json.loads(DATA.read_text()) if case["name"] == "soft-tabor-10"
    )
    contact = sa.Contact(
        sa.Paraboloid(inputs["radius"]),
        sa.StandardLinearSolid(inputs["E0"], inputs["E_inf"], inputs["tau"], inputs["poisson"]),
        sa.LennardJones(inputs["hamaker"], inputs["z0"]),
    )
    return contact, sa.Triangle(start or inputs["start"], inputs["turn"], inputs["speed"])


def assert_same_numbers(one, other):
    for name in set(one.variables) & set(other.variables):
        assert np.array_equal(one[name].values, other[name].values), name


# Energy balance


@pytest.mark.parametrize(("contact", "motion"), [(ATTARD, ATTARD_RAMP), sticky(12e-9)])
def test_work_done_is_what_the_sample_dissipates(contact, motion):
    result = sa.force_distance(contact, motion, tolerance=3e-3)
    released = float(result["viscous_loss"]) + float(result["jump_energy"].sum())
    assert float(result["contact_radius"][-1]) == 0
    assert float(result["loop_energy"]) == pytest.approx(released, rel=0.01)


@pytest.mark.parametrize("tap", [LDPE_TAP, {**LDPE_TAP, "mean_height": 40.6e-9}])
def test_work_done_by_steady_taps_is_what_the_sample_dissipates(tap):
    result = sa.tapping_cycle(LDPE, **tap, cycles=3, tolerance=3e-3)
    last = result["jump_time"] >= 2 / tap["frequency"]
    released = float(result["viscous_loss"]) + float(result["jump_energy"][last].sum())
    assert float(result["dissipation"]) == pytest.approx(released, rel=0.01)


def test_all_cycles_are_reported_and_scalars_are_of_the_last():
    result = sa.tapping_cycle(LDPE, **LDPE_TAP, cycles=3)
    assert result["cycle_virial"].shape == result["cycle_dissipation"].shape == (3,)
    assert float(result["virial"]) == float(result["cycle_virial"][-1])
    assert float(result["dissipation"]) == float(result["cycle_dissipation"][-1])
    # The surface recovers within a period of 36 retardation times: all cycles are alike.
    for name in ("cycle_virial", "cycle_dissipation"):
        assert result[name].values == pytest.approx(np.full(3, result[name].values[0]), rel=2e-3)
    once = sa.tapping_cycle(LDPE, **LDPE_TAP)
    for name in ("virial", "dissipation", "force_max", "force_min", "contact_time", "indentation"):
        assert float(once[name]) == pytest.approx(float(result[name]), rel=1e-2)


def test_a_slow_surface_remembers_the_tap_before():
    slow = sa.Contact(LDPE.tip, sa.StandardLinearSolid(2e9, 0.1e9, 1e-5, 0.49), LDPE.surface)
    result = sa.tapping_cycle(slow, **LDPE_TAP, cycles=3)
    first, _, last = np.abs(result["cycle_virial"].values)
    assert abs(last - first) > 0.02 * first


# Convergence


def test_results_converge_as_the_tolerance_falls():
    tolerances = (1e-1, 1e-2, 1e-3, 1e-4)
    for run, names in (
        (lambda t: sa.force_distance(ATTARD, ATTARD_RAMP, tolerance=t), SCALARS),
        (
            lambda t: sa.tapping_cycle(LDPE, **LDPE_TAP, tolerance=t),
            ("virial", "dissipation", "force_max", "force_min", "viscous_loss"),
        ),
    ):
        best = run(1e-5)
        errors = []
        for tolerance in tolerances:
            result = run(tolerance)
            errors.append(max(abs(float(result[name]) / float(best[name]) - 1) for name in names))
            assert errors[-1] < tolerance
        assert errors[0] > errors[1] > errors[2] > errors[3]


# Equivalent samples and motions


def test_a_chain_of_one_runs_as_the_standard_linear_solid():
    sample = LDPE.sample
    chain = sa.GeneralizedKelvinVoigt(
        sample.E0, (1 / sample.E_inf - 1 / sample.E0,), (sample.creep_time,), sample.poisson
    )
    one = sa.tapping_cycle(LDPE, **LDPE_TAP)
    other = sa.tapping_cycle(sa.Contact(LDPE.tip, chain, LDPE.surface), **LDPE_TAP)
    assert_same_numbers(one, other)


def test_a_chain_of_two_equal_times_runs_as_one():
    sample = LDPE.sample
    half = (1 / sample.E_inf - 1 / sample.E0) / 2
    times = (sample.creep_time, sample.creep_time)
    chain = sa.GeneralizedKelvinVoigt(sample.E0, (half, half), times, sample.poisson)
    one = sa.tapping_cycle(LDPE, **LDPE_TAP, tolerance=1e-3)
    two = sa.tapping_cycle(sa.Contact(LDPE.tip, chain, LDPE.surface), **LDPE_TAP, tolerance=1e-3)
    for name in ("virial", "dissipation", "force_max", "force_min", "viscous_loss"):
        assert float(two[name]) == pytest.approx(float(one[name]), rel=2e-3)


def test_equal_moduli_run_as_elastic():
    def run(sample):
        contact = sa.Contact(LDPE.tip, sample, LDPE.surface)
        return sa.force_distance(contact, sa.Triangle(4e-9, -0.5e-9, 1e-3))

    elastic = run(sa.Elastic(1e9, 0.3))
    assert_same_numbers(run(sa.StandardLinearSolid(1e9, 1e9, 1e-6, 0.3)), elastic)
    assert np.all(elastic["viscous_power"] == 0)


def sampled(motion, count):
    time = np.unique(np.concatenate([np.linspace(*motion.breaks[[0, -1]], count), motion.breaks]))
    return sa.Trajectory(time, motion.height(time))


@pytest.mark.parametrize(
    ("contact", "motion", "count"),
    [(LDPE, sa.Sine(38e-9, 40e-9, 278e3), 1001), (ATTARD, ATTARD_RAMP, 201)],
)
def test_a_sampled_motion_runs_as_the_motion_itself(contact, motion, count):
    exact = sa.force_distance(contact, motion, tolerance=1e-2)
    found = sa.force_distance(contact, sampled(motion, count), tolerance=1e-2)
    largest = max(abs(float(exact[name])) for name in ("force_max", "force_min"))
    for name in ("force_max", "force_min", "force_min_approach"):
        assert float(found[name]) == pytest.approx(float(exact[name]), abs=0.01 * largest)
    for name in ("loop_energy", "viscous_loss"):
        assert float(found[name]) == pytest.approx(float(exact[name]), rel=0.01)


def test_the_origin_of_time_does_not_matter():
    motion = sampled(sa.Sine(5e-9, 6e-9, 278e3), 301)
    later = sa.Trajectory(motion.time + 3e-6, motion.heights)
    one, other = (sa.force_distance(LDPE, m) for m in (motion, later))
    for name in SCALARS:
        assert float(other[name]) == pytest.approx(float(one[name]), rel=1e-2)


def test_units_of_length_do_not_matter():
    # All lengths ten times larger at the same pressures: W grows with length, forces with its
    # square, energies with its cube.
    big = sa.Contact(
        sa.Paraboloid(10 * LDPE.tip.radius),
        LDPE.sample,
        sa.LennardJones(1e3 * LDPE.surface.hamaker, 10 * LDPE.surface.z0),
    )
    motion = sa.Triangle(4e-9, -1e-9, 5e-3)
    bigger = sa.Triangle(40e-9, -10e-9, 50e-3)
    one, other = sa.force_distance(LDPE, motion), sa.force_distance(big, bigger)
    for name, power in zip(SCALARS, (2, 2, 2, 3, 3), strict=True):
        assert float(other[name]) == pytest.approx(10**power * float(one[name]), rel=1e-5)


# Profiles


@pytest.fixture(scope="module")
def profiled():
    return sa.force_distance(ATTARD, ATTARD_RAMP, profiles=True)


def test_profiles_do_not_change_the_curves(profiled):
    plain = sa.force_distance(ATTARD, ATTARD_RAMP)
    assert_same_numbers(plain, profiled)
    assert set(profiled.variables) - set(plain.variables) == {"r", "deformation", "gap", "pressure"}


def test_gap_and_pressure_of_profiles(profiled):
    r = profiled["r"].values
    gap = profiled["tip_height"].values[:, None] + r**2 / 2e-6 - profiled["deformation"].values
    assert profiled["gap"].values == pytest.approx(gap, rel=1e-12)
    assert profiled["gap"].values.min() > 0.5 * ATTARD.surface.z0
    pressure = ATTARD.surface.pressure(gap)
    assert profiled["pressure"].values == pytest.approx(pressure, rel=1e-12)
    assert profiled["deformation"].values[:, 0] == pytest.approx(
        profiled["axis_deformation"].values, abs=1e-13
    )


def test_profiles_carry_the_force(profiled):
    r, gap = profiled["r"].values, profiled["gap"].values
    density = profiled["pressure"].values * r
    near = 2 * np.pi * np.sum((density[:, 1:] + density[:, :-1]) / 2 * np.diff(r), axis=1)
    end = gap[:, -1]
    law = ATTARD.surface
    tail = law.hamaker * ATTARD.tip.radius / 6 * (law.z0**6 / (4 * end**8) - 1 / end**2)
    force = profiled["force"].values
    assert near + tail == pytest.approx(force, abs=0.02 * np.abs(force).max())


def test_contact_radius_is_where_tension_is_largest(profiled):
    r, radius = profiled["r"].values, profiled["contact_radius"].values
    steepest = r[profiled["pressure"].values.argmin(axis=1)]
    touching = radius > 5 * r[1]
    assert touching.any()
    assert steepest[touching] == pytest.approx(radius[touching], abs=1.5 * r[1])


# Repeating, reporting, giving up


@pytest.mark.filterwarnings("ignore:.*still in contact at the end:softafm.AccuracyWarning")
def test_runs_repeat_bit_by_bit():
    for run in (
        lambda: sa.force_distance(*sticky()),
        lambda: sa.tapping_cycle(LDPE, **LDPE_TAP, profiles=True),
    ):
        assert_same_numbers(run(), run())


def test_runs_do_not_depend_on_what_ran_before():
    one = sa.tapping_cycle(LDPE, **LDPE_TAP)
    sa.force_distance(ATTARD, ATTARD_RAMP, tolerance=1e-3)
    assert_same_numbers(sa.tapping_cycle(LDPE, **LDPE_TAP), one)


@pytest.mark.filterwarnings("ignore:.*still in contact at the end:softafm.AccuracyWarning")
def test_progress_rises_to_one():
    heard = []
    sa.force_distance(*sticky(), progress=lambda *report: heard.append(report))
    fractions = [fraction for fraction, _ in heard]
    assert len(fractions) > 3
    assert all(isinstance(message, str) for _, message in heard)
    assert fractions[-1] == 1
    assert fractions == sorted(fractions)
    assert 0 <= fractions[0] < 1


def test_what_progress_raises_ends_the_run():
    class Stop(Exception):
        pass

    def stop(fraction, message):
        raise Stop

    with pytest.raises(Stop):
        sa.force_distance(*sticky(), progress=stop)


def test_a_run_given_up_keeps_what_it_found():
    whole = sa.force_distance(ATTARD, ATTARD_RAMP)
    with pytest.raises(sa.DivergedError, match="most_steps = 50") as caught:
        sa.force_distance(ATTARD, ATTARD_RAMP, solver=sa.solvers.Energy(most_steps=50))
    history = caught.value.history
    n = history.time.size
    assert 10 < n <= 51
    assert len(str(caught.value).splitlines()) == 1
    for name in ("time", "tip_height", "force", "contact_radius", "axis_deformation"):
        assert np.array_equal(getattr(history, name), whole[name].values[:n])


@pytest.mark.parametrize("option", ["finest_spacing", "most_steps"])
@pytest.mark.parametrize("value", [0, -1, np.nan, np.inf, None, "many"])
def test_bad_options_are_refused(option, value):
    with pytest.raises(ValueError, match=f"^{option}") as caught:
        sa.solvers.Energy(**{option: value})
    assert len(str(caught.value).splitlines()) == 1


def test_a_mesh_too_coarse_for_the_cohesive_zone_warns():
    contact, motion = sticky()
    with pytest.warns(sa.AccuracyWarning) as caught:
        result = sa.force_distance(contact, motion, solver=sa.solvers.Energy(finest_spacing=0.1))
    text, *audited = (str(warning.message) for warning in caught)
    assert result.attrs["warnings"].splitlines() == [text, *audited]
    assert all(each.startswith("audit: ") for each in audited)
    assert len(text.splitlines()) == 1
    assert {warning.filename for warning in caught} == {__file__}
    # Numbers and a remedy that works.
    assert "finest_spacing" in text
    assert len(re.findall(r"\d(?:\.\d+)?e-\d+ m", text)) >= 3
    tabor = float(re.search(r"regularise=([\d.e-]+)$", text)[1])
    remedy = contact.regularised(tabor).surface
    assert remedy.work_of_adhesion == pytest.approx(contact.surface.work_of_adhesion, rel=1e-3)
    assert remedy.z0 > contact.surface.z0
    with pytest.warns(sa.AccuracyWarning, match="still in contact"):
        fine = sa.force_distance(contact, motion)
    assert fine.attrs["warnings"].startswith("audit: the tip is still in contact")


# Anything at all

contacts = st.builds(
    lambda radius, E0, ratio, creep_time, poisson, tabor, z0: sa.Contact(
        sa.Paraboloid(radius),
        sa.StandardLinearSolid(E0, E0 * ratio, creep_time, poisson),
        sa.LennardJones.from_work_of_adhesion(
            np.sqrt(tabor**3 * z0**3 / radius) * E0 * ratio / (1 - poisson**2), z0
        ),
    ),
    radius=st.floats(-8.5, -6).map(lambda x: 10**x),
    E0=st.floats(8, 10.5).map(lambda x: 10**x),
    ratio=st.floats(-1.5, 0).map(lambda x: 10**x),
    creep_time=st.floats(-7, -3).map(lambda x: 10**x),
    poisson=st.floats(0, 0.5),
    tabor=st.floats(-1.3, 0.7).map(lambda x: 10**x),
    z0=st.floats(0.15e-9, 1e-9),
)


@pytest.mark.filterwarnings("ignore:.*still in contact at the end:softafm.AccuracyWarning")
@pytest.mark.filterwarnings("ignore::softafm.errors.DoubtfulValueWarning")
@given(contacts, st.floats(3, 12), st.floats(-3, 1), st.floats(-2, 2).map(lambda x: 10**x))
@settings(max_examples=15, deadline=None)
def test_any_contact_obeys_the_laws(contact, start, turn, rate):
    assume(turn < start)
    law = contact.surface
    depth = (start - turn) * law.z0
    motion = sa.Triangle(start * law.z0, turn * law.z0, rate * depth / contact.sample.creep_time)
    result = sa.force_distance(contact, motion, profiles=True)
    force = result["force"].values
    scale = np.abs(force).max()

    # Bounds of the force: the largest tension on the area within its reach, and repulsion as if
    # the surface were rigid.
    gap = result["gap"].values
    reach = np.abs(result["deformation"].values).max() + 10 * law.z0 + max(0, -turn) * law.z0
    area = 2 * np.pi * contact.tip.radius * reach
    tension = -law.pressure(law.gap_of_largest_tension)
    assert force.min() >= -1.01 * tension * area
    assert np.all(gap > 0)

    # The second law: power and jump energy are positive, and work in a closed loop is not gained.
    assert np.all(result["viscous_power"].values >= 0)
    assert np.all(result["jump_energy"].values >= -1e-3 * scale * law.z0)
    relaxed = np.abs(result["deformation"].values[-1]).max() < 1e-2 * law.z0
    if float(result["contact_radius"][-1]) == 0 and relaxed:
        assert float(result["loop_energy"]) >= -0.01 * scale * law.z0

    # Order of the observables.
    assert float(result["force_max"]) >= force.max() - 1e-12 * scale
    assert float(result["force_min"]) <= float(result["force_min_approach"]) + 1e-12 * scale
    assert np.all(np.diff(result["time"].values) > 0)
    assert result["time"].values[-1] == motion.breaks[-1]
    assert result["tip_height"].values == pytest.approx(
        motion.height(result["time"].values), abs=1e-9 * law.z0
    )


def test_identical_runs_give_identical_datasets():
    # Save for the moment of creation and the time it took.
    runs = [sa.force_distance(LDPE, sa.Triangle(4e-9, 0.0, 1e-2)) for _ in range(2)]
    for run in runs:
        del run.attrs["created"], run.attrs["solver_wall_time"]
    xr.testing.assert_identical(*runs)
