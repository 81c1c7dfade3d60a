#!/bin/bash
# Adhesion 0.93, ReferenceSolutions.JKR.contact_radius(penetration=..., radius=..., contact_modulus=...,
# work_of_adhesion=...): right in the units of Maugis (R = 1, E* = 3/4, w = 1/π) only. In SI units the radius of an AFM
# tip's contact is several times too large, and one is returned where the contact has long parted. Two causes: the limit
# of the branch is (π w R²/6 · K)^(1/3) in place of (π w R²/(6 K))^(1/3), and Newton's method starts there and stops at
# SciPy's absolute tolerance of 1.48e-8, larger than such a contact. force(penetration=...) inherits it. From the force, or
# with penetration(contact_radius=...) the module is right.
#
# Seen (penetration over the depth of the pull-off, radius over that of JKR):
#   Maugis' units: 1.0000 (-0.99), 1.0000 (0), 1.0000 (5), 0 beyond the pull-off
#   R = 10 nm, E* = 1 GPa, w = 50 mJ/m²: 14.9879 (-0.99), 6.8218 (0), 3.5812 (5), 2.138e-08 beyond the pull-off
#   there force(penetration=0) is -5.8e+02 times that of JKR
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    'adhesion==0.93' 'contactmechanics==1.8.3' 'surfacetopography==1.27.1' 'scipy==1.17.1'
cd "$folder"
"$folder/venv/bin/python" -W ignore - <<'PYTHON'
from math import pi, sqrt

from Adhesion.ReferenceSolutions import JKR
from scipy.optimize import brentq


def compare(R, E, w):
    """Return the radius over that of JKR by penetration, and what is returned beyond the pull-off."""
    smallest = (pi * w * R**2 / (8 * E)) ** (1 / 3)
    deep = 3 * smallest**2 / R
    given = {"radius": R, "contact_modulus": E, "work_of_adhesion": w}
    ratios = {}
    for share in (-0.99, 0, 5):

        def excess(a, share=share):
            return a**2 / R - sqrt(2 * pi * a * w / E) - share * deep

        known = brentq(excess, smallest, 1e3 * smallest, xtol=1e-20)
        back = JKR.penetration(contact_radius=known, **given)
        assert abs(back - share * deep) < 1e-6 * deep, "the comparison is wrong"
        ratios[share] = JKR.contact_radius(penetration=share * deep, **given) / known
        if share == 0:
            forces = JKR.force(penetration=0.0, **given) / JKR.force(contact_radius=known, **given)
    return ratios, JKR.contact_radius(penetration=-2 * deep, **given), forces


def write(name, ratios, beyond):
    listed = ", ".join(f"{ratio:.4f} ({share:g})" for share, ratio in ratios.items())
    print(f"{name}: {listed}, {beyond:.4g} beyond the pull-off")


ratios, beyond, _ = compare(1.0, 0.75, 1 / pi)
write("Maugis' units", ratios, beyond)
assert all(abs(ratio - 1) < 1e-6 for ratio in ratios.values()), "the comparison is wrong"
assert beyond == 0, "the comparison is wrong"
ratios, beyond, forces = compare(10e-9, 1e9, 50e-3)
write("R = 10 nm, E* = 1 GPa, w = 50 mJ/m²", ratios, beyond)
print(f"there force(penetration=0) is {forces:.2g} times that of JKR")
assert all(ratio > 2 for ratio in ratios.values()), "the behaviour has changed: SI units are right"
assert beyond > 0, "the behaviour has changed: a parted contact has no radius"
PYTHON
