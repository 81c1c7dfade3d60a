"""Electrostatic double layers with van der Waals attraction: DLVO."""

from dataclasses import dataclass
from math import sqrt, tanh
from typing import ClassVar

from softafm.checks.validate import check_between, check_positive
from softafm.compiled.formulas import Term
from softafm.surfaces.law import SurfaceLaw
from softafm.surfaces.lennard_jones import _lennard_jones
from softafm.surfaces.limits import check_length
from softafm.surfaces.repulsion import exponential

_CHARGE, _BOLTZMANN, _AVOGADRO = 1.602176634e-19, 1.380649e-23, 6.02214076e23
_VACUUM = 8.8541878128e-12
"""Elementary charge (C), k (J/K), 1/mol: exact; vacuum permittivity (F/m): CODATA 2018."""


@dataclass(frozen=True)
class DLVO(SurfaceLaw):
    """Lennard-Jones law and the double layers of two charged surfaces in a 1:1 electrolyte.

    p(h) = H/(6πh³)·((z0/h)⁶ − 1) + 64·n·kT·γ1γ2·exp(−h/λ), γ = tanh(eψ/4kT), in which λ is the
    Debye length and n = εkT/(2e²λ²) the number density of the salt. Double layers overlap weakly:
    that holds at gaps from about λ on. Where barriers make two wells, the deeper tension counts as
    the contact.

    Parameters
    ----------
    hamaker
        Hamaker constant H, J, in the liquid.
    z0
        Equilibrium gap without charges, m.
    surface_potential
        Potential ψ of the sample, V, and of the tip unless ``tip_potential`` is given; ±1 at most.
    debye_length
        Debye length λ, m.
    temperature
        Temperature T, K, 200 to 1000.
    permittivity
        Relative permittivity of the liquid, 1 to 1000; 78.4 of water.
    tip_potential
        Potential of the tip, V; of the other sign it makes the double layers attract.

    Raises
    ------
    ValueError
        If a value is out of range.

    References
    ----------
    J. N. Israelachvili, Intermolecular and Surface Forces, 3rd ed., Academic Press 2011, ch. 14;
    J. Gregory, *J. Colloid Interface Sci.* 51, 44 (1975), for unequal potentials.
    """

    kind: ClassVar[str] = "dlvo"
    hamaker: float
    z0: float
    surface_potential: float
    debye_length: float
    temperature: float = 298.15
    permittivity: float = 78.4
    tip_potential: float | None = None

    def __post_init__(self) -> None:
        psi = check_between("surface_potential", self.surface_potential, "V", -1, 1)
        object.__setattr__(self, "hamaker", check_positive("hamaker", self.hamaker, "J"))
        object.__setattr__(self, "z0", check_length("z0", self.z0))
        object.__setattr__(self, "surface_potential", psi)
        object.__setattr__(self, "debye_length", check_length("debye_length", self.debye_length))
        object.__setattr__(self, "temperature", _check_temperature(self.temperature))
        object.__setattr__(self, "permittivity", _check_permittivity(self.permittivity))
        if self.tip_potential is not None:
            other = check_between("tip_potential", self.tip_potential, "V", -1, 1)
            object.__setattr__(self, "tip_potential", other)

    @classmethod
    def from_concentration(
        cls,
        hamaker: float,
        z0: float,
        surface_potential: float,
        concentration: float,
        temperature: float = 298.15,
        permittivity: float = 78.4,
        tip_potential: float | None = None,
    ) -> "DLVO":
        """Build the law from the concentration of the salt.

        Parameters
        ----------
        concentration
            Concentration of the 1:1 salt, mol/L, 1e-7 (pure water) to 10.
        """
        n = 1e3 * _AVOGADRO * check_between("concentration", concentration, "mol/L", 1e-7, 10)
        epsilon = _VACUUM * _check_permittivity(permittivity)
        squared = epsilon * _BOLTZMANN * _check_temperature(temperature) / (2 * n * _CHARGE**2)
        return cls(
            hamaker, z0, surface_potential, sqrt(squared), temperature, permittivity, tip_potential
        )

    @property
    def double_layer_pressure(self) -> float:
        """64·n·kT·γ1γ2, the pressure of the double layers continued to zero gap, Pa."""
        thermal = _BOLTZMANN * self.temperature / _CHARGE
        tip = self.surface_potential if self.tip_potential is None else self.tip_potential
        gammas = tanh(self.surface_potential / (4 * thermal)) * tanh(tip / (4 * thermal))
        return 32 * _VACUUM * self.permittivity * (thermal / self.debye_length) ** 2 * gammas

    @property
    def terms(self) -> tuple[Term, Term]:
        """The Lennard-Jones law and the double layers."""
        layers = (self.double_layer_pressure, 0.0, self.debye_length)
        return (Term(_lennard_jones, (self.hamaker, self.z0)), Term(exponential, layers))


def _check_temperature(value: float) -> float:
    return check_between("temperature", value, "K", 200, 1000)


def _check_permittivity(value: float) -> float:
    return check_between("permittivity", value, "", 1, 1000)
