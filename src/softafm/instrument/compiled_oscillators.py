"""Compiled eigenmodes of a lever with inertia: filters of the force on the tip, with memory.

A filter is ż = λz + F(t), and the tip deflected by Re(w z); an eigenmode is one filter of a complex
λ, or two of a real one. Besides, each mode does what its drives make it do, C cos ωt − S sin ωt.
``parameters`` holds the numbers of filters and of tones, then per filter Re λ, Im λ, Re w, Im w and
the number of its mode, and per tone ω, C, S and the number of its mode. ``state`` holds Re z, Im z.
"""

from math import cos, exp, inf, sin, sqrt

from numba import float64

from softafm.compiled.functions import ACCEPTANCE, RESPONSE, compile_for, compile_when_used, inline

FILTERS, TONES, FILTER, TONE = 2, 0, 5, 4
"""Where the first filter starts in the parameters; how many numbers a filter and a tone have."""

_VECTOR = float64[::1]
_SHORT = 0.36
"""Square of |x| below which moments are series, as differences would cancel."""


@inline
def find_moments(re, im):
    """M_j = ∫₀¹ e^(x(1 − s)) s^j ds for j = 0, 1, 2 of a complex x; e^x = 1 + x M_0."""
    x = complex(re, im)
    if re * re + im * im < _SHORT:
        m2 = 1.0 + x / 15.0
        for k in range(14, 3, -1):
            m2 = 1.0 + x * m2 / k
        m2 = m2 / 3.0
        m1 = 0.5 * (x * m2 + 1.0)
        return x * m1 + 1.0, m1, m2
    grown = exp(re)
    m0 = (complex(grown * cos(im), grown * sin(im)) - 1.0) / x
    m1 = (m0 - 1.0) / x
    return m0, m1, (2.0 * m1 - 1.0) / x


@inline
def respond_to_drive(time, parameters):
    """Deflection that the drives cause at a time, m."""
    at, deflection = FILTERS + FILTER * int(parameters[0]), 0.0
    for _ in range(int(parameters[1])):
        angle = parameters[at] * time
        deflection += parameters[at + 1] * cos(angle) - parameters[at + 2] * sin(angle)
        at += TONE
    return deflection


@compile_when_used(RESPONSE)
def swing(time, step, deflection, force, parameters, state):
    """Rest and stiffness of a step over which the force is linear in time."""
    rest, gives = respond_to_drive(time, parameters), 0.0
    for j in range(int(parameters[0])):
        at = FILTERS + FILTER * j
        rate = complex(parameters[at], parameters[at + 1])
        weight = complex(parameters[at + 2], parameters[at + 3])
        m0, m1, _ = find_moments(rate.real * step, rate.imag * step)
        z = complex(state[2 * j], state[2 * j + 1])
        z += step * (rate * m0 * z + (m0 - m1) * force)
        rest += weight.real * z.real - weight.imag * z.imag
        gives += step * (weight.real * m1.real - weight.imag * m1.imag)
    return rest, 1.0 / gives if gives > 0.0 else inf


@compile_when_used(ACCEPTANCE)
def swing_on(time, step, before, force, parameters, state):
    """Carry the filters over a step in which the force went from one to the other."""
    for j in range(int(parameters[0])):
        at = FILTERS + FILTER * j
        rate = complex(parameters[at], parameters[at + 1])
        m0, m1, _ = find_moments(rate.real * step, rate.imag * step)
        z = complex(state[2 * j], state[2 * j + 1])
        z += step * (rate * m0 * z + (m0 - m1) * before + m1 * force)
        state[2 * j], state[2 * j + 1] = z.real, z.imag


@inline
def bend_late(step, last, bend, parameters, state):
    """Let the force have been a parabola over the step before the last, which was ``last`` long.

    ``bend`` is its second derivative there, N/s²; it acts as the straight line and
    bend (s² − s) last²/2. Returns the change of the deflection, m.
    """
    change = 0.0
    for j in range(int(parameters[0])):
        at = FILTERS + FILTER * j
        rate = complex(parameters[at], parameters[at + 1])
        weight = complex(parameters[at + 2], parameters[at + 3])
        _, m1, m2 = find_moments(rate.real * last, rate.imag * last)
        m0, _, _ = find_moments(rate.real * step, rate.imag * step)
        late = (1.0 + rate * step * m0) * (m2 - m1) * (0.5 * bend * last * last * last)
        state[2 * j] += late.real
        state[2 * j + 1] += late.imag
        change += weight.real * late.real - weight.imag * late.imag
    return change


@inline
def bound_speed(parameters, state):
    """How fast filters and drives can move the tip until a force acts, m/s."""
    at, speed = FILTERS, 0.0
    for j in range(int(parameters[0])):
        rate = parameters[at] ** 2 + parameters[at + 1] ** 2
        weight = parameters[at + 2] ** 2 + parameters[at + 3] ** 2
        speed += sqrt(rate * weight * (state[2 * j] ** 2 + state[2 * j + 1] ** 2))
        at += FILTER
    for _ in range(int(parameters[1])):
        speed += parameters[at] * sqrt(parameters[at + 1] ** 2 + parameters[at + 2] ** 2)
        at += TONE
    return speed


@inline
def find_fastest(parameters):
    """Largest angular frequency of filters and drives, 1/s."""
    at, fastest = FILTERS, 0.0
    for _ in range(int(parameters[0])):
        fastest = max(fastest, sqrt(parameters[at] ** 2 + parameters[at + 1] ** 2))
        at += FILTER
    for _ in range(int(parameters[1])):
        fastest = max(fastest, parameters[at])
        at += TONE
    return fastest


@inline
def begin_motion(time, parameters, motion):
    """Write the deflection that drives cause, then those of the modes, m, and their speeds, m/s."""
    at, modes = FILTERS + FILTER * int(parameters[0]), motion.size // 2
    for i in range(motion.size):
        motion[i] = 0.0
    for _ in range(int(parameters[1])):
        omega, i = parameters[at], 1 + int(parameters[at + 3])
        c, s = cos(omega * time), sin(omega * time)
        deflection = parameters[at + 1] * c - parameters[at + 2] * s
        motion[0] += deflection
        motion[i] += deflection
        motion[i + modes] -= omega * (parameters[at + 1] * s + parameters[at + 2] * c)
        at += TONE


@inline
def add_filters(parameters, state, motion):
    """Add what the filters do to what ``begin_motion`` wrote."""
    at, modes = FILTERS, motion.size // 2
    for j in range(int(parameters[0])):
        rate = complex(parameters[at], parameters[at + 1])
        z = complex(state[2 * j], state[2 * j + 1])
        z *= complex(parameters[at + 2], parameters[at + 3])
        i = 1 + int(parameters[at + 4])
        motion[0] += z.real
        motion[i] += z.real
        motion[i + modes] += rate.real * z.real - rate.imag * z.imag
        at += FILTER


@compile_for((float64, _VECTOR, _VECTOR, _VECTOR))
def measure_motion(time, parameters, state, motion):
    """Write the deflection, then those of the modes, m, and their speeds, m/s, into ``motion``."""
    begin_motion(time, parameters, motion)
    add_filters(parameters, state, motion)
