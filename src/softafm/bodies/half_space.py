"""The body that all samples are if nothing else is said."""

from collections.abc import Hashable
from dataclasses import dataclass
from functools import cached_property
from math import inf, isinf, pi
from typing import Any, ClassVar

import numpy as np

from softafm.bodies.kernel import influence
from softafm.bodies.mesh import UnitMesh
from softafm.checks.kinds import refuse_sample

_ANGLES, _ANGLE_WEIGHTS = (pi / 4 * x for x in np.polynomial.legendre.leggauss(16))
_SINES = np.sin(_ANGLES + pi / 4)


@dataclass(frozen=True)
class HalfSpace:
    """One sample all the way down: the ``softafm.bodies.Body`` of Hertz, Boussinesq and JKR.

    Parameters
    ----------
    sample
        Rheology, e.g. ``softafm.Elastic``.

    Raises
    ------
    ValueError
        If it is no sample.
    """

    kind: ClassVar[str] = "half-space"
    sample: Any

    def __post_init__(self) -> None:
        refuse_sample("sample", self.sample)

    @cached_property
    def compliance(self) -> Any:
        """(1 − ν²) times the creep compliance of the sample."""
        return self.sample.compliance.scaled(1 - self.sample.poisson**2)

    @property
    def key(self) -> Hashable:
        """The operator is the same for all."""
        return self.kind

    @property
    def length(self) -> float:
        """Infinite: contacts of all radii look alike."""
        return inf

    @property
    def widest(self) -> float:
        """Infinite: the meshes resolve contacts of all radii."""
        return inf

    @property
    def decay(self) -> float:
        """0 1/m: displacements fall as 1/r."""
        return 0.0

    def influence(self, mesh: UnitMesh, frame: float) -> np.ndarray:
        """Return the matrix of ``softafm.bodies.kernel``, the same for all frames."""
        return influence(mesh.nodes, mesh.spacing, mesh.masses)

    def depth(
        self, tip: Any, radius: np.ndarray, modulus: float, work_of_adhesion: float
    ) -> np.ndarray:
        """Depth of a tip in contacts of some radii (m), δ(a) − sqrt(2πaW/E), m, shape (n,).

        δ(a) = a ∫ g'(r)/√(a² − r²) dr, which is a²/R of a paraboloid; JKR for any profile (Maugis
        and Barquins 1983).
        """
        depth = radius * (tip.slope(radius[:, None] * _SINES) @ _ANGLE_WEIGHTS)
        if work_of_adhesion > 0:
            depth -= np.sqrt(2 * pi * work_of_adhesion / modulus * radius)
        return depth

    def hardening(self, radius: float) -> float:
        """1."""
        return 1.0


def refuse_other_bodies(solver: Any, contact: Any) -> None:
    """Raise ValueError if a solver that knows half-spaces only is to deform another body."""
    if not isinf(contact.body.length):
        raise ValueError(
            f"solver '{solver.kind}': knows half-spaces only, not the body '{contact.body.kind}'; "
            "take the solver 'energy'"
        )
