"""Pixels whose contact is too soft for its surface law: what is computed, and how far it is off."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from softafm.checks.gathering import Placed
from softafm.contact import Contact
from softafm.modes import Mode
from softafm.modes.regularise import (
    COARSER,
    Regularise,
    doubt_softness,
    regularise_contact,
    tell_choice,
)

_LEAST = 0.01
"""Part of the largest value of a map below which another does not count by itself."""


def regularise_further(
    contact: Contact, regularise: Regularise, mode: Mode, motion: Any
) -> Contact:
    """Return a contact for the run that tells the error: the same, if none is to be told."""
    found = regularise_contact(contact, regularise, mode, motion)
    if regularise == "auto" and found is not contact:
        return contact.regularised(COARSER * contact.largest_tabor)
    return found


def doubt_soft_pixels(contacts: Sequence[Contact], mode: Mode, motion: Any) -> list[Placed]:
    """Return the warnings of contacts that are computed with laws too short for the solver."""
    return [
        (i, doubt)
        for i, each in enumerate(contacts)
        for doubt in doubt_softness(each, mode, motion)
    ]


def estimate_errors(
    given: Sequence[Contact],
    contacts: Sequence[Contact],
    number: np.ndarray,
    names: Sequence[str],
    values: np.ndarray,
    other: np.ndarray,
) -> Iterator[Placed]:
    """Yield by how much each contact that was regularised by itself may be off.

    Parameters
    ----------
    given, contacts
        The contacts before and as they were computed, n each.
    number
        Which contact each pixel is, shape (y, x).
    names, values, other
        The m maps, and those at half the Tabor number, each of shape (y, x, m).
    """
    size = np.abs(other)
    least = _LEAST * np.nanmax(size, axis=(0, 1), initial=0.0, where=~np.isnan(size))
    scale = np.maximum(size, least)
    errors = np.abs(values - other) / np.where(scale > 0, scale, 1.0)
    for i, (before, contact) in enumerate(zip(given, contacts, strict=True)):
        if contact is before:
            continue
        found = errors[number == i][0]
        tabor = COARSER * before.largest_tabor
        largest, known = np.nan, f"a run at {tabor:g} to tell the error has no result"
        if not np.isnan(found).all():
            worst = int(np.nanargmax(found))
            largest, name = float(found[worst]), names[worst]
            known = f"by a run at {tabor:g} it is off by up to {100 * largest:.2g} % ({name})"
        yield i, tell_choice(before, contact, largest, known)
