"""Van der Waals attraction alone, to be added to a repulsion."""

from dataclasses import dataclass
from math import pi
from typing import ClassVar

import numpy as np

from softafm.checks.validate import check_positive
from softafm.compiled.formulas import Term
from softafm.surfaces.law import SurfaceLaw
from softafm.surfaces.limits import check_length


@dataclass(frozen=True)
class VanDerWaalsAttraction(SurfaceLaw):
    """Van der Waals attraction p(h) = −H/(6πh³), a part of a sum: it needs a repulsion beside it.

    Inside the cutoff, where it would diverge, it goes on as its own osculating parabola, at
    negative gaps too: any repulsion that rises faster holds the surfaces apart.

    Parameters
    ----------
    hamaker
        Hamaker constant H, J.
    cutoff
        Gap below which the law no longer holds, m; about 0.165 nm for many solids.

    Raises
    ------
    ValueError
        If a value is out of range.

    References
    ----------
    J. N. Israelachvili, Intermolecular and Surface Forces, 3rd ed., Academic Press 2011, ch. 13.
    """

    kind: ClassVar[str] = "van-der-waals-attraction"
    overlaps: ClassVar[bool] = True
    hamaker: float
    cutoff: float = 0.165e-9

    def __post_init__(self) -> None:
        object.__setattr__(self, "hamaker", check_positive("hamaker", self.hamaker, "J"))
        object.__setattr__(self, "cutoff", check_length("cutoff", self.cutoff))

    @property
    def terms(self) -> tuple[Term]:
        """p(h) = −H/(6πh³), and within the cutoff c, y = 1 − h/c, −H/(6πc³)·(1 + 3y + 6y²)."""
        return (Term(attraction, (self.hamaker, self.cutoff)),)


def attraction(h: np.ndarray, H: float, cutoff: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Evaluate −H/(6πh³), within ``cutoff`` its osculating parabola, slope and potential."""
    scale = H / (6 * pi * cutoff * cutoff * cutoff)
    ratio = h / cutoff
    far = 1 / np.maximum(ratio, 1.0)
    y = 1 - np.minimum(ratio, 1.0)
    square = far * far
    p = -scale * (square * far + y * (3 + 6 * y))
    slope = scale / cutoff * (3 * square * square + 12 * y)
    return p, slope, -scale * cutoff * (0.5 * square + y * (1 + y * (1.5 + 2 * y)))
