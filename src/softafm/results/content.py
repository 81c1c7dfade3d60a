"""What results hold: every variable with its unit, and which of them those of each mode have."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from softafm.units.quantities import is_coherent

if TYPE_CHECKING:
    from xarray import Variable

VARIABLES = {
    "time": ("s", "time"),
    "r": ("m", "radial coordinate"),
    "tip_height": ("m", "tip height above the undeformed surface"),
    "base_height": ("m", "height of the base: that of the tip on an unbent lever"),
    "deflection": ("m", "deflection of the lever, positive away from the sample"),
    "force": ("N", "force on the tip, positive = repulsive"),
    "contact_radius": ("m", "radius of the largest tension"),
    "axis_deformation": ("m", "surface displacement under the apex, positive towards the tip"),
    "viscous_power": ("W", "power dissipated in the sample"),
    "deformation": ("m", "surface displacement, positive towards the tip"),
    "gap": ("m", "gap between tip and deformed surface"),
    "pressure": ("Pa", "pressure on the surface, positive = repulsive"),
    "force_max": ("N", "largest force"),
    "force_min": ("N", "smallest force"),
    "force_mean": ("N", "mean force of a cycle"),
    "force_min_approach": ("N", "smallest force before the lowest height"),
    "loop_energy": ("J", "energy dissipated in the motion, -∮F dh0 or -∮F dZ"),
    "viscous_loss": ("J", "energy dissipated in the sample"),
    "branch": ("1", "branch of solutions"),
    "amplitude_ratio": ("1", "amplitude over free amplitude"),
    "sweep_height": ("m", "mean height of the tip in a sweep"),
    "mean_height": ("m", "mean height of the tip"),
    "amplitude": ("m", "amplitude of the tip"),
    "phase": ("degree", "lag of the deflection behind the drive"),
    "virial": ("J", "virial, mean of F·(h0 - mean height) over a cycle"),
    "dissipation": ("J", "energy dissipated in a cycle, -∮F dh0"),
    "eigenmode": ("1", "number of the eigenmode"),
    "harmonic": ("1", "number of the harmonic"),
    "harmonic_amplitude": ("m", "amplitude of the deflection at a harmonic of the drive"),
    "cycle_end": ("s", "time at the end of each cycle"),
    "drive_work": ("J", "work of drive and base on lever and tip in a cycle"),
    "damping": ("J", "energy dissipated by the lever itself in a cycle"),
    "jump_loss": ("J", "energy released by elastic jumps in a cycle"),
    "apparent_force": ("N", "apparent force, from the deflection"),
    "mean_deflection": ("m", "mean deflection of the lever in a cycle"),
    "cycles_run": ("1", "cycles that were run"),
    "cycle_virial": ("J", "virial of each cycle"),
    "cycle_dissipation": ("J", "energy dissipated in each cycle"),
    "contact_time": ("s", "time in contact in a cycle"),
    "indentation": ("m", "largest depth of the surface under the apex"),
    "jump_time": ("s", "time of elastic jumps"),
    "jump_energy": ("J", "energy released by elastic jumps"),
    "x": ("m", "position along a line of a map"),
    "y": ("m", "position down the lines of a map"),
    "topography": ("m", "height at which the lever is left, that of the sample included"),
    "sample_height": ("m", "height of the surface"),
    "lowest_height": ("m", "lowest height of the tip, or of the base of its lever"),
    "material": ("1", "number of the material"),
}
"""Unit and long name of every variable of a result, by name; a mode declares what is its own."""
_BUILT_IN = frozenset(VARIABLES)
_UNITS = frozenset(unit for unit, _ in VARIABLES.values())

DIRECTIONS = {"approach": "falls", "retract": "rises"}
"""Directions of a sweep of the height, and what it does then."""
FORMAT = "softafm result 1"
"""What the attribute ``format`` of every result says."""
LARGEST = 2_000_000_000
"""Size that a result may have in memory to be read, bytes, unless more is allowed."""
BRANCHES = ("attractive", "unstable", "repulsive")
"""The values of ``branch`` in an approach curve."""

TAPPED = (
    "virial", "dissipation", "force_mean", "force_max", "force_min", "contact_time", "indentation",
)  # fmt: skip
"""Observables of a tap."""
RAMPED = ("force_max", "force_min", "force_min_approach", "loop_energy", "viscous_loss")
"""Observables of a force curve."""
_CURVES = ("tip_height", "force", "contact_radius", "axis_deformation", "viscous_power")
HISTORY: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(_CURVES, ("time",)),
    "jump_time": ("jump",),
    "jump_energy": ("jump",),
}
"""Dimensions of what is kept of a contact that is carried through a motion."""
PROFILES: dict[str, tuple[str, ...]] = dict.fromkeys(
    ("deformation", "gap", "pressure"), ("time", "r")
)
"""Dimensions of the shapes of the surface; a result holds all of them or none."""
UNNUMBERED = ("jump", "cycle")
"""Dimensions without a coordinate."""
RISING = ("time", "r", "x", "y")
"""Coordinates whose values rise from each to the next."""
SAMPLES = {
    "time": (2, 10**9),
    "r": (2, 20_000),
    "x": (1, 100_000),
    "y": (1, 100_000),
    "amplitude_ratio": (1, 100_000),
    "sweep_height": (0, 10_000),
}
"""How many values a coordinate has, at least and at most; movies and arrows are made of them."""
REGULARISED = ("regularised_range", "given_tabor", "given_range", "edge_slowed")
"""Attributes, all numbers, of a result whose law had its range enlarged."""


Labelled = tuple[str | tuple[str, ...], Any]
"""Dimensions and values of a variable."""


@dataclass(frozen=True)
class Observable:
    """A variable that a mode adds to results: SI unit, what it is in words, and its dimensions."""

    units: str
    long_name: str
    dims: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.units not in _UNITS and not is_coherent(self.units):
            raise ValueError(
                f"units = {self.units!r}: must be an SI unit without prefix, such as 'm', 'N/m' or "
                "'1', as results are in SI"
            )
        if not isinstance(self.long_name, str) or not self.long_name.strip():
            raise ValueError(f"long_name = {self.long_name!r}: must say in words what it is")
        if not isinstance(self.dims, tuple) or not all(isinstance(d, str) for d in self.dims):
            raise ValueError(f"dims = {self.dims!r}: must be a tuple of names, such as ('time',)")


@dataclass(frozen=True)
class Needed:
    """What the result of a mode holds, for figures, tables and exports to be made of it.

    Parameters
    ----------
    variables
        Dimensions of each; every dimension but ``UNNUMBERED`` has a coordinate of its name, too.
    described
        What the attribute ``experiment`` describes besides tip, sample and surface.
    numbers
        Attributes that are numbers.
    inputs
        Keys of ``motion`` in the attribute ``experiment`` that are numbers above zero, with units.
    gaps
        Whether values may be NaN, where there is no solution.
    """

    variables: Mapping[str, tuple[str, ...]]
    described: str = "motion"
    numbers: tuple[str, ...] = ()
    inputs: Mapping[str, str] = field(default_factory=dict)
    gaps: bool = False


MAPS: dict[str, Needed] = {
    "amplitude-modulation": Needed(
        dict.fromkeys(
            ("topography", "sample_height", "mean_height", "phase", "branch", *TAPPED), ("y", "x")
        ),
        described="imaging",
        numbers=("different_pixels",),
        gaps=True,
    ),
    "force-volume": Needed(
        dict.fromkeys(
            ("topography", "sample_height", "lowest_height", "indentation", *RAMPED), ("y", "x")
        ),
        described="imaging",
        numbers=("different_pixels",),
        gaps=True,
    ),
}
"""By kind of imaging."""
NEEDED: dict[str, Needed] = {**MAPS}
"""By kind of imaging, and by mode once it is declared."""


def observables(*names: str, over: tuple[str, ...] = ()) -> dict[str, Observable]:
    """Return observables that bear names known in results, over some dimensions."""
    return {name: Observable(*_meaning(name), over) for name in names}


def declare(mode: str, needed: Needed, observed: Mapping[str, Observable]) -> None:
    """Make known what the results of a mode hold, and what its observables mean.

    Raises
    ------
    ValueError
        If the name of an observable means something else in results.
    """
    others = {name for known, each in NEEDED.items() if known != mode for name in each.variables}
    own = VARIABLES.keys() - _BUILT_IN - others
    new = [name for name in observed if name in own or find_unit(name) is None]
    for name, each in observed.items():
        if name in new or (each.units, each.long_name) == _meaning(name):
            continue
        over = f", over={each.dims}" if each.dims else ""
        raise ValueError(
            f"observable '{name}' of mode '{mode}': this name means {_meaning(name)[1]}, in "
            f"{find_unit(name)}, in all results; take observables('{name}'{over}), which means "
            "just that, or another name"
        )
    VARIABLES.update({name: (observed[name].units, observed[name].long_name) for name in new})
    NEEDED[mode] = needed


def make_variable(name: str, dims: str | tuple[str, ...], values: Any) -> "Variable":
    """Return values under a known name, with its unit and long name as attributes.

    A name may be prefixed by ``approach_`` or ``retract_``.
    """
    from xarray import Variable

    units, long_name = _meaning(name)
    array = np.asarray(values)
    array = array if array.dtype.kind == "U" else array.astype(float)
    # On its usual path xarray imports dask to see whether this is one of its arrays.
    return Variable(dims, array, {"units": units, "long_name": long_name}, fastpath=True)


def find_unit(name: str) -> str | None:
    """Return the unit of a variable; None if no mode returns one of this name."""
    if name in VARIABLES:
        return VARIABLES[name][0]
    direction, _, rest = name.partition("_")
    return _describe_recorded(name)[0] if direction in DIRECTIONS and rest in VARIABLES else None


def _meaning(name: str) -> tuple[str, str]:
    return VARIABLES[name] if name in VARIABLES else _describe_recorded(name)


def _describe_recorded(name: str) -> tuple[str, str]:
    """Return unit and long name of what is recorded in a sweep of the height."""
    direction, _, rest = name.partition("_")
    units, long_name = VARIABLES[rest]
    return units, f"{long_name}, while the height {DIRECTIONS[direction]}"
