"""A force curve for each different contact of a map."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from softafm.checks.gathering import Placed, collect_warnings, keep_worst
from softafm.contact import Contact
from softafm.errors import AccuracyWarning, DivergedError
from softafm.maps.imaging import ForceVolume
from softafm.modes.force_distance import force_distance
from softafm.modes.spectroscopy import force_spectroscopy
from softafm.solvers.solver import Solver

NAMES = (
    "lowest_height", "force_max", "force_min", "force_min_approach", "loop_energy", "viscous_loss",
    "indentation",
)  # fmt: skip
"""``lowest_height`` is that of the tip, or of the base of a lever."""


@dataclass(frozen=True)
class Curves:
    """Computes force curves of contacts as they are."""

    imaging: ForceVolume
    solver: Solver
    tolerance: float

    def __call__(self, contacts: list[Contact]) -> tuple[np.ndarray, dict[int, str], list[Placed]]:
        """Return ``NAMES`` of contacts (contacts, names), why some failed, and their warnings."""
        values, reasons = np.full((len(contacts), len(NAMES)), np.nan), {}
        warned: list[Placed] = []
        for i, contact in enumerate(contacts):
            found: list[AccuracyWarning] = []
            try:
                with collect_warnings(found):
                    values[i] = self._scalars(contact)
            except DivergedError as error:
                reasons[i] = str(error)
            warned += [(i, each) for each in keep_worst(found)]
        return values, reasons, warned

    def _scalars(self, contact: Contact) -> list[float]:
        imaging = self.imaging
        options: dict[str, Any] = {
            "solver": self.solver, "tolerance": self.tolerance, "regularise": None
        }  # fmt: skip
        if imaging.cantilever is None:
            curve, path = force_distance(contact, imaging.motion, **options), "tip_height"
        else:
            curve = force_spectroscopy(contact, imaging.cantilever, imaging.motion, **options)
            path = "base_height"
        indentation = max(0.0, -float(curve["axis_deformation"].min()))
        return [
            float(curve[path].min()), *(float(curve[name]) for name in NAMES[1:-1]), indentation
        ]  # fmt: skip
