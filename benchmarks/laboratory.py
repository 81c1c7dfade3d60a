"""What tips, surface laws and samples cost: one tap of each against paraboloid, Lennard-Jones, SLS.

Every contact is tapped in turn with the reference, so that a ratio is not of two hours of a busy
machine; the least of each counts. A step costs what law and tip cost, and a tap has as many steps
as its physics asks for: both are shown.

python benchmarks/laboratory.py
"""

from math import pi
from time import perf_counter

import numpy as np

import softafm as sa

ROUNDS = 25
W, Z0, R = 0.02, 3e-10, 12e-9
TIP = sa.Paraboloid(R)
LAW = sa.LennardJones.from_work_of_adhesion(W, Z0)
SAMPLE = sa.StandardLinearSolid(2.5e9, 0.3e9, 1.2e-7, 0.45)


def lennard_jones(gap, work, z0):
    near = (z0 / gap) ** 3
    pressure = 8 * work / (3 * z0) * near * (near * near - 1)
    slope = -8 * work / (z0 * gap) * near * (3 * near * near - 1)
    return pressure, slope, 4 * work / 3 * (z0 / gap) ** 2 * (near * near / 4 - 1)


def paraboloid(radius, R):
    return radius * radius / (2 * R)


def prony(terms):
    """The reference sample, its one relaxation spread over so many terms close in time."""
    times = np.geomspace(0.999, 1.001, terms) * SAMPLE.creep_time * SAMPLE.E_inf / SAMPLE.E0
    moduli = np.full(terms, (SAMPLE.E0 - SAMPLE.E_inf) / terms)
    return sa.GeneralizedMaxwell(SAMPLE.E_inf, tuple(moduli), tuple(times), SAMPLE.poisson)


GAPS = np.geomspace(1.5e-10, 3e-8, 200)
CONTACTS = {
    "reference once more": (TIP, SAMPLE, LAW),
    "Prony series, 5 terms": (TIP, prony(5), LAW),
    "Prony series, 20 terms": (TIP, prony(20), LAW),
    "user's Lennard-Jones": (TIP, SAMPLE, sa.CustomSurface(lennard_jones, work=W, z0=Z0)),
    "user's paraboloid": (sa.CustomTip(paraboloid, R=R), SAMPLE, LAW),
    "van der Waals, n = 12": (TIP, SAMPLE, sa.VanDerWaals.from_work_of_adhesion(W, Z0, 12.0)),
    "DMT": (TIP, SAMPLE, sa.DMT.from_work_of_adhesion(W, Z0)),
    "exponential": (TIP, SAMPLE, sa.Exponential(W, Z0, 1.5e-10, 0.5e-10)),
    "Morse": (TIP, SAMPLE, sa.Morse(W, Z0, 1.2e-10)),
    "Dugdale": (TIP, SAMPLE, sa.Dugdale(W, Z0, W / Z0)),
    "DLVO": (TIP, SAMPLE, sa.DLVO(16 * pi * W * Z0**2, Z0, 0.02, 5e-9)),
    "tabulated, 200 points": (TIP, SAMPLE, sa.Tabulated(tuple(GAPS), tuple(LAW.pressure(GAPS)))),
    "repulsion only": (TIP, SAMPLE, sa.Repulsion(1e12, 3e-11)),
    "sphere": (sa.Sphere(R), SAMPLE, LAW),
    "cone of 20°": (sa.Cone(np.radians(20), R), SAMPLE, LAW),
    "hyperboloid of 20°": (sa.Hyperboloid(R, np.radians(20)), SAMPLE, LAW),
    "flat punch": (sa.FlatPunch(R, 0.2 * R), SAMPLE, LAW),
}


def tap(contact):
    """Return the seconds that a tap took, and its attempted steps."""
    motion = sa.Sine(mean_height=36e-9, amplitude=40e-9, frequency=250e3)
    started = perf_counter()
    history = sa.solvers.Energy().solve(contact, motion)
    return perf_counter() - started, history.diagnostics["attempted_steps"]


def main():
    reference = sa.Contact(TIP, SAMPLE, LAW)
    tap(reference)
    print(f"one tap: paraboloid, Lennard-Jones, SLS      {1e3 * tap(reference)[0]:6.2f} ms")
    print(f"{'against it':<28}{'time':>8}{'steps':>8}{'a step':>8}")
    for name, parts in CONTACTS.items():
        contact = sa.Contact(*parts)
        tap(contact)
        pairs = [(tap(reference), tap(contact)) for _ in range(ROUNDS)]
        (least, steps), (time, its_steps) = (min(taps) for taps in zip(*pairs, strict=True))
        ratio, more = time / least, its_steps / steps
        print(f"{name:<28}{ratio:8.2f}{more:8.2f}{ratio / more:8.2f}")


if __name__ == "__main__":
    main()
