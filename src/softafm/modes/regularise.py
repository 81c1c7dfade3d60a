"""The range of a surface law, enlarged as asked for, or where a contact is too soft for its own."""

import json
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Literal

import numpy as np

from softafm.checks.kinds import refuse_other
from softafm.checks.validate import LARGEST_TABOR, check_tabor
from softafm.contact import Contact
from softafm.errors import AccuracyWarning, DivergedError
from softafm.modes.check import find_differences, record_warning, run_again
from softafm.progress import Progress
from softafm.results.datasets import compute_edge_slowing
from softafm.units.quantities import write_quantity

if TYPE_CHECKING:
    from xarray import Dataset

    from softafm.modes.mode import Mode
    from softafm.modes.scales import Scales

Regularise = float | Literal["auto"] | None
"""The option ``regularise`` of modes."""

CHOSEN, COARSER = LARGEST_TABOR / 2, LARGEST_TABOR / 4
"""Tabor number that a contact beyond the largest is given, and that of a second run, which tells
by how much the range still matters: both well within reach."""
_ROUNDING = 1 + 1e-6
"""What was regularised to the largest number is not beyond it."""


def is_beyond(contact: Contact) -> bool:
    """Return whether a contact is so soft that the solver may not succeed with its law."""
    return contact.tabor_softened > LARGEST_TABOR * _ROUNDING


def choose_tabor(contact: Contact, regularise: Regularise) -> float | None:
    """Return the Tabor number to which a contact is to be lowered; None if its law stays.

    ValueError if it is no contact, or the option is none such.
    """
    refuse_other("contact", contact, Contact, "a softafm.Contact")
    if regularise is None:
        return None
    if not isinstance(regularise, str):
        return check_tabor("regularise", regularise)
    if regularise != "auto":
        raise ValueError(
            f"regularise = {regularise!r}: must be a number from 0.1 to {LARGEST_TABOR:g}, 'auto' "
            "or None"
        )
    if not is_beyond(contact):
        return None
    try:
        contact.regularised(COARSER)
    except ValueError:  # not every law can be stretched, nor to every length
        return None
    return CHOSEN


def regularise_contact(contact: Contact, regularise: Regularise) -> Contact:
    """Return the contact that is computed with an option ``regularise``; ValueError as before."""
    tabor = choose_tabor(contact, regularise)
    return contact if tabor is None else contact.regularised(tabor)


def doubt_softness(contact: Contact) -> tuple[AccuracyWarning, ...]:
    """Return what is to be warned of before a contact is computed, or nothing."""
    if not is_beyond(contact):
        return ()
    tabor = contact.tabor_softened
    text = (
        f"the surface law '{contact.surface.kind}' is taken as it is at a Tabor number of "
        f"{tabor:.3g}; beyond {LARGEST_TABOR:g} the solver may not succeed"
    )
    return (AccuracyWarning(text, tabor),)


def estimate_error(
    mode: "Mode",
    result: "Dataset",
    given: Contact,
    scales: Callable[["Dataset"], "Scales"],
    repeat: Callable[..., "Dataset"],
    progress: bool | Progress | None,
) -> None:
    """Write into a result by how much a contact regularised by itself may be off, and warn.

    The error of an observable is its difference from a run at half the Tabor number, over its
    scale: ``regularised_errors``, JSON, and ``regularised_error``, the largest without its sign,
    NaN if that run failed.

    Parameters
    ----------
    mode, result, given
        What was run, what it gave, and the contact as it was before.
    scales
        Function of the other result that returns the ``Scales``.
    repeat
        Function of a contact that runs it as it is, with ``progress``.
    progress
        As for the mode.
    """
    errors: dict[str, float] = {}
    again = partial(repeat, given.regularised(COARSER))
    try:
        other = run_again(again, progress, f"at a Tabor number of {COARSER:g}")
    except (DivergedError, ValueError) as error:
        known = f"the run at {COARSER:g} that tells the error failed: {error}"
        largest = np.nan
    else:
        found = find_differences(mode, result, other, scales(other))
        errors = {name: difference.relative for name, difference in found.items()}
        worst = max(errors, key=lambda name: abs(errors[name]), default="")
        largest = abs(errors.get(worst, np.nan))
        known = f"by a run at {COARSER:g} results are off by up to {100 * largest:.2g} % ({worst})"
    result.attrs |= {"regularised_errors": json.dumps(errors), "regularised_error": largest}
    slower = compute_edge_slowing(given, result.attrs["regularised_range"])
    before, after = (
        write_quantity(result.attrs[name], "m") for name in ("given_range", "regularised_range")
    )
    text = (
        f"regularised by itself: the Tabor number of {given.tabor_softened:.3g} is beyond "
        f"{LARGEST_TABOR:g}, and was lowered to {CHOSEN:g} by a range of {after} in place of "
        f"{before}; {known}"
    )
    if slower > 1:
        text += f"; the edge is {slower:.2g} times slower in cohesive lengths, which adds to that"
    record_warning(result, AccuracyWarning(f"{text}; regularise=None keeps the law", largest))
