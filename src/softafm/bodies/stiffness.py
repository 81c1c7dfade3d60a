"""Stiffness of a body on a unit mesh: the inverse of its influence matrix, for frames as needed.

On a half-space one matrix serves contacts of all radii. On any other body they are tabulated at
frames in geometric steps, between which each entry is a polynomial in the logarithm of the frame:
through six points a step of 1.1 leaves errors of 1e-6.
"""

from dataclasses import dataclass, field
from functools import lru_cache
from math import floor, isinf, log
from typing import Any

import numpy as np

from softafm.bodies.body import Body
from softafm.bodies.mesh import UnitMesh
from softafm.errors import DivergedError

STEP = log(1.1)
"""ln of the ratio of two frames that follow each other."""
POINTS = 6
"""Of the polynomial in ln a."""


@dataclass(frozen=True)
class _Operator:
    """A body on a mesh; what ``key`` does not hold makes no difference."""

    key: tuple[Any, ...]
    body: Body = field(compare=False)
    mesh: UnitMesh = field(compare=False)


class Stiffness:
    """The stiffness matrices of a body on a unit mesh, found when first asked for.

    In a frame of radius a, u = −c K p becomes S·u = −(c a) masses·p.

    Attributes
    ----------
    uniform
        S if it is the same in all frames, shape (n, n); else None.
    first
        Index of the first tabulated frame, which is ``body.length``·1.1^index.
    entries
        S in the frames tabulated so far, shape (k, n, n), one after the other; k = 0 if uniform.
    """

    def __init__(self, body: Body, mesh: UnitMesh):
        key = (body.key, mesh.edge_spacing, mesh.growth, mesh.nodes.size)
        self._operator = _Operator(key, body, mesh)
        n = mesh.nodes.size
        self.uniform = _matrix(self._operator, 0) if isinf(body.length) else None
        self.first, self.entries = 0, np.empty((0, n, n))

    def reach(self, frame: float) -> None:
        """Tabulate what the stiffness in a frame of radius ``frame``, m, is interpolated from.

        Raises
        ------
        DivergedError
            If the mesh cannot resolve the body in that frame.
        """
        if self.uniform is not None:
            return
        # One more at either end, so that round-off of a logarithm makes no difference.
        first = floor(log(frame / self._operator.body.length) / STEP) - POINTS // 2
        last = first + POINTS + 2
        if len(self.entries):
            first = min(first, self.first)
            last = max(last, self.first + len(self.entries))
        if last - first > len(self.entries):
            self.first = first
            self.entries = np.stack([_matrix(self._operator, i) for i in range(first, last)])


@lru_cache(maxsize=256)
def _matrix(operator: _Operator, index: int) -> np.ndarray:
    body, mesh = operator.body, operator.mesh
    frame = 1.0 if isinf(body.length) else body.length * np.exp(STEP * index)
    return _inverse(body.influence(mesh, frame), body, frame)


def _inverse(matrix: np.ndarray, body: Any, frame: float) -> np.ndarray:
    """Inverse of a symmetric positive definite matrix, which is overwritten.

    By the solvers' own factorisation: the bits of LAPACK's depend on the number of threads.
    """
    from softafm.compiled.dense import factorise, solve_factorised

    if not factorise(matrix, len(matrix)):
        raise DivergedError(
            f"the mesh cannot resolve the body '{body.kind}' in contacts of about {frame:.3g} m: "
            f"it is good for {body.widest:.3g} m; indent less, or take a sharper tip"
        )
    inverse = np.eye(len(matrix))
    for row in inverse:
        solve_factorised(matrix, row, len(matrix))
    inverse = (inverse + inverse.T) / 2
    inverse.setflags(write=False)
    return inverse
