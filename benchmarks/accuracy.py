"""Is the tolerance the error? Random contacts and motions against runs at a tighter tolerance.

Tip radius 5 nm to 5 µm, E_inf 1 MPa to 10 GPa, E0/E_inf 1 to 50, W 5 to 100 mJ/m², z0 0.15 to
0.5 nm, relaxed Tabor number up to 30, triangles and taps with creep times that matter. One line per
contact, then the share within the tolerance.

    python benchmarks/accuracy.py [COUNT [TOLERANCE [SEED]]]
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import sys
from time import perf_counter

import numpy as np

import softafm as sa


def random_run(random):
    """Return a contact's Tabor number and a function of tolerance that runs it."""

    def between(low, high):
        return float(np.exp(random.uniform(np.log(low), np.log(high))))

    while True:
        contact = sa.Contact(
            sa.Paraboloid(between(5e-9, 5e-6)),
            sa.Elastic(between(1e6, 1e10), random.uniform(0, 0.5)),
            sa.LennardJones.from_work_of_adhesion(
                between(5e-3, 0.1), random.uniform(0.15e-9, 0.5e-9)
            ),
        )
        if contact.tabor_relaxed <= 30:
            break
    radius, z0 = contact.tip.radius, contact.surface.z0
    modulus = contact.sample.reduced_modulus_relaxed
    adhesive = (6 * np.pi * contact.surface.work_of_adhesion * radius**2 / modulus) ** (1 / 3)
    depth = random.uniform(0.2, 1.5) * (adhesive + np.sqrt(radius * z0)) ** 2 / radius + z0

    def with_creep(creep_time):
        sample = contact.sample
        E0 = sample.E * between(1, 50)
        solid = sa.StandardLinearSolid(E0, sample.E, creep_time, sample.poisson)
        return sa.Contact(contact.tip, solid, contact.surface)

    if random.random() < 0.5:
        frequency = between(1e4, 1e6)
        amplitude = random.uniform(2e-9, 50e-9) + depth
        mean_height = amplitude - depth * random.uniform(-0.2, 1)
        touching = 3 * depth / (2 * np.pi * frequency * amplitude)
        tapped = with_creep(touching * between(0.01, 10))
        scale = 0.02 * amplitude
        return (
            contact,
            scale,
            lambda tolerance: sa.tapping_cycle(
                tapped, amplitude, mean_height, frequency, tolerance=tolerance
            ),
        )
    speed = between(1e-8, 1e-3)
    pressed = with_creep(depth / speed * between(0.01, 100))
    motion = sa.Triangle(max(4, 6 * contact.tabor_relaxed**0.43) * z0, -depth, speed)
    return contact, z0, lambda tolerance: sa.force_distance(pressed, motion, tolerance=tolerance)


def largest_error(result, finer, length):
    force = max(abs(float(finer["force_max"])), abs(float(finer["force_min"])))
    worst = 0.0
    for name in ("force_max", "force_min", "force_min_approach"):
        worst = max(worst, abs(float(result[name] - finer[name])) / force)
    for name in ("loop_energy", "virial", "dissipation"):
        if name in finer:
            scale = max(abs(float(finer[name])), force * length)
            worst = max(worst, abs(float(result[name] - finer[name])) / scale)
    return worst


def main():
    arguments = [float(a) for a in sys.argv[1:]]
    count, tolerance, seed = arguments + [60, 1e-2, 1][len(arguments) :]
    random = np.random.default_rng(int(seed))
    found, warned, failed = [], 0, 0
    for number in range(int(count)):
        contact, length, run = random_run(random)
        started = perf_counter()
        try:
            result = run(tolerance)
            seconds = perf_counter() - started
            finer = run(min(tolerance / 10, 1e-3))
        except sa.DivergedError as error:
            failed += 1
            print(f"{number:4d}  Tabor {contact.tabor_relaxed:6.2f}  {error}", flush=True)
            continue
        found.append(largest_error(result, finer, length))
        warned += bool(result.attrs["warnings"])
        print(
            f"{number:4d}  Tabor {contact.tabor_relaxed:6.2f}  {result.attrs['mode']:15s}"
            f"{1e3 * seconds:8.1f} ms  error {100 * found[-1]:6.3f} %"
            f"{'  above tolerance' if found[-1] > tolerance else ''}",
            flush=True,
        )
    within = np.mean(np.array(found) <= tolerance)
    print(
        f"{within:.1%} of {len(found)} runs within tolerance {tolerance:g}; median error "
        f"{np.median(found):.1e}, 99th percentile {np.quantile(found, 0.99):.1e}; "
        f"{warned} warned, {failed} gave up"
    )


if __name__ == "__main__":
    main()
