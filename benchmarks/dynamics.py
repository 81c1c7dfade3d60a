"""Time of levers with inertia against prescribed taps, in turns, and their accuracy.

CPU times are the least of several turns after a warm-up, on one core. Each turn times a tap that is
prescribed and cycles of a lever that has come to rest at its amplitude, on the same contact.

    python benchmarks/dynamics.py [TURNS]
"""

import sys
from dataclasses import replace
from time import process_time

import common
import numpy as np

import softafm as sa

PS = sa.Contact(
    sa.Paraboloid(50e-9),
    sa.StandardLinearSolid(E0=4.25e9, E_inf=1.89e9, creep_time=1e-7, poisson=0.35),
    sa.LennardJones(2e-20, 0.15e-9),
)
LDPE = sa.Contact(
    sa.Paraboloid(10e-9),
    sa.StandardLinearSolid(E0=2e9, E_inf=0.2e9, creep_time=1e-7, poisson=0.49),
    sa.LennardJones(1e-19, 0.25e-9),
)
LEVER, DRIVE = sa.Cantilever(28.1, 429.5, 278e3), sa.Drive(278e3, 15e-9)
HEIGHT = 8.491192e-9


def cpu(work, *arguments, **options):
    """CPU time of a call, s, and what it returned."""
    started = process_time()
    found = work(*arguments, **options)
    return process_time() - started, found


def per_cycle(contact, drive, base, cycles=(200, 500), **options):
    """CPU time of a cycle, s, of those beyond the first ones, which ring up."""
    few, _ = cpu(sa.tapping_transient, contact, LEVER, drive, base, cycles[1], "none", **options)
    all_of_them, last = cpu(
        sa.tapping_transient, contact, LEVER, drive, base, sum(cycles), "none", **options
    )
    return (all_of_them - few) / cycles[0], last


def prescribed(contact, taps):
    """CPU time of one of several prescribed taps, s, of those beyond the first."""
    solver = sa.solvers.Energy()
    first, _ = cpu(solver.solve, contact, replace(taps, cycles=1))
    return (cpu(solver.solve, contact, taps)[0] - first) / (taps.cycles - 1)


def compare(turns):
    """Rows of a dynamic cycle against a prescribed tap of the same amplitude and height."""
    for name, contact, drive, base in (
        ("polystyrene", PS, DRIVE, HEIGHT),
        ("polyethylene", LDPE, sa.Drive(278e3, 62e-9), 46e-9),
    ):
        run = sa.tapping_transient(contact, LEVER, drive, base, 600, "none", start="swinging")
        amplitude = float(run.amplitude[-1, 0])
        times = []
        for _ in range(turns):
            tap = prescribed(contact, sa.Sine(base, amplitude, 278e3, 25))
            cycle, _ = per_cycle(contact, drive, base, start="swinging")
            times.append((tap, cycle))
        tap, cycle = np.min(times, axis=0)
        ratio = np.median([b / a for a, b in times])
        yield (
            name,
            f"{1e3 * tap:.2f} ms",
            f"{1e3 * cycle:.2f} ms",
            f"{cycle / tap:.2f}",
            f"{ratio:.2f}",
        )


def time_others(turns):
    """Rows of whole runs and of free cycles."""
    whole = min(cpu(sa.tapping_transient, PS, LEVER, DRIVE, HEIGHT)[0] for _ in range(turns))
    yield "1500 cycles on polystyrene", f"{whole:.2f} s"
    free = min(per_cycle(PS, DRIVE, 60e-9, (20_000, 1000))[0] for _ in range(turns))
    yield "a free cycle", f"{1e6 * free:.1f} µs"


def measure():
    """Rows of accuracy: the steady state, energy balances, and damping that is not there."""
    run = sa.tapping_transient(PS, LEVER, DRIVE, HEIGHT).isel(cycle=-1)
    fine = sa.tapping_transient(PS, LEVER, DRIVE, HEIGHT, tolerance=1e-3).isel(cycle=-1)
    for name, at in (("1e-2", run), ("1e-3", fine)):
        state = f"{float(at.amplitude[0]) / 15e-9:.6f}, {float(at.phase[0]):.4f}°"
        yield f"amplitude ratio and phase at tolerance {name}", state
        yield f"dissipation at tolerance {name}", f"{1e18 * float(at.dissipation):.4f} aJ"
    spent = float(run.damping + run.dissipation)
    yield "drive work less damping and dissipation", f"{float(run.drive_work) / spent - 1:.1e}"
    lost = float(run.viscous_loss + run.jump_loss)
    yield "dissipation less what the sample takes", f"{float(run.dissipation) / lost - 1:.1e}"
    elastic = sa.Contact(PS.tip, sa.Elastic(4.25e9, 0.35), PS.surface)
    lever = sa.Cantilever(28.1, 30, 278e3)
    for tolerance in (1e-2, 1e-3):
        hits = sa.tapping_transient(elastic, lever, DRIVE, HEIGHT, 300, tolerance=tolerance)
        last = hits.isel(cycle=slice(-40, None))
        stored = np.pi * 28.1 * last.amplitude[:, 0] ** 2
        found = float((last.dissipation / stored).mean())
        yield f"1/Q of an elastic sample at tolerance {tolerance:g}", f"{found:.1e}"


def main():
    turns = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    cpu(sa.tapping_transient, PS, LEVER, DRIVE, HEIGHT, 20)
    cpu(sa.solvers.Energy().solve, PS, sa.Sine(HEIGHT, 9e-9, 278e3))
    headings = dict.fromkeys(
        ("contact", "tap", "cycle", "ratio of least", "median of ratios"), "left"
    )
    common.show("A cycle against a prescribed tap, CPU time", headings, compare(turns))
    common.show("CPU time", {"work": "left", "time": "left"}, time_others(turns))
    common.show("Accuracy", {"what": "left", "found": "left"}, measure())


if __name__ == "__main__":
    main()
