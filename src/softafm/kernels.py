"""Compiled motions, called by the solvers' hot loops."""

from math import cos, pi

from softafm.compiled import HEIGHT, compiled


@compiled(HEIGHT)
def triangle(time, parameters):
    turn, speed, middle, half_dwell = parameters[0], parameters[1], parameters[2], parameters[3]
    return turn + speed * max(abs(time - middle) - half_dwell, 0.0)


@compiled(HEIGHT)
def still(time, parameters):
    return parameters[0]


@compiled(HEIGHT)
def sine(time, parameters):
    mean, amplitude, frequency = parameters[0], parameters[1], parameters[2]
    return mean + amplitude * cos(2 * pi * frequency * time)


@compiled(HEIGHT)
def sampled(time, parameters):
    """Cubic Hermite interpolation; parameters hold times, heights and slopes, n of each."""
    n = parameters.size // 3
    low, high = 0, n - 1
    while high - low > 1:
        middle = (low + high) // 2
        if parameters[middle] <= time:
            low = middle
        else:
            high = middle
    step = parameters[low + 1] - parameters[low]
    x = (time - parameters[low]) / step
    y0, y1 = parameters[n + low], parameters[n + low + 1]
    d0, d1 = step * parameters[2 * n + low], step * parameters[2 * n + low + 1]
    rest = 1 - x
    return rest * rest * (y0 * (1 + 2 * x) + d0 * x) + x * x * (y1 * (3 - 2 * x) - d1 * rest)
