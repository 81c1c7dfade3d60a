"""Stores of sweeps that are damaged, absurd, or lead elsewhere."""

import json
import random
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from hostile_input import Input

import softafm as sa
from softafm.sweeps.store import Store


def of_stores(chance: random.Random) -> Iterator[Input]:
    yield store_input("sound", lambda store: None, 0)
    names = ("x", "sum", "state", "reason", "warning")
    keys = ("zarr_format", "shape", "chunks", "dtype", "order", "compressor", "filters")
    for name in names:
        for key in keys:
            yield store_input("a key missing", metadata(name, key, None, drop=True))
            for value in chance.sample([[], {}, "odd", 5, -1, [-1], [10**15], 1e300], 3):
                yield store_input("an odd value", metadata(name, key, value))
        yield store_input("another codec", metadata(name, "filters", [{"id": "pickle"}]))
        yield store_input("a link", linked(name))
    for file in (".zattrs", ".zmetadata"):
        for _ in range(12):
            yield store_input("cut off", cut(file, chance.random()))
        for text in ("", "[]", "null", "[" * 50_000, "{}", "\x00", '{"metadata": 1}'):
            yield store_input("metadata that are none", overwritten_text(file, text))
        yield store_input("a file missing", lambda store, file=file: (store / file).unlink())
        yield store_input("a link", linked(file))
    yield store_input("no folder", lambda store: store.rename(store.with_name("other")))


def store_input(kind: str, change: Callable[[Path], None], code: int = 2) -> Input:
    def make(folder: Path) -> None:
        made = sound_store()
        for path, content in made.items():
            (folder / "s.zarr" / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / "s.zarr" / path).write_bytes(content)
        change(folder / "s.zarr")

    return Input(f"store, {kind}", make, ("sweep", "--status", "s.zarr"), code)


@cache
def sound_store() -> dict[str, bytes]:
    """Return the files of a small store, by name."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "s.zarr"
        sa.sweep(lambda x: {"sum": x}, {"x": [1.0, 2.0, 3.0]}, workers=0, store=path)
        assert Store(path).missing() == []
        found = [each for each in path.rglob("*") if each.is_file()]
        return {str(each.relative_to(path)): each.read_bytes() for each in found}


def metadata(name: str, key: str, value: object, drop: bool = False) -> Callable[[Path], None]:
    def change(store: Path) -> None:
        told = json.loads((store / ".zmetadata").read_text())
        array = told["metadata"][f"{name}/.zarray"]
        array[key] = value
        if drop:
            del array[key]
        (store / ".zmetadata").write_text(json.dumps(told))

    return change


def linked(name: str) -> Callable[[Path], None]:
    def change(store: Path) -> None:
        (store / name).rename(store.with_name("elsewhere"))
        (store / name).symlink_to(store.with_name("elsewhere"))

    return change


def cut(file: str, part: float) -> Callable[[Path], None]:
    def change(store: Path) -> None:
        content = (store / file).read_bytes()
        (store / file).write_bytes(content[: int(part * (len(content) - 1))])

    return change


def overwritten_text(file: str, text: str) -> Callable[[Path], None]:
    return lambda store: (store / file).write_text(text)
