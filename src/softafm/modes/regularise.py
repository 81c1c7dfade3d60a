"""The range of a surface law, enlarged as asked for, or where a contact is too soft for its own."""

import json
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from softafm.checks.kinds import refuse_other
from softafm.checks.validate import LARGEST_TABOR, check_tabor
from softafm.contact import Contact
from softafm.errors import AccuracyWarning, DivergedError
from softafm.instrument.agreement import check_motion
from softafm.instrument.motion import is_steady
from softafm.modes.check import find_differences, record_warning, run_again
from softafm.modes.start import refuse_start_inside
from softafm.progress import Progress
from softafm.results.datasets import compute_edge_slowing
from softafm.units.quantities import write_quantity

if TYPE_CHECKING:
    from xarray import Dataset

    from softafm.modes.mode import Mode
    from softafm.modes.scales import Scales

Regularise = float | Literal["auto"] | None
"""The option ``regularise`` of modes."""

CHOSEN, COARSER = 1 / 2, 1 / 4
"""Tabor number that a contact beyond its largest is given, in that, and that of a second run, which
tells by how much the range still matters: both well within reach."""
_ROUNDING = 1 + 1e-6
"""What was regularised to the largest number is not beyond it."""


def is_beyond(contact: Contact, mode: "Mode", motion: Any) -> bool:
    """Return whether a contact gets so soft in a motion that the solver may not succeed.

    A sample that would soften long after the end is not soft.
    """
    largest = contact.largest_tabor * _ROUNDING
    if contact.tabor_softened <= largest:
        return False
    if mode.simulate is not None:
        return True
    path = mode.path(motion)
    check_motion(path)
    if is_steady(path):
        return True
    duration = float(path.breaks[-1] - path.breaks[0])
    stiffer = 1 / (contact.softened_modulus * float(contact.body.compliance.at(duration)))
    return contact.tabor_softened * max(1.0, stiffer) ** (-2 / 3) > largest


def choose_tabor(
    contact: Contact, regularise: Regularise, mode: "Mode", motion: Any
) -> float | None:
    """Return the Tabor number to which a contact is lowered in a mode; None if its law stays.

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
    if not is_beyond(contact, mode, motion):
        return None
    try:
        longer = contact.regularised(COARSER * contact.largest_tabor)
        if mode.simulate is None:
            refuse_start_inside(longer, mode.path(motion))
    except ValueError:  # not every law can be stretched, nor farther than the tip is away at first
        return None
    return CHOSEN * contact.largest_tabor


def regularise_contact(
    contact: Contact, regularise: Regularise, mode: "Mode", motion: Any
) -> Contact:
    """Return the contact that is computed with an option ``regularise``; ValueError as before."""
    tabor = choose_tabor(contact, regularise, mode, motion)
    return contact if tabor is None else contact.regularised(tabor)


def doubt_softness(contact: Contact, mode: "Mode", motion: Any) -> tuple[AccuracyWarning, ...]:
    """Return what is to be warned of before a contact is computed, or nothing."""
    if not is_beyond(contact, mode, motion):
        return ()
    tabor = contact.tabor_softened
    text = (
        f"the surface law '{contact.surface.kind}' is taken as it is at a Tabor number of "
        f"{tabor:.3g}; beyond {contact.largest_tabor:g} the solver may not succeed"
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
    coarser = COARSER * given.largest_tabor
    again = partial(repeat, given.regularised(coarser))
    try:
        other = run_again(again, progress, f"at a Tabor number of {coarser:g}")
    except DivergedError as error:
        known = f"the run at {coarser:g} that tells the error failed: {error}"
        largest = np.nan
    else:
        found = find_differences(mode, result, other, scales(other))
        errors = {name: difference.relative for name, difference in found.items()}
        worst = max(errors, key=lambda name: abs(errors[name]), default="")
        largest = abs(errors.get(worst, np.nan))
        known = f"by a run at {coarser:g} it is off by up to {100 * largest:.2g} % ({worst})"
    result.attrs |= {"regularised_errors": json.dumps(errors), "regularised_error": largest}
    contact = given.regularised(CHOSEN * given.largest_tabor)
    record_warning(result, tell_choice(given, contact, largest, known))


def tell_choice(given: Contact, contact: Contact, error: float, known: str) -> AccuracyWarning:
    """Return the warning that a contact was regularised by itself, and what is known of the error.

    ``error`` is the largest, over its scale, and ``known`` says it in words.
    """
    before, after = (write_quantity(each.surface.range, "m") for each in (given, contact))
    slower = compute_edge_slowing(given, contact.surface.range)
    text = (
        f"regularised by itself: the Tabor number of {given.tabor_softened:.3g} is beyond "
        f"{given.largest_tabor:g}, and was lowered to {contact.tabor_softened:.3g} by a range of "
        f"{after} in place of {before}; {known}"
    )
    if slower > 1:
        text += f"; the edge is {slower:.2g} times slower in cohesive lengths, which adds to that"
    return AccuracyWarning(f"{text}; regularise=None keeps the law", error)
