"""Answers that good guesses miss, by an independent solver: pull-off against speed, dwell, depth.

See data/README.md.
"""

import json
from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest

import softafm as sa
from softafm import indentation

KNOWN = json.loads((Path(__file__).parent / "data" / "known_answers.json").read_text())
RUBBER = KNOWN["rubber"]
UNIT = pi * RUBBER["radius"] * RUBBER["work_of_adhesion"]
STICKY = sa.LennardJones.from_work_of_adhesion(RUBBER["work_of_adhesion"], RUBBER["z0"])
PARABOLOID = sa.Paraboloid(RUBBER["radius"])
SOLID = sa.StandardLinearSolid(*(RUBBER[name] for name in ("E0", "E_inf", "creep_time", "poisson")))


def pull(speed, depth=-RUBBER["turn"], sample=SOLID, **options):
    contact = sa.Contact(PARABOLOID, sample, STICKY)
    return sa.force_distance(contact, sa.Triangle(RUBBER["start"], -depth, speed, **options))


def measure_pull_off(run):
    return -float(run.force_min) / UNIT


def list_pairs(table):
    return list(zip(table["value"], table["pull_off"], strict=True))


@pytest.mark.parametrize(("speed", "known"), list_pairs(RUBBER["speed"]))
def test_pull_off_is_largest_at_a_speed_between(speed, known):
    # Given to three digits.
    assert measure_pull_off(pull(speed)) == pytest.approx(known, rel=0.005)


def test_the_fastest_and_the_most_lossy_pull_are_not_the_same():
    stuck, lossy = RUBBER["largest_pull_off"], RUBBER["largest_loop"]
    runs = {speed: pull(speed) for speed in (2e-5, 3e-5, 4.5e-5, 6e-5, 8e-5, 1.1e-4)}
    strongest = max(runs, key=lambda speed: measure_pull_off(runs[speed]))
    assert strongest == stuck["speed"]
    assert measure_pull_off(runs[strongest]) == pytest.approx(stuck["value"], rel=0.005)
    loops = {speed: float(run.loop_energy) for speed, run in runs.items()}
    assert max(loops, key=loops.get) == lossy["speed"]
    assert loops[lossy["speed"]] == pytest.approx(lossy["value"], rel=0.005)


@pytest.mark.parametrize(("dwell", "known"), list_pairs(RUBBER["dwell"]))
def test_pull_off_grows_with_dwell(dwell, known):
    run = pull(RUBBER["dwell"]["speed"], dwell=dwell)
    assert measure_pull_off(run) == pytest.approx(known, rel=0.004)


def test_a_dwell_is_nearly_complete_only_after_sixteen_creep_times():
    last = measure_pull_off(pull(1e-2, dwell=1.0))
    for creep_times, within in ((12, False), (20, True)):
        run = pull(1e-2, dwell=creep_times * SOLID.creep_time)
        assert (measure_pull_off(run) > 0.95 * last) is within


@pytest.mark.parametrize(("depth", "known"), list_pairs(RUBBER["depth"]))
def test_pull_off_grows_with_depth_where_the_sample_creeps(depth, known):
    found = measure_pull_off(pull(RUBBER["depth"]["speed"], depth))
    assert found == pytest.approx(known, rel=0.003)
    relaxed = sa.Elastic(SOLID.E_inf, SOLID.poisson)
    elastic = measure_pull_off(pull(1e-5, depth, relaxed))
    assert elastic == pytest.approx(RUBBER["elastic"]["E_inf"], rel=0.003)


def test_pull_off_of_the_glassy_sample():
    glassy = sa.Elastic(SOLID.E0, SOLID.poisson)
    found = measure_pull_off(pull(1e-5, sample=glassy))
    assert found == pytest.approx(RUBBER["elastic"]["E0"], rel=0.003)


W, Z0 = KNOWN["laws"]["work_of_adhesion"], KNOWN["laws"]["length"]
LAWS = [
    sa.LennardJones.from_work_of_adhesion(W, Z0),
    sa.Morse(W, Z0, Z0 / 2),
    sa.Exponential(W, Z0, Z0, 0.2 * Z0),
    sa.Dugdale(W, Z0, W / Z0, 0.1),
]


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.kind)
def test_at_one_tabor_number_laws_differ_little_in_pull_off_and_much_in_loss(law):
    modulus = sqrt(RUBBER["radius"] * W**2 / law.range**3)
    contact = sa.Contact(PARABOLOID, sa.Elastic(modulus, 0.0), law)
    assert contact.tabor_relaxed == pytest.approx(1)
    run = sa.force_distance(contact, sa.Triangle(60e-9, -5e-9, 1e-6), tolerance=2e-3)
    assert measure_pull_off(run) == pytest.approx(KNOWN["laws"]["pull_off"][law.kind], rel=0.003)
    loop = float(run.loop_energy) / (UNIT * law.range)
    assert loop == pytest.approx(KNOWN["laws"]["loop"][law.kind], rel=0.01)


def test_at_fixed_grips_the_jump_out_is_near_that_of_jkr():
    known = KNOWN["fixed_grips"]
    R, tabor = RUBBER["radius"], known["tabor"]
    modulus = sqrt(R * W**2 / (tabor**3 * Z0**3))
    contact = sa.Contact(PARABOLOID, sa.Elastic(modulus, 0.0), STICKY)
    run = sa.force_distance(contact, sa.Triangle(40e-9, -10e-9, 1e-6))
    last = int(np.searchsorted(run.time.values, run.jump_time.values[-1])) - 1
    force = float(run.force[last]) / float(run.force_min)
    assert force == pytest.approx(known["jump_out_force"], abs=0.004)
    jkr = indentation.jkr_parting(PARABOLOID, modulus, W)
    height = float(run.tip_height[last]) / -jkr.depth
    assert height == pytest.approx(known["jump_out_height"], rel=0.003)


LDPE = sa.Contact(sa.Paraboloid(10e-9), sa.samples.ldpe(), sa.LennardJones(1e-19, 0.25e-9))


def test_a_tap_on_polyethylene_that_is_never_repulsive():
    known = KNOWN["ldpe"]["setpoint"]
    tap = sa.tapping_cycle(LDPE, known["amplitude"], known["mean_height"], 278e3)
    for name in ("virial", "dissipation", "force_mean"):
        assert float(tap[name]) == pytest.approx(known[name], rel=0.01)
    assert float(tap.force_max) <= 0


def test_the_virial_of_a_surface_that_bulges_is_twice_that_of_a_flat_one_and_more():
    known = KNOWN["ldpe"]["virial"]
    A, phase = known["amplitude"], 2 * pi * (np.arange(1000) + 0.5) / 1000
    H, R, z0 = LDPE.surface.hamaker, LDPE.tip.radius, LDPE.surface.z0
    for Z, value in zip(known["mean_height"], known["value"], strict=True):
        tap = sa.tapping_cycle(LDPE, A, Z, 278e3)
        assert float(tap.virial) == pytest.approx(value, rel=0.01)
        gap = Z + A * np.cos(phase)
        flat = -H * R / (6 * gap**2) * (1 - z0**6 / (4 * gap**6))
        assert LDPE.rigid_force(gap) == pytest.approx(flat, rel=1e-6)
        assert float(tap.virial) > 2 * np.mean(flat * A * np.cos(phase))


def test_the_second_of_two_equal_dents_is_lower():
    speed, start, turn = 1e-5, 5e-9, -5e-9
    corners = np.array([0, 1, 2, 3, 4]) * (start - turn) / speed
    motion = sa.Trajectory(corners, [start, turn, start, turn, start])
    sample = sa.StandardLinearSolid(1e9, 0.1e9, 1e-3, 0.5)
    contact = sa.Contact(sa.Paraboloid(100e-9), sample, sa.Repulsion(1e8, 0.3e-9))
    run = sa.force_distance(contact, motion, tolerance=2e-3)
    time, force, height = (run[name].values for name in ("time", "force", "tip_height"))
    halves = time <= corners[2], time >= corners[2]
    peaks = [force[half].max() for half in halves]
    losses = [-np.trapezoid(force[half], height[half]) for half in halves]
    assert peaks[1] / peaks[0] == pytest.approx(KNOWN["two_dents"]["peak"], abs=0.002)
    assert losses[1] / losses[0] == pytest.approx(KNOWN["two_dents"]["energy"], abs=0.005)
