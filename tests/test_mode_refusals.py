"""What a mode of one's own may get wrong is said in a line, before anything is lost."""

import re
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Annotated, ClassVar

import pytest
from own_modes import modes_restored

import softafm as sa
from softafm import modes
from softafm.experiment.config import build_experiment
from softafm.experiment.regime import regime
from softafm.instrument.motions import Triangle
from softafm.units.quantities import LENGTH

SOFT = sa.Contact(
    sa.Paraboloid(1e-6), sa.Elastic(1e6, poisson=0.5), sa.Repulsion(1e10, decay=0.1e-9)
)
FILE = {
    "mode": "dent",
    "tip": {"shape": "paraboloid", "radius": "1 um"},
    "sample": {"model": "elastic", "E": "1 MPa", "poisson": 0.5},
    "surface": {"law": "repulsion", "pressure_at_zero": "10 GPa", "decay": "0.1 nm"},
    "motion": {"depth": "5 nm"},
}


@dataclass(frozen=True)
class Dent:
    kind: ClassVar[str] = "dent"
    depth: Annotated[float, LENGTH]


def dent(contact, depth, **options):
    return modes.perform(modes.MODES["dent"], contact, Dent(depth), **options)


def observe(contact, motion, history):
    return {"base_height": history.tip_height, "rise": history.extreme(history.force, 1)}


DENT = modes.Mode(
    name="dent",
    function=dent,
    motions={"dent": Dent},
    observables={
        **modes.observables("base_height", over=("time",)),
        "rise": modes.Observable("N", "rise of the force"),
    },
    observe=observe,
    path=lambda motion: Triangle(5e-9, -motion.depth, 1e-6),
    figure=modes.Layout((("time", "base_height"),), title=(("rise", "rise"),)),
)


@pytest.fixture(autouse=True)
def restored():
    with modes_restored():
        yield


def refused(line):
    return pytest.raises(ValueError, match=f"^{re.escape(line)}")


def test_a_name_that_is_taken_is_kept_unless_it_is_to_be_replaced():
    built_in = modes.MODES["force-distance"]
    with refused("mode 'force-distance': another mode of this name is registered; take another"):
        modes.register(replace(DENT, name="force-distance"))
    with refused("mode 'force-volume': a kind of imaging has this name"):
        modes.register(replace(DENT, name="force-volume"), replace=True)
    assert modes.MODES["force-distance"] is built_in
    modes.register(DENT)
    modes.register(DENT)
    other = replace(DENT, observables={**DENT.observables, "rise": modes.Observable("J", "work")})
    modes.register(other, replace=True)
    assert modes.MODES["dent"] is other
    assert dent(SOFT, 5e-9).rise.attrs == {"units": "J", "long_name": "work"}


def test_a_record_that_is_refused_leaves_nothing_behind():
    observables = {"push": modes.Observable("N", "push"), "force": modes.Observable("Hz", "shift")}
    wrong = replace(DENT, observables=observables, figure=modes.Layout())
    with refused("observable 'force' of mode 'dent': this name means force on the tip, positive"):
        modes.register(wrong)
    right = {**DENT.observables, "push": modes.Observable("J", "work of the push")}
    modes.register(replace(DENT, observables=right))


def test_a_known_name_is_taken_by_observables():
    stolen = {**DENT.observables, "deflection": modes.Observable("m", "bend", ("time",))}
    with pytest.raises(ValueError, match=r"take observables\('deflection', over=\('time',\)\), w"):
        modes.register(replace(DENT, observables=stolen))


@pytest.mark.parametrize("name", ["Force Curve", "force curve", "force_curve", "", None, "-a"])
def test_a_mode_is_named_as_all_are(name):
    with refused(f"mode {name!r}: its name must be of small letters and digits, with hyphens"):
        replace(DENT, name=name)


@pytest.mark.parametrize("units", ["nm", "nanometre", "nN", "", "deg", None, "5 m"])
def test_observables_are_in_si(units):
    with refused(f"units = {units!r}: must be an SI unit without prefix, such as 'm', 'N/m'"):
        modes.Observable(units, "words")


@pytest.mark.parametrize("units", ["N/m", "1", "degree", "J/m^2", "Pa s", "rad/s", "W", "kg m"])
def test_any_unit_of_the_si_will_do(units):
    assert modes.Observable(units, "words").units == units


def test_dimensions_are_a_tuple_of_what_has_a_meaning():
    with refused("dims = 'time': must be a tuple of names, such as ('time',)"):
        modes.Observable("m", "words", "time")
    over = {**DENT.observables, "rise": modes.Observable("N", "rise", ("tiem",))}
    with refused("mode 'dent': the dimension tiem must be among the observables"):
        modes.register(replace(DENT, observables=over))


def nothing(contact, cantilever, **options):
    raise AssertionError("it was to be refused before any run")


@pytest.mark.parametrize(
    ("change", "line"),
    [
        ({"observables": {"rise": "N"}}, "mode 'dent': observables['rise'] = 'N': must be an Obse"),
        ({"observables": {"a rise": modes.Observable("N", "rise")}}, "mode 'dent': observable 'a "),
        ({"observables": ["rise"]}, "mode 'dent': observables = ['rise']: must be a dict of Obse"),
        ({"motions": [Dent]}, "mode 'dent': motions = [<class 'test_mode_refusals.Dent'>]: must"),
        ({"motions": {"dent": float}}, "mode 'dent': motions['dent'] = <class 'float'>: must be a"),
        ({"tables": {"ramp": 3}}, "mode 'dent': tables['ramp'] = 3: must be a dataclass with a"),
        ({"tables": {"ramp": Dent}}, "mode 'dent': dent has no argument ramp, which is one of its"),
        (
            {"lever": "stiffness"},
            "mode 'dent': dent has no argument cantilever, which lever = 'sti",
        ),
        ({"function": nothing, "motions": {}}, "mode 'dent': motions is empty"),
        (
            {"function": lambda contact, cantilever, depth: None},
            "mode 'dent': <lambda> takes cantilever; lever must be 'stiffness' or 'resonator'",
        ),
        (
            {"function": lambda depth, contact: None},
            "mode 'dent': <lambda> takes depth first; its first arguments must be a contact",
        ),
        (
            {"function": lambda contact, depth, cantilever: None, "lever": "stiffness"},
            "mode 'dent': <lambda> takes contact first; its first arguments must be a contact and",
        ),
    ],
)
def test_a_record_that_is_no_mode_is_refused_when_it_is_made(change, line):
    with refused(line):
        replace(DENT, **change)


@pytest.mark.parametrize(
    "figure",
    [modes.Layout((("time", "rsie"),)), modes.Layout((), title=(("rsie", "rise"),))],
)
def test_a_figure_shows_what_results_hold(figure):
    with refused("mode 'dent': its figure shows 'rsie': did you mean 'rise'?"):
        modes.register(replace(DENT, figure=figure))


@pytest.mark.parametrize(
    ("found", "line"),
    [
        ({"rise": float("nan")}, "mode 'dent': variable 'rise' holds nan N: must be a finite num"),
        ({"rise": 1e31}, "mode 'dent': variable 'rise' holds 1e+31 N: must be within 1e+30"),
        ({"rise": "large"}, "mode 'dent': variable 'rise' holds 'str"),
        ({"rise": None}, "mode 'dent': variable 'rise' holds 'object': must hold numbers"),
        ({"rise": [1.0, 2.0]}, "mode 'dent': observable 'rise' has the shape (2,): must be a si"),
        ({"rise": [1.0, [2.0]]}, "mode 'dent': observable 'rise' = [1.0, [2.0]]: must be numbers"),
        ({"base_height": 0.5}, "mode 'dent': observable 'base_height' has the shape (): must be o"),
        ({"base_height": [1.0]}, "mode 'dent': observable 'base_height' has 1 values along time: "),
        ({"rsie": 1.0}, "mode 'dent': observe returns rsie: must be among its observables"),
    ],
)
def test_what_is_observed_is_refused_before_it_is_a_result(found, line):
    modes.register(replace(DENT, observe=lambda *inputs: {**observe(*inputs), **found}))
    with refused(line):
        dent(SOFT, 5e-9)


@pytest.mark.parametrize(
    ("found", "line"),
    [
        (None, "mode 'dent': observe returns None: must be a dict of the observables by name"),
        (MappingProxyType({}), "mode 'dent': observe returns no base_height and rise: must return"),
    ],
)
def test_all_that_is_to_be_observed_is(found, line):
    modes.register(replace(DENT, observe=lambda *inputs: found))
    with refused(line):
        dent(SOFT, 5e-9)


def test_what_simulate_returns_is_looked_at_too():
    modes.register(replace(DENT, observe=None, simulate=lambda *inputs: None))
    with refused("mode 'dent': simulate = None: must be a function that returns an Outcome"):
        dent(SOFT, 5e-9)


def test_a_path_that_is_no_motion_is_refused_before_any_run():
    modes.register(replace(DENT, path=modes.Mode.path))
    line = "mode 'dent': path = Dent(depth=5e-09): must be a motion such as softafm.Triangle, which"
    for use in (sa.run, regime, lambda file: build_experiment(file, None)):
        with refused(line):
            use(FILE)


def test_a_lever_that_a_mode_does_not_have_is_refused():
    modes.register(DENT)
    with refused(
        "cantilever = Cantilever(stiffness=1.0, quality_factor=None, frequency=...: must be"
    ):
        dent(SOFT, 5e-9, cantilever=sa.Cantilever(stiffness=1.0))


def test_a_misspelt_option_is_that_of_the_function():
    modes.register(DENT)
    line = r"^dent\(\) got tol = 0.001, which is no argument of it: did you mean 'tolerance'\?"
    with pytest.raises(TypeError, match=line):
        dent(SOFT, 5e-9, tol=1e-3)
