#!/bin/bash
# pyvisq 1.2.2: Burgers.J builds its Kelvin-Voigt element from the spring and dashpot of the Maxwell element (a) in place
# of its own (b), so that creep and relaxation are of two materials: the integral of G(t - s) J(s) ds is not t. And
# Generalized.J(0) is 0, not 1/G(0): of a generalised Maxwell solid the instantaneous compliance is lost at t = 0 only.
# Maxwell's, for comparison, is right.
#
# Seen:
#   Maxwell: integral / t = 1.0000
#   Burgers: integral / t = 1.1368
#   Generalized: G(0) J(0) = 0.0, G(1e-6) J(1e-6) = 1.0000
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'pyvisq==1.2.2'
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
from pyvisq.models import burgers, elements, generalized, maxwell
from scipy.integrate import quad


def spring(k):
    return elements.SpringParams(k)


def dashpot(c):
    return elements.DashpotParams(c)


def share(model, time=2.0):
    """Return the integral of G(t - s) J(s) ds over t: 1 if both are of one material."""
    value, _ = quad(lambda s: model.G(time - s) * model.J(s), 0, time, epsrel=1e-10)
    return value / time


single = maxwell.Maxwell(maxwell.MaxwellParams(dashpot(2.0), spring(1.0)))
four = burgers.Burgers(burgers.BurgersParams(dashpot(2.0), spring(1.0), dashpot(3.0), spring(4.0)))
solid = generalized.Generalized(
    generalized.GeneralizedParams(spring(1.0), [maxwell.MaxwellParams(dashpot(2.0), spring(1.0))])
)
print(f"Maxwell: integral / t = {share(single):.4f}")
print(f"Burgers: integral / t = {share(four):.4f}")
at_once = solid.G(0) * solid.J(0)
print(f"Generalized: G(0) J(0) = {at_once:.1f}, G(1e-6) J(1e-6) = {solid.G(1e-6) * solid.J(1e-6):.4f}")
assert abs(share(single) - 1) < 1e-6, "the comparison is wrong"
assert abs(share(four) - 1) > 0.01, "the behaviour has changed: Burgers creeps as it relaxes"
assert at_once == 0, "the behaviour has changed: J(0) is no longer 0"
PYTHON
