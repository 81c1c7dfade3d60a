"""Campaigns: what every run gives, and what is refused before any of them."""

import copy
from pathlib import Path

import numpy as np
import pytest

import softafm as sa
from softafm.checks.refusals import ConfigError
from softafm.experiment.config import build_experiment, parse_document, read_example
from softafm.modes import MODES
from softafm.sweeps.block import DONE, FAILED, WARNED, Work
from softafm.sweeps.reading import make_campaign, read_table
from softafm.sweeps.sweep import plan

TAP = parse_document(read_example("ldpe-tapping"), "ldpe-tapping")
EXAMPLES = ("attard-triangle", "ldpe-spectroscopy", "ldpe-tapping")


def campaign(sweep, document=TAP, what=None):
    return make_campaign(
        document if what is None else what, Path(), read_table(sweep), from_file=True
    )


def refused(sweep, document=TAP, what=None):
    with pytest.raises(ConfigError) as refusal:
        campaign(sweep, document, what)
    assert "\n" not in str(refusal.value)
    return str(refusal.value)


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_observables_of_a_mode_are_the_scalars_of_its_runs(name):
    document = parse_document(read_example(name), name)
    result = build_experiment(document, Path()).run()
    scalars = [n for n, v in result.data_vars.items() if v.ndim == 0]
    assert sorted(MODES[document["mode"]].observed) == sorted(scalars)


def test_a_run_gives_what_the_experiment_gives_to_the_last_bit():
    found = campaign({"vary": {"motion.mean_height": ["43 nm"], "sample.E_inf": ["0.2 GPa"]}})
    (point,) = found.points([range(1), range(1)])
    given = found.run(point)
    document = copy.deepcopy(TAP)
    document["motion"]["mean_height"], document["sample"]["E_inf"] = "43 nm", "0.2 GPa"
    result = build_experiment(document, Path()).run()
    assert {name: float(value) for name, value in given.items()} == {
        name: float(result[name]) for name in MODES["tapping-cycle"].observed
    }


def test_an_approach_curve_gives_arrays_over_branch_and_ratio():
    document = parse_document(read_example("ps-approach-curve"), "ps-approach-curve")
    document["motion"] = {"free_amplitude": "15 nm", "amplitude_ratio": [0.8, 0.5]}
    found = campaign({"vary": {"sample.creep_time": ["1 us"]}}, document)
    phase = next(o for o in found.observables if o.name == "phase")
    assert (phase.dimensions, phase.shape) == (("branch", "amplitude_ratio"), (3, 2))
    assert phase.unit == "degree"
    assert found.coordinates["amplitude_ratio"][1].tolist() == [0.8, 0.5]
    told = refused({"vary": {"motion.amplitude_ratio": [[0.8], [0.5]]}}, document)
    assert told.startswith("sweep.vary.'motion.amplitude_ratio': the results of every run lie over")


def test_a_file_of_a_campaign_is_read(tmp_path):
    text = read_example("ldpe-tapping") + (
        "[sweep]\ndesign = 'grid'\nbatch = 7\nobservables = ['virial']\n"
        "[sweep.vary]\nsample.E_inf = ['0.1 GPa']\n'tip.radius' = ['10 nm', '20 nm']\n"
        "[[sweep.together]]\n'motion.amplitude' = ['40 nm', '50 nm', '60 nm']\n"
        "motion.mean_height = { from = '38 nm', to = '58 nm', points = 3 }\n"
    )
    (tmp_path / "c.toml").write_text(text, encoding="utf-8")
    found, batch = plan(tmp_path / "c.toml", ["sweep.observables=['dissipation']"])
    assert found.dimensions == ("E_inf", "radius", "amplitude_mean_height")
    assert (found.shape, batch) == ((1, 2, 3), 7)
    assert [observable.name for observable in found.observables] == ["dissipation"]
    assert "sweep" not in found.identity["experiment"]


@pytest.mark.parametrize(
    ("sweep", "words"),
    [
        ({}, "sweep.vary: missing"),
        ([1], "sweep = [1]: must be a table"),
        ({"vary": {"tip.radius": ["1 nm"]}, "sampels": 3}, "sweep.sampels: unknown key; did you"),
        ({"vary": ["tip.radius"]}, "sweep.vary = ['tip.radius']: must be a table"),
        ({"together": [3]}, "sweep.together[0] = 3: must be a table"),
        ({"vary": {"tip.radius": [1e-9]}}, "'tip.radius'[0] = 1e-09: must be a length with its"),
        (
            {"vary": {"tip.radius": ["9 nm"]}, "observables": ["dissipaton"]},
            "sweep.observables = 'dissipaton': did you mean 'dissipation'?",
        ),
        ({"vary": {"tip.radius": ["9 nm"]}, "observables": []}, "sweep.observables = []: is emp"),
        (
            {"vary": {"tip.radius": ["9 nm"]}, "observables": ["virial", "virial"]},
            "'virial' is listed twice",
        ),
        (
            {"vary": {"sample.E_inf": ["1 GPa", "5 GPa"]}},
            "sample.E_inf = '5000000000.0 Pa': must be at most sample.E0 = '2 GPa'",
        ),
        (
            {"vary": {"sample.E_inf": {"from": "5 GPa", "to": "9 GPa"}}, "design": "random",
             "samples": 20},
            "must be at most sample.E0",
        ),
    ],
)  # fmt: skip
def test_a_bad_campaign_is_refused_in_one_line(sweep, words):
    assert words in refused(sweep)


def test_what_the_experiment_lacks_is_refused_too():
    assert refused({"vary": {"tip.radius": ["9 nm"]}}, {}).startswith("mode: missing")
    without = {key: table for key, table in TAP.items() if key != "surface"}
    assert refused({"vary": {"tip.radius": ["9 nm"]}}, without) == (
        "surface: missing; add a table [surface]"
    )


def test_values_that_suit_only_some_others_are_let_through():
    vary = {"sample.E0": ["1 GPa", "9 GPa"], "sample.E_inf": ["0.1 GPa", "5 GPa"]}
    found = campaign({"vary": vary})
    work = Work(found.run, {"virial": ()})
    block = work(found.points([range(2), range(2)]))
    assert block.state.tolist() == [DONE, FAILED, DONE, DONE]
    assert block.reasons == {
        1: "sample.E_inf = '5000000000.0 Pa': must be at most sample.E0 = '1000000000.0 Pa' "
        "(a solid softens as it relaxes)"
    }


# Functions


def area(width, height=1.0):
    import warnings

    if width < 0:
        raise ValueError("width: must be above 0")
    if width == 7:
        warnings.warn("seven is\nodd", sa.AccuracyWarning, stacklevel=1)
        warnings.warn("nobody cares", UserWarning, stacklevel=1)
    if width == 8:
        raise KeyError("eight")
    return {"area": width * height, "name": "rectangle", "outline": np.ones(4)}


def test_a_function_gives_its_scalars_or_a_reason():
    found = campaign({"vary": {"width": [1, -1, 7, 8]}}, what=area)
    assert [observable.name for observable in found.observables] == ["area"]
    block = Work(found.run, {"area": ()})(found.points([range(4)]))
    assert block.state.tolist() == [DONE, FAILED, WARNED, FAILED]
    assert block.values["area"].tolist()[::2] == [1.0, 7.0]
    assert block.reasons == {1: "width: must be above 0", 3: "KeyError: 'eight'"}
    assert block.warnings == {2: "seven is; odd"}


def test_the_scalars_of_a_dataset_keep_their_units():
    def tap(mean_height):
        experiment = build_experiment(TAP, Path())
        return sa.tapping_cycle(experiment.contact, 49.6e-9, mean_height, 278e3, 1)

    found = campaign({"vary": {"mean_height": [43e-9]}}, what=tap)
    units = {observable.name: observable.unit for observable in found.observables}
    assert units["virial"] == "J"
    assert sorted(units) == sorted(MODES["tapping-cycle"].observed)


@pytest.mark.parametrize(
    ("function", "vary", "words"),
    [
        (area, {"breadth": [1]}, "sweep.vary: area cannot be called with it: missing a required"),
        (area, {"width": [-1]}, "the first run, of area with width = -1, failed: ValueError: wid"),
        (area, {"width": [[1, 2]]}, "'width'[0] = [1, 2]: must be a number"),
        (lambda x: 3, {"x": [1]}, "must be a mapping of names to numbers"),
        (lambda x: {"x": "text"}, {"x": [1]}, "gives no numbers"),
        (lambda x: {"x": x}, {"x": [1]}, "'x' is what varies, too"),
    ],
)
def test_a_bad_function_is_refused_in_one_line(function, vary, words):
    assert words in refused({"vary": vary}, what=function)
