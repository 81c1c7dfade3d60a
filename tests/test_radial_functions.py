"""Rings, radial functions and what a pressure does to them, against known constants."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipkm1, j0

from softafm.bodies import radial_functions as functions
from softafm.bodies.rings import disc, ring_influence

# ρ_j(s) = ∫_0^1 cos(jπr) k(r, s) dr for j = 0, 1, 2, 5, 10, by adaptive quadrature of others.
COSINE_RESPONSES = {
    0.05: (8.76342782939, 5.44820134725, 3.82813720508, 1.87872352766, 0.268759583716),
    0.3: (5.15743976644, 1.60270763169, -0.15161904165, -0.032723953259, -0.212963534156),
    0.75: (3.17626470957, -0.254352896388, -0.112444345963, 0.128738477043, -0.00557355052497),
    0.95: (2.53236806042, -0.324780793988, 0.183139130021, -0.0579757682118, -0.0121188925394),
}


def kernel(r, s):
    larger, smaller = max(r, s), min(r, s)
    return 4 / (np.pi * larger) * ellipkm1((larger - smaller) * (larger + smaller) / larger**2)


@pytest.mark.parametrize("s", COSINE_RESPONSES)
def test_responses_to_cosines(s):
    found = functions.responses("cosine", 11, (s,))[[0, 1, 2, 5, 10], 0] / s
    assert np.allclose(found, COSINE_RESPONSES[s], rtol=0, atol=2e-11)


@pytest.mark.parametrize("s", [0.02, 0.4, 1.0])
@pytest.mark.parametrize("j", [0, 3])
def test_responses_to_bessel_functions(j, s):
    wave = functions.wavenumbers("bessel", j + 1)[j]
    exact, _ = quad(
        lambda r: j0(wave * r) * kernel(r, s) * r, 0, 1, points=[s], limit=200, epsabs=1e-10
    )
    assert functions.responses("bessel", j + 1, (s,))[j, 0] / s == pytest.approx(exact, abs=1e-8)


@pytest.mark.parametrize("basis", functions.BASES)
def test_functions_are_orthogonal(basis):
    r, weight = np.polynomial.legendre.leggauss(200)
    r, weight = (r + 1) / 2, weight / 2
    values = functions.evaluate(basis, 30, r)
    weight = weight * r if basis == "bessel" else weight
    gram = values.T @ (weight[:, None] * values)
    assert np.allclose(gram, np.diag(functions.norms(basis, 30)), rtol=0, atol=1e-13)


@pytest.mark.parametrize("basis", functions.BASES)
def test_projection_returns_the_coefficients(basis):
    wanted = np.array([0.3, -1.0, 0.5, 0.2])
    found = functions.project(basis, 6, lambda r: functions.evaluate(basis, 4, r) @ wanted)
    assert np.allclose(found, [*wanted, 0, 0], rtol=0, atol=1e-13)


@pytest.mark.parametrize("quadrature", functions.QUADRATURES)
@pytest.mark.parametrize("nodes", [2, 7, 70])
def test_grids_integrate_lines_exactly(quadrature, nodes):
    grid = functions.grid(nodes, quadrature)
    assert grid.weight.sum() == pytest.approx(1, rel=1e-13)
    assert grid.weight @ grid.radius == pytest.approx(0.5, rel=1e-13)
    assert np.all((grid.radius >= grid.edges[:-1]) & (grid.radius <= grid.edges[1:]))


@pytest.mark.parametrize("a", [0.3, 1.0])
@pytest.mark.parametrize("r", [0.0, 1e-4, 0.3, 0.299999, 0.8, 5.0])
def test_disc_is_the_integral_of_the_kernel(r, a):
    def integrand(s):
        return kernel(r, s) * s if s > 0 else 0.0

    exact, _ = quad(integrand, 0, a, points=[min(r, a)], limit=400, epsabs=1e-10)
    assert disc(r, a) == pytest.approx(exact, abs=1e-8)


@pytest.mark.parametrize(
    ("rings", "error"), [(50, 1.5e-3), (100, 5.8e-4), (200, 2.2e-4), (400, 8.5e-5)]
)
def test_rings_meet_the_hertz_deformation(rings, error):
    """p = √(1 − r²) displaces by (π/4)(2 − r²) (Johnson 1985, section 3.4); errors as published."""
    edges = np.arange(rings + 1) / rings
    middle = (edges[1:] + edges[:-1]) / 2
    found = ring_influence(middle, edges) @ np.sqrt(1 - middle**2)
    largest = np.abs(found / (np.pi / 4 * (2 - middle**2)) - 1).max()
    assert largest == pytest.approx(error, rel=0.02)
