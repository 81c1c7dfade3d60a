"""Results of every mode for tests of files, computed in well under a second."""

import warnings
from functools import cache

import numpy as np

import softafm as sa

CONTACT = sa.Contact(
    tip=sa.Paraboloid(10e-9),
    sample=sa.StandardLinearSolid(2e9, 0.5e9, 1e-7, 0.49),
    surface=sa.LennardJones(1e-19, 0.3e-9),
)
LEVER = sa.Cantilever(28.1, quality_factor=430, frequency=278e3)
RAMP = sa.Triangle(4e-9, -0.5e-9, 1e-3)


@cache
def results():
    """Return a result of every mode by name, some with shapes, a check or a longer range."""
    sample_map = sa.SampleMap(
        CONTACT, (4e-9, 2e-9), {"sample.E_inf": np.array([[0.5e9, 1e9], [1e9, 0.5e9]])}
    )
    loose = {"tolerance": 0.1}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sa.AccuracyWarning)
        return {
            "force-distance": sa.force_distance(CONTACT, RAMP, check=True, **loose),
            "with shapes": sa.force_distance(CONTACT, RAMP, profiles=True, **loose),
            "regularised": sa.force_distance(CONTACT, RAMP, regularise=0.3, **loose),
            "force-spectroscopy": sa.force_spectroscopy(CONTACT, LEVER, RAMP, **loose),
            "tapping-cycle": sa.tapping_cycle(CONTACT, 10e-9, 10.5e-9, 278e3, 2, **loose),
            "approach-curve": sa.approach_curve(CONTACT, LEVER, 15e-9, [0.9, 0.5], **loose),
            "amplitude-modulation": sa.scan(
                sample_map, sa.AmplitudeModulation(LEVER, 15e-9, 0.8), **loose
            ),
            "force-volume": sa.scan(sample_map, sa.ForceVolume(RAMP), **loose),
        }


NAMES = (
    "force-distance", "with shapes", "regularised", "force-spectroscopy", "tapping-cycle",
    "approach-curve", "amplitude-modulation", "force-volume",
)  # fmt: skip
