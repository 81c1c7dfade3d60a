"""Names that are not known: which known one they are taken for, in files and on the way there."""

from pathlib import Path

import pytest

from softafm.checks.refusals import ConfigError
from softafm.checks.suggestions import guess
from softafm.experiment import schema
from softafm.experiment.config import build_experiment, parse_document, read_example
from softafm.modes import MODES

MODELS = list(schema.CHOICES["sample"][1])
LAWS = list(schema.CHOICES["surface"][1])
SHAPES = list(schema.CHOICES["tip"][1])
TABLES = ["mode", "tip", "sample", "surface", "motion", "cantilever", "solver", "run"]
LEVER = list(schema.ResonatorTable.model_fields)
TAP = list(schema.TapMotion.model_fields)


@pytest.mark.parametrize(
    ("given", "valid", "expected"),
    [
        ("lever", TABLES, ["cantilever"]),
        ("probe", TABLES, ["tip"]),
        ("indenter", TABLES, ["tip"]),
        ("law", TABLES, ["surface"]),
        ("force", TABLES, ["surface"]),
        ("adhesion", TABLES, ["surface"]),
        ("material", TABLES, ["sample"]),
        ("specimen", TABLES, ["sample"]),
        ("substrate", TABLES, ["sample"]),
        ("drive", TABLES, ["motion"]),
        ("oscillation", TABLES, ["motion"]),
        ("ramp", TABLES, ["motion"]),
        ("Tip", TABLES, ["tip"]),
        ("smaple", TABLES, ["sample"]),
        ("rnu", TABLES, ["run"]),
        ("PDMS", MODELS, ["pdms"]),
        ("pmds", MODELS, ["pdms"]),
        ("SLS", MODELS, ["standard-linear-solid"]),
        ("Standard_Linear_Solid", MODELS, ["standard-linear-solid"]),
        ("prony", MODELS, ["generalized-maxwell"]),
        ("PS", MODELS, ["polystyrene"]),
        ("poly", MODELS, ["polystyrene", "polyisobutylene"]),
        ("DMT", LAWS, ["dmt"]),
        ("LJ", LAWS, ["lennard-jones"]),
        ("lenard jones", LAWS, ["lennard-jones"]),
        ("vdW", LAWS, ["van-der-waals"]),
        ("Bead", SHAPES, ["sphere"]),
        ("parabolic", SHAPES, ["paraboloid"]),
        ("punch", SHAPES, ["flat-punch"]),
        ("spring_constant", LEVER, ["stiffness"]),
        ("k", LEVER, ["stiffness"]),
        ("Q", LEVER, ["quality_factor"]),
        ("f0", LEVER, ["frequency"]),
        ("A", TAP, ["amplitude"]),
        ("Z", TAP, ["mean_height"]),
        ("nu", ["E", "poisson"], ["poisson"]),
        ("modulus", ["E", "poisson"], ["E"]),
        ("E", ["E0", "E_inf", "poisson"], ["E0"]),
        ("R", ["radius", "shape"], ["radius"]),
        ("tapping", list(MODES), ["tapping-cycle"]),
        ("xyz", MODELS, []),
        ("", MODELS, []),
        ("x" * 1000, MODELS, []),
    ],
)
def test_what_is_meant(given, valid, expected):
    assert guess(given, valid) == expected


def test_every_other_word_leads_to_a_name_that_exists():
    names = {name for _, choices in schema.CHOICES.values() for name in choices}
    names |= {chooser for chooser, _ in schema.CHOICES.values()} | {*schema.KEYS, *TABLES, "map"}
    tables = [t for _, choices in schema.CHOICES.values() for t in choices.values()]
    tables += [t for mode in MODES.values() for t in schema.motions_of(mode).values()]
    tables += [schema.ResonatorTable, schema.Run]
    names |= {"iterative"}
    names |= {key for table in tables for key in table.model_fields}
    names |= {*MODES, "tapping-map", "force-volume", "setpoint", "drive_frequency"}
    from softafm.checks.suggestions import _OTHER_WORDS

    assert set(_OTHER_WORDS) <= names


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("[sample]", "[specimen]", "specimen: unknown key; did you mean 'sample'?"),
        ("radius", "R", "tip.R: unknown key; did you mean 'radius'?"),
        ('"paraboloid"', '"Parabola"', "tip.shape = 'Parabola': did you mean 'paraboloid'?"),
        ('"49.6 nm"', '"49,6 nm"', "motion.amplitude = '49,6 nm': must be a length with its unit, "
         "such as '10 nm'; did you mean '49.6 nm'?"),
    ],
)  # fmt: skip
def test_files_are_refused_with_what_was_meant(old, new, line):
    text = read_example("ldpe-tapping")
    assert old in text
    with pytest.raises(ConfigError) as refused:
        build_experiment(parse_document(text.replace(old, new), "file"), Path())
    assert any(each.startswith(line) for each in str(refused.value).splitlines())
