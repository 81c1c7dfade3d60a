"""A cantilever driven near its resonance, its tip in contact once a cycle.

With q = A cos(ωt − φ), the drive F0 cos ωt, and virial V and dissipation E of the tip's force, both
components of the drive balance:

    F0 cos φ = k A (1 − r²) − 2V/A,      F0 sin φ = k A r/Q + E/(πA),      r = ω/ω0.

At resonance, r = 1 and F0 = k A0/Q, these are equations (29) and (30) of Rajabifar et al. 2021
(Cleveland et al. 1998; San Paulo and García 2001). Their sum of squares says which amplitudes and
heights go together; the slow drift of amplitude and phase away from them says which are stable.
"""

from cmath import exp
from dataclasses import dataclass
from math import hypot, pi
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Drive:
    """A drive of constant force, given by the free amplitude that it causes.

    Parameters
    ----------
    stiffness, quality_factor
        k, N/m, and Q of the cantilever.
    detuning
        Drive over resonance frequency, r.
    free_amplitude
        Amplitude away from the sample, m.
    """

    stiffness: float
    quality_factor: float
    detuning: float
    free_amplitude: float

    @property
    def _against(self) -> tuple[float, float]:
        """What the free lever sets against the drive per amplitude, in phase and behind, N/m."""
        r = self.detuning
        return self.stiffness * (1 - r * r), self.stiffness * r / self.quality_factor

    @property
    def force(self) -> float:
        """Amplitude F0 of the drive, N."""
        return self.free_amplitude * hypot(*self._against)

    def components(self, amplitude: Any, virial: Any, dissipation: Any) -> tuple[Any, Any]:
        """F0 cos φ and F0 sin φ that hold an amplitude (m) under V and E (J), in N."""
        elastic, viscous = self._against
        in_phase = elastic * amplitude - 2 * virial / amplitude
        return in_phase, viscous * amplitude + dissipation / (pi * amplitude)

    def excess(self, amplitude: Any, virial: Any, dissipation: Any) -> Any:
        """Force needed to hold an amplitude over that of the drive, less 1: 0 on a solution."""
        return np.hypot(*self.components(amplitude, virial, dissipation)) / self.force - 1

    def strongest_push(self, amplitude: Any) -> np.ndarray:
        """Largest −2V/A, N, against which the drive holds an amplitude, without dissipation."""
        elastic, viscous = self._against
        left = self.force**2 - (viscous * amplitude) ** 2
        push = np.sqrt(np.maximum(left, 0.0)) - elastic * amplitude
        return np.where(left > 0, np.maximum(push, 0.0), 0.0)

    @property
    def most_dissipation(self) -> float:
        """Largest E, J, that the drive can feed into a tap: πA(F0 − k A r/Q) at its maximum."""
        return pi * self.force**2 / (4 * self._against[1])

    def phase(self, amplitude: Any, virial: Any, dissipation: Any) -> Any:
        """Lag φ of the deflection behind the drive, degrees."""
        in_phase, behind = self.components(amplitude, virial, dissipation)
        return np.degrees(np.arctan2(behind, in_phase))

    def drift(self, amplitude: float, phase: float, needed: complex) -> tuple[float, float]:
        """dA/dt, m, and dφ/dt of a phase in rad, averaged over a cycle.

        ``needed`` has the ``components`` as its real and imaginary part. Time is in units of 2r/ω0,
        so that a free lever finds its amplitude in about Q of them.
        """
        surplus = (self.force * exp(1j * phase) - needed) / self.stiffness
        return surplus.imag, surplus.real / amplitude

    def second_harmonic(self, amplitude: Any, virial: Any, dissipation: Any) -> Any:
        """Second harmonic of the deflection over its first, which the balance leaves out.

        The tip's force has the components 2V/A and E/(πA) at the drive's frequency; that of a
        brief contact at the turning point has 2V/A and 2E/(πA) at twice that. The lever yields to
        them as an oscillator, by 1/k|1 − 4r² + 2ir/Q|: at resonance about 1/(3k).
        """
        r = self.detuning
        yields = self.stiffness * hypot(1 - 4 * r * r, 2 * r / self.quality_factor)
        force = np.hypot(2 * virial / amplitude, 2 * dissipation / (pi * amplitude))
        return force / (yields * amplitude)

    def stable(
        self,
        amplitude: Any,
        virial: Any,
        dissipation: Any,
        virial_slope: Any,
        dissipation_slope: Any,
    ) -> Any:
        """Whether a solution attracts, from dV/dA and dE/dA at fixed height of the lever, J/m.

        The Jacobian of ``drift`` must have a negative trace and a positive determinant:

            dA/dt  ~ F0 sin φ − k A r/Q − E/(πA),
            dφ/dt  ~ (F0 cos φ − k A (1 − r²) + 2V/A)/A.
        """
        in_phase, behind = self.components(amplitude, virial, dissipation)
        viscous = self._against[1]
        a = -viscous - (dissipation_slope - dissipation / amplitude) / (pi * amplitude)
        c = -in_phase / amplitude**2
        c = c + 2 * (virial_slope - 2 * virial / amplitude) / amplitude**2
        d = -behind / amplitude
        return (a + d < 0) & (a * d - in_phase * c > 0)
