"""Atomic force microscopy on soft, adhesive, viscoelastic surfaces from first principles."""

__version__ = "0.1.0"

from softafm import solvers
from softafm.animation import animate
from softafm.cantilever import Cantilever
from softafm.contact import Contact
from softafm.errors import AccuracyWarning, DivergedError
from softafm.modes.approach import approach_curve
from softafm.modes.force_distance import force_distance
from softafm.modes.spectroscopy import force_spectroscopy
from softafm.modes.tapping import tapping_cycle
from softafm.motions import Sine, Trajectory, Triangle
from softafm.results import export, load, save
from softafm.rheology import Elastic, GeneralizedKelvinVoigt, StandardLinearSolid
from softafm.storyboard import plot_profiles
from softafm.surfaces import LennardJones
from softafm.tips import Paraboloid

__all__ = [
    "AccuracyWarning",
    "Cantilever",
    "Contact",
    "DivergedError",
    "Elastic",
    "GeneralizedKelvinVoigt",
    "LennardJones",
    "Paraboloid",
    "Sine",
    "StandardLinearSolid",
    "Trajectory",
    "Triangle",
    "animate",
    "approach_curve",
    "export",
    "force_distance",
    "force_spectroscopy",
    "load",
    "plot_profiles",
    "save",
    "solvers",
    "tapping_cycle",
]
