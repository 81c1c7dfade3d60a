"""Linear viscoelastic samples, each stated by its creep compliance.

Every solid is written as a generalised Kelvin-Voigt chain,
1/E(t) = 1/E0 + Σ J_m (1 − exp(−t/τ_m)) + φ t, in uniaxial compliance (Rajabifar et al. 2021,
equation 4). What the contact problem needs of it is for the body under the tip to say.
"""

from softafm.rheology.compliance import CreepCompliance
from softafm.rheology.dma import measure_misfit
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
    "CreepCompliance",
    "Elastic",
    "FractionalStandardLinearSolid",
    "GeneralizedKelvinVoigt",
    "GeneralizedMaxwell",
    "KelvinVoigt",
    "Maxwell",
    "PowerLaw",
    "Solid",
    "StandardLinearSolid",
    "chain_to_prony",
    "measure_misfit",
    "prony_to_chain",
    "read_dma",
]
