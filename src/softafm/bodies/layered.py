"""Bodies of layers, stated by one function of the wavenumber."""

from abc import ABC, abstractmethod
from collections.abc import Hashable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from softafm.bodies import hankel
from softafm.bodies.half_space import HalfSpace
from softafm.bodies.mesh import UnitMesh


@dataclass(frozen=True)
class Layered(HalfSpace, ABC):
    """A half-space of the ``sample`` at the surface, but for what other materials below change.

    A class of such bodies is a frozen dataclass that states ``kind``, ``length`` and ``factor``,
    and checks its own fields. All layers relax alike, as the sample does: moduli keep their ratio.
    """

    @property
    @abstractmethod
    def length(self) -> float:
        """Thickness of the layers, m, or the length over which the modulus changes with depth."""

    @abstractmethod
    def factor(self, wavenumber: np.ndarray) -> np.ndarray:
        """S(κ·length), the displacement by a pressure of wavenumber κ over that of a half-space.

        ``wavenumber`` holds κ·length, above 0. S is positive, and 1 to six digits from 20 on.
        """

    @property
    def key(self) -> Hashable:
        """What ``factor`` depends on: the body itself, unless a class knows better."""
        return self

    @property
    def widest(self) -> float:
        """One length: the meshes do not know it, and nodes far from the edge would miss it."""
        return self.length

    def influence(self, mesh: UnitMesh, frame: float) -> np.ndarray:
        """Return the matrix of a half-space and what the layers add."""
        ratio = self.length / frame
        added = hankel.excess(mesh.nodes, lambda k: self.factor(k * ratio), hankel.HIGHEST / ratio)
        return super().influence(mesh, frame) + added

    def depth(
        self, tip: Any, radius: np.ndarray, modulus: float, work_of_adhesion: float
    ) -> np.ndarray:
        """Depth of a tip in contacts of some radii (m), m, shape (n,); see ``bodies.hankel``.

        Contacts wider than 4 lengths count with the weights of one as wide as that.
        """
        known = _estimates(self)
        weights = known.at(radius / self.length, known.weights)
        inner = super().depth(tip, (radius[:, None] * hankel.POINTS).ravel(), modulus, 0.0)
        rest = 1 - weights.sum(axis=1)
        depth = super().depth(tip, radius, modulus, 0.0)
        depth -= np.sum(weights * inner.reshape(weights.shape), axis=1)
        if work_of_adhesion > 0:
            depth -= np.sqrt(2 * np.pi * work_of_adhesion / modulus * radius)
        return depth / rest

    def hardening(self, radius: float) -> float:
        """Stiffness under a flat punch of this radius, m, over that on a half-space."""
        known = _estimates(self)
        return 1 + float(known.at(np.array([radius / self.length]), known.hardening)[0, 0])


@lru_cache(maxsize=64)
def _estimates(body: Layered) -> hankel.Estimates:
    return hankel.estimates(body.factor)
