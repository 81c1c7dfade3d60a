"""Time steppers of the fixed-step solvers."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from softafm.checks.validate import check_whole


@dataclass(frozen=True)
class AdamsBashforth:
    """Adams-Bashforth steps, y⁺ = y + dt Σ_i b_i ẏ(t − i·dt) with ``order`` past rates.

    Rajabifar et al. 2021, equation (27), with n_E = order − 1. The first steps of every smooth
    piece of a motion, which lack past rates, are of Runge and Kutta's fourth order.

    Parameters
    ----------
    order
        1 (forward Euler) to 5.

    Raises
    ------
    ValueError
        If the order is not a whole number from 1 to 5.
    """

    kind: ClassVar[str] = "adams-bashforth"
    rates_per_step: ClassVar[int] = 1
    order: int = 2

    def __post_init__(self) -> None:
        object.__setattr__(self, "order", check_whole("order", self.order, 1, 5))

    @property
    def weights(self) -> np.ndarray:
        """b_0, b_1, ..., of sum 1: exact for rates that are polynomials of degree order − 1."""
        power = np.arange(self.order)
        past = -power.astype(float)
        return np.linalg.solve(past[None, :] ** power[:, None], 1 / (power + 1))


@dataclass(frozen=True)
class ForwardEuler:
    """Forward Euler steps, y⁺ = y + dt ẏ: Rajabifar et al. 2021, equation (26)."""

    kind: ClassVar[str] = "forward-euler"
    rates_per_step: ClassVar[int] = 1

    @property
    def weights(self) -> np.ndarray:
        """The one weight of the present rate."""
        return np.ones(1)


@dataclass(frozen=True)
class RungeKutta4:
    """The classical Runge-Kutta steps of fourth order, with four rates a step."""

    kind: ClassVar[str] = "runge-kutta-4"
    rates_per_step: ClassVar[int] = 4

    @property
    def weights(self) -> np.ndarray:
        """No weights of past rates."""
        return np.empty(0)


Stepper = AdamsBashforth | ForwardEuler | RungeKutta4


def check_stepper(value: Any) -> Stepper:
    """Return ``value`` if it is a stepper, else raise ValueError."""
    if not isinstance(value, Stepper):
        raise ValueError(
            f"stepper = {value!r}: must be solvers.ForwardEuler(), solvers.AdamsBashforth(order) "
            "or solvers.RungeKutta4()"
        )
    return value
