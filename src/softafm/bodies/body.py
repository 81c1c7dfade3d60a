"""What solvers and estimates ask of the elastic thing under the tip."""

from collections.abc import Hashable
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from softafm.bodies.half_space import HalfSpace
from softafm.checks.kinds import members, refuse_incomplete, refuse_sample

if TYPE_CHECKING:
    from softafm.bodies.mesh import UnitMesh


class Body(Hashable, Protocol):
    """A sample of some geometry, pressed on at its flat surface.

    A pressure p displaces the surface by u = −J K p, with the creep compliance J in time and the
    operator K in space, (K p)(r) = ∫ p(s) k(r, s) s ds. K does not change with time: all parts of
    a body relax alike. Lengths in m.
    """

    @property
    def kind(self) -> str:
        """Its name, in results and refusals."""

    @property
    def sample(self) -> Any:
        """The sample at its surface, which has ``kind``, ``compliance`` and ``poisson``."""

    @property
    def compliance(self) -> Any:
        """(1 − ν²) times the compliance of the sample: a ``softafm.rheology.CreepCompliance``."""

    @property
    def key(self) -> Hashable:
        """What the operator depends on; bodies of one key share their matrices."""

    @property
    def length(self) -> float:
        """The length that the operator knows, such as a thickness; infinite if there is none."""

    @property
    def widest(self) -> float:
        """Radius of the widest contact that the meshes of the solver resolve on this body."""

    @property
    def decay(self) -> float:
        """Rate at which displacements far out fall faster than 1/r, as e^(−decay·r)/r, 1/m."""

    def influence(self, mesh: "UnitMesh", frame: float) -> np.ndarray:
        """Return the symmetric matrix G of K for a contact of radius ``frame``, in units of it.

        (K p)(r_i) = frame·Σ_j G_ij m_j p_j at r = frame·``mesh.nodes``, with ``mesh.masses`` m:
        shape (n, n). If ``length`` is infinite, ``frame`` makes no difference.
        """

    def depth(
        self, tip: Any, radius: np.ndarray, modulus: float, work_of_adhesion: float
    ) -> np.ndarray:
        """Estimate the depth of ``tip`` in elastic contacts of some radii, shape (n,).

        ``modulus`` is the reduced one, Pa; surface forces are short-ranged, of a work of adhesion
        in J/m², which may be 0.
        """

    def hardening(self, radius: float) -> float:
        """Estimate the stiffness under a flat punch, in stiffnesses 2Ea of a half-space."""


def body_of(sample: Any) -> Body:
    """Return ``sample`` if it is a body, else a half-space of it.

    What has an ``influence`` is meant as a body.

    Raises
    ------
    ValueError
        If it is neither, or lacks something that a body or a sample has.
    """
    if hasattr(sample, "influence"):
        refuse_incomplete(
            "sample", sample, members(Body), "a body such as softafm.bodies.HalfSpace"
        )
        refuse_sample("sample.sample", sample.sample)
        return sample
    refuse_sample("sample", sample)
    return HalfSpace(sample)
