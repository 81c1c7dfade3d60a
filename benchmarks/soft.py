"""Soft and sticky contacts: whole loops, with both jumps, at Tabor numbers up to 1000.

Elastic contacts at controlled height, beside JKR's pull-off of 1.5 πRW; standard linear solids of
E0/E_inf = 20 that retract at 0.1 z0 per creep time; and silicone rubber on a soft lever that turns
at a force.

    python benchmarks/soft.py
"""

import warnings
from time import process_time

import common
import numpy as np
from scipy.integrate import trapezoid

import softafm as sa
from softafm import solvers

R, W, Z0 = 20e-9, common.W, common.Z0
LAW = sa.LennardJones.from_work_of_adhesion(W, Z0)


def elastic(tabor):
    """A contact of a Tabor number, and a ramp from above its pull-off to below its snap-in."""
    modulus = np.sqrt(R * W**2 / (tabor * Z0) ** 3)
    start = max(2 * tabor, 1.5 * 2.641 * tabor ** (3 / 7)) * Z0
    turn = -((0.75 * np.pi**2) ** (1 / 3)) * tabor * Z0
    return sa.Contact(sa.Paraboloid(R), sa.Elastic(modulus, 0.0), LAW), sa.Triangle(
        start, turn, 1e-6
    )


def creeping(tabor):
    """A contact of ``common.soft_contact``, and a ramp that parts it."""
    contact, ramp = common.soft_contact(tabor)
    return contact, sa.Triangle(6 * tabor * Z0, ramp.turn, ramp.speed)


def measure(contact, ramp, tolerance: float, **options) -> tuple:
    """Steps, attempts, nodes, CPU, pull-off over πRW, jumps, energy spent over work done."""
    solver, times = solvers.Energy(), []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sa.AccuracyWarning)
        for _ in range(3):
            started = process_time()
            history = solver.solve(contact, ramp, tolerance=tolerance, **options)
            times.append(process_time() - started)
    work = -trapezoid(history.force, history.tip_height)
    spent = trapezoid(history.viscous_power, history.time) + history.jump_energy.sum()
    unit = np.pi * contact.tip.radius * W
    return (
        history.diagnostics["steps"], history.diagnostics["attempted_steps"],
        history.diagnostics["most_nodes"], common.clock(min(times)),
        f"{-history.force.min() / unit:.4f}", history.jump_energy.size, f"{spent / work:.4f}",
    )  # fmt: skip


def main() -> None:
    rows = []
    for tolerance in (1e-2, 1e-3):
        for tabor in (10, 30, 64, 200, 640, 1000):
            rows.append(("elastic", tabor, tolerance, *measure(*elastic(tabor), tolerance)))
        for tabor in (10, 30, 100, 300):
            rows.append(("creeping", tabor, tolerance, *measure(*creeping(tabor), tolerance)))
        rubber = sa.Contact(sa.Paraboloid(R), sa.samples.pdms(), LAW)
        ramp = sa.Triangle(300e-9, -300e-9, 1e-6, setpoint_force=5e-9)
        found = measure(rubber, ramp, tolerance, stiffness=0.4)
        rows.append(("rubber, lever", f"{rubber.tabor_relaxed:.0f}", tolerance, *found))
    titles = ("contact", "Tabor", "tolerance", "steps", "attempts", "nodes", "CPU", "pull-off/πRW",
              "jumps", "spent/work")  # fmt: skip
    common.show("Soft and sticky contacts", dict.fromkeys(titles, "right"), rows)


if __name__ == "__main__":
    main()
