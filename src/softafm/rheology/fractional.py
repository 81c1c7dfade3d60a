"""The standard linear solid with a springpot for its dashpot."""

from dataclasses import dataclass
from math import ceil
from typing import ClassVar, NamedTuple

import numpy as np

from softafm.checks.validate import check_poisson_ratio, check_positive
from softafm.rheology.lists import check_window
from softafm.rheology.represented import Represented, check_exponent
from softafm.rheology.series import Response, check_error

_LEAST_EXPONENT = 0.01
"""The exact creep is an integral over a width that grows as the inverse of the exponent."""


@dataclass(frozen=True)
class FractionalStandardLinearSolid(Represented):
    """Broad transition between two moduli, 1/E*(ω) = 1/E0 + (1/E_inf − 1/E0)/(1 + (iωτ)^a).

    Cole and Cole's law, here of the compliance. Solvers need a discrete spectrum, so it is
    represented by as few Kelvin-Voigt elements as keep ``error`` over ``window``; creep, relaxation
    and moduli are those of this chain, and ``represented_error`` says how close it is. Where the
    window does not reach E0 or E_inf, neither need the chain.

    Parameters
    ----------
    E0, E_inf
        Short- and long-term Young's modulus, Pa; E_inf ≤ E0.
    creep_time
        Creep (retardation) time τ, s.
    exponent
        Exponent a, 0.01 or more and below 1; it would be a standard linear solid at 1.
    window
        Shortest and longest time of the experiment, s.
    poisson
        Poisson's ratio, in (-1, 0.5].
    error
        Largest relative error allowed, 1e-5 to 0.5: of the creep compliance at times in the
        window, and of the complex compliance at ω between their inverses.

    Raises
    ------
    ValueError
        If a value is out of range or E_inf > E0; and, when the chain is first needed, if it has
        too many elements.

    References
    ----------
    Cole and Cole 1941. Creep: 1/E(t) = 1/E_inf − (1/E_inf − 1/E0) E_a(−(t/τ)^a), with the
    Mittag-Leffler function E_a.
    """

    kind: ClassVar[str] = "fractional-standard-linear-solid"
    E0: float
    E_inf: float
    creep_time: float
    exponent: float
    window: tuple[float, float]
    poisson: float
    error: float = 0.01

    def __post_init__(self) -> None:
        object.__setattr__(self, "E0", check_positive("E0", self.E0, "Pa"))
        object.__setattr__(self, "E_inf", check_positive("E_inf", self.E_inf, "Pa"))
        object.__setattr__(self, "creep_time", check_positive("creep_time", self.creep_time, "s"))
        object.__setattr__(self, "exponent", check_exponent(self.exponent))
        if self.exponent < _LEAST_EXPONENT:
            raise ValueError(
                f"exponent = {self.exponent:g}: must be at least {_LEAST_EXPONENT:g}; below, the "
                "transition is spread over hundreds of decades and the sample as good as Elastic"
            )
        object.__setattr__(self, "window", check_window(self.window))
        object.__setattr__(self, "poisson", check_poisson_ratio(self.poisson))
        object.__setattr__(self, "error", check_error(self.error))
        if self.E_inf > self.E0:
            raise ValueError(
                f"E_inf = {self.E_inf:g} Pa: must be at most E0 = {self.E0:g} Pa "
                "(a solid softens as it relaxes)"
            )

    @property
    def _response(self) -> Response:
        return _ColeCole(self.E_inf / self.E0, self.creep_time / self.window[0], self.exponent)

    @property
    def _scale(self) -> float:
        return 1 / self.E_inf


class _ColeCole(NamedTuple):
    """Compliance r + (1 − r)/(1 + (iωτ)^a)."""

    instantaneous: float
    creep_time: float
    exponent: float
    flows: bool = False

    def creep(self, time: np.ndarray) -> np.ndarray:
        """Integrate over the spectrum, of which the share u has times below τ·x(u)."""
        a = self.exponent
        # u = 1/(1 + e^−v), by the trapezoidal rule in v: the ends fall off as e^−|v|.
        v = np.linspace(-36, 36, 2 * ceil(36 / min(0.2, a / 3)) + 1)
        below, above = 1 / (1 + np.exp(-v)), 1 / (1 + np.exp(v))
        logs = np.log(np.sin(np.pi * a * below) / np.sin(np.pi * a * above)) / a
        shares = below * above * (v[1] - v[0])
        rates = np.exp(np.clip(-logs, -600, 600)) / self.creep_time
        crept = -np.expm1(-np.asarray(time)[..., None] * rates) @ shares
        return self.instantaneous + (1 - self.instantaneous) * crept

    def complex_compliance(self, angular_frequency: np.ndarray) -> np.ndarray:
        rise = (1j * angular_frequency * self.creep_time) ** self.exponent
        return self.instantaneous + (1 - self.instantaneous) / (1 + rise)
