"""What a user finds in ``softafm``: its names, and how files become results and figures."""

import inspect
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

import softafm as sa
from softafm.experiment.config import Experiment, read_example
from softafm.instrument.motion import Motion
from softafm.solvers.solver import Solver

TAP = tomllib.loads(read_example("ldpe-tapping"))
GENTLE = """
mode = "force-distance"
[tip]
shape = "paraboloid"
radius = "1 um"
[sample]
model = "elastic"
E = "1 MPa"
poisson = 0.3
[surface]
law = "repulsion"
pressure_at_zero = "100 MPa"
decay = "0.1 nm"
[motion]
start = "20 nm"
turn = "-100 nm"
speed = "1 um/s"
"""
SMALL = ["map.pixels=[2, 1]", 'map.size=["20 nm", "10 nm"]']
_UNSTATED = ("self", "cls")
HEAVY = {"matplotlib", "numba", "pandas", "pint", "pydantic", "rich", "scipy", "xarray"}


def test_dir_shows_the_public_names_and_no_others():
    assert sorted(dir(sa)) == sorted([*sa.__all__, "__version__"])
    assert all(getattr(sa, name) is not None for name in dir(sa))
    assert len(set(sa.__all__)) == len(sa.__all__)
    with pytest.raises(AttributeError, match="module 'softafm' has no attribute 'plots'"):
        _ = sa.plots


def test_a_star_import_brings_every_public_name():
    names = {}
    exec("from softafm import *", names)
    assert set(sa.__all__) <= set(names)


def test_looking_at_the_names_imports_nothing_heavy():
    code = f"import sys, softafm; dir(softafm); print({HEAVY} & {{*sys.modules}})"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout == "set()\n"


# Running what a file says


@pytest.fixture(scope="module")
def gentle(tmp_path_factory):
    path = tmp_path_factory.mktemp("public") / "gentle.toml"
    path.write_text(GENTLE, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def pressed(gentle):
    return sa.run(gentle)


def test_a_file_its_tables_and_the_experiment_give_one_result(gentle, pressed):
    tables = tomllib.loads(GENTLE)
    experiment = sa.load_experiment(gentle)
    assert isinstance(experiment, Experiment)
    by_hand = sa.force_distance(experiment.contact, sa.Triangle(20e-9, -100e-9, 1e-6))
    for other in (sa.run(str(gentle)), sa.run(tables), sa.run(experiment), by_hand):
        np.testing.assert_array_equal(other.force, pressed.force)
    assert tables == tomllib.loads(GENTLE)


def test_overrides_reach_the_run_and_leave_the_tables_alone(gentle):
    tables = tomllib.loads(GENTLE)
    softer = [sa.run(source, ["sample.E=0.5MPa"]) for source in (gentle, tables)]
    assert tables == tomllib.loads(GENTLE)
    assert float(softer[0].force_max) == float(softer[1].force_max)
    hertz = sa.indentation.hertz_force(1e-6, 100e-9, 0.5e6 / (1 - 0.3**2))
    assert float(softer[0].force_max) == pytest.approx(hertz, rel=0.03)


def test_the_progress_of_a_run_is_told(gentle):
    told = []
    sa.run(gentle, progress=lambda fraction, message: told.append(fraction))
    assert told[-1] == 1
    assert told == sorted(told)


@pytest.mark.parametrize("call", [sa.run, sa.regime])
@pytest.mark.parametrize(
    ("source", "reason"),
    [
        (None, "experiment = None: must be the path of a TOML file, a dict of its tables or what"),
        (["a.toml"], r"experiment = \['a.toml'\]: must be the path of a TOML file"),
        (Experiment, "experiment = <class Experiment>: must be the path .*; call it: Experiment"),
        ({**TAP, "mode": "tap"}, "mode = 'tap': did you mean 'tapping-cycle'"),
        ({1: TAP}, "key of an experiment = 1: must be the name of a table"),
        ({**TAP, "tip": None}, r"tip = None: must be a table, \[tip\]"),
        ({**TAP, "tip": {"shape": "paraboloid", "radius": 1e-8}}, "tip.radius = 1e-08: "),
        ({**TAP, "tip": {1: 2}}, "tip"),
        ({**TAP, "map": {}}, "the file describes a map, which 'softafm scan' takes"),
        ("none.toml", "none.toml: no such file"),
        ("mode = 'x'", "mode = 'x': no such file"),
    ],
)
def test_what_is_no_experiment_is_refused_in_one_line(call, source, reason):
    with pytest.raises(ValueError, match=reason) as refusal:
        call(source)
    assert "\n" not in str(refusal.value)


def test_an_experiment_takes_no_overrides(gentle):
    experiment = sa.load_experiment(gentle)
    with pytest.raises(ValueError, match=r"overrides = \['sample.E=2MPa'\]: must be empty for an"):
        sa.run(experiment, ["sample.E=2MPa"])


def test_a_map_file_is_loaded_and_run(tmp_path):
    path = tmp_path / "blend.toml"
    path.write_text(read_example("blend"), encoding="utf-8")
    experiment = sa.load_map(path, SMALL)
    assert experiment.run().sizes == {"y": 1, "x": 2}


def test_a_trajectory_is_read_in_si(tmp_path):
    path = tmp_path / "piezo.csv"
    path.write_text("time (ms),height (nm)\n0,10\n1,-5\n2,10\n", encoding="utf-8")
    motion = sa.read_trajectory(path)
    assert isinstance(motion, sa.Trajectory)
    assert motion.height(0.5e-3) == pytest.approx(2.5e-9, rel=1e-12)


# The regime


def test_the_regime_holds_the_scales_of_the_contact():
    scales = sa.regime(TAP)
    R, W, z0, E0, E_inf = 10e-9, 1e-19 / (16 * np.pi * 0.25e-9**2), 0.25e-9, 2e9, 0.1e9
    for modulus, tabor, length in (
        (E0, scales.tabor_instantaneous, scales.cohesive_length_instantaneous),
        (E_inf, scales.tabor_relaxed, scales.cohesive_length),
    ):
        reduced = modulus / (1 - 0.49**2)
        assert tabor == pytest.approx((R * W**2 / (reduced**2 * z0**3)) ** (1 / 3), rel=1e-6)
        assert length == pytest.approx(reduced * z0**2 / W, rel=1e-6)
    assert scales.lowest_height == pytest.approx(42.82e-9 - 49.6e-9, rel=1e-12)
    assert scales.duration == pytest.approx(1 / 278e3, rel=1e-12)
    assert scales.effective_radius == pytest.approx(R, rel=1e-12)
    assert scales.mode == "tapping-cycle"
    assert 0 < scales.expected_seconds < 1


def test_the_regime_prints_as_the_command_line_shows_it(tmp_path, softafm):
    path = tmp_path / "tap.toml"
    path.write_text(read_example("ldpe-tapping"), encoding="utf-8")
    code, out, _ = softafm("info", str(path))
    said = str(sa.regime(path))
    assert code == 0
    assert said.split() == out.split()
    assert said.splitlines()[0] == "tapping-cycle, before any run"
    assert len(said.splitlines()) == 1 + len(sa.regime(path).rows)


def test_the_regime_without_adhesion(gentle):
    scales = sa.regime(gentle, ["motion.turn=-60nm"])
    assert scales.tabor_relaxed == 0
    assert scales.cohesive_length == np.inf
    assert scales.contact_radius == pytest.approx(np.sqrt(1e-6 * 60e-9), rel=1e-6)


# Figures with a reference


def lines_named(figure, name):
    return [line for ax in figure.axes for line in ax.get_lines() if line.get_label() == name]


def test_a_closed_form_is_drawn_beside_a_result(pressed):
    tip, a = sa.Paraboloid(1e-6), np.linspace(0, 0.33e-6, 40)
    modulus = 1e6 / (1 - 0.3**2)
    depth, load = sa.indentation.depth(tip, a), sa.indentation.load(tip, a, modulus)
    figure = sa.plot(pressed, reference=(-depth, load))
    (line,) = lines_named(figure, "reference")
    assert line.axes.get_xlabel() == "Tip height (nm)"
    np.testing.assert_allclose(line.get_xdata(), -1e9 * depth, rtol=1e-12)
    np.testing.assert_allclose(line.get_ydata(), 1e9 * load, rtol=1e-12)
    bare = sa.plot(pressed)
    assert line.axes.get_xlim() == bare.axes[0].get_xlim()
    shown = {text.get_text() for text in line.axes.get_legend().get_texts()}
    assert shown == {"approach", "retract", "reference"}
    assert lines_named(bare, "reference") == []


def test_a_second_result_is_drawn_as_reference(pressed, gentle):
    stiffer = sa.run(gentle, ["sample.E=2MPa"])
    figure = sa.plot(pressed, labels=["soft"], reference=stiffer)
    shown = {text.get_text() for text in figure.axes[0].get_legend().get_texts()}
    assert {"soft", "reference"} <= shown


@pytest.mark.parametrize(
    ("reference", "reason"),
    [
        (3.0, "reference = 3.0: must be a result of softafm, or a pair"),
        (([1e-9],), "reference has 1 entries: must be a result of softafm, or a pair"),
        (([0, 1e-9], [0.0]), "reference has 2 heights and 1 forces: must have as many of each"),
        (([0, 1e-9], [0, np.nan]), r"reference\[1\]\[1\] = nan N: must be a finite number"),
        (("x", [0, 1]), r"reference\[0\] = 'x': must be a list of numbers in m"),
    ],
)
def test_what_is_no_reference_is_refused(pressed, reference, reason):
    with pytest.raises(ValueError, match=reason):
        sa.plot(pressed, reference=reference)


def test_a_result_of_another_mode_is_no_reference(pressed):
    with pytest.raises(ValueError, match="mode = force-distance, tapping-cycle: must be"):
        sa.plot(pressed, reference=sa.run(TAP))


def test_a_figure_without_tip_heights_takes_no_closed_form(tmp_path):
    path = tmp_path / "blend.toml"
    path.write_text(read_example("blend"), encoding="utf-8")
    image = sa.load_map(path, SMALL).run()
    with pytest.raises(ValueError, match="mode = amplitude-modulation has no axis of tip height"):
        sa.plot(image, reference=([0, 1e-9], [0, 1e-9]))


# Types


def public_functions():
    """Yield every public function, and every method that a public class adds, with its name."""
    for name in sa.__all__:
        thing = getattr(sa, name)
        if inspect.ismodule(thing):
            found = {f"{name}.{each}": getattr(thing, each) for each in dir(thing)}
            things = {n: t for n, t in found.items() if "._" not in n and _of_softafm(t)}
        else:
            things = {name: thing}
        for label, each in things.items():
            if inspect.isroutine(each):
                yield label, each
            elif inspect.isclass(each):
                yield from _methods(label, each)


def _of_softafm(thing):
    return getattr(thing, "__module__", "").startswith("softafm")


def _methods(label, kind):
    for base in kind.__mro__:
        if not _of_softafm(base):
            continue
        for name, member in vars(base).items():
            function = getattr(member, "fget", None) or getattr(member, "func", member)
            function = getattr(function, "__func__", function)
            if inspect.isfunction(function) and not name.startswith("_"):
                yield f"{label}.{name}", function


def test_every_public_function_states_its_types():
    lacking = []
    for label, function in public_functions():
        signature = inspect.signature(function)
        parameters = [each for each in signature.parameters.values() if each.name not in _UNSTATED]
        if any(each.annotation is inspect.Parameter.empty for each in parameters):
            lacking.append(label)
        elif signature.return_annotation is inspect.Signature.empty:
            lacking.append(f"{label} ->")
    assert lacking == []
    assert len(dict(public_functions())) > 150


def test_solvers_and_motions_of_ones_own_fit_the_types():
    wanted = {"solver": Solver | None, "motion": Motion}
    found = [
        (label, each.name, each.annotation)
        for label, function in public_functions()
        for each in inspect.signature(function).parameters.values()
        if each.name in wanted and not label.startswith("modes.")  # theirs may describe a motion
    ]
    assert [(label, a) for label, name, a in found if a != wanted[name]] == []
    assert {name for _, name, _ in found} == set(wanted)


def test_the_package_says_that_it_is_typed():
    assert (Path(sa.__file__).parent / "py.typed").is_file()


def test_one_override_without_a_list_is_refused(gentle):
    with pytest.raises(ValueError, match=r"must be a list of such texts, \['sample.E0=3GPa'\]"):
        sa.run(gentle, "sample.E0=3GPa")


def test_a_contact_alone_is_no_experiment():
    contact = sa.Contact(
        sa.Paraboloid(10e-9), sa.Elastic(1e9, 0.3), sa.LennardJones(1e-19, 0.25e-9)
    )
    with pytest.raises(ValueError, match=r"must say how the tip moves, .* contact\.tabor_relaxed"):
        sa.regime(contact)
