"""Objects of a wrong kind: one line names the argument, what was given and what would be valid."""

import re

import numpy as np
import pytest
import xarray as xr

import softafm as sa
from softafm.draw.results import plot

TIP, SAMPLE, LAW = sa.Paraboloid(10e-9), sa.Elastic(1e9, 0.3), sa.LennardJones(1e-19, 0.3e-9)
CONTACT = sa.Contact(TIP, SAMPLE, LAW)
RAMP = sa.Triangle(4e-9, 2e-9, 1e-3)
LEVER = sa.Cantilever(28.0, 400, 278e3)
MAP = sa.SampleMap(CONTACT, 1e-6, height=np.zeros((1, 2)))
IMAGING = sa.AmplitudeModulation(LEVER, 1e-8, 0.8)
MODES = {
    "force_distance": lambda contact=CONTACT, **o: sa.force_distance(contact, RAMP, **o),
    "force_spectroscopy": lambda contact=CONTACT, **o: sa.force_spectroscopy(
        contact, LEVER, RAMP, **o
    ),
    "tapping_cycle": lambda contact=CONTACT, **o: sa.tapping_cycle(
        contact, 1e-8, 1e-8, 278e3, 1, **o
    ),
    "approach_curve": lambda contact=CONTACT, **o: sa.approach_curve(
        contact, LEVER, 1e-8, [0.8], **o
    ),
}


class Lacking:
    """A motion, or a solver, of someone who has not read all of the page."""

    kind, breaks, landmarks, top_speed = "lacking", RAMP.breaks, RAMP.landmarks, RAMP.top_speed

    def height(self, time):
        return RAMP.height(time)


@pytest.mark.parametrize(
    ("build", "said"),
    [
        (
            lambda: sa.Contact(SAMPLE, TIP, LAW),
            "tip = Elastic(E=1000000000.0, poisson=0.3): must be a tip such as softafm.Paraboloid",
        ),
        (
            lambda: sa.Contact(TIP, sa.samples.ldpe, LAW),
            "sample = <function ldpe>: must be a sample such as softafm.Elastic; call it: "
            "softafm.samples.ldpe()",
        ),
        (
            lambda: sa.Contact(TIP, sa.Elastic, LAW),
            "sample = <class Elastic>: must be a sample such as softafm.Elastic; call it: "
            "Elastic(...)",
        ),
        (
            lambda: sa.Contact(TIP, "ldpe", LAW),
            "sample = 'ldpe': must be a sample such as softafm.Elastic",
        ),
        (
            lambda: sa.Contact(TIP, SAMPLE, None),
            "surface = None: must be a surface law such as softafm.LennardJones",
        ),
        (
            lambda: sa.force_distance(CONTACT, None),
            "motion = None: must be a motion such as softafm.Triangle",
        ),
        (
            lambda: sa.force_distance(CONTACT, ([0, 1], [1e-9, 0])),
            "motion = ([0, 1], [1e-09, 0]): must be a motion such as softafm.Triangle",
        ),
        (
            lambda: sa.force_distance(CONTACT, sa.Triangle),
            "motion = <class Triangle>: must be a motion such as softafm.Triangle; call it: "
            "Triangle(...)",
        ),
        (
            lambda: sa.force_distance(CONTACT, Lacking()),
            "must be a motion such as softafm.Triangle; it has no velocity and compiled_height",
        ),
        (
            lambda: sa.force_spectroscopy(CONTACT, 2.0, RAMP),
            "cantilever = 2.0: must be a softafm.Cantilever",
        ),
        (
            lambda: sa.approach_curve(CONTACT, sa.Cantilever, 1e-8, [0.5]),
            "cantilever = <class Cantilever>: must be a softafm.Cantilever; call it: "
            "Cantilever(...)",
        ),
        (lambda: sa.scan(None, IMAGING), "sample = None: must be a softafm.SampleMap"),
        (
            lambda: sa.scan(MAP, None),
            "imaging = None: must be an AmplitudeModulation or a ForceVolume",
        ),
        (
            lambda: sa.scan(MAP, IMAGING, solver="energy"),
            "solver = 'energy': must be a solver such as softafm.solvers.Energy()",
        ),
        (lambda: sa.ForceVolume(None), "motion = None: must be a Triangle, a Sine or a Trajectory"),
        (
            lambda: sa.SampleMap(None, 1e-6),
            "materials = None: must be a softafm.Contact, or several in a list",
        ),
        (
            lambda: sa.SampleMap([CONTACT, TIP], 1e-6),
            "materials[1] = Paraboloid(radius=1e-08): must be a softafm.Contact",
        ),
        (
            lambda: sa.SampleMap.mixed([[0.5]], CONTACT, None, 1e-6),
            "other = None: must be a softafm.Contact",
        ),
        (lambda: sa.plot_contact(None), "contact = None: must be a softafm.Contact"),
        (
            lambda: sa.plot_tip(SAMPLE),
            "tips = Elastic(E=1000000000.0, poisson=0.3): must be a tip such as "
            "softafm.Paraboloid, or several in a list",
        ),
        (
            lambda: sa.plot_surface([LAW, TIP]),
            "laws[1] = Paraboloid(radius=1e-08): must be a surface law such as "
            "softafm.LennardJones",
        ),
        (
            lambda: sa.plot_rheology(sa.samples.pdms),
            "sample = <function pdms>: must be a sample such as softafm.Elastic; call it: "
            "softafm.samples.pdms()",
        ),
    ],
)
def test_what_is_of_a_wrong_kind_is_refused_in_one_line(build, said):
    with pytest.raises(ValueError, match=r"^\S+ = ") as refused:
        build()
    assert str(refused.value).endswith(said)
    assert len(str(refused.value).splitlines()) == 1


@pytest.mark.parametrize("run", MODES.values(), ids=MODES)
@pytest.mark.parametrize("regularise", [None, 1.0])
def test_every_mode_refuses_what_is_no_contact_or_no_solver(run, regularise):
    for given in (None, "x", TIP, sa.Contact):
        with pytest.raises(ValueError, match=r"^contact = .*: must be a softafm.Contact"):
            run(given, regularise=regularise)
    for solver in ("energy", sa.solvers.Energy, Lacking()):
        for check in (False, True):
            with pytest.raises(ValueError, match=r"^solver = .*: must be a solver such as"):
                run(solver=solver, check=check, regularise=regularise)
    with pytest.raises(ValueError, match=r"; it has no adaptive and solve$"):
        run(solver=Lacking())


@pytest.mark.parametrize(
    ("name", "use"),
    [
        ("result", lambda given, path: sa.save(given, path / "x.nc")),
        ("result", lambda given, path: sa.export(given, path / "x.csv")),
        ("result", lambda given, path: sa.export(given, path / "x.h5")),
        ("result", lambda given, path: sa.export_gwyddion(given, path / "x.gwy")),
        ("result", lambda given, path: sa.animate(given, path / "x.html")),
        ("result", lambda given, path: sa.plot_profiles(given)),
        ("maps", lambda given, path: sa.plot_map(given)),
        ("datasets", lambda given, path: plot(given)),
    ],
)
def test_what_is_no_result_is_neither_drawn_nor_written(name, use, tmp_path):
    for given in ({"force": 1.0}, None, "x.nc", xr.DataArray(1.0)):
        with pytest.raises(ValueError, match=rf"^{name}(\[0\])? = .*: must be a result") as refused:
            use(given, tmp_path)
        assert len(str(refused.value).splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def test_a_dataset_without_a_curve_has_no_table(tmp_path):
    with pytest.raises(ValueError, match=r"x\.csv: the dataset is not a result of softafm"):
        sa.export(xr.Dataset({"force": ("step", [1.0])}), tmp_path / "x.csv")
    assert list(tmp_path.iterdir()) == []


def test_a_plain_class_of_the_users_own_still_moves_a_tip():
    class Whole(Lacking):
        compiled_height = RAMP.compiled_height

        def velocity(self, time):
            return RAMP.velocity(time)

    result, same = (sa.force_distance(CONTACT, motion) for motion in (Whole(), RAMP))
    np.testing.assert_array_equal(result["force"], same["force"])
    assert '"motion": {"kind": "lacking"}' in result.attrs["experiment"]


def test_a_wrapper_that_passes_attributes_on_still_solves():
    class Logged:
        def __init__(self, solver):
            self._solver = solver

        def __getattr__(self, name):
            return getattr(self._solver, name)

    wrapped = sa.force_distance(CONTACT, RAMP, solver=Logged(sa.solvers.Energy()))
    np.testing.assert_array_equal(wrapped["force"], sa.force_distance(CONTACT, RAMP)["force"])


class Spoiled:
    """A ramp of someone's own in which one attribute is not what it should be."""

    kind, landmarks = "spoiled", RAMP.landmarks
    breaks, top_speed = RAMP.breaks, RAMP.top_speed
    compiled_height = RAMP.compiled_height

    def height(self, time):
        return RAMP.height(time)

    def velocity(self, time):
        return RAMP.velocity(time)

    def __init__(self, **attributes):
        vars(self).update(attributes)


def test_a_motion_of_a_plain_class_is_a_motion():
    one, two = sa.force_distance(CONTACT, Spoiled()), sa.force_distance(CONTACT, RAMP)
    np.testing.assert_array_equal(one["force"], two["force"])


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"breaks": np.array([0.0])}, "motion.breaks = [0.]: of the motion 'spoiled' must be an"),
        ({"breaks": RAMP.breaks[::-1]}, "array of two times or more, s, ever later"),
        ({"landmarks": np.array([1.0])}, "must be an array of times between the breaks"),
        ({"top_speed": 0.0}, "motion.top_speed = 0: of the motion 'spoiled' must be above 0 m/s"),
        ({"top_speed": 0.9e-3}, "must be at least the speed at"),
        ({"height": lambda time: 1e-9}, "motion.height(time) = 1e-09: of the motion"),
        ({"velocity": lambda time: -RAMP.velocity(time)}, "must be the slope of the height there"),
        ({"compiled_height": (RAMP.height, np.zeros(4))}, "compile_when_used(HEIGHT)"),
        ({"compiled_height": (RAMP.compiled_height[0], [0.0])}, "must be an array of floats"),
        (
            {"compiled_height": sa.Triangle(4e-9, 1e-9, 1e-3).compiled_height},
            "must be the height there",
        ),
    ],
)
def test_a_motion_that_contradicts_itself_is_refused(wrong, said):
    with pytest.raises(ValueError, match=re.escape(said)):
        sa.force_distance(CONTACT, Spoiled(**wrong))


class OwnSolver:
    kind, adaptive = "own", True

    def solve(self, contact, motion, *, tolerance, **options):
        return sa.solvers.Energy().solve(contact, motion, tolerance=tolerance, **options)


def test_a_solver_of_a_plain_class_is_a_solver():
    one, two = MODES["force_distance"](solver=OwnSolver()), MODES["force_distance"]()
    np.testing.assert_array_equal(one["force"], two["force"])


def test_a_solver_that_lacks_an_argument_or_a_history_is_refused():
    class Short(OwnSolver):
        def solve(self, contact, motion, *, stiffness=None, tolerance):
            raise AssertionError("must not run")

    class Empty(OwnSolver):
        def solve(self, contact, motion, **options):
            return None

    with pytest.raises(ValueError, match="'own' must take profiles and progress"):
        MODES["force_distance"](solver=Short())
    with pytest.raises(ValueError, match=r"history = None: must be a softafm\.solvers\.History"):
        MODES["force_distance"](solver=Empty())
