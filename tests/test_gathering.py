"""Warnings of many runs: one of each kind, in calls, in attributes of results, in files of maps."""

import warnings
from dataclasses import dataclass, replace

import numpy as np
import pytest

import softafm as sa
from softafm.checks.gathering import find_kind, gather, keep_worst

CONTACT = sa.Contact(
    sa.Paraboloid(10e-9),
    sa.StandardLinearSolid(2e9, 0.5e9, 1e-7, 0.49),
    sa.LennardJones(1e-19, 0.3e-9),
)
LIQUID = sa.Cantilever(stiffness=0.5, quality_factor=3.0, frequency=30e3)


@dataclass(frozen=True)
class Doubting(sa.solvers.Energy):
    """The default solver, which doubts every run, those of deep indentation most."""

    def solve(self, contact, motion, **options):
        history = super().solve(contact, motion, **options)
        depth = max(0.0, -float(history.axis_deformation.min()))
        texts = (f"the depth of {depth:.3g} m is doubtful, it is", "an old formula was used")
        doubts = tuple(sa.AccuracyWarning(text, depth) for text in texts)
        for doubt in doubts:
            warnings.warn(doubt, stacklevel=3)
        return replace(history, warnings=doubts)


def warned_of(call):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = call()
    return result, [str(each.message) for each in caught]


def test_a_curve_in_liquid_warns_once_of_each_kind():
    result, told = warned_of(
        lambda: sa.approach_curve(
            CONTACT, LIQUID, 5e-9, [0.9, 0.7, 0.5], solver=Doubting(), tolerance=0.1
        )
    )
    depths = [text for text in told if "is doubtful" in text]
    assert len(depths) == 1
    assert sum("an old formula" in text for text in told) == 1
    count, total = int(depths[0].split()[0]), int(depths[0].split()[2])
    assert 10 < count == total < 2 * result.attrs["solver_taps"]
    assert " decisive taps, the worst at amplitude " in depths[0]
    assert result.attrs["warnings"].splitlines() == told
    # The worst is told: no solution goes deeper than the deepest tap.
    deepest = float(depths[0].partition("the depth of ")[2].split()[0])
    assert deepest >= np.nanmax(result["indentation"].values) * 0.99


@pytest.mark.parametrize("quality", [2.0, 3.0])
def test_a_lever_that_does_not_move_as_a_sine_is_warned_of(quality):
    lever = replace(LIQUID, quality_factor=quality)
    result, told = warned_of(
        lambda: sa.approach_curve(CONTACT, lever, 10e-9, [0.9, 0.7], tolerance=0.1)
    )
    doubts = [text for text in told if "does not move as the sine" in text]
    assert len(doubts) == 1
    assert f"at quality_factor = {quality:g} and 1 times the resonance frequency" in doubts[0]
    assert doubts[0] in result.attrs["warnings"].splitlines()
    # At resonance and without dissipation the second harmonic is √(A0² − A²)/(3Q), over A.
    share = float(doubts[0].partition(" of the amplitude")[0].split()[-1])
    assert share == pytest.approx(np.sqrt(1 / 0.7**2 - 1) / (3 * quality), rel=0.1)


def test_a_map_tells_once_of_levers_that_do_not_move_as_a_sine():
    moduli = np.array([[0.3e9, 0.35e9, 0.4e9]])
    sample = sa.SampleMap(CONTACT, 30e-9, {"sample.E_inf": moduli})
    imaging = sa.AmplitudeModulation(LIQUID, 10e-9, 0.8)
    result, told = warned_of(lambda: sa.scan(sample, imaging, tolerance=0.1))
    (doubt,) = [text for text in told if "does not move as the sine" in text]
    assert doubt.startswith("3 of 3 different pixels, the worst at pixel (0, ")
    assert doubt in result.attrs["warnings"].splitlines()


@pytest.mark.parametrize("workers", [1, 2])
def test_a_force_volume_warns_once_of_each_kind(workers):
    size = (2, 3)
    moduli = np.linspace(0.3e9, 0.6e9, 6).reshape(size)
    sample = sa.SampleMap(CONTACT, (20e-9, 30e-9), {"sample.E_inf": moduli})
    imaging = sa.ForceVolume(sa.Triangle(4e-9, -0.5e-9, 1e-3))
    result, told = warned_of(
        lambda: sa.scan(sample, imaging, solver=Doubting(), tolerance=0.1, workers=workers)
    )
    assert len(told) == 2
    assert told[0].startswith("6 of 6 different pixels, the worst at pixel (0, 0): the depth of ")
    assert result.attrs["warnings"].splitlines() == told


def test_a_motion_beyond_the_window_is_recorded_too():
    sample = sa.PowerLaw(E1=1e6, exponent=0.2, window=(1e-6, 1e-5), poisson=0.49)
    contact = replace(CONTACT, sample=sample)
    result, told = warned_of(
        lambda: sa.force_distance(contact, sa.Triangle(4e-9, 2e-9, 1e-5), tolerance=0.1)
    )
    # It also ends in contact.
    assert sum("enlarge the window" in text for text in told) == 1
    assert result.attrs["warnings"].splitlines() == told


def test_kinds_are_told_apart_by_their_words():
    found = [
        ("a", sa.AccuracyWarning("no steady cycle after 3: off by 0.1", 0.1)),
        ("b", sa.AccuracyWarning("no steady cycle after 40: off by 7", 7.0)),
        ("b", sa.AccuracyWarning("no steady cycle after 41: off by 2", 2.0)),
        ("c", sa.AccuracyWarning("the domain of 5 nm is small")),
    ]
    assert find_kind(found[0][1]) == find_kind(found[1][1]) != find_kind(found[3][1])
    assert [str(each) for each in gather(found, 9, "runs", str.upper)] == [
        "2 of 9 runs, the worst at B: no steady cycle after 40: off by 7",
        "1 of 9 runs, at C: the domain of 5 nm is small",
    ]
    assert keep_worst(each for _, each in found) == [found[1][1], found[3][1]]
