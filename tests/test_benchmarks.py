"""The benchmarks: all can be loaded, and on a few random contacts the tolerance is the error."""

import importlib
import sys
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
SCRIPTS = sorted(path.stem for path in BENCHMARKS.glob("*.py"))
RAMP, TAP, APPROACH = 3, 5, 6
"""Seeds of a force curve, a tap and an approach curve."""


@pytest.fixture(scope="module")
def scripts():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(BENCHMARKS)
        patch.setenv("OPENBLAS_NUM_THREADS", "1")
        yield {name: importlib.import_module(name) for name in SCRIPTS}
        for name in SCRIPTS:
            del sys.modules[name]


def test_every_script_has_a_main_and_says_how_it_is_run(scripts):
    for name, module in scripts.items():
        if name != "common":
            assert callable(module.main)
            assert f"python benchmarks/{name}.py" in module.__doc__


@pytest.fixture(scope="module")
def drawn(scripts):
    return [scripts["contacts"].draw(seed) for seed in range(30)]


def test_seeds_draw_every_mode_and_kind_and_always_the_same(scripts, drawn):
    assert {each.mode for each in drawn} == set(scripts["contacts"].MODES)
    assert len({each.contact.sample.kind for each in drawn}) == 6
    assert len({each.contact.surface.kind for each in drawn}) == 7
    assert len({each.contact.tip.kind for each in drawn}) == 5
    assert repr(scripts["contacts"].draw(5)) == repr(drawn[5])


def test_ramps_start_out_of_contact_and_can_end_there(drawn):
    for experiment in drawn:
        if experiment.mode in ("force-distance", "force-spectroscopy"):
            contact = experiment.contact
            if experiment.regularise != "auto":
                contact = contact.regularised(experiment.regularise)
            assert contact.contact_radius(experiment.motion.start) == 0
            assert experiment.motion.start > contact.edge_gap + 10 * contact.reach


def found(**values):
    return {"force_max": 10.0, "force_min": -1.0, **values}


@pytest.mark.parametrize(
    ("values", "truth", "error"),
    [
        (found(), found(force_min=-1.1), 0.1 / 1.1),
        (found(force_min=-0.01), found(force_min=-0.03), 0.02 / 0.1),
        (found(virial=1.0), found(virial=2.0), 0.5),
    ],
)
def test_observables_are_measured_against_themselves(scripts, values, truth, error):
    experiment = scripts["contacts"].draw(TAP)
    errors = scripts["accuracy"].compare(experiment, values, truth)
    assert max(errors.values()) == pytest.approx(error)


@pytest.mark.parametrize("name", ["loop_energy", "dissipation"])
def test_small_energies_count_against_part_of_force_times_length(scripts, name):
    experiment = scripts["contacts"].draw(RAMP if name == "loop_energy" else TAP)
    length = experiment.contact.surface.range
    if name == "dissipation":
        length = 0.02 * experiment.motion.amplitude
    truth = found(**{name: 0.02 * 10.0 * length / 4})
    errors = scripts["accuracy"].compare(experiment, found(**{name: 0.0}), truth)
    assert errors[name] == pytest.approx(0.25)


def solutions(heights, dissipation=1e-18):
    heights = np.array([heights])
    same = {"force_max": 0 * heights + 1e-9, "force_min": 0 * heights - 1e-9}
    return {"mean_height": heights, "dissipation": 0 * heights + dissipation, **same}


@pytest.mark.parametrize(
    ("values", "error"),
    [
        (solutions([10e-9] * 8), 0.0),
        (solutions([10.2e-9] + [10e-9] * 7), 0.01),  # 1 % + 0.1 nm
        (solutions([10e-9] * 8, 1.02e-18), 0.01),
        (solutions([np.nan] + [10e-9] * 7), np.inf),
    ],
)
def test_solutions_may_be_off_by_so_much_and_none_missing(scripts, values, error):
    experiment = scripts["contacts"].draw(APPROACH)
    errors = scripts["accuracy"].compare(experiment, values, solutions([10e-9] * 8))
    assert max(errors.values()) == pytest.approx(error)


def test_battery_ends_what_takes_too_long_and_goes_on_where_it_was_stopped(
    scripts, tmp_path, capsys
):
    out = tmp_path / "found.jsonl"
    arguments = ["--first", str(RAMP), "--tolerances", "0.03", "--out", str(out)]
    entries = scripts["accuracy"].main([*arguments, "--contacts", "1"])
    for entry in entries:
        assert entry["ending"] == "completed"
        assert entry["error"] <= entry["tolerance"]
    runner = scripts["accuracy"].Runner()
    assert runner.run(APPROACH, 1e-4, 0.0)["ending"] == "ended after 0 s"
    assert runner.run(RAMP, 1e-2, 60.0)["ending"] == "completed"
    runner.stop()
    before = out.read_text()
    assert scripts["accuracy"].main([*arguments, "--contacts", "1"]) == entries
    assert out.read_text() == before
    assert "100.0%" in capsys.readouterr().out


def test_soft_contacts_are_set_up_as_the_reference_cases(scripts):
    common = scripts["common"]
    inputs = common.reference_cases()["soft-tabor-30"]["inputs"]
    contact, ramp = common.soft_contact(30)
    solid, law = asdict(contact.sample), contact.surface
    assert contact.tip.radius == inputs["radius"]
    assert solid["E0"] == pytest.approx(inputs["E0"])
    assert solid["E_inf"] == pytest.approx(inputs["E_inf"])
    assert solid["creep_time"] == inputs["tau"]
    assert law.hamaker == pytest.approx(inputs["hamaker"])
    assert (ramp.start, ramp.turn) == pytest.approx((inputs["start"], inputs["turn"]), rel=1e-4)


def test_counted_run_notes_every_newton_iteration(scripts, monkeypatch):
    table, common = scripts["table"], scripts["common"]
    monkeypatch.setattr(table.Counted, "tallies", {}, raising=False)
    monkeypatch.setattr(table.energy_run, "Run", table.Counted)
    result = common.run(common.reference_cases()[table.TAP])
    newtons = sum(tally[0] for tally in table.Counted.tallies.values())
    assert newtons == result.attrs["solver_newton_iterations"]
    assert max(table.Counted.tallies) == result.attrs["solver_most_nodes"]
