"""Samples: known answers of creep, relaxation and moduli, and what is refused."""

import re
from math import gamma, inf, nan, pi
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import erfcx
from scipy.special import gamma as complex_gamma

from softafm import AccuracyWarning, samples
from softafm.draw.sample import plot_rheology
from softafm.rheology import (
    CreepCompliance,
    Elastic,
    FractionalStandardLinearSolid,
    GeneralizedKelvinVoigt,
    GeneralizedMaxwell,
    KelvinVoigt,
    Maxwell,
    PowerLaw,
    StandardLinearSolid,
    chain_to_prony,
    prony_to_chain,
)

decades = st.floats(-3, 3).map(lambda x: 10.0**x)
poisson = st.floats(-0.9, 0.5)
WINDOW = (1e-3, 1.0)
FREQUENCY = np.geomspace(0.01, 1e3, 21)

SAMPLES = [
    Elastic(2e9, 0.3),
    StandardLinearSolid(2e9, 1e8, 1e-2, 0.49),
    KelvinVoigt(1e6, 0.1, 0.5),
    Maxwell(1e6, 0.1, 0.5),
    GeneralizedKelvinVoigt(1e9, (1e-9, 3e-8), (1e-2, 5.0), 0.4),
    GeneralizedMaxwell(1e6, (2e6, 3e6, 4e6), (1e-2, 1.0, 1e2), 0.4),
    GeneralizedMaxwell(0, (2e6, 3e6), (1e-2, 1.0), -0.5),
    PowerLaw(1e6, 0.3, WINDOW, 0.5),
    FractionalStandardLinearSolid(1e9, 1e7, 0.03, 0.6, WINDOW, 0.45),
]


def laplace(function, s):
    """s times the Laplace transform of a function of time, by quadrature in the logarithm."""
    value, _ = quad(
        lambda y: np.exp(y - np.exp(y)) * float(function(np.exp(y) / s)),
        -40,
        4,
        limit=400,
        epsabs=0,
        epsrel=1e-10,
    )
    return value


EVERY = {
    **{f"{sample.kind} {i}": sample for i, sample in enumerate(SAMPLES)},
    "SLS by relaxation time": StandardLinearSolid.from_relaxation_time(2e9, 1e6, 1e-3, 0.49),
    "SLS in shear": StandardLinearSolid.from_shear(1e9, 5e8, 1e-3, -0.2),
    "SLS of one modulus": StandardLinearSolid(1e9, 1e9, 1e-3, 0.3),
    "Kelvin-Voigt by viscosity": KelvinVoigt.from_viscosity(1e3, 10.0, 0.5),
    "Kelvin-Voigt in shear": KelvinVoigt.from_shear(1e3, 10.0, 0.3),
    "Maxwell by viscosity": Maxwell.from_viscosity(1e6, 1e3, 0.5),
    "Maxwell in shear": Maxwell.from_shear(1e6, 1e3, 0.3),
    "series in shear": GeneralizedMaxwell.from_shear(1e3, (1e6, 1e9), (1.0, 1e-4), 0.4),
    "series by ratios": GeneralizedMaxwell.from_ratios(1e9, (0.9, 0.099), (1e-5, 1e-2), 0.4),
    "series of equal times": GeneralizedMaxwell(1e6, (1e6, 2e6), (1e-3, 1e-3), 0.4),
    "series by a fit": GeneralizedMaxwell.from_dma(
        *([1.0, 10.0, 100.0], [1e6, 1.5e6, 3e6], [2e5, 6e5, 1e6]), poisson=0.4
    ),
    "springpot": PowerLaw.springpot(1e5, 0.7, (1e-4, 10.0), 0.5),
    **{f"sample {name}": build() for name, build in samples.NAMED.items()},
}
"""Every class of samples, by each of its constructors, and the named ones."""

NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)


def convolve(one, other, time):
    """Return ∫ one(t − s) other(s) ds from 0 to t, by Gauss's rule in decades of either end.

    The last decade is 1e-24 t: a spring of 1e6 E relaxes in 1e-6 of its creep time.
    """
    ends = np.log(time) + np.append(np.linspace(-24 * np.log(10), -np.log(10), 47), np.log(0.5))
    half, middle = np.diff(ends) / 2, (ends[1:] + ends[:-1]) / 2
    s = np.exp(middle[:, None] + half[:, None] * NODES)
    near = one(time - s) * other(s) + one(s) * other(time - s)
    return float(np.sum(half[:, None] * WEIGHTS * s * near))


# Interconversion


def test_known_chain_of_a_prony_series():
    # Roots of E_inf + Σ E_k s λ_k/(1 + s λ_k) = 0, by bisection in 40 digits.
    creep = prony_to_chain(1, (2, 3, 4), (1e-2, 1, 100))
    assert creep[0] == pytest.approx(0.1, rel=1e-15)
    assert creep[1] == pytest.approx([0.02476130507, 0.07332025921, 0.80191843572], abs=1e-11)
    assert creep[2] == pytest.approx([0.01248804572, 1.59380577872, 502.423706176], rel=1e-9)
    assert creep[3] == 0


def test_order_and_repetition_of_terms_do_not_matter():
    plain = prony_to_chain(1, (2, 3, 4), (1e-2, 1, 100))
    mixed = prony_to_chain(1, (4, 1.5, 0, 2, 1.5), (100, 1, 7, 1e-2, 1))
    for one, other in zip(plain, mixed, strict=True):
        assert other == pytest.approx(one, rel=1e-14)


@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([2, 20, 40]),
    st.sampled_from([1.0, 12.0]),
    st.booleans(),
)
@settings(deadline=None)
def test_modulus_to_compliance_and_back(seed, terms, span, flows):
    rng = np.random.default_rng(seed)
    times = np.sort(10.0 ** rng.uniform(-span / 2, span / 2, terms))
    moduli = 10.0 ** rng.uniform(6, 9, terms)
    E_inf = 0.0 if flows else 10.0 ** rng.uniform(6, 9)
    chain = prony_to_chain(E_inf, moduli, times)
    assert (chain[3] > 0) == flows
    back = chain_to_prony(*chain)
    assert back[0] == pytest.approx(E_inf, rel=1e-8)
    assert back[1] == pytest.approx(moduli, rel=1e-8)
    assert back[2] == pytest.approx(times, rel=1e-8)
    # s J(s) · s E(s) = 1 at any s.
    s = 10.0 ** rng.uniform(-8, 8, 20)
    lag = s[:, None] * chain[2]
    creep = chain[0] + (chain[1] / (1 + lag)).sum(axis=1) + chain[3] / s
    lag = s[:, None] * times
    relaxation = E_inf + (moduli * lag / (1 + lag)).sum(axis=1)
    assert creep * relaxation == pytest.approx(1, rel=1e-12)


def test_weak_terms_keep_their_digits():
    times = np.geomspace(1e-6, 1e6, 20)
    moduli = np.where(np.arange(20) % 2, 1e9, 10.0)
    E_inf, back, _ = chain_to_prony(*prony_to_chain(1e9, moduli, times))
    assert E_inf == pytest.approx(1e9, rel=1e-14)
    assert back == pytest.approx(moduli, rel=1e-8)


@given(decades, st.floats(0.01, 0.99), decades, poisson)
def test_one_prony_term_is_the_standard_linear_solid(E0, ratio, relaxation_time, nu):
    E_inf = ratio * E0
    solid = StandardLinearSolid.from_relaxation_time(E0, E_inf, relaxation_time, nu)
    series = GeneralizedMaxwell(E_inf, [E0 - E_inf], [relaxation_time], nu)
    expected = solid.compliance
    for one, other in zip(expected, series.compliance, strict=True):
        assert other == pytest.approx(one, rel=2e-14)
    assert series.reduced_modulus_relaxed == pytest.approx(solid.reduced_modulus_relaxed, rel=1e-14)


# Creep, relaxation, storage and loss


@pytest.mark.parametrize("sample", SAMPLES, ids=lambda sample: sample.kind)
@pytest.mark.parametrize("s", [0.5, 30.0])
def test_creep_and_relaxation_are_of_one_sample(sample, s):
    # s J(s) · s E(s) = 1, both by quadrature over time.
    product = laplace(sample.creep_compliance, s) * laplace(sample.relaxation_modulus, s)
    assert product == pytest.approx(1, rel=1e-6)


@pytest.mark.parametrize("sample", EVERY.values(), ids=EVERY)
@pytest.mark.parametrize("time", np.geomspace(1e-9, 1e3, 7))
def test_relaxation_and_creep_convolve_to_the_time(sample, time):
    # ∫ E(t − s) J(s) ds = t, the inverse of s E(s) · s J(s) = 1.
    product = convolve(sample.relaxation_modulus, sample.creep_compliance, time)
    assert product == pytest.approx(time, rel=1e-9)


@pytest.mark.parametrize("sample", EVERY.values(), ids=EVERY)
def test_what_is_stiff_at_once_yields_as_little(sample):
    product = sample.relaxation_modulus(0.0) * sample.creep_compliance(0.0)
    assert product == pytest.approx(1, rel=1e-12)


def test_convolution_tells_a_modulus_that_is_only_the_inverse_of_the_compliance():
    # 1/J(t) is not E(t), though it starts and ends as it does.
    sample = EVERY["series in shear"]
    product = convolve(lambda t: 1 / sample.creep_compliance(t), sample.creep_compliance, 1.0)
    assert abs(product - 1) > 0.01


@given(decades, decades, poisson)
def test_the_dashpot_of_a_kelvin_voigt_solid_is_in_its_relaxation(E, creep_time, nu):
    # E(t) = E + Eτ δ(t): what stands for the delta has its area, and is over by 1e-4 τ.
    sample = KelvinVoigt(E, creep_time, nu)
    area = convolve(sample.relaxation_modulus, np.ones_like, 1e-4 * creep_time)
    assert area - 1e-4 * E * creep_time == pytest.approx(E * creep_time, rel=3e-6)
    assert sample.relaxation_modulus(1e-4 * creep_time) == pytest.approx(E, rel=3e-6)


@pytest.mark.parametrize("sample", SAMPLES, ids=lambda sample: sample.kind)
def test_moduli_are_those_of_the_relaxation(sample):
    # E* = E_inf + Σ E_k iωλ_k/(1 + iωλ_k), with the terms of the relaxation modulus.
    E_inf, moduli, times = chain_to_prony(*sample.compliance)
    lag = 2j * pi * FREQUENCY[:, None] * times
    expected = E_inf + (moduli * lag / (1 + lag)).sum(axis=1)
    assert sample.storage_modulus(FREQUENCY) == pytest.approx(expected.real, rel=1e-9)
    scale = 1e-9 * np.abs(expected)
    assert np.all(np.abs(sample.loss_modulus(FREQUENCY) - expected.imag) <= scale)
    assert sample.relaxation_modulus(0.0) == pytest.approx(1 / sample.creep_compliance(0.0))
    assert np.shape(sample.relaxation_modulus([[0.1, 1.0]])) == (1, 2)
    assert np.shape(sample.creep_compliance(1.0)) == ()


@given(decades, decades, poisson)
def test_maxwell_creeps_and_relaxes_as_in_closed_form(E0, relaxation_time, nu):
    sample = Maxwell(E0, relaxation_time, nu)
    time = relaxation_time * np.array([0.0, 0.1, 1.0, 10.0])
    creep = (1 + time / relaxation_time) / E0
    assert sample.creep_compliance(time) == pytest.approx(creep, rel=1e-14)
    decay = E0 * np.exp(-time / relaxation_time)
    assert sample.relaxation_modulus(time) == pytest.approx(decay, rel=1e-12)
    lag = 2 * pi * FREQUENCY * relaxation_time
    assert sample.storage_modulus(FREQUENCY) == pytest.approx(E0 * lag**2 / (1 + lag**2))
    assert sample.loss_modulus(FREQUENCY) == pytest.approx(E0 * lag / (1 + lag**2))
    assert sample.reduced_modulus_relaxed == 0
    assert sample.compliance.relaxed == inf
    # A series of one term without E_inf is the same fluid.
    series = GeneralizedMaxwell(0, [E0], [relaxation_time], nu)
    assert series.creep_compliance(time) == pytest.approx(creep, rel=1e-14)
    assert series.compliance.elements.size == 0


def test_viscosities():
    # Trouton: the extensional viscosity of an incompressible fluid is three times that of shear.
    shear = Maxwell.from_shear(G0=1e6, viscosity=1e3, poisson=0.5)
    assert shear == Maxwell(3e6, 1e-3, 0.5)
    assert shear == Maxwell.from_viscosity(3e6, 3e3, 0.5)
    assert KelvinVoigt.from_shear(1e6, 1e3, 0.5) == KelvinVoigt.from_viscosity(3e6, 3e3, 0.5)


@given(decades, decades)
def test_flow_as_an_element_of_a_chain(E0, relaxation_time):
    creep = Maxwell(E0, relaxation_time, 0.5).compliance
    duration = 7 * relaxation_time
    chain = creep.chain(duration)
    assert chain.fluidity == 0
    assert chain.elements.shape == chain.retardation_times.shape == (1,)
    time = np.linspace(0, duration, 9)
    assert chain.at(time) == pytest.approx(creep.at(time), rel=1e-6)
    solid = StandardLinearSolid(E0, E0 / 2, 1.0, 0.5).compliance
    assert solid.chain(duration) is solid
    with pytest.raises(ValueError, match=r"^duration = 0 s: must be greater than 0$"):
        creep.chain(0)


@given(decades, decades, poisson)
def test_kelvin_voigt_is_the_limit_of_a_stiff_standard_linear_solid(E, creep_time, nu):
    sample = KelvinVoigt(E, creep_time, nu)
    time = creep_time * np.array([0.01, 0.1, 1.0, 10.0])
    ideal = -np.expm1(-time / creep_time) / E
    assert sample.creep_compliance(time) == pytest.approx(ideal, abs=1.01e-6 / E)
    stiff = StandardLinearSolid(1e6 * E, E, creep_time, nu)
    assert sample.creep_compliance(time) == pytest.approx(stiff.creep_compliance(time), rel=1e-5)
    frequency = 1 / creep_time
    assert sample.storage_modulus(frequency) == pytest.approx(E, rel=1e-4)
    assert sample.loss_modulus(frequency) == pytest.approx(2 * pi * E, rel=1e-4)


def test_shear_moduli_and_ratios_of_a_series():
    young = GeneralizedMaxwell(3.0, (6.0, 9.0), (1.0, 2.0), 0.5)
    assert GeneralizedMaxwell.from_shear(1.0, (2.0, 3.0), (1.0, 2.0), 0.5) == young
    ratios = GeneralizedMaxwell.from_ratios(18.0, (6 / 18, 9 / 18), (1.0, 2.0), 0.5)
    assert ratios.E_inf == pytest.approx(3)
    assert ratios.moduli == pytest.approx((6, 9))
    with pytest.warns(AccuracyWarning, match=r"^ratios add up to 1, which leaves E_inf = 0 Pa, a "):
        assert GeneralizedMaxwell.from_ratios(1e9, [0.1] * 10, np.arange(1, 11), 0.5).E_inf == 0
    assert GeneralizedMaxwell(3.0, (), (), 0.5).creep_compliance(1.0) == pytest.approx(1 / 3)


def test_chains_by_position_of_the_old_three_fields():
    creep = CreepCompliance(1.0, np.array([2.0]), np.array([3.0]))
    assert creep.fluidity == 0
    assert creep.at(3.0) == pytest.approx(1 + 2 * (1 - np.exp(-1)))
    assert creep.complex_at(1 / 3) == pytest.approx(1 + 2 / (1 + 1j))


# Power laws


@pytest.mark.parametrize(("per_decade", "least", "most"), [(1, 0.01, 0.02), (2, 1e-5, 2e-4)])
def test_ripple_of_a_power_law_of_equally_spaced_terms(per_decade, least, most):
    # E_k = E1 h λ_k^−a/Γ(a) ripples by 2|Γ(a + 2πi/h)|/Γ(a).
    a, h = 0.2, np.log(10) / per_decade
    times = np.exp(h * np.arange(-40 * per_decade, 40 * per_decade + 1))
    series = GeneralizedMaxwell(0, h * times**-a / gamma(a), times, 0.5)
    time = np.geomspace(1, 10, 200)
    ripple = np.max(np.abs(series.relaxation_modulus(time) * time**a - 1))
    assert ripple == pytest.approx(2 * abs(complex_gamma(a + 2j * pi / h)) / gamma(a), rel=0.01)
    assert least < ripple < most


@pytest.mark.parametrize("exponent", [0.05, 0.3, 0.5, 0.9])
@pytest.mark.parametrize("error", [0.03, 1e-3])
def test_power_laws_are_as_close_as_they_say(exponent, error):
    law = PowerLaw(1e6, exponent, (1e-7, 1e-2), 0.4, 1e-3, error)
    time = np.geomspace(*law.window, 501)
    frequency = 1 / (2 * pi * time)
    # 1/E(t) = sin(πa)/(πa) (t/t0)^a/E1.
    exact = np.sin(pi * exponent) / (pi * exponent) * (time / 1e-3) ** exponent / 1e6
    assert law.exact_creep_compliance(time) == pytest.approx(exact, rel=1e-12)
    creep = np.abs(law.creep_compliance(time) / exact - 1)
    modulus = law.storage_modulus(frequency) + 1j * law.loss_modulus(frequency)
    exact = law.exact_complex_compliance(frequency)
    dynamic = np.abs(1 / modulus / exact - 1)
    assert law.represented_error == pytest.approx(max(creep.max(), dynamic.max()), rel=0.02)
    assert law.represented_error <= error
    # E* = E1 Γ(1 − a) (iωt0)^a and E(t) = E1 (t/t0)^−a, well within the window. The nearer to a
    # fluid, the less of a stress is left by the time it is asked for.
    omega = 2 * pi * frequency * 1e-3
    assert 1 / exact == pytest.approx(1e6 * gamma(1 - exponent) * (1j * omega) ** exponent)
    inner = time[100:-100]
    decay = 1e6 * (inner / 1e-3) ** -exponent
    assert law.relaxation_modulus(inner) == pytest.approx(decay, rel=1.5 * error / (1 - exponent))


def test_numbers_of_elements():
    # One per cent of a springpot takes 1.3 to 1.7 elements a decade, flow included.
    counts = [PowerLaw(1e6, 0.3, (1e-6, top), 0.5).element_count for top in (1e-3, 1, 1e6)]
    assert counts == [6, 10, 17]
    assert PowerLaw(1e6, 0.3, (1e-6, 1), 0.5, error=1e-3).element_count == 14
    assert FractionalStandardLinearSolid(1e9, 1e7, 1e-3, 0.99, (1e-6, 1), 0.5).element_count <= 2


def test_series_scale_with_modulus_and_time():
    one = PowerLaw(1e6, 0.3, (1e-6, 1.0), 0.5)
    other = PowerLaw(2e6, 0.3, (1e-3, 1e3), 0.5, reference_time=1e3)
    chain, scaled = one.compliance, other.compliance
    assert scaled.elements == pytest.approx(chain.elements / 2)
    assert scaled.retardation_times == pytest.approx(1e3 * chain.retardation_times)
    assert scaled.fluidity == pytest.approx(chain.fluidity / 2e3)


def test_springpot():
    # E(t) = V t^−a/Γ(1 − a)
    law = PowerLaw.springpot(5e5, 0.5, (1e-3, 1), 0.5, 0.02)
    assert law.relaxation_modulus(0.03) == pytest.approx(5e5 * (pi * 0.03) ** -0.5, rel=0.03)
    assert law == PowerLaw(law.E1, 0.5, (1e-3, 1), 0.5, 1.0, 0.02)


def test_fractional_creep_is_the_mittag_leffler_function():
    solid = FractionalStandardLinearSolid(1e9, 1e7, 0.02, 0.5, (1e-4, 10), 0.5)
    time = np.geomspace(1e-6, 1e3, 40)
    # E_1/2(−x) = exp(x²) erfc(x)
    exact = 1e-7 - (1e-7 - 1e-9) * erfcx((time / 0.02) ** 0.5)
    assert solid.exact_creep_compliance(time) == pytest.approx(exact, rel=1e-8)
    for a in (0.05, 0.3, 0.8, 0.95, 0.999):
        solid = FractionalStandardLinearSolid(1e9, 1e7, 0.02, a, (1e-4, 10), 0.5)
        x = 0.4
        series = sum((-x) ** k / gamma(a * k + 1) for k in range(60))
        creep = solid.exact_creep_compliance(0.02 * x ** (1 / a))
        assert creep == pytest.approx(1e-7 - (1e-7 - 1e-9) * series, rel=1e-7)


@pytest.mark.parametrize("exponent", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("creep_time", [1e-8, 1e-3, 1e3])
def test_fractional_solids_are_as_close_as_they_say(exponent, creep_time):
    solid = FractionalStandardLinearSolid(1e9, 2e7, creep_time, exponent, (1e-6, 1), 0.4, 5e-3)
    time = np.geomspace(1e-6, 1, 301)
    exact = solid.exact_creep_compliance(time)
    assert solid.creep_compliance(time) == pytest.approx(exact, rel=5e-3)
    frequency = 1 / (2 * pi * time)
    # Cole and Cole in the compliance.
    s = (2j * pi * frequency * creep_time) ** exponent
    exact = 1 / 1e9 + (1 / 2e7 - 1 / 1e9) / (1 + s)
    assert solid.exact_complex_compliance(frequency) == pytest.approx(exact, rel=1e-12)
    modulus = solid.storage_modulus(frequency) + 1j * solid.loss_modulus(frequency)
    assert np.max(np.abs(1 / modulus / exact - 1)) <= 5e-3 * (1 + 1e-6)
    assert solid.reduced_modulus_relaxed > 0


def test_equal_moduli_need_no_elements():
    solid = FractionalStandardLinearSolid(1e9, 1e9, 1.0, 0.5, WINDOW, 0.3)
    assert (solid.element_count, solid.compliance.fluidity) == (0, 0)
    assert solid.relaxation_modulus(0.5) == pytest.approx(1e9)


# Refusals


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: KelvinVoigt(0, 1, 0.5), "^E = 0 Pa: must be greater than 0"),
        (lambda: KelvinVoigt(1, -1, 0.5), "^creep_time = -1 s: must be greater than 0"),
        (lambda: KelvinVoigt.from_viscosity(1, 0, 0.5), "^viscosity = 0 Pa s: must be greater"),
        (lambda: Maxwell(1, 0, 0.5), "^relaxation_time = 0 s: must be greater than 0"),
        (lambda: Maxwell(1, 1, 0.6), "^poisson = 0.6: must be"),
        (lambda: GeneralizedMaxwell(-1, [1], [1], 0.5), "^E_inf = -1 Pa: must be positive, or 0"),
        (lambda: GeneralizedMaxwell(1, [1, -2], [1, 2], 0.5), r"^moduli\[1\] = -2 Pa: must not be"),
        (lambda: GeneralizedMaxwell(1, [1, 2], [1, 0], 0.5), r"^relaxation_times\[1\] = 0 s: must"),
        (lambda: GeneralizedMaxwell(1, [1, 2], [1], 0.5), "^relaxation_times has 1 entries: must"),
        (lambda: GeneralizedMaxwell(0, [0], [1], 0.5), "^moduli has no entry above 0 Pa: must"),
        (lambda: GeneralizedMaxwell(1, 2, 3, 0.5), "^moduli = 2: must be a list of numbers in Pa"),
        (lambda: GeneralizedMaxwell.from_shear(-1, [1], [1], 0.5), "^G_inf = -1 Pa: must be"),
        (lambda: GeneralizedMaxwell.from_ratios(1, [0.6, 0.6], [1, 2], 0.5), "^ratios add up to 1"),
        (lambda: PowerLaw(1, 1, WINDOW, 0.5), "^exponent = 1: must be above 0"),
        (lambda: PowerLaw(1, 0.5, (1, 1), 0.5), r"^window = \(1, 1\) s: must be the shortest and"),
        (lambda: PowerLaw(1, 0.5, (0, 1), 0.5), r"^window\[0\] = 0 s: must be greater than 0"),
        (lambda: PowerLaw(1, 0.5, WINDOW, 0.5, error=1e-7), "^error = 1e-07: must be between"),
        (lambda: PowerLaw(1, 0.5, WINDOW, 0.5, 0), "^reference_time = 0 s: must be greater"),
        (
            lambda: PowerLaw(1, 0.5, (1e-20, 1e20), 0.5, error=1e-3).compliance,
            r"^error = 0.001 over window = \(1e-20, 1e\+20\) s needs more than 40 elements: must",
        ),
        (
            lambda: PowerLaw(1, 0.5, (1e-200, 1e200), 0.5).compliance,
            r"^error = 0.01 over window = \(1e-200, 1e\+200\) s needs more than 40 elements",
        ),
        (
            lambda: FractionalStandardLinearSolid(1, 2, 1, 0.5, WINDOW, 0.5),
            "^E_inf = 2 Pa: must be at most E0 = 1 Pa",
        ),
        (lambda: SAMPLES[0].creep_compliance([1, -1]), r"^time\[1\] = -1 s: must be finite and at"),
        (lambda: SAMPLES[0].relaxation_modulus(nan), "^time = nan s: must be finite and at least"),
        (lambda: SAMPLES[0].loss_modulus(0), "^frequency = 0 Hz: must be finite and greater"),
        (lambda: plot_rheology(SAMPLES[0], (2, 1)), "^window = "),
    ],
)
def test_refusals_in_one_line(build, message):
    with pytest.raises(ValueError, match=message) as refused:
        build()
    assert "\n" not in str(refused.value)


# The figure and the page


def test_the_examples_of_the_samples_page_run(tmp_path, monkeypatch):
    page = (Path(__file__).parents[1] / "docs" / "samples.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    names = {}
    for block in re.findall(r"```python\n(.*?)```", page, re.S):
        exec(block, names)
    assert names["misfit"][0] < 0.05
    assert names["cell"].element_count == 6


@pytest.mark.parametrize("sample", SAMPLES, ids=lambda sample: sample.kind)
def test_figures_of_all_samples(sample, tmp_path):
    figure = plot_rheology(sample)
    relaxation, dynamic, creep = figure.axes
    assert relaxation.get_ylabel().startswith("Relaxation modulus (")
    assert creep.get_ylabel().startswith("Creep compliance (1/")
    assert [line.get_label() for line in dynamic.lines] == [
        "storage modulus E′",
        "loss modulus E″",
    ]
    figure.savefig(tmp_path / "figure.png", dpi=30)


@pytest.mark.parametrize("exponent", [2e-41, 1e-6, 0.0099])
def test_a_fractional_solid_that_hardly_creeps_is_refused_before_it_takes_all_memory(exponent):
    with pytest.raises(ValueError, match=r"^exponent = .*: must be at least 0\.01; .* Elastic"):
        FractionalStandardLinearSolid(1e9, 1e6, 1e-3, exponent, (1e-6, 1.0), 0.5)
