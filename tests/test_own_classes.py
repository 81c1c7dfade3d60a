"""Tips, laws, samples and bodies of a user's own classes: a contact refuses what they must not be.

Without a refusal such a class gives wrong numbers without a word, or a run that does not end.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest

import softafm as sa
from softafm import bodies, rheology
from softafm.compiled.formulas import Term
from softafm.rheology import CreepCompliance

TIP, SAMPLE, LAW = sa.Paraboloid(1e-8), sa.Elastic(1e9, 0.5), sa.LennardJones(1e-19, 0.3e-9)
ONE = np.array([1e-9])
CREEP = CreepCompliance(1e-9, ONE, np.array([1e-3]))


def tip(formula, **stated):
    stated = {"kind": "own", "term": Term(formula, (1e-8,)), **stated}
    return type("Own", (sa.Tip,), stated)()


def law(formula, **stated):
    stated = {"kind": "own", "terms": (Term(formula, (1e6, 1e-10)),), **stated}
    return type("Own", (sa.SurfaceLaw,), stated)()


def sample(compliance=CREEP, poisson=0.3, **stated):
    stated = {"kind": "own", "compliance": compliance, "poisson": poisson, **stated}
    return type("Own", (rheology.Solid,), stated)()


def body(factor, length: Any = 2e-8, **stated):
    stated = {"kind": "own", "length": length, "factor": lambda _, x: factor(x), **stated}
    return type("Own", (bodies.Layered,), stated)(SAMPLE)


def decaying(h, P, decay):
    p = P * np.exp(-h / decay)
    return p, -p / decay, p * decay


def on_soft(x):
    return 1 + np.exp(-x)


REFUSED_TIPS = [
    (tip(lambda r, R: R - np.sqrt(R * R - r * r)), r"nan m at 1.0\d*e-08 m: must be finite$"),
    (tip(lambda r, R: 1e-9 + r * r / R), "1e-09 m at radius 0: must be 0, the apex$"),
    (tip(lambda r, R: 0.5 * r), r"rises as radius\^1 at radius 0: must rise as radius\^2"),
    (tip(lambda r, R: -r * r / R), "must never fall$"),
    (tip(lambda r, R: r if r < R else R), "its term must be a formula of arrays .* ValueError: "),
    (tip(lambda r, R: list(r * r)), "its term must be a formula of arrays .* it returns "),
    (tip(lambda r: r * r), "its term must be a formula of arrays .* TypeError: "),
    (tip(lambda r, R: r * r / R + 0j), "its term must be a formula of arrays .* complex128"),
]


@pytest.mark.parametrize(("own", "said"), REFUSED_TIPS)
def test_a_tip_that_is_no_profile_is_refused(own, said):
    with pytest.raises(ValueError, match=f"^tip 'own': .*{said}"):
        sa.Contact(own, SAMPLE, LAW)


def test_a_tip_may_have_whole_numbers_for_parameters():
    """Handed to the compiled loop as they are, they would be read as the bits of floats."""
    own = tip(None, term=Term(lambda r, n: 1e6 * n * r * r, (50,)))
    ramp = sa.Triangle(2e-9, 0.0, 1e-6)
    forces = (sa.force_distance(sa.Contact(each, SAMPLE, LAW), ramp).force for each in (own, TIP))
    np.testing.assert_allclose(*forces, rtol=1e-6)


REFUSED_LAWS = [
    (lambda h, P, d: (P * np.exp(-h / d), P / d * np.exp(-h / d), P * d * np.exp(-h / d)),
     r"slope .* Pa/m at 1e-12 m: must be dp/dh = -"),
    (lambda h, P, d: (*decaying(h, P, d)[:2], -decaying(h, P, d)[2]), "must be −dΦ/dh"),
    (lambda h, P, d: decaying(h, P, d)[:2], "must be formulas of arrays that return .pressure, "),
    (lambda h: decaying(h, 1e6, 1e-10), "must be formulas .* TypeError: "),
    (lambda h, P, d: decaying(h, P, d) if h > 0 else 0, "must be formulas .* ValueError: "),
    (lambda h, P, d: decaying(h, P * np.nan, d), "pressure nan at 1e-12 m: must be finite$"),
]  # fmt: skip


@pytest.mark.parametrize(("formula", "said"), REFUSED_LAWS)
def test_a_law_whose_formulas_do_not_agree_is_refused_also_in_a_sum(formula, said):
    for surface in (law(formula), LAW + law(formula)):
        with pytest.raises(ValueError, match=f"^surface law 'own': .*{said}"):
            sa.Contact(TIP, SAMPLE, surface)


def test_a_law_must_repel_but_a_part_of_a_sum_need_not():
    pulling = law(lambda h, P, d: decaying(h, -P, d))
    with pytest.raises(ValueError, match=r"^surface law 'own': .* must repel \(above 0\)"):
        sa.Contact(TIP, SAMPLE, pulling)
    sa.Contact(TIP, SAMPLE, LAW + pulling)


REFUSED_SAMPLES = [
    (sample(CREEP._replace(elements=np.array([np.nan]))),
     r"compliance.elements\[0\] = nan 1/Pa: must be a finite number"),
    (sample(CREEP._replace(retardation_times=np.array([-1.0]))),
     r"compliance.retardation_times\[0\] = -1 s: must be greater than 0"),
    (sample(CREEP._replace(elements=np.array([1e-9, 1e-9]))),
     "compliance.retardation_times has 1 entries: must have as many as .*compliance.elements, 2"),
    (sample(CreepCompliance(1e-9, 1e-9, 1e-3)),
     "compliance.elements = 1e-09: must be a list of numbers in 1/Pa"),
    (sample(CREEP._replace(instantaneous=0.0)),
     "compliance.instantaneous = 0 1/Pa: must be greater than 0"),
    (sample(CREEP._replace(fluidity=-1.0)), "compliance.fluidity = -1 1/.* must not be negative"),
    (sample(CREEP._replace(instantaneous=1e9)),
     r"compliance = 1e\+09 1/Pa: must be at most 1e\+06 1/Pa, the inverse of a modulus"),
    (sample((1e-9, ONE, ONE)), "compliance = .*: must be a softafm.rheology.CreepCompliance"),
    (sample(poisson=0.6), "poisson = 0.6: must be above -1 and at most 0.5"),
    (sample(poisson=45), "poisson = 45: must be above -1 and at most 0.5"),
]  # fmt: skip


@pytest.mark.parametrize(("own", "said"), REFUSED_SAMPLES)
def test_a_sample_that_no_material_can_be_is_refused(own, said):
    with pytest.raises(ValueError, match=rf"^sample\.{said}"):
        sa.Contact(TIP, own, LAW)
    with pytest.raises(ValueError, match=rf"^sample\.sample\.{said}"):
        sa.Contact(TIP, bodies.HalfSpace(own), LAW)
    with pytest.raises(ValueError, match=rf"^sample\.{said}"):
        sa.plot_rheology(own)


REFUSED_FACTORS = [
    (lambda x: 0.5 * on_soft(x), "= 0.5 at wavenumber 20: must be 1 to six digits"),
    (lambda x: 1 - 0.5 / (1 + x**2), "= 0.998753 at wavenumber 20: must be 1 to six digits"),
    (lambda x: 1 - 1 / (1 + x), "= 0.952381 at wavenumber 20: must be 1 to six digits"),
    (lambda x: 2e-8 * on_soft(x), "= 2e-08 at wavenumber 20: must be 1 to six digits"),
    (lambda x: 0.1 + 0 * x, "= 0.1 at wavenumber 20: must be 1 to six digits"),
    (lambda x: 1 + np.exp(-x) / x, "= 10000 at wavenumber 0.0001: must level off towards 0"),
    (lambda x: np.nan * x, "= nan at wavenumber 0.0001: must be positive and finite"),
    (lambda x: -on_soft(x), r"= -1.9999 at wavenumber .*: must be positive and finite"),
    (lambda x: None, ": of the body 'own' must be a formula of arrays .* it returns None"),
    (list, ": of the body 'own' must be a formula of arrays .* it returns "),
    (lambda x: on_soft(x)[:3], ": of the body 'own' must be a formula of arrays .* of shape .3,"),
    (lambda x: 1 if x > 20 else 2, ": of the body 'own' must be a formula of arrays .* ValueErr"),
    (lambda x: on_soft(x) + 0j, ": of the body 'own' must be a formula of arrays .* complex128"),
]


@pytest.mark.parametrize(("factor", "said"), REFUSED_FACTORS)
def test_a_layered_body_with_a_wrong_factor_is_refused(factor, said):
    sa.Contact(TIP, body(on_soft), LAW)
    with pytest.raises(ValueError, match=f"^sample.factor ?{said}"):
        sa.Contact(TIP, body(factor), LAW)


@pytest.mark.parametrize(
    ("length", "said"),
    [
        (0, "= 0 m: must be greater than 0"),
        (-2e-8, "= -2e-08 m: must be greater than 0"),
        (np.nan, "= nan m: must be a finite number"),
        (np.inf, "= inf m: must be a finite number"),
        ("20 nm", "= '20 nm': must be a number in m"),
        (lambda self: 2e-8, "= <bound method .*: must be a number in m"),
    ],
)
def test_the_length_of_a_layered_body_is_a_positive_number(length, said):
    with pytest.raises(ValueError, match=f"^sample.length {said}"):
        sa.Contact(TIP, body(on_soft, length), LAW)


def test_a_layered_body_states_length_and_factor():
    for missing in ("length", "factor"):
        stated = {"kind": "own", "length": 1e-8, "factor": lambda _, x: on_soft(x)}
        del stated[missing]
        with pytest.raises(TypeError, match=f"abstract class Own .*{missing}"):
            type("Own", (bodies.Layered,), stated)(SAMPLE)


def test_a_class_that_derives_its_name_from_another_is_refused():
    """Results would record the other one."""

    @dataclass(frozen=True)
    class Unnamed(bodies.Layered):
        length: float = 1e-8

        def factor(self, wavenumber):
            return on_soft(wavenumber)

    named = type("Named", (Unnamed,), {"kind": "named"})
    sa.Contact(TIP, named(SAMPLE), LAW)
    must = r"must be a name that the class \S+ states, as text: results record it$"
    with pytest.raises(ValueError, match=rf"^sample.kind = 'half-space': {must}"):
        sa.Contact(TIP, Unnamed(SAMPLE), LAW)
    with pytest.raises(ValueError, match=rf"^sample.kind = None: {must}"):
        sa.Contact(TIP, sample(kind=None), LAW)
    with pytest.raises(ValueError, match=rf"^tip.kind = None: {must}"):
        sa.Contact(tip(lambda r, R: r * r / R, kind=None), SAMPLE, LAW)
    with pytest.raises(ValueError, match=rf"^surface.kind = 5: {must}"):
        sa.Contact(TIP, SAMPLE, law(decaying, kind=5))
    derived = type("Derived", (sa.Elastic,), {})
    with pytest.raises(ValueError, match=rf"^sample.kind = 'elastic': {must}"):
        sa.Contact(TIP, derived(1e9, 0.3), LAW)


def test_a_body_whose_estimated_depth_never_rises_is_refused():
    class Bottomless(bodies.HalfSpace):
        kind: ClassVar[str] = "bottomless"

        def depth(self, tip, radius, modulus, work_of_adhesion):
            return np.zeros_like(radius)

    contact = sa.Contact(TIP, Bottomless(SAMPLE), LAW)
    with pytest.raises(ValueError, match="of the body 'bottomless' is 1e-09 m deep"):
        contact.contact_radius(-1e-9)


def test_a_body_in_place_of_a_sample_is_told_of_its_sample():
    with pytest.raises(ValueError, match=r"this is a body: take its sample, as body\.sample"):
        sa.plot_rheology(body(on_soft))


def helper(gap):
    return gap + undefined  # noqa: F821


def test_what_numba_does_not_compile_is_said_in_its_own_words():
    def uses_plain_python(gap, a):
        return helper(gap), a, a

    with pytest.raises(ValueError, match="Untyped global name 'helper'") as caught:
        sa.CustomSurface(uses_plain_python, a=1.0)
    assert "\x1b" not in str(caught.value)
    assert str(caught.value).isprintable()
