"""Objects that are not what an argument is for: one line says what was given and what would be."""

from collections.abc import Iterator, Sequence
from inspect import Parameter, isroutine, signature
from typing import Any

from softafm.checks.refusals import join_with_and, show

SAMPLE = ("kind", "compliance", "poisson")
"""What a sample has, whatever its class."""
REDUCED = (
    "has a reduced_compliance only: must have compliance, the creep compliance under uniaxial "
    "stress without the factor 1 − ν², and poisson"
)
"""What is wrong with a sample that states its compliance as a half-space has it."""


def members(protocol: type) -> tuple[str, ...]:
    """Return the names that a protocol asks for, in the order in which it states them."""
    return tuple(name for name in vars(protocol) if not name.startswith("_"))


def is_built_in(value: Any) -> bool:
    """Whether a class of this package made an object, none of the user's, derived or not."""
    return type(value).__module__.startswith("softafm.")


def check_kind(name: str, value: Any) -> None:
    """Raise ValueError if an object of a user's class has no name, or that of another class."""
    stated = next((each for each in type(value).__mro__ if "kind" in vars(each)), None)
    kind = getattr(value, "kind", None)
    inherited = stated is not None and stated.__module__.startswith("softafm.")
    if inherited or not isinstance(kind, str):
        of = type(value).__qualname__
        raise ValueError(
            f"{name}.kind = {kind!r}: must be a name that the class {of} states, as text: results "
            "record it"
        )


def refuse_other(name: str, value: Any, kind: type | tuple[type, ...], wanted: str) -> None:
    """Raise ValueError if ``value`` is no instance of a class; ``wanted`` says in words of what."""
    if not isinstance(value, kind):
        raise ValueError(
            f"{name} = {_describe_given(value)}: must be {wanted}{_describe_call(value)}"
        )


def refuse_incomplete(name: str, value: Any, needed: Sequence[str], wanted: str) -> None:
    """Raise ValueError if ``value`` is a class, or lacks one of the attributes ``needed``."""
    # What stands in dir is not evaluated: a property may compile, or fail for its own reasons.
    known = set() if isinstance(value, type) else set(dir(value))
    missing = [each for each in needed if each not in known and not hasattr(value, each)]
    if not missing and not isinstance(value, type):
        return
    in_part = 0 < len(missing) < len(needed) and not isinstance(value, type)
    lacks = f"; it has no {join_with_and(missing)}" if in_part else ""
    raise ValueError(
        f"{name} = {_describe_given(value)}: must be {wanted}{lacks}{_describe_call(value)}"
    )


def refuse_sample(name: str, value: Any) -> None:
    """Raise ValueError if ``value`` lacks something that a sample has."""
    if hasattr(value, "reduced_compliance") and not hasattr(value, "compliance"):
        raise ValueError(f"{name} = {_describe_given(value)}: {REDUCED}")
    wanted = "a sample such as softafm.Elastic"
    if hasattr(value, "influence") and hasattr(value, "sample"):
        wanted += ", and this is a body: take its sample, as body.sample"
    refuse_incomplete(name, value, SAMPLE, wanted)


def refuse_non_dataset(name: str, value: Any) -> None:
    """Raise ValueError if ``value`` is not an ``xarray.Dataset``, which all results are."""
    from xarray import Dataset

    refuse_other(name, value, Dataset, "a result of softafm, an xarray.Dataset")


def check_list(name: str, value: Any, kind: type, wanted: str) -> list[Any]:
    """Return one object of a class, or a sequence of such, as a list; else raise ValueError."""
    if isinstance(value, kind):
        return [value]
    if isinstance(value, str | bytes) or not isinstance(value, Sequence | Iterator):
        refuse_other(name, value, kind, f"{wanted}, or several in a list")
    found = list(value)
    for i, each in enumerate(found):
        refuse_other(f"{name}[{i}]", each, kind, wanted)
    return found


def _is_callable(value: Any) -> bool:
    return isinstance(value, type) or isroutine(value)


def _describe_given(value: Any) -> str:
    """Return a value as the user would recognise it: of a function or class its name."""
    if not _is_callable(value):
        return " ".join(show(value).split())
    return f"<{'class' if isinstance(value, type) else 'function'} {value.__qualname__}>"


def _describe_call(value: Any) -> str:
    """Say how to call a function or class that was given in place of what it makes."""
    if not _is_callable(value):
        return ""
    room = "softafm.samples." if value.__module__ == "softafm.samples" else ""
    try:
        parameters = signature(value).parameters.values()
    except (TypeError, ValueError):  # one that is not written in Python
        return ""
    needed = any(each.default is Parameter.empty for each in parameters)
    return f"; call it: {room}{value.__qualname__}({'...' if needed else ''})"
