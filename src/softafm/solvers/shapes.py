"""Surface shapes that were found on many meshes, brought to common radii."""

from typing import Any, NamedTuple

import numpy as np

from softafm.bodies.mesh import node_index
from softafm.solvers.history import Profiles


class Shape(NamedTuple):
    """Displacement (n,), m, on a unit mesh in a frame of this radius, m."""

    frame: float
    mesh: Any
    deformation: np.ndarray


def interpolate_to_common_radii(shapes: list[Shape]) -> Profiles:
    """Interpolate shapes by quintic splines to 301 radii out to thrice the widest frame.

    Beyond its mesh a surface falls off as 1/r, or as its body says.
    """
    from scipy.interpolate import make_interp_spline

    radius = 3 * max(shape.frame for shape in shapes) * np.linspace(0, 1, 301)
    deformation = np.empty((len(shapes), radius.size))
    for row, (frame, mesh, values) in zip(deformation, shapes, strict=True):
        last = values.size - 1
        mirrored = np.concatenate([values[:0:-1], values])
        spline = make_interp_spline(np.arange(-last, last + 1), mirrored, k=5)
        index = node_index(radius / frame, mesh.edge_spacing, mesh.growth)
        end = frame * mesh.nodes[-1]
        outside = np.fmax(radius, end)
        beyond = values[-1] * end / outside * np.exp(-mesh.decay * (outside - end))
        row[:] = np.where(index <= last, spline(np.minimum(index, last)), beyond)
    return Profiles(radius, deformation)
