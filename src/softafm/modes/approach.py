"""Amplitude modulation: which heights a driven lever can have for its amplitude, and which it takes.

Rajabifar et al. 2021, equations (29) to (32).
"""

import warnings
from typing import TYPE_CHECKING

import numpy as np

from softafm._validate import finite, positive, tolerance_of
from softafm.cantilever import Cantilever
from softafm.contact import Contact
from softafm.errors import AccuracyWarning
from softafm.modes.tap_map import OBSERVABLES, TapMap
from softafm.modes.tapping import tap_observables
from softafm.motions import Sine
from softafm.oscillator import Drive
from softafm.progress import Progress, reporting
from softafm.results import curve_dataset
from softafm.solvers.energy import Energy

if TYPE_CHECKING:
    from xarray import Dataset

BRANCHES = ("attractive", "unstable", "repulsive")
_APPROACHES, _AMPLITUDES, _HEIGHTS = 2000, 500, 241
