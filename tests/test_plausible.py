"""Numbers in a unit that is not the SI's: one line says what may be meant, and is said once."""

import math
import warnings
from contextlib import suppress

import pytest

import softafm as sa
from softafm.errors import DoubtfulValueWarning


@pytest.mark.parametrize(
    ("build", "said"),
    [
        (lambda: sa.Sphere(radius=5), "radius = 5 m: is very large, .* did you mean 5e-09 (5 nm)?"),
        (lambda: sa.Paraboloid(10), "radius = 10 m: .* did you mean 1e-08 (10 nm)?"),
        (lambda: sa.LennardJones(1e-19, z0=0.3), "z0 = 0.3 m: .* did you mean 3e-10 (0.3 nm)?"),
        (lambda: sa.LennardJones(100, 3e-10), "hamaker = 100 J: .* did you mean 1e-19 (100 zJ)?"),
        (lambda: sa.LennardJones.from_work_of_adhesion(50, 3e-10), "= 50 J/m².* 0.05 (50 mJ/m²)?"),
        (lambda: sa.Triangle(10, -5e-9, 1e-7), "start = 10 m: .* did you mean 1e-08 (10 nm)?"),
        (lambda: sa.Triangle(1e-8, -5, 1e-7), "turn = -5 m: .* did you mean -5e-09 (-5 nm)?"),
        (lambda: sa.Triangle(1e-8, -5e-9, 200), "speed = 200 m/s: .* 2e-07 (200 nm/s)?"),
        (lambda: sa.Triangle(1e-8, 0, 1e-7, setpoint_force=5), "= 5 N: .* 5e-09 (5 nN)?"),
        (lambda: sa.MeasuredTip([0, 1, 2, 5], [0, 0.1, 0.3, 2]), "r[3] = 5 m: .* 5e-09 (5 nm)?"),
        (lambda: sa.Sine(46e-9, 50, 278e3), "amplitude = 50 m: .* did you mean 5e-08 (50 nm)?"),
        (lambda: sa.Elastic(2e-9, 0.5), "E = 2e-09 Pa: is very small, .* 2 (2e-09 GPa)?"),
    ],
)
def test_values_that_are_hardly_meant_in_si(build, said):
    with pytest.warns(DoubtfulValueWarning) as warned:
        build()
    text = str(warned[0].message)
    for part in said.split(".*"):
        assert part.strip() in text
    assert len(text.splitlines()) == 1
    assert issubclass(DoubtfulValueWarning, UserWarning)
    assert warned[0].filename == __file__


@pytest.mark.parametrize(
    "build",
    [
        lambda: sa.Sphere(100e-6),  # a colloidal probe
        lambda: sa.FlatPunch(3e-3, 1e-5),  # of a rheometer
        lambda: sa.Elastic(1.0, 0.5),  # a very soft gel
        lambda: sa.Elastic(1.2e12, 0.2),  # diamond
        lambda: sa.Cantilever(0.006, 1.5, 2e3),
        lambda: sa.LennardJones.from_work_of_adhesion(1.0, 1e-9),
        lambda: sa.Triangle(1e-3, -1e-4, 1e-3, setpoint_force=1e-2),
        lambda: sa.Sine(0.0, 100e-9, 2e6),
        lambda: sa.Sphere(math.nextafter(1e-2, 0)),
    ],
)
def test_real_experiments_are_not_doubted(build):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        build()


def test_a_run_says_it_once():
    lever = sa.Cantilever(28.1, 430, 278e3)
    soft = sa.StandardLinearSolid(2e9, 0.5e9, 1e-7, 0.49)
    contact = sa.Contact(sa.Paraboloid(10e-9), soft, sa.LennardJones(1e-19, 0.3e-9))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        with suppress(sa.DivergedError):  # no tap of such a lever comes to an end
            sa.approach_curve(contact, lever, 0.02, [0.9, 0.8], tolerance=0.1)
    doubts = [each for each in caught if each.category is DoubtfulValueWarning]
    assert [str(each.message).partition(":")[0] for each in doubts] == ["free_amplitude = 0.02 m"]


def test_files_are_doubted_in_one_line(softafm, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    softafm("example", "ldpe-tapping")
    code, _, err = softafm("info", "ldpe-tapping.toml", "--set", "tip.radius=5 m")
    assert code == 0
    assert err.startswith("softafm: warning: radius = 5 m: is very large")
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize(
    "call",
    [
        lambda: sa.force_distance(None, None, tolerance="x"),
        lambda: sa.Elastic(1e9, "x"),
        lambda: sa.Cantilever(28, "x", 1e5),
        lambda: sa.PowerLaw(1e6, "x", (1e-6, 1.0), 0.5),
        lambda: sa.GeneralizedMaxwell.from_ratios(1e9, ["x"], [1.0], 0.5),
        lambda: sa.VanDerWaals(1e-19, 3e-10, exponent="x"),
        lambda: sa.samples.pdms("x"),
        lambda: sa.approach_curve(None, None, 1e-8, [0.5], tolerance=[1]),
    ],
)
def test_numbers_without_a_unit_are_asked_for_without_one(call):
    with pytest.raises(ValueError, match=r"= .*: must be a number$"):
        call()
    with pytest.raises(ValueError, match=r"^poisson = nan: must be a finite number$"):
        sa.Elastic(1e9, math.nan)
