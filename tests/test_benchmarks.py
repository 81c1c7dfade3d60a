"""The benchmarks: all can be loaded, and on a few random contacts the tolerance is the error."""

import importlib
import sys
from dataclasses import asdict
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
SCRIPTS = sorted(path.stem for path in BENCHMARKS.glob("*.py"))
SEEDS = range(12)


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


def test_random_contacts_are_within_the_tolerance_or_warn(scripts, tmp_path):
    accuracy, out = scripts["accuracy"], tmp_path / "found.jsonl"
    entries = accuracy.battery(SEEDS, [3e-2], out)
    assert {entry["mode"] for entry in entries} == {
        "force-distance", "force-spectroscopy", "tapping-cycle"
    }  # fmt: skip
    for entry in entries:
        assert entry["ending"] == "completed"
        assert entry["error"] <= entry["tolerance"] or entry["warned"], entry


def test_battery_goes_on_where_it_was_stopped(scripts, tmp_path, monkeypatch, capsys):
    accuracy, out, measured = scripts["accuracy"], tmp_path / "found.jsonl", []

    def entry_of(seed, tolerance):
        measured.append((seed, tolerance))
        return {"seed": seed, "tolerance": tolerance, "tabor": 1.0, "mode": "tapping-cycle",
                "seconds": 1.0, "error": tolerance / 2, "warned": False,
                "ending": "completed"}  # fmt: skip

    monkeypatch.setattr(accuracy, "measure", entry_of)
    accuracy.battery([3, 4], [1e-2], out)
    arguments = ["--contacts", "3", "--first", "3", "--tolerances", "0.01", "0.001", "--plot",
                 "--out", str(out)]  # fmt: skip
    entries = accuracy.main(arguments)
    assert measured == [(3, 1e-2), (4, 1e-2), (5, 1e-2), (3, 1e-3), (4, 1e-3), (5, 1e-3)]
    assert len(entries) == len(out.read_text().splitlines()) == 6
    assert out.with_suffix(".png").exists()
    assert "100.0%" in capsys.readouterr().out


def test_a_seed_is_always_the_same_contact(scripts):
    first, again = (scripts["accuracy"].draw(5) for _ in range(2))
    assert first.tabor == again.tabor
    assert first.length == again.length


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
