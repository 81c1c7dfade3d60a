"""The magnitudes against which differences of observables are judged."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from xarray import Dataset

    from softafm.modes.parts import Inputs

_FORCE, _ENERGY, _TAP = 0.01, 0.02, 0.02
"""Below which parts of the largest force a force counts as none, and of that times a length an
energy: the reach of the contact, or of taps this part of their amplitude."""


@dataclass(frozen=True)
class Scales:
    """Magnitudes of observables: numbers, or arrays over their dimensions.

    Parameters
    ----------
    least
        By SI unit: a smaller value counts as if it were this large. Units that are not listed
        count by their value, and what has none ("1") is not compared.
    fixed
        By name or SI unit: what takes the place of the value.
    """

    least: Mapping[str, Any]
    fixed: Mapping[str, Any] = field(default_factory=lambda: {"degree": np.degrees(1.0)})

    def of(self, name: str, unit: str, values: np.ndarray) -> Any:
        """Return the scale of an observable with these values."""
        if name in self.fixed or unit in self.fixed:
            return self.fixed.get(name, self.fixed.get(unit))
        return np.maximum(np.abs(values), self.least.get(unit, 0.0))


def force_scales(inputs: "Inputs", result: "Dataset") -> Scales:
    """Return the scales of a force curve: every observable counts by itself.

    At least they are parts of the largest force, and of its work over the reach of the contact.
    """
    force, reach = largest_force(result), inputs.contact.reach
    return Scales({"N": _FORCE * force, "J": _ENERGY * force * reach, "m": reach})


def tap_scales(contact: Any, amplitude: Any, frequency: float, result: "Dataset") -> Scales:
    """Return the scales of taps of an amplitude, m, shape () or (n,), and a frequency, Hz.

    Forces and energies count above parts of the largest force and of that times the amplitude,
    times above that of a contact that is just felt.
    """
    force = largest_force(result)
    grazing = np.sqrt(2 * contact.reach / amplitude) / (np.pi * frequency)
    energy = _ENERGY * force * _TAP * amplitude
    return Scales({"N": _FORCE * force, "J": energy, "s": grazing, "m": contact.reach})


def largest_force(result: "Dataset") -> Any:
    """Return the largest magnitude of the force, N, over the dimensions of ``force_max``.

    It is that of the curve where a result has no ``force_max`` and ``force_min``.
    """
    if {"force_max", "force_min"} <= set(result.data_vars):
        return np.maximum(np.abs(result["force_max"].values), np.abs(result["force_min"].values))
    curve = result["force"].values if "force" in result else np.zeros(0)
    return np.max(np.abs(curve), initial=0.0)
