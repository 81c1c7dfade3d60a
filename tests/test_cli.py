"""The command line: what it writes, what it says, and how it fails."""

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import warnings
from functools import wraps
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import softafm as sa
from softafm.cli import main
from softafm.experiment.config import read_example
from softafm.modes import MODES

posix = pytest.mark.skipif(os.name != "posix", reason="signals and terminals of POSIX")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty current directory with the two examples in it."""
    monkeypatch.chdir(tmp_path)
    for name in ("ldpe-tapping", "attard-triangle"):
        (tmp_path / f"{name}.toml").write_text(read_example(name), encoding="utf-8")
    return tmp_path


@pytest.fixture
def wide(monkeypatch):
    """A terminal in which no row of a table is broken."""
    monkeypatch.setenv("COLUMNS", "250")


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def refused(answer):
    """Assert that the input was refused in one line without a traceback; return the line."""
    code, out, err = answer
    assert code == 2
    assert out == ""
    assert err.count("\n") == 1
    assert err.startswith("softafm: ")
    return err.removeprefix("softafm: ").strip()


# What works


def test_run_saves_the_result_and_shows_the_observables(folder, softafm):
    code, out, err = softafm("run", "ldpe-tapping.toml")
    assert (code, err) == (0, "")
    result = sa.load(folder / "ldpe-tapping.nc")
    assert float(result["virial"]) == pytest.approx(-3.4805e-17, rel=0.01)
    assert re.search(r"virial +-34\.\d+ aJ", out)
    assert re.search(r"force_max +11\.\d+ nN", out)
    assert re.search(rf"jumps +{result['jump_time'].size}\b", out)
    assert "saved ldpe-tapping.nc" in out


def test_run_takes_overrides_and_options(folder, softafm):
    code, _, _ = softafm(
        *("run", "attard-triangle.toml", "--set", "motion.speed=2um/s", "--set", "sample.E0=4GPa"),
        *("--tolerance", "0.05", "--profiles", "--solver", "energy", "--out", "slow.nc"),
    )
    assert code == 0
    result = sa.load(folder / "slow.nc")
    assert float(result["time"][-1]) == pytest.approx(40e-9 / 2e-6)
    assert result.attrs["tolerance"] == 0.05
    assert '"E0": 4000000000.0' in result.attrs["experiment"]
    assert "gap" in result


def test_a_check_is_shown_with_the_observables(folder, softafm, wide):
    code, out, err = softafm("run", "ldpe-tapping.toml", "--check")
    assert (code, err) == (0, "")
    assert re.search(r"virial +-34\.\d+ aJ.*; check [+-]0\.\d+ %", out)
    assert re.search(r"check +[+-]0\.\d+ % +largest difference from a run at tolerance 0\.001", out)
    found = json.loads(sa.load(folder / "ldpe-tapping.nc").attrs["check_differences"])
    assert "virial" in found
    assert "cycles_run" not in found


def test_a_check_that_finds_something_warns(folder, softafm, wide):
    code, out, err = softafm(
        *("run", "attard-triangle.toml", "--solver", "attard", "--set", "solver.method=explicit"),
        *("--set", "solver.steps=1000", "--set", "solver.nodes=4", "--check"),
        *("--set", "solver.stepper=runge-kutta-4", "--set", "surface.hamaker=1e-21 J"),
    )
    assert code == 0
    assert err.startswith("softafm: warning: ")
    assert err.endswith("run with steps = 2000, nodes = 8, or finer\n")
    assert "from a run with twice the steps and nodes" in out


def test_a_regularised_contact_is_shown(folder, softafm, wide):
    softafm("example", "pdms-sphere")
    short = ("pdms-sphere.toml", "--set", "surface.z0=0.3nm")
    assert "regularise" not in softafm("info", *short)[1]
    _, out, _ = softafm("info", *short, "--set", "run.regularise=8", "--set", "run.check=true")
    assert re.search(r"range +15\.\d+ nm +of the law, regularised; it was 300 pm", out)
    assert re.search(r"Tabor number, slow +8 ", out)
    assert "with a check" in out
    code, out, err = softafm("run", *short, "--regularise", "8")
    assert (code, err) == (0, "")
    assert re.search(r"range +15\.\d+ nm +of the law, regularised; it was 300 pm", out)
    slow = ("ldpe-tapping.toml", "--set", "sample.E0=20MPa", "--set", "sample.E_inf=1MPa")
    slowed = softafm("info", *slow, "--set", "run.regularise=8")[1]
    assert "crosses its cohesive length 81 times more slowly" in slowed
    _, out, _ = softafm("info", "ldpe-tapping.toml", "--set", "run.regularise=50")
    assert re.search(r"range +250 pm +of the law; a Tabor number of \S+ needs no other", out)


def tapping_by(monkeypatch, function):
    """Let a function of the test's take the place of ``tapping_cycle`` in experiments."""
    mode = MODES["tapping-cycle"]
    monkeypatch.setitem(vars(mode), "function", wraps(mode.function)(function))


def test_a_result_of_the_papers_solver_is_run_plotted_and_exported(folder, softafm):
    code, _, err = softafm(
        *("run", "attard-triangle.toml", "--solver", "attard", "--set", "solver.method=explicit"),
        *("--set", "solver.stepper=runge-kutta-4", "--set", "solver.steps=2000"),
        *("--set", "solver.nodes=35", "--set", "solver.domain=0.5um", "--out", "fixed.nc"),
        *("--set", "surface.hamaker=1e-21 J"),
    )
    assert (code, err) == (0, "")
    result = sa.load(folder / "fixed.nc")
    assert json.loads(result.attrs["solver"]) == {
        "kind": "attard",
        "nodes": 35,
        "domain": pytest.approx(0.5e-6),
        "method": "explicit",
        "steps": 2000,
        "stepper": {"kind": "runge-kutta-4"},
        "iteration_tolerance": 1e-6,
        "relaxation": None,
        "most_iterations": 100_000,
    }
    assert "tolerance" not in result.attrs
    assert result["time"].size == 2001
    assert softafm("plot", "fixed.nc")[0] == 0
    assert (folder / "fixed.png").read_bytes().startswith(b"\x89PNG")
    assert softafm("export", "fixed.nc", "--out", "fixed.csv")[0] == 0
    assert "force (N)" in (folder / "fixed.csv").read_text(encoding="utf-8")


def test_spectroscopy_is_run_plotted_and_exported(folder, softafm):
    assert softafm("example", "ldpe-spectroscopy")[0] == 0
    run = ("run", "ldpe-spectroscopy.toml", "--tolerance", "0.05")
    assert softafm(*run, "--out", "stiff.nc")[0] == 0
    code, out, err = softafm(*run, "--set", "cantilever.stiffness=2 N/m", "--out", "soft.nc")
    assert (code, err) == (0, "")
    assert re.search(r"force_max +2\.\d+ nN", out)
    assert re.search(r"jumps +2\b", out)
    assert softafm("plot", "stiff.nc", "soft.nc", "--out", "levers.png")[0] == 0
    assert softafm("export", "soft.nc", "--out", "soft.csv")[0] == 0
    lines = (folder / "soft.csv").read_text(encoding="utf-8").splitlines()
    header = next(line for line in lines if not line.startswith("#"))
    assert {"base_height (m)", "deflection (m)"} < set(header.split(","))


@pytest.mark.parametrize("name", ["attard-triangle", "ldpe-spectroscopy", "ldpe-tapping"])
def test_what_is_exported_is_a_motion_to_run_again(folder, softafm, name):
    softafm("example", name, "--force")
    once = ("--set", "motion.cycles=1") if name == "ldpe-tapping" else ()
    assert softafm("run", f"{name}.toml", *once, "--out", "run.nc")[0] == 0
    assert softafm("export", "run.nc", "--out", "c.csv")[0] == 0
    text = (folder / f"{name}.toml").read_text(encoding="utf-8")
    text = re.sub(r"\[motion\]\n[^\[]*", '[motion]\nshape = "trajectory"\nfile = "c.csv"\n\n', text)
    text = text.replace('"tapping-cycle"', '"force-distance"')
    (folder / "again.toml").write_text(text, encoding="utf-8")
    code, _, err = softafm("run", "again.toml", "--out", "again.nc")
    assert (code, err) == (0, "")
    first, again = (sa.load(folder / file) for file in ("run.nc", "again.nc"))
    force = np.interp(first["time"], again["time"], again["force"])
    largest = float(np.abs(first["force"]).max())
    assert np.mean(np.abs(force - first["force"].values)) < 5e-3 * largest
    assert float(again["force_min"]) == pytest.approx(float(first["force_min"]), rel=5e-3)


def test_an_approach_curve_is_run_plotted_and_exported(folder, softafm):
    assert softafm("example", "ps-approach-curve")[0] == 0
    run = ("run", "ps-approach-curve.toml", "--tolerance", "0.05", "--set", "motion.points=4")
    assert "run.profiles = True: not used" in refused(softafm(*run, "--profiles"))
    code, out, err = softafm(*run)
    assert (code, err) == (0, "")
    assert re.search(r"repulsive +3 of 4 +amplitudes; 3\d° to \d+°, at most 4\.\d+ aJ", out)
    assert re.search(r"jump on approach +10\.\d+ nm +10\.\d+ nm to 11\.\d+ nm, 13\d° to 6\d°", out)
    assert re.search(r"jump on retract +13\.\d+ nm", out)
    assert softafm("plot", "ps-approach-curve.nc")[0] == 0
    assert (folder / "ps-approach-curve.png").read_bytes().startswith(b"\x89PNG")
    assert "holds no surface profiles" in refused(
        softafm("plot", "ps-approach-curve.nc", "--profiles")
    )
    assert softafm("export", "ps-approach-curve.nc", "--out", "sweep.csv")[0] == 0
    lines = (folder / "sweep.csv").read_text(encoding="utf-8").splitlines()
    header = next(line for line in lines if not line.startswith("#"))
    assert header.startswith("sweep_height (m),approach_amplitude (m),approach_phase (degree),")


def test_plot_draws_one_or_several(folder, softafm):
    softafm("run", "attard-triangle.toml", "--tolerance", "0.05")
    assert softafm("plot", "attard-triangle.nc")[0] == 0
    assert (folder / "attard-triangle.png").read_bytes().startswith(b"\x89PNG")
    two = ("plot", "attard-triangle.nc", "attard-triangle.nc", "--out", "two.pdf")
    assert softafm(*two)[0] == 0
    assert (folder / "two.pdf").read_bytes().startswith(b"%PDF")


def test_export_writes_a_curve_other_programs_read(folder, softafm):
    softafm("run", "attard-triangle.toml", "--tolerance", "0.05")
    assert softafm("export", "attard-triangle.nc", "--out", "curve.csv")[0] == 0
    lines = (folder / "curve.csv").read_text(encoding="utf-8").splitlines()
    header = next(line for line in lines if not line.startswith("#"))
    assert "force (N)" in header.split(",")


def test_info_shows_the_regime_without_running(folder, softafm):
    before = names(folder)
    code, out, err = softafm("info", "ldpe-tapping.toml")
    assert (code, err) == (0, "")
    assert re.search(r"Tabor number, slow +3\.35", out)
    assert re.search(r"work of adhesion +31\.83 mJ/m²", out)
    assert re.search(r"creep time +100 ns", out)
    assert "JKR" in out
    assert "expected cost" in out
    assert names(folder) == before


def test_run_shows_its_audit_and_info_that_a_run_would_end_in_contact(folder, softafm):
    softafm("example", "ldpe-spectroscopy")
    soft = ("--set", "cantilever.stiffness=0.05 N/m")
    code, out, _ = softafm("info", "ldpe-spectroscopy.toml", *soft)
    assert code == 0
    assert re.search(r"end of the motion +20 nm +the tip parts at about \d\d nm: start there", out)
    code, out, err = softafm("run", "ldpe-spectroscopy.toml", *soft, "--out", "stuck.nc")
    assert code == 0
    assert re.search(r"audit +failed +signs, bounds and the end; energy balanced to", out)
    assert "still in contact at the end" in err
    code, out, err = softafm("run", "ldpe-spectroscopy.toml", "--out", "parted.nc")
    assert (code, err) == (0, "")
    assert re.search(r"audit +passed", out)


@pytest.mark.parametrize(
    ("settings", "cost", "reason"),
    [
        (["name=energy"], "under 1 s", "the edge crosses at most [0-9.]+ cohesive"),
        (["name=attard"], "under 1 s", "10000 steps of 70 nodes"),
        (["name=attard", "nodes=140", "method=explicit"], "seconds", "10000 steps of 140 nodes"),
        (["name=attard", "nodes=140", "steps=50000"], "seconds", "50000 steps of 140 nodes"),
        (["name=enhanced-attard"], "under 1 s", "10000 steps of 70 nodes"),
        (["name=enhanced-attard", "steps=100000"], "seconds", "100000 steps of 70 nodes"),
        (["name=enhanced-attard", "steps=10000000"], "minutes", "10000000 steps of 70 nodes"),
    ],
)
def test_info_tells_the_cost_of_the_chosen_solver(folder, softafm, settings, cost, reason):
    overrides = [word for key in settings for word in ("--set", f"solver.{key}")]
    code, out, _ = softafm("info", "ldpe-tapping.toml", *overrides)
    assert code == 0
    assert re.search(rf"expected cost +{cost} +{reason}", out)


@pytest.mark.parametrize(
    ("stiffness", "shown", "words"),
    [("28.1 N/m", r"28\.1 N/m", "the lever is stiffer"), ("40 pN/nm", "40 mN/m", "snaps in")],
)
def test_info_compares_the_lever_with_the_attraction(softafm, folder, stiffness, shown, words):
    softafm("example", "ldpe-spectroscopy")
    info = ("info", "ldpe-spectroscopy.toml", "--set", f"cantilever.stiffness={stiffness}")
    code, out, err = softafm(*info)
    assert (code, err) == (0, "")
    assert re.search(rf"lever stiffness +{shown}", out)
    assert re.search(rf"steepest attraction +8\.211 N/m +undeformed; .*{words}", out)
    assert re.search(r"contact stiffness +2\.465 N/m", out)
    assert "lever unbent" in out


def test_info_on_an_approach_curve(softafm, folder):
    softafm("example", "ps-approach-curve")
    code, out, err = softafm("info", "ps-approach-curve.toml")
    assert (code, err) == (0, "")
    assert re.search(r"lowest tip height +-467\.9 pm +of a tap: Hertz against the drive", out)
    assert re.search(r"free amplitude +15 nm +driven at 1 of the resonance, Q = 429\.5", out)
    assert re.search(r"force of the drive +981\.4 pN", out)  # k A0 / Q
    assert re.search(r"largest dissipation +11\.56 aJ", out)  # π k A0² / 4Q
    assert re.search(r"time of the tap +3\.597 µs", out)
    assert re.search(r"creep time +100 ns +0\.028 of the tap: viscoelastic", out)
    assert re.search(r"expected cost +under 1 s +some 80 taps; the edge crosses", out)
    fixed = ("--set", "solver={name='attard', steps=100000}")
    off = ("--set", "motion.drive_frequency=280kHz")
    code, out, _ = softafm("info", "ps-approach-curve.toml", *fixed, *off)
    assert code == 0
    assert re.search(r"driven at 1\.007 of the resonance", out)
    assert re.search(r"expected cost +minutes +some 80 taps; 100000 steps of 70 nodes", out)


@pytest.mark.parametrize(
    ("modulus", "regime"), [("100 GPa", "stiff (DMT)"), ("0.1 MPa", "soft (JKR)")]
)
def test_info_names_the_regime(softafm, folder, modulus, regime):
    sample = f"sample={{model='elastic', E='{modulus}', poisson=0.3}}"
    code, out, _ = softafm("info", "ldpe-tapping.toml", "--set", sample)
    assert code == 0
    assert regime in out


MELT = "sample={model='maxwell', E0='1 GPa', viscosity='1 kPa s', poisson=0.4}"
POWER_LAW = "sample={model='power-law', E1='1 MPa', exponent=0.3, poisson=0.5, window="
WALL = "surface={law='repulsion', pressure_at_zero='100 MPa', decay='1 nm'}"


@pytest.mark.parametrize(
    ("override", "rows"),
    [
        (MELT, [r"Tabor number, slow +flows", r"cohesive length, slow +flows",
                r"viscosity +1 kPa s +in tension, 357\.1 Pa s in shear",
                r"Young's modulus +1 GPa +maxwell; 125 kPa after the motion",
                r"JKR, at 595\.2 MPa as flow sets in"]),
        (WALL, [r"work of adhesion +0 J/m² +repulsion: no adhesion", r"without adhesion, slow",
                r"expected cost +under 1 s +no tension zone"]),
        ("sample={model='epoxy'}", [r"creep times +24 elements +102\.2 ns to 105\.5 ks"]),
        ("sample={model='elastic', E='1 GPa', poisson=0.3}", [r"modulus +1 GPa +elastic *\n"]),
        (POWER_LAW + "['1 us', '1 ms']}", [r"\d elements .*the motion outlasts it",
                                           r"of the elements"]),
        (POWER_LAW + "['1 us', '1 s']}", [r"represented .*elements +to 0\.\d+ %, from 1 µs to "
                                          r"1 s\b"]),
        (POWER_LAW + "['1 s', '10 s']}", [r"ends before"]),
        ("tip={shape='cone', half_angle='20 deg', apex_radius='10 nm'}",
         [r"effective radius +9\.75 nm +of the cone"]),
        ("tip.radius=5 um", [r"tip radius +5 µm +paraboloid"]),
    ],
)  # fmt: skip
def test_info_on_every_kind_of_contact(folder, softafm, monkeypatch, override, rows):
    monkeypatch.setenv("COLUMNS", "150")
    code, out, err = softafm("info", "attard-triangle.toml", "--set", override)
    assert (code, err) == (0, "")
    assert not re.search(r"\b(nan|inf)\b", out)
    for row in rows:
        assert re.search(row, out)


@pytest.mark.parametrize("override", [MELT, WALL])
def test_info_compares_any_lever_with_any_contact(folder, softafm, override):
    softafm("example", "ldpe-spectroscopy")
    code, out, _ = softafm("info", "ldpe-spectroscopy.toml", "--set", override)
    assert code == 0
    stiffness = r"9\.712 N/m +2·E·a, at 595" if override == MELT else r"1\.861 N/m +2·E·a, slow"
    assert re.search(rf"contact stiffness +{stiffness}", out)
    assert ("the law only repels" in out) == (override == WALL)


@pytest.mark.parametrize(
    ("name", "steady"),
    [("ps-approach-curve", ()), ("ldpe-tapping", ("--set", "motion.cycles=steady"))],
)
def test_info_refuses_flow_that_never_becomes_steady(folder, softafm, name, steady):
    softafm("example", name)
    line = refused(softafm("info", f"{name}.toml", "--set", MELT, *steady))
    assert "the sample 'maxwell' flows" in line


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_show_draws_what_touches(folder, softafm, suffix):
    before = names(folder)
    out = () if suffix == "png" else ("--out", f"attard-triangle-contact.{suffix}")
    code, said, err = softafm("show", "attard-triangle.toml", "--set", MELT, *out)
    assert (code, err) == (0, "")
    assert said == f"saved attard-triangle-contact.{suffix}\n"
    assert names(folder) == sorted([*before, f"attard-triangle-contact.{suffix}"])
    beginning = {"png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml"}[suffix]
    assert (folder / f"attard-triangle-contact.{suffix}").read_bytes().startswith(beginning)


def test_a_motion_longer_than_the_window_of_a_sample_is_told(folder, softafm):
    window = POWER_LAW + "['1 us', '1 ms']}"
    code, _, err = softafm("run", "attard-triangle.toml", "--tolerance", "0.05", "--set", window)
    assert code == 0
    assert err.startswith("softafm: warning: the motion lasts 0.008 s, but the sample 'power-law'")


def test_each_mode_warns_its_caller_of_a_window_too_short():
    law = sa.PowerLaw(1e8, 0.3, (1e-7, 1e-6), 0.5)
    contact = sa.Contact(sa.Paraboloid(1e-8), law, sa.LennardJones(1e-20, 0.3e-9))
    ramp = sa.Triangle(2e-9, 0.2e-9, 1e-3)
    for run in (
        lambda: sa.force_distance(contact, ramp, tolerance=0.1),
        lambda: sa.force_spectroscopy(contact, sa.Cantilever(10.0), ramp, tolerance=0.1),
        lambda: sa.tapping_cycle(contact, 2e-9, 2.2e-9, 3e5, cycles=1, tolerance=0.1),
    ):
        with pytest.warns(sa.AccuracyWarning, match=r"^the motion lasts 3.*e-06 s") as warned:
            run()
        assert [Path(warning.filename).name for warning in warned] == ["test_cli.py"]


def test_example_lists_and_writes(tmp_path, monkeypatch, softafm):
    monkeypatch.chdir(tmp_path)
    code, out, _ = softafm("example")
    assert code == 0
    for name in ("attard-triangle", "ldpe-spectroscopy", "ldpe-tapping"):
        assert re.search(rf"^{name} +\w.*", out, re.MULTILINE)
    assert names(tmp_path) == []
    assert softafm("example", "ldpe-tapping")[0] == 0
    assert softafm("example", "ldpe-tapping", "--out", "mine.toml")[0] == 0
    assert names(tmp_path) == ["ldpe-tapping.toml", "mine.toml"]
    assert (tmp_path / "mine.toml").read_text(encoding="utf-8") == read_example("ldpe-tapping")


def test_version_and_help(softafm):
    assert softafm("--version")[:2] == (0, f"softafm {sa.__version__}\n")
    assert softafm("run", "--help")[0] == 0
    code, out, _ = softafm("--help")
    assert code == 0
    assert all(command in out for command in ("run", "example", "plot", "show", "info", "export"))
    assert softafm()[:2] == (0, out)


# Existing and unwritable outputs


@pytest.mark.parametrize(
    ("command", "out"),
    [
        (("run", "ldpe-tapping.toml"), "ldpe-tapping.nc"),
        (("run", "ldpe-tapping.toml"), "other.nc"),
        (("plot", "result.nc"), "result.png"),
        (("show", "ldpe-tapping.toml"), "ldpe-tapping-contact.png"),
        (("export", "result.nc"), "curve.csv"),
        (("example", "ldpe-tapping"), "ldpe-tapping.toml"),
    ],
)
def test_an_existing_output_needs_force(folder, softafm, command, out):
    softafm("run", "ldpe-tapping.toml", "--tolerance", "0.05", "--out", "result.nc")
    command = (*command, "--out", out)
    (folder / out).write_bytes(b"precious")
    before = names(folder)
    assert refused(softafm(*command)).startswith(f"--out = {out}: exists")
    assert (folder / out).read_bytes() == b"precious"
    assert softafm(*command, "--force")[0] == 0
    assert (folder / out).read_bytes() != b"precious"
    assert names(folder) == before


@pytest.mark.parametrize("out", ["nowhere/result.nc", "ldpe-tapping.toml/result.nc"])
def test_an_unwritable_output_is_refused_before_the_run(folder, softafm, monkeypatch, out):
    tapping_by(monkeypatch, lambda *_, **__: pytest.fail("it ran"))
    assert "cannot write there" in refused(softafm("run", "ldpe-tapping.toml", "--out", out))


@pytest.fixture
def users_folder(monkeypatch):
    """An experiment in a folder of an ordinary user, as whom the test then runs."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o777)
        config = folder / "ldpe-tapping.toml"
        config.write_text(read_example("ldpe-tapping"), encoding="utf-8")
        config.chmod(0o644)
        monkeypatch.chdir(folder)
        root = os.getuid() == 0
        if root:
            os.setresuid(65534, 65534, 0)
        yield folder
        if root:
            os.setresuid(0, 0, 0)
        monkeypatch.undo()


@posix
def test_a_write_protected_folder_and_file_are_refused(users_folder, softafm):
    (users_folder / "old.nc").write_bytes(b"precious")
    (users_folder / "old.nc").chmod(0o400)
    line = refused(softafm("run", "ldpe-tapping.toml", "--out", "old.nc", "--force"))
    assert "write-protected" in line
    (users_folder / "locked").mkdir(mode=0o500)
    line = refused(softafm("run", "ldpe-tapping.toml", "--out", "locked/new.nc"))
    assert "cannot write there" in line


@posix
def test_a_dangling_link_is_an_existing_output(folder, softafm):
    (folder / "link.nc").symlink_to(folder / "gone.nc")
    assert "exists" in refused(softafm("run", "ldpe-tapping.toml", "--out", "link.nc"))
    assert softafm("run", "ldpe-tapping.toml", "--out", "result.nc")[0] == 0
    result = sa.load(folder / "result.nc")
    with pytest.raises(FileExistsError):
        sa.save(result, folder / "link.nc")
    assert (folder / "link.nc").is_symlink()


def test_a_folder_or_a_wrong_suffix_is_no_output(folder, softafm):
    (folder / "folder.nc").mkdir()
    run = ("run", "ldpe-tapping.toml", "--force", "--out")
    assert "is not a file" in refused(softafm(*run, "folder.nc"))
    assert "must end in .nc" in refused(softafm(*run, "ldpe-tapping.toml"))
    assert "must end in .nc" in refused(softafm(*run, "curve.csv"))


# Bad input


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("run", "none.toml"), "none.toml: no such file"),
        (("run", "."), ".: is a directory"),
        (("info", "none.toml"), "none.toml: no such file"),
        (("run", "ldpe-tapping.toml", "--set", "tip.radius=10 kg"), "tip.radius = '10 kg': must"),
        (("run", "ldpe-tapping.toml", "--set", "tip.radius"), "override 'tip.radius': must be"),
        (("run", "ldpe-tapping.toml", "--solver", "newton"), "solver.name = 'newton': must be"),
        (("run", "ldpe-tapping.toml", "--solver", "attard", "--tolerance", "0.01"),
         "run.tolerance = 0.01: the solver 'attard' takes fixed steps"),
        (("run", "ldpe-tapping.toml", "--solver", "attard", "--set", "solver.nodes=1"),
         "solver.nodes = 1: must be a whole number from 2 to 2000"),
        (("run", "ldpe-tapping.toml", "--regularise", "0"), "run.regularise = 0: must be"),
        (("run", "ldpe-tapping.toml", "--tolerance", "0"), "run.tolerance = 0: must be"),
        (("run", "ldpe-tapping.toml", "--tolerance", "nan"), "run.tolerance = nan: must be"),
        (("run", "ldpe-tapping.toml", "--tolerance", "1%"), "run.tolerance = '1%': must be"),
        (("run", "ldpe-tapping.toml", "--set", "motion.mean_height=0 nm", "--set",
          "motion.amplitude=0.1 nm"), "motion.mean_height = '0 nm': start height"),
        (("example", "ldpe"), "example 'ldpe': unknown;"),
        (("plot", "none.nc"), "none.nc: no such file"),
        (("plot", "ldpe-tapping.toml"), "ldpe-tapping.toml: is a file to be run, not a result"),
        (("plot", "none.nc", "--out", "picture.bmp"), "--out = picture.bmp: must end in .png"),
        (("export", "none.nc", "--out", "a.csv"), "none.nc: no such file"),
        (("show", "none.toml"), "none.toml: no such file"),
        (("show", "ldpe-tapping.toml", "--out", "a.bmp"), "--out = a.bmp: must end in .png"),
        (("show", "ldpe-tapping.toml", "--set", "tip.radius=1"), "tip.radius = 1: must be"),
    ],
)  # fmt: skip
def test_bad_input_is_refused_in_one_line(folder, softafm, arguments, reason):
    before = names(folder)
    assert refused(softafm(*arguments)).startswith(reason)
    assert names(folder) == before


@pytest.mark.parametrize(
    "arguments",
    [("run",), ("rnu",), ("run", "a.toml", "--frce"), ("run", "a.toml", "--out")],
)
def test_wrong_usage_is_bad_input(softafm, arguments):
    assert "see softafm --help" in refused(softafm(*arguments))


def test_different_modes_do_not_share_a_plot(folder, softafm):
    for name in ("ldpe-tapping", "attard-triangle"):
        softafm("run", f"{name}.toml", "--tolerance", "0.05")
    answer = softafm("plot", "ldpe-tapping.nc", "attard-triangle.nc", "--out", "both.png")
    assert "mode" in refused(answer)
    assert not (folder / "both.png").exists()


@given(st.lists(st.text(max_size=12), max_size=4))
@settings(max_examples=80, deadline=None)
def test_no_argument_makes_it_crash(arguments):
    assert main(["info", *arguments]) in (0, 2)


# Failures


def test_a_run_that_cannot_go_on_is_a_failure(folder, softafm):
    code, out, err = softafm("run", "ldpe-tapping.toml", "--set", "solver={name='energy', "
                             "most_steps=10}")  # fmt: skip
    assert (code, out) == (1, "")
    assert err.startswith("softafm: the run failed: ")
    assert err.count("\n") == 1
    assert not (folder / "ldpe-tapping.nc").exists()


def test_a_run_that_blows_up_is_a_failure(folder, softafm):
    before = names(folder)
    code, out, err = softafm(
        *("run", "ldpe-tapping.toml", "--solver", "attard", "--set", "solver.method=explicit"),
        *("--set", "surface.z0=0.15nm"),
    )
    assert (code, out) == (1, "")
    assert err.startswith("softafm: the run failed: blew up at t = ")
    assert err.count("\n") == 1
    assert names(folder) == before


def test_an_unforeseen_error_is_one_line_and_a_traceback_on_request(folder, softafm, monkeypatch):
    def broken(*_, **__):
        raise ArithmeticError("by zero\nin two lines")

    tapping_by(monkeypatch, broken)
    code, _, err = softafm("run", "ldpe-tapping.toml")
    assert code == 1
    assert err.startswith("softafm: ArithmeticError: by zero in two lines")
    assert err.count("\n") == 1
    monkeypatch.setenv("SOFTAFM_TRACEBACK", "1")
    with pytest.raises(ArithmeticError):
        main(["run", "ldpe-tapping.toml"])


def test_doubtful_accuracy_is_said_in_one_line(folder, softafm, monkeypatch):
    honest = sa.tapping_cycle

    def doubtful(*arguments, **options):
        warnings.warn("the mesh is\ntoo coarse", sa.AccuracyWarning, stacklevel=1)
        return honest(*arguments, **options)

    tapping_by(monkeypatch, doubtful)
    code, _, err = softafm("run", "ldpe-tapping.toml")
    assert (code, err) == (0, "softafm: warning: the mesh is too coarse\n")


@pytest.fixture
def heard_interrupts():
    """Interrupts are heard, which a shell lets its background jobs ignore."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@posix
@pytest.mark.usefixtures("heard_interrupts")
@pytest.mark.parametrize("lost_as", [None, TypeError("missing argument")])
def test_an_interrupt_that_compiled_code_swallows_still_ends_the_run(
    folder, softafm, monkeypatch, lost_as
):
    """numba loses an interrupt that falls between Python and compiled code (once in 60 here)."""

    def numb(*_, progress, **__):
        with contextlib.suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        if lost_as is not None:
            raise lost_as
        progress(0.5, "going on")
        pytest.fail("it went on")

    tapping_by(monkeypatch, numb)
    before = names(folder)
    code, _, err = softafm("run", "ldpe-tapping.toml")
    assert (code, err) == (1, "softafm: interrupted, nothing written\n")
    assert names(folder) == before


# As its own process

CALL = [sys.executable, "-c", "import sys; from softafm.cli import main; sys.exit(main())"]


def test_exit_codes_of_the_process(folder):
    good = subprocess.run([*CALL, "info", "ldpe-tapping.toml"], capture_output=True, text=True)
    assert (good.returncode, good.stderr) == (0, "")
    bad = subprocess.run([*CALL, "info", "none.toml"], capture_output=True, text=True)
    assert (bad.returncode, bad.stdout) == (2, "")
    assert bad.stderr == "softafm: none.toml: no such file\n"


def test_importing_the_package_reads_nothing_heavy():
    heavy = "{'pydantic', 'pint', 'matplotlib', 'scipy', 'numba', 'xarray'}"
    code = f"import sys, softafm, softafm.cli; print({heavy} & {{*sys.modules}})"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout == "set()\n"


def test_running_and_informing_import_neither_dask_nor_pint(tmp_path):
    assert all(map(find_spec, ("dask", "pint")))  # or there would be nothing to find
    code = """
import sys
from softafm.cli import main

for name in ("attard-triangle", "ldpe-movie", "ps-approach-curve"):
    main(["example", name])
    assert main(["info", f"{name}.toml"]) == 0
    assert main(["run", f"{name}.toml"]) == 0
assert main(["show", "attard-triangle.toml"]) == 0
print({name.partition(".")[0] for name in sys.modules} & {"dask", "distributed", "pint", "zarr"})
"""
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert run.stdout.splitlines()[-1] == "set()"


@posix
def test_an_interrupted_run_says_so_and_leaves_nothing(folder):
    before = names(folder)
    master, terminal = os.openpty()
    command = [*CALL, "run", "ldpe-tapping.toml", "--tolerance", "1e-4", "--set"]
    process = subprocess.Popen(
        [*command, "motion.cycles=100000"],
        stdout=subprocess.PIPE,
        stderr=terminal,
        # A shell's background job ignores Ctrl-C, and so would its children.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    os.close(terminal)
    said = b""
    with process, os.fdopen(master, "rb", buffering=0) as screen:
        try:
            while b"%" not in said:
                said += screen.read(1000)
            process.send_signal(signal.SIGINT)
            process.wait(timeout=60)
            while chunk := screen.read(1000):
                said += chunk
        except OSError:  # how Linux reports the end of a terminal
            pass
        finally:
            process.kill()
        out = process.stdout.read()
    assert process.returncode == 1
    assert out == b""
    assert b"softafm: interrupted, nothing written" in said
    assert b"Traceback" not in said
    assert names(folder) == before
