"""Atomic force microscopy on soft, adhesive, viscoelastic surfaces from first principles."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from softafm import bodies, indentation, modes, samples, solvers
from softafm.contact import Contact
from softafm.draw.animation import animate
from softafm.draw.contact import plot_contact
from softafm.draw.law import plot_surface
from softafm.draw.sample import plot_rheology
from softafm.draw.storyboard import plot_profiles
from softafm.draw.tip import plot_tip
from softafm.errors import AccuracyWarning, DivergedError, DoubtfulValueWarning
from softafm.files.measured import read_trajectory
from softafm.instrument.cantilever import Cantilever, Eigenmode
from softafm.instrument.drive import Drive
from softafm.instrument.motions import Sine, Trajectory, Triangle
from softafm.modes.approach import approach_curve
from softafm.modes.force_distance import force_distance
from softafm.modes.peak_force import peak_force_tapping
from softafm.modes.spectroscopy import force_spectroscopy
from softafm.modes.tapping import tapping_cycle
from softafm.modes.transient import tapping_transient
from softafm.results.datasets import export, load, save
from softafm.rheology import (
    Elastic,
    FractionalStandardLinearSolid,
    GeneralizedKelvinVoigt,
    GeneralizedMaxwell,
    KelvinVoigt,
    Maxwell,
    PowerLaw,
    StandardLinearSolid,
    read_dma,
)
from softafm.surfaces import (
    DLVO,
    DMT,
    CustomSurface,
    Dugdale,
    Exponential,
    LennardJones,
    Morse,
    Repulsion,
    SumOfLaws,
    SurfaceLaw,
    Tabulated,
    VanDerWaals,
    VanDerWaalsAttraction,
    read_law,
)
from softafm.tips import (
    Cone,
    CustomTip,
    FlatPunch,
    Hyperboloid,
    MeasuredTip,
    Paraboloid,
    PowerLawTip,
    Sphere,
    Tip,
    read_tip_profile,
)
from softafm.version import __version__ as __version__

if TYPE_CHECKING:
    from softafm.draw.maps import plot_map
    from softafm.draw.results import plot
    from softafm.experiment.config import load_experiment
    from softafm.experiment.regime import regime
    from softafm.experiment.run import run
    from softafm.maps.gwyddion import export_gwyddion
    from softafm.maps.imaging import AmplitudeModulation, ForceVolume
    from softafm.maps.map_file import load_map
    from softafm.maps.sample_map import SampleMap
    from softafm.maps.scan import scan
    from softafm.sweeps.designs import Between
    from softafm.sweeps.sweep import load_sweep, sweep

__all__ = [
    "DLVO",
    "DMT",
    "AccuracyWarning",
    "AmplitudeModulation",
    "Between",
    "Cantilever",
    "Cone",
    "Contact",
    "CustomSurface",
    "CustomTip",
    "DivergedError",
    "DoubtfulValueWarning",
    "Drive",
    "Dugdale",
    "Eigenmode",
    "Elastic",
    "Exponential",
    "FlatPunch",
    "ForceVolume",
    "FractionalStandardLinearSolid",
    "GeneralizedKelvinVoigt",
    "GeneralizedMaxwell",
    "Hyperboloid",
    "KelvinVoigt",
    "LennardJones",
    "Maxwell",
    "MeasuredTip",
    "Morse",
    "Paraboloid",
    "PowerLaw",
    "PowerLawTip",
    "Repulsion",
    "SampleMap",
    "Sine",
    "Sphere",
    "StandardLinearSolid",
    "SumOfLaws",
    "SurfaceLaw",
    "Tabulated",
    "Tip",
    "Trajectory",
    "Triangle",
    "VanDerWaals",
    "VanDerWaalsAttraction",
    "animate",
    "approach_curve",
    "bodies",
    "export",
    "export_gwyddion",
    "force_distance",
    "force_spectroscopy",
    "indentation",
    "load",
    "load_experiment",
    "load_map",
    "load_sweep",
    "modes",
    "peak_force_tapping",
    "plot",
    "plot_contact",
    "plot_map",
    "plot_profiles",
    "plot_rheology",
    "plot_surface",
    "plot_tip",
    "read_dma",
    "read_law",
    "read_tip_profile",
    "read_trajectory",
    "regime",
    "run",
    "samples",
    "save",
    "scan",
    "solvers",
    "sweep",
    "tapping_cycle",
    "tapping_transient",
]

_LATER = {
    "AmplitudeModulation": "maps.imaging",
    "Between": "sweeps.designs",
    "ForceVolume": "maps.imaging",
    "SampleMap": "maps.sample_map",
    "export_gwyddion": "maps.gwyddion",
    "load_experiment": "experiment.config",
    "load_map": "maps.map_file",
    "load_sweep": "sweeps.sweep",
    "plot": "draw.results",
    "plot_map": "draw.maps",
    "regime": "experiment.regime",
    "run": "experiment.run",
    "scan": "maps.scan",
    "sweep": "sweeps.sweep",
}
"""Names and their modules, imported when first asked for."""


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module 'softafm' has no attribute '{name}'")
    return getattr(import_module(f"softafm.{_LATER[name]}"), name)
