#!/bin/bash
# pyfmrheo 0.1.3, TingModel("paraboloid", radius, "analytical"): on the way out of a power-law sample the force is not
# Ting's, as Gauss' hypergeometric function is replaced by Butler and Wood's approximation (hyp2f1_apprx). At an exponent
# of 0.2 it jumps up by 5 % where the motion turns, is 12 % low at 1.2 times the time of the turn and 19 % at 1.3; at 0.5
# it is not finite at all. The way in, and all of a cone, are right, so a fit of the way out is wrong for a
# paraboloid only.
#
# Seen (force over that of Ting's integral at t/t_m):
#   cone, 0.2: 1.000 (0.5), 1.000 (1.02), 1.000 (1.1), 1.000 (1.2), 1.000 (1.3)
#   paraboloid, 0.2: 1.000 (0.5), 1.029 (1.02), 0.954 (1.1), 0.878 (1.2), 0.812 (1.3)
#   paraboloid, 0.2, just after the turn over just before it: 1.051; Ting: 0.990
#   paraboloid, 0.5: 0 of 332 forces before the end of the contact are finite
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    'pyfmrheo==0.1.3' 'lmfit==1.3.2' 'numpy==1.26.4' 'scipy==1.14.1'
cd "$folder"
"$folder/venv/bin/python" -W ignore::RuntimeWarning - <<'PYTHON'
from math import pi, radians, sqrt, tan

import numpy as np
from pyfmrheo.models.ting import TingModel
from scipy.integrate import quad

RADIUS, ANGLE, POISSON, MODULUS, SPEED, TURN = 1e-6, 35.0, 0.5, 1e3, 1e-6, 1.0
TIME = np.linspace(0, 2 * TURN, 2001)
SHARE = 1 / (1 - POISSON**2)
TIPS = {
    "cone": (ANGLE, 2.0, 2 / pi * tan(radians(ANGLE)) * SHARE),
    "paraboloid": (RADIUS, 1.5, 4 / 3 * sqrt(RADIUS) * SHARE),
}


def compute(tip, exponent):
    """Force of the package on a triangle of the depth, N."""
    model = TingModel(tip, TIPS[tip][0], "analytical")
    model.E0, model.betaE, model.tc, model.F0 = MODULUS, exponent, 0.0, 0.0
    depth = SPEED * (TURN - np.abs(TIME - TURN))
    return model.eval(TIME, None, depth, 1.0, idx_tm=1000, v0t=SPEED, v0r=SPEED)


def integrate(tip, exponent, t):
    """Ting's integral of E(t - s) d(depth^n), up to the time t1 of equal contact before the turn."""
    _, n, factor = TIPS[tip]

    def rate(s):
        return factor * MODULUS * n * SPEED**n * s ** (n - 1)

    if t <= TURN:
        return quad(rate, 0, t, weight="alg", wvar=(0, -exponent))[0]
    t1 = t - 2 ** (1 / (1 - exponent)) * (t - TURN)
    return quad(lambda s: rate(s) * (t - s) ** -exponent, 0, t1, epsrel=1e-10)[0]


for tip in TIPS:
    force = compute(tip, 0.2)
    over = {i: force[i] / integrate(tip, 0.2, TIME[i]) for i in (500, 1020, 1100, 1200, 1300)}
    listed = ", ".join(f"{ratio:.3f} ({TIME[i]:g})" for i, ratio in over.items())
    print(f"{tip}, 0.2: {listed}")
    assert abs(over[500] - 1) < 1e-4, "the comparison is wrong"
    if tip == "cone":
        assert all(abs(ratio - 1) < 1e-4 for ratio in over.values()), "the comparison is wrong"
    else:
        assert over[1200] < 0.9, "the behaviour has changed: the paraboloid follows Ting"

step = force[1001] / force[1000]
known = integrate(tip, 0.2, TIME[1001]) / integrate(tip, 0.2, TURN)
print(f"{tip}, 0.2, just after the turn over just before it: {step:.3f}; Ting: {known:.3f}")
assert step > 1.03 > known, "the behaviour has changed: the force no longer jumps at the turn"
out = compute(tip, 0.5)[1001:1333]
print(f"{tip}, 0.5: {np.isfinite(out).sum()} of {out.size} forces before the end of the contact are finite")
assert not np.isfinite(out).any(), "the behaviour has changed: an exponent of 0.5 is finite"
PYTHON
