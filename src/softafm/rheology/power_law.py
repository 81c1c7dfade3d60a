"""Power-law rheology, the springpot: relaxation without a characteristic time."""

from dataclasses import dataclass
from math import gamma
from typing import ClassVar, NamedTuple

import numpy as np

from softafm.checks.validate import check_poisson_ratio, check_positive
from softafm.rheology.lists import check_window
from softafm.rheology.represented import Represented, check_exponent
from softafm.rheology.series import Response, check_error


@dataclass(frozen=True)
class PowerLaw(Represented):
    """Power-law relaxation E(t) = E1 (t/t0)^−a, as of a springpot σ = V d^a ε/dt^a.

    Solvers need a discrete spectrum, so the law is represented by as few Kelvin-Voigt elements as
    keep ``error`` over ``window``; creep, relaxation and moduli are those of this chain, and
    ``represented_error`` says how close it is. The chain is elastic at times shorter than the
    window, and flows at longer ones.

    Parameters
    ----------
    E1
        Young's relaxation modulus at ``reference_time``, Pa.
    exponent
        Exponent a, above 0 and below 1.
    window
        Shortest and longest time of the experiment, s.
    poisson
        Poisson's ratio, in (-1, 0.5].
    reference_time
        Time t0 at which the modulus is E1, s.
    error
        Largest relative error allowed, 1e-5 to 0.5: of the creep compliance at times in the
        window, and of the complex compliance at ω between their inverses.

    Raises
    ------
    ValueError
        If a value is out of range; and, when the chain is first needed, if it has too many
        elements.

    References
    ----------
    1/E(t) = sin(πa)/(πa) (t/t0)^a/E1; E*(ω) = E1 Γ(1 − a) (iωt0)^a.
    """

    kind: ClassVar[str] = "power-law"
    E1: float
    exponent: float
    window: tuple[float, float]
    poisson: float
    reference_time: float = 1.0
    error: float = 0.01

    def __post_init__(self) -> None:
        time = check_positive("reference_time", self.reference_time, "s")
        object.__setattr__(self, "E1", check_positive("E1", self.E1, "Pa"))
        object.__setattr__(self, "exponent", check_exponent(self.exponent))
        object.__setattr__(self, "window", check_window(self.window))
        object.__setattr__(self, "poisson", check_poisson_ratio(self.poisson))
        object.__setattr__(self, "reference_time", time)
        object.__setattr__(self, "error", check_error(self.error))

    @classmethod
    def springpot(
        cls,
        quasi_property: float,
        exponent: float,
        window: tuple[float, float],
        poisson: float,
        error: float = 0.01,
    ) -> "PowerLaw":
        """Build from σ = V d^a ε/dt^a with V in Pa s^a: E(t) = V t^−a/Γ(1 − a)."""
        exponent = check_exponent(exponent)
        V = check_positive("quasi_property", quasi_property, "Pa s^a")
        return cls(V / gamma(1 - exponent), exponent, window, poisson, 1.0, error)

    @property
    def _response(self) -> Response:
        return _Springpot(self.exponent)

    @property
    def _scale(self) -> float:
        shortest = self.window[0] / self.reference_time
        return shortest**self.exponent / (self.E1 * gamma(1 - self.exponent))


class _Springpot(NamedTuple):
    """Compliance (iω)^−a."""

    exponent: float
    flows: bool = True

    def creep(self, time: np.ndarray) -> np.ndarray:
        return time**self.exponent / gamma(1 + self.exponent)

    def complex_compliance(self, angular_frequency: np.ndarray) -> np.ndarray:
        return (1j * angular_frequency) ** -self.exponent
