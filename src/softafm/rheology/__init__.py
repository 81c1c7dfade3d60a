"""Linear viscoelastic samples, each stated by its creep compliance.

Every solid is written as a generalised Kelvin-Voigt chain,
1/E(t) = 1/E0 + Σ J_m (1 − exp(−t/τ_m)) + φ t, in uniaxial compliance; the contact problem needs it
times 1 − ν² (Rajabifar et al. 2021, equations 4 and 9).
"""

from softafm.rheology.compliance import ReducedCompliance
from softafm.rheology.dma import dma_misfit
from softafm.rheology.dma_table import read_dma
from softafm.rheology.elastic import Elastic
from softafm.rheology.fractional import FractionalStandardLinearSolid
from softafm.rheology.interconversion import chain_to_prony, prony_to_chain
from softafm.rheology.kelvin_voigt import GeneralizedKelvinVoigt, KelvinVoigt
from softafm.rheology.maxwell import GeneralizedMaxwell, Maxwell
from softafm.rheology.power_law import PowerLaw
from softafm.rheology.solid import Solid
from softafm.rheology.standard_linear_solid import StandardLinearSolid

__all__ = [
    "Elastic",
    "FractionalStandardLinearSolid",
    "GeneralizedKelvinVoigt",
    "GeneralizedMaxwell",
    "KelvinVoigt",
    "Maxwell",
    "PowerLaw",
    "ReducedCompliance",
    "Solid",
    "StandardLinearSolid",
    "chain_to_prony",
    "dma_misfit",
    "prony_to_chain",
    "read_dma",
]
