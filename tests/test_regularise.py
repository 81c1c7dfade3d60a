"""Soft contacts whose law is given a longer range at the same work of adhesion."""

import json
import re
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import softafm as sa
from softafm.experiment.config import load_experiment, read_example

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


@given(tabor=st.floats(0.1, 100))
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


@pytest.mark.parametrize("tabor", [0, 0.09, 101, -8, np.nan, np.inf, "8", True, None])
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
    with pytest.raises(ValueError, match=r"^regularise = 1000: must be between 0\.1 and 100"):
        RUNS[mode](SOFT, regularise=1000)


def test_a_check_repeats_the_regularised_contact(tmp_path):
    result = sa.force_distance(SOFT, RAMP, regularise=2, check=True)
    finer = sa.force_distance(SOFT.regularised(2), RAMP, tolerance=1e-3)
    found = json.loads(result.attrs["check_differences"])["force_min"]
    force = max(abs(float(finer.force_min)), abs(float(finer.force_max)))
    assert found == pytest.approx(float(result.force_min - finer.force_min) / force, abs=1e-12)
    sa.save(result, tmp_path / "soft.nc")
    assert sa.load(tmp_path / "soft.nc").attrs == result.attrs


def test_the_pull_off_of_an_elastic_contact_tends_to_jkr():
    """Johnson, Kendall and Roberts 1971: 1.5 πRW. The loop energy is told to be doubtful."""
    off = []
    for tabor in (3, 8, 20):
        doubtful = pytest.warns(sa.AccuracyWarning, match="loop energy")
        with doubtful if tabor > 18 else nullcontext():
            pull = -float(sa.force_distance(SOFT, RAMP, regularise=tabor).force_min)
        off.append(pull / (1.5 * np.pi * 1e-6 * W) - 1)
    assert off == sorted(off, reverse=True)
    assert 0 < off[-1] < 3e-3
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
