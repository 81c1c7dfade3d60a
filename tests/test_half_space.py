"""The half-space operator against closed forms."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import i0e

import softafm as sa
from softafm import bodies
from softafm.bodies.kernel import kernel
from softafm.bodies.mesh import node_index, unit_mesh
from softafm.bodies.stiffness import Stiffness
from softafm.solvers.energy.tuning import EXTENT


def stiffness(mesh):
    return Stiffness(bodies.HalfSpace(sa.Elastic(1e9, 0.3)), mesh).uniform


def displacement(mesh, pressure):
    """K p on the nodes, from the stiffness that solvers use."""
    return np.linalg.solve(stiffness(mesh), mesh.masses * pressure)


@pytest.fixture(scope="module")
def contact_mesh():
    """The finest mesh of a run at tolerance 1e-3, that of the paper's Fig. 3 at 5 µm/s."""
    contact = sa.Contact(
        tip=sa.Paraboloid(radius=10e-6),
        sample=sa.StandardLinearSolid(E0=5e9, E_inf=0.5e9, creep_time=1e-3, poisson=0.0),
        surface=sa.LennardJones(hamaker=1e-19, z0=0.5e-9),
    )
    ramp = sa.Triangle(start=10e-9, turn=-10e-9, speed=5e-6)
    result = sa.force_distance(contact, ramp, tolerance=1e-3)
    return unit_mesh(result.attrs["solver_finest_spacing"], result.attrs["solver_growth"], EXTENT)


def test_hemispherical_pressure_gives_a_paraboloid(contact_mesh):
    # Hertz: p = sqrt(1 - r²) on the unit disc gives K p = (π/4)(2 - r²). The nodal value next to
    # the edge, where the slope is infinite, is set so that the nodes carry the exact load 1/3.
    mesh = contact_mesh
    pressure = np.sqrt(np.clip(1 - mesh.nodes**2, 0, None))
    last = np.flatnonzero(mesh.nodes < 1)[-1]
    pressure[last] += (1 / 3 - mesh.masses @ pressure) / mesh.masses[last]
    inside = mesh.nodes <= 1
    exact = np.pi / 4 * (2 - mesh.nodes**2)
    error = displacement(mesh, pressure) / exact - 1
    assert np.max(np.abs(error[inside])) < 1e-4


def test_smooth_disc_pressure(contact_mesh):
    # p = (1 - r²)^(3/2) gives K p = (3π/64)(8 - 8r² + 3r⁴) inside the disc.
    mesh = contact_mesh
    pressure = np.clip(1 - mesh.nodes**2, 0, None) ** 1.5
    inside = mesh.nodes <= 1
    exact = 3 * np.pi / 64 * (8 - 8 * mesh.nodes**2 + 3 * mesh.nodes**4)
    error = displacement(mesh, pressure) / exact - 1
    assert np.max(np.abs(error[inside])) < 1e-4


@pytest.mark.parametrize("width", [0.7, 1.5, 2.0])
def test_gaussian_pressure(contact_mesh, width):
    # p = exp(-r²/b²) gives K p = √π b exp(-x) I0(x), x = r²/2b².
    mesh = contact_mesh
    pressure = np.exp(-((mesh.nodes / width) ** 2))
    exact = width * np.sqrt(np.pi) * i0e((mesh.nodes / width) ** 2 / 2)
    near = mesh.nodes < 3
    error = displacement(mesh, pressure) / exact - 1
    assert np.max(np.abs(error[near])) < 2e-4


def test_error_falls_with_the_third_power_of_the_spacing():
    # The zeta-regularised trapezoidal rule is of third order in the spacing, here by growth.
    def error(growth):
        mesh = unit_mesh(2 * growth, growth, 8.0)
        exact = np.sqrt(np.pi) * 1.5 * i0e((mesh.nodes / 1.5) ** 2 / 2)
        found = displacement(mesh, np.exp(-((mesh.nodes / 1.5) ** 2)))
        return np.max(np.abs(found / exact - 1)[mesh.nodes < 2])

    growths = np.array([0.4, 0.3, 0.2, 0.15, 0.1])
    order = np.polyfit(np.log(growths), np.log([error(g) for g in growths]), 1)[0]
    assert 2.7 < order < 4.5


def test_masses_integrate_even_functions():
    mesh = unit_mesh(0.1, 0.25, 8.0)
    load = mesh.masses @ np.exp(-((mesh.nodes / 1.5) ** 2))
    assert load == pytest.approx(1.5**2 / 2, rel=1e-6)


@given(st.floats(-4, -0.6), st.floats(0.1, 0.35), st.floats(4, 12))
@settings(max_examples=30, deadline=None)
def test_every_mesh_is_stable_and_ordered(log_spacing, growth, extent):
    mesh = unit_mesh(10**log_spacing, growth, extent)
    assert np.all(np.diff(mesh.nodes) > 0)
    assert mesh.nodes[-1] >= extent
    assert np.all(mesh.masses > 0)
    assert np.allclose(node_index(mesh.nodes, 10**log_spacing, growth), np.arange(mesh.nodes.size))
    assert np.linalg.eigvalsh(stiffness(mesh)).min() > 0


def test_kernel_near_its_singularity():
    # 1 - m is formed without cancellation: k → (2/πr) ln(8r/|r - s|).
    gap = 1e-12
    assert kernel(np.array(1.0), np.array(1.0 + gap)) == pytest.approx(
        2 / np.pi * np.log(8 / gap), rel=1e-3
    )


def test_meshes_are_built_once():
    assert unit_mesh(0.1, 0.25, 8.0) is unit_mesh(0.1, 0.25, 8.0)


def test_all_half_spaces_share_a_stiffness():
    mesh = unit_mesh(0.1, 0.25, 8.0)
    one, other = (Stiffness(bodies.HalfSpace(sa.Elastic(E, 0.3)), mesh) for E in (1e6, 1e9))
    assert one.uniform is other.uniform
