"""The figure of a contact, of whatever tip, surface law and sample."""

import io
from math import radians

import numpy as np
import pytest

import softafm as sa

W, Z0 = 0.05, 0.3e-9
LJ = sa.LennardJones.from_work_of_adhesion(W, Z0)
TIPS = [
    sa.Paraboloid(1e-8),
    sa.Sphere(1e-6),
    sa.Cone(radians(20), 1e-8),
    sa.Cone(radians(75), 1e-8),
    sa.Hyperboloid(1e-8, radians(30)),
    sa.FlatPunch(1e-7, 1e-8),
    sa.PowerLawTip(50.0, 1e-9, 1e-8),
    sa.MeasuredTip((0, 1e-9, 5e-9, 1e-8), (0, 5e-11, 1.2e-9, 5e-9)),
]
SAMPLES = [
    sa.Elastic(1e9, 0.3),
    sa.Maxwell(1e9, 1e-3, 0.5),
    sa.samples.polyisobutylene(),
    sa.PowerLaw(1e6, 0.3, (1e-3, 1.0), 0.5),
]
LAWS = [LJ, sa.Repulsion(1e8, 1e-9), sa.SumOfLaws((LJ, sa.Repulsion(5e7, 1e-9)))]
CONTACTS = [
    *(sa.Contact(tip, SAMPLES[0], LJ) for tip in TIPS),
    *(sa.Contact(TIPS[0], sample, LJ) for sample in SAMPLES[1:]),
    *(sa.Contact(TIPS[0], SAMPLES[0], law) for law in LAWS[1:]),
]


@pytest.mark.parametrize(
    "contact", CONTACTS, ids=lambda c: f"{c.tip.kind}, {c.sample.kind}, {c.surface.kind}"
)
def test_every_contact_is_drawn(contact):
    with np.errstate(all="raise", under="ignore"):
        figure = sa.plot_contact(contact)
    tip, pressure, potential, times, moduli, creep = figure.axes
    assert [ax.get_title() for ax in (tip, pressure, times)] == [
        f"Tip: {contact.tip.kind}",
        f"Surface law: {contact.surface.kind}",
        f"Sample: {contact.sample.kind}",
    ]
    labels = [ax.get_ylabel() for ax in (tip, pressure, potential, times, moduli, creep)]
    assert [label.rpartition(" (")[0] for label in labels] == [
        *("Height", "Pressure", "Potential", "Relaxation modulus", "Modulus", "Creep compliance")
    ]
    picture = io.BytesIO()
    figure.savefig(picture, dpi=30)
    assert picture.tell() > 1000


@pytest.mark.parametrize("tip", TIPS, ids=lambda tip: tip.kind)
def test_a_tip_is_drawn_beyond_its_apex_without_being_told_how_far(tip):
    (ax,) = sa.plot_tip(tip).axes
    line = ax.get_lines()[0]
    extent = line.get_xdata()[-1] * (1e-6 if "µm" in ax.get_xlabel() else 1e-9)
    assert extent > max(tip.joints, default=0.0)
    flank = min(1.0, float(tip.slope(1e-3)))
    assert tip.slope(0.7 * extent) < 10
    assert tip.slope(extent) >= 0.9 * flank


def test_drawings_refuse_in_the_same_words():
    for draw, noun in ((sa.plot_tip, "tip"), (sa.plot_surface, "law")):
        with pytest.raises(ValueError, match=f"^{noun}s is empty: must hold at least one {noun}$"):
            draw([])
    with pytest.raises(ValueError, match=r"^labels has 1 entries: must have one a law, 2$"):
        sa.plot_surface(LAWS[:2], ["one"])


def test_more_lines_than_colours_are_told_apart_by_dashes():
    (ax, _) = sa.plot_surface([LJ] * 9).axes
    drawn = [line for line in ax.lines if len(line.get_xdata()) > 2]
    assert len({(line.get_color(), line.get_linestyle()) for line in drawn}) == 9
