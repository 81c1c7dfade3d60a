"""Bodies that are no plain half-spaces, against independent solutions."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest
from scipy.integrate import trapezoid
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

import softafm as sa
from softafm import bodies, rheology
from softafm.bodies.body import body_of
from softafm.bodies.mesh import unit_mesh
from softafm.bodies.stiffness import STEP, Stiffness
from softafm.solvers.energy.layout import Table
from softafm.solvers.energy.stiffness import find_stiffness

RADIUS, DEPTH, MODULUS = 1e-4, 1e-6, 1e6
CLOSE = sa.Repulsion(pressure_at_zero=1e9, decay=2e-12)
"""Short-ranged for contacts of 10 µm: nearly that of Hertz."""
TAPPED = sa.StandardLinearSolid(E0=1e9, E_inf=1e8, creep_time=1e-6, poisson=0.5)
LAW = sa.LennardJones(hamaker=1e-19, z0=0.25e-9)


@dataclass(frozen=True)
class Skinned(bodies.Layered):
    """An incompressible skin on an incompressible base ``ratio`` times as stiff (Burmister)."""

    kind: ClassVar[str] = "skinned"
    thickness: float
    ratio: float

    @property
    def length(self):
        return self.thickness

    def factor(self, wavenumber):
        contrast, fading = (1 - self.ratio) / (1 + self.ratio), np.exp(-2 * wavenumber)
        once = 2 * contrast * fading
        twice = (contrast * fading) ** 2
        above = 1 + 2 * once * wavenumber - twice
        return above / (1 - once * (1 + 2 * wavenumber**2) + twice)


def elastic(ratio, thickness):
    return Skinned(sa.Elastic(MODULUS, 0.5), thickness, ratio)


def pressed(body, depth=DEPTH, **options):
    contact = sa.Contact(sa.Paraboloid(RADIUS), body, CLOSE)
    return sa.force_distance(contact, sa.Triangle(5e-9, -depth, 1e-6), **options)


def solution(body, radius):
    """Depth, and force over E/(1 − ν²), of the paraboloid in a contact of a radius.

    The Fredholm equation φ + Mφ = (2/π)(δ − x²/R), M = (2/π) ∫ (S − 1) cos κx cos κy dκ, with
    φ(a) = 0 and F = πE ∫ φ dx, of a paraboloid. Each wavenumber is given its own panels.
    """
    points, weights = (x / 2 for x in np.polynomial.legendre.leggauss(80))
    x = np.append(radius * (0.5 + points), radius)
    weights = np.append(radius * weights, 0.0)
    edges = np.concatenate([[0], np.geomspace(1e-4, 1, 16), np.arange(2, 21)]) / body.thickness
    gauss, shares = np.polynomial.legendre.leggauss(12)
    half = np.diff(edges)[:, None] / 2
    k, dk = (edges[:-1, None] + half * (1 + gauss)).ravel(), (half * shares).ravel()
    waves = np.cos(np.outer(x, k))
    change = 2 / np.pi * dk * (body.factor(k * body.thickness) - 1)
    matrix = np.eye(x.size) + np.einsum("ik,jk->ij", waves * change, waves) * weights
    given = 2 / np.pi * np.array([np.ones(x.size), x**2 / RADIUS])
    flat, curved = np.linalg.solve(matrix, given.T).T
    depth = curved[-1] / flat[-1]
    return depth, np.pi * weights @ (depth * flat - curved)


def hertz_like(body, depth):
    """Radius of the contact and force over E/(1 − ν²) at a depth."""
    radius = brentq(lambda a: solution(body, a)[0] - depth, 1e-8, 3 * np.sqrt(RADIUS * depth))
    return radius, solution(body, radius)[1]


def measured_depth(body, height):
    """Depth of a contact without the gap that the law leaves, (decay)·ln(P0/mean pressure)."""
    radius, force = hertz_like(body, -height)
    mean = MODULUS / 0.75 * force / (np.pi * radius**2)
    return -height + CLOSE.decay * np.log(CLOSE.pressure_at_zero / mean)


# Elastic


def test_the_solution_to_compare_with_has_the_load_of_thin_films():
    # F/F_Hertz and a/√(Rδ) of a film bonded to a rigid base at √(Rδ) = t, ν = 1/2.
    film = elastic(1e9, np.sqrt(RADIUS * DEPTH))
    radius, force = hertz_like(film, DEPTH)
    assert radius / np.sqrt(RADIUS * DEPTH) == pytest.approx(1.40949, rel=1e-5)
    assert force / (4 / 3 * np.sqrt(RADIUS) * DEPTH**1.5) == pytest.approx(5.11537, rel=1e-5)


@pytest.mark.parametrize("ratio", [0.1, 10.0])
@pytest.mark.parametrize("thickness", [40e-6, 16e-6])
def test_elastic_loads(ratio, thickness):
    body = elastic(ratio, thickness)
    curve = pressed(body)
    deepest = int(curve.force.values.argmax())
    depth = measured_depth(body, float(curve.tip_height[deepest]))
    radius, force = hertz_like(body, depth)
    assert float(curve.force[deepest]) == pytest.approx(MODULUS / 0.75 * force, rel=1e-4)
    assert float(curve.contact_radius[deepest]) == pytest.approx(radius, rel=1e-3)
    assert abs(float(curve.loop_energy)) < 1e-5 * float(curve.force_max) * DEPTH


def test_a_base_like_the_skin_and_a_skin_without_end_are_half_spaces():
    alone = pressed(sa.Elastic(MODULUS, 0.5), depth=1e-7)
    stated = bodies.HalfSpace(sa.Elastic(MODULUS, 0.5))
    for body in (elastic(1.0, 1e-5), elastic(10.0, 1.0), stated):
        curve = pressed(body, depth=1e-7)
        assert float(curve.force_max) == pytest.approx(float(alone.force_max), rel=2e-5)


@pytest.mark.parametrize("ratio", [0.2, 10.0])
def test_what_an_elastic_adhesive_contact_loses_it_loses_in_jumps(ratio):
    body = Skinned(sa.Elastic(5e7, 0.5), 40e-9, ratio)
    contact = sa.Contact(sa.Paraboloid(10e-9), body, LAW)
    motion = sa.Triangle(start=10e-9, turn=-2e-9, speed=1e-4)
    rigid = sa.force_distance(contact, motion)
    lever = sa.force_spectroscopy(contact, sa.Cantilever(1.0), motion)
    for curve in (rigid, lever):
        assert curve.jump_time.size >= 2
        assert float(curve.jump_energy.sum()) == pytest.approx(float(curve.loop_energy), rel=2e-3)


# Viscoelastic


def test_a_viscoelastic_body_loads_by_the_hereditary_integral():
    # While the contact grows F = ∫ E(t − s) dF_elastic(δ(s)) (Lee and Radok 1960).
    sample = sa.StandardLinearSolid(E0=3e6, E_inf=1e6, creep_time=0.5, poisson=0.5)
    body = Skinned(sample, 20e-6, 10.0)
    curve = pressed(body)
    # It parts from a dent five times as wide as its last contact, smoothly.
    assert curve.sizes["jump"] == 0
    top = int(curve.tip_height.values.argmin())
    time, height = float(curve.time[top]), curve.tip_height.values
    began = np.interp(0, -height[: top + 1], curve.time.values[: top + 1])
    start = -CLOSE.decay * np.log(CLOSE.pressure_at_zero / 1e4)
    radii = np.linspace(0, 1.5, 25)[1:] * np.sqrt(RADIUS * DEPTH)
    found = np.array([[0.0, 0.0], *(solution(body, radius) for radius in radii)])
    instants = np.linspace(began, time, 401)
    depths = (instants - began) / (time - began) * DEPTH - start
    middles = (instants[1:] + instants[:-1]) / 2
    modulus = sample.relaxation_modulus(time - middles) / 0.75
    expected = float(modulus @ np.diff(CubicSpline(*found.T)(depths)))
    assert float(curve.force[top]) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("ratio", [0.2, 10.0])
def test_a_tap_loses_what_its_sample_dissipates(ratio):
    contact = sa.Contact(sa.Paraboloid(10e-9), Skinned(TAPPED, 20e-9, ratio), LAW)
    tap = sa.tapping_cycle(contact, 20e-9, 18.5e-9, 200e3, cycles="steady")
    lost = trapezoid(tap.viscous_power, tap.time) + float(tap.jump_energy.sum())
    assert lost == pytest.approx(float(tap.dissipation), rel=5e-3)
    plain = sa.Contact(contact.tip, TAPPED, LAW)
    alone = sa.tapping_cycle(plain, 20e-9, 18.5e-9, 200e3, cycles="steady")
    assert (float(tap.force_max) > float(alone.force_max)) == (ratio > 1)


# Stiffness of a frame


def test_the_stiffness_between_tabulated_frames():
    body, mesh = elastic(1e4, 1e-6), unit_mesh(0.02, 0.2, 8.0)
    n, frame = mesh.nodes.size, 0.4123e-6
    stiffness = Stiffness(body, mesh)
    table = Table(stiffness.entries, 0.0, STEP, np.empty((n, n)))
    assert not find_stiffness(table, frame)
    stiffness.reach(frame)
    start = np.log(body.length) + STEP * stiffness.first
    table = Table(stiffness.entries, start, STEP, np.empty((n, n)))
    assert find_stiffness(table, frame)
    identity = table.found @ body.influence(mesh, frame)
    np.testing.assert_allclose(np.linalg.eigvals(identity), 1, rtol=0, atol=1e-5)
    assert not find_stiffness(table, 3 * frame)


# Estimates


@pytest.mark.parametrize("ratio", [0.1, 10.0])
@pytest.mark.parametrize("radius", [1e-9, 3e-6, 12e-6, 40e-6])
def test_estimates(ratio, radius):
    body = elastic(ratio, 16e-6)
    tip = sa.Paraboloid(RADIUS)
    depth, force = solution(body, radius)
    assert body.depth(tip, np.array([radius]), MODULUS, 0.0)[0] == pytest.approx(depth, rel=5e-3)
    # dF = stiffness·dδ as the contact grows.
    more, stronger = solution(body, 1.001 * radius)
    stiffness = (stronger - force) / (more - depth)
    assert 2 * radius * body.hardening(radius) == pytest.approx(stiffness, rel=5e-3)


def test_the_contact_expected_is_that_of_the_body():
    body = elastic(10.0, 16e-6)
    contact = sa.Contact(sa.Paraboloid(RADIUS), body, CLOSE)
    radius, _ = hertz_like(body, DEPTH)
    assert contact.contact_radius(-DEPTH) == pytest.approx(radius, rel=2e-3)
    stiff = sa.Contact(sa.Paraboloid(RADIUS), sa.Elastic(MODULUS, 0.5), CLOSE)
    assert radius > 1.05 * stiff.contact_radius(-DEPTH)


# What is refused or doubted


def test_a_contact_wider_than_the_mesh_is_good_for_is_doubted():
    doubt = "on the body 'skinned' the mesh is good for contacts of up to 1e-05 m"
    with pytest.warns(sa.AccuracyWarning, match=doubt):
        pressed(elastic(3.0, 10e-6), depth=1.1e-6)


def test_a_contact_that_the_mesh_cannot_resolve_ends_the_run():
    message = r"^the mesh cannot resolve the body 'skinned' in contacts of .* good for 4e-06 m"
    with pytest.raises(sa.DivergedError, match=message):
        pressed(elastic(1e4, 4e-6))


@pytest.mark.parametrize("solver", [sa.solvers.Attard(), sa.solvers.EnhancedAttard()])
def test_solvers_of_the_paper_refuse_other_bodies(solver):
    contact = sa.Contact(sa.Paraboloid(10e-9), Skinned(TAPPED, 20e-9, 10.0), LAW)
    message = (
        f"^solver '{solver.kind}': knows half-spaces only, not the body 'skinned'; take the solver "
        "'energy'$"
    )
    with pytest.raises(ValueError, match=message):
        sa.force_distance(contact, sa.Triangle(5e-9, 1e-9, 1e-3), solver=solver)


def test_a_body_that_lacks_something_is_refused_by_what_it_lacks():
    incomplete = SimpleNamespace(kind="slab", sample=TAPPED, influence=lambda mesh, frame: None)
    with pytest.raises(ValueError, match=r"must be a body .*; it has no compliance, key, length, "):
        sa.Contact(sa.Paraboloid(10e-9), incomplete, LAW)
    with pytest.raises(ValueError, match=r"^sample = 3: must be a sample such as softafm.Elastic$"):
        bodies.HalfSpace(3)


def test_a_sample_with_a_reduced_compliance_only_is_told_what_to_state():
    wanted = "must have compliance, the creep compliance under uniaxial stress without the factor"
    old = SimpleNamespace(kind="old", reduced_compliance=TAPPED.compliance)
    with pytest.raises(ValueError, match=f"^sample = .*: has a reduced_compliance only: {wanted}"):
        sa.Contact(sa.Paraboloid(10e-9), old, LAW)
    with pytest.raises(TypeError, match=f"^class Old: has a reduced_compliance only: {wanted}"):

        class Old(rheology.Solid):
            reduced_compliance = TAPPED.compliance


def test_a_body_goes_where_a_sample_goes(tmp_path):
    body = Skinned(TAPPED, 20e-9, 10.0)
    contact = sa.Contact(sa.Paraboloid(10e-9), body, LAW)
    assert (contact.sample, contact.body, contact.rheology) == (body, body, TAPPED)
    plain = sa.Contact(sa.Paraboloid(10e-9), TAPPED, LAW)
    assert plain.body == bodies.HalfSpace(TAPPED) == body_of(TAPPED)
    assert contact.tabor_relaxed == plain.tabor_relaxed
    curve = sa.force_distance(contact, sa.Triangle(5e-9, -1e-9, 1e-3), profiles=True)
    # In contact the surface follows the tip.
    deepest = int(curve.tip_height.values.argmin())
    inside = curve.r.values < 0.5 * float(curve.contact_radius[deepest])
    gap = curve.gap.values[deepest][inside]
    assert np.all((gap > 0.8 * LAW.z0) & (gap < 1.05 * LAW.z0))
    sa.save(curve, tmp_path / "curve.nc")
    kept = sa.load(tmp_path / "curve.nc")
    assert '"kind": "skinned"' in kept.attrs["experiment"]
    assert '"thickness": 2e-08' in kept.attrs["experiment"]
