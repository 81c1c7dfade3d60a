"""Damaged and hostile inputs by the hundred: one line each, in time, and nothing touched."""

import random
from collections import Counter

import hostile
import pytest

from softafm.files import guard
from softafm.results import datasets as results


@pytest.mark.parametrize(
    "family", [hostile.of_results, hostile.of_experiments, hostile.of_tables, hostile.of_stores]
)
def test_hostile_inputs_are_refused_and_touch_nothing(
    family, tmp_path, monkeypatch, record_property
):
    """Results are read here, and every fortieth apart as users have it: each start takes 0.4 s."""
    apart, count = results.load_apart, 0

    def load(path, **options):
        nonlocal count
        count += 1
        return (apart if count % 40 == 1 else results.load)(path, **options)

    monkeypatch.setattr(results, "load_apart", load)
    kinds, wrong = Counter(), []
    for number, one in enumerate(family(random.Random(hostile.SEED))):
        folder = tmp_path / str(number)
        folder.mkdir()
        found = hostile.complaint(one, folder)
        kinds[one.kind] += 1
        if found is not None:
            wrong.append(f"{one.kind}, {' '.join(one.arguments)}: {found}")
    assert wrong == []
    record_property(f"hostile inputs, {family.__name__}", f"{kinds.total()} of {len(kinds)} kinds")


def test_there_are_more_than_five_hundred_and_a_seed_makes_the_same():
    kinds = [one.kind for one in hostile.inputs(1)]
    assert len(kinds) >= 500
    assert kinds == [one.kind for one in hostile.inputs(1)]
    assert guard.SECONDS < hostile.LONGEST
