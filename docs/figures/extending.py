"""Print every number that docs/extending.md quotes."""

from math import exp
from time import perf_counter

import numpy as np
from numba import njit

import softafm as sa
from softafm import surfaces
from softafm.compiled.formulas import Term

GAPS = np.geomspace(0.1e-9, 10e-9, 64)


def morse(gap, W, z0, decay):
    """Return pressure, slope and potential of the Morse law, as the page writes it."""
    far = exp((z0 - gap) / decay)
    rate = 2 / decay * W * far
    return rate * (far - 1), rate / decay * (1 - 2 * far), W * far * (far - 2)


def with_maximum(gap, strength, decay):
    """Repulsion that is level inside 0.2 nm, by ``np.maximum``."""
    p = strength * np.exp(-np.maximum(gap, 0.2e-9) / decay)
    return p, -p / decay, p * decay


def with_where(gap, strength, decay):
    """Repulsion that is level inside 0.2 nm, by ``np.where``."""
    p = strength * np.exp(-np.where(gap > 0.2e-9, gap, 0.2e-9) / decay)
    return p, -p / decay, p * decay


class Formula(surfaces.SurfaceLaw):
    """A law of one formula, unchecked."""

    kind = "formula"

    def __init__(self, function):
        self.function = function

    @property
    def terms(self):
        """The formula with its parameters."""
        return (Term(self.function, (1e9, 0.2e-9)),)


@njit
def repeat(function, gap, parameters, pressure, slope, times):
    """Call a compiled law many times, as a solver does."""
    for _ in range(times):
        function(gap, parameters, pressure, slope, gap.size)


def nanoseconds(law) -> float:
    """Time that one compiled call for 64 gaps takes, ns."""
    compiled, _, parameters = law.compiled_pressure
    p, slope = np.empty((2, GAPS.size))
    repeat(compiled, GAPS, parameters, p, slope, 10)
    best = np.inf
    for _ in range(5):
        start = perf_counter()
        repeat(compiled, GAPS, parameters, p, slope, 10_000)
        best = min(best, perf_counter() - start)
    return 1e9 * best / 10_000


def curve_seconds(law) -> float:
    """Shortest of three times that a force curve takes, s."""
    sample = sa.StandardLinearSolid(E0=2e9, E_inf=0.1e9, creep_time=1e-7, poisson=0.49)
    contact, best = sa.Contact(sa.Paraboloid(10e-9), sample, law), np.inf
    for _ in range(3):
        start = perf_counter()
        sa.force_distance(contact, sa.Triangle(start=10e-9, turn=-2e-9, speed=1e-3))
        best = min(best, perf_counter() - start)
    return best


def main():
    """Print the times."""
    built_in = surfaces.Morse(0.05, 0.3e-9, 0.15e-9)
    start = perf_counter()
    custom = sa.CustomSurface(morse, W=0.05, z0=0.3e-9, decay=0.15e-9)
    print(f"first custom law of a process, compiled and checked: {perf_counter() - start:.2f} s")
    start = perf_counter()
    sa.CustomSurface(morse, W=0.04, z0=0.3e-9, decay=0.15e-9)
    print(f"the same with other parameters: {1e3 * (perf_counter() - start):.1f} ms")
    for name, law in (("built-in", built_in), ("custom", custom)):
        curve = 1e3 * curve_seconds(law)
        print(f"64 gaps, {name}: {nanoseconds(law):.0f} ns; a curve: {curve:.1f} ms")
    for function in (with_maximum, with_where):
        print(f"64 gaps, {function.__name__}: {nanoseconds(Formula(function)):.0f} ns")


if __name__ == "__main__":
    main()
