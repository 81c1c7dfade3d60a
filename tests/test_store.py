"""Stores: blocks written whole, read by xarray, and noticed when damaged."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
import xarray
from hypothesis import given
from hypothesis import strategies as st

from softafm.campaigns.block import DONE, FAILED, UNKNOWN, WARNED, Block
from softafm.campaigns.campaign import Campaign, Observable
from softafm.campaigns.progress import in_words, status
from softafm.campaigns.store import Busy, Store, StoreError, blocks_of, create, differences
from softafm.campaigns.sweep import load_sweep

SHAPE = (3, 7)


def campaign(**changes):
    known = {
        "dimensions": ("a", "b"),
        "shape": SHAPE,
        "coordinates": {
            "a": (("a",), np.array([1.0, 2.0, 4.0]), {"units": "m"}),
            "word": (("b",), np.array(list("uvwxyzµ")), {}),
            "k": (("k",), np.array([0, 1]), {}),
        },
        "observables": (
            Observable("one", "N", "a force"),
            Observable("two", "J", "", ("k",), (2,)),
        ),
        "point": lambda index: index,
        "run": dict,
        "identity": {"of": {"what": 1}},
    }
    return Campaign(**{**known, **changes})


def block_of(store, number):
    """A block whose values tell where they belong; a run of the first failed, one warned."""
    index = np.array(list(np.ndindex(*map(len, store.ranges(number)))))
    index += [r[0] for r in store.ranges(number)]
    one = index @ [10.0, 1.0]
    block = Block(np.full(len(one), DONE, np.uint8), {"one": one, "two": np.stack([one, -one], 1)})
    if number == 0:
        block.state[:2] = FAILED, WARNED
        block.reasons[0], block.warnings[1] = "it µst fail", "it may"
        block.values["one"][0] = np.nan
    return block


@pytest.fixture
def store(tmp_path):
    """A store of 6 blocks, all written."""
    store = create(tmp_path / "s.zarr", campaign(), 4)
    assert (store.block, store.block_count) == ((1, 4), 6)
    for number in range(6):
        store.write(number, block_of(store, number))
    return store


def test_xarray_opens_it_as_the_dataset_that_it_is(store):
    found = xarray.open_zarr(store.path).load()
    expected = np.add.outer([0.0, 10.0, 20.0], np.arange(7.0))
    expected[0, 0] = np.nan
    np.testing.assert_array_equal(found["one"], expected)
    np.testing.assert_array_equal(found["two"][1:, :, 1], -expected[1:])
    assert found["two"].dims == ("a", "b", "k")
    assert found["one"].attrs == {"units": "N", "long_name": "a force"}
    assert set(found.coords) == {"a", "word", "k"}
    assert found["a"].values.tolist() == [1, 2, 4]
    assert found["a"].attrs["units"] == "m"
    assert found["word"].values.tolist() == list("uvwxyzµ")
    assert found["state"].dtype == np.uint8
    assert found["state"].values[0].tolist() == [FAILED, WARNED, DONE, DONE, DONE, DONE, DONE]
    assert str(found["reason"].values[0, 0]) == "it µst fail"
    assert [str(text) for text in found["warning"].values[0, :3]] == ["", "it may", ""]
    assert str(found["reason"].values[2, 6]) == ""
    assert xarray.testing.assert_identical(found, load_sweep(store.path)) is None


def test_what_is_not_written_is_nan_and_not_run(tmp_path):
    store = create(tmp_path / "s.zarr", campaign(), 4)
    store.write(1, block_of(store, 1))
    found = load_sweep(store.path)
    assert found["state"].values[0].tolist() == [UNKNOWN] * 4 + [DONE] * 3
    assert np.isfinite(found["one"].values).sum() == 3
    assert store.missing() == [0, 2, 3, 4, 5]


@pytest.mark.parametrize("name", ["one/0.0", "two/0.0.0", "reason/0.0", "warning/0.0", "state/0.0"])
@pytest.mark.parametrize("damage", ["truncated", "empty", "flipped", "missing"])
def test_a_damaged_chunk_is_noticed(store, name, damage):
    assert store.missing() == []
    file = store.path / name
    content = bytearray(file.read_bytes())
    if damage == "missing":
        file.unlink()
    elif damage == "flipped":
        content[-6] ^= 1
        file.write_bytes(content)
    else:
        file.write_bytes(content[: len(content) // 2 if damage == "truncated" else 0])
    assert store.missing() == [0]
    if damage != "missing":
        with pytest.raises(ValueError, match=r"s\.zarr: is damaged .* resume the sweep"):
            load_sweep(store.path)


def test_a_chunk_appears_whole_or_not_at_all(store, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    before = (store.path / "one/0.0").read_bytes()
    monkeypatch.setattr(os, "replace", full)
    block = block_of(store, 0)
    block.values["one"] += 1
    with pytest.raises(OSError, match="No space"):
        store.write(0, block)
    assert (store.path / "one/0.0").read_bytes() == before
    assert not list(store.path.rglob("*.part"))


def test_one_process_writes_at_a_time(store):
    assert not store.in_use
    (store.path / "one/0.0.part").write_bytes(b"half")
    with store.writing():
        assert not (store.path / "one/0.0.part").exists()
        assert store.in_use
        with pytest.raises(Busy, match="another process is at work"), Store(store.path).writing():
            pass
    assert not store.in_use


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"identity": {"of": {"what": 2}}}, "of.what is 2, and was 1"),
        ({"identity": {"of": {}}}, "of.what is missing"),
        ({"identity": {"of": {"what": 1}, "more": 3}}, "more is new"),
        ({"shape": (3, 8)}, "it had 3 of a × 7 of b, and now 3 of a × 8 of b"),
        (
            {"coordinates": {"a": (("a",), np.array([1.0, 2.0, 5.0]), {})}},
            "the values of a were others",
        ),
    ],
)
def test_another_campaign_is_told_from_the_one_that_began_it(store, changes, words):
    assert differences(store, campaign()) is None
    assert differences(store, campaign(**changes)) == words


def test_what_is_no_store_is_refused(tmp_path, store):
    (tmp_path / "folder").mkdir()
    for path, words in (("none", "no such store"), ("folder", "is no store of a sweep")):
        with pytest.raises(StoreError, match=f"{path}: {words}"):
            Store(tmp_path / path)
    attributes = {**store.attributes, "format": "another"}
    (store.path / ".zattrs").write_text(json.dumps(attributes), encoding="utf-8")
    with pytest.raises(StoreError, match="is no store of a sweep"):
        Store(store.path)


@given(st.lists(st.integers(1, 50), min_size=1, max_size=4), st.integers(1, 200))
def test_blocks_are_no_larger_than_asked_and_cut_the_first_axes_first(shape, runs):
    block = blocks_of(shape, runs)
    assert np.prod(block) <= runs
    assert all(1 <= b <= n for b, n in zip(block, shape, strict=True))
    cut = [axis for axis, (b, n) in enumerate(zip(block, shape, strict=True)) if b < n]
    # Before the last axis that is cut, an axis has more than one only if it still had room.
    for axis in cut:
        inner = int(np.prod(block[axis + 1 :]))
        assert block[axis] <= runs // inner
        assert 2 * block[axis] > min(shape[axis], runs // inner)


def test_the_status_is_read_from_the_store_alone(store, tmp_path):
    for number in range(6):
        file = store.path / "state" / ".".join(map(str, divmod(number, 2)))
        os.utime(file, (1000.0 + 2 * number, 1000.0 + 2 * number))
    os.utime(store.path / ".lock", (998.0, 998.0))
    Path(store.path / "state/2.1").unlink()
    found = status(store.path)
    assert (found.runs, found.done, found.failed, found.warned) == (21, 18, 1, 1)
    assert found.rate == pytest.approx(18 / 10)
    assert found.seconds_left == pytest.approx(3 / 1.8)
    assert found.example == "a[0], b[0]: it µst fail"
    assert not found.running
    fresh = status(create(tmp_path / "new.zarr", campaign(), 4).path)
    assert (fresh.done, fresh.rate, fresh.seconds_left) == (0, None, None)


def test_durations_in_words():
    told = [in_words(seconds) for seconds in (3, 119, 300, 9000, 1e6)]
    assert told == ["3 s", "119 s", "5 min", "2 h", "12 days"]
