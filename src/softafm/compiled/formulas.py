"""Formulas of surface laws and tip profiles: functions of one number, written in plain Python."""

import inspect
import re
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from softafm.checks.validate import check_finite

_TERMINAL_CODE = re.compile(r"\x1b\[[0-9;]*m")
"""With these numba colours what it says."""


class Shape(NamedTuple):
    """The part of a term that determines its compiled code: function and number of parameters.

    ``function(x, a, b, ...)`` takes so many ``parameters`` one by one, or with None all of them as
    one array.
    """

    function: Callable
    parameters: int | None


class Term(NamedTuple):
    """A formula with the values of its parameters, SI.

    Written with operators and NumPy's functions alone, without ``if``, a formula serves for single
    numbers in compiled loops and for arrays in Python.
    """

    function: Callable
    values: tuple[float, ...]
    as_array: bool = False

    @property
    def shape(self) -> Shape:
        """What decides how the formula is compiled."""
        return Shape(self.function, None if self.as_array else len(self.values))

    @property
    def packed(self) -> tuple[float, ...]:
        """The values as the compiled loops expect them."""
        return (float(len(self.values)), *self.values) if self.as_array else self.values

    def __call__(self, x):
        """Evaluate the formula in Python for an array ``x``."""
        if self.as_array:
            return self.function(x, np.array(self.values))
        return self.function(x, *self.values)


def bound_parameters(
    function: Callable, first: str, parameters: Mapping[str, float]
) -> tuple[tuple[str, float], ...]:
    """Return name and value of each parameter of a user's formula, in the order it takes them.

    ``first`` says what the function's first argument is; those after it are its parameters, of
    which ``parameters`` names the values, SI. A default of the function counts where it does not.

    Raises
    ------
    ValueError
        If it is not a function of plain positional arguments, or the names or values do not fit.
    """
    name = getattr(function, "__name__", "function")
    try:
        taken = list(inspect.signature(getattr(function, "py_func", function)).parameters.values())
    except (TypeError, ValueError):
        raise ValueError(f"function = {function!r}: must be a Python function") from None
    plain = inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD
    if not taken or any(each.kind not in plain for each in taken):
        shown = ", ".join(map(str, taken))
        raise ValueError(f"function = {name}({shown}): must take ({first}, parameter, ...)")
    known = {each.name: each.default for each in taken[1:]}
    listed = f"those of {name} are " + ", ".join(known) if known else f"{name} takes none"
    for key in parameters:
        if key not in known:
            raise ValueError(f"{key}: must be a parameter of the function; {listed}")
    values = {**known, **parameters}
    for key, value in values.items():
        if value is inspect.Parameter.empty:
            raise ValueError(f"{key}: missing; must have a value; {listed}")
    return tuple((key, check_finite(key, value, "SI units")) for key, value in values.items())


def find_first_line(error: Exception) -> str:
    """Return what numba has to say of a function, which it says in many lines and many types."""
    plain = _TERMINAL_CODE.sub("", str(error))
    lines = [line.strip() for line in plain.splitlines() if line.strip()]
    reason = next((line for line in lines if not line.startswith("Failed in")), "")
    return f"{type(error).__name__}: {reason}"
