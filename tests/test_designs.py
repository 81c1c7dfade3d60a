"""Which values a sweep takes, and which it refuses."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from softafm.checks.refusals import ConfigError
from softafm.experiment.config import parse_document, read_example
from softafm.experiment.fields import find_field, make_plain_field, replace_value
from softafm.sweeps.designs import Between, make_design
from softafm.units import quantities as units

TAP = parse_document(read_example("ldpe-tapping"), "ldpe-tapping")
KINDS = [kind for kind in vars(units).values() if isinstance(kind, units.Kind)]
TWO = {"sample.E_inf": Between("10 MPa", 1e9, log=True), "motion.amplitude": Between(1e-8, 5e-8)}


def of_tap(path):
    return find_field(TAP, path, [path], Path(), bare=True)


def design(vary, kind="grid", samples=None, seed=0, field=of_tap, taken=()):
    return make_design(kind, vary, field, samples, seed, taken)


# Grids


def test_a_grid_has_a_dimension_for_each_field_in_si():
    found = design({"sample.E_inf": ["0.05 GPa", 1e8], "motion.cycles": [1, 2, 3]})
    assert (found.dimensions, found.shape, found.size) == (("E_inf", "cycles"), (2, 3), 6)
    assert found.at((0, 2)) == {"sample.E_inf": 5e7, "motion.cycles": 3}
    assert found.write_at((1, 0)) == {"sample.E_inf": "100000000.0 Pa", "motion.cycles": 1}
    dims, values, told = found.coordinates["E_inf"]
    assert (dims, values.tolist()) == (("E_inf",), [5e7, 1e8])
    assert told == {"units": "Pa", "long_name": "sample.E_inf"}


def test_a_range_has_its_ends_and_evenly_spaced_values():
    range_ = {"from": "10 ns", "to": "1 us", "points": 21, "spacing": "log"}
    _, values, _ = design({"sample.creep_time": range_}).coordinates["creep_time"]
    assert (values[0], values[-1]) == (1e-8, 1e-6)
    assert np.diff(np.log(values)) == pytest.approx(np.full(20, np.log(100) / 20))
    range_ = {"from": "1 nm", "to": "3 nm", "points": 3}
    _, values, _ = design({"tip.radius": range_}).coordinates["radius"]
    assert values == pytest.approx([1e-9, 2e-9, 3e-9], rel=1e-15)


def test_fields_in_a_tuple_vary_together():
    found = design({("tip.radius", "tip.shape"): [["10 nm", "20 nm"], ["sphere", "paraboloid"]]})
    assert (found.dimensions, found.shape) == (("radius_shape",), (2,))
    assert found.at((1,)) == {"tip.radius": 2e-8, "tip.shape": "paraboloid"}
    assert found.coordinates["shape"][1].tolist() == ["sphere", "paraboloid"]


def test_names_are_the_last_key_unless_that_is_taken():
    found = design({"tip.radius": [1e-8], "motion.amplitude": [1e-8]}, taken=["amplitude"])
    assert found.dimensions == ("radius", "motion_amplitude")


def test_entries_of_lists_and_parts_of_sums_can_vary():
    prony = {"model": "generalized-maxwell", "moduli": ["1 GPa", "2 GPa"]}
    parts = [{"law": "exponential"}, {"law": "repulsion"}]
    document = {**TAP, "sample": prony, "surface": {"law": "sum", "parts": parts}}
    for path, text, value in (
        ("sample.moduli[1]", "3 GPa", 3e9),
        ("surface.parts[0].decay", "3 nm", 3e-9),
    ):
        field = find_field(document, path, [path], Path(), bare=False)
        assert field.read(text) == value
    changed = replace_value(document, ("sample", "moduli", 1), "3 GPa")
    assert changed["sample"]["moduli"] == ["1 GPa", "3 GPa"]
    assert prony["moduli"] == ["1 GPa", "2 GPa"]


@given(
    st.sampled_from(KINDS),
    st.floats(1e-39, 1e39, allow_nan=False) | st.floats(-1e39, -1e-39) | st.just(0.0),
)
def test_a_value_in_si_is_read_back_to_the_last_bit(kind, value):
    assert units.read_quantity(f"{value!r} {kind.si}", kind) == value


# Samples


@pytest.mark.parametrize("kind", ["random", "latin-hypercube", "sobol"])
def test_a_sample_lies_in_its_ranges_and_is_that_of_its_seed(kind):
    found = design(TWO, kind, 100, 3)
    assert (found.dimensions, found.shape) == (("sample",), (100,))
    moduli, lengths = (found.coordinates[name][1] for name in ("E_inf", "amplitude"))
    assert ((moduli >= 1e7) & (moduli <= 1e9)).all()
    assert ((lengths >= 1e-8) & (lengths <= 5e-8)).all()
    # Half of them are below the geometric mean, and the two have nothing to do with each other.
    assert abs((moduli < 1e8).mean() - 0.5) < 0.15
    assert abs(np.corrcoef(np.log(moduli), lengths)[0, 1]) < 0.3
    again, other = design(TWO, kind, 100, 3), design(TWO, kind, 100, 4)
    assert np.array_equal(moduli, again.coordinates["E_inf"][1])
    assert not np.array_equal(moduli, other.coordinates["E_inf"][1])


def test_a_latin_hypercube_has_one_value_in_each_of_n_parts():
    _, values, _ = design(TWO, "latin-hypercube", 50).coordinates["amplitude"]
    assert sorted(((values - 1e-8) / 4e-8 * 50).astype(int)) == list(range(50))


def test_a_sobol_sample_is_even():
    _, values, _ = design(TWO, "sobol", 64).coordinates["amplitude"]
    assert sorted(((values - 1e-8) / 4e-8 * 64).astype(int)) == list(range(64))


def test_a_list_is_drawn_from_in_a_sample():
    found = design({"tip.shape": ["sphere", "paraboloid"], **TWO}, "latin-hypercube", 40)
    shapes = found.coordinates["shape"][1].tolist()
    assert (shapes.count("sphere"), shapes.count("paraboloid")) == (20, 20)


# Refusals


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        ({}, "sweep.vary: names nothing to vary"),
        ({"sample.E_ing": [1]}, "sweep.vary.'sample.E_ing': unknown key; did you mean 'E_inf'?"),
        ({"smple.E_inf": [1]}, "sweep.vary.'smple.E_inf': no table of this experiment; did you"),
        ({"E_inf": [1]}, "sweep.vary.'E_inf': must be a table and a key"),
        ({"mode": ["tapping-cycle"]}, "sweep.vary.'mode': cannot vary"),
        ({"sample.E_inf": []}, "sweep.vary.'sample.E_inf' = []: is empty"),
        ({"sample.E_inf": ["1 GPa", "3 nm"]}, "'sample.E_inf'[1] = '3 nm': must be a modulus"),
        ({"sample.E_inf": "1 GPa"}, "'sample.E_inf' = '1 GPa': must be a list"),
        ({"sample.E_inf": [float("nan")]}, "'sample.E_inf'[0] = nan: must be finite"),
        ({"tip.shape": ["cube"]}, "'tip.shape'[0] = 'cube': must be 'paraboloid'"),
        ({"sample.poisson": ["0.3"]}, "'sample.poisson'[0] = '0.3': must be a plain number"),
        ({"sample.E_inf": Between(1e7, 1e8)}, "add points, their number, or choose a random"),
        ({"sample.E_inf": {"from": 1e7, "to": 1e8}}, "add points"),
        ({"sample.E_inf": {"from": 1e7}}, "'sample.E_inf'.to: missing"),
        ({"sample.E_inf": {"from": 1e7, "to": 1e8, "poins": 3}}, ".poins: unknown key; did you"),
        ({"sample.E_inf": {"from": 1e7, "to": 1e8, "points": 1}}, "points = 1: must be a whole"),
        ({"sample.E_inf": {"from": 1e7, "to": "1 m", "points": 2}}, ".to = '1 m': must be a mod"),
        (
            {"sample.poisson": {"from": 0.0, "to": 0.5, "points": 2, "spacing": "log"}},
            ".from = 0.0: must be above 0 for spacing = 'log'",
        ),
        ({"motion.cycles": {"from": 1, "to": 5, "points": 5}}, "list the values instead"),
        (
            {("tip.radius", "sample.E_inf"): [["1 nm"], [1e7, 1e8]]},
            "'tip.radius, sample.E_inf': 'tip.radius' has 1, 'sample.E_inf' has 2 values",
        ),
        ({("tip.radius", "sample.E_inf"): [["1 nm"]]}, "has 1 lists for 2 fields"),
        ({"tip.radius": ["1 nm"], ("tip.radius",): [1e-9]}, "'tip.radius': is listed twice"),
        (
            {f"sample.{key}": {"from": 1, "to": 2, "points": 10**4} for key in ("E0", "E_inf")}
            | {"tip.radius": {"from": 1e-9, "to": 2e-9, "points": 10**4}},
            "a grid of 1e+12 runs",
        ),
    ],
)
def test_a_bad_grid_is_refused_in_one_line(vary, words):
    with pytest.raises(ConfigError) as refusal:
        design(vary)
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"kind": "gird"}, "sweep.design = 'gird': did you mean 'grid'?"),
        ({"kind": "sobol"}, "sweep.samples: missing"),
        ({"kind": "sobol", "samples": 0}, "sweep.samples = 0: must be a whole number"),
        ({"kind": "random", "samples": 10, "seed": -1}, "sweep.seed = -1"),
        ({"samples": 10}, "sweep.samples = 10: has no effect in a grid"),
        (
            {"vary": {"tip.radius": {"from": 1e-9, "to": 2e-9, "points": 3}}, "kind": "sobol",
             "samples": 10},
            "'tip.radius'.points: has no effect in a random design",
        ),
    ],
)  # fmt: skip
def test_a_bad_sample_is_refused_in_one_line(options, words):
    with pytest.raises(ConfigError) as refusal:
        design(**{"vary": TWO, **options})
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_units_must_be_written_in_a_file():
    field = find_field(TAP, "tip.radius", [], Path(), bare=False)
    with pytest.raises(ValueError, match="the unit is missing"):
        field.read(1e-9)


def test_a_function_takes_what_it_is_given():
    vary = {"n": [1, 2], "word": ["a", "b"], "flag": [True, False], "x": [0.5, 1]}
    found = design(vary, field=make_plain_field)
    assert found.at((1, 0, 1, 1)) == {"n": 2, "word": "a", "flag": False, "x": 1}
    kinds = {name: values.dtype.kind for name, (_, values, _) in found.coordinates.items()}
    assert kinds == {"n": "i", "word": "U", "flag": "b", "x": "f"}
