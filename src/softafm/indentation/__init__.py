"""Known answers for a rigid tip on a half-space: to plot beside a result, and to test with.

All of them hold for any tip of revolution unless they name its radius. The contact has no friction
and small slopes, as in the solvers: the half-space deforms as under pressures on a flat surface.
Depths are counted from where undeformed surfaces would touch. The surfaces of a simulation rest at
the ``equilibrium_gap`` of their law, so that its tip is higher by about so much.

| answer | sample | surface forces |
|---|---|---|
| Hertz, Sneddon: ``force``, ``depth``, ``load``, ``contact_radius`` | elastic | none |
| Derjaguin, Muller and Toporov: ``dmt_force`` | elastic, stiff | long-ranged |
| Johnson, Kendall and Roberts: ``jkr``, ``jkr_parting`` | elastic, soft | short-ranged |
| Maugis-Dugdale: ``maugis``, ``maugis_parting`` | elastic | a constant tension up to a range |
| Lee and Radok: ``lee_radok`` | viscoelastic, while the contact grows | none |
| Ting: ``ting`` | viscoelastic, pressed in and withdrawn | none |

The last four return a ``Curve``, which ``softafm.plot`` takes as ``reference``.
"""

from softafm.indentation.adhesive import (
    dmt_force,
    dmt_pull_off,
    jkr,
    jkr_depth,
    jkr_load,
    jkr_parting,
    jkr_pull_off,
)
from softafm.indentation.at_depth import contact_radius, force
from softafm.indentation.cohesive_zone import maugis, maugis_parting
from softafm.indentation.curve import Curve, Parting
from softafm.indentation.elastic import depth, hertz_force, load
from softafm.indentation.viscoelastic import lee_radok, ting

__all__ = [
    "Curve",
    "Parting",
    "contact_radius",
    "depth",
    "dmt_force",
    "dmt_pull_off",
    "force",
    "hertz_force",
    "jkr",
    "jkr_depth",
    "jkr_load",
    "jkr_parting",
    "jkr_pull_off",
    "lee_radok",
    "load",
    "maugis",
    "maugis_parting",
    "ting",
]
