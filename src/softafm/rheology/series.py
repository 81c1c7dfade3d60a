"""The fewest Kelvin-Voigt elements that stand for a continuous spectrum over a window of times."""

from collections.abc import Hashable
from functools import lru_cache
from math import ceil, log, log10, pi
from typing import NamedTuple, Protocol

import numpy as np

from softafm.checks.validate import check_finite
from softafm.rheology.compliance import CreepCompliance

MOST_ELEMENTS = 40
_WIDEST = 1e60
_FITTED, _MEASURED = 12, 60
"""Samples a decade where a series is fitted, and where its error is measured."""
_MOST_STEPS, _PATIENCE = 300, 45
"""Steps to level the error, and how many of them may pass without gain."""
_EXACT = 1e-12
"""An error of round-off, with nothing left to level."""


class Response(Hashable, Protocol):
    """A compliance known exactly; hashable, for its series is found only once."""

    @property
    def flows(self) -> bool:
        """Whether the series may flow at times beyond the window."""

    def creep(self, time: np.ndarray) -> np.ndarray:
        """Creep compliance at ``time``."""

    def complex_compliance(self, angular_frequency: np.ndarray) -> np.ndarray:
        """Complex compliance at ω."""


class Series(NamedTuple):
    """A chain and its largest relative error in the window."""

    compliance: CreepCompliance
    error: float


def check_error(value: float) -> float:
    """Return ``value`` if it is an error that a series can keep."""
    number = check_finite("error", value, "")
    if not 1e-5 <= number <= 0.5:
        raise ValueError(f"error = {number:g}: must be between 1e-5 and 0.5")
    return number


def find_fewest_elements(response: Response, window: tuple[float, float], error: float) -> Series:
    """Return the chain of the fewest elements that keeps ``error`` over a window.

    The error is the largest relative deviation of the creep compliance at times in the window, and
    of the complex compliance at ω between their inverses. The chain has times, as the response, in
    units of the shortest.

    Raises
    ------
    ValueError
        If more than 40 elements were needed.
    """
    shortest, longest = window
    ratio = longest / shortest
    series = _find_fewest(response, ratio, error) if ratio < _WIDEST else None
    if series is None:
        raise ValueError(
            f"error = {error:g} over window = ({shortest:g}, {longest:g}) s needs more than "
            f"{MOST_ELEMENTS} elements: must be larger, or the window shorter"
        )
    return series


@lru_cache(maxsize=64)
def _find_fewest(response: Response, longest: float, error: float) -> Series | None:
    """Return the chain of the fewest elements that keeps ``error`` from time 1 to ``longest``.

    Modes start at equal ratios with weights by non-negative least squares, and move freely by least
    squares whose emphasis shifts to where the error is largest until it is level (Lawson 1961).
    """
    coarse, fine = (_Samples(response, longest, n) for n in (_FITTED, _MEASURED))

    def levelled(count: int) -> Series:
        logs = _level(coarse, _space_equally(coarse, count))
        return Series(fine.compliance(logs), fine.error(logs))

    # Equal spacing h in ln τ leaves a ripple of some 2 exp(−π²/h); two elements more for the ends.
    count = ceil(log(longest) * log(2 / error) / pi**2) + 2
    count = min(count, MOST_ELEMENTS)
    best = levelled(count)
    while best.error > error and count < MOST_ELEMENTS:
        count += 1
        best = levelled(count)
    if best.error > error:
        return None
    while count > 0:
        count -= 1
        fewer = levelled(count)
        if fewer.error > error:
            break
        best = fewer
    return best


class _Samples:
    """Relative contributions of elements to the exact response at samples of the window.

    A chain is given by logarithms: of J_g, of J_m, of φ if it flows, and of τ_m.
    """

    def __init__(self, response: Response, longest: float, per_decade: int):
        count = ceil(per_decade * log10(longest)) + per_decade
        self.longest = longest
        self.flows = response.flows
        self.time = np.geomspace(1, longest, count)[:, None]
        self.s = 1j / self.time
        exact = np.concatenate(
            [response.complex_compliance(1 / self.time[:, 0]), response.creep(self.time[:, 0])]
        )
        self.scale = 1 / exact[:, None]

    def columns(self, times: np.ndarray) -> np.ndarray:
        """Return what unit weights add to the response, relative to it."""
        one = np.ones_like(self.time)
        complex_columns = [one + 0j, 1 / (1 + self.s * times)]
        creep_columns = [one, -np.expm1(-self.time / times)]
        if self.flows:
            complex_columns.append(1 / self.s)
            creep_columns.append(self.time)
        return self.scale * np.vstack([np.hstack(complex_columns), np.hstack(creep_columns)])

    def slopes(self, logs: np.ndarray) -> np.ndarray:
        """Return the derivatives of the relative response by the logarithms."""
        weights, times = self.split(logs)
        ratio, lag = self.time / times, self.s * times
        of_times = self.scale * np.vstack([-lag / (1 + lag) ** 2, -ratio * np.exp(-ratio)])
        elements = weights[1 : times.size + 1]
        return np.hstack([self.columns(times) * weights, of_times * elements])

    def split(self, logs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return weights and times."""
        count = (logs.size - 1 - self.flows) // 2
        values = np.exp(logs)
        return values[: logs.size - count], values[logs.size - count :]

    def residual(self, logs: np.ndarray) -> np.ndarray:
        """Return the relative deviation from the exact response, complex."""
        weights, times = self.split(logs)
        # Not a dot product: BLAS threads of matrices as small as these wait for each other.
        return np.einsum("ij,j->i", self.columns(times), weights) - 1

    def error(self, logs: np.ndarray) -> float:
        """Return the largest relative deviation."""
        return float(np.max(np.abs(self.residual(logs))))

    def compliance(self, logs: np.ndarray) -> CreepCompliance:
        """Return the chain itself, by rising times."""
        weights, times = self.split(logs)
        order = np.argsort(times)
        fluidity = float(weights[-1]) if self.flows else 0.0
        elements = weights[1 : times.size + 1]
        return CreepCompliance(float(weights[0]), elements[order], times[order], fluidity)


def _space_equally(samples: _Samples, count: int) -> np.ndarray:
    """Return a chain of elements at equal ratios, weighed by non-negative least squares."""
    from scipy.optimize import nnls

    ends = 0.5 / count if count == 1 else 0.0
    times = samples.longest ** (np.linspace(0, 1, count) + ends)
    columns = samples.columns(times)
    rows = np.vstack([columns.real, columns.imag])
    norms = np.linalg.norm(rows, axis=0)
    target = np.repeat([1.0, 0.0], columns.shape[0])
    weights = nnls(rows / norms, target)[0] / norms
    # A logarithm needs all weights above zero; what is too small to matter can still grow.
    return np.log(np.concatenate([np.maximum(weights, 1e-5 / np.max(np.abs(columns), 0)), times]))


def _level(samples: _Samples, logs: np.ndarray) -> np.ndarray:
    """Return the chain of as many elements whose largest error is least, or nearly so.

    Levenberg-Marquardt steps in the logarithms, and after every third a shift of emphasis.
    """
    error = np.abs(samples.residual(logs))
    emphasis, damping = np.ones(error.size), 1e-2
    best, least, since = logs, np.max(error), 0
    for step in range(1, _MOST_STEPS + 1):
        slopes = samples.slopes(logs)
        weighed = slopes.conj() * emphasis[:, None]
        matrix = np.einsum("ij,ik->jk", weighed, slopes).real
        downhill = -np.einsum("ij,i->j", weighed, samples.residual(logs)).real
        scale = np.diag(matrix) + 1e-12 * np.max(np.diag(matrix))
        cost = emphasis @ error**2
        for _ in range(12):
            change = np.linalg.solve(matrix + damping * np.diag(scale), downhill)
            trial = logs + np.clip(change, -2, 2)
            tried = np.abs(samples.residual(trial))
            if emphasis @ tried**2 <= cost:
                logs, error, damping = trial, tried, max(damping / 5, 1e-9)
                break
            damping *= 4
        if np.max(error) < 0.995 * least:
            since = 0
        if np.max(error) < least:
            best, least = logs, np.max(error)
        since += 1
        if since > _PATIENCE or least < _EXACT:
            break
        if step % 3 == 0:
            emphasis *= error
            emphasis = np.maximum(emphasis / np.max(emphasis), 1e-8)
    return best
