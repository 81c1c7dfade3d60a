"""Flat punches, whose rim holds the edge of the contact."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

import softafm as sa


@pytest.mark.parametrize(
    "law",
    [
        sa.Exponential(work_of_adhesion=1e-4, z0=0.29e-9, decay=0.23e-9, core=0.029e-9),
        sa.LennardJones(hamaker=1e-21, z0=0.3e-9),
        sa.Morse(work_of_adhesion=1e-3, z0=0.3e-9, decay=0.1e-9),
    ],
    ids=lambda law: law.kind,
)
def test_pull_on_a_punch_nears_that_of_a_rigid_sample_from_below(law):
    """The face parts everywhere at once, and the edge runs over it: the pull was 8 % too large."""
    tip = sa.FlatPunch(radius=2.5e-6, edge_radius=1e-6)
    rim = 1.5e-6

    def force(height):
        face = np.pi * rim**2 * float(law.pressure(height))
        reach = [rim + part * 1e-6 for part in (0.01, 0.03, 0.1, 0.3)]
        beyond = quad(
            lambda r: 2 * np.pi * r * float(law.pressure(height + float(tip.profile(r)))),
            rim, rim + 0.99e-6, points=reach, epsrel=1e-8, limit=200,
        )[0]  # fmt: skip
        return face + beyond

    z0 = law.equilibrium_gap
    least = minimize_scalar(force, bounds=(z0, 3 * z0), method="bounded", options={"xatol": 1e-15})
    pulls = []
    for modulus in (6e9, 1e10, 1e11, 1e13):
        contact = sa.Contact(tip, sa.Elastic(modulus, 0.3), law)
        run = sa.force_distance(contact, sa.Triangle(5e-9, -0.4e-9 if modulus < 1e11 else z0, 1e-6))
        pulls.append(float(run["force_min"]) / float(least.fun))
    assert pulls[0] < pulls[1] < max(pulls) < 1.003
    assert pulls[-1] == pytest.approx(1, rel=3e-3)
