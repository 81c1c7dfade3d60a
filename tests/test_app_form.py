"""The form before it is drawn: what it asks for, and what becomes of a document."""

import math
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from softafm.app.answers import add_part, change_mode, choose, take_way
from softafm.app.documents import arrange, find_value, read_text, remove, replace_value, write_text
from softafm.app.form import (
    Alternatives,
    Field,
    describe_section,
    list_tables,
    read_preset_titles,
    read_presets,
)
from softafm.app.marks import MISSING, add_missing, place
from softafm.app.outlook import estimate_cost, find_problems, foresee, summarise
from softafm.app.plan import list_sections, make_plan
from softafm.app.uploads import keep
from softafm.experiment import schema
from softafm.experiment.config import build_experiment, list_examples
from softafm.experiment.regime import estimate_seconds, regime
from softafm.modes import MODES

HERE = Path()
TAP = read_presets()["ldpe-tapping"]
EVERY = [
    (mode, table, choice)
    for mode in MODES
    for table in (*list_tables(mode), "surface.parts")
    for choice in describe_section(table, None, mode).choices
]


def shown_of(document, path):
    return {one.path: one for one in list_sections(document, {})}[path]


def sample(**keys):
    return {**TAP, "sample": keys}


@pytest.mark.parametrize(("mode", "table", "choice"), EVERY)
def test_every_field_has_a_label_a_help_text_and_an_example(mode, table, choice):
    for field in describe_section(table, choice or None, mode).fields.values():
        assert field.label
        assert len(field.help) > 8, field
        assert "``" not in field.help
        assert field.kind != "quantity" or field.example
        assert bool(field.choices) == (field.kind == "choice")


def test_the_form_offers_what_the_schema_knows():
    for table, (chooser, choices) in schema.CHOICES.items():
        shape = describe_section(table, None, "force-distance")
        assert (shape.chooser, shape.choices) == (chooser, tuple(choices))
        for choice, made in choices.items():
            fields = describe_section(table, choice, "force-distance").fields
            assert set(fields) == set(made.model_fields)
    for name, mode in MODES.items():
        assert describe_section("motion", None, name).choices == tuple(schema.motions_of(mode))
        assert ("cantilever" in list_tables(name)) == (schema.cantilever_of(mode) is not None)
    assert "sum" not in describe_section("surface.parts", None, "force-distance").choices


def test_every_example_that_a_field_shows_is_read_by_its_type():
    for mode, table, choice in EVERY:
        shape = describe_section(table, choice or None, mode)
        for field in shape.fields.values():
            if not field.example or field.kind == "tables":
                continue
            document = {"mode": mode, table.partition(".")[0]: {}}
            path = f"{table}.{field.name}"
            if table == "surface.parts":
                document["surface"] = {"law": "sum", "parts": [{}]}
                path = f"surface.parts[0].{field.name}"
            place = path.rpartition(".")[0]
            if shape.chooser:
                document = replace_value(document, f"{place}.{shape.chooser}", choice)
            value = (
                field.example == "True" if field.kind == "flag" else read_text(field.example, field)
            )
            found = find_problems(replace_value(document, path, value), HERE)
            reason = found.get(path, "")
            assert "unit" not in reason, (path, field.example, reason)
            assert "plain number" not in reason, (path, field.example, reason)


def test_a_key_may_mean_different_things_in_different_ways():
    (entry,) = (
        entry
        for entry in describe_section("sample", "maxwell", "tapping-cycle").entries
        if isinstance(entry, Alternatives)
    )
    assert entry.names == (("E0", "relaxation_time"), ("E0", "viscosity"), ("G0", "viscosity"))
    assert entry.labels[0] == "E₀, relaxation time"
    assert "extension" in entry.ways[1][1].help
    assert "shear" in entry.ways[2][1].help


@pytest.mark.parametrize(
    ("table", "choice", "name", "default"),
    [
        ("surface", "dlvo", "temperature", "298.15 K"),
        ("surface", "van-der-waals-attraction", "cutoff", "165 pm"),
        ("sample", "epoxy", "poisson", "0.35"),
        ("solver", "attard", "stepper", "forward-euler"),
        ("solver", "enhanced-attard", "orthogonal", "true"),
        ("motion", "triangle", "dwell", "0 s"),
        ("motion", "triangle", "setpoint_force", ""),
    ],
)
def test_defaults_are_those_of_what_is_built(table, choice, name, default):
    assert describe_section(table, choice, "force-distance").fields[name].default == default


def test_presets_are_the_bundled_examples_and_can_run():
    assert list(read_presets()) == list_examples()
    assert read_preset_titles()["ldpe-tapping"].startswith("One tap of a 10 nm tip")
    for document in read_presets().values():
        found = foresee(document, HERE)
        assert found.problems == {}
        assert found.seconds > 0
        assert arrange(document) == document


def test_outlook_is_the_regime_and_cost_of_the_program():
    experiment = build_experiment(TAP, HERE)
    assert summarise(TAP, HERE) == regime(experiment).rows
    assert estimate_cost(TAP, HERE) == estimate_seconds(experiment)
    assert estimate_cost(read_presets()["ps-approach-curve"], HERE) > 10 * estimate_cost(TAP, HERE)
    assert estimate_cost({**TAP, "run": {"check": True}}, HERE) == pytest.approx(
        4 * estimate_cost(TAP, HERE)
    )


@pytest.mark.parametrize(
    ("path", "value", "place", "reason"),
    [
        ("sample.E0", "2 Gpaa", "sample.E0", "'Gpaa' is not a known unit"),
        ("sample.E0", "a: b = c: d", "sample.E0", "must be a modulus"),
        ("sample.E0", "1 MPa", "sample.E_inf", "must be at most sample.E0 = '1 MPa'"),
        ("sample.E0", None, "sample", "give E0 and E_inf"),
        ("sample.poisson", "0,49", "sample.poisson", "must be a plain number"),
        ("tip.radius", None, "tip.radius", "missing"),
        ("tip.radus", "10 nm", "tip.radus", "did you mean 'radius'"),
        ("tip.a: b.c", "10 nm", "tip.a: b.c", "unknown key"),
        ("tip.\x07", 1, "tip.\x07", "unknown key"),
        ("tip." + "long" * 40, 1, "tip." + "long" * 40, "unknown key"),
        ("tip.shape", "con", "tip.shape", "did you mean 'cone'"),
        ("tip", 5, "tip", "must be a table"),
        ("mode", "taping-cycle", "mode", "did you mean 'tapping-cycle'"),
        ("cantilever", {"stiffness": "1 N/m"}, "cantilever", "not used"),
        ("motion", None, "motion.mean_height", "missing; must be a length"),
        ("motion.cycles", 0, "motion.cycles", "must be a whole number"),
        ("run.tolerance", 5, "run.tolerance", "must be between"),
        ("surface", {"law": "sum", "parts": [{"law": "dmt", "z0": 1}]}, "surface.parts[0].z0",
         "the unit is missing"),
    ],
)  # fmt: skip
def test_problems_name_the_field_and_the_reason(path, value, place, reason):
    table, _, key = path.partition(".")
    document = {**TAP, table: {**TAP[table], key: value} if key else value}
    document = {k: v for k, v in document.items() if v is not None}
    if key and value is None:
        del document[table][key]
    found = find_problems(document, HERE)
    assert reason in found[place]
    assert summarise(document, HERE) == ()
    assert estimate_cost(document, HERE) is None
    if path == place and value is not None:
        assert remove(document, place) == remove(TAP, place)


@pytest.mark.parametrize("name", ["../secret.csv", "/etc/passwd", "..", "a\\b.csv", "C:x.csv"])
def test_a_file_from_the_browser_has_a_plain_name(tmp_path, name):
    document = {**TAP, "tip": {"shape": "measured", "file": name}}
    (place,) = find_problems(document, tmp_path / "session")
    assert place == "tip.file"
    parts = [{"law": "tabulated", "file": name}]
    (place,) = find_problems({**TAP, "surface": {"law": "sum", "parts": parts}}, tmp_path)
    assert place == "surface.parts[0].file"


def test_files_are_found_in_the_folder_of_the_session(tmp_path):
    document = {**TAP, "tip": {"shape": "measured", "file": "tip.csv"}}
    assert "no such file" in find_problems(document, tmp_path)["tip.file"]
    heights = "\n".join(f"{r},{r * r / 20}" for r in range(0, 30, 3))
    (tmp_path / "tip.csv").write_text(f"radius (nm),height (nm)\n{heights}\n", encoding="utf-8")
    assert find_problems(document, tmp_path) == {}


def test_uploads_get_plain_names_that_are_not_taken(tmp_path):
    assert keep(tmp_path, "../../my tip.csv", b"1", 100) == "my_tip.csv"
    assert keep(tmp_path, "C:\\data\\my tip.csv", b"1", 100) == "my_tip.csv"
    assert keep(tmp_path, "my tip.csv", b"2", 100) == "2-my_tip.csv"
    assert keep(tmp_path, "...", b"3", 100) == "file.csv"
    assert keep(tmp_path, "é/" + "x" * 300 + ".csv", b"4", 100).endswith("x.csv")
    assert (tmp_path / "my_tip.csv").read_bytes() == b"1"
    assert all(path.parent == tmp_path and len(path.name) < 90 for path in tmp_path.iterdir())
    with pytest.raises(ValueError, match="is too large"):
        keep(tmp_path, "large.csv", b"x" * 101, 100)
    for number in range(4):
        with_room = number < 3
        content = bytes([number]) * 100
        if with_room:
            keep(tmp_path, "more.csv", content, 100)
        else:
            with pytest.raises(ValueError, match="exceeds the total"):
                keep(tmp_path, "more.csv", content, 100)


NUMBER = Field("n", "n", "number", "", "", True)
LIST = Field("n", "n", "list", "", "", True)
LENGTHS = Field("n", "n", "list", "", "", True, unit="m")
TEXT = Field("n", "n", "quantity", "", "", True)


@pytest.mark.parametrize(
    ("field", "text", "value"),
    [
        (NUMBER, " 0.49 ", 0.49), (NUMBER, "10", 10), (NUMBER, "1e-3", 0.001), (NUMBER, "", None),
        (NUMBER, "nan", "nan"), (NUMBER, "1e999", "1e999"), (NUMBER, "steady", "steady"),
        (LIST, "0.1, 0.2", [0.1, 0.2]), (LIST, "[1, x]", [1, "x"]), (LIST, ",", []),
        (LENGTHS, "1 us, 2 ms", ["1 us", "2 ms"]), (TEXT, "2 GPa", "2 GPa"), (TEXT, "  ", None),
    ],
)  # fmt: skip
def test_texts_stand_for_values(field, text, value):
    found = read_text(text, field)
    assert found == value
    assert type(found) is type(value)
    assert read_text(write_text(found), field) == (None if value == [] else value)


@given(st.floats(allow_nan=False, allow_infinity=False) | st.integers())
def test_numbers_survive_their_text(number):
    found = read_text(write_text(number), NUMBER)
    assert math.isclose(found, number, rel_tol=0, abs_tol=0)


def test_documents_are_changed_in_copies():
    changed = replace_value(TAP, "solver.nodes", 50)
    assert find_value(changed, "solver.nodes") == 50
    assert "solver" not in TAP
    assert replace_value({"tip": 5}, "tip.radius", "1 nm") == {"tip": {"radius": "1 nm"}}
    assert find_value(TAP, "tip.radius.deeper") is None
    assert find_value({"a": [1]}, "a[3]") is None


def test_documents_are_minimal_and_in_the_order_of_the_form():
    mixed = {
        "run": {},
        "odd": 1,
        "solver": {"nodes": 50},
        "tip": {"radius": "1 nm", "shape": "sphere"},
    }
    mixed |= {"mode": "force-distance"}
    found = arrange(mixed)
    assert list(found) == ["mode", "tip", "solver", "odd"]
    assert list(found["tip"]) == ["shape", "radius"]
    assert found["solver"] == {"name": "energy", "nodes": 50}
    assert "solver" not in arrange({**TAP, "solver": {"name": "energy"}})


def test_another_choice_keeps_what_both_have_and_remembers_the_rest():
    memory = {}
    cone = choose(TAP, shown_of(TAP, "tip"), "cone", memory)
    assert cone["tip"] == {"shape": "cone"}
    assert choose(cone, shown_of(cone, "tip"), "hyperboloid", memory)["tip"] == {
        "shape": "hyperboloid",
        "radius": "10 nm",
    }
    maxwell = choose(TAP, shown_of(TAP, "sample"), "maxwell", memory)
    assert maxwell["sample"] == {"model": "maxwell", "E0": "2 GPa", "poisson": 0.49}
    back = choose(maxwell, shown_of(maxwell, "sample"), "standard-linear-solid", memory)
    assert back == TAP
    with pytest.raises(KeyError):
        choose(TAP, shown_of(TAP, "tip"), "__class__", memory)


def test_alternatives_are_taken_one_at_a_time():
    memory = {}
    one = shown_of(TAP, "sample")
    moduli, times = one.ways
    shear = take_way(TAP, "sample", moduli, 1, memory)
    assert "E0" not in shear["sample"]
    assert "creep_time" in shear["sample"]
    assert set(list_sections(shear, {("sample", 0): 1})[1].fields) >= {"G0", "G_inf"}
    assert take_way(shear, "sample", moduli, 0, memory) == TAP
    assert "creep_time" not in take_way(TAP, "sample", times, 1, memory)["sample"]


def test_keys_of_two_alternatives_are_both_on_the_page():
    both = {**TAP, "surface": {**TAP["surface"], "work_of_adhesion": "30 mJ/m^2"}}
    one = shown_of(both, "surface")
    assert {"surface.hamaker", "surface.work_of_adhesion", "surface.z0"} == set(one.inputs)
    assert "give hamaker, or work_of_adhesion" in find_problems(both, HERE)["surface"]


def test_another_mode_takes_its_own_motion_and_lever():
    memory = {}
    curve = change_mode(TAP, "force-spectroscopy", memory)
    assert curve["motion"] == {
        "mean_height": "42.82 nm",
        "amplitude": "49.6 nm",
        "frequency": "278 kHz",
    }
    lever = replace_value(curve, "cantilever.stiffness", "28 N/m")
    assert find_problems(lever, HERE) == {}
    tap = change_mode(lever, "tapping-cycle", memory)
    assert tap == TAP
    assert change_mode(tap, "approach-curve", memory)["cantilever"] == {"stiffness": "28 N/m"}


def test_a_sum_begins_with_the_law_that_was_there():
    memory = {}
    total = choose(TAP, shown_of(TAP, "surface"), "sum", memory)
    assert total["surface"] == {"law": "sum", "parts": [TAP["surface"]]}
    assert find_problems(total, HERE) == {}
    more = add_part(total)
    assert [one.path for one in list_sections(more, {}) if "parts" in one.path] == [
        "surface.parts[0]",
        "surface.parts[1]",
    ]
    part = choose(more, shown_of(more, "surface.parts[1]"), "repulsion", memory)
    assert part["surface"]["parts"][1] == {"law": "repulsion"}
    assert choose(part, shown_of(part, "surface"), "lennard-jones", memory) == TAP
    for _ in range(50):
        more = add_part(more)
    assert len(more["surface"]["parts"]) == 20


def test_empty_fields_of_the_way_taken_are_missing():
    document = sample(model="kelvin-voigt", poisson=0.3)
    shown = list_sections(document, {("sample", 0): 2})
    found = add_missing(find_problems(document, HERE), shown, document)
    assert found == {"sample.G": MISSING, "sample.viscosity": MISSING}
    assert add_missing({}, list_sections(TAP, {}), TAP) == {}


def test_problems_have_a_place_on_the_form():
    document = sample(
        model="generalized-maxwell",
        E_inf="1 MPa",
        moduli=["1 MPa", "2 MPo"],
        relaxation_times=["1 s", "2 s"],
        poisson=0.3,
        poison=0.3,
    )
    document["tip"] = {"shape": "con"}
    at, elsewhere = place(find_problems(document, HERE), list_sections(document, {}))
    assert at["sample.moduli"].startswith("entry 2 must be a modulus")
    assert "did you mean 'cone'" in at["tip"]
    assert [path for path, _ in elsewhere] == ["sample.poison"]


values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=6), inner, max_size=3)
    ),
    max_leaves=6,
)
keys = st.sampled_from(
    ["mode", "tip", "sample", "surface", "motion", "cantilever", "solver", "run", "odd"]
)


@settings(max_examples=200, deadline=None)
@given(st.dictionaries(keys, values), st.sampled_from([*MODES, "odd"]))
def test_any_document_has_a_form(broken, mode):
    document = {**TAP, "mode": mode, **broken}
    shown = list_sections(document, {})
    found = add_missing(find_problems(document, HERE), shown, document)
    at, elsewhere = place(found, shown)
    assert bool(found) == bool(at or elsewhere)
    assert make_plan(shown, 10)["sections"]
    assert arrange(arrange(document)) == arrange(document) or "nan" in repr(document)
