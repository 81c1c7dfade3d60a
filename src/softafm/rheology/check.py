"""What a sample must be, where a class of the user's own states it."""

from typing import Any

import numpy as np

from softafm.checks.kinds import check_kind, is_built_in
from softafm.checks.refusals import show
from softafm.checks.validate import check_finite, check_poisson_ratio, check_positive
from softafm.rheology.compliance import CreepCompliance
from softafm.rheology.lists import check_count, check_positives

_SOFTEST = 1e6
"""Largest compliance that any material has, 1/Pa: moduli in its place are above it."""


def check_sample(name: str, sample: Any) -> None:
    """Raise ValueError if a sample of a class of the user's own has no name or no creep."""
    if is_built_in(sample):
        return
    check_kind(name, sample)
    check_poisson_ratio(sample.poisson, f"{name}.poisson")
    check_compliance(f"{name}.compliance", sample.compliance)


def check_compliance(name: str, creep: Any) -> None:
    """Raise ValueError if a creep compliance is none, or no material can have it."""
    if not isinstance(creep, CreepCompliance):
        raise ValueError(f"{name} = {show(creep)}: must be a softafm.rheology.CreepCompliance")
    instantaneous = check_positive(f"{name}.instantaneous", creep.instantaneous, "1/Pa")
    elements = check_positives(f"{name}.elements", creep.elements, "1/Pa")
    times = check_positives(f"{name}.retardation_times", creep.retardation_times, "s")
    check_count(f"{name}.retardation_times", times, f"{name}.elements", elements)
    if check_finite(f"{name}.fluidity", creep.fluidity, "1/(Pa s)") < 0:
        raise ValueError(f"{name}.fluidity = {creep.fluidity:g} 1/(Pa s): must not be negative")
    largest = float(np.max([instantaneous, *elements]))
    if largest > _SOFTEST:
        raise ValueError(
            f"{name} = {largest:g} 1/Pa: must be at most {_SOFTEST:g} 1/Pa, the inverse of a "
            "modulus; is it a modulus?"
        )
