"""Contact and motion of a result, built anew from what its attributes describe."""

import json
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import fields
from inspect import isabstract
from types import ModuleType
from typing import Any

import xarray as xr

from softafm import bodies, rheology, surfaces, tips
from softafm.contact import Contact
from softafm.errors import DoubtfulValueWarning
from softafm.instrument.motions import Sine

_ROOMS: dict[str, tuple[ModuleType, ...]] = {
    "tip": (tips,),
    "sample": (rheology, bodies),
    "surface": (surfaces,),
}


def read_contact(result: xr.Dataset) -> Contact:
    """Return the contact that a result describes.

    Raises
    ------
    ValueError
        If a part of it is of a class of the user's own, which the result names but does not hold,
        or the description is not complete.
    """
    with _refuse_damaged(), warnings.catch_warnings():
        warnings.simplefilter("ignore", DoubtfulValueWarning)  # the run has given them
        described = json.loads(result.attrs["experiment"])
        return Contact(**{role: _build(role, described[role]) for role in _ROOMS})


def read_sine(result: xr.Dataset) -> Sine | None:
    """Return the sine that a result describes as the motion of its tip; None of other motions.

    Raises
    ------
    ValueError
        If the description is not complete.
    """
    with _refuse_damaged():
        motion = json.loads(result.attrs["experiment"])["motion"]
        if motion["kind"] != Sine.kind or "base_height" in result:
            return None
        return Sine(*(motion[each.name] for each in fields(Sine)))


@contextmanager
def _refuse_damaged() -> Iterator[None]:
    """Reword what Python says of a description, of unknown origin, that lacks something."""
    try:
        yield
    except (KeyError, TypeError, AttributeError) as error:
        raise ValueError(
            f"the result does not describe its experiment as softafm does ({error!r}); give a "
            "reference as heights and forces"
        ) from None


def _build(role: str, described: Mapping[str, Any]) -> Any:
    classes = [c for room in _ROOMS[role] for c in vars(room).values() if isinstance(c, type)]
    known = {getattr(cls, "kind", None): cls for cls in classes if not isabstract(cls)}
    kind = described["kind"]
    if kind not in known or any(_is_function(value) for value in described.values()):
        raise ValueError(
            f"{role} = '{kind}': is of a class or function of your own, which a result does not "
            "hold; give a reference as heights and forces"
        )
    names = [each.name for each in fields(known[kind]) if each.init]
    return known[kind](**{name: _read(role, described[name]) for name in names})


def _is_function(value: Any) -> bool:
    return isinstance(value, Mapping) and "source" in value


def _read(role: str, value: Any) -> Any:
    if isinstance(value, Mapping):
        return _build(role, value)
    if isinstance(value, list):
        return tuple(_read(role, entry) for entry in value)
    return value
