"""TOML that asks for too much is refused in a bounded time."""

import time
import tomllib

import pytest

from softafm.experiment.config import (
    ConfigError,
    build_table,
    list_examples,
    parse_document,
    read_example,
    set_value,
)
from softafm.experiment.toml_text import parse, parse_apart
from softafm.files.guard import Unreadable, read_apart
from softafm.modes import MODES

LARGE = 900_000

TOO_MUCH = {
    "dotted key": (".".join("a" * (LARGE // 2)) + " = 1", "has a key of more than 16 parts"),
    "quoted key": ('"a" . ' * (LARGE // 6) + "a = 1", "has a key of more than 16 parts"),
    "table": ("[" + ".".join("a" * 17) + "]", "has a key of more than 16 parts"),
    "inline": ("x = {" + "'a'." * 17 + "a = 1}", "has a key of more than 16 parts"),
    "short keys, deep": ("[a.a.a.a.a.a.a.a.a]\nb.b.b.b.b.b.b.b.b = 1", "nested more than 16 deep"),
    "arrays": ("x = " + "[" * 17 + "]" * 17, "is nested more than 16 deep"),
    "arrays without end": ("x = " + "[" * LARGE, "is not valid TOML: nested too deeply"),
    "keys": ("".join(f"k{i} = 1\n" for i in range(70_000)), "has 70000 keys: at most 2000"),
    "tables": ("[[a]]\nb = 1\n" * 70_000, "has 70001 keys: at most 2000"),
    "values": ("x = [" + "1," * 300_000 + "]", "has 300001 values: at most 200000"),
    "number": ("x = " + "9" * LARGE, "is not valid TOML: "),
    "no key": ("a" * LARGE, "is not valid TOML: "),
    "quotes": ('"' * LARGE, "is not valid TOML: "),
}


@pytest.mark.parametrize("kind", TOO_MUCH)
def test_too_much_is_refused_soon(kind):
    text, words = TOO_MUCH[kind]
    started = time.monotonic()
    with pytest.raises(ConfigError) as caught:
        parse_document(text, "x.toml")
    assert time.monotonic() - started < 10
    assert str(caught.value).startswith("x.toml: ")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_files_hold_is_parsed_as_ever():
    for name in list_examples():
        assert parse(read_example(name)) == tomllib.loads(read_example(name))
    long = "x = '" + "a.b " * 1000 + "'\ny = [" + "1.5, " * 10_000 + "]\n" + "# e.g. this\n" * 1000
    assert parse(long) == tomllib.loads(long)
    assert parse("a.b.c.d.e.f.g = 1") == tomllib.loads("a.b.c.d.e.f.g = 1")


def test_overrides_are_as_bounded(softafm):
    with pytest.raises(ConfigError, match="must be key=value"):
        set_value({}, ".".join("a" * 50_000) + "=1")
    document = {}
    set_value(document, "tip.radius={" + "a." * 5000 + "a=1}")
    assert isinstance(document["tip"]["radius"], str)


def test_many_problems_are_told_in_a_few_lines(softafm, tmp_path):
    path = tmp_path / "x.toml"
    path.write_text("".join(f"k{i} = 1\n" for i in range(1999)))
    code, _, said = softafm("info", path)
    assert code == 2
    assert len(said.splitlines()) == 51
    assert said.splitlines()[-1] == "softafm: and 1953 more like these"


def test_long_lists_are_refused_before_their_units_are_read():
    sample = {"model": "generalized-maxwell", "E_inf": "1 Pa", "poisson": 0.4}
    sample |= {"moduli": ["1 Pa"] * 5000, "relaxation_times": ["1 s"]}
    with pytest.raises(ConfigError, match=r"moduli = .*: has 5000 entries: must have at most 1000"):
        build_table("sample", {"sample": sample}, MODES["tapping-cycle"], None)


def test_a_guard_brings_tables_and_texts_of_dates():
    text = 'a = 1\nb = [1.5, "x", true]\nc = 1979-05-27\n[d]\ne = nan\n'
    assert str(read_apart("softafm.experiment.toml_text:parse_apart", text)[0]) == str(
        parse_apart(text)[0]
    )
    assert parse_apart("c = 1979-05-27T07:32:00Z")[0] == {"c": "1979-05-27 07:32:00+00:00"}
    with pytest.raises(Unreadable, match="is not valid TOML"):
        read_apart("softafm.experiment.toml_text:parse_apart", "a = ")
