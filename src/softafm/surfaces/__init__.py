"""Laws of the pressure between two surfaces against the gap that separates them."""

from softafm.surfaces.attraction import VanDerWaalsAttraction
from softafm.surfaces.custom import CustomSurface
from softafm.surfaces.dlvo import DLVO
from softafm.surfaces.dmt import DMT
from softafm.surfaces.dugdale import Dugdale
from softafm.surfaces.exponential import Exponential
from softafm.surfaces.law import SumOfLaws, SurfaceLaw
from softafm.surfaces.lennard_jones import LennardJones
from softafm.surfaces.morse import Morse
from softafm.surfaces.reading import read_law
from softafm.surfaces.repulsion import Repulsion
from softafm.surfaces.tabulated import Tabulated
from softafm.surfaces.van_der_waals import VanDerWaals

__all__ = [
    "DLVO",
    "DMT",
    "CustomSurface",
    "Dugdale",
    "Exponential",
    "LennardJones",
    "Morse",
    "Repulsion",
    "SumOfLaws",
    "SurfaceLaw",
    "Tabulated",
    "VanDerWaals",
    "VanDerWaalsAttraction",
    "read_law",
]
