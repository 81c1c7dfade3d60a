"""Named samples: the values of their sources, and that they run."""

import numpy as np
import pytest
from scipy.integrate import trapezoid

import softafm as sa
from softafm import samples, surfaces

EVERY = [build() for build in samples.NAMED.values()]


def test_names_are_those_of_the_functions():
    assert all(name == build.__name__ for name, build in samples.NAMED.items())
    assert set(samples.NAMED) == {"ldpe", "polystyrene", "pdms", "polyisobutylene", "epoxy"}
    for build in samples.NAMED.values():
        assert "References" in build.__doc__


def test_samples_of_the_paper_are_its_tables():
    """Rajabifar et al. 2021, Tables 1 and 3."""
    assert samples.ldpe() == sa.StandardLinearSolid(2e9, 0.1e9, 1e-7, 0.49)
    assert samples.polystyrene() == sa.StandardLinearSolid(4.25e9, 1.89e9, 1e-7, 0.35)


@pytest.mark.parametrize(("ratio", "modulus"), [(10, 2e6), (5, 4e6), (33, 20e6 / 33)])
def test_pdms_softens_with_its_mixing_ratio(ratio, modulus):
    """E = 20 MPa/ratio: Wang, Volinsky and Gallant 2014."""
    assert samples.pdms(ratio) == sa.Elastic(modulus, 0.5)


def test_pdms_of_ratio_ten_lies_in_the_measured_range():
    """1.32 to 2.97 MPa in tension: Johnston et al. 2014."""
    assert 1.32e6 < samples.pdms().E < 2.97e6


@pytest.mark.parametrize(
    ("time", "modulus"),
    [
        (1.0e-10, 2.75e9),
        (9.8e-9, 1.21e9),
        (1.69e-7, 2.91e8),
        (1.7e-6, 5.0e7),
        (1.05e-3, 1.43e6),
        (3.1e-2, 8.8e5),
    ],
)
def test_polyisobutylene_relaxes_as_measured(time, modulus):
    """Catsiff and Tobolsky's master curve, from Fig. 7.18 of Brinson and Brinson 2008."""
    found = float(samples.polyisobutylene().relaxation_modulus(time))
    assert found == pytest.approx(modulus, rel=0.25)


def test_polyisobutylene_flows():
    sample = samples.polyisobutylene()
    assert sample.poisson == 0.5
    assert sample.compliance.fluidity > 0
    assert np.all(np.diff(sample.relaxation_modulus(np.geomspace(1e-12, 1e6, 200))) < 0)


def test_epoxy_goes_from_its_glass_to_its_rubber():
    """Shear moduli of 891 MPa and 4.9 MPa: Simon, McKenna and Sindt 2000."""
    sample = samples.epoxy()
    shares = np.array(sample.moduli) / (2 * 1.35 * (891e6 - 4.9e6))
    assert shares.sum() == pytest.approx(1, abs=1e-3)
    assert len(shares) == 24
    shear = sample.relaxation_modulus(np.array([0.0, 1e12])) / (2 * 1.35)
    np.testing.assert_allclose(shear, [891e6, 4.9e6], rtol=1e-3)
    assert samples.epoxy(0.4).poisson == 0.4


@pytest.mark.parametrize("sample", EVERY, ids=list(samples.NAMED))
# The ramp ends in contact, on purpose.
@pytest.mark.filterwarnings("ignore:audit. the tip is still in contact:softafm.AccuracyWarning")
def test_named_samples_run(sample):
    surface = sa.LennardJones.from_work_of_adhesion(0.05, 1e-9)
    contact = sa.Contact(sa.Paraboloid(20e-9), sample, surface)
    curve = sa.force_distance(contact, sa.Triangle(start=10e-9, turn=-2e-9, speed=1e-3))
    assert float(curve.force_min) < 0
    assert float(curve.loop_energy) > -1e-3 * 2e-9 * float(np.abs(curve.force).max())


@pytest.mark.parametrize(
    "surface",
    [surfaces.Morse(0.04, 0.3e-9, 0.5e-9), sa.LennardJones.from_work_of_adhesion(0.04, 0.3e-9)],
    ids=["morse", "lennard-jones"],
)
def test_a_melt_that_snaps_in_within_picoseconds_has_a_finite_energy(surface):
    """Energies were integrals of cubics, which ran wild before the surface's fast creep."""
    contact = sa.Contact(sa.Paraboloid(10e-9), samples.polyisobutylene(), surface)
    tap = sa.tapping_cycle(contact, amplitude=50e-9, mean_height=45e-9, frequency=300e3, cycles=1)
    work = -trapezoid(tap.force, tap.tip_height)
    assert float(tap.dissipation) == pytest.approx(work, rel=0.05)
    lost = float(tap.viscous_loss + tap.jump_energy.sum())
    assert float(tap.dissipation) == pytest.approx(lost, rel=0.03)
    assert float(tap.force.min()) < float(tap.force_mean.squeeze()) < float(tap.force.max())


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: samples.pdms(4.9), "^mixing_ratio = 4.9: must be from 5 to 33, as was measured$"),
        (lambda: samples.pdms(34), "^mixing_ratio = 34: must be from 5 to 33"),
        (lambda: samples.pdms("10:1"), "^mixing_ratio = '10:1': must be a number"),
        (lambda: samples.pdms(float("nan")), "^mixing_ratio = nan: must be a finite number"),
        (lambda: samples.epoxy(0.51), "^poisson = 0.51: must be above -1 and at most 0.5"),
    ],
)
def test_what_was_not_measured_is_refused(build, message):
    with pytest.raises(ValueError, match=message):
        build()
