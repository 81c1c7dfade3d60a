"""Compiled motions, called by the solvers' hot loops."""

from math import cos, pi

import numpy as np

from softafm.compiled.functions import HEIGHT, compile_when_used


@compile_when_used(HEIGHT)
def triangle(time: float, parameters: np.ndarray) -> float:
    turn, speed, middle, half_dwell = parameters[0], parameters[1], parameters[2], parameters[3]
    return turn + speed * max(abs(time - middle) - half_dwell, 0.0)


@compile_when_used(HEIGHT)
def still(time: float, parameters: np.ndarray) -> float:
    return parameters[0]


@compile_when_used(HEIGHT)
def sine(time: float, parameters: np.ndarray) -> float:
    mean, amplitude, frequency = parameters[0], parameters[1], parameters[2]
    return mean + amplitude * cos(2 * pi * frequency * time)


@compile_when_used(HEIGHT)
def sampled(time: float, parameters: np.ndarray) -> float:
    """Cubics between n times; parameters hold the times, then n − 1 coefficients of each power of
    the time since the last of them, the highest power first."""
    n = (parameters.size + 4) // 5
    low, high = 0, n - 1
    while high - low > 1:
        middle = (low + high) // 2
        if parameters[middle] <= time:
            low = middle
        else:
            high = middle
    x, at, pieces = time - parameters[low], n + low, n - 1
    height = parameters[at] * x + parameters[at + pieces]
    return (height * x + parameters[at + 2 * pieces]) * x + parameters[at + 3 * pieces]
