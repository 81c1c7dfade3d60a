"""Examples of the documents are run, so that they cannot rot."""

import ast
import importlib
import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from own_modes import modes_restored

import softafm as sa
from softafm import rheology, surfaces, tips
from softafm.app.python_lines import write_python
from softafm.checks import validate
from softafm.draw.results import plot
from softafm.draw.summary import list_observables
from softafm.experiment import schema
from softafm.experiment.config import build_experiment, load_experiment, read_example
from softafm.experiment.regime import list_rows
from softafm.sweeps.reading import make_campaign, read_table
from softafm.units import quantities

DOCS = Path(__file__).parents[1] / "docs"
PACKAGE = Path(sa.__file__).parent


def example_module(page, folder):
    """Import the Python blocks of a page as one module (a file: compiled code is cached by it)."""
    blocks = re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.S)
    path = folder / f"{Path(page).stem}_example.py"
    path.write_text("\n".join(blocks), encoding="utf-8")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


# Extending


@pytest.fixture(scope="module")
def extending(tmp_path_factory):
    with modes_restored():
        yield example_module("extending.md", tmp_path_factory.mktemp("extending"))


RUN = sa.Triangle(start=10e-9, turn=-2e-9, speed=1e-3)
SAMPLE = sa.StandardLinearSolid(E0=2e9, E_inf=0.1e9, creep_time=1e-6, poisson=0.49)


def assert_same_curves(contact, other):
    """Equal within the tolerance: a custom law has no gaps below zero, which changes steps."""
    one, two = (sa.force_distance(each, RUN, tolerance=1e-3) for each in (contact, other))
    for name in ("force_min", "force_max", "loop_energy"):
        assert float(one[name]) == pytest.approx(float(two[name]), rel=2e-4)


def test_a_custom_law_is_the_built_in_one(extending):
    built_in = surfaces.Morse(0.05, 0.3e-9, 0.15e-9)
    gap = np.linspace(0.1e-9, 3e-9, 60)
    for name in ("pressure", "slope", "potential"):
        expected = getattr(built_in, name)(gap)
        np.testing.assert_allclose(getattr(extending.law, name)(gap), expected, rtol=1e-12)
    for name in ("work_of_adhesion", "equilibrium_gap", "gap_of_largest_tension", "range"):
        assert getattr(extending.law, name) == pytest.approx(getattr(built_in, name), rel=1e-9)
    contact = sa.Contact(sa.Paraboloid(10e-9), SAMPLE, extending.law)
    assert_same_curves(contact, replace(contact, surface=built_in))


def test_a_custom_tip_is_the_built_in_one(extending):
    built_in = tips.Hyperboloid(10e-9, np.radians(20))
    radius = np.geomspace(1e-11, 1e-7, 50)
    np.testing.assert_allclose(extending.tip.profile(radius), built_in.profile(radius), rtol=1e-12)
    contact = sa.Contact(extending.tip, SAMPLE, sa.LennardJones(1e-19, 0.3e-9))
    assert_same_curves(contact, replace(contact, tip=built_in))


def test_a_sampled_pressure_is_a_law(extending):
    law, gap = extending.solvation, np.geomspace(0.15e-9, 5e-9, 40)
    exact = np.array([extending.oscillating(h) for h in gap])
    np.testing.assert_allclose(law.pressure(gap), exact, rtol=0, atol=2e-4 * np.abs(exact).max())
    points, weights = np.polynomial.legendre.leggauss(2000)
    between = 2.75e-9 + 2.25e-9 * points
    fall = 2.25e-9 * float(weights @ law.pressure(between))
    assert float(law.potential(0.5e-9) - law.potential(5e-9)) == pytest.approx(fall, rel=1e-4)


def test_the_law_that_is_a_class_is_consistent(extending):
    law = extending.contact.surface
    gap = np.linspace(0.15e-9, 3e-9, 60)
    compiled_pressure, compiled_potential, parameters = law.compiled_pressure
    pressure, slope, potential = np.empty((3, gap.size))
    compiled_pressure(gap, parameters, pressure, slope, gap.size)
    compiled_potential(gap, parameters, potential, gap.size)

    assert pressure == pytest.approx(law.pressure(gap), rel=1e-12)
    assert potential == pytest.approx(law.potential(gap), rel=1e-12)
    step = 1e-14
    rise = (law.pressure(gap + step) - law.pressure(gap - step)) / (2 * step)
    assert slope == pytest.approx(rise, rel=1e-5, abs=1e-6 * np.abs(slope).max())
    fall = (law.potential(gap - step) - law.potential(gap + step)) / (2 * step)
    assert pressure == pytest.approx(fall, rel=1e-5, abs=1e-6 * np.abs(pressure).max())
    assert law.pressure(law.equilibrium_gap) == pytest.approx(0, abs=1e-3)

    with pytest.raises(ValueError, match="core = 5e-10 m: must be below decay = 5e-10 m"):
        replace(law, core=law.decay)
    stiff = sa.Contact(sa.Paraboloid(1e-7), sa.Elastic(1e12, poisson=0.3), law)
    curve = sa.force_distance(stiff, sa.Triangle(start=3e-9, turn=0.22e-9, speed=1e-6))
    derjaguin = -2 * np.pi * stiff.tip.radius * law.work_of_adhesion
    assert float(curve.force_min) == pytest.approx(derjaguin, rel=0.01)


def test_the_tip_that_is_a_class_meets_the_closed_form(extending):
    tip = extending.WornTip(radius=1e-6, flat=0.3e-6)
    law = sa.Repulsion(pressure_at_zero=1e10, decay=0.1e-9)
    contact = sa.Contact(tip, sa.Elastic(1e6, poisson=0.0), law)
    curve = sa.force_distance(contact, sa.Triangle(start=5e-9, turn=-0.1e-6, speed=1e-6))
    deepest = int(curve.tip_height.values.argmin())
    depth = -float(curve.axis_deformation[deepest])
    closed = sa.indentation.force(tip, depth, 1e6)
    assert float(curve.force[deepest]) == pytest.approx(closed, rel=0.01)


def test_the_sample_that_is_a_class_is_burgers_model(extending):
    burgers = extending.contact.sample
    time = np.array([0.0, 1e-5, 1e-4, 1e-3])
    creep = 1 / 2e9 + (1 - np.exp(-time / 1e-4)) / 0.5e9 + time / 1e6
    np.testing.assert_allclose(burgers.creep_compliance(time), creep, rtol=1e-12)
    E_inf, moduli, times = rheology.chain_to_prony(*burgers.compliance)
    series = rheology.GeneralizedMaxwell(E_inf, moduli, times, 0.4)
    for part, expected in zip(series.compliance, burgers.compliance, strict=True):
        np.testing.assert_allclose(part, expected, rtol=1e-10)


def test_classes_run_in_the_papers_solver_too(extending):
    motion = sa.Triangle(start=5e-9, turn=-2e-9, speed=1e-5)
    solver = sa.solvers.EnhancedAttard(steps=20_000)
    other = sa.force_distance(extending.contact, motion, solver=solver)
    for name in ("force_min", "force_max", "loop_energy"):
        assert float(extending.curve[name]) == pytest.approx(float(other[name]), rel=2e-3)


def test_the_skin_of_the_extending_page_answers_as_two_layers_do(extending):
    # Incompressible layers in the Hankel domain, at unit wavenumber: the vertical displacement w is
    # a sum of (1, z) e^(±z), the horizontal one w', the shear stress w + w'' in shear moduli, and
    # the normal one 2w' - (w''' - w').
    def rows(z, sign, modulus):
        w = [
            np.array([sign**k, sign**k * z + k * sign ** abs(k - 1)]) * np.exp(sign * z)
            for k in range(4)
        ]
        normal = modulus * (2 * w[1] - (w[3] - w[1]))
        return np.array([w[0], w[1], modulus * (w[0] + w[2]), normal])

    for ratio in (0.1, 3.0, 50.0):
        body = replace(extending.coated.sample, ratio=ratio)
        for thickness in (0.05, 0.5, 2.0):
            top = np.hstack([rows(0.0, -1, 1.0), rows(0.0, 1, 1.0)])[2:]
            skin = np.hstack([rows(thickness, -1, 1.0), rows(thickness, 1, 1.0)])
            base = rows(thickness, -1, ratio)
            system = np.vstack([np.hstack([top, np.zeros((2, 2))]), np.hstack([skin, -base])])
            found = np.linalg.solve(system, [0, 1, 0, 0, 0, 0])
            alone = np.linalg.solve(rows(0.0, -1, 1.0)[2:], [0, 1])
            answer = (found[0] + found[2]) / alone[0]
            factor = body.factor(np.array([thickness]))[0]
            assert factor == pytest.approx(answer, rel=1e-10)


def test_the_skin_of_the_extending_page_is_tapped(extending):
    tap = extending.tap
    plain = replace(extending.coated, sample=extending.rubber)
    alone = sa.tapping_cycle(plain, amplitude=20e-9, mean_height=18.5e-9, frequency=200e3)
    assert float(tap.force_max) > 1.02 * float(alone.force_max)
    lost = np.trapezoid(tap.viscous_power, tap.time) + float(tap.jump_energy.sum())
    assert lost == pytest.approx(float(tap.dissipation), rel=0.02)
    for wrong, message in (
        ({"thickness": 0.0}, "^thickness = 0 m: must be greater than 0$"),
        ({"ratio": -1.0}, "^ratio = -1: must be greater than 0$"),
        ({"sample": sa.Elastic(1e9, 0.3)}, "^sample.poisson = 0.3: must be 0.5 in a skin$"),
    ):
        with pytest.raises(ValueError, match=message):
            replace(extending.coated.sample, **wrong)


def test_the_motion_of_the_extending_page_bounces(extending):
    curve = sa.force_distance(extending.contact, extending.bounces)
    deep = curve.tip_height.values < 0
    assert np.count_nonzero(np.diff(deep.astype(int)) == 1) == 4


EXTENDING = (DOCS / "extending.md").read_text(encoding="utf-8")
RELAXING = tomllib.loads(re.search(r"```toml\n(mode = .*?)```", EXTENDING, re.S)[1])
SOFT = {
    "tip": {"shape": "paraboloid", "radius": "1 um"},
    "sample": {"model": "standard-linear-solid", "E0": "2 MPa", "E_inf": "0.5 MPa",
               "creep_time": "1 ms", "poisson": 0.5},
    "surface": {"law": "repulsion", "pressure_at_zero": "10 GPa", "decay": "0.1 nm"},
}  # fmt: skip


@pytest.fixture
def relaxing(extending):
    """The file of the page, with the tables that it leaves out."""
    return {**SOFT, **RELAXING}


def test_the_mode_of_the_extending_page_meets_the_closed_form(extending):
    """At a depth reached at once the force relaxes as E(t): E. H. Lee and J. R. M. Radok, J. Appl.
    Mech. 27, 438 (1960)."""
    sample = sa.StandardLinearSolid(E0=2e6, E_inf=0.5e6, creep_time=1e-3, poisson=0.5)
    law = sa.Repulsion(pressure_at_zero=1e10, decay=0.1e-9)
    contact = sa.Contact(sa.Paraboloid(1e-6), sample, law)
    relaxation_time = 1e-3 * 0.5e6 / 2e6
    for duration in (0.5 * relaxation_time, 8 * relaxation_time):
        held = extending.stress_relaxation(contact, 5e-9, 100e-9, 0.1, duration)
        left = float(held.force_held / held.force_on_arrival)
        assert left == pytest.approx(0.25 + 0.75 * np.exp(-duration / relaxation_time), rel=0.01)
    hertz = sa.indentation.force(contact.tip, 100e-9, 2e6 / (1 - 0.5**2))
    assert float(held.force_on_arrival) == pytest.approx(hertz, rel=0.02)


def test_the_mode_of_the_extending_page_runs_from_a_file(extending, relaxing, tmp_path):
    path = tmp_path / "relaxation.toml"
    path.write_text(
        "\n".join(f"{key} = {_inline(value)}" for key, value in relaxing.items()), encoding="utf-8"
    )
    experiment = load_experiment(path, ["motion.duration=2 ms"])
    result = experiment.run()
    same = extending.stress_relaxation(experiment.contact, 5e-9, 2e-9, 1e-5, 2e-3)
    xr.testing.assert_equal(result, same)
    assert experiment.observables()["force_held"] == float(same.force_held)
    assert [row.name for row in list_rows(experiment)][-1] == "expected cost"
    checked = extending.stress_relaxation(experiment.contact, 5e-9, 2e-9, 1e-5, check=True)
    assert set(json.loads(checked.attrs["check_differences"])) == {"force_on_arrival", "force_held"}


def test_results_of_the_extending_page_are_saved_exported_and_drawn(extending, tmp_path):
    result = extending.relaxation
    assert result.force_held.attrs == {
        "units": "N", "long_name": "force at the end of the hold"
    }  # fmt: skip
    sa.save(result, tmp_path / "relaxation.nc")
    assert sa.load(tmp_path / "relaxation.nc").identical(result)
    sa.save(result.drop_vars("force_held"), tmp_path / "spoiled.nc")
    with pytest.raises(ValueError, match="'force_held' is missing, which a result of mode 'stress"):
        sa.load(tmp_path / "spoiled.nc")
    sa.export(result, tmp_path / "relaxation.csv")
    assert "# force_held = " in (tmp_path / "relaxation.csv").read_text(encoding="utf-8")
    force, radius = plot([result, result]).axes
    assert force.get_ylabel() == "Force on the tip (nN)"
    assert radius.get_ylabel() == "Contact radius (nm)"
    assert force.lines[-2].get_ydata()[-1] == pytest.approx(1e9 * float(result.force_held))
    assert "force_held" in list_observables(result).columns[0].cells


def test_the_mode_of_the_extending_page_is_swept(extending, relaxing):
    what = {"vary": {"motion.depth": ["1 nm", "3 nm"]}}
    campaign = make_campaign(relaxing, Path(), read_table(what), from_file=True)
    found = [campaign.run(point)["force_held"] for point in campaign.points([range(2)])]
    assert campaign.observables[0].unit == "N"
    assert found[1] > 2 * found[0] > 0


def test_the_page_knows_the_mode_of_the_extending_page(extending, relaxing, monkeypatch):
    pytest.importorskip("bokeh")
    from softafm.app.curves import Shown, draw_figures
    from softafm.app.form import describe_section

    fields = describe_section("motion", None, "stress-relaxation").fields
    assert list(fields) == ["start", "depth", "speed", "duration"]
    assert fields["depth"].help == "Depth below the flat surface, m."
    assert (fields["speed"].unit, fields["speed"].default) == ("m/s", "1 µm/s")
    assert "Time" in draw_figures([Shown("held", "#000000", extending.relaxation)], "light")
    monkeypatch.setitem(sys.modules, "extending_example", extending)
    names: dict = {}
    exec(write_python(relaxing, Path()), names)
    xr.testing.assert_equal(names["result"], build_experiment(relaxing, Path()).run())


def test_the_mode_of_the_extending_page_becomes_one_of_the_program_by_a_file_and_a_line(tmp_path):
    package = tmp_path / "softafm"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    describe_section = EXTENDING.split("\n## A mode\n")[1].split("\n## ")[0]
    *blocks, _ = re.findall(r"```python\n(.*?)```", describe_section, re.S)
    (package / "modes" / "stress_relaxation.py").write_text("\n".join(blocks), encoding="utf-8")
    imported, registered = re.search(r"```text\n(.*?)```", describe_section, re.S)[1].splitlines()
    table = package / "modes" / "__init__.py"
    lines = table.read_text(encoding="utf-8")
    lines = re.sub("^from softafm.modes import .*$", imported, lines, flags=re.M)
    table.write_text(f"{lines}{registered}\n", encoding="utf-8")
    file = tmp_path / "relaxation.toml"
    file.write_text(
        "\n".join(f"{key} = {_inline(value)}" for key, value in {**SOFT, **RELAXING}.items()),
        encoding="utf-8",
    )
    done = subprocess.run(
        [sys.executable, "-m", "softafm", "info", str(file)],
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(tmp_path)}, capture_output=True,
        text=True, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("stress-relaxation, before any run")
    heavy = "{'matplotlib', 'numba', 'pydantic', 'scipy', 'xarray'}"
    look = f"import softafm, sys; assert softafm.modes.MODES; print(*{heavy} & set(sys.modules))"
    light = subprocess.run(
        [sys.executable, "-c", look], cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert light.stdout == "\n"


def test_the_lines_of_the_extending_page_make_its_law_a_choice_of_files(extending, monkeypatch):
    section = EXTENDING.split("\n## In experiment files\n")[1].split("\n## ")[0]
    lines = re.search(r"```text\n(.*?)```", section, re.S)[1]
    imported, key, law, _ = lines.splitlines()
    assert imported == "from softafm.surfaces.screened import Screened"
    with pytest.raises(ValueError, match=r"^strength of Screened: add it to KEYS of softafm/exp"):
        schema._make_table(extending.Screened)
    for name, unit in eval(f"{{{key}\n}}", vars(schema)).items():
        monkeypatch.setitem(schema.KEYS, name, unit)
    chooser, laws = schema.CHOICES["surface"]
    laws = laws | eval(f"{{{law}\n}}", {**vars(schema), "Screened": extending.Screened})
    written = {"law": "screened", "strength": "100 MPa", "decay": "0.5 nm", "core": "0.2 nm"}
    built = schema.build_choice("surface", written, chooser, laws, folder=Path())
    assert built == extending.contact.surface
    wrong = {**written, "core": "3 nm"}
    with pytest.raises(ValueError, match=r"^surface\.core = '3 nm': must be below surface\.dec"):
        schema.build_choice("surface", wrong, chooser, laws, folder=Path())


def test_the_extending_page_names_all_units_and_checks():
    section = EXTENDING.split("\n## A mode\n")[1].split("\n## ")[0]
    units = {name for name, each in vars(quantities).items() if isinstance(each, quantities.Kind)}
    assert units == {name for name in re.findall(r"`([A-Z_]{4,})`", section) if name != "MODE"}
    for check in re.findall(r"`(check_\w+)`", section):
        assert callable(getattr(validate, check))


@pytest.mark.parametrize(
    ("motion", "line"),
    [
        ({"start": "5 nm"}, "motion.depth: missing; must be a length with its unit"),
        ({"depht": "2 nm", **RELAXING["motion"]}, "motion.depht: unknown key; did you mean"),
        ({**RELAXING["motion"], "speed": "0 m/s"}, "motion.speed = '0 m/s': must be greater than"),
        ({**RELAXING["motion"], "speed": "1 nm"}, "motion.speed = '1 nm': must be a speed with"),
        ({**RELAXING["motion"], "start": "0 nm"}, "motion.start = '0 nm': start height = 0 m: "),
        ({**RELAXING["motion"], "shape": "sine"}, "motion.shape = 'sine': must be 'press'"),
    ],
)
def test_files_of_the_mode_of_the_extending_page_are_refused_in_a_line(relaxing, motion, line):
    with pytest.raises(ValueError, match=f"^{re.escape(line)}") as refused:
        build_experiment({**relaxing, "motion": motion}, Path())
    assert len(str(refused.value).splitlines()) == 1


# The other pages


def test_the_tips_page_runs(tmp_path):
    page = example_module("tips.md", tmp_path)
    assert page.load == pytest.approx(page.hertz, rel=0.2)
    assert np.all(page.sticky[1:] < page.load[1:])
    assert page.at_one_micron > 0
    assert page.tip.profile(5e-9) == 0


@pytest.mark.parametrize("page", ["surfaces.md", "samples.md"])
def test_pages_run_elsewhere_are_run(page):
    assert page in "".join(
        (Path(__file__).parent / f"test_{subject}.py").read_text(encoding="utf-8")
        for subject in ("surfaces", "rheology")
    )


def test_the_tap_of_the_first_page_runs(tmp_path):
    tap = example_module("index.md", tmp_path).tap
    assert float(tap.dissipation) == pytest.approx(4.00e-17, rel=0.02)


def test_the_first_force_curve_is_what_the_tutorial_says(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = example_module("first-force-curve.md", tmp_path)
    curve = page.curve
    assert page.contact.tabor_relaxed == pytest.approx(8.8, abs=0.05)
    assert page.contact.cohesive_length == pytest.approx(3.4e-9, abs=0.05e-9)
    assert float(curve.force_max) == pytest.approx(199e-9, rel=0.01)
    assert float(curve.force_min) == pytest.approx(-223e-9, rel=0.01)
    assert float(curve.loop_energy) == pytest.approx(14e-15, rel=0.01)
    assert curve.jump_energy.values == pytest.approx([11.7e-15, 2.2e-15], rel=0.02)
    assert float(curve.force_min) == pytest.approx(page.load.min(), rel=0.01)
    heights = np.interp(curve.jump_time, curve.time, curve.tip_height)
    assert heights == pytest.approx([54e-9, 122e-9], abs=0.5e-9)
    assert float(page.again.loop_energy) == float(curve.loop_energy)
    assert (tmp_path / "curve.png").stat().st_size > 10_000


def test_the_first_tap_is_what_the_tutorial_says(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ldpe-tapping.toml").write_text(read_example("ldpe-tapping"), encoding="utf-8")
    page = example_module("first-tap.md", tmp_path)
    assert page.regime.tabor_instantaneous == pytest.approx(0.45, abs=0.005)
    assert page.regime.tabor_relaxed == pytest.approx(3.3, abs=0.05)
    assert float(page.tap.dissipation) == pytest.approx(87e-18, rel=0.01)
    assert float(page.slower.dissipation / page.tap.dissipation) == pytest.approx(2.7, rel=0.02)
    assert float(page.steady.dissipation / page.first.dissipation) == pytest.approx(0.25, abs=0.02)
    assert (tmp_path / "tap.png").exists()
    assert (tmp_path / "creep.png").exists()


def test_the_solver_tables_of_the_command_line_page_hold_the_defaults(tmp_path):
    page = (DOCS / "command-line.md").read_text(encoding="utf-8")
    path = tmp_path / "experiment.toml"
    solvers = []
    for table in re.findall(r"```toml\n(\[solver\]\n.*?)```", page, re.S):
        path.write_text(f"{read_example('ldpe-tapping')}\n{table}", encoding="utf-8")
        solvers.append(load_experiment(path).solver)
    segments, functions = solvers
    assert replace(segments, domain=None, relaxation=None) == sa.solvers.Attard()
    assert replace(functions, domain=None) == sa.solvers.EnhancedAttard()


def test_the_reference_holds_every_public_name_and_no_other():
    pages = "\n".join(page.read_text(encoding="utf-8") for page in (DOCS / "api").glob("*.md"))
    described = re.findall(r"^::: softafm\.(\S+)$", pages, re.M)
    assert len(described) == len(set(described))
    public = {name for name in described if "." not in name}
    assert public == set(sa.__all__)
    for name in set(described) - public:  # of what public functions return or raise
        room, _, thing = f"softafm.{name}".rpartition(".")
        assert getattr(importlib.import_module(room), thing).__doc__


@pytest.mark.parametrize("room", ["bodies", "instrument", "modes", "solvers"])
def test_the_reference_holds_every_protocol(room):
    page = (DOCS / "api" / "extending.md").read_text(encoding="utf-8")
    described = set(re.findall(r"^::: (\S+)$", page, re.M))
    public = getattr(sa, room).__all__ if f"softafm.{room}" in described else ()
    for path in (PACKAGE / room).rglob("*.py"):
        module = ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts)
        for line in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            bases = line.bases if isinstance(line, ast.ClassDef) else ()
            if any(isinstance(base, ast.Name) and base.id == "Protocol" for base in bases):
                assert f"{module}.{line.name}" in described or line.name in public, line.name


def test_every_public_name_has_a_docstring():
    for name in sa.__all__:
        assert (getattr(sa, name).__doc__ or "").strip(), name


# Command line

COMMAND_LINE = (DOCS / "command-line.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("table", [table for table in schema.CHOICES if table != "solver"])
def test_the_command_line_page_lists_every_choice_with_its_keys(table):
    chooser, choices = schema.CHOICES[table]
    section = COMMAND_LINE.split(f"| `{chooser}` | keys |\n|---|---|\n")[1].split("\n\n")[0]
    listed = {}
    for row in section.splitlines():
        names, keys = row.strip("| ").split(" | ")
        without_columns = re.sub(r"with columns such as `[^`]*`", "", keys)
        for name in re.findall(r"`([^`]+)`", names):
            listed[name] = set(re.findall(r"`(\w+)`", without_columns))
    assert listed == {name: set(choice.model_fields) for name, choice in choices.items()}


def test_the_command_line_page_lists_every_solver_with_its_keys():
    for name, solver in schema.CHOICES["solver"][1].items():
        row = re.search(rf"`name = \"{name}\"` \| (.*) \|", COMMAND_LINE)
        assert row is not None, f"docs/command-line.md has no row for the solver '{name}'"
        assert set(re.findall(r"`(\w+)`", row[1])) == set(solver.model_fields)


@pytest.mark.parametrize("snippet", re.findall(r"```toml\n(.*?)```", COMMAND_LINE, re.S))
def test_the_snippets_of_the_command_line_page_are_accepted(snippet, tmp_path):
    written = tomllib.loads(snippet)
    base = tomllib.loads(read_example("ldpe-tapping"))
    path = tmp_path / "experiment.toml"
    mode = written.get("mode", "tapping-cycle")
    if "free_amplitude" in written.get("motion", {}):
        mode = "approach-curve"
    if "file" in written.get("motion", {}):
        mode = "force-distance"
        rows = "".join(f"{k},{15 - abs(k - 20) / 2}\n" for k in range(41))
        (tmp_path / written["motion"]["file"]).write_text(f"time (ms),height (nm)\n{rows}")
    document = {**base, **written, "mode": mode}
    path.write_text(
        "\n".join(f"{key} = {_inline(value)}" for key, value in document.items()), encoding="utf-8"
    )
    load_experiment(path)


def _inline(value):
    """A value as TOML in one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {_inline(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_inline, value)) + "]"
    return json.dumps(value)


def test_documents_install_a_copy_of_the_repository_as_it_is_not_published():
    pages = [DOCS.parent / "README.md", *sorted(DOCS.rglob("*.md"))]
    texts = {page.name: page.read_text(encoding="utf-8") for page in pages}
    for name, text in texts.items():
        targets = re.findall(r"pip install (?:-e )?['\"]?([^\s'\"`]+)", text)
        assert all(target.startswith(".") for target in targets), name
    for name in ("README.md", "index.md", "page.md"):
        assert "not on PyPI" in texts[name]


def test_a_motion_of_a_plain_class_is_the_same_path_by_points(extending):
    motion = extending.landing
    contact = sa.Contact(sa.Paraboloid(10e-9), SAMPLE, sa.LennardJones(1e-19, 0.3e-9))
    time = np.linspace(0, motion.breaks[-1], 4001)
    path = sa.Trajectory(time, motion.height(time), smooth=True)
    one, two = (sa.force_distance(contact, each, tolerance=1e-3) for each in (motion, path))
    for name in ("force_min", "force_max", "loop_energy"):
        assert float(one[name]) == pytest.approx(float(two[name]), rel=2e-3)
    assert json.loads(one.attrs["experiment"])["motion"]["decay"] == 1e-4


def test_lines_of_prose_are_wrapped():
    pages = [DOCS.parent / "README.md", DOCS.parent / "CONTRIBUTING.md", *DOCS.rglob("*.md")]
    for page in pages:
        text = page.read_text(encoding="utf-8")
        prose = re.sub(r"```.*?```", "", text, flags=re.S)
        long = [line for line in prose.splitlines() if len(line) > 100 and line[0] not in "|!"]
        assert not long, f"{page.name}: wrap with tools/wrap.py"


def test_a_lever_in_liquid_takes_up_what_the_force_gives(extending):
    """k q + c q̇ = F: the integral of F − k q is c times the last deflection."""
    history, (k, drag) = extending.history, extending.InLiquid(0.5, 2e-5).parameters
    motion = sa.Triangle(start=5e-9, turn=-2e-9, speed=1e-5)
    time, force = history.time, history.force
    q = history.tip_height - motion.height(time)
    given = (force - k * q)[1:] @ np.diff(time)
    assert np.abs(q).max() > 0.1e-9
    assert given == pytest.approx(drag * q[-1], abs=1e-3 * drag * np.abs(q).max())
    assert np.abs(force - k * q).max() > 0.3 * np.abs(force).max()
