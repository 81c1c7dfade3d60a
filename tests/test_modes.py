"""Records of modes: what they are for, what they refuse, and one of a kind that is not built in."""

import ast
import json
import re
from dataclasses import dataclass, make_dataclass, replace
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
import pytest
import xarray as xr
from own_modes import modes_restored

import softafm as sa
from softafm import modes
from softafm.checks.refusals import ConfigError
from softafm.draw.results import plot
from softafm.experiment import schema
from softafm.experiment.config import build_experiment
from softafm.experiment.regime import estimate_seconds, list_rows
from softafm.modes.start import choose_solver
from softafm.sweeps.reading import make_campaign, read_table
from softafm.units.quantities import LENGTH, SPEED

PACKAGE = Path(sa.__file__).parent
SOFT = sa.Contact(
    sa.Paraboloid(1e-6), sa.Elastic(1e6, poisson=0.5), sa.Repulsion(1e10, decay=0.1e-9)
)
FILE = {
    "mode": "load-curve",
    "tip": {"shape": "paraboloid", "radius": "1 um"},
    "sample": {"model": "elastic", "E": "1 MPa", "poisson": 0.5},
    "surface": {"law": "repulsion", "pressure_at_zero": "10 GPa", "decay": "0.1 nm"},
    "motion": {"deepest": "300 nm", "count": 3},
    "ramp": {"speed": "2 um/s"},
}


@dataclass(frozen=True)
class Depths:
    """Depths at even distances.

    Parameters
    ----------
    deepest
        The largest depth, m.
    count
        How many there are.
    """

    kind: ClassVar[str] = "depths"
    deepest: Annotated[float, LENGTH]
    count: int = 4

    @property
    def depths(self):
        return self.deepest * np.arange(1, self.count + 1) / self.count


@dataclass(frozen=True)
class Ramp:
    """How each depth is reached.

    Parameters
    ----------
    speed
        Speed of the tip, m/s.
    """

    kind: ClassVar[str] = "ramp"
    speed: Annotated[float, SPEED] = 1e-6


def load_curve(contact, deepest, count=4, ramp=Ramp(), *, solver=None, tolerance=1e-2,
               progress=None, check=False, regularise=None):  # fmt: skip
    """Largest force at several depths, each on a fresh place."""
    return modes.perform(
        LOADS, contact, Depths(deepest, count), tables={"ramp": ramp}, solver=solver,
        tolerance=tolerance, progress=progress, check=check, regularise=regularise,
    )  # fmt: skip


def press_to_all(inputs, settings):
    asked, solver, forces = inputs.motion, choose_solver(settings.solver), []
    for depth in asked.depths:
        ramp = sa.Triangle(5e-9, -depth, inputs.tables["ramp"].speed)
        history = solver.solve(inputs.contact, ramp, tolerance=settings.tolerance)
        forces.append(history.extreme(history.force, 1))
    return modes.Outcome(
        inputs.parts, solver, settings.tolerance,
        {"largest_load": ("depth", np.array(forces))}, {"depth": ("depth", asked.depths)},
        diagnostics={"presses": asked.count},
    )  # fmt: skip


LOADS = modes.Mode(
    name="load-curve",
    function=load_curve,
    motions={"depths": Depths},
    observables={
        "depth": modes.Observable("m", "depth below the flat surface", ("depth",)),
        "largest_load": modes.Observable("N", "largest force at a depth", ("depth",)),
    },
    simulate=press_to_all,
    axes=modes.Axes(("depth",), lambda asked: (asked.depths,), ("deepest", "count")),
    tables={"ramp": Ramp},
    scales=lambda inputs, result: modes.Scales({"N": 1e-9}),
    foresee=lambda inputs: modes.Foreseen(
        sa.Triangle(5e-9, -inputs.motion.deepest, 1e-6), inputs.motion.count, "ramp"
    ),
    figure=modes.Layout((("depth", "largest_load"),), cropped=False),
    diagnostics=("solver_presses",),
)


@pytest.fixture
def loads():
    with modes_restored():
        modes.register(LOADS)
        yield LOADS


def test_no_file_but_that_of_a_mode_names_it():
    """So a new one is a file and a line in the table, and an old one is spelled once."""
    for path in PACKAGE.rglob("*.py"):
        if path.parent.name == "modes":
            continue
        texts = [each.value for each in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
                 if isinstance(each, ast.Constant)]  # fmt: skip
        assert not [text for text in texts if isinstance(text, str) and text in modes.MODES], path


def test_every_mode_is_public_under_the_name_of_its_function():
    for mode in modes.MODES.values():
        assert getattr(sa, mode.function.__name__) is mode.function
        assert mode.function.__name__ in sa.__all__


def test_a_mode_with_a_coordinate_of_its_own_runs_from_python_and_from_a_file(loads):
    result = load_curve(SOFT, 300e-9, 3, Ramp(2e-6))
    hertz = [sa.indentation.force(SOFT.tip, depth, 1e6 / 0.75) for depth in result.depth.values]
    np.testing.assert_allclose(result.largest_load.values, hertz, rtol=0.02)
    experiment = build_experiment(FILE, Path())
    xr.testing.assert_equal(experiment.run(), result)
    np.testing.assert_array_equal(
        experiment.observables()["largest_load"], result.largest_load.values
    )
    single = replace(experiment, motion=Depths(300e-9, 1))
    assert estimate_seconds(experiment) == pytest.approx(3 * estimate_seconds(single))
    assert json.loads(result.attrs["experiment"])["ramp"] == {"kind": "ramp", "speed": 2e-6}
    assert list_rows(experiment)[-1].words.startswith("some 3 ramps; ")


@pytest.mark.usefixtures("loads")
def test_its_result_is_checked_saved_exported_and_drawn(tmp_path):
    result = load_curve(SOFT, 300e-9, 3, tolerance=3e-2, check=True)
    finer = load_curve(SOFT, 300e-9, 3, tolerance=3e-3)
    differences = json.loads(result.attrs["check_differences"])
    pressed, finest = result.largest_load.values, finer.largest_load.values
    expected = (pressed - finest) / np.maximum(finest, 1e-9)
    assert list(differences) == ["largest_load"]
    assert abs(differences["largest_load"]) == pytest.approx(np.abs(expected).max())
    sa.save(result, tmp_path / "loads.nc")
    assert sa.load(tmp_path / "loads.nc").identical(result)
    sa.export(result, tmp_path / "loads.csv")
    lines = (tmp_path / "loads.csv").read_text(encoding="utf-8").splitlines()
    assert lines[-4] == "depth (m),largest_load (N)"
    assert [float(cell) for cell in lines[-1].split(",")] == [300e-9, pressed[-1]]
    (ax,) = plot(result).axes
    assert ax.get_xlabel() == "Depth below the flat surface (nm)"
    assert ax.lines[-1].get_ydata() == pytest.approx(1e9 * pressed)


def test_its_sweep_keeps_the_coordinate_and_cannot_vary_it(loads):
    what = {"vary": {"sample.E": ["1 MPa", "2 MPa"], "ramp.speed": ["1 um/s"]}}
    campaign = make_campaign(FILE, Path(), read_table(what), from_file=True)
    (load,) = campaign.observables
    assert (load.name, load.unit, load.dimensions, load.shape) == (
        "largest_load",
        "N",
        ("depth",),
        (3,),
    )
    assert campaign.coordinates["depth"][1].tolist() == Depths(300e-9, 3).depths.tolist()
    with pytest.raises(ConfigError, match=r"motion.count'.* lie over depth already"):
        make_campaign(FILE, Path(), read_table({"vary": {"motion.count": [2, 3]}}), from_file=True)


def test_the_page_draws_it_and_offers_no_movie(loads):
    pytest.importorskip("bokeh")
    from softafm.app.curves import Shown, draw_figures

    result = load_curve(SOFT, 300e-9, 3)
    assert list(draw_figures([Shown("loads", "#000000", result)], "light")) == [
        "Depth below the flat surface"
    ]
    with pytest.raises(ConfigError, match=r"^run.profiles = True: not used with mode = 'load-c"):
        build_experiment({**FILE, "run": {"profiles": True}}, Path())


@pytest.mark.usefixtures("loads")
def test_its_further_table_is_asked_for_and_refused_in_a_line():
    from softafm.app.form import describe_section, list_tables
    from softafm.app.python_lines import write_python

    assert list_tables("load-curve")[4:] == ("ramp", "solver", "run")
    (speed,) = describe_section("ramp", None, "load-curve").fields.values()
    assert (speed.unit, speed.default, speed.help) == ("m/s", "1 µm/s", "Speed of the tip, m/s.")
    assert "ramp=Ramp(speed=2e-6)" in write_python(FILE, Path())
    assert "from test_modes import Ramp" in write_python(FILE, Path())
    without = {name: table for name, table in FILE.items() if name != "ramp"}
    for ramp, line in (
        ({}, "ramp: missing; add a table"),
        ({"ramp": {"speed": "2 um"}}, "ramp.speed = '2 um': must be a speed with its unit"),
        ({"ramp": {"sped": "2 um/s"}}, "ramp.sped: unknown key; did you mean 'speed'?"),
        ({"mode": "force-distance", "ramp": {}}, "ramp: unknown key"),
    ):
        with pytest.raises(ConfigError, match="^" + re.escape(line)):
            build_experiment({**without, **ramp}, Path())


def test_results_of_a_mode_that_is_not_registered_are_refused(tmp_path):
    with modes_restored():
        modes.register(LOADS)
        sa.save(load_curve(SOFT, 300e-9, 2), tmp_path / "loads.nc")
    with pytest.raises(ValueError, match=r"attribute mode = 'load-curve': .*must be 'force-dist"):
        sa.load(tmp_path / "loads.nc")
    with pytest.raises(ValueError, match=r"^mode 'load-curve' is not known: call .*register"):
        load_curve(SOFT, 300e-9, 2)


@pytest.mark.parametrize(
    ("change", "line"),
    [
        ({"observe": press_to_all}, "mode 'load-curve': must have either observe or simulate"),
        ({"simulate": None}, "mode 'load-curve': must have either observe or simulate"),
        ({"motions": {}}, "mode 'load-curve': motions is empty"),
        ({"motions": {"sine": sa.Sine}}, "mode 'load-curve': load_curve has no argument mean_heig"),
        ({"lever": "soft"}, "mode 'load-curve': lever = 'soft': must be '' or 'stiffness' or"),
    ],
)
def test_a_record_that_does_not_fit_is_refused(change, line):
    with pytest.raises(ValueError, match=f"^{re.escape(line)}"):
        replace(LOADS, **change)


def test_a_name_means_the_same_in_all_results():
    stolen = replace(
        LOADS, axes=modes.Axes(), figure=modes.Layout((("force", "force"),)),
        observables={"force": modes.Observable("Hz", "frequency shift")},
    )  # fmt: skip
    with modes_restored(), pytest.raises(ValueError, match=r"'force' of mode 'load-curve': this"):
        modes.register(stolen)
    assert "load-curve" not in modes.MODES


@pytest.mark.parametrize(
    ("field", "written", "value"),
    [
        (Annotated[float, LENGTH], "3 nm", 3e-9),
        (Annotated[float, LENGTH] | None, "3 nm", 3e-9),
        (Annotated[tuple[float, ...], LENGTH], ["1 nm", "3 nm"], (1e-9, 3e-9)),
        (tuple[float, ...] | None, [0.5, 2.0], (0.5, 2.0)),
        (float | None, 0.5, 0.5),
        (Literal["tip", "base"], "base", "base"),
        (int, 3, 3),
        (bool, True, True),
    ],
)
def test_fields_of_a_dataclass_are_written_by_their_types(field, written, value):
    made = make_dataclass("Made", [("field", field)], namespace={"kind": "made"}, frozen=True)
    assert (
        schema.build_kind("made", {"field": written}, schema.table_of(made), folder=Path()).field
        == value
    )
    with pytest.raises(ConfigError, match=r"^made\.field = \{\}: must be "):
        schema.build_kind("made", {"field": {}}, schema.table_of(made), folder=Path())


def test_fields_of_a_solver_have_units_too():
    namespace = {"kind": "own", "adaptive": True}
    field = ("reach", Annotated[float, LENGTH] | None, None)
    table = schema._make_solver_table(make_dataclass("Own", [field], namespace=namespace))
    assert schema.build_kind("solver", {"reach": "3 nm"}, table, folder=Path()).reach == 3e-9
    with pytest.raises(
        ConfigError, match=r"^solver\.reach = 3e-09: must be a length with its unit"
    ):
        schema.build_kind("solver", {"reach": 3e-9}, table, folder=Path())


def test_a_dimension_needs_a_meaning():
    over = replace(LOADS, axes=modes.Axes(("place",)))
    with modes_restored(), pytest.raises(ValueError, match="the dimension place must be among the"):
        modes.register(over)


def test_what_is_observed_is_what_the_record_says():
    mode = modes.MODES["force-distance"]
    odd = replace(mode, name="odd", observe=lambda contact, motion, history: {"force_max": 1.0})
    with modes_restored():
        modes.register(odd)
        with pytest.raises(ValueError, match=r"^mode 'odd': observe returns no force_min, force_m"):
            modes.perform(odd, SOFT, sa.Triangle(5e-9, -1e-9, 1e-6))


def test_a_motion_that_no_file_can_describe_is_refused():
    @dataclass(frozen=True)
    class Odd:
        kind: ClassVar[str] = "odd"
        phase: complex

    def odd_curve(contact, phase, ramp):
        raise AssertionError("it was to be refused before any run")

    odd = replace(LOADS, function=odd_curve, motions={"odd": Odd})
    with modes_restored():
        modes.register(odd)
        with pytest.raises(ValueError, match=r"field phase: .*complex.* cannot be written"):
            build_experiment({**FILE, "motion": {"phase": 1}}, Path())
