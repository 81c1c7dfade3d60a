"""How true the tolerance is for random tips, surface laws and samples, not just the paper's.

Force curves of random contacts at tolerance 1e-2 against the same at 1e-3. Forces count relative to
the largest |force|, the loop energy to the larger of its value and largest |force|·z0 (without
adhesion the decay length of the repulsion).

python benchmarks/every_contact.py [NUMBER [FIRST_SEED]]
"""

import sys
import warnings
from math import pi

import numpy as np

import softafm as sa

OBSERVABLES = ("force_max", "force_min", "loop_energy")
TABOR_BOUND = 20


def log_uniform(random, low, high):
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def contact_of(seed):
    """Return a random contact and the ramp that suits it."""
    random = np.random.default_rng(seed)
    uniform = random.uniform
    R, z0 = log_uniform(random, 5e-9, 5e-6), uniform(1.5e-10, 5e-10)
    W, modulus = log_uniform(random, 5e-3, 0.1), log_uniform(random, 1e6, 1e10)
    ratio = log_uniform(random, 1, 50)
    core = 0.1 * z0
    law = [
        lambda: sa.LennardJones.from_work_of_adhesion(W, z0),
        lambda: sa.VanDerWaals.from_work_of_adhesion(W, z0, uniform(4, 20)),
        lambda: sa.DMT.from_work_of_adhesion(W, z0, uniform(0.02, 0.25)),
        lambda: sa.Exponential(W, z0, z0 * uniform(0.2, 1), core),
        lambda: sa.Morse(W, z0, z0 * uniform(0.2, 0.6)),
        lambda: sa.Dugdale(W, z0, W / z0 * uniform(0.5, 2), uniform(0.1, 0.3)),
        lambda: sa.DLVO(16 * pi * W * z0**2, z0, uniform(0, 0.05), log_uniform(random, 1e-9, 3e-8)),
        lambda: sa.Repulsion(log_uniform(random, 10, 1000) * modulus * ratio, 0.2 * z0),
        lambda: (
            sa.LennardJones.from_work_of_adhesion(W / 2, z0)
            + sa.Exponential(W / 2, z0, 0.6 * z0, core)
        ),
    ][random.integers(9)]()
    tip = [
        lambda: sa.Paraboloid(R),
        lambda: sa.Sphere(R),
        lambda: sa.Cone(uniform(0.2, 1.2), R),
        lambda: sa.Hyperboloid(R, uniform(0.2, 1.2)),
        lambda: sa.FlatPunch(R, R * uniform(0.05, 1)),
        lambda: sa.PowerLawTip(uniform(2, 6), 0.1 * R, 0.45 * R),
    ][random.integers(6)]()
    speed, nu = log_uniform(random, 1e-7, 1e-3), uniform(0.2, 0.5)
    time = 1e-9 / speed
    creep_time, window = time * log_uniform(random, 1e-2, 1e2), (1e-2 * time, 1e3 * time)
    sample = [
        lambda: sa.Elastic(modulus, nu),
        lambda: sa.StandardLinearSolid(modulus * ratio, modulus, creep_time, nu),
        lambda: sa.KelvinVoigt(modulus, creep_time, nu),
        lambda: sa.Maxwell(modulus, creep_time, nu),
        lambda: sa.GeneralizedMaxwell(
            modulus, modulus * ratio * uniform(0.1, 1, 6), time * np.geomspace(1e-3, 1e3, 6), nu
        ),
        lambda: sa.PowerLaw(modulus, uniform(0.1, 0.6), window, nu, reference_time=time),
        lambda: sa.FractionalStandardLinearSolid(
            modulus * ratio, modulus, creep_time, uniform(0.3, 0.9), window, nu
        ),
    ][random.integers(7)]()
    contact = sa.Contact(tip, sample, law)
    natural = contact.contact_radius(0.0) ** 2 / contact.effective_radius
    depth = min(max(natural, 3 * z0) * uniform(0.3, 3), 0.3 * R)
    start = contact.edge_gap + (15 if contact.adhesive else 5) * contact.reach + depth
    return contact, sa.Triangle(start, -depth, speed)


def errors_of(contact, motion):
    """Return the errors at tolerance 1e-2 and whether the run warned."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        rough = sa.force_distance(contact, motion, tolerance=1e-2)
        fine = sa.force_distance(contact, motion, tolerance=1e-3)
    largest = float(np.abs(fine.force.values).max())
    length = contact.surface.equilibrium_gap if contact.surface.attracts else contact.reach
    scales = largest, largest, max(abs(float(fine.loop_energy)), largest * length)
    off = [
        abs(float(rough[name] - fine[name])) / scale
        for name, scale in zip(OBSERVABLES, scales, strict=True)
    ]
    return off, bool(rough.attrs["warnings"])


def main(number=100, seed=0):
    worst, warned = [], 0
    while len(worst) < number:
        contact, motion = contact_of(seed)
        law, modulus = contact.surface, contact.softened_modulus
        tabor = law.work_of_adhesion**2 * contact.effective_radius
        seed += 1
        if contact.adhesive and tabor > TABOR_BOUND**3 * modulus**2 * law.range**3:
            continue
        errors, warns = errors_of(contact, motion)
        worst.append(max(errors))
        warned += warns
        if worst[-1] > 1e-2:
            name = OBSERVABLES[int(np.argmax(errors))]
            kinds = f"{contact.tip.kind}, {law.kind}, {contact.sample.kind}"
            told = f"{kinds} (seed {seed - 1}{', warned' if warns else ''})"
            print(f"{100 * worst[-1]:5.2f} % in {name}: {told}", flush=True)
    within = np.mean(np.array(worst) <= 1e-2)
    half, most, largest = 100 * np.quantile(worst, [0.5, 0.99, 1.0])
    print(
        f"{number} contacts: {within:.1%} within 1 %; median {half:.3f} %, 99 % within "
        f"{most:.2f} %, largest {largest:.2f} %; {warned} warned"
    )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
