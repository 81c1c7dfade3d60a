"""Results beside known answers: pull-off against speed, dwell, depth and law; dents beside Ting.

The tables of docs/known-answers.md, in half a minute.

    python benchmarks/known_answers.py
"""

import json
from collections.abc import Iterable, Iterator
from math import log, pi, sqrt

import common
import numpy as np
from scipy.integrate import trapezoid

import softafm as sa
from softafm import indentation

KNOWN = json.loads((common.DATA / "known_answers.json").read_text(encoding="utf-8"))
RUBBER, LAWS = KNOWN["rubber"], KNOWN["laws"]
UNIT = pi * RUBBER["radius"] * RUBBER["work_of_adhesion"]
TIP = sa.Paraboloid(RUBBER["radius"])
SOLID = sa.StandardLinearSolid(*(RUBBER[name] for name in ("E0", "E_inf", "creep_time", "poisson")))
STICKY = sa.LennardJones.from_work_of_adhesion(RUBBER["work_of_adhesion"], RUBBER["z0"])

DEPTH, TIME, MODULUS = 10e-9, 1e-3, 1e7
"""A dent in a solid of this long-term modulus, Pa: its depth, m, and the time of the way in, s."""
DENTS = ((10, 0.05), (10, 0.2), (10, 1), (2, 0.5))
"""E0/E_inf, and the relaxation time over that of the way in."""
LONG_WALL, SHORT_WALL = DEPTH / 100, DEPTH / 2000
"""Lengths in which a repulsion decays, m."""


def pull(speed: float, depth: float, dwell: float = 0.0) -> float:
    """Pull-off of the rubber over πRW."""
    motion = sa.Triangle(RUBBER["start"], -depth, speed, dwell=dwell)
    return -float(sa.force_distance(sa.Contact(TIP, SOLID, STICKY), motion).force_min) / UNIT


def list_pulls() -> Iterator[tuple[str, float, float, float]]:
    """Yield what varies, its value, the pull-off found and that known."""
    depth = -RUBBER["turn"]
    runs = {
        "speed": lambda value: pull(value, depth),
        "dwell": lambda value: pull(RUBBER["dwell"]["speed"], depth, value),
        "depth": lambda value: pull(RUBBER["depth"]["speed"], value),
    }
    for name, run in runs.items():
        table = RUBBER[name]
        for value, known in zip(table["value"], table["pull_off"], strict=True):
            yield name, value, run(value), known


def list_laws() -> Iterator[tuple[str, float, float, float, float]]:
    """Yield laws, their pull-off over πRW and loop over πRW·range at Tabor number 1, and known."""
    W, length = LAWS["work_of_adhesion"], LAWS["length"]
    for law in (
        sa.LennardJones.from_work_of_adhesion(W, length),
        sa.Morse(W, length, length / 2),
        sa.Exponential(W, length, length, 0.2 * length),
        sa.Dugdale(W, length, W / length, 0.1),
    ):
        modulus = sqrt(RUBBER["radius"] * W**2 / law.range**3)
        contact = sa.Contact(TIP, sa.Elastic(modulus, 0.0), law)
        run = sa.force_distance(contact, sa.Triangle(60e-9, -5e-9, 1e-6))
        found = -float(run.force_min) / UNIT, float(run.loop_energy) / (UNIT * law.range)
        yield law.kind, found[0], LAWS["pull_off"][law.kind], found[1], LAWS["loop"][law.kind]


def compare_dent(ratio: float, share: float, decay: float) -> tuple[float, float]:
    """Largest difference of a run from Ting, and that of the loops, per cent of peak and loop."""
    sample = sa.StandardLinearSolid.from_relaxation_time(
        ratio * MODULUS, MODULUS, share * TIME, 0.0
    )
    # The gap at which the wall carries the mean pressure of the deepest contact.
    motion = sa.Triangle(0.3 * DEPTH, -DEPTH, DEPTH / TIME)
    known = indentation.ting(TIP, sample, motion)
    wall = 1e3 * ratio * MODULUS
    gap = decay * log(wall / (known.force.max() / (pi * known.contact_radius.max() ** 2)))
    contact = sa.Contact(TIP, sample, sa.Repulsion(wall, decay))
    start = 0.3 * DEPTH + gap
    run = sa.force_distance(contact, sa.Triangle(start, gap - DEPTH, DEPTH / TIME))
    beside = indentation.ting(TIP, sample, motion, run.time.values[run.time <= motion.breaks[-1]])
    apart = np.abs(run.force.values[: beside.force.size] - beside.force).max()
    loop = -trapezoid(known.force, known.height)
    return 100 * apart / known.force.max(), 100 * (float(run.loop_energy) / loop - 1)


def list_dents() -> Iterator[tuple]:
    """Yield dents and how far runs with a long and a short wall are from Ting."""
    for ratio, share in DENTS:
        found = (compare_dent(ratio, share, decay) for decay in (LONG_WALL, SHORT_WALL))
        yield ratio, share, *(f"{value:+.2f}" for pair in found for value in pair)


def list_transition() -> Iterator[tuple]:
    """Yield pull-offs over πRW by Tabor number: of a Lennard-Jones law, Maugis, and JKR."""
    R, W, Z0 = common.R, common.W, common.Z0
    for tabor in (0.1, 0.5, 1.0, 2.0, 5.0):
        contact = common.elastic_contact(tabor)
        motion = sa.Triangle((3 * tabor + 8) * Z0, -(tabor + 2) * Z0, 1e-6)
        run = -float(sa.force_distance(contact, motion).force_min)
        modulus, tension = common.jkr_like(tabor), contact.surface.largest_tension
        known = -indentation.maugis_parting(contact.tip, modulus, W, tension, 0).force
        yield tabor, *(f"{value / (pi * R * W):.3f}" for value in (run, known))


def show(title: str, headings: Iterable[str], rows: Iterable[Iterable]) -> None:
    """Print a table, all columns but the first to the right."""
    first, *rest = headings
    common.show(title, {first: "left", **dict.fromkeys(rest, "right")}, rows)


def main() -> None:
    """Print all tables."""
    pulls = ((n, f"{v:g}", f"{found:.3f}", f"{known:g}") for n, v, found, known in list_pulls())
    show("Pull-off over πRW", ("varied", "value, SI", "found", "known"), pulls)
    laws = ((law, *(f"{value:.3f}" for value in values)) for law, *values in list_laws())
    headings = "law", "pull-off", "known", "loop", "known loop"
    show("Laws at Tabor number 1", headings, laws)
    show("Pull-off of elastic samples", ("Tabor number", "found", "Maugis"), list_transition())
    walls = [f"{name}, %, wall of {1e9 * decay:g} nm" for decay in (LONG_WALL, SHORT_WALL)
             for name in ("force", "loop")]  # fmt: skip
    show("Dents beside Ting", ("E0/E_inf", "λ/t_m", *walls), list_dents())


if __name__ == "__main__":
    main()
