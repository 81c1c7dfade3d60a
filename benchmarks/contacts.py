"""Experiments as people make them, drawn at random: one for every seed, always the same.

Colloids on gels of 1 kPa to sharp tips on glassy polymers; elastic, Kelvin-Voigt, standard linear,
Maxwell, Prony and power-law samples with creep times of 1e-8 to 1e3 s, and the named ones; levers
of 0.006 to 200 N/m, speeds of 1 nm/s to 10 mm/s, approach curves with Q of 2 to 1000. Forces are
what a trigger would be, curves start out of contact and mostly end there, and the base of a lever
goes farther by what bends it. Of contacts above a Tabor number of 30 half are regularised.

    python benchmarks/contacts.py SEED [SEED ...]        prints the experiments of these seeds
"""

import sys
from dataclasses import replace
from math import pi

import numpy as np

import softafm as sa
from softafm import rheology
from softafm.experiment.config import Experiment
from softafm.instrument.motions import Sine
from softafm.modes.driven import AmplitudeSweep

MODES = {
    "force-distance": 0.3, "force-spectroscopy": 0.3, "tapping-cycle": 0.25, "approach-curve": 0.15,
}  # fmt: skip
SOFTEST, SOFT = 1000, 30
"""Tabor numbers above which no contact is drawn, and above which half are regularised."""
FARTHEST = 3e-6
"""By how much a lever bends at most, m: another is taken to measure more."""


class Random:
    """Random numbers of a seed."""

    def __init__(self, seed: int):
        self.generator = np.random.default_rng([16, seed])

    def between(self, low: float, high: float) -> float:
        """Return a number whose logarithm is uniform."""
        return float(np.exp(self.generator.uniform(np.log(low), np.log(high))))

    def uniform(self, low: float, high: float) -> float:
        return float(self.generator.uniform(low, high))

    def either(self, *choices):
        """Return what one of some functions returns, all of them as likely."""
        return choices[self.generator.integers(len(choices))]()


def draw(seed: int) -> Experiment:
    """Return the experiment of a seed."""
    random = Random(seed)
    mode = str(random.generator.choice(list(MODES), p=list(MODES.values())))
    make = {
        "force-distance": ramp, "force-spectroscopy": ramp_of_lever, "tapping-cycle": taps,
        "approach-curve": approach,
    }[mode]  # fmt: skip
    experiment = None
    while experiment is None:
        experiment = make(random)
    return experiment


def ramp(random: Random) -> Experiment | None:
    """Return a force curve, or None if it was one that nobody would measure."""
    tip = random.either(
        lambda: sa.Paraboloid(random.between(5e-9, 5e-6)),
        lambda: sa.Sphere(random.between(5e-9, 5e-6)),
        lambda: sharp(random),
        lambda: blunt(random),
    )
    modulus, speed = random.between(1e3, 1e10), random.between(1e-9, 1e-2)
    law = draw_law(random, modulus)
    force = random.between(1e-10, 1e-5)
    depth = depth_of(sa.Contact(tip, sa.Elastic(modulus, 0.4), law), force)
    sample = draw_sample(random, modulus, depth / speed)
    contact = sa.Contact(tip, sample, law)
    if contact.tabor_softened > SOFTEST:
        return None
    number = choose_number(random, contact)
    touched = contact if number == "auto" else contact.regularised(number)
    neck = neck_of(touched)
    if neck > 0.5 * contact.effective_radius:
        return None
    start = touched.edge_gap + 10 * touched.reach + random.uniform(1.2, 4) * neck + 0.5 * depth
    dwell = random.either(lambda: 0.0, lambda: 0.0, lambda: depth / speed * random.between(0.1, 10))
    motion = sa.Triangle(start, -depth, speed, dwell=dwell)
    return Experiment("force-distance", contact, motion, regularise=number)


def ramp_of_lever(random: Random) -> Experiment | None:
    """Return the same with a lever; half of them turn at a force."""
    drawn = ramp(random)
    if drawn is None:
        return None
    contact, motion = drawn.contact, drawn.motion
    lever = sa.Cantilever(random.between(0.006, 200))
    depth = -motion.turn
    modulus = 1 / float(contact.body.compliance.at(depth / motion.speed))
    radius = contact.tip.radius_at(depth)
    force = 4 / 3 * modulus * radius * depth
    pulled = 2 * pi * contact.effective_radius * max(contact.surface.work_of_adhesion, 0.0)
    if max(force, pulled) / lever.stiffness > FARTHEST:
        return None
    start = motion.start + random.uniform(1, 2) * pulled / lever.stiffness
    turn = motion.turn - force / lever.stiffness
    motion = random.either(
        lambda: sa.Triangle(start, turn, motion.speed, motion.dwell),
        lambda: sa.Triangle(start, 3 * turn, motion.speed, motion.dwell, setpoint_force=force),
    )
    return replace(drawn, mode="force-spectroscopy", motion=motion, cantilever=lever)


def taps(random: Random) -> Experiment | None:
    """Return taps, or None if the tip would not come off."""
    amplitude, frequency = random.between(2e-9, 1e-7), random.between(1e4, 1e6)
    tip, modulus, law = tapped(random)
    elastic = sa.Contact(tip, sa.Elastic(modulus, 0.4), law)
    depth = min(depth_of(elastic, random.between(1e-10, 1e-7)), 0.5 * amplitude)
    touching = np.sqrt(2 * depth / amplitude) / (pi * frequency)
    contact = sa.Contact(tip, draw_sample(random, modulus, touching), law)
    if contact.tabor_softened > SOFTEST or neck_of(contact) + law_length(contact) > amplitude:
        return None
    closest = law_length(contact) * random.uniform(0, 0.2) if random.uniform(0, 1) < 0.2 else -depth
    cycles = "steady"
    if contact.body.compliance.fluidity > 0:
        cycles = int(random.generator.integers(1, 4))
    motion = Sine(amplitude + closest, amplitude, frequency, cycles)
    number = choose_number(random, contact)
    return Experiment("tapping-cycle", contact, motion, regularise=number)


def approach(random: Random) -> Experiment | None:
    """Return an approach curve, or None if the lever would stick."""
    tip, modulus, law = tapped(random)
    frequency, amplitude = random.between(1e4, 5e5), random.between(5e-9, 1e-7)
    quality = random.between(2, 1000)
    contact = sa.Contact(tip, draw_sample(random, modulus, 0.1 / frequency), law)
    lever = sa.Cantilever(random.between(0.1, 50), quality_factor=quality, frequency=frequency)
    pull = 2 * pi * contact.effective_radius * max(law.work_of_adhesion, 0.0)
    sticks = lever.stiffness * amplitude < 3 * pull or neck_of(contact) > amplitude
    if sticks or contact.tabor_softened > SOFTEST or contact.body.compliance.fluidity > 0:
        return None
    ratios = np.linspace(0.95, random.uniform(0.2, 0.6), 8)
    sweep = AmplitudeSweep(amplitude, tuple(map(float, ratios)), None)
    number = choose_number(random, contact)
    return Experiment("approach-curve", contact, sweep, lever, regularise=number)


def tapped(random: Random) -> tuple[sa.Tip, float, sa.SurfaceLaw]:
    """Return a tip, a modulus and a law as taps are made with."""
    tip = random.either(
        lambda: sa.Paraboloid(random.between(5e-9, 1e-7)),
        lambda: sa.Sphere(random.between(5e-9, 1e-7)),
        lambda: sharp(random),
    )
    modulus = random.between(1e6, 1e10)
    return tip, modulus, draw_law(random, modulus)


def sharp(random: Random) -> sa.Tip:
    apex, angle = random.between(5e-9, 5e-8), random.uniform(0.2, 1.2)
    return random.either(lambda: sa.Cone(angle, apex), lambda: sa.Hyperboloid(apex, angle))


def blunt(random: Random) -> sa.Tip:
    radius = random.between(5e-8, 5e-6)
    return sa.FlatPunch(radius, radius * random.uniform(0.05, 1))


def draw_law(random: Random, modulus: float) -> sa.SurfaceLaw:
    z0, work = random.uniform(0.15e-9, 0.5e-9), random.between(1e-5, 0.1)
    return random.either(
        lambda: sa.LennardJones.from_work_of_adhesion(work, z0),
        lambda: sa.DMT.from_work_of_adhesion(work, z0, random.uniform(0.05, 0.25)),
        lambda: sa.Morse(work, z0, z0 * random.uniform(0.2, 0.6)),
        lambda: sa.Exponential(work, z0, z0 * random.uniform(0.4, 1), 0.1 * z0),
        lambda: sa.Dugdale(work, z0, work / z0 * random.uniform(0.5, 2), random.uniform(0.1, 0.3)),
        lambda: sa.DLVO(
            16 * pi * work * z0**2, z0, random.uniform(0, 0.05), random.between(1e-9, 3e-8)
        ),
        lambda: sa.Repulsion(modulus * random.between(10, 1000), random.between(0.1e-9, 1e-9)),
    )


def draw_sample(random: Random, modulus: float, duration: float) -> rheology.Solid:
    """Return a sample of a modulus in the long run, loaded for a time, s."""
    ratio, nu = random.between(1, 1000), random.uniform(0.2, 0.5)
    creep_time = random.either(
        lambda: random.between(1e-8, 1e3),
        lambda: float(np.clip(duration * random.between(1e-3, 1e3), 1e-8, 1e3)),
    )
    window = (1e-2 * duration, 1e3 * duration)
    named = (
        sa.samples.pdms, sa.samples.ldpe, sa.samples.polystyrene, sa.samples.polyisobutylene,
        sa.samples.epoxy,
    )  # fmt: skip
    return random.either(
        lambda: sa.Elastic(modulus, nu),
        lambda: sa.StandardLinearSolid(modulus * ratio, modulus, creep_time, nu),
        lambda: sa.StandardLinearSolid(modulus * ratio, modulus, creep_time, nu),
        lambda: sa.KelvinVoigt(modulus, creep_time, nu),
        lambda: sa.Maxwell(modulus, creep_time, nu),
        lambda: sa.GeneralizedMaxwell(
            modulus, tuple(modulus * ratio * random.generator.uniform(0.1, 1, 6)),
            tuple(duration * np.geomspace(1e-3, 1e3, 6)), nu,
        ),
        lambda: sa.PowerLaw(modulus, random.uniform(0.1, 0.6), window, nu, duration),
        lambda: random.either(*named),
    )  # fmt: skip


def choose_number(random: Random, contact: sa.Contact) -> float | str:
    """Return the Tabor number to which a contact is regularised, or "auto"."""
    soft = contact.tabor_softened > SOFT and random.uniform(0, 1) < 0.5
    return 8.0 if soft and not isinstance(contact.surface, sa.DLVO) else "auto"


def depth_of(contact: sa.Contact, force: float) -> float:
    """Return how deep a force presses a tip, m, by Hertz: some of its range, and of its size."""
    R, law = contact.effective_radius, contact.reach
    depth = (0.75 * force / contact.softened_modulus / np.sqrt(R)) ** (2 / 3)
    round_tip = isinstance(contact.tip, sa.Paraboloid | sa.Sphere)
    return float(np.clip(depth, 0.5 * law, max(0.3 * R if round_tip else 5 * R, law)))


def neck_of(contact: sa.Contact) -> float:
    """Return how far a relaxed contact can be drawn up before it breaks, m; 0 without adhesion."""
    height = 0.5 * contact.reach
    while contact.contact_radius(height) > 0:
        height *= 1.25
    return height if contact.adhesive else 0.0


def law_length(contact: sa.Contact) -> float:
    """Return how far the surfaces feel each other, m."""
    return contact.edge_gap + 5 * contact.reach


def main(seeds=()):
    for seed in seeds:
        print(draw(int(seed)))


if __name__ == "__main__":
    main(sys.argv[1:])
