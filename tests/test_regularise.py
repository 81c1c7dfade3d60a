"""Soft contacts whose law is given a longer range at the same work of adhesion."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import softafm as sa
from softafm.app.python_lines import write_python
from softafm.experiment.config import load_experiment, read_example
from softafm.experiment.regime import regime

W, Z0 = 0.05, 0.3e-9
LAWS = [
    sa.LennardJones.from_work_of_adhesion(W, Z0),
    sa.VanDerWaals.from_work_of_adhesion(W, Z0, 12),
    sa.DMT.from_work_of_adhesion(W, Z0, 0.15),
    sa.Exponential(W, Z0, 0.2e-9, 0.05e-9),
    sa.Morse(W, Z0, 0.15e-9),
    sa.Dugdale(W, Z0, 100e6, 0.2),
]
TIPS = [
    sa.Paraboloid(1e-6),
    sa.Sphere(5e-6),
    sa.Cone(np.radians(20), 8e-9),
    sa.FlatPunch(1e-6, 1e-7),
    sa.Hyperboloid(20e-9, np.radians(30)),
]
RUBBER = sa.Elastic(2e6, 0.5)
SOFT = sa.Contact(sa.Paraboloid(1e-6), RUBBER, LAWS[0])
OTHERS = [
    LAWS[0] + sa.Repulsion(1e6, 0.5e-9),
    sa.DLVO(1e-20, Z0, 0.0, 1e-9),
]


def kind(thing):
    return thing.kind


@pytest.mark.parametrize("law", LAWS, ids=kind)
@pytest.mark.parametrize("factor", [0.7, 1.0, 20.0])
def test_a_stretched_law_has_its_pressure_at_stretched_gaps(law, factor):
    longer, gap = law.stretched(factor), np.geomspace(0.2e-9, 5e-9, 40)
    for name in ("pressure", "potential", "slope"):
        power = {"pressure": 1, "potential": 0, "slope": 2}[name]
        found, given = getattr(longer, name)(factor * gap), getattr(law, name)(gap)
        np.testing.assert_allclose(found * factor**power, given, rtol=1e-9)
    assert longer.work_of_adhesion == pytest.approx(law.work_of_adhesion, rel=1e-9)
    assert longer.range == pytest.approx(factor * law.range, rel=1e-9)
    assert type(longer) is type(law)


@pytest.mark.parametrize("law", LAWS, ids=kind)
@pytest.mark.parametrize("factor", [0, -1.0, np.nan, "two", True])
def test_a_factor_that_is_none_is_refused(law, factor):
    with pytest.raises(ValueError, match=r"^factor = "):
        law.stretched(factor)


@pytest.mark.parametrize("law", LAWS, ids=kind)
@pytest.mark.parametrize("tip", TIPS, ids=kind)
def test_a_regularised_contact_has_the_number(tip, law):
    contact = sa.Contact(tip, RUBBER, law)
    regularised = contact.regularised(tabor=8)
    assert regularised.tabor_relaxed == pytest.approx(8, rel=1e-6)
    assert regularised.surface.work_of_adhesion == pytest.approx(W, rel=1e-9)
    assert (regularised.tip, regularised.sample) == (contact.tip, contact.sample)
    assert regularised.regularised(8.01) == regularised


@given(tabor=st.floats(0.1, 200))
@settings(max_examples=50, deadline=None)
def test_the_number_falls_with_the_range(tabor):
    regularised = SOFT.regularised(tabor)
    assert regularised.tabor_relaxed == pytest.approx(tabor, rel=1e-8)
    ratio = SOFT.tabor_relaxed / tabor
    assert regularised.surface.range == pytest.approx(ratio * Z0, rel=1e-8)


def test_a_fluid_counts_with_its_softened_modulus():
    melt = sa.Maxwell(1e9, 1e-6, 0.5)
    contact = sa.Contact(sa.Paraboloid(1e-6), melt, LAWS[0])
    assert contact.tabor_relaxed == np.inf
    regularised = contact.regularised(2)
    like = sa.Elastic(contact.softened_modulus * 0.75, 0.5)
    assert sa.Contact(contact.tip, like, regularised.surface).tabor_relaxed == pytest.approx(2)


def test_a_contact_below_the_number_stays_as_it_is():
    assert SOFT.regularised(8).regularised(9).surface == SOFT.regularised(8).surface
    stiff = sa.Contact(sa.Paraboloid(1e-8), sa.Elastic(1e9, 0.3), LAWS[0])
    assert stiff.regularised(8) is stiff


@pytest.mark.parametrize("tabor", [0, 0.09, 1001, -8, np.nan, np.inf, "8", True, None])
def test_a_number_out_of_range_is_refused(tabor):
    with pytest.raises(ValueError, match=r"^tabor = ") as refused:
        SOFT.regularised(tabor)
    assert len(str(refused.value).splitlines()) == 1


def test_what_cannot_be_regularised_is_refused():
    repelling = sa.Contact(SOFT.tip, RUBBER, sa.Repulsion(1e6, 1e-9))
    with pytest.raises(ValueError, match=r"^surface law 'repulsion': has no adhesion"):
        repelling.regularised(8)
    for law in OTHERS:
        contact = sa.Contact(SOFT.tip, RUBBER, law)
        with pytest.raises(ValueError, match=f"^surface law '{law.kind}': cannot be stretched"):
            contact.regularised(0.5)
    gel = sa.Contact(sa.Paraboloid(1e-5), sa.Elastic(1e3, 0.5), LAWS[0])
    with pytest.raises(ValueError, match="'lennard-jones': its range would have to be"):
        gel.regularised(0.5)


# As an option of the modes

RAMP = sa.Triangle(0.3e-6, -0.05e-6, 1e-6)
LEVER = sa.Cantilever(1.0, quality_factor=100, frequency=5e4)
RUNS = {
    "force-distance": lambda c, **o: sa.force_distance(c, RAMP, **o),
    "force-spectroscopy": lambda c, **o: sa.force_spectroscopy(c, LEVER, RAMP, **o),
    "tapping-cycle": lambda c, **o: sa.tapping_cycle(c, 50e-9, 60e-9, 1e4, 1, **o),
    "approach-curve": lambda c, **o: sa.approach_curve(c, LEVER, 50e-9, [0.7], **o),
}


@pytest.mark.filterwarnings("ignore:.*still in contact at the end:softafm.AccuracyWarning")
@pytest.mark.parametrize("mode", RUNS)
def test_every_mode_runs_the_regularised_contact_and_records_both(mode):
    run = RUNS[mode]
    result = run(SOFT, regularise=2.0, tolerance=0.1)
    by_hand = run(SOFT.regularised(2.0), tolerance=0.1)
    np.testing.assert_array_equal(result["force_min"].values, by_hand["force_min"].values)
    experiment = json.loads(result.attrs["experiment"])
    given = {"kind": "lennard-jones", "hamaker": SOFT.surface.hamaker, "z0": Z0}
    assert experiment["regularise"] == {"tabor": 2.0, "surface": given}
    range_ = SOFT.regularised(2.0).surface.range
    assert experiment["surface"]["z0"] == result.attrs["regularised_range"] == range_
    assert result.attrs["given_range"] == Z0
    assert result.attrs["given_tabor"] == pytest.approx(SOFT.tabor_relaxed)
    assert result.attrs["regularised_tabor"] == 2.0
    assert result.attrs["tabor_relaxed"] == pytest.approx(2.0)
    assert "regularise" not in json.loads(by_hand.attrs["experiment"])


def test_it_is_recorded_where_nothing_had_to_change():
    stiff = sa.Contact(sa.Paraboloid(1e-8), sa.Elastic(1e9, 0.3), LAWS[0])
    motion = sa.Triangle(4e-9, 0.3e-9, 1e-6)
    result = sa.force_distance(stiff, motion, regularise=8)
    assert result.attrs["given_range"] == result.attrs["regularised_range"] == Z0
    assert result.attrs["regularised_tabor"] == 8
    assert float(result.force_min) == float(sa.force_distance(stiff, motion).force_min)


@pytest.mark.filterwarnings("ignore:.*still in contact at the end:softafm.AccuracyWarning")
def test_the_edge_of_a_viscoelastic_contact_is_slowed_and_that_is_told():
    """The cohesive length E z0²/W grows with the square of the range."""
    for sample in (sa.StandardLinearSolid(2e7, 2e6, 1e-4, 0.5), sa.Maxwell(2e7, 1e-4, 0.5)):
        creeping = sa.Contact(SOFT.tip, sample, SOFT.surface)
        result = sa.force_distance(creeping, RAMP, regularise=5, tolerance=0.1)
        ratio = result.attrs["regularised_range"] / Z0
        assert result.attrs["edge_slowed"] == pytest.approx(ratio**2)
        assert ratio > 1
    assert sa.force_distance(SOFT, RAMP, regularise=5).attrs["edge_slowed"] == 1


def test_pull_off_converges_at_a_speed_in_cohesive_lengths():
    """And does not at a speed: between Tabor numbers of 8 and 12 it still rises."""
    pulled = {}
    for tabor in (8, 12):
        length = SOFT.regularised(tabor).cohesive_length
        for time in ("kept", "fixed"):
            creep_time = 0.3 * (length if time == "kept" else SOFT.regularised(8).cohesive_length)
            sample = sa.StandardLinearSolid(2e7, 2e6, creep_time / RAMP.speed, 0.5)
            contact = sa.Contact(SOFT.tip, sample, SOFT.surface)
            curve = sa.force_distance(contact, RAMP, regularise=tabor)
            pulled[time, tabor] = float(curve.force_min)
    assert pulled["kept", 12] == pytest.approx(pulled["kept", 8], rel=0.02)
    assert pulled["fixed", 12] < 1.1 * pulled["fixed", 8]


@pytest.mark.parametrize("mode", RUNS)
def test_every_mode_refuses_a_number_out_of_range(mode):
    with pytest.raises(ValueError, match=r"^regularise = 1001: must be between 0\.1 and 1000"):
        RUNS[mode](SOFT, regularise=1001)


def test_a_check_repeats_the_regularised_contact(tmp_path):
    result = sa.force_distance(SOFT, RAMP, regularise=2, check=True)
    finer = sa.force_distance(SOFT.regularised(2), RAMP, tolerance=1e-3)
    found = json.loads(result.attrs["check_differences"])["force_min"]
    force = max(abs(float(finer.force_min)), abs(float(finer.force_max)))
    assert found == pytest.approx(float(result.force_min - finer.force_min) / force, abs=1e-12)
    sa.save(result, tmp_path / "soft.nc")
    assert sa.load(tmp_path / "soft.nc").attrs == result.attrs


def test_the_pull_off_of_an_elastic_contact_tends_to_jkr():
    """Johnson, Kendall and Roberts 1971: 1.5 πRW."""
    off = []
    for tabor in (3, 8, 20, 100):
        pull = -float(sa.force_distance(SOFT, RAMP, regularise=tabor).force_min)
        off.append(pull / (1.5 * np.pi * 1e-6 * W) - 1)
    assert off == sorted(off, reverse=True)
    assert 0 < off[-1] < 1e-3
    assert off[2] < 3e-3
    assert off[1] < 0.01


def test_the_page_on_soft_contacts_runs(tmp_path):
    page = (Path(__file__).parents[1] / "docs" / "soft.md").read_text(encoding="utf-8")
    path, names = tmp_path / "soft.py", {}
    path.write_text("\n".join(re.findall(r"```python\n(.*?)```", page, re.S)), encoding="utf-8")
    exec(compile(path.read_text(encoding="utf-8"), path, "exec"), names)
    assert names["curve"].attrs["given_tabor"] == pytest.approx(402, abs=0.5)
    pull = -float(names["curve"].force_min) / (np.pi * 5e-6 * 0.05)
    assert pull == pytest.approx(1.513, abs=0.002)
    assert names["checked"].attrs["check_largest"] < 1e-2


# By itself, where a contact is too soft

GEL = sa.Contact(sa.Paraboloid(5e-6), sa.Elastic(2e4, 0.5), LAWS[0])
"""Its Tabor number is 8667."""
GEL_RAMP = sa.Triangle(6e-6, -1e-6, 1e-6)


def same(one, two):
    ignored = {"created", "solver_wall_time"}
    assert {k: v for k, v in one.attrs.items() if k not in ignored} == {
        k: v for k, v in two.attrs.items() if k not in ignored
    }
    assert one.drop_attrs().identical(two.drop_attrs())


@pytest.mark.filterwarnings("ignore:.*still in contact at the end:softafm.AccuracyWarning")
@pytest.mark.parametrize("mode", RUNS)
def test_up_to_the_largest_number_the_default_is_the_real_law(mode):
    contact = SOFT.regularised(2)
    default = RUNS[mode](contact, tolerance=0.1)
    same(default, RUNS[mode](contact, tolerance=0.1, regularise=None))
    assert not [name for name in default.attrs if "regularised" in name]


def test_beyond_it_a_run_regularises_by_itself_and_tells_its_error(tmp_path):
    """The pull-off is JKR's, 1.5 πRW, at any Tabor number as large."""
    with pytest.warns(
        sa.AccuracyWarning, match=r"^regularised by itself: .* 8\.67e\+03 .*"
    ) as told:
        result = sa.force_distance(GEL, GEL_RAMP)
    assert len(told) == 1
    assert str(told[0].message) == result.attrs["warnings"]
    assert float(result.force_min) == pytest.approx(-1.5 * np.pi * 5e-6 * W, rel=3e-3)
    assert (result.attrs["regularised_tabor"], result.attrs["given_range"]) == (500, Z0)
    assert result.attrs["given_tabor"] == pytest.approx(8667, abs=1)
    assert json.loads(result.attrs["experiment"])["regularise"]["surface"]["z0"] == Z0
    finer = sa.force_distance(GEL, GEL_RAMP, regularise=500)
    assert float(result.loop_energy) == float(finer.loop_energy)
    other = sa.force_distance(GEL, GEL_RAMP, regularise=250)
    errors = json.loads(result.attrs["regularised_errors"])
    assert set(errors) == {
        "force_max", "force_min", "force_min_approach", "loop_energy", "viscous_loss",
    }  # fmt: skip
    for name in ("force_min", "loop_energy"):
        found = float((result[name] - other[name]) / abs(other[name]))
        assert errors[name] == pytest.approx(found, rel=1e-6, abs=1e-12)
    largest = max(map(abs, errors.values()))
    assert result.attrs["regularised_error"] == largest
    assert f"{100 * largest:.2g} % (loop_energy)" in result.attrs["warnings"]
    sa.save(result, tmp_path / "gel.nc")
    assert sa.load(tmp_path / "gel.nc").attrs == result.attrs
    text = sa.plot(result).get_supxlabel()
    assert text == f"too soft for their law, and regularised: estimated error {100 * largest:.2g} %"


def test_the_estimate_holds_against_the_largest_number():
    """Between Tabor numbers of 500 and 1000 observables change by less than it says."""
    with pytest.warns(sa.AccuracyWarning, match="^regularised by itself"):
        errors = json.loads(sa.force_distance(GEL, GEL_RAMP).attrs["regularised_errors"])
    half, whole = (sa.force_distance(GEL, GEL_RAMP, regularise=tabor) for tabor in (500, 1000))
    for name in ("force_min", "force_min_approach", "loop_energy"):
        change = abs(float(half[name] / whole[name]) - 1)
        assert change <= max(abs(errors[name]), 3e-3), name


def test_a_viscoelastic_contact_is_told_that_its_edge_is_slower():
    sample = sa.StandardLinearSolid(2e5, 2e4, 1e-3, 0.5)
    contact = sa.Contact(GEL.tip, sample, GEL.surface)
    with pytest.warns(sa.AccuracyWarning, match=r"3e\+02 times slower in cohesive lengths"):
        result = sa.force_distance(contact, sa.Triangle(2e-5, -1e-6, 1e-6))
    assert result.attrs["edge_slowed"] == pytest.approx((8667 / 500) ** 2, rel=1e-3)


class Counting:
    """Takes the place of a solver that would give up: it says which contact it was given."""

    kind, adaptive = "counting", True

    def __init__(self):
        self.given = []

    def solve(self, contact, motion, **options):
        self.given.append(contact)
        raise sa.DivergedError("nothing is solved here")


def test_a_sample_that_softens_long_after_the_motion_is_not_soft():
    """In the long run its Tabor number is 1e5; within the motion it is that of a solid, 0.2."""
    sample = sa.StandardLinearSolid.from_relaxation_time(3e9, 10.0, 1e3, 0.35)
    contact = sa.Contact(sa.Paraboloid(1e-8), sample, sa.LennardJones(1e-19, Z0))
    assert contact.tabor_softened > 1e4
    solver, slow = Counting(), sa.Triangle(1e-6, 0.3e-9, 1e-21)
    for regularise in ("auto", None):
        with pytest.raises(sa.DivergedError):
            sa.force_distance(
                contact, sa.Triangle(4e-9, 0.3e-9, 1e-6), regularise=regularise, solver=solver
            )
    with pytest.raises(sa.DivergedError):
        sa.force_distance(contact, slow, solver=solver)
    assert solver.given == [contact, contact, contact.regularised(500)]


def test_none_forces_the_real_law_and_warns_beforehand():
    solver = Counting()
    with (
        pytest.warns(sa.AccuracyWarning, match=r"Tabor number of 8\.67e\+03; beyond 1000 .* may"),
        pytest.raises(sa.DivergedError),
    ):
        sa.force_distance(GEL, GEL_RAMP, regularise=None, solver=solver)
    assert solver.given == [GEL]


def test_a_law_that_cannot_be_stretched_is_run_as_it_is_with_that_warning():
    for law in OTHERS:
        contact, solver = sa.Contact(GEL.tip, sa.Elastic(1e3, 0.5), law), Counting()
        with (
            pytest.warns(sa.AccuracyWarning, match="is taken as it is at a Tabor number of"),
            pytest.raises(sa.DivergedError),
        ):
            sa.force_distance(contact, GEL_RAMP, solver=solver)
        assert solver.given == [contact]


def test_a_tip_that_starts_within_the_longer_range_meets_the_law_as_it_is():
    """At a Tabor number of 250 the surfaces would be at rest 10.4 nm apart."""
    solver = Counting()
    with (
        pytest.warns(sa.AccuracyWarning, match="is taken as it is at a Tabor number of"),
        pytest.raises(sa.DivergedError),
    ):
        sa.force_distance(GEL, sa.Triangle(10e-9, -1e-6, 1e-6), solver=solver)
    with pytest.raises(sa.DivergedError):
        sa.force_distance(GEL, sa.Triangle(11e-9, -1e-6, 1e-6), solver=solver)
    assert solver.given == [GEL, GEL.regularised(500)]


def test_what_was_regularised_to_the_largest_number_is_not_beyond_it():
    solver = Counting()
    for options in ({"regularise": 1000}, {}, {"regularise": None}):
        contact = GEL if options.get("regularise") else GEL.regularised(1000)
        with pytest.raises(sa.DivergedError):
            sa.force_distance(contact, GEL_RAMP, solver=solver, **options)
    assert solver.given == [GEL.regularised(1000)] * 3


def test_an_estimate_that_fails_is_told_and_the_result_kept(monkeypatch, tmp_path):
    class Failing(sa.solvers.Energy):
        def solve(self, contact, motion, **options):
            if contact.tabor_softened < 300:
                raise sa.DivergedError("gone")
            return super().solve(contact, motion, **options)

    with pytest.warns(sa.AccuracyWarning, match="the run at 250 that tells the error failed: gone"):
        result = sa.force_distance(GEL, GEL_RAMP, solver=Failing())
    assert np.isnan(result.attrs["regularised_error"])
    sa.save(result, tmp_path / "gel.nc")
    assert np.isnan(sa.load(tmp_path / "gel.nc").attrs["regularised_error"])
    assert sa.plot(result).get_supxlabel().endswith("error not known")


@pytest.mark.parametrize("regularise", ["none", "Auto", "8"])
@pytest.mark.parametrize("mode", RUNS)
def test_a_word_that_is_none_is_refused(mode, regularise):
    with pytest.raises(ValueError, match=r"^regularise = '\w+': must be a number from 0\.1 "):
        RUNS[mode](SOFT, regularise=regularise)


# As an entry of an experiment file


@pytest.fixture
def soft_file(tmp_path):
    path = tmp_path / "soft.toml"
    path.write_text(read_example("pdms-sphere"), encoding="utf-8")
    return path


def test_a_file_says_it_is_to_be_regularised(soft_file):
    experiment = load_experiment(soft_file, ["surface.z0=0.3nm", "run.regularise=8"])
    assert experiment.contact.surface.z0 == pytest.approx(0.3e-9)
    assert experiment.regularise == 8
    result = experiment.run()
    assert result.attrs["tabor_relaxed"] == pytest.approx(8)
    assert float(result.force_min) == pytest.approx(-1.5 * np.pi * W * 5e-6, rel=0.02)


@pytest.mark.parametrize(
    ("written", "meant", "line"),
    [("auto", "auto", ""), ("none", None, "regularise=None"), ("1000", 1000, "regularise=1e3")],
)
def test_a_file_says_whether_its_contact_may_be_regularised(soft_file, written, meant, line):
    assert load_experiment(soft_file).regularise == "auto"
    experiment = load_experiment(soft_file, [f"run.regularise={written}"])
    assert experiment.regularise == meant
    found = write_python(experiment.document, soft_file.parent)
    assert line in found
    assert ("regularise" in found) == bool(line)


@pytest.fixture
def gel_file(tmp_path):
    """A file of the gel and its ramp."""
    path = tmp_path / "gel.toml"
    path.write_text(
        """
        mode = "force-distance"
        tip = { shape = "paraboloid", radius = "5 um" }
        sample = { model = "elastic", E = "20 kPa", poisson = 0.5 }
        surface = { law = "lennard-jones", work_of_adhesion = "50 mJ/m^2", z0 = "0.3 nm" }
        motion = { start = "6 um", turn = "-1 um", speed = "1 um/s" }
        """,
        encoding="utf-8",
    )
    return path


def test_before_a_run_it_is_said_that_it_will_be_regularised(gel_file):
    by_itself, once, forced = (
        regime(gel_file, [f"run.regularise={written}"]) for written in ("auto", "500", "none")
    )
    assert "regularised; it was 300 pm at a Tabor number of 8.67e+03" in str(by_itself)
    assert "a second run estimates the error" in str(by_itself)
    assert by_itself.contact == once.contact == GEL.regularised(500)
    assert by_itself.expected_seconds == pytest.approx(2 * once.expected_seconds)
    assert "a second run" not in str(once)
    assert "the law stays: beyond a Tabor number of 1000 the run may fail" in str(forced)


def test_a_sweep_is_warned_of_contacts_that_were_regularised(gel_file):
    with pytest.warns(sa.AccuracyWarning, match="^regularised by itself"):
        found = load_experiment(gel_file).observables()
    assert float(found["force_min"]) == pytest.approx(-1.5 * np.pi * 5e-6 * W, rel=3e-3)


def test_the_command_line_shows_what_was_regularised(gel_file, softafm, monkeypatch):
    monkeypatch.setenv("COLUMNS", "250")
    out = gel_file.parent / "gel.nc"
    code, shown, told = softafm("run", gel_file, "--out", out)
    assert code == 0
    assert re.search(r"range +5\.2 nm +of the law, regularised; .*estimated error \+2\.\d %", shown)
    assert told.startswith("softafm: warning: regularised by itself")
    assert sa.load(out).attrs["regularised_tabor"] == 500
    code, _, told = softafm("run", gel_file, "--out", out, "--force", "--regularise", "never")
    assert (code, told) == (
        2,
        "softafm: run.regularise = 'never': must be a plain number, without quotes or unit; or "
        "'auto' or 'none'\n",
    )
