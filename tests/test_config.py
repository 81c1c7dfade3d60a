"""Experiment files: what they mean, and that nothing wrong in them passes or crashes."""

import contextlib
import dataclasses
import json
import math
import os

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import softafm as sa
from softafm import rheology, samples, surfaces, tips
from softafm.experiment import schema
from softafm.experiment.config import (
    ConfigError,
    Experiment,
    list_examples,
    load_experiment,
    read_example,
)
from softafm.surfaces import read_law
from softafm.units.quantities import (
    ANGLE,
    CONCENTRATION,
    FORCE,
    LENGTH,
    MODULUS,
    STIFFNESS,
    TEMPERATURE,
    VISCOSITY,
    VOLTAGE,
    read_quantity,
    write_quantity,
)

TAP = {
    "mode": "tapping-cycle",
    "tip": {"shape": "paraboloid", "radius": "10 nm"},
    "sample": {
        "model": "standard-linear-solid",
        "E0": "2 GPa",
        "E_inf": "0.1 GPa",
        "creep_time": "0.1 us",
        "poisson": 0.49,
    },
    "surface": {"law": "lennard-jones", "hamaker": "1e-19 J", "z0": "0.25 nm"},
    "motion": {"amplitude": "49.6 nm", "mean_height": "46 nm", "frequency": "278 kHz"},
}
TRIANGLE = {"start": "10 nm", "turn": "-10 nm", "speed": "5 um/s"}
CURVE = {**TAP, "mode": "force-distance", "motion": TRIANGLE}
LEVER = {"stiffness": "28.1 N/m", "quality_factor": 430, "frequency": "278 kHz"}
SPECTROSCOPY = {**CURVE, "mode": "force-spectroscopy", "cantilever": LEVER}
SWEEP = {
    **TAP,
    "mode": "approach-curve",
    "cantilever": LEVER,
    "motion": {"free_amplitude": "15 nm", "first_ratio": 0.9, "last_ratio": 0.3, "points": 3},
}
KELVIN_VOIGT = {
    "model": "generalized-kelvin-voigt",
    "E0": "2 GPa",
    "compliances": ["1 1/GPa", "2/GPa"],
    "retardation_times": ["1 us", "10 us"],
    "poisson": 0.3,
}

LENGTHS = {"tip.radius", "surface.z0", "motion.amplitude", "motion.mean_height"}
POSITIVE = {
    "tip.radius": "m",
    "sample.E0": "Pa",
    "sample.E_inf": "Pa",
    "sample.creep_time": "s",
    "surface.hamaker": "J",
    "surface.z0": "m",
    "motion.amplitude": "m",
    "motion.frequency": "Hz",
}
QUANTITIES = {**POSITIVE, "motion.mean_height": "m"}
UNITS = ["m", "nm", "Pa", "GPa", "s", "us", "Hz", "kHz", "J", "eV", "m/s", "J/m^2", "kg", "K", "V"]
OF_KIND = {"m": {"m", "nm"}, "Pa": {"Pa", "GPa"}, "s": {"s", "us"}, "Hz": {"Hz", "kHz"}}
OF_KIND["J"] = {"J", "eV"}

fields = st.sampled_from(sorted(QUANTITIES))
positive_fields = st.sampled_from(sorted(POSITIVE))
printable = st.text(st.characters(exclude_categories=["Cs", "Cc"]), max_size=30)
anything = st.one_of(st.booleans(), st.integers(), st.floats(), printable, st.lists(st.integers()))
few = settings(max_examples=60, deadline=None)


def toml(document):
    """Write a document of plain values and tables as TOML."""

    def text(value):
        if isinstance(value, dict):
            return "{" + ", ".join(f"{text(k)} = {text(v)}" for k, v in value.items()) + "}"
        if isinstance(value, list):
            return "[" + ", ".join(map(text, value)) + "]"
        if isinstance(value, float):
            return repr(value) if math.isfinite(value) else str(value)
        return json.dumps(value, ensure_ascii=False)

    return "\n".join(f"{text(k)} = {text(v)}" for k, v in document.items())


def changed(document, path, value):
    """Return a copy with one dotted key set, or removed when the value is None."""
    table, _, key = path.partition(".")
    if not key:
        copy = {**document, table: value}
        return copy if value is not None else {k: v for k, v in document.items() if k != table}
    return {**document, table: changed(document[table], key, value)}


@pytest.fixture(scope="module")
def load(tmp_path_factory):
    """Write a document (tables, text or bytes) to a file and load it."""
    path = tmp_path_factory.mktemp("config") / "experiment.toml"

    def load(document, *overrides):
        content = toml(document) if isinstance(document, dict) else document
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return load_experiment(path, overrides)

    load.folder = path.parent
    return load


def refusal(load, document, *overrides):
    """Return the one line with which an experiment is refused."""
    with pytest.raises(ConfigError) as refused:
        load(document, *overrides)
    lines = str(refused.value).splitlines()
    assert len(lines) == 1
    assert len(lines[0]) < 400
    return lines[0]


# What a file means


def test_check_and_regularise_are_read_and_passed_on(load):
    assert (load(CURVE).check, load(CURVE).regularise) == (False, "auto")
    near = ("motion.start=4nm", "motion.turn=0nm", "run.tolerance=0.1")
    for document in (CURVE, SPECTROSCOPY):
        experiment = load(document, *near, "run.check=true", "run.regularise=2")
        assert (experiment.check, experiment.regularise) == (True, 2.0)
        result = experiment.run()
        assert result.attrs["check_tolerance"] == pytest.approx(0.01)
        assert result.attrs["regularised_tabor"] == 2
        assert result.attrs["given_range"] == pytest.approx(0.25e-9)


@pytest.mark.parametrize(
    ("overrides", "line"),
    [
        (["run.check=1"], "run.check = 1: must be true or false"),
        (["run.regularise=0"], "run.regularise = 0: must be between 0.1 and 1000"),
        (["run.regularise=1001"], "run.regularise = 1001: must be between 0.1 and 1000"),
        (["run.regularise='8'"], "run.regularise = '8': must be a plain number, without quotes"),
        (["run.regularise=true"], "run.regularise = True: must be a plain number"),
        (
            ["run.check=true", "run.tolerance=1e-5"],
            "run.check = True: a run of tolerance 1e-05 cannot be repeated at a tighter one",
        ),
        (
            ["run.check=true", "solver.name=attard", "solver.nodes=2000"],
            "run.check = True: the solver 'attard' cannot be run twice as fine: nodes = 4000",
        ),
        (
            [
                "run.regularise=8",
                "surface={law='repulsion', pressure_at_zero='1 MPa', decay='1nm'}",
            ],
            "run.regularise = 8: surface law 'repulsion': has no adhesion",
        ),
        (
            ["run.regularise=0.1", "sample.E_inf=1kPa"],
            "run.regularise = 0.1: surface law 'lennard-jones': its range would have to be",
        ),
        (
            ["run.regularise=1", "sample.E_inf=1MPa"],
            "motion.start = '10 nm': start height = 1e-08 m: must be above the equilibrium gap",
        ),
    ],
)
def test_what_cannot_be_checked_or_regularised_is_refused(load, overrides, line):
    assert refusal(load, CURVE, *overrides).startswith(line)


def test_the_contracts_example_is_the_contracts_python(load):
    experiment = load(TAP)
    assert experiment.contact == sa.Contact(
        tip=sa.Paraboloid(radius=10e-9),
        sample=sa.StandardLinearSolid(E0=2e9, E_inf=0.1e9, creep_time=1e-7, poisson=0.49),
        surface=sa.LennardJones(hamaker=1e-19, z0=0.25e-9),
    )
    assert experiment.motion == sa.Sine(46e-9, 49.6e-9, 278e3, cycles="steady")
    assert experiment.mode == "tapping-cycle"
    assert (experiment.tolerance, experiment.profiles, experiment.solver) == (1e-2, False, None)


def test_triangle_is_the_default_motion_of_a_force_curve(load):
    named = load(changed(CURVE, "motion", {"shape": "triangle", **TRIANGLE}))
    assert load(CURVE).motion == named.motion == sa.Triangle(10e-9, -10e-9, 5e-6)


def test_a_force_curve_may_follow_a_sine(load):
    motion = {"shape": "sine", **TAP["motion"]}
    assert load({**CURVE, "motion": motion}).motion == sa.Sine(46e-9, 49.6e-9, 278e3, 1)
    for cycles in (3, "steady"):
        for document in ({**CURVE, "motion": motion}, TAP):
            experiment = load(changed(document, "motion.cycles", cycles))
            assert experiment.motion == sa.Sine(46e-9, 49.6e-9, 278e3, cycles)


WAVE = {"mean_height": "-10 nm", "amplitude": "50 nm", "frequency": "1 Hz"}


def test_a_triangle_may_be_a_wave_and_rest_and_turn_at_a_force(load):
    wave = load({**CURVE, "motion": WAVE}).motion
    assert wave == sa.Triangle.from_frequency(-10e-9, 50e-9, 1.0)
    options = {"dwell": "20 ms", "setpoint_force": "500 pN"}
    for document in (CURVE, SPECTROSCOPY):
        motion = load({**document, "motion": {**TRIANGLE, **options}}).motion
        assert motion == sa.Triangle(10e-9, -10e-9, 5e-6, 0.02, 5e-10)
    wave = load({**SPECTROSCOPY, "motion": {"shape": "triangle", **WAVE, **options}}).motion
    assert wave == sa.Triangle.from_frequency(-10e-9, 50e-9, 1.0, dwell=0.02, setpoint_force=5e-10)


@pytest.mark.parametrize("stiffness", ["28.1 N/m", "28100 mN/m", "28100 pN/nm", "28.1 nN/nm"])
def test_a_cantilever(load, stiffness):
    document = changed(SPECTROSCOPY, "cantilever.stiffness", stiffness)
    assert load(document).cantilever == sa.Cantilever(28.1, 430.0, 278e3)
    assert load({**document, "cantilever": {"stiffness": stiffness}}).cantilever == (
        sa.Cantilever(28.1)
    )
    assert load(CURVE).cantilever is None


def test_spectroscopy_takes_every_motion_of_the_base(load):
    sine = {"shape": "sine", **TAP["motion"]}
    assert load({**SPECTROSCOPY, "motion": sine}).motion == sa.Sine(46e-9, 49.6e-9, 278e3)
    motion = measured(load, b"time (s),height (nm)\n0,10\n1,-2\n")["motion"]
    assert load({**SPECTROSCOPY, "motion": motion}).motion == sa.Trajectory([0, 1], [1e-8, -2e-9])


def test_an_approach_curve_takes_even_or_listed_ratios(load):
    experiment = load(SWEEP)
    assert experiment.cantilever == sa.Cantilever(28.1, 430.0, 278e3)
    assert experiment.motion.free_amplitude == 15e-9
    assert experiment.motion.amplitude_ratio == pytest.approx((0.9, 0.6, 0.3), rel=1e-14)
    assert experiment.motion.drive_frequency is None
    motion = {"free_amplitude": "15 nm", "amplitude_ratio": [0.5, 0.9, 0.2]}
    experiment = load({**SWEEP, "motion": {**motion, "drive_frequency": "270 kHz"}})
    assert experiment.motion.amplitude_ratio == (0.5, 0.9, 0.2)
    assert experiment.motion.drive_frequency == 270e3
    assert load({**SWEEP, "motion": motion}, "motion.amplitude_ratio=[0.5]").motion
    assert load(SWEEP, "motion.points=31").motion.amplitude_ratio[-1] == 0.3
    assert load(SWEEP, "run.profiles=false", "solver.name=attard").solver == sa.solvers.Attard()


@pytest.mark.parametrize(
    ("sample", "solid"),
    [
        ({"model": "elastic", "E": "1 MPa", "poisson": 0.3}, sa.Elastic(1e6, 0.3)),
        (KELVIN_VOIGT, sa.GeneralizedKelvinVoigt(2e9, (1e-9, 2e-9), (1e-6, 1e-5), 0.3)),
        (
            {"E0": "2 GPa", "E_inf": "1 GPa", "relaxation_time": "3 us", "poisson": 0},
            sa.StandardLinearSolid(2e9, 1e9, 6e-6, 0.0),
        ),
        (
            {"G0": "2 GPa", "G_inf": "1 GPa", "creep_time": "3 us", "poisson": 0.5},
            sa.StandardLinearSolid(6e9, 3e9, 3e-6, 0.5),
        ),
        (
            {"G0": "2 GPa", "G_inf": "1 GPa", "relaxation_time": "3 us", "poisson": 0.5},
            sa.StandardLinearSolid(6e9, 3e9, 6e-6, 0.5),
        ),
    ],
)
def test_samples(load, sample, solid):
    table = {"model": "standard-linear-solid", **sample}
    built = load({**TAP, "sample": table}).contact.sample
    assert type(built) is type(solid)
    for part, expected in zip(built.compliance, solid.compliance, strict=True):
        np.testing.assert_allclose(part, expected, rtol=1e-14)


PRONY = {"relaxation_times": ["1 ms", "1 s"], "poisson": 0.5}
POWER = {"exponent": 0.5, "window": ["1 ms", "1 s"], "poisson": 0.5}
SALT = {"hamaker": "1e-20 J", "z0": "0.3 nm", "surface_potential": "-25 mV"}
STICKY = {"work_of_adhesion": "50 mJ/m^2", "z0": "0.3 nm"}
BRUSH = {"law": "repulsion", "pressure_at_zero": "100 MPa", "decay": "0.5 nm"}
FILES = {
    "tip.csv": "radius (nm),height (nm)\n0,0.2\n2,0.4\n4,1.1\n6,2.2\n",
    "law.csv": "gap (nm),pressure (MPa)\n0.2,900\n0.3,0\n0.4,-110\n0.6,-40\n1,-9\n2,-1.1\n",
    "dma.csv": "frequency (Hz),storage (MPa),loss (MPa)\n1,1,0.2\n10,1.5,0.6\n100,3,1\n",
}
DMA = [1.0, 10.0, 100.0], [1e6, 1.5e6, 3e6], [2e5, 6e5, 1e6]
NM = 1e-9
BUILT = [
    ("tip", "paraboloid", {"radius": "10 nm"}, tips.Paraboloid(10 * NM)),
    ("tip", "sphere", {"radius": "2 um"}, tips.Sphere(2e-6)),
    (
        *("tip", "cone", {"half_angle": "20 deg", "apex_radius": "8 nm"}),
        tips.Cone(math.radians(20), 8 * NM),
    ),
    (
        *("tip", "hyperboloid", {"half_angle": "0.35 rad", "radius": "8 nm"}),
        tips.Hyperboloid(8 * NM, 0.35),
    ),
    (
        *("tip", "flat-punch", {"radius": "1 um", "edge_radius": "0.1 um"}),
        tips.FlatPunch(1e-6, 1e-7),
    ),
    (
        *("tip", "power-law", {"exponent": 4, "height": "3 nm", "radius": "10 nm"}),
        tips.PowerLawTip(4.0, 3 * NM, 10 * NM),
    ),
    (
        *("tip", "measured", {"file": "tip.csv"}),
        tips.MeasuredTip((0, 2 * NM, 4 * NM, 6 * NM), (0.2 * NM, 0.4 * NM, 1.1 * NM, 2.2 * NM)),
    ),
    ("sample", "elastic", {"E": "1 MPa", "poisson": 0.3}, sa.Elastic(1e6, 0.3)),
    (
        *("sample", "standard-linear-solid"),
        {"E0": "2 GPa", "E_inf": "1 GPa", "creep_time": "3 us", "poisson": 0.4},
        sa.StandardLinearSolid(2e9, 1e9, 3e-6, 0.4),
    ),
    (
        *("sample", "kelvin-voigt", {"E": "1 MPa", "creep_time": "1 ms", "poisson": 0.5}),
        rheology.KelvinVoigt(1e6, 1e-3, 0.5),
    ),
    (
        *("sample", "kelvin-voigt", {"E": "1 MPa", "viscosity": "2 kPa s", "poisson": 0.5}),
        rheology.KelvinVoigt.from_viscosity(1e6, 2e3, 0.5),
    ),
    (
        *("sample", "kelvin-voigt", {"G": "1 MPa", "viscosity": "2 kPa s", "poisson": 0.5}),
        rheology.KelvinVoigt.from_shear(1e6, 2e3, 0.5),
    ),
    (
        *("sample", "maxwell", {"E0": "1 MPa", "relaxation_time": "1 ms", "poisson": 0.5}),
        rheology.Maxwell(1e6, 1e-3, 0.5),
    ),
    (
        *("sample", "maxwell", {"E0": "1 MPa", "viscosity": "2 kPa s", "poisson": 0.5}),
        rheology.Maxwell.from_viscosity(1e6, 2e3, 0.5),
    ),
    (
        *("sample", "maxwell", {"G0": "1 MPa", "viscosity": "2 kPa s", "poisson": 0.5}),
        rheology.Maxwell.from_shear(1e6, 2e3, 0.5),
    ),
    (
        *("sample", "generalized-kelvin-voigt"),
        {k: v for k, v in KELVIN_VOIGT.items() if k != "model"},
        sa.GeneralizedKelvinVoigt(2e9, (1e-9, 2e-9), (1e-6, 1e-5), 0.3),
    ),
    (
        *("sample", "generalized-maxwell"),
        {"E_inf": "1 MPa", "moduli": ["2 MPa", "3 MPa"], **PRONY},
        rheology.GeneralizedMaxwell(1e6, (2e6, 3e6), (1e-3, 1.0), 0.5),
    ),
    (
        *("sample", "generalized-maxwell"),
        {"G_inf": "1 MPa", "shear_moduli": ["2 MPa", "3 MPa"], **PRONY},
        rheology.GeneralizedMaxwell.from_shear(1e6, (2e6, 3e6), (1e-3, 1.0), 0.5),
    ),
    (
        *("sample", "generalized-maxwell", {"E0": "8 MPa", "ratios": [0.25, 0.5], **PRONY}),
        rheology.GeneralizedMaxwell.from_ratios(8e6, (0.25, 0.5), (1e-3, 1.0), 0.5),
    ),
    (
        *("sample", "power-law", {"E1": "1 kPa", "reference_time": "1 ms", "error": 0.02, **POWER}),
        rheology.PowerLaw(1e3, 0.5, (1e-3, 1.0), 0.5, 1e-3, 0.02),
    ),
    (
        *("sample", "fractional-standard-linear-solid"),
        {"E0": "1 GPa", "E_inf": "10 MPa", "creep_time": "10 ms", **POWER},
        rheology.FractionalStandardLinearSolid(1e9, 1e7, 1e-2, 0.5, (1e-3, 1.0), 0.5),
    ),
    (
        *("sample", "measured-moduli", {"file": "dma.csv", "poisson": 0.4, "per_decade": 1}),
        rheology.GeneralizedMaxwell.from_dma(*DMA, poisson=0.4, per_decade=1),
    ),
    ("sample", "ldpe", {}, samples.ldpe()),
    ("sample", "polystyrene", {}, samples.polystyrene()),
    ("sample", "pdms", {}, samples.pdms()),
    ("sample", "pdms", {"mixing_ratio": 20}, samples.pdms(20)),
    ("sample", "polyisobutylene", {}, samples.polyisobutylene()),
    ("sample", "epoxy", {"poisson": 0.4}, samples.epoxy(0.4)),
    ("surface", "lennard-jones", {"hamaker": "1e-19 J", "z0": "0.3 nm"},
     surfaces.LennardJones(1e-19, 0.3 * NM)),
    ("surface", "lennard-jones", STICKY,
     surfaces.LennardJones.from_work_of_adhesion(0.05, 0.3 * NM)),
    ("surface", "van-der-waals", {"hamaker": "1e-19 J", "z0": "0.3 nm", "exponent": 15},
     surfaces.VanDerWaals(1e-19, 0.3 * NM, 15.0)),
    ("surface", "van-der-waals", STICKY,
     surfaces.VanDerWaals.from_work_of_adhesion(0.05, 0.3 * NM)),
    ("surface", "dmt", {"hamaker": "1e-19 J", "z0": "0.3 nm"}, surfaces.DMT(1e-19, 0.3 * NM)),
    ("surface", "dmt", {**STICKY, "wall": 0.2},
     surfaces.DMT.from_work_of_adhesion(0.05, 0.3 * NM, 0.2)),
    ("surface", "exponential", {**STICKY, "decay": "0.3 nm", "core": "0.05 nm"},
     surfaces.Exponential(0.05, 0.3 * NM, 0.3 * NM, 0.05 * NM)),
    ("surface", "morse", {**STICKY, "decay": "0.15 nm"},
     surfaces.Morse(0.05, 0.3 * NM, 0.15 * NM)),
    ("surface", "dugdale", {**STICKY, "tension": "100 MPa"},
     surfaces.Dugdale(0.05, 0.3 * NM, 1e8)),
    ("surface", "dlvo", {**SALT, "debye_length": "9.6 nm", "tip_potential": "0.05 V"},
     surfaces.DLVO(1e-20, 0.3 * NM, -0.025, 9.6 * NM, tip_potential=0.05)),
    ("surface", "dlvo",
     {**SALT, "concentration": "1 mmol/L", "temperature": "310 K", "permittivity": 74},
     surfaces.DLVO.from_concentration(1e-20, 0.3 * NM, -0.025, 1e-3, 310.0, 74.0)),
    ("surface", "repulsion", {"pressure_at_zero": "100 MPa", "decay": "0.5 nm"},
     surfaces.Repulsion(1e8, 0.5 * NM)),
    ("surface", "tabulated", {"file": "law.csv"},
     surfaces.Tabulated((2e-10, 3e-10, 4e-10, 6e-10, 1e-9, 2e-9),
                        (9e8, 0.0, -1.1e8, -4e7, -9e6, -1.1e6))),
    ("surface", "sum",
     {"parts": [BRUSH, {"law": "van-der-waals-attraction", "hamaker": "1e-20 J"},
                {"law": "tabulated", "file": "law.csv"}]},
     None),
]  # fmt: skip


def same(one, other):
    """Whether two things are equal but for rounding."""
    if dataclasses.is_dataclass(one):
        return type(one) is type(other) and all(
            same(getattr(one, f.name), getattr(other, f.name)) for f in dataclasses.fields(one)
        )
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(same, one, other))
    return one == (pytest.approx(other, rel=1e-12) if isinstance(other, float) else other)


@pytest.mark.parametrize(("table", "choice", "keys", "thing"), BUILT)
def test_every_choice_is_what_python_builds(load, table, choice, keys, thing):
    for name, content in FILES.items():
        (load.folder / name).write_text(content)
    chooser, _ = schema.CHOICES[table]
    document = {**TAP, table: {chooser: choice, **keys}}
    written = getattr(load(document, "motion.cycles=1").contact, table)
    if thing is None:
        brush, attraction = surfaces.Repulsion(1e8, 0.5 * NM), surfaces.VanDerWaalsAttraction(1e-20)
        thing = brush + attraction + read_law(load.folder / "law.csv")
    assert same(written, thing)


def test_no_cycle_is_steady_on_a_sample_that_flows(load):
    fluid = {"model": "maxwell", "E0": "1 GPa", "relaxation_time": "1 ms", "poisson": 0.5}
    flowing, sweeping = {**TAP, "sample": fluid}, {**SWEEP, "sample": fluid}
    assert load(flowing, "motion.cycles=3").motion.cycles == 3
    assert refusal(load, flowing).startswith("motion.cycles: missing; must be a number, as the")
    line = refusal(load, flowing, "motion.cycles=steady")
    assert line.startswith("motion.cycles: 'steady'; must be a number, as the sample 'maxwell'")
    assert refusal(load, sweeping).startswith("mode = 'approach-curve': cannot be used")


def test_every_choice_is_among_those_built():
    built = {(table, choice) for table, choice, _, _ in BUILT}
    for table, (_, choices) in schema.CHOICES.items():
        if table != "solver":
            only_in_sums = {"van-der-waals-attraction"} if table == "surface" else set()
            assert {choice for of, choice in built if of == table} == set(choices) - only_in_sums


def test_files_are_sought_beside_the_experiment_or_where_the_path_says(load, tmp_path):
    (load.folder / "measured").mkdir(exist_ok=True)
    for path in ("measured/tip.csv", str(tmp_path / "tip.csv")):
        (load.folder / path).write_text(FILES["tip.csv"])
        tip = load({**TAP, "tip": {"shape": "measured", "file": path}}).contact.tip
        assert tip.r == pytest.approx([0, 2e-9, 4e-9, 6e-9])


def test_parts_of_a_sum_may_be_written_as_tables(load):
    text = (
        toml({k: v for k, v in TAP.items() if k != "surface"})
        + """
[surface]
law = "sum"

[[surface.parts]]
law = "lennard-jones"
hamaker = "1e-19 J"
z0 = "0.3 nm"

[[surface.parts]]
law = "repulsion"
pressure_at_zero = "100 MPa"
decay = "0.5 nm"
"""
    )
    law = load(text).contact.surface
    assert same(law, surfaces.LennardJones(1e-19, 3e-10) + surfaces.Repulsion(1e8, 5e-10))


def test_a_law_that_only_repels_is_no_mistake(load):
    contact = load({**CURVE, "surface": BRUSH}).contact
    assert not contact.adhesive
    assert contact.tabor_relaxed == 0


def test_a_surface_may_be_given_by_its_work_of_adhesion(load):
    table = {"law": "lennard-jones", "work_of_adhesion": "30 mJ/m^2", "z0": "2.5 angstrom"}
    surface = load({**TAP, "surface": table}).contact.surface
    assert surface.work_of_adhesion == pytest.approx(0.03)
    assert surface.z0 == 2.5e-10


def test_run_and_solver_tables(load):
    tables = {"run": {"tolerance": 1e-3, "profiles": True}, "solver": {"name": "energy"}}
    experiment = load({**TAP, **tables})
    assert experiment.tolerance == 1e-3
    assert experiment.profiles is True
    assert experiment.solver == sa.solvers.Energy()


def test_a_solver_takes_its_own_parameters(load):
    solver = {"name": "energy", "most_steps": 5000}
    assert load({**TAP, "solver": solver}).solver == sa.solvers.Energy(most_steps=5000)
    line = refusal(load, {**TAP, "solver": {"name": "energy", "most_stepz": 5000}})
    assert line.startswith("solver.most_stepz: unknown key; did you mean 'most_steps'")
    assert refusal(load, {**TAP, "solver": {"name": "energy", "most_steps": "many"}}).startswith(
        "solver.most_steps = 'many': "
    )


ATTARD = {"name": "attard"}
ENHANCED = {"name": "enhanced-attard"}
SOLVERS = [sa.solvers.Energy, sa.solvers.Attard, sa.solvers.EnhancedAttard]


@pytest.mark.parametrize(
    ("table", "solver"),
    [
        (ATTARD, sa.solvers.Attard()),
        (
            {
                **ATTARD,
                "nodes": 35,
                "domain": "12 nm",
                "method": "explicit",
                "steps": 500,
                "stepper": "runge-kutta-4",
                "iteration_tolerance": 1e-4,
                "relaxation": 1,
                "most_iterations": 7,
            },
            sa.solvers.Attard(
                35, 12e-9, "explicit", 500, sa.solvers.RungeKutta4(), 1e-4, 1.0, 7
            ),
        ),
        (ENHANCED, sa.solvers.EnhancedAttard()),
        (
            {
                **ENHANCED,
                "functions": 12,
                "nodes": 35,
                "basis": "bessel",
                "expand": "bounded-gap",
                "orthogonal": False,
                "domain": "0.1 um",
                "quadrature": "midpoint",
                "steps": 500,
                "stepper": "forward-euler",
            },
            sa.solvers.EnhancedAttard(
                *(12, 35, "bessel", "bounded-gap", False, 1e-7, "midpoint", 500),
                sa.solvers.ForwardEuler(),
            ),
        ),
    ],
)  # fmt: skip
def test_the_papers_solvers_take_all_their_parameters(load, table, solver):
    experiment = load({**TAP, "solver": table})
    assert experiment.solver == solver
    assert experiment.tolerance == 1e-2


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
def test_steppers_are_named_with_their_order(load, order):
    solver = load({**TAP, "solver": ATTARD}, f"solver.stepper=adams-bashforth-{order}").solver
    assert solver.stepper == sa.solvers.AdamsBashforth(order)


def test_every_parameter_of_every_solver_is_a_key(load):
    for solver in SOLVERS:
        line = refusal(load, {**TAP, "solver": {"name": solver.kind, "x": 1}})
        assert all(f"'{field.name}'" in line for field in dataclasses.fields(solver))


def test_overrides_replace_and_add(load):
    experiment = load(
        TAP, "sample.E0=3GPa", "tip.radius = '20 nm'", "sample.poisson=0.3", "motion.cycles=2"
    )
    assert experiment.contact.sample.E0 == 3e9
    assert experiment.contact.tip.radius == 20e-9
    assert experiment.contact.sample.poisson == 0.3
    assert experiment.motion.cycles == 2
    assert load(TAP, "run.tolerance=1e-3").tolerance == 1e-3


def test_a_byte_order_mark_and_windows_line_ends_are_no_obstacle(load):
    text = toml(TAP).replace("\n", "\r\n")
    assert load(b"\xef\xbb\xbf" + text.encode()) == load(TAP)


def test_running_a_file_is_calling_the_function(load):
    result = load(TAP, "run.tolerance=0.05").run()
    same = sa.tapping_cycle(
        load(TAP).contact, amplitude=49.6e-9, mean_height=46e-9, frequency=278e3, tolerance=0.05
    )
    assert result.attrs["mode"] == "tapping-cycle"
    np.testing.assert_array_equal(result["force"], same["force"])
    curve = load(CURVE).run()
    motion = sa.Triangle(10e-9, -10e-9, 5e-6)
    same = sa.force_distance(load(CURVE).contact, motion)
    np.testing.assert_array_equal(curve["force"], same["force"])
    bent = load(SPECTROSCOPY).run()
    same = sa.force_spectroscopy(load(CURVE).contact, sa.Cantilever(28.1), motion)
    assert bent.attrs["mode"] == "force-spectroscopy"
    np.testing.assert_array_equal(bent["deflection"], same["deflection"])


def test_running_an_approach_curve_is_calling_the_function(load):
    done = []
    found = load(SWEEP, "run.tolerance=0.1", "motion.drive_frequency=277.9 kHz").run(
        lambda fraction, message: done.append((fraction, message))
    )
    same = sa.approach_curve(
        *(load(SWEEP).contact, sa.Cantilever(28.1, 430.0, 278e3), 15e-9, [0.9, 0.6, 0.3]),
        drive_frequency=277.9e3,
        tolerance=0.1,
    )
    assert found.attrs["mode"] == "approach-curve"
    np.testing.assert_array_equal(found["mean_height"], same["mean_height"])
    np.testing.assert_array_equal(found["retract_phase"], same["retract_phase"])
    assert done
    assert all(0 <= fraction <= 1 for fraction, _ in done)


# Bundled examples


def test_bundled_examples_load_and_say_what_they_are(load):
    named = {"ldpe-spectroscopy", "ldpe-tapping", "ps-approach-curve"}
    assert named | {"pdms-sphere", "epoxy-tapping"} <= set(list_examples())
    for name in list_examples():
        text = read_example(name)
        assert text.startswith("# ")
        assert isinstance(load(text), Experiment)


def test_attards_moduli_are_halved(load):
    sample = load(read_example("attard-triangle")).contact.sample
    assert sample.reduced_modulus_instantaneous == pytest.approx(5e9)
    assert sample.reduced_modulus_relaxed == pytest.approx(0.5e9)


def test_ldpe_example_is_the_reference_case(load):
    result = load(read_example("ldpe-tapping")).run()
    assert float(result["virial"]) == pytest.approx(-3.4805e-17, rel=0.01)
    assert float(result["dissipation"]) == pytest.approx(8.7097e-17, rel=0.01)


def test_polystyrene_example_is_the_papers_table(load):
    experiment = load(read_example("ps-approach-curve"))
    assert experiment.contact == sa.Contact(
        tip=sa.Paraboloid(50e-9),
        sample=sa.StandardLinearSolid(4.25e9, 1.89e9, 1e-7, 0.35),
        surface=sa.LennardJones(2e-20, 0.15e-9),
    )
    assert experiment.cantilever == sa.Cantilever(28.1, 429.5, 278e3)
    assert experiment.motion.free_amplitude == 15e-9
    assert experiment.motion.amplitude_ratio == pytest.approx(np.linspace(0.95, 0.2, 31))


def test_spectroscopy_example_is_the_papers_wave_and_the_reference_case(load):
    experiment = load(read_example("ldpe-spectroscopy"))
    assert experiment.motion.speed == pytest.approx(
        sa.Triangle.from_frequency(0.0, 50e-9, 1.0).speed
    )
    result = experiment.run()
    assert float(result["force_max"]) == pytest.approx(5.2246e-9, rel=0.01)
    assert float(result["force_min"]) == pytest.approx(-1.57152e-9, rel=0.01)
    assert float(result["loop_energy"]) == pytest.approx(1.07619e-18, rel=0.01)


def test_pdms_example_is_torn_off_as_in_jkr_theory(load):
    experiment = load(read_example("pdms-sphere"))
    contact = experiment.contact
    assert contact.sample == samples.pdms()
    assert 5 < contact.tabor_relaxed < 10
    result = experiment.run()
    assert float(result["force_max"]) == pytest.approx(0.5e-6, rel=0.01)
    assert float(result["force_min"]) == pytest.approx(-1.5 * math.pi * 0.05 * 5e-6, rel=0.03)
    assert result.sizes["jump"] == 2
    real = {"law": "lennard-jones", "work_of_adhesion": "50 mJ/m^2", "z0": "0.3 nm"}
    override = f"surface={{{', '.join(f'{k}={v!r}' for k, v in real.items())}}}"
    named = load(read_example("pdms-sphere"), override).contact
    assert named.tabor_relaxed == pytest.approx(400, rel=0.02)


def test_epoxy_example_softens_at_a_lower_frequency(load):
    fast = load(read_example("epoxy-tapping")).run()
    slow = load(read_example("epoxy-tapping"), "motion.frequency=300 Hz").run()
    assert 0.7 < float(slow["force_max"] / fast["force_max"]) < 0.9
    for tap in (fast, slow):
        assert float(tap["dissipation"]) == pytest.approx(float(tap["viscous_loss"]), rel=0.01)
    melt = load(read_example("epoxy-tapping"), "sample={model='polyisobutylene'}").contact.sample
    assert melt == samples.polyisobutylene()


def test_unknown_example():
    with pytest.raises(ConfigError, match="did you mean 'ldpe-tapping'"):
        read_example("ldpe-taping")


# Units


@pytest.mark.parametrize(
    ("written", "kind", "value"),
    [
        ("10 nm", LENGTH, 10e-9),
        ("10nm", LENGTH, 10e-9),
        (" 1e1  nm ", LENGTH, 10e-9),
        ("-10 nm", LENGTH, -10e-9),
        (".5 µm", LENGTH, 0.5e-6),
        ("2.5 Å", LENGTH, 2.5e-10),
        ("0 nm", LENGTH, 0.0),
        ("1 N/m²", MODULUS, 1.0),
        ("1 N m^-2", MODULUS, 1.0),
        ("3 J/m**3", MODULUS, 3.0),
        ("40 pN/nm", STIFFNESS, 0.04),
        ("2.5 mN/m", STIFFNESS, 0.0025),
        ("5 nN", FORCE, 5e-9),
        ("120 pN", FORCE, 1.2e-10),
        ("180 deg", ANGLE, math.pi),
        ("180 degrees", ANGLE, math.pi),
        ("180°", ANGLE, math.pi),
        ("0.35 rad", ANGLE, 0.35),
        ("-25 mV", VOLTAGE, -0.025),
        ("300 K", TEMPERATURE, 300.0),
        ("1 mM", CONCENTRATION, 1e-3),
        ("1 mmol/L", CONCENTRATION, 1e-3),
        ("1 mol/m^3", CONCENTRATION, 1e-3),
        ("2 kPa s", VISCOSITY, 2e3),
        ("2 Pa·s", VISCOSITY, 2.0),
        ("1 cP", VISCOSITY, 1e-3),
    ],
)
def test_quantities(written, kind, value):
    assert read_quantity(written, kind) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize("written", ["25 degC", "25 °C", "250 degC", "300 degF"])
def test_temperatures_count_from_absolute_zero(written):
    with pytest.raises(ValueError, match=r"such as '298 K'; '.*' does not count from zero, 'K'"):
        read_quantity(written, TEMPERATURE)


@given(st.floats(1e-3, 1e3), st.sampled_from(["pm", "nm", "µm", "um", "mm"]))
@few
def test_reading_a_length_scales_by_its_prefix(number, unit):
    scale = {"pm": 1e-12, "nm": 1e-9, "µm": 1e-6, "um": 1e-6, "mm": 1e-3}[unit]
    assert read_quantity(f"{number!r} {unit}", LENGTH) == pytest.approx(number * scale, rel=1e-14)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (1.14485e-8, "N", "11.45 nN"),
        (-8.6093e-9, "N", "-8.609 nN"),
        (9.99999e-10, "m", "1 nm"),
        (0.0, "J", "0 J"),
        (8.7097e-17, "J", "87.1 aJ"),
        (2.78e5, "Hz", "278 kHz"),
        (0.04, "N/m", "40 mN/m"),
        (0.45, "", "0.45"),
    ],
)
def test_readable_values(value, unit, text):
    assert write_quantity(value, unit) == text


# What is refused


@given(positive_fields, st.floats(max_value=0, allow_infinity=False))
@few
def test_negative_and_zero_quantities(load, path, number):
    written = f"{number!r} {POSITIVE[path]}"
    line = refusal(load, changed(TAP, path, written))
    assert line.startswith(f"{path} = ")
    assert "must be" in line


@given(fields, st.sampled_from(["nan", "inf", "-inf", "1e999", "-1e200", "1e-300"]))
@few
def test_numbers_that_cannot_be_computed_with(load, path, number):
    line = refusal(load, changed(TAP, path, f"{number} {QUANTITIES[path]}"))
    assert line.startswith(f"{path} = '{number} ")


@given(fields, st.floats(1e-3, 1e3), st.sampled_from(UNITS))
@few
def test_units_of_the_wrong_kind(load, path, number, unit):
    if unit in OF_KIND[QUANTITIES[path]]:
        return
    line = refusal(load, changed(TAP, path, f"{number!r} {unit}"))
    assert line.startswith(f"{path} = ")
    assert "with its unit, such as '" in line


@given(fields, st.floats(1e-3, 1e3), st.booleans())
@few
def test_missing_units(load, path, number, as_text):
    line = refusal(load, changed(TAP, path, repr(number) if as_text else number))
    assert line.startswith(f"{path} = ")
    assert "the unit is missing" in line


@given(fields, anything)
@few
def test_garbage_values(load, path, value):
    line = refusal(load, changed(TAP, path, value))
    assert line.startswith(path)


@given(st.sampled_from(["tip", "sample", "surface", "motion"]), printable)
@few
def test_unknown_keys(load, table, key):
    if key in TAP[table] or key in {"G0", "G_inf", "cycles", "shape"}:
        return
    document = changed(TAP, table, {**TAP[table], key: "1 nm"})
    assert refusal(load, document).startswith(f"{table}.")


@given(st.binary(max_size=200))
@few
def test_garbage_files(load, content):
    with pytest.raises(ConfigError):
        load(content)


@given(st.one_of(st.just(""), fields.map("{}=".format)), st.text(max_size=40))
@settings(max_examples=150, deadline=None)
def test_garbage_overrides(load, start, rest):
    with contextlib.suppress(ConfigError):
        load(TAP, start + rest)


@pytest.mark.parametrize("path", [f"{t}.{k}" for t in TAP if t != "mode" for k in TAP[t]])
def test_missing_keys(load, path):
    line = refusal(load, changed(TAP, path, None))
    assert line.startswith(path.split(".")[0])
    assert path.split(".")[1] in line


@pytest.mark.parametrize("table", ["tip", "sample", "surface", "motion"])
def test_missing_and_malformed_tables(load, table):
    assert refusal(load, changed(TAP, table, None)).startswith(f"{table}: missing")
    assert refusal(load, changed(TAP, table, 3)).startswith(f"{table} = 3: must be a table")


@pytest.mark.parametrize(
    ("override", "line"),
    [
        ("tip.radius=10 kg", "tip.radius = '10 kg': must be a length with its unit, such as '10 n"),
        ("tip.radius=9**9**9**9 m", "tip.radius = '9**9**9**9 m': must be a length"),
        ("motion.frequency=278 krad/s", "motion.frequency = '278 krad/s': must be a frequency"),
        ("sample.E_inf=3 GPa", "sample.E_inf = '3 GPa': must be at most sample.E0 = '2 GPa'"),
        ("sample.poisson=0.51", "sample.poisson = 0.51: must be above -1 and at most 0.5"),
        ("sample.poisson=-1", "sample.poisson = -1: must be above -1"),
        ("sample.poisson=nan", "sample.poisson = nan: must be a finite number"),
        ("sample.poisson='0.4'", "sample.poisson = '0.4': must be a plain number"),
        ("sample.poisson=true", "sample.poisson = True: must be a plain number"),
        ("sample.G0=1 GPa", "sample: give E0 and E_inf, or G0 and G_inf; found E0, E_inf, G0"),
        ("sample.relaxation_time=1 us", "sample: give creep_time, or relaxation_time; found"),
        ("surface.work_of_adhesion=30 mJ/m^2", "surface: give hamaker, or work_of_adhesion"),
        ("tip.raduis=10 nm", "tip.raduis: unknown key; did you mean 'radius'?"),
        ("cantilver.k=1", "cantilver: unknown key; did you mean 'cantilever'?"),
        ("cantilever.stiffness=1 N/m", "cantilever: not used with mode = 'tapping-cycle'; leave"),
        ("cantilever=1", "cantilever: not used with mode = 'tapping-cycle'; leave it out, or use"),
        ("tip.shape=paraboloyd", "tip.shape = 'paraboloyd': did you mean 'paraboloid'?"),
        ("mode=tapping-cycel", "mode = 'tapping-cycel': did you mean 'tapping-cycle'?"),
        ("mode=[1]", "mode = [1]: must be 'force-distance', 'force-spectroscopy', 'tapping-cycl"),
        ("motion.cycles=0", "motion.cycles = 0: must be a whole number from 1"),
        ("motion.cycles=1.5", "motion.cycles = 1.5: must be a whole number"),
        ("motion.cycles=true", "motion.cycles = True: must be a whole number"),
        ("motion.cycles='3'", "motion.cycles = '3': must be a whole number"),
        (
            "motion.cycles=stedy",
            "motion.cycles = 'stedy': must be a whole number from 1 to 1000000, or 'steady'",
        ),
        ("run.tolerance=0", "run.tolerance = 0: must be between"),
        ("run.tolerance=-1", "run.tolerance = -1: must be between"),
        ("run.profiles=1", "run.profiles = 1: must be true or false"),
        ("solver.name=enregy", "solver.name = 'enregy': did you mean 'energy'?"),
        ("sample.E0", "override 'sample.E0': must be key=value"),
        ("=3", "override '=3': must be key=value"),
        ("tip..radius=3", "override 'tip..radius=3': must be key=value"),
        ("tip.radius.x=3", "override 'tip.radius.x=3': tip.radius is a value, not a table"),
    ],
)
def test_refusals_read_well(load, override, line):
    assert refusal(load, TAP, override).startswith(line)


def test_only_a_counted_oscillation_must_start_outside_the_surface(load):
    inside = "motion.mean_height=-60 nm"
    line = refusal(load, TAP, inside, "motion.cycles=1")
    assert line.startswith("motion.mean_height = '-60 nm': start height = ")
    assert load(TAP, inside).motion.steady


@pytest.mark.parametrize(
    ("override", "line"),
    [
        ("motion.free_amplitude=15", "motion.free_amplitude = 15: must be a length with its unit"),
        ("motion.free_amplitude=0 nm", "motion.free_amplitude = '0 nm': must be greater than 0"),
        ("motion.first_ratio=1", "motion.first_ratio = 1: must be above 0 and below 1"),
        ("motion.last_ratio=0", "motion.last_ratio = 0: must be above 0 and below 1"),
        ("motion.last_ratio=20%", "motion.last_ratio = '20%': must be a plain number"),
        ("motion.last_ratio=nan", "motion.last_ratio = nan: must be a finite number"),
        ("motion.last_ratio=0.9", "motion.first_ratio = 0.9: must differ from last_ratio; for one"),
        ("motion.points=1", "motion.points = 1: must be a whole number from 2 to 1000"),
        ("motion.points=1001", "motion.points = 1001: must be a whole number from 2 to 1000"),
        ("motion.points=3.0", "motion.points = 3.0: must be a whole number"),
        ("motion.point=3", "motion.point: unknown key; did you mean 'points'?"),
        ("motion.amplitude_ratio=[0.5]", "motion: give amplitude_ratio, or first_ratio, last_rati"),
        ("motion.drive_frequency=1 nm", "motion.drive_frequency = '1 nm': must be a frequency"),
        ("motion.drive_frequency=0 Hz", "motion.drive_frequency = '0 Hz': must be greater than 0"),
        ("motion.mean_height=1 nm", "motion.mean_height: unknown key; must be 'free_amplitude', "),
        ("motion.shape=triangle", "motion.shape = 'triangle': must be 'sine'"),
        ("run.profiles=true", "run.profiles = True: not used with mode = 'approach-curve', which"),
        ("cantilever.frequency=0 Hz", "cantilever.frequency = '0 Hz': must be greater than 0"),
    ],
)
def test_bad_approach_curves(load, override, line):
    assert refusal(load, SWEEP, override).startswith(line)


@pytest.mark.parametrize(
    ("ratios", "line"),
    [
        ([], "amplitude_ratio = []: must be a list, in square brackets, with at least one entry"),
        (0.5, "amplitude_ratio = 0.5: must be a list"),
        ([0.5, 1.2], "amplitude_ratio[1] = 1.2: must be above 0 and below 1"),
        ([-0.5, 0.2], "amplitude_ratio[0] = -0.5: must be above 0 and below 1"),
        (["0.5"], "amplitude_ratio[0] = '0.5': must be a plain number"),
        ([0.5] * 1001, "amplitude_ratio = [0.5, 0.5, "),
    ],
)
def test_bad_lists_of_ratios(load, ratios, line):
    motion = {"free_amplitude": "15 nm", "amplitude_ratio": ratios}
    assert refusal(load, {**SWEEP, "motion": motion}).startswith(f"motion.{line}")


@pytest.mark.parametrize(
    ("key", "needs"),
    [
        ("stiffness", "a stiffness with its unit, such as '28 N/m'"),
        ("quality_factor", "a number, such as 430"),
        ("frequency", "a frequency with its unit, such as '278 kHz'"),
    ],
)
def test_an_approach_curve_needs_the_whole_cantilever(load, key, needs):
    line = refusal(load, changed(SWEEP, f"cantilever.{key}", None))
    assert line == f"cantilever.{key}: missing; must be {needs}"
    line = refusal(load, changed(SWEEP, "cantilever", None))
    assert line == "cantilever: missing; add a table [cantilever]"


@given(st.sampled_from(["free_amplitude", "first_ratio", "last_ratio", "points"]), anything)
@few
def test_garbage_in_approach_curves(load, key, value):
    document = changed(SWEEP, f"motion.{key}", value)
    with contextlib.suppress(ConfigError):
        assert load(document).motion
        return
    assert refusal(load, document).startswith("motion.")


WHOLE = "must be a whole number"


@pytest.mark.parametrize(
    ("solver", "override", "line"),
    [
        (ATTARD, "nodes=1", "nodes = 1: must be a whole number from 2 to 2000"),
        (ATTARD, "nodes=true", f"nodes = True: {WHOLE}"),
        (ATTARD, "nodes=70.0", f"nodes = 70.0: {WHOLE}"),
        (ATTARD, "nodes='70'", f"nodes = '70': {WHOLE}"),
        (ATTARD, "steps=0", "steps = 0: must be a whole number from 1 to 100000000"),
        (ATTARD, "steps=0x" + "f" * 9000, f"steps = (a int too long to show): {WHOLE}"),
        (ATTARD, "domain=12", "domain = 12: must be a length with its unit, such as '10 nm'; the"),
        (ATTARD, "domain=12 s", "domain = '12 s': must be a length with its unit, such as '10 nm'"),
        (ATTARD, "domain=-12 nm", "domain = '-12 nm': must be greater than 0"),
        (ATTARD, "method=implicit", "method = 'implicit': did you mean 'iterative'? It must be"),
        (ATTARD, "method=1", "method = 1: must be 'iterative' or 'explicit'"),
        (ATTARD, "stepper=adams-bashforth", "stepper = 'adams-bashforth': did you mean 'adams-"),
        (ATTARD, "stepper=adams-bashforth-6", "stepper = 'adams-bashforth-6': did you mean 'adam"),
        (ATTARD, "stepper=4", "stepper = 4: must be 'forward-euler', 'adams-bashforth-1', "),
        (ATTARD, "stepper=[4]", "stepper = [4]: must be 'forward-euler', 'adams-bashforth-1', "),
        (ATTARD, "relaxation=2", "relaxation = 2: must be at most 1"),
        (ATTARD, "relaxation=0", "relaxation = 0: must be greater than 0"),
        (ATTARD, "relaxation=1%", "relaxation = '1%': must be a plain number"),
        (ATTARD, "iteration_tolerance=nan", "iteration_tolerance = nan: must be a finite number"),
        (ATTARD, "functions=25", "functions: unknown key; must be 'nodes', 'domain', 'method'"),
        (ENHANCED, "functions=80", "functions = 80: must be a whole number from 1 to 70"),
        (ENHANCED, "basis=sine", "basis = 'sine': did you mean 'cosine'? It must be"),
        (ENHANCED, "expand=h", "expand = 'h': must be 'deformation', 'gap' or 'bounded-gap'"),
        (ENHANCED, "orthogonal=1", "orthogonal = 1: must be true or false"),
        (ENHANCED, "orthogonal=yes", "orthogonal = 'yes': must be true or false"),
        (ENHANCED, "quadrature=gauss", "quadrature = 'gauss': must be 'trapezoid' or 'midpoint'"),
    ],
)
def test_bad_parameters_of_the_papers_solvers(load, solver, override, line):
    found = refusal(load, {**TAP, "solver": solver}, f"solver.{override}")
    assert found.startswith(f"solver.{line}")


def test_fewer_nodes_than_functions_are_refused_though_only_one_is_written(load):
    line = refusal(load, {**TAP, "solver": {**ENHANCED, "nodes": 20}})
    assert line == "solver: functions = 25: must be a whole number from 1 to 20"


@given(
    st.sampled_from(SOLVERS).flatmap(
        lambda solver: st.tuples(
            st.just(solver.kind),
            st.sampled_from([field.name for field in dataclasses.fields(solver)]),
        )
    ),
    anything,
)
@few
def test_garbage_parameters_of_solvers(load, parameter, value):
    name, key = parameter
    document = {**TAP, "solver": {"name": name, key: value}}
    try:
        load(document)
    except ConfigError:
        assert refusal(load, document).startswith("solver")


@pytest.mark.parametrize("solver", [ATTARD, ENHANCED])
def test_fixed_steps_refuse_a_written_tolerance(load, solver):
    document = {**TAP, "solver": solver}
    line = refusal(load, {**document, "run": {"tolerance": 1e-2}})
    assert line == (
        f"run.tolerance = 0.01: the solver '{solver['name']}' takes fixed steps, which no "
        "tolerance changes; leave it out and use solver.steps"
    )
    assert refusal(load, document, "run.tolerance=1e-3").startswith("run.tolerance = 0.001: the so")
    assert refusal(load, document, "run.tolerance=1").startswith("run.tolerance = 1: must be betw")
    assert load({**document, "run": {"profiles": True}}).profiles is True


@pytest.mark.parametrize(
    ("motion", "line"),
    [
        ({"turn": "20 nm"}, "motion.turn = '20 nm': must be below motion.start = '10 nm'"),
        ({"speed": "0 um/s"}, "motion.speed = '0 um/s': must be greater than 0"),
        ({"speed": "5 um"}, "motion.speed = '5 um': must be a speed with its unit, such as '5 um"),
        ({"start": "0.1 nm"}, "motion.start = '0.1 nm': start height"),
        ({"start": None}, "motion: give start, turn and speed, or mean_height, amplitude and freq"),
        ({"frequency": "1 Hz"}, "motion: give start, turn and speed, or mean_height, amplitude an"),
        ({"cycles": 2}, "motion.cycles: unknown key; must be 'start', "),
        ({"dwell": 1}, "motion.dwell = 1: must be a time with its unit, such as '0.1 us'; the uni"),
        ({"dwell": "1 nm"}, "motion.dwell = '1 nm': must be a time with its unit, such as '0.1 u"),
        ({"dwell": "-1 ms"}, "motion.dwell = '-1 ms': must be at least 0"),
        ({"dwell": "inf s"}, "motion.dwell = 'inf s': must be finite"),
        ({"setpoint_force": "5 nm"}, "motion.setpoint_force = '5 nm': must be a force with its u"),
        ({"setpoint_force": "0 nN"}, "motion.setpoint_force = '0 nN': must be greater than 0"),
        ({"setpoint_force": "-5 nN"}, "motion.setpoint_force = '-5 nN': must be greater than 0"),
    ],
)
def test_bad_triangles(load, motion, line):
    written = {k: v for k, v in {**TRIANGLE, **motion}.items() if v is not None}
    for document in (CURVE, SPECTROSCOPY):
        assert refusal(load, {**document, "motion": written}).startswith(line)


@pytest.mark.parametrize(
    ("motion", "line"),
    [
        ({"frequency": "0 Hz"}, "motion.frequency = '0 Hz': must be greater than 0"),
        ({"amplitude": "-1 nm"}, "motion.amplitude = '-1 nm': must be greater than 0"),
        ({"amplitude": "1e-30 m"}, "motion: turn = -1e-08 m: must be below start = -1e-08 m"),
        ({"mean_height": "-60 nm"}, "motion.mean_height = '-60 nm': start height = -1e-08 m: must"),
    ],
)
def test_bad_triangular_waves(load, motion, line):
    assert refusal(load, {**CURVE, "motion": {**WAVE, **motion}}).startswith(line)


@pytest.mark.parametrize(
    ("override", "line"),
    [
        ("cantilever.stiffness=28", "cantilever.stiffness = 28: must be a stiffness with its unit"),
        ("cantilever.stiffness=28 N", "cantilever.stiffness = '28 N': must be a stiffness with it"),
        ("cantilever.stiffness=0 N/m", "cantilever.stiffness = '0 N/m': must be greater than 0"),
        ("cantilever.stiffness=nan N/m", "cantilever.stiffness = 'nan N/m': must be finite"),
        ("cantilever.quality_factor=0", "cantilever.quality_factor = 0: must be greater than 0"),
        ("cantilever.quality_factor=inf", "cantilever.quality_factor = inf: must be a finite num"),
        ("cantilever.quality_factor='9'", "cantilever.quality_factor = '9': must be a plain num"),
        ("cantilever.frequency=1 s", "cantilever.frequency = '1 s': must be a frequency with its"),
        ("cantilever.frequency=-1 Hz", "cantilever.frequency = '-1 Hz': must be greater than 0"),
        ("cantilever.k=1 N/m", "cantilever.k: unknown key; did you mean 'stiffness'? It must be"),
        ("cantilever={}", "cantilever.stiffness: missing; must be a stiffness with its unit, such"),
        ("cantilever=28", "cantilever = 28: must be a table, [cantilever]"),
        ("mode=force-distance", "cantilever: not used with mode = 'force-distance'; leave it out"),
    ],
)
def test_bad_cantilevers(load, override, line):
    assert refusal(load, SPECTROSCOPY, override).startswith(line)


def test_a_missing_cantilever(load):
    line = refusal(load, changed(SPECTROSCOPY, "cantilever", None))
    assert line == "cantilever: missing; add a table [cantilever]"


@given(st.sampled_from(sorted(LEVER)), anything)
@few
def test_garbage_in_cantilevers(load, key, value):
    document = changed(SPECTROSCOPY, f"cantilever.{key}", value)
    try:
        load(document)
    except ConfigError:
        assert refusal(load, document).startswith(f"cantilever.{key} = ")


def test_the_papers_solvers_take_a_lever(load):
    experiment = load(SPECTROSCOPY, "solver.name=attard")
    assert (experiment.solver, experiment.cantilever.stiffness) == (sa.solvers.Attard(), 28.1)


def test_fixed_steps_refuse_a_setpoint_of_force(load):
    line = refusal(load, {**CURVE, "solver": ATTARD}, "motion.setpoint_force=1 nN")
    assert line == (
        "motion.setpoint_force = '1 nN': the solver 'attard' must know the motion beforehand; "
        "leave it out, or use the solver 'energy'"
    )


@pytest.mark.parametrize(
    ("change", "line"),
    [
        ({"compliances": ["1 1/GPa", "-2/GPa"]}, "sample.compliances[1] = '-2/GPa': must be grea"),
        ({"compliances": ["1 1/GPa", "2"]}, "sample.compliances[1] = '2': must be a compliance"),
        ({"compliances": []}, "sample.compliances = []: must be a list"),
        ({"compliances": "1/GPa"}, "sample.compliances = '1/GPa': must be a list"),
        ({"retardation_times": ["1 us"]}, "sample.retardation_times = ['1 us']: has 1 entries"),
    ],
)
def test_bad_kelvin_voigt_chains(load, change, line):
    assert refusal(load, {**TAP, "sample": {**KELVIN_VOIGT, **change}}).startswith(line)


WINDOW = ["1 ms", "1 s"]
MAXWELL = {"model": "generalized-maxwell", "E_inf": "1 MPa", "moduli": ["1 MPa"], **PRONY}
CELL = {"model": "power-law", "E1": "1 kPa", "exponent": 0.2, "window": WINDOW, "poisson": 0.5}
CONE = {"shape": "cone", "half_angle": "20 deg", "apex_radius": "8 nm"}


@pytest.mark.parametrize(
    ("table", "keys", "line"),
    [
        ("tip", {**CONE, "half_angle": 20}, "tip.half_angle = 20: must be an angle with its unit, "
         "such as '20 deg'; the unit is missing"),
        ("tip", {**CONE, "half_angle": "95 deg"}, "tip.half_angle = '95 deg': must be above 0 and"),
        ("tip", {**CONE, "apex_radius": "0 nm"}, "tip.apex_radius = '0 nm': must be greater than"),
        ("tip", {**CONE, "radius": "8 nm"}, "tip.radius: unknown key; did you mean 'apex_radius'?"),
        ("tip", {"shape": "cone", "apex_radius": "8 nm"}, "tip.half_angle: missing; must be an an"),
        ("tip", {"shape": "flat-punch", "radius": "1 nm", "edge_radius": "2 nm"},
         "tip.edge_radius = '2 nm': must be at most tip.radius = '1 nm'"),
        ("tip", {"shape": "power-law", "exponent": 1.5, "height": "1 nm", "radius": "1 nm"},
         "tip.exponent = 1.5: must be from 2 to 50"),
        ("tip", {"shape": "hyperbola"}, "tip.shape = 'hyperbola': did you mean 'hyperboloid'?"),
        ("tip", {"shape": "measured"}, "tip.file: missing; must be the name of a CSV file"),
        ("sample", {"model": "ldppe"}, "sample.model = 'ldppe': did you mean 'ldpe'?"),
        ("sample", {"model": "ldpe", "poisson": 0.3}, "sample.poisson: unknown key; must be 'mod"),
        ("sample", {"model": "pdms", "mixing_ratio": 3}, "sample.mixing_ratio = 3: must be from 5"),
        ("sample", {"model": "epoxy", "poisson": 0.6}, "sample.poisson = 0.6: must be above -1"),
        ("sample", {"model": "kelvin-voigt", "E": "1 MPa", "poisson": 0.5},
         "sample: give E and creep_time, or E and viscosity, or G and viscosity; found E"),
        ("sample", {"model": "maxwell", "E0": "1 MPa", "relaxation_time": "-1 s", "poisson": 0.5},
         "sample.relaxation_time = '-1 s': must be greater than 0"),
        ("sample", {"model": "maxwell", "G0": "1 MPa", "viscosity": "1 Pa", "poisson": 0.5},
         "sample.viscosity = '1 Pa': must be a viscosity with its unit, such as '1 kPa s'; 'Pa'"),
        ("sample", {**MAXWELL, "moduli": ["1 MPa", "-3 MPa"]},
         "sample.moduli[1] = '-3 MPa': must not be negative"),
        ("sample", {**MAXWELL, "relaxation_times": ["1 ms", "0 s"]},
         "sample.relaxation_times[1] = '0 s': must be greater than 0"),
        ("sample", MAXWELL,
         "sample.relaxation_times = ['1 ms', '1 s']: has 2 entries: must have as many as moduli,"),
        ("sample", {**MAXWELL, "E0": "1 MPa"},
         "sample: give E_inf and moduli, or G_inf and shear_moduli, or E0 and ratios; found"),
        ("sample", {"model": "generalized-maxwell", "E0": "1 MPa", "ratios": [0.5], **PRONY},
         "sample.relaxation_times = ['1 ms', '1 s']: has 2 entries: must have as many as ratios,"),
        ("sample", {"model": "generalized-maxwell", "E0": "1 MPa", "ratios": [0.5, 0.6], **PRONY},
         "sample.ratios = [0.5, 0.6]: add up to 1.1: must add up to at most 1"),
        ("sample", {"model": "generalized-maxwell", "G_inf": "0 Pa", "shear_moduli": ["0 Pa"],
                    **PRONY, "relaxation_times": ["1 s"]},
         "sample.shear_moduli = ['0 Pa']: has no entry above 0 Pa: must have one where "
         "sample.G_inf = '0 Pa'"),
        ("sample", {**CELL, "window": ["1 s", "1 ms"]},
         "sample.window = ['1 s', '1 ms']: must be the shortest and a longer time of the exp"),
        ("sample", {**CELL, "window": ["1 ms"]}, "sample.window = ['1 ms']: must be the shortest"),
        ("sample", {**CELL, "window": ["1 ms", "1 m"]}, "sample.window[1] = '1 m': must be a time"),
        ("sample", {**CELL, "exponent": 1}, "sample.exponent = 1: must be above 0 (elastic) and b"),
        ("sample", {**CELL, "window": ["1e-20 s", "1e20 s"], "error": 1e-3},
         "sample.window = ['1e-20 s', '1e20 s']: error = 0.001 over window = (1e-20, 1e+20) s "
         "needs more than 40 elements: must be larger, or the window shorter"),
        ("sample", {"model": "fractional-standard-linear-solid", "E0": "1 GPa", "E_inf": "2 GPa",
                    "creep_time": "1 ms", **POWER},
         "sample.E_inf = '2 GPa': must be at most sample.E0 = '1 GPa'"),
        ("surface", {"law": "morse", **STICKY}, "surface.decay: missing; must be a length with it"),
        ("surface", {"law": "mors"}, "surface.law = 'mors': did you mean 'morse'?"),
        ("surface", {"law": "dmt", **STICKY, "wall": 0.5},
         "surface.wall = 0.5: must be between 0.02 and 0.25"),
        ("surface", {"law": "dmt", **STICKY, "hamaker": "1e-19 J"},
         "surface: give hamaker, or work_of_adhesion; found "),
        ("surface", {"law": "dugdale", **STICKY, "tension": "1 Pa"},
         "surface.tension = '1 Pa': work_of_adhesion/tension = 0.05 m: must be between"),
        ("surface", {"law": "exponential", **STICKY, "decay": "0.1 nm", "core": "0.2 nm"},
         "surface.core = '0.2 nm': must be shorter than surface.decay = '0.1 nm'"),
        ("surface", {"law": "dlvo", **SALT, "surface_potential": "25 nm", "concentration": "1 mM"},
         "surface.surface_potential = '25 nm': must be a voltage with its unit, such as '-25 mV'"),
        ("surface", {"law": "dlvo", **SALT}, "surface: give debye_length, or concentration; found"),
        ("surface", {"law": "dlvo", **SALT, "concentration": "1 mM", "temperature": "25 degC"},
         "surface.temperature = '25 degC': must be a temperature with its unit, such as '298 K'"),
        ("surface", {**BRUSH, "decay": "1 m"}, "surface.decay = '1 m': must be between 2e-12 and "
         "1e-06 m"),
        ("surface", {"law": "van-der-waals-attraction", "hamaker": "1e-20 J"},
         "surface.law = 'van-der-waals-attraction': its pressure at a gap of 1e-12 m is "),
        ("surface", {"law": "sum"}, "surface.parts: missing; must be tables [[surface.parts]], ea"),
        ("surface", {"law": "sum", "parts": []}, "surface.parts = []: must be a list, in square"),
        ("surface", {"law": "sum", "parts": [BRUSH, 3]},
         "surface.parts[1] = 3: must be a table with a law"),
        ("surface", {"law": "sum", "parts": [{}]}, "surface.parts[0].law: missing; must be 'lenn"),
        ("surface", {"law": "sum", "parts": [BRUSH, {"law": "morze"}]},
         "surface.parts[1].law = 'morze': did you mean 'morse'?"),
        ("surface", {"law": "sum", "parts": [{"law": [1]}]}, "surface.parts[0].law = [1]: must be"),
        ("surface", {"law": "sum", "parts": [{"law": "sum"}]}, "surface.parts[0].law = 'sum': mu"),
        ("surface", {"law": "sum", "parts": [BRUSH, {**BRUSH, "decay": "0.5"}]},
         "surface.parts[1].decay = '0.5': must be a length with its unit, such as '10 nm'; the un"),
        ("surface", {"law": "sum", "parts": [BRUSH, {**BRUSH, "decay": "-1 nm"}]},
         "surface.parts[1].decay = '-1 nm': must be between 2e-12 and 1e-06 m"),
        ("surface", {"law": "sum", "parts": [{**BRUSH, "decai": "1 nm"}]},
         "surface.parts[0].decai: unknown key; did you mean 'decay'?"),
        ("surface", {"law": "sum", "parts": [{"law": "dmt", "z0": "1 nm"}]},
         "surface.parts[0]: give hamaker, or work_of_adhesion; found none of them"),
        ("surface", {"law": "sum", "parts": [{"law": "van-der-waals-attraction",
                                              "hamaker": "1e-20 J"}]},
         "surface.law = 'sum': its pressure at a gap of 1e-12 m is "),
    ],
)  # fmt: skip
def test_bad_tips_samples_and_surfaces(load, table, keys, line):
    assert refusal(load, {**TAP, table: keys}).startswith(line)


@pytest.mark.parametrize(
    ("table", "keys", "content", "line"),
    [
        ("tip", {"shape": "measured"}, "radius (nm),height (nm)\n0,0\n2,0.4\n4,0.3\n6,2\n",
         "height[2] = 3e-10 m at r = 4e-09 m: must not be below height[1] = 4e-10 m"),
        ("tip", {"shape": "measured"}, "radius,height\n0,0\n",
         "column 'radius' has no unit: it must be that of a length"),
        ("sample", {"model": "measured-moduli", "poisson": 0.4},
         "frequency (Hz),storage (MPa),loss (MPa)\n10,1,.1\n1,1,.1\n10,2,.2\n",
         "storage is 1e+06 and 2e+06 Pa at one frequency, 10 Hz: must be of one sample at one "),
        ("sample", {"model": "measured-moduli", "poisson": 0.4},
         "frequency (Hz),storage (MPa),loss (MPa)\n1,4,.1\n10,3,.1\n100,2,.1\n1000,1,.1\n",
         "storage = 4e+06 Pa at 1 Hz: no linear passive solid has this beside the other moduli, "),
        ("sample", {"model": "measured-moduli", "poisson": 0.4},
         "frequency (Hz),storage (MPa),loss (MPa)\n1,1,.1\n10,2,-0.1\n",
         "loss[1] = -100000 Pa: must be finite and greater than 0"),
        ("surface", {"law": "tabulated"},
         "gap (nm),pressure (MPa)\n0.2,-1\n0.3,-0.5\n0.5,-0.1\n1,-0.01\n",
         "pressures[0] = -1e+06 Pa at 2e-10 m: must repel, above 0; begin the table at a shorter"),
        ("surface", {"law": "tabulated"}, "gap (nm),pressure (MPa)\n0.2,9\n0.3,x\n",
         "line 3 ('0.3,x'): 'pressure' must be a finite number, such as 0.5 or 5e-9; found 'x'"),
    ],
)  # fmt: skip
def test_bad_measured_things(load, table, keys, content, line):
    (load.folder / "data.csv").write_text(content)
    document = {**TAP, table: {**keys, "file": "data.csv"}}
    assert refusal(load, document).startswith(f"{table}.file = 'data.csv': {line}")
    document = {**TAP, table: {**keys, "file": "none.csv"}}
    assert refusal(load, document) == f"{table}.file = 'none.csv': no such file"


def test_what_is_wrong_beside_a_good_file_is_not_blamed_on_it(load):
    (load.folder / "dma.csv").write_text(FILES["dma.csv"])
    sample = {"model": "measured-moduli", "file": "dma.csv", "poisson": 0.4}
    for key, value, reason in (
        ("poisson", 0.7, "must be above -1 and at most 0.5"),
        ("per_decade", 50, "must be between 0.5 and 10"),
    ):
        line = refusal(load, {**TAP, "sample": {**sample, key: value}})
        assert line == f"sample.{key} = {value}: {reason}"


@given(
    st.sampled_from([b for b in BUILT if b[2]]).flatmap(
        lambda built: st.tuples(st.just(built), st.sampled_from(sorted(built[2]))),
    ),
    anything,
)
@few
@pytest.mark.filterwarnings("ignore::softafm.AccuracyWarning")  # it may be a sample, but a poor one
def test_garbage_in_tips_samples_and_surfaces(load, built, value):
    (table, choice, keys, _), key = built
    for name, content in FILES.items():
        (load.folder / name).write_text(content)
    chooser, _ = schema.CHOICES[table]
    document = {**CURVE, table: {chooser: choice, **keys, key: value}}
    lines = []
    try:
        load(document)
    except ConfigError as refused:  # each entry of a list has a line
        lines = str(refused).splitlines()
    assert all(line.startswith(f"{table}.{key}") for line in lines)


def test_several_problems_are_told_together(load):
    document = changed(changed(TAP, "tip.radius", "10"), "motion.frequency", "1 m")
    with pytest.raises(ConfigError) as refused:
        load(document)
    first, second = str(refused.value).splitlines()
    assert first.startswith("tip.radius")
    assert second.startswith("motion.frequency")


def test_values_out_of_range_are_told_together_with_a_unit_that_does_not_fit(load):
    sample = {"model": "measured-moduli", "file": "none.csv", "poisson": 0.7, "per_decade": "5 m"}
    motion = {**TAP["motion"], "amplitude": "-1 nm", "frequency": "1 m"}
    with pytest.raises(ConfigError) as refused:
        load({**TAP, "sample": sample, "motion": motion})
    assert [line.partition(": ")[0] for line in str(refused.value).splitlines()] == [
        "sample.file = 'none.csv'",
        "sample.poisson = 0.7",
        "sample.per_decade = '5 m'",
        "motion.amplitude = '-1 nm'",
        "motion.frequency = '1 m'",
    ]


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "is empty"),
        (b" \n\t", "is empty"),
        (b"mode = ", "is not valid TOML"),
        (b"mode = 'a'\nmode = 'b'", "is not valid TOML"),
        ("mode = 'café'".encode("latin-1"), "is not text in UTF-8"),
        (b"\xff\xfem\0", "is not text in UTF-8"),
        (b"a = " + b"[" * 100_000, "is not valid TOML"),
        (b"a = " + b"9" * 10_000, "is not valid TOML"),
        (b"#" * 1_000_001, "is 1.0 MB large"),
    ],
)
def test_unreadable_files(load, content, reason):
    line = refusal(load, content)
    assert "experiment.toml: " in line
    assert reason in line


def test_a_huge_number_is_refused_in_a_short_line(load):
    text = toml(TAP).replace("0.49", "0x" + "f" * 100_000)
    assert refusal(load, text).startswith("sample.poisson = ")
    assert refusal(load, TAP, "mode=0x" + "f" * 100_000).startswith("mode = ")


def test_missing_files_folders_and_pipes(tmp_path):
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe.toml")
    for name, reason in (
        ("none.toml", "no such file"),
        ("", "is a directory"),
        ("pipe.toml", "is not a regular file"),
        ("x" * 5000, "File name too long"),
        ("nul\0byte", "no such file"),
    ):
        with pytest.raises(ConfigError, match=reason):
            load_experiment(tmp_path / name)


# Measured motions


def measured(load, content, name="motion.csv"):
    (load.folder / "motion.csv").write_bytes(content)
    return {**CURVE, "motion": {"shape": "trajectory", "file": name}}


def test_a_measured_motion_lies_beside_the_file(load):
    content = (
        b"\xef\xbb\xbfheight (nm),force (V),time (us)\r\n10,0.1,0\r\n\r\n-2,0.2,1.5\r\n10,0,3\r\n"
    )
    motion = load(measured(load, content)).motion
    np.testing.assert_allclose(motion.time, [0, 1.5e-6, 3e-6], rtol=1e-14)
    np.testing.assert_allclose(motion.height(motion.time), [10e-9, -2e-9, 10e-9], rtol=1e-14)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "is empty"),
        (b"time (us),height (nm)\n", "at least 2"),
        (b"time (us),height (nm)\n0,10\n", "at least 2"),
        (b"0,10\n1,9\n", "no column 'time'"),
        (b"time,height\n0,10\n1,9\n", "column 'time' has no unit"),
        (b"time (us),z (nm)\n0,10\n1,9\n", "no column 'height'"),
        (b"time (nm),height (nm)\n0,10\n1,9\n", "'time (nm)' must name a unit of a time"),
        (b"time (us),height (nm)\n0,10\n1,x\n", "line 3 ('1,x')"),
        (b"time (us),height (nm)\n0,10\n1\n", "line 3 ('1')"),
        (b"time (us),height (nm)\n0,10\n0,9\n", "must be later than"),
        (b"time (us),height (nm)\n0,10\nnan,9\n", "must be a finite number"),
        (b"time (us),height (nm)\n0,10\n1,inf\n", "must be a finite number"),
        (b"time (us),height (nm)\n0,-10\n1,-12\n", "inside the surface"),
        (b"\xff\xfe\x00", "is not text in UTF-8"),
        (b"time (us),height (nm)\n" + b'"' + b"1" * 200_000, "is not a CSV file"),
    ],
)
def test_bad_measured_motions(load, content, reason):
    line = refusal(load, measured(load, content))
    assert line.startswith("motion.file = 'motion.csv': ")
    assert reason in line


RECORD = "time (us),height (nm)\n" + "".join(
    f"{k},{1.5 + abs(k - 20) / 5 + (-1) ** k / 50:.3f}\n" for k in range(41)
)


def test_a_motion_from_a_file_may_be_smooth_or_measured(load):
    document = measured(load, RECORD.encode())
    motion = load(document).motion
    samples = motion.time, motion.heights
    assert motion == sa.Trajectory(*samples)
    assert load(changed(document, "motion.smooth", True)).motion == sa.Trajectory(*samples, True)
    document = changed(document, "motion.measured", True)
    assert load(document).motion == sa.Trajectory.from_measurement(*samples)
    assert load(document).motion.breaks[1] == pytest.approx(20e-6, rel=0.01)
    document = changed(document, "motion.noise", "0.05 nm")
    assert load(document).motion.noise == pytest.approx(0.05e-9)


@pytest.mark.parametrize(
    ("keys", "line"),
    [
        ({"noise": "1 nm"}, "motion.noise = '1 nm': not used without measured = true"),
        ({"measured": True, "noise": "0 nm"}, "motion.noise = '0 nm': must be greater than 0"),
        ({"measured": True, "noise": 1}, "motion.noise = 1: must be a length with its unit, such"),
        ({"measured": True, "smooth": True}, "motion.smooth = True: not used with measured = tr"),
        ({"measured": "yes"}, "motion.measured = 'yes': must be true or false"),
        ({"smooth": 1}, "motion.smooth = 1: must be true or false"),
        ({"measure": True}, "motion.measure: unknown key; did you mean 'measured'?"),
    ],
)
def test_ways_to_draw_a_motion_that_do_not_go_together(load, keys, line):
    document = measured(load, RECORD.encode())
    document["motion"] |= keys
    assert refusal(load, document).startswith(line)


def test_too_short_a_record_is_refused(load):
    document = measured(load, b"time (us),height (nm)\n0,10\n1,9\n")
    document["motion"]["measured"] = True
    line = "motion.file = 'motion.csv': time has 2 entries: a measurement must have at least 20; "
    assert refusal(load, document).startswith(line)


def test_spectroscopy_moves_the_base_and_other_modes_the_tip(load):
    content = b"# a run\ntime (us),tip_height (nm),base_height (nm)\n0,10,11\n1,8,7\n"
    motion = measured(load, content)["motion"]
    for document, heights in ((CURVE, [10e-9, 8e-9]), (SPECTROSCOPY, [11e-9, 7e-9])):
        assert load({**document, "motion": motion}).motion.heights == pytest.approx(heights)


@pytest.mark.parametrize("name", ["none.csv", "", ".", "\u0000.csv", 3, "x" * 5000])
def test_unreadable_measured_motions(load, name):
    assert refusal(load, measured(load, b"", name)).startswith("motion.file = ")


@given(st.binary(max_size=200))
@few
def test_garbage_measured_motions(load, content):
    assert refusal(load, measured(load, content)).startswith("motion.file = ")
