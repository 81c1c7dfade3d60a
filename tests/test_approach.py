"""Approach curves: heights that go with amplitudes, and what is recorded on the way."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import trapezoid
from scipy.special import ellipe, ellipk

import softafm as sa

REFERENCE = json.loads((Path(__file__).parent / "data" / "approach_curve_ps.json").read_text())
INPUTS, CURVE = REFERENCE["inputs"], REFERENCE["curve"]
FREE = INPUTS["free_amplitude"]
PS = sa.Contact(
    sa.Paraboloid(INPUTS["radius"]),
    sa.StandardLinearSolid(INPUTS["E0"], INPUTS["E_inf"], INPUTS["tau"], INPUTS["poisson"]),
    sa.LennardJones(INPUTS["hamaker"], INPUTS["z0"]),
)
LEVER = sa.Cantilever(INPUTS["stiffness"], INPUTS["quality_factor"], INPUTS["frequency"])
RATIOS = [row["amplitude_ratio"] for row in CURVE]
# Farthest solutions at which the reference's own dissipation is wrong (see data/README.md).
WEAK = {0.95: 1.920e-19, 0.9: 3.121e-19, 0.8: 4.527e-19, 0.2: 4.198e-19}
OBSERVABLES = (
    "virial", "dissipation", "force_mean", "force_max", "force_min", "contact_time", "indentation",
)  # fmt: skip


@pytest.fixture(scope="module")
def curve():
    return sa.approach_curve(PS, LEVER, FREE, RATIOS)


@pytest.fixture(scope="module")
def sweep():
    return sa.approach_curve(PS, LEVER, FREE, np.linspace(0.2, 0.98, 27))


def balance(amplitude, virial, dissipation, frequency=LEVER.frequency):
    """cos φ and sin φ that hold an amplitude: CHECKS, off resonance; F0 that of the free lever."""
    k, Q, r = LEVER.stiffness, LEVER.quality_factor, frequency / LEVER.frequency
    drive = k * FREE * abs(1 - r**2 + 1j * r / Q)
    cosine = (k * amplitude * (1 - r**2) - 2 * virial / amplitude) / drive
    sine = (k * amplitude * r / Q + dissipation / (np.pi * amplitude)) / drive
    return cosine, sine


# Against converged numbers


def test_all_solutions_of_the_reference_are_found_and_no_others(curve):
    for i, row in enumerate(CURVE):
        found = curve.isel(amplitude_ratio=i)
        heights = found["mean_height"].values
        kinds = {1: ["repulsive"], 3: ["attractive", "unstable", "repulsive"]}
        kinds = kinds[len(row["solutions"])] if i else ["attractive"]
        assert list(found["branch"].values[~np.isnan(heights)]) == kinds
        for kind, solution in zip(kinds, row["solutions"], strict=True):
            values = found.sel(branch=kind)
            weak = WEAK.get(row["amplitude_ratio"]) if kind == "attractive" else None
            dissipation = weak or solution["dissipation"]
            assert float(values["mean_height"]) == pytest.approx(
                solution["mean_height"], abs=0.02e-9
            )
            assert float(values["phase"]) == pytest.approx(solution["phase_deg"], abs=0.5)
            assert float(values["virial"]) == pytest.approx(solution["virial"], rel=0.02)
            assert float(values["dissipation"]) == pytest.approx(dissipation, rel=0.02)
            largest = max(abs(solution["force_max"]), abs(solution["force_min"]))
            for name in ("force_max", "force_min"):
                assert float(values[name]) == pytest.approx(solution[name], abs=0.02 * largest)


def rings(edges):
    """Middles of rings, and the displacement K there of unit pressures on them."""
    r = (edges[1:] + edges[:-1]) / 2

    def disc(a):
        inside = r[:, None] <= a
        x = np.where(inside, r[:, None] / np.where(inside, a, 1), a / r[:, None]) ** 2
        far = ellipe(x) - (1 - x) * ellipk(x)
        return 4 / np.pi * np.where(inside, a * ellipe(x), r[:, None] * far)

    outer = disc(edges[None, 1:])
    return r, outer - np.pad(outer[:, :-1], ((0, 0), (1, 0)))


@pytest.mark.parametrize("ratio", WEAK)
def test_weak_dissipation_by_newtons_method_on_rings(ratio):
    """What replaces the reference where its own dissipation is doubtful, and what softafm finds.

    u = −K(J_g p + J_1 w) on constant-pressure rings, w by the trapezoidal rule, in steps that are
    finest about the lowest point.
    """
    (solution,) = [row["solutions"][0] for row in CURVE if row["amplitude_ratio"] == ratio]
    amplitude, mean_height = ratio * FREE, solution["mean_height"]
    edges = np.append(np.linspace(0, 12e-9, 80), np.geomspace(12e-9, 80e-9, 21)[1:])
    r, influence = rings(edges)
    areas, tip = np.pi * np.diff(edges**2), r**2 / (2 * INPUTS["radius"])
    factor = 1 - INPUTS["poisson"] ** 2
    stiff = factor / INPUTS["E0"]
    soft = factor / INPUTS["E_inf"] - stiff
    H, z0 = INPUTS["hamaker"], INPUTS["z0"]

    def pressure(gap):
        return H / (6 * np.pi * gap**3) * ((z0 / gap) ** 6 - 1)

    def slope(gap):
        return H / (6 * np.pi * gap**4) * (3 - 9 * (z0 / gap) ** 6)

    s = np.linspace(-1, 1, 801)
    time = 0.5 / INPUTS["frequency"] + 1.2e-6 * (0.15 * s + 0.85 * s**3)
    heights = mean_height + amplitude * np.cos(2 * np.pi * INPUTS["frequency"] * time)
    w = p = pressure(heights[0] + tip)
    u = -influence @ (stiff * p + soft * w)
    power, forces = [], []
    for height, step in zip(heights, np.diff(time, prepend=time[0]), strict=True):
        half = step / (2 * INPUTS["tau"])
        past, share = (w * (1 - half) + half * p) / (1 + half), half / (1 + half)
        compliance = stiff + soft * share
        for _ in range(20):
            gap = height + tip - u
            p = pressure(gap)
            miss = u + soft * influence @ past + compliance * influence @ p
            if np.abs(miss).max() < 1e-7 * z0:
                break
            u = u - np.linalg.solve(np.eye(r.size) - compliance * influence * slope(gap), miss)
        w = past + share * p
        power.append(soft / INPUTS["tau"] * (areas * (p - w)) @ (influence @ (p - w)))
        forces.append(areas @ p)
    loss = trapezoid(power, time)
    # All work done is lost: the numbers are consistent.
    assert -trapezoid(forces, heights) == pytest.approx(loss, rel=2e-3)
    assert loss == pytest.approx(WEAK[ratio], rel=2e-3)
    tap = sa.tapping_cycle(PS, amplitude, mean_height, LEVER.frequency, tolerance=1e-3)
    for name in ("dissipation", "viscous_loss"):
        assert float(tap[name]) == pytest.approx(loss, rel=5e-3)
    assert solution["dissipation"] < 0.99 * loss


# Identities


def test_squares_of_sine_and_cosine_add_up(curve, sweep):
    for result in (curve, sweep):
        table = [result[n].values for n in ("phase", "virial", "dissipation")]
        amplitude = np.broadcast_to(FREE * result["amplitude_ratio"].values, table[0].shape)
        groups = [(amplitude, table)]
        for way in ("approach", "retract"):
            columns = [result[f"{way}_{n}"].values for n in ("phase", "virial", "dissipation")]
            groups.append((result[f"{way}_amplitude"].values, columns))
        for a, (phase, virial, dissipation) in groups:
            known = ~np.isnan(phase)
            assert known.sum() > 10
            cosine, sine = balance(a[known], virial[known], dissipation[known])
            assert cosine**2 + sine**2 == pytest.approx(np.ones(cosine.size), abs=5e-3)
            angle = np.radians(phase[known])
            assert np.cos(angle) == pytest.approx(cosine, abs=5e-3)
            assert np.sin(angle) == pytest.approx(sine, abs=5e-3)


@pytest.mark.parametrize("shift", [-200.0, 300.0])
def test_solutions_off_resonance_hold_when_tapped(shift):
    frequency = LEVER.frequency + shift
    result = sa.approach_curve(PS, LEVER, FREE, [0.4, 0.85], drive_frequency=frequency)
    phase = result["phase"].values
    checked = 0
    for i, kind in enumerate(result["branch"].values):
        for j, ratio in enumerate(result["amplitude_ratio"].values):
            height = float(result["mean_height"][i, j])
            if np.isnan(height):
                continue
            tap = sa.tapping_cycle(PS, ratio * FREE, height, frequency, tolerance=1e-3)
            for name in OBSERVABLES:
                unit = abs(float(tap["force_min"]))
                unit *= 0.02 * FREE if name in ("virial", "dissipation") else 1.0
                if name == "contact_time":
                    unit = 1e-6
                if name == "indentation":
                    unit = 1e-9
                allowed = 0.02 * max(unit, abs(float(tap[name])))
                assert float(result[name][i, j]) == pytest.approx(float(tap[name]), abs=allowed)
            found = float(tap["virial"]), float(tap["dissipation"])
            cosine, sine = balance(ratio * FREE, *found, frequency)
            assert np.hypot(cosine, sine) == pytest.approx(1, abs=0.02)
            assert phase[i, j] == pytest.approx(np.degrees(np.arctan2(sine, cosine)), abs=1)
            assert (phase[i, j] > 90) == (kind == "attractive") or kind == "unstable"
            checked += 1
    # Below resonance attraction, which softens the lever, finds it past its peak: no choice.
    assert checked == (2 if shift < 0 else 4)
    if shift < 0:
        for name in ("amplitude", "phase", *OBSERVABLES):
            one, other = (result[f"{way}_{name}"].values for way in ("approach", "retract"))
            assert np.array_equal(one, other)
            assert np.all(np.isfinite(one))


# What an instrument records


def jump(result, way):
    """Heights between which the amplitude of a sweep jumps."""
    amplitude = result[f"{way}_amplitude"].values
    steps = np.abs(np.diff(amplitude))
    at = int(np.nanargmax(steps))
    others = np.delete(steps, at)
    assert steps[at] > 5 * np.nanmax(others)  # only one
    heights = result["sweep_height"].values
    return heights[at + 1], heights[at]


def test_approach_and_retract_differ_where_three_solutions_exist(sweep):
    height = sweep["sweep_height"].values
    down, up = (sweep[f"{way}_amplitude"].values for way in ("approach", "retract"))
    assert np.all(np.diff(height) < 0)
    low, high = jump(sweep, "approach")[0], jump(sweep, "retract")[1]
    between = (height > low + 1e-12) & (height < high - 1e-12)
    assert between.sum() > 40
    assert np.all(up[between] > down[between] + 0.3e-9)
    phase_down, phase_up = (sweep[f"{way}_phase"].values for way in ("approach", "retract"))
    assert np.all(phase_down[between] > 100)
    assert np.all(phase_up[between] < 92)
    for name in ("amplitude", "phase", *OBSERVABLES):
        one, other = (sweep[f"{way}_{name}"].values for way in ("approach", "retract"))
        assert np.array_equal(one[~between], other[~between]), name
    # The reference's stable solutions lie on their sweep, or on both; the unstable ones on none.
    for row in CURVE:
        if len(row["solutions"]) < 3 or row["amplitude_ratio"] < 0.7:
            continue
        passed = np.array(
            [
                [np.interp(-solution["mean_height"], -height, way) for way in (down, up)]
                for solution in row["solutions"]
            ]
        )
        on = np.abs(passed / FREE - row["amplitude_ratio"]) < 2e-3
        attractive, unstable, repulsive = (solution["mean_height"] for solution in row["solutions"])
        assert low < unstable < high
        wanted = [[True, attractive > high], [False, False], [repulsive < low, True]]
        assert on.tolist() == wanted


@pytest.mark.parametrize(
    ("way", "ratios", "above", "below"),
    [("approach", (0.66, 0.78), 3, 1), ("retract", (0.912, 0.96), 0, 2)],
)
def test_sweeps_jump_where_solutions_vanish(sweep, way, ratios, above, below):
    # Two of the amplitudes that a height allows meet: the stable one that was followed and the
    # unstable one next to it. Counted by taps at both ends of the step in which the sweep jumps.
    low, high = jump(sweep, way)
    assert high - low < 0.06e-9
    # Heights of a curve at the usual tolerance are good to some hundredths of a nanometre.
    for height, wanted in ((high + 0.05e-9, above), (low - 0.05e-9, below)):
        surplus = []
        for amplitude in FREE * np.linspace(*ratios, 31):
            tap = sa.tapping_cycle(PS, amplitude, height, LEVER.frequency, tolerance=1e-3)
            needed = balance(amplitude, float(tap["virial"]), float(tap["dissipation"]))
            surplus.append(np.hypot(*needed) > 1)
        assert np.count_nonzero(np.diff(surplus)) == wanted


def test_the_unstable_branch_lies_between_the_stable_ones(sweep):
    attractive, unstable, repulsive = sweep["mean_height"].values
    known = ~np.isnan(unstable)
    assert known.sum() > 10
    assert np.all(attractive[known] > unstable[known])
    assert np.all(unstable[known] > repulsive[known])
    # Two islands of it: the attractive branch breaks off around half the amplitude.
    assert np.abs(np.diff(known.astype(int))).sum() == 3
    ratio = sweep["amplitude_ratio"].values
    assert not known[(ratio > 0.45) & (ratio < 0.68)].any()


def test_amplitudes_of_the_sweep_outside_the_asked_range_are_unknown():
    result = sa.approach_curve(PS, LEVER, FREE, np.linspace(0.75, 0.9, 7))
    for way in ("approach", "retract"):
        amplitude = result[f"{way}_amplitude"].values
        inside = amplitude[~np.isnan(amplitude)]
        assert inside.size > 50
        assert inside.min() > 0.74 * FREE
        assert inside.max() < 0.91 * FREE


# Calling


def test_one_amplitude_alone_and_progress(curve):
    heard = []
    alone = sa.approach_curve(PS, LEVER, FREE, 0.8, progress=lambda *report: heard.append(report))
    assert alone.sizes["amplitude_ratio"] == 1
    wanted = curve.sel(amplitude_ratio=0.8)["mean_height"].values
    assert alone["mean_height"].values[:, 0] == pytest.approx(wanted, abs=0.01e-9)
    fractions = [fraction for fraction, _ in heard]
    assert len(fractions) > 10
    assert fractions == sorted(fractions)
    assert 0 < fractions[0] < fractions[-1] <= 1
    assert all("taps" in message for _, message in heard[:-1])


def test_tolerance_narrows_the_answer(curve):
    fine = sa.approach_curve(PS, LEVER, FREE, [0.9, 0.4], tolerance=2e-3)
    coarse = curve.sel(amplitude_ratio=[0.9, 0.4])
    for name, allowed in (("mean_height", 0.003e-9), ("phase", 0.3)):
        assert fine[name].values == pytest.approx(coarse[name].values, abs=allowed)


@pytest.mark.parametrize("name", ["quality_factor", "frequency"])
def test_levers_that_cannot_be_driven_are_refused(name):
    values = {"stiffness": 28.1, "quality_factor": 430.0, "frequency": 278e3}
    with pytest.raises(ValueError, match=f"^cantilever.{name} = None") as caught:
        sa.approach_curve(PS, sa.Cantilever(**{**values, name: None}), FREE, [0.5])
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("bad", [0.0, 1.0, 1.2, -0.1, np.nan, np.inf])
def test_ratios_out_of_range_are_refused(bad):
    with pytest.raises(ValueError, match=r"^amplitude_ratio\[1\] = "):
        sa.approach_curve(PS, LEVER, FREE, [0.5, bad, 0.6])


@pytest.mark.parametrize("bad", [[], [[0.5, 0.6]]])
def test_misshapen_ratios_are_refused(bad):
    with pytest.raises(ValueError, match=r"^amplitude_ratio has shape"):
        sa.approach_curve(PS, LEVER, FREE, bad)


@pytest.mark.parametrize("name", ["free_amplitude", "drive_frequency"])
@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan])
def test_bad_numbers_are_refused(name, bad):
    arguments = {"free_amplitude": FREE, "amplitude_ratio": [0.5], name: bad}
    with pytest.raises(ValueError, match=f"^{name} = "):
        sa.approach_curve(PS, LEVER, **arguments)


@pytest.mark.parametrize(
    ("lever", "ratios", "line"),
    [
        (28.1, [0.9], r"^cantilever = 28\.1: must be a softafm\.Cantilever$"),
        (sa.Cantilever(28.1, 430, 278e3), "0.9", r"^amplitude_ratio = '0\.9': must be a list"),
        (sa.Cantilever(28.1, 430, 278e3), [0.9, None], r"^amplitude_ratio\[1\] = nan"),
        (sa.Cantilever(28.1, 430, 278e3), [0.9, "x"], r"^amplitude_ratio = \[0\.9, 'x'\]: must"),
    ],
)
def test_what_is_no_lever_or_no_ratio_is_refused(lever, ratios, line):
    contact = sa.Contact(
        sa.Paraboloid(1e-8), sa.Elastic(1e9, 0.3), sa.LennardJones(hamaker=1e-19, z0=3e-10)
    )
    with pytest.raises(ValueError, match=line):
        sa.approach_curve(contact, lever, 15e-9, ratios)


def test_a_fluid_is_refused_with_a_way_out():
    fluid = sa.Contact(PS.tip, sa.Maxwell(1e9, 1e-3, 0.3), PS.surface)
    with pytest.raises(ValueError, match="flows") as refused:
        sa.approach_curve(fluid, LEVER, 15e-9, [0.9])
    assert str(refused.value) == (
        "no height goes with an amplitude: the sample 'maxwell' flows, so that the tip sinks "
        "deeper with every cycle; take tapping_cycle with a number of cycles, or force_distance"
    )
