"""Readers for tests of the guard: harmless things that do what a damaged file may make one do."""

import os
import sys
import time

import numpy as np


def whole(count):
    return {"text": "µ\n\udc80", "none": None}, [
        np.arange(float(count)), np.array(["a", "bcd"]), np.empty((0, 3)), np.array(2.0),
        np.arange(6, dtype=">i4").reshape(2, 3).T,
    ]  # fmt: skip


def sleeps(seconds):
    time.sleep(seconds)
    return None, []


def spins(_):
    while True:
        pass


def allocates(size):
    return None, [np.ones(size, np.uint8)]


def dies(code):
    os._exit(code)


def is_killed(number):
    os.kill(os.getpid(), number)


def prints(text):
    print(text)
    os.write(1, text.encode())
    os.write(2, text.encode())
    return "said", []


def garbles(text):
    """Write what is no answer where answers go."""
    for place in range(3, 20):
        try:
            os.write(place, text.encode())
        except OSError:
            continue
    os._exit(0)


def refuses(text):
    raise ValueError(text)


def fails(text):
    raise KeyError(text)


def knows(*names):
    return {name: os.environ.get(name) for name in names}, []


def writes(path):
    with open(path, "w") as file:
        file.write("x")
    return None, []


def deep(count):
    sys.setrecursionlimit(10 * count)
    nested = []
    for _ in range(count):
        nested = [nested]
    return nested, []
