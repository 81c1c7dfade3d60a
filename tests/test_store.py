"""Stores: blocks written whole, read by xarray, and noticed when damaged."""

import json
import os
import time
from pathlib import Path

import numpy as np
import pytest
import xarray
from hypothesis import given
from hypothesis import strategies as st

from softafm.sweeps import store as store_module
from softafm.sweeps.block import DONE, FAILED, UNKNOWN, WARNED, Block
from softafm.sweeps.campaign import Campaign, Observable
from softafm.sweeps.progress import describe_duration, read_status
from softafm.sweeps.store import (
    Busy,
    Store,
    StoreError,
    choose_blocks,
    create,
    describe_difference,
    read_unpacked_size,
)
from softafm.sweeps.sweep import load_sweep, open_store

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
    assert describe_difference(store, campaign()) is None
    assert describe_difference(store, campaign(**changes)) == words


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
    block = choose_blocks(shape, runs)
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
    found = read_status(store.path)
    assert (found.runs, found.done, found.failed, found.warned) == (21, 18, 1, 1)
    assert found.rate == pytest.approx(18 / 10)
    assert found.seconds_left == pytest.approx(3 / 1.8)
    assert found.example == "a[0], b[0]: it µst fail"
    assert not found.running
    fresh = read_status(create(tmp_path / "new.zarr", campaign(), 4).path)
    assert (fresh.done, fresh.rate, fresh.seconds_left) == (0, None, None)


def test_durations_in_words():
    told = [describe_duration(seconds) for seconds in (3, 119, 300, 9000, 1e6)]
    assert told == ["3 s", "119 s", "5 min", "2 h", "12 days"]


# Stores of others


def changed(store, name, change):
    """Change a part of the metadata of a store, where all of them stand."""
    path = store.path / ".zmetadata"
    told = json.loads(path.read_text(encoding="utf-8"))
    change(told["metadata"][name])
    path.write_text(json.dumps(told), encoding="utf-8")


def test_a_store_is_loaded_as_xarray_reads_it(store):
    ours, theirs = load_sweep(store.path), open_store(store).load()
    xarray.testing.assert_identical(ours, theirs)
    assert list(ours.variables) == list(theirs.variables)
    assert {n: v.dtype for n, v in ours.variables.items()} == {
        n: v.dtype for n, v in theirs.variables.items()
    }
    for file in ("one/0.1", "state/0.1", "reason/0.0"):
        (store.path / file).unlink()
    xarray.testing.assert_identical(load_sweep(store.path), open_store(store).load())


@pytest.mark.parametrize(
    ("name", "values", "words"),
    [
        (
            "one/.zarray",
            {"filters": [{"id": "pickle"}]},
            "'one' is kept in a way that softafm does",
        ),
        ("one/.zarray", {"compressor": {"id": "lzma"}}, "'one' is kept in a way that softafm does"),
        ("one/.zarray", {"compressor": None}, "is no store of a sweep, or damaged"),
        ("reason/.zarray", {"filters": [{"id": "pickle"}]}, "'reason' is kept in a way"),
        ("one/.zarray", {"dtype": "|V8"}, "'one' is kept in a way that softafm does not write"),
        ("one/.zarray", {"dtype": "<f4"}, "'one' is not of the type or shape of its runs"),
        ("one/.zarray", {"dtype": 5}, "is no store of a sweep, or damaged"),
        ("one/.zarray", {"zarr_format": 3}, "'one' is kept in a way that softafm does not write"),
        ("one/.zarray", {"dimension_separator": "/"}, "'one' is kept in a way"),
        ("one/.zarray", {"shape": [3, -7]}, "'one' has the shape [3, -7] in [1, 4]"),
        ("one/.zarray", {"shape": [3, 7.0]}, "'one' has the shape [3, 7.0] in [1, 4]"),
        ("one/.zarray", {"chunks": [0, 4]}, "'one' has the shape [3, 7] in [0, 4]"),
        ("one/.zarray", {"shape": [3, 8]}, "'one' is not of the type or shape of its runs"),
        ("state/.zarray", {"shape": [10**12, 7]}, "is of an absurd shape, [1000000000000, 7]"),
        ("state/.zarray", {"shape": [0, 7]}, "is of an absurd shape, [0, 7]"),
        ("state/.zarray", {"shape": [10**8, 7]}, "is of an absurd shape"),
        ("state/.zarray", {"chunks": [10**6, 10**6]}, "has blocks of 1000000000000 runs"),
        ("one/.zattrs", {"units": "days since 1900-01-01"}, "has the unit 'days since 1900-01-01'"),
        ("one/.zattrs", {"scale_factor": 2.0}, "'one' is described as softafm does not"),
        ("one/.zattrs", {"units": 2.0}, "'one' is described as softafm does not"),
        ("one/.zattrs", {"_ARRAY_DIMENSIONS": ["a"]}, "'one' is described as softafm does not"),
        ("a/.zarray", {"chunks": [1]}, "its coordinate 'a' is in parts"),
    ],
)
def test_what_no_sweep_writes_is_refused_before_it_is_used(store, softafm, name, values, words):
    changed(store, name, lambda told: told.update(values))
    for attempt in (load_sweep, read_status, Store):
        with pytest.raises(StoreError) as caught:
            attempt(store.path)
        assert str(caught.value).startswith(f"{store.path}: ")
        assert words in str(caught.value)
        assert "\n" not in str(caught.value)
    assert softafm("sweep", "--status", store.path) == (2, "", f"softafm: {caught.value}\n")


@pytest.mark.parametrize(
    ("file", "content"),
    [
        (".zattrs", ""), (".zattrs", "[]"), (".zattrs", "[" * 100_000), (".zattrs", "{}"),
        (".zattrs", '{"format": "softafm sweep 1"}'), (".zmetadata", "{"), (".zmetadata", "{}"),
        (".zmetadata", '{"metadata": []}'), (".zmetadata", '{"metadata": {"state/.zarray": 1}}'),
        (".zattrs", '{"format": "softafm sweep 1", "campaign": "[]", "values": "{}"}'),
    ],
)  # fmt: skip
def test_metadata_that_make_no_sense_are_refused(store, softafm, file, content):
    (store.path / file).write_text(content)
    for attempt in (load_sweep, read_status):
        with pytest.raises(StoreError, match=r"s\.zarr: (is no store of a sweep|its campaign)"):
            attempt(store.path)
    code, out, said = softafm("sweep", "--status", store.path)
    assert (code, out, said.count("\n")) == (2, "", 1)


@pytest.mark.parametrize("name", ["../outside", "a/../../outside", "..", "/tmp/x", ".hidden"])
def test_names_do_not_lead_out_of_a_store(store, name):
    path = store.path / ".zmetadata"
    told = json.loads(path.read_text(encoding="utf-8"))
    told["metadata"] |= {f"{name}/{kind}": told["metadata"][f"a/{kind}"] for kind in
                         (".zarray", ".zattrs")}  # fmt: skip
    path.write_text(json.dumps(told), encoding="utf-8")
    with pytest.raises(StoreError, match="has an array named"):
        load_sweep(store.path)


@pytest.mark.parametrize("place", ["one/0.0", "a/0", "one", ".zattrs", "new"])
def test_links_are_not_followed(store, tmp_path, place):
    """Not even to a part of the store as it should be."""
    file = store.path / place
    if file.exists():
        file.rename(tmp_path / "outside")
    file.symlink_to(tmp_path / "outside")
    with pytest.raises(StoreError, match="is a link, which no store of a sweep holds"):
        load_sweep(store.path)


def test_a_chunk_that_stands_for_more_than_it_may_is_not_unpacked(store, monkeypatch):
    """Of zeros a few bytes stand for many; their frame says so."""
    packed = store_module._CODEC.encode(bytes(50_000_000))
    assert len(packed) < 10_000
    assert read_unpacked_size(packed) == 50_000_000
    (store.path / "one/0.0").write_bytes(packed)
    (store.path / "reason/0.0").write_bytes(packed)
    monkeypatch.setattr(store_module, "_LARGEST_TEXTS", 1000)
    assert store.missing() == [0]
    with pytest.raises(StoreError, match=r"is damaged \(one: 0.0 has 50000000 bytes unpacked\)"):
        load_sweep(store.path)
    for size in (0, 100, 300, 70_000):
        assert read_unpacked_size(store_module._CODEC.encode(bytes(size))) == size
    for odd in (b"", b"odd", packed[:5], b"\x28\xb5\x2f\xfd\x00\x00\x00\x00"):
        with pytest.raises(ValueError, match=r"Zstandard|say what size"):
            read_unpacked_size(odd)


def test_more_than_memory_may_hold_is_not_loaded(store, monkeypatch):
    monkeypatch.setattr(store_module, "_LARGEST", 500)
    with pytest.raises(StoreError, match=r"GB unpacked, .*: open it with xarray\.open_zarr"):
        load_sweep(store.path)


def test_the_status_of_a_large_store_that_holds_nothing_is_told_at_once(store):
    shape = {"shape": [10**7, 7]}
    for name in ("state", "reason", "warning", "one"):
        changed(store, f"{name}/.zarray", lambda told: told.update(shape | {"chunks": [100, 4]}))
    changed(store, "two/.zarray", lambda told: told.update({"shape": [10**7, 7, 2],
                                                            "chunks": [100, 4, 2]}))  # fmt: skip
    started = time.monotonic()
    assert read_status(store.path).runs == 7 * 10**7
    assert time.monotonic() - started < 5


def test_what_is_in_the_folder_besides_is_left_alone(store):
    (store.path / "zarr.json").write_text("{}")
    (store.path / "one" / "notes.txt").write_text("x")
    (store.path / "state" / "99.99").write_bytes(b"x")
    assert load_sweep(store.path)["state"].shape == SHAPE
    assert read_status(store.path).runs == 21
