"""The driven lever: its balance of forces, and which of its solutions attract."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from softafm.instrument.oscillator import Drive

# CHECKS: mean height, amplitude, virial of a rigid Lennard-Jones sample; A/A0 and phase for
# k = 28.1 N/m and Q = 430 at resonance.
RIGID = [
    (50e-9, 1.16397182626e-18, 0.99989849, 90.81637),
    (50e-9, 2.25889088641e-18, 0.99961787, 91.58402),
    (10e-9, 1.73174656831e-19, 0.99859845, 93.03384),
]


@pytest.mark.parametrize(("amplitude", "virial", "ratio", "phase"), RIGID)
def test_rigid_sample_reduces_the_amplitude_by_known_ratios(amplitude, virial, ratio, phase):
    def excess(free):
        return Drive(28.1, 430.0, 1.0, free).excess(amplitude, virial, 0.0)

    free = brentq(excess, 0.9 * amplitude, 2 * amplitude, xtol=1e-20)
    assert amplitude / free == pytest.approx(ratio, abs=1e-8)
    found = Drive(28.1, 430.0, 1.0, free).phase(amplitude, virial, 0.0)
    assert found == pytest.approx(phase, abs=1e-5)


def test_phase_and_dissipation_at_resonance():
    # Cleveland et al. 1998: sin φ = (A/A0)(1 + QE/πkA²), cos φ = −2QV/kAA0, and the
    # amplitude-reduction equation of Rajabifar et al. 2021 (31).
    k, Q, free = 28.1, 430.0, 60e-9
    virial, dissipation = -3e-17, 4e-17

    def reduced(amplitude):  # equation (31)
        damping = 1 / Q + dissipation / (np.pi * k * amplitude**2)
        return free / Q / np.hypot(2 * virial / (k * amplitude**2), damping)

    amplitude = brentq(lambda a: reduced(a) - a, 20e-9, 60e-9, xtol=1e-20)
    drive = Drive(k, Q, 1.0, free)
    assert drive.excess(amplitude, virial, dissipation) == pytest.approx(0, abs=1e-9)
    sine = amplitude / free * (1 + Q * dissipation / (np.pi * k * amplitude**2))
    cosine = -2 * Q * virial / (k * amplitude * free)
    assert sine**2 + cosine**2 == pytest.approx(1, abs=1e-9)
    phase = np.radians(drive.phase(amplitude, virial, dissipation))
    assert (np.cos(phase), np.sin(phase)) == pytest.approx((cosine, sine), abs=1e-9)


@pytest.mark.parametrize("detuning", [0.8, 0.995, 1.0, 1.01, 1.3])
def test_a_free_lever_swings_at_its_free_amplitude(detuning):
    k, Q, free = 2.0, 50.0, 20e-9
    drive = Drive(k, Q, detuning, free)
    # The response of a harmonic oscillator to F0 cos ωt.
    response = 1 / (k * (1 - detuning**2 + 1j * detuning / Q))
    assert drive.force * abs(response) == pytest.approx(free, rel=1e-12)
    assert drive.excess(free, 0.0, 0.0) == pytest.approx(0, abs=1e-12)
    assert drive.phase(free, 0.0, 0.0) == pytest.approx(-np.degrees(np.angle(response)))


@pytest.mark.parametrize("detuning", [0.9, 1.0, 1.02])
def test_linear_tip_forces_shift_and_damp_the_resonance(detuning):
    # A tip force −κq − cq' has V = −κA²/2 and E = πcωA², and adds to spring and damper.
    k, Q, free, stiffer, damping = 2.0, 80.0, 20e-9, 0.05, 0.03  # κ and cω, N/m
    drive = Drive(k, Q, detuning, free)
    against = k * (1 - detuning**2) + stiffer + 1j * (k * detuning / Q + damping)
    response = drive.force / against
    amplitude = abs(response)
    values = amplitude, -stiffer * amplitude**2 / 2, np.pi * damping * amplitude**2
    assert drive.excess(*values) == pytest.approx(0, abs=1e-12)
    assert drive.phase(*values) == pytest.approx(-np.degrees(np.angle(response)))
    # The squares of both components add up to the drive, there and nowhere else.
    assert np.hypot(*drive.components(*values)) == pytest.approx(drive.force, rel=1e-12)
    less = 0.9 * amplitude, 0.81 * values[1], 0.81 * values[2]
    assert drive.excess(*less) == pytest.approx(-0.1)


# Stability, against the oscillator q'' + q'/Q + q = F0 cos rt + f(q, q') itself (m = k = 1)

Q = 100.0


class CubicSpring:
    """f = −βq³: a stiffening spring (Duffing), bistable above resonance."""

    beta = 0.04

    def force(self, q, speed):
        return -self.beta * q**3

    def virial(self, a, r):
        return -3 / 8 * self.beta * a**4

    def dissipation(self, a, r):
        return 0.0 * a


class FarAttraction:
    """f = −c/(Z + q)² + c/Z²: van der Waals, less its pull at rest; bistable below resonance."""

    c, height = 0.03, 1.4

    def force(self, q, speed):
        return -self.c / (self.height + q) ** 2 + self.c / self.height**2

    def virial(self, a, r):
        return self.c * a**2 / (self.height**2 - a**2) ** 1.5

    def dissipation(self, a, r):
        return 0.0 * a


class SelfExcited:
    """f = (g − cq²)q' (van der Pol): swings by itself unless the drive is strong enough to lead."""

    g, c = 0.03, 0.08

    def force(self, q, speed):
        return (self.g - self.c * q**2) * speed

    def virial(self, a, r):
        return 0.0 * a

    def dissipation(self, a, r):  # −∮ f dq over q = a cos rt
        return np.pi * r * (self.c * a**4 / 4 - self.g * a**2)


def solutions(case, drive):
    """Amplitude, phase (rad) and stability of every solution with an amplitude below 1.39."""

    def values(a):
        return case.virial(a, drive.detuning), case.dissipation(a, drive.detuning)

    grid, step = np.linspace(1e-3, 1.39, 4001), 1e-5
    excess = drive.excess(grid, *values(grid))
    for i in np.flatnonzero(excess[1:] * excess[:-1] < 0):
        a = brentq(lambda x: drive.excess(x, *values(x)), grid[i], grid[i + 1], xtol=1e-12)
        slopes = np.subtract(values(a + step), values(a - step)) / (2 * step)
        stable = drive.stable(a, *values(a), *slopes)
        yield a, np.radians(drive.phase(a, *values(a))), bool(stable)


def wander(case, drive, wanted, periods=200):
    """Way of oscillators that start 5 % off ``wanted``, (n,), eight from each: (periods, n, 8).

    In the complex plane of A exp(−iφ), less ``wanted`` and over its magnitude. Classical
    Runge-Kutta method, 40 steps a period.
    """
    r, wanted = drive.detuning, np.asarray(wanted)[:, None]
    start = wanted * (1 + 0.05 * np.exp(2j * np.pi * np.arange(8) / 8))
    state = np.array([start.real, -r * start.imag])  # q = Re z exp(irt)
    step = 2 * np.pi / r / 40

    def rates(t, y):
        pull = drive.force * np.cos(r * t) + case.force(*y)
        return np.array([y[1], pull - y[0] - y[1] / Q])

    t, way = 0.0, []
    for _ in range(periods):
        for _ in range(40):
            a = rates(t, state)
            b = rates(t + step / 2, state + step / 2 * a)
            c = rates(t + step / 2, state + step / 2 * b)
            d = rates(t + step, state + step * c)
            state, t = state + step / 6 * (a + 2 * b + 2 * c + d), t + step
        way.append((state[0] - 1j * state[1] / r - wanted) / np.abs(wanted))
    return np.array(way)


@pytest.mark.parametrize(
    ("case", "detuning", "free", "wanted"),
    [
        (CubicSpring(), 1.0, 0.35, [True]),
        (CubicSpring(), 1.02, 0.35, [True, False, True]),
        (FarAttraction(), 0.976, 0.22, [True, False, True]),
        (SelfExcited(), 1.01, 0.2, [False]),
        (SelfExcited(), 1.01, 0.77, [True]),
        (SelfExcited(), 1.01, 1.2, [True]),
    ],
)
def test_stable_solutions_attract_and_unstable_ones_do_not(case, detuning, free, wanted):
    drive = Drive(1.0, Q, detuning, free)
    amplitude, phase, stable = zip(*solutions(case, drive), strict=True)
    assert list(stable) == wanted
    way = wander(case, drive, np.array(amplitude) * np.exp(-1j * np.array(phase)))
    for i, attracts in enumerate(stable):
        last, farthest = way[-1, i], np.abs(way[:, i]).max(axis=0)
        if attracts:  # all end alike, and there but for the error of averaging
            assert np.abs(last - last.mean()).max() < 0.01
            assert np.abs(last).max() < 0.1
        else:
            assert np.median(farthest) > 0.5


def swing(quality, detuning, height, damping=0.0):
    """Amplitude, virial, dissipation and second harmonic over the first of a lever in steady taps.

    Its equation of motion, with time in 1/ω0, above a Hertz contact with a dashpot.
    """
    k, free, radius, modulus = 0.5, 10e-9, 20e-9, 1e8
    force0 = Drive(k, quality, detuning, free).force

    def force(depth, speed):
        depth = np.maximum(depth, 0.0)
        return 4 / 3 * modulus * np.sqrt(radius) * depth**1.5 - damping * np.sqrt(depth) * speed

    def motion(time, state):
        q, speed = state
        push = force(-height - q, speed)
        return speed, (force0 * np.cos(detuning * time) + push) / k - speed / quality - q

    period = 2 * np.pi / detuning
    last = max(40, int(6 * quality)) * period
    at = last + period * np.arange(2048) / 2048
    options = {"rtol": 1e-8, "atol": 1e-17, "max_step": period / 60, "t_eval": at}
    q, speed = solve_ivp(motion, (0, at[-1]), (0, 0), **options).y
    harmonics = np.abs(np.fft.rfft(q)) * 2 / at.size
    pushes = force(-height - q, speed)
    virial, dissipation = np.mean(pushes * (q - q.mean())), -np.mean(pushes * speed) * period
    return harmonics[1], virial, dissipation, harmonics[2] / harmonics[1]


@pytest.mark.parametrize(
    ("quality", "detuning", "height", "damping"),
    [(2, 1, 5e-9, 0), (3, 1, 4e-9, 5e2), (10, 1, 7e-9, 0), (5, 0.9, 7e-9, 5e2), (30, 0.6, 8e-9, 0)],
)
def test_the_second_harmonic_is_that_of_the_equation_of_motion(quality, detuning, height, damping):
    amplitude, virial, dissipation, share = swing(quality, detuning, height, damping)
    assert dissipation > 0.01 * abs(virial) if damping else abs(dissipation) < 0.01 * abs(virial)
    drive = Drive(0.5, quality, detuning, 10e-9)
    estimate = drive.second_harmonic(amplitude, virial, dissipation)
    assert share == pytest.approx(estimate, rel=0.35)
