"""The store of a campaign: a Zarr group (format 2) on disk, written block by block.

A block is a chunk of every array. Its chunks are written whole or not at all, that of ``state``
last; each carries a checksum. So a block is either there or, whatever became of it, run again. The
chunks are written here and not by the zarr package, which takes a millisecond for each; it reads
them, as do xarray and other programs.
"""

import json
import os
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from hashlib import sha256
from math import ceil, prod
from pathlib import Path
from typing import Any

import numpy as np

from softafm.checks.refusals import show
from softafm.sweeps.block import DONE, FAILED, UNKNOWN, WARNED, Block
from softafm.sweeps.campaign import Campaign, Observable
from softafm.sweeps.extra import require
from softafm.sweeps.store_check import FORMAT, StoreError, read_metadata
from softafm.version import __version__

require("zarr", "numcodecs")
from numcodecs import VLenUTF8, Zstd  # noqa: E402

_CODEC = Zstd(level=3, checksum=True)
_TEXTS = VLenUTF8()
_STATE = {
    "long_name": "what became of the run",
    "flag_values": [UNKNOWN, DONE, FAILED, WARNED],
    "flag_meanings": "not_run done failed done_with_warning",
}
_TEXT_ARRAYS = {"reason": "why the run failed", "warning": "what the run warns of"}
_EMPTY = {"state": UNKNOWN, "reason": "", "warning": ""}
"""What stands for runs not done, where that is not NaN."""
_TEXT: Any = getattr(np.dtypes, "StringDType", lambda: object)()
"""Type of texts in memory, as Zarr has them."""
_LARGEST, _LARGEST_TEXTS = 4_000_000_000, 200_000_000
"""Sizes of what is loaded at once, and of the texts of a block, bytes."""
RESERVED = ("state", *_TEXT_ARRAYS)
"""Names of variables that every store has besides its observables."""


class Busy(StoreError):
    """A store that another process is writing."""


def choose_blocks(shape: Sequence[int], runs: int) -> tuple[int, ...]:
    """Return the shape of blocks of about ``runs`` runs: whole last axes, the rest divided."""
    block: list[int] = []
    for size in reversed(shape):
        parts = ceil(size / max(1, runs // prod(block)))
        block.insert(0, ceil(size / parts))
    return tuple(block)


class Store:
    """A campaign's runs on disk, of which one process at a time writes.

    Parameters
    ----------
    path
        Folder of the store, which exists: see ``create``.

    Raises
    ------
    StoreError
        If it is not the store of a sweep.
    """

    def __init__(self, path: Path):
        self.path = Path(path)
        self.attributes, self._arrays, self._described = read_metadata(self.path)
        self.shape = tuple(self._arrays["state"]["shape"])
        self.block = tuple(self._arrays["state"]["chunks"])
        self.dimensions = tuple(self._described["state"]["_ARRAY_DIMENSIONS"])
        self._observables = self.attributes["observables"]

    @property
    def size(self) -> int:
        """The number of runs."""
        return prod(self.shape)

    @property
    def _counts(self) -> tuple[int, ...]:
        return tuple(ceil(n / b) for n, b in zip(self.shape, self.block, strict=True))

    @property
    def block_count(self) -> int:
        """The number of blocks."""
        return prod(self._counts)

    def ranges(self, number: int) -> tuple[range, ...]:
        """Return which indices along each dimension a block has."""
        return tuple(
            range(i * b, min((i + 1) * b, n))
            for i, b, n in zip(self._position(number), self.block, self.shape, strict=True)
        )

    def _position(self, number: int) -> tuple[int, ...]:
        return tuple(map(int, np.unravel_index(number, self._counts)))

    def write(self, number: int, block: Block) -> None:
        """Write a block; OSError if the disk is full, and the store is as it was."""
        for name in self._observables:
            self._write(name, number, block.values[name])
        for name, texts in (("reason", block.reasons), ("warning", block.warnings)):
            if texts:
                values = np.full(block.state.size, "", dtype=object)
                for run, text in texts.items():
                    values[run] = text
                self._write(name, number, values)
        self._write("state", number, block.state)

    def _write(self, name: str, number: int, values: np.ndarray) -> None:
        """Write a chunk of an array, filled up to its full size where the array ends."""
        array = self._arrays[name]
        ranges, chunks = self.ranges(number), tuple(array["chunks"])
        values = values.reshape(*map(len, ranges), *chunks[len(ranges) :])
        if values.shape != chunks:
            full = np.full(chunks, _EMPTY.get(name, np.nan), dtype=values.dtype)
            full[tuple(slice(n) for n in values.shape)] = values
            values = full
        if array["dtype"] == "|O":
            content = _TEXTS.encode(values.ravel())
        else:
            content = np.ascontiguousarray(values, dtype=array["dtype"])
        _write_whole(self._file(name, number), _CODEC.encode(content))

    def _file(self, name: str, number: int) -> Path:
        further = len(self._arrays[name]["chunks"]) - len(self.shape)
        key = ".".join(map(str, (*self._position(number), *(0,) * further)))
        return self.path / name / key

    def list_begun_blocks(self) -> list[int]:
        """Return the numbers of the blocks of which anything is known, in order."""
        return sorted(self._numbers("state"))

    def _numbers(self, name: str) -> list[int]:
        """Return the numbers of the blocks of which an array has a chunk."""
        depth = len(self.shape)
        keys = (entry.split(".") for entry in os.listdir(self.path / name))
        whole = (key for key in keys if len(key) >= depth and all(map(_is_index, key)))
        places = (tuple(map(int, key[:depth])) for key in whole)
        counts = self._counts
        return [
            int(np.ravel_multi_index(place, counts))
            for place in places
            if all(i < n for i, n in zip(place, counts, strict=True))
        ]

    def state(self, number: int) -> np.ndarray:
        """Return what became of the runs of a block, flat; all unknown if that is not known."""
        sizes = tuple(map(len, self.ranges(number)))
        found = self._read("state", number)
        if found is None or found.max(initial=UNKNOWN) > WARNED:
            return np.full(prod(sizes), UNKNOWN, np.uint8)
        return found.reshape(self.block)[tuple(slice(n) for n in sizes)].ravel()

    def _read(self, name: str, number: int) -> np.ndarray | None:
        """Return the values of a chunk, flat; None if it is missing or damaged."""
        try:
            return self._decode(name, self._file(name, number))
        except (FileNotFoundError, RuntimeError, ValueError):
            return None

    def _decode(self, name: str, file: Path) -> np.ndarray:
        """Return the values of a chunk, flat; RuntimeError or ValueError if it is damaged."""
        array = self._arrays[name]
        packed, count = file.read_bytes(), prod(array["chunks"])
        texts = array["dtype"] == "|O"
        size = read_unpacked_size(packed)
        if size > _LARGEST_TEXTS if texts else size != count * np.dtype(array["dtype"]).itemsize:
            raise ValueError(f"{file.name} has {size} bytes unpacked")
        content = _CODEC.decode(packed)
        if not texts:
            return np.frombuffer(content, dtype=array["dtype"])
        values = _TEXTS.decode(content)
        if values.size != count:
            raise ValueError(f"{file.name} has {values.size} texts, not {count}")
        return values

    def load(self) -> dict[str, tuple[list[str], np.ndarray, dict[str, Any]]]:
        """Return all arrays by name: dimensions, values and attributes; NaN where nothing is known.

        Raises
        ------
        StoreError
            If a part is damaged, or all would take more memory than 4 GB.
        """
        size = sum(
            prod(array["shape"]) * np.dtype(array["dtype"]).itemsize
            for array in self._arrays.values()
        )
        if size > _LARGEST:
            raise StoreError(
                f"{self.path}: has {size / 1e9:.3g} GB unpacked, and at most {_LARGEST / 1e9:g} GB "
                "are loaded: open it with xarray.open_zarr, which reads what is asked for"
            )
        found = {}
        over_runs = (*self._observables, *RESERVED)
        for name in sorted(self._described, key=lambda name: name not in over_runs):
            attributes = self._described[name]
            described = {
                key: each for key, each in attributes.items() if key != "_ARRAY_DIMENSIONS"
            }
            found[name] = (attributes["_ARRAY_DIMENSIONS"], self._load_array(name), described)
        return found

    def _load_array(self, name: str) -> np.ndarray:
        array = self._arrays[name]
        try:
            if name not in (*self._observables, *RESERVED):
                file = self.path / name / ".".join("0" * max(1, len(array["shape"])))
                return self._decode(name, file).reshape(array["shape"]).copy()
            kind = _TEXT if array["dtype"] == "|O" else array["dtype"]
            full = np.full(array["shape"], _EMPTY.get(name, np.nan), kind)
            for number in self._numbers(name):
                values = self._decode(name, self._file(name, number)).reshape(array["chunks"])
                place = tuple(slice(r.start, r.stop) for r in self.ranges(number))
                full[place] = values[tuple(slice(len(r)) for r in self.ranges(number))]
        except (OSError, RuntimeError, ValueError) as error:
            reason = f"is damaged ({name}: {error}); resume the sweep to repeat what is lost"
            raise StoreError(f"{self.path}: {reason}") from None
        return full

    def is_whole(self, number: int) -> bool:
        """Whether all of a block is there and undamaged."""
        state = self.state(number)
        if not state.all():
            return False
        needed = list(self._observables)
        needed += ["reason"] if (state == FAILED).any() else []
        needed += ["warning"] if (state == WARNED).any() else []
        return all(self._read(name, number) is not None for name in needed)

    def missing(self) -> list[int]:
        """Return the numbers of the blocks that are to be run, having read all others."""
        return [number for number in range(self.block_count) if not self.is_whole(number)]

    def read_finish(self, number: int) -> float | None:
        """Return when a block was written, s since 1970; None if it was not."""
        try:
            return self._file("state", number).stat().st_mtime
        except FileNotFoundError:
            return None

    def texts(self, name: str, number: int) -> np.ndarray:
        """Return the ``reason`` or ``warning`` of each run of a block, flat."""
        sizes = tuple(map(len, self.ranges(number)))
        found = self._read(name, number)
        if found is None:
            return np.full(prod(sizes), "", dtype=object)
        return found.reshape(self.block)[tuple(slice(n) for n in sizes)].ravel()

    @contextmanager
    def writing(self) -> Iterator[None]:
        """Keep other processes from writing meanwhile; Busy if one does already."""
        with open(self._lock, "ab") as lock:
            if not _try_lock(lock):
                raise Busy(f"{self.path}: another process is using it")
            for part in self.path.glob("*/*.part"):  # of a process that was killed
                part.unlink()
            yield

    def begin(self) -> None:
        """Note that runs begin now."""
        os.utime(self._lock)

    @property
    def _lock(self) -> Path:
        return self.path / ".lock"

    @property
    def in_use(self) -> bool:
        """Whether a process is writing."""
        try:
            with open(self._lock, "ab") as lock:
                return not _try_lock(lock)
        except OSError:
            return False

    @property
    def begun(self) -> float:
        """When runs began last, s since 1970."""
        with suppress(OSError):
            return self._lock.stat().st_mtime
        return 0.0


def read_unpacked_size(packed: bytes) -> int:
    """Return the size that a frame of Zstandard says it unpacks to; ValueError if it does not.

    RFC 8878, section 3.1.1.1: a descriptor, a byte of window unless all is one segment, an
    identifier of a dictionary, and the size in 1, 2, 4 or 8 bytes.
    """
    if len(packed) < 6 or packed[:4] != b"\x28\xb5\x2f\xfd":
        raise ValueError("is not packed by Zstandard")
    descriptor = packed[4]
    single, flag = descriptor >> 5 & 1, descriptor >> 6
    length = (1 if single else 0, 2, 4, 8)[flag]
    start = 6 - single + (0, 1, 2, 4)[descriptor & 3]
    if not length or len(packed) < start + length:
        raise ValueError("does not say what size it unpacks to")
    return int.from_bytes(packed[start : start + length], "little") + (256 if flag == 1 else 0)


def _is_index(text: str) -> bool:
    return text.isascii() and text.isdigit() and len(text) < 12


def _try_lock(lock: Any) -> bool:
    """Take a lock that the system gives up with the process, where it has such; else say yes."""
    try:
        import fcntl
    except ImportError:
        return True
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _write_whole(file: Path, content: bytes) -> None:
    """Write a file whole or not at all."""
    part = file.with_name(f"{file.name}.part")
    try:
        with open(part, "wb") as out:
            out.write(content)
        os.replace(part, file)
    except BaseException:
        with suppress(OSError):
            part.unlink()
        raise


def create(path: Path, campaign: Campaign, runs: int) -> Store:
    """Make the store of a campaign, with blocks of about ``runs`` runs; it appears whole or not.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    path = Path(path)
    part = path.with_name(f".{path.name}.part")
    shutil.rmtree(part, ignore_errors=True)
    try:
        part.mkdir()
        _fill(part, campaign, choose_blocks(campaign.shape, runs))
        (part / ".lock").touch()
        part.rename(path)
    except BaseException:
        shutil.rmtree(part, ignore_errors=True)
        raise
    return Store(path)


def _fill(path: Path, campaign: Campaign, block: tuple[int, ...]) -> None:
    attributes = {
        "format": FORMAT,
        "softafm_version": __version__,
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "campaign": json.dumps(campaign.identity),
        "values": json.dumps(_hash_coordinates(campaign)),
        "observables": [observable.name for observable in campaign.observables],
    }
    metadata: dict[str, Any] = {".zgroup": {"zarr_format": 2}, ".zattrs": attributes}
    chunks: dict[str, bytes] = {}
    for name, (dimensions, values, described) in campaign.coordinates.items():
        array = np.ascontiguousarray(values)
        array = array.astype(array.dtype.newbyteorder("<"))
        metadata |= _describe_array(
            name, dimensions, array.shape, array.shape, array.dtype.str, described
        )
        chunks[f"{name}/{'.'.join('0' * array.ndim)}"] = _CODEC.encode(array)
    over = (campaign.dimensions, campaign.shape, block)
    for observable in campaign.observables:
        metadata |= _write_observable(observable, *over)
    metadata |= _describe_array("state", *over, "|u1", _STATE)
    for name, long_name in _TEXT_ARRAYS.items():
        metadata |= _describe_array(name, *over, "|O", {"long_name": long_name})
    attributes["coordinates"] = " ".join(campaign.coordinates)
    for key, content in metadata.items():
        file = path / key
        file.parent.mkdir(exist_ok=True)
        file.write_text(json.dumps(content), encoding="utf-8")
    for key, chunk in chunks.items():
        (path / key).write_bytes(chunk)
    consolidated = {"zarr_consolidated_format": 1, "metadata": metadata}
    (path / ".zmetadata").write_text(json.dumps(consolidated), encoding="utf-8")


def _write_observable(
    observable: Observable, dimensions: Sequence[str], shape: Sequence[int], block: Sequence[int]
) -> dict[str, Any]:
    attributes = {"units": observable.unit, "long_name": observable.long_name}
    return _describe_array(
        observable.name,
        (*dimensions, *observable.dimensions),
        (*shape, *observable.shape),
        (*block, *observable.shape),
        "<f8",
        {key: text for key, text in attributes.items() if text},
    )


def _describe_array(
    name: str,
    dimensions: Sequence[str],
    shape: Sequence[int],
    chunks: Sequence[int],
    dtype: str,
    attributes: Mapping[str, Any],
) -> dict[str, Any]:
    """Return the metadata of an array, with its attributes."""
    floats = dtype == "<f8"
    return {
        f"{name}/.zarray": {
            "zarr_format": 2,
            "shape": list(shape),
            "chunks": list(chunks),
            "dtype": dtype,
            "order": "C",
            "compressor": _CODEC.get_config(),
            "filters": [_TEXTS.get_config()] if dtype == "|O" else None,
            # Whatever else is filled in by a number would be masked with NaN by xarray.
            "fill_value": "NaN" if floats else None,
        },
        f"{name}/.zattrs": {"_ARRAY_DIMENSIONS": list(dimensions), **attributes},
    }


def _hash_coordinates(campaign: Campaign) -> dict[str, str]:
    """Return the SHA-256 of the values of every coordinate, by name."""
    return {
        name: sha256(f"{dims} {values.dtype.str} {values.shape}".encode() + values.tobytes())
        .hexdigest()
        for name, (dims, values, _) in campaign.coordinates.items()
    }  # fmt: skip


def describe_difference(store: Store, campaign: Campaign) -> str | None:
    """Return in what a campaign differs from the one that began a store; None if in nothing."""
    begun = json.loads(store.attributes["campaign"])
    ours = json.loads(json.dumps(campaign.identity))
    found = _find_difference(begun, ours, "")
    if found is None and (campaign.dimensions, campaign.shape) != (store.dimensions, store.shape):
        found = f"it had {_describe_sizes(store.dimensions, store.shape)}, and now "
        found += _describe_sizes(campaign.dimensions, campaign.shape)
    values = json.loads(store.attributes["values"])
    for name, digest in _hash_coordinates(campaign).items():
        if found is None and values.get(name) != digest:
            found = f"the values of {name} were different"
    return found


def _describe_sizes(dimensions: Sequence[str], shape: Sequence[int]) -> str:
    return " × ".join(f"{n} of {name}" for name, n in zip(dimensions, shape, strict=True))


def _find_difference(begun: Any, ours: Any, path: str) -> str | None:
    if isinstance(begun, dict) and isinstance(ours, dict):
        for key in {**begun, **ours}:
            name = f"{path}.{key}" if path else key
            if key not in begun or key not in ours:
                there = "is new" if key in ours else "is missing"
                return f"{name} {there}"
            if (found := _find_difference(begun[key], ours[key], name)) is not None:
                return found
        return None
    return None if begun == ours else f"{path} is {show(ours)}, and was {show(begun)}"
