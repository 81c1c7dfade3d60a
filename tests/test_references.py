"""Known answers beside results: drawn by name, where they suit, and refused where they do not."""

import json
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
import xarray as xr

import softafm as sa
from softafm import bodies, indentation, tips
from softafm.draw.described import read_contact
from softafm.results.datasets import describe

R = 1e-6
PARABOLOID = sa.Paraboloid(R)
RUBBER = sa.StandardLinearSolid(10e6, 1e6, 1e-2, 0.5)
STICKY = sa.LennardJones.from_work_of_adhesion(0.05, 8e-9)
WALL = sa.Repulsion(1e9, 0.5e-9)


def press(sample, law, tip=PARABOLOID, motion=None, **options):
    motion = motion or sa.Triangle(50e-9, -50e-9, 1e-5)
    return sa.force_distance(sa.Contact(tip, sample, law), motion, **options)


@pytest.fixture(scope="module")
def elastic():
    return press(sa.Elastic(2e6, 0.5), STICKY, motion=sa.Triangle(150e-9, -50e-9, 1e-6))


@pytest.fixture(scope="module")
def hard():
    return press(sa.Elastic(2e6, 0.5), WALL)


@pytest.fixture(scope="module")
def viscous():
    return press(RUBBER, WALL)


def find_lines(figure, label):
    """Lines of a reference, SI: both axes are in nano."""
    lines = [line for ax in figure.axes for line in ax.lines if line.get_label() == label]
    return [(1e-9 * line.get_xdata(), 1e-9 * line.get_ydata()) for line in lines]


def list_legend(figure):
    return [text.get_text() for ax in figure.axes for text in ax.get_legend().get_texts()]


def test_jkr_by_name_lies_beside_an_adhesive_run(elastic):
    figure = sa.plot(elastic, reference="jkr")
    ((height, force),) = find_lines(figure, "JKR")
    assert force.min() == pytest.approx(indentation.jkr_pull_off(R, 0.05), rel=1e-4)
    # On the way up the run follows the stable branch at a gap of z0; its Tabor number is 6.
    last = int(height.argmax())
    up = np.arange(elastic.time.size) > int(np.argmin(elastic.tip_height.values))
    up &= elastic.tip_height.values < 100e-9
    known = np.interp(-elastic.tip_height.values[up], -height[last:], force[last:])
    assert elastic.force.values[up] == pytest.approx(known, abs=0.03 * abs(force.min()))
    assert list_legend(figure)[-1] == "JKR"


def test_several_are_told_apart(elastic):
    own = sa.indentation.jkr(PARABOLOID, 3e6, 0.05, 50e-9)
    pair = np.array([0.0, 50e-9]), np.array([-1e-7, 0.0])
    figure = sa.plot(elastic, reference=["hertz", "dmt", "maugis", own, pair])
    names = ["Hertz (no adhesion)", "DMT", "Maugis-Dugdale", "reference[3]", "reference[4]"]
    assert list_legend(figure)[-5:] == names
    looks = [
        (line.get_color(), line.get_linestyle())
        for ax in figure.axes
        for line in ax.lines
        if line.get_label() in names[:4]
    ]
    assert len(set(looks)) == 4
    ((height, force),) = find_lines(figure, "DMT")
    assert height[0] > height[-1]
    assert force.min() == pytest.approx(indentation.dmt_pull_off(R, 0.05))
    ((height, force),) = find_lines(figure, "reference[3]")
    assert height == pytest.approx(own.height)


def test_a_curve_alone_is_drawn_as_it_is(elastic):
    own = sa.indentation.jkr(PARABOLOID, 3e6, 0.05, 50e-9)
    ((height, force),) = find_lines(sa.plot(elastic, reference=own), "reference")
    assert force == pytest.approx(own.force)
    assert height == pytest.approx(own.height)


def test_hertz_is_counted_from_where_a_wall_carries_the_mean_pressure(hard):
    ((height, force),) = find_lines(sa.plot(hard, reference="hertz"), "Hertz (no adhesion)")
    known = np.interp(hard.tip_height.values, height[::-1], force[::-1])
    assert hard.force.values == pytest.approx(known, abs=0.02 * float(hard.force_max))
    deepest = np.interp(float(hard.tip_height.min()), height[::-1], force[::-1])
    assert float(hard.force_max) == pytest.approx(deepest, rel=0.01)


def test_ting_by_name_follows_the_motion_of_each_run(viscous):
    slow = press(RUBBER, WALL, motion=sa.Triangle(50e-9, -50e-9, 1e-6))
    figure = sa.plot([viscous, slow], reference="ting")
    for run, (height, force) in zip(
        (viscous, slow), find_lines(figure, "Ting (no adhesion)"), strict=True
    ):
        assert height.min() == pytest.approx(float(run.tip_height.min()))
        assert force.max() == pytest.approx(float(run.force_max), rel=0.01)
        loop = -np.trapezoid(force, height)
        assert loop == pytest.approx(float(run.loop_energy), rel=0.06)
    assert list_legend(figure)[-1] == "Ting (no adhesion)"
    colours = [
        line.get_color()
        for line in figure.axes[0].lines
        if line.get_label() == "Ting (no adhesion)"
    ]
    assert len(set(colours)) == 2


def test_lee_and_radok_end_at_the_turn(viscous):
    ((height, force),) = find_lines(
        sa.plot(viscous, reference="lee-radok"), "Lee-Radok (no adhesion)"
    )
    assert np.all(np.diff(height) < 1e-15)
    assert force[-1] == pytest.approx(float(viscous.force_max), rel=0.01)


def test_one_answer_for_all_runs_is_drawn_once(hard):
    figure = sa.plot([hard, hard], reference="hertz")
    assert len(find_lines(figure, "Hertz (no adhesion)")) == 1


def test_on_a_lever_and_in_a_tap_the_way_of_the_tip_counts():
    contact = sa.Contact(PARABOLOID, RUBBER, WALL)
    lever = sa.Cantilever(stiffness=0.5)
    run = sa.force_spectroscopy(contact, lever, sa.Triangle(50e-9, -150e-9, 1e-5))
    ((_, force),) = find_lines(sa.plot(run, reference="ting"), "Ting (no adhesion)")
    assert force.max() == pytest.approx(float(run.force_max), rel=0.02)
    quick = sa.Contact(PARABOLOID, replace(RUBBER, creep_time=1e-6), WALL)
    tap = sa.tapping_cycle(quick, 50e-9, 20e-9, 1e3)
    assert tap.attrs["solver_cycles"] == 1
    ((_, force),) = find_lines(sa.plot(tap, reference="ting"), "Ting (no adhesion)")
    assert force.max() == pytest.approx(float(tap.force_max), rel=0.02)
    slow = sa.tapping_cycle(contact, 50e-9, 20e-9, 1e3)
    with pytest.raises(ValueError, match=r"'ting': is of one dent in a surface at rest, and this"):
        sa.plot(slow, reference="ting")


@pytest.mark.parametrize("name", ["hertz", "jkr", "dmt", "maugis"])
def test_elastic_answers_do_not_suit_viscoelastic_samples(viscous, name):
    said = f"^reference = '{name}': is of an elastic sample, and 'standard-linear-solid' creeps"
    with pytest.raises(ValueError, match=said):
        sa.plot(viscous, reference=name)


@pytest.mark.parametrize("name", ["jkr", "dmt", "maugis"])
def test_adhesive_answers_need_adhesion(hard, name):
    said = f"^reference = '{name}': is of an adhesive contact, and the law 'repulsion' has no"
    with pytest.raises(ValueError, match=said):
        sa.plot(hard, reference=name)


# The ramp ends in contact, on purpose.
@pytest.mark.filterwarnings("ignore:audit. .*:softafm.AccuracyWarning")
def test_what_else_does_not_suit_is_refused(elastic, hard):
    cone = press(sa.Elastic(2e6, 0.5), STICKY, tip=tips.Cone(1.2, 1e-7))
    with pytest.raises(ValueError, match=r"'dmt': is of a paraboloid, and the tip is a 'cone'"):
        sa.plot(cone, reference="dmt")
    with pytest.raises(ValueError, match=r"reference\[1\] = 'jrk': did you mean 'jkr'\?"):
        sa.plot(elastic, reference=["hertz", "jrk"])
    away = press(sa.Elastic(2e6, 0.5), WALL, motion=sa.Triangle(90e-9, 40e-9, 1e-6))
    with pytest.raises(
        ValueError, match=r"'ting': motion: its lowest height is .* must come below"
    ):
        sa.plot(away, reference="ting")


# Contacts that results describe


def describe_contact(contact):
    """A result as far as its contact goes."""
    parts = {"tip": contact.tip, "sample": contact.sample, "surface": contact.surface}
    described = {role: describe(part) for role, part in parts.items()}
    return xr.Dataset(attrs={"experiment": json.dumps(described)})


@pytest.mark.parametrize(
    ("tip", "sample", "law"),
    [
        (PARABOLOID, sa.Elastic(1e9, 0.3), STICKY),
        (tips.Cone(0.4, R), sa.samples.pdms(), sa.Morse(0.05, 1e-9, 0.5e-9)),
        (tips.FlatPunch(R, 0.1 * R), sa.KelvinVoigt(1e6, 1e-3, 0.5), WALL),
        (tips.PowerLawTip(3.0, R, R), sa.Maxwell(1e6, 1e-3, 0.5), sa.DMT(1e-19, 0.2e-9)),
        (tips.Sphere(R), sa.PowerLaw(1e6, 0.2, (1e-6, 1.0), 0.5), STICKY + WALL),
        (tips.Hyperboloid(R, 0.4), bodies.HalfSpace(RUBBER), sa.Dugdale(0.05, 1e-9, 1e7)),
        (
            tips.MeasuredTip((0, 1e-8, 2e-8, 3e-8), (0, 1e-9, 5e-9, 1e-8)),
            sa.GeneralizedMaxwell(1e6, (1e6, 2e6), (1e-3, 1.0), 0.5),
            sa.DLVO(1e-19, 0.3e-9, 0.05, 1e-8),
        ),
    ],
)
def test_contacts_are_built_anew_from_what_results_describe(tip, sample, law):
    contact = sa.Contact(tip, sample, law)
    assert read_contact(describe_contact(contact)) == contact


@dataclass(frozen=True)
class Slab(bodies.Layered):
    kind: ClassVar[str] = "slab"
    length: float = 1e-5

    def factor(self, wavenumber):
        return np.tanh(wavenumber)


def rise(r, radius):
    return r * r / radius


def test_tips_and_laws_of_ones_own_are_refused(hard):
    contact = sa.Contact(tips.CustomTip(rise, radius=R), RUBBER, WALL)
    with pytest.raises(ValueError, match=r"^tip = 'custom': is of a class or function of your own"):
        read_contact(describe_contact(contact))
    described = hard.attrs["experiment"].replace('"kind": "repulsion"', '"kind": "mine"')
    with pytest.raises(ValueError, match=r"^reference = 'hertz': surface = 'mine': is of a class"):
        sa.plot(hard.assign_attrs(experiment=described), reference="hertz")


@pytest.mark.parametrize(
    "damage",
    [
        lambda described: described.pop("tip"),
        lambda described: described["tip"].pop("radius"),
        lambda described: described["tip"].update(kind=["paraboloid"]),
        lambda described: described["sample"].update(E="soft"),
        lambda described: described.update(surface=3),
        lambda described: described.pop("motion"),
        lambda described: described["motion"].pop("kind"),
    ],
)
def test_descriptions_that_are_damaged_are_refused(hard, damage):
    described = json.loads(hard.attrs["experiment"])
    damage(described)
    with pytest.raises(ValueError, match=r"^reference = 'ting': [^\n]+$"):
        sa.plot(hard.assign_attrs(experiment=json.dumps(described)), reference="ting")


def test_bodies_other_than_half_spaces_are_refused(hard, monkeypatch):
    slab = describe(Slab(sa.Elastic(2e6, 0.5)))
    experiment = json.loads(hard.attrs["experiment"]) | {"sample": slab}
    run = hard.assign_attrs(experiment=json.dumps(experiment))
    with pytest.raises(ValueError, match=r"^reference = 'hertz': sample = 'slab': is of a class"):
        sa.plot(run, reference="hertz")
    monkeypatch.setattr(bodies, "Slab", Slab, raising=False)
    with pytest.raises(ValueError, match=r"^reference = 'hertz': is of a half-space, and the"):
        sa.plot(run, reference="hertz")


# On the command line


def test_the_command_line_draws_known_answers(softafm, viscous, tmp_path):
    result, picture = tmp_path / "run.nc", tmp_path / "run.png"
    sa.save(viscous, result)
    named = "--reference", "ting", "--reference", "lee-radok"
    assert softafm("plot", result, "--out", picture, *named)[0] == 0
    assert picture.stat().st_size > 10_000
    code, _, said = softafm("plot", result, "--out", tmp_path / "no.png", "--reference", "hertz")
    assert code == 2
    assert said.startswith("softafm: reference = 'hertz': is of an elastic sample, and")
    assert said.count("\n") == 1
    code, _, said = softafm("plot", result, "--profiles", "--reference", "ting")
    assert (code, said.count("\n")) == (2, 1)
    assert not (tmp_path / "no.png").exists()
