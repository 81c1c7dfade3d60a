"""What a user takes away reproduces the run: to the last bit, by every way that is offered."""

import shlex
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

import softafm as sa
from softafm.app import take_away
from softafm.checks.refusals import ConfigError
from softafm.cli import main
from softafm.experiment import config

SPHERE = {"shape": "sphere", "radius": "20 nm"}
RUBBER = {"model": "elastic", "E": "50 MPa", "poisson": 0.5}
CARBON = {"law": "lennard-jones", "hamaker": "1e-19 J", "z0": "0.3 nm"}
RAMP = {"start": "5 nm", "turn": "1 nm", "speed": "1 um/s"}


def force_curve(**tables):
    parts = {"tip": SPHERE, "sample": RUBBER, "surface": CARBON, "motion": RAMP}
    return {"mode": "force-distance", **parts, **tables}


WITH_FILES = {
    "tip.csv": "radius (nm),height (nm)\n0,0\n2,0.1\n4,0.4\n8,1.6\n16,6.4\n",
    "law.csv": "gap (nm),pressure (MPa)\n0.2,90\n0.3,0\n0.4,-20\n0.8,-4\n2,-0.2\n",
    "moduli.csv": "frequency (Hz),storage (MPa),loss (MPa)\n1,10,2\n10,14,4\n100,20,6\n1000,28,7\n",
    "motion.csv": "time (us),height (nm)\n0,5\n1,3\n2,1.5\n3,3\n4,5\n",
    "curve.csv": "time (us),tip_height (nm),base_height (nm)\n0,5,5\n1,2,1.5\n2,5,5\n",
    "record.csv": "time (us),height (nm)\n"
    + "".join(
        f"{k},{1.5 + abs(k - 20) / 5 + noise:.3f}\n"
        for k, noise in enumerate(np.random.default_rng(1).normal(0, 0.02, 41))
    ),
}

DOCUMENTS = {
    "named sample": force_curve(sample={"model": "epoxy", "poisson": 0.3}),
    "named sample with options": force_curve(sample={"model": "pdms", "mixing_ratio": 20}),
    "many terms": force_curve(
        sample={
            "model": "generalized-maxwell",
            "E_inf": "3 MPa",
            "moduli": ["1 MPa"] * 12,
            "relaxation_times": [f"{k} us" for k in range(1, 13)],
            "poisson": 0.4,
        }
    ),
    "one term": force_curve(
        sample={
            "model": "generalized-maxwell",
            "E_inf": "3 MPa",
            "moduli": ["0.1 GPa"],
            "relaxation_times": ["1 us"],
            "poisson": 0.4,
        }
    ),
    "another constructor": force_curve(
        surface={"law": "lennard-jones", "work_of_adhesion": "30 mJ/m^2", "z0": "0.3 nm"}
    ),
    "a sum": force_curve(
        surface={
            "law": "sum",
            "parts": [
                {"law": "lennard-jones", "hamaker": "1e-20 J", "z0": "0.3 nm"},
                {"law": "repulsion", "pressure_at_zero": "1 MPa", "decay": "1 nm"},
            ],
        }
    ),
    "a power law": force_curve(
        sample={
            "model": "power-law",
            "E1": "20 MPa",
            "reference_time": "1 us",
            "exponent": 0.2,
            "poisson": 0.5,
            "window": ["1 ns", "0.1 s"],
        }
    ),
    "a wave": force_curve(
        motion={"mean_height": "5 nm", "amplitude": "4 nm", "frequency": "1 kHz", "dwell": "1 us"}
    ),
    "a solver of fixed steps": {
        **config.parse_document(config.read_example("attard-triangle"), ""),
        "solver": {
            "name": "attard",
            "method": "explicit",
            "steps": 1000,
            "nodes": 50,
            "stepper": "adams-bashforth-3",
        },
        "motion": {"start": "10 nm", "turn": "4 nm", "speed": "5 um/s"},
        "run": {},
    },
    "options": force_curve(run={"tolerance": 0.05, "profiles": True, "regularise": 1.5}),
    "files": {
        "mode": "force-distance",
        "tip": {"shape": "measured", "file": "tip.csv"},
        "sample": {"model": "measured-moduli", "file": "moduli.csv", "poisson": 0.5},
        "surface": {"law": "tabulated", "file": "law.csv"},
        "motion": {"shape": "trajectory", "file": "motion.csv"},
    },
    **{
        f"a motion from a file, {how}": force_curve(
            motion={"shape": "trajectory", "file": name, **keys}
        )
        for how, name, keys in (
            ("smooth", "motion.csv", {"smooth": True}),
            ("measured", "record.csv", {"measured": True}),
            ("of known noise", "record.csv", {"measured": True, "noise": "0.02 nm"}),
        )
    },
    "a motion of the base from a file": {
        **force_curve(motion={"shape": "trajectory", "file": "curve.csv"}),
        "mode": "force-spectroscopy",
        "cantilever": {"stiffness": "10 N/m"},
    },
    "listed ratios": {
        **config.parse_document(config.read_example("ps-approach-curve"), ""),
        "motion": {
            "free_amplitude": "15 nm",
            "amplitude_ratio": [0.9, 0.5],
            "drive_frequency": "277 kHz",
        },
    },
}
DOCUMENTS |= {
    name: config.parse_document(config.read_example(name), name) for name in config.list_examples()
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for name, text in WITH_FILES.items():
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(document, folder):
    return config.build_experiment(document, folder).run()


def executed(lines):
    """Run lines as a user would, and return what they call result."""
    found = {}
    exec(compile(lines, "lines", "exec"), found)
    return found["result"]


def assert_same(found, expected):
    """The same to the last bit, and made of the same, but for when."""
    xr.testing.assert_equal(found, expected)
    for name in ("experiment", "solver"):
        assert found.attrs[name] == expected.attrs[name]


@pytest.mark.parametrize("name", DOCUMENTS)
# The ramp ends in contact, on purpose.
@pytest.mark.filterwarnings("ignore:audit. the tip is still in contact:softafm.AccuracyWarning")
def test_the_python_lines_reproduce_the_run(name, folder):
    lines = take_away.write_python(DOCUMENTS[name], folder)
    assert_same(executed(lines), run(DOCUMENTS[name], folder))
    assert max(map(len, lines.splitlines())) <= 100


def test_the_python_lines_read_as_if_written_by_hand(folder):
    lines = take_away.write_python(DOCUMENTS["ldpe-tapping"], folder)
    assert lines == (
        "import softafm as sa\n\n"
        "tip = sa.Paraboloid(radius=1e-8)\n"
        "sample = sa.StandardLinearSolid(E0=2e9, E_inf=1e8, creep_time=1e-7, poisson=0.49)\n"
        "surface = sa.LennardJones(hamaker=1e-19, z0=2.5e-10)\n"
        "contact = sa.Contact(tip=tip, sample=sample, surface=surface)\n"
        "result = sa.tapping_cycle(\n"
        "    contact,\n"
        "    amplitude=4.96e-8,\n"
        "    mean_height=4.282e-8,\n"
        "    frequency=2.78e5,\n"
        "    cycles=1,\n"
        ")\n"
    )


def test_python_lines_of_a_bad_document_are_refused(folder):
    with pytest.raises(ConfigError, match=r"tip\.radius: missing"):
        take_away.write_python(force_curve(tip={"shape": "sphere"}), folder)


def test_a_file_name_in_python_lines_is_text_and_nothing_else(folder):
    name = "tip'); import os; ('.csv"
    (folder / name).write_text(WITH_FILES["tip.csv"])
    lines = take_away.write_python(force_curve(tip={"shape": "measured", "file": name}), folder)
    assert "os" not in compile(lines, "lines", "exec").co_names
    assert executed(lines).attrs["mode"] == "force-distance"


@pytest.mark.parametrize("name", ["ldpe-tapping", "ldpe-spectroscopy", "files", "a sum"])
def test_the_command_line_reproduces_the_run(name, folder, capsys):
    document = DOCUMENTS[name]
    Path(take_away.name_file(document)).write_text(take_away.write_toml(document))
    program, *arguments = shlex.split(take_away.write_command(document))
    assert program == "softafm"
    assert main(arguments) == 0
    capsys.readouterr()
    result = Path(take_away.name_file(document)).with_suffix(".nc")
    assert_same(sa.load(result), run(document, folder))


@pytest.mark.parametrize("name", DOCUMENTS)
def test_the_experiment_file_holds_the_document(name):
    text = take_away.write_toml(DOCUMENTS[name])
    assert config.parse_document(text, name) == DOCUMENTS[name]


@pytest.mark.parametrize("mode", ["../../etc/passwd", "a b; rm -rf", None, ["x"]])
def test_a_file_is_not_named_as_a_link_says(mode):
    assert take_away.name_file({"mode": mode}) == "experiment.toml"
    assert take_away.write_command({"mode": mode}) == "softafm run experiment.toml"


@pytest.mark.parametrize("name", DOCUMENTS)
def test_a_link_holds_the_document(name):
    query = take_away.write_query(DOCUMENTS[name])
    assert take_away.read_query(query) == DOCUMENTS[name]
    assert take_away.read_query(f"?{query}") == DOCUMENTS[name]


def test_a_link_can_be_read():
    query = take_away.write_query(DOCUMENTS["ldpe-tapping"])
    assert query.startswith("mode=tapping-cycle&tip.shape=paraboloid&tip.radius=10+nm&")
    assert "sample.poisson=0.49" in query
    assert "run.profiles=false" in query


KEYS = st.text(st.characters(codec="ascii", categories=["L", "N"]), min_size=1)
PLAIN = st.one_of(
    st.text(st.characters(exclude_categories=["Cs"])),
    st.booleans(),
    st.integers(-(2**63), 2**63),
    st.floats(allow_nan=False),
)
VALUES = st.recursive(
    PLAIN,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner),
    max_leaves=5,
)


@given(st.dictionaries(KEYS, st.dictionaries(st.text(max_size=4), VALUES, max_size=4), max_size=4))
def test_a_link_holds_any_document(document):
    found = take_away.read_query(take_away.write_query(document))
    assert found == document
    assert repr(found) == repr(document)  # 1 is no 1.0, nor True


@pytest.mark.parametrize(
    ("query", "reason"),
    [
        ("tip.radius", "cannot be read"),
        ("tip.radius=%ff", "cannot be read"),
        ("tip=1&tip.radius=2", "is a value, not a table"),
        ("mode=a&mode=b", "mode more than once"),
        ("=3", "must be key=value"),
        ("&".join(f"tip.x{k}=1" for k in range(300)), "cannot be read"),
        ("tip.radius=" + "9" * 20_000, "20011 characters"),
    ],
)
def test_a_malformed_link_is_refused_in_one_line(query, reason):
    with pytest.raises(ConfigError, match=reason) as refusal:
        take_away.read_query(query)
    assert len(str(refusal.value).splitlines()) == 1


def test_a_document_too_long_for_a_link_is_refused():
    ratios = np.linspace(0.9, 0.1, 1000).tolist()
    with pytest.raises(ConfigError, match="use the TOML file"):
        take_away.write_query({"mode": "approach-curve", "motion": {"amplitude_ratio": ratios}})


def test_files_of_a_result_can_be_read_back(folder):
    result = run(DOCUMENTS["ldpe-tapping"], folder)
    Path("a.nc").write_bytes(take_away.write_netcdf(result))
    assert sa.load("a.nc").identical(result)
    rows = [line for line in take_away.write_csv(result).decode().splitlines() if line[0] != "#"]
    names, table = rows[0].split(","), np.loadtxt(rows[1:], delimiter=",")
    np.testing.assert_allclose(table[:, names.index("force (N)")], result.force, rtol=1e-8)


def test_pictures_are_of_their_kind_and_name_the_runs(folder):
    result = run(DOCUMENTS["ldpe-tapping"], folder)
    assert take_away.draw_picture([result], "png").startswith(b"\x89PNG\r\n")
    drawing = take_away.draw_picture([result, result], "svg", ["first", "second"])
    assert b"<svg" in drawing
    assert b"second" in drawing


def test_a_picture_of_different_modes_is_refused(folder):
    results = [run(DOCUMENTS[name], folder) for name in ("ldpe-tapping", "a sum")]
    with pytest.raises(ValueError, match="the same for all"):
        take_away.draw_picture(results, "png")


def test_what_is_taken_away_needs_no_panel():
    import subprocess

    code = "import sys, softafm.app.take_away; assert not {'panel', 'bokeh'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)
