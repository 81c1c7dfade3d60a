"""Results that are damaged, not ours, or point elsewhere."""

import json
import random
from collections.abc import Callable, Iterator
from pathlib import Path

import h5py
import numpy as np
from hostile_input import Input
from result_samples import NAMES, results

from softafm.results.content import NEEDED


def of_results(chance: random.Random) -> Iterator[Input]:
    for name in NAMES:
        sound, commands = saved(name), uses(name)
        yield Input("result, sound", writing(sound), commands[0], 0)
        if name in ("regularised", "force-spectroscopy", "force-volume"):  # as others are
            continue
        for change, kind in changes(name, chance):
            yield Input(f"result, {kind}", writing(sound, change), chance.choice(commands))
        for _ in range(6):
            part = sound[: chance.randrange(len(sound) - 8)]
            yield Input("result, cut off", writing(part), chance.choice(commands))
    for content in (b"", b"time,force\n0,1\n", b"\x89PNG\r\n\x1a\n" + bytes(99), bytes(5000),
                    b"CDF\x01" + bytes(99), b"\x89HDF\r\n\x1a\n", b"\x89HDF\r\n\x1a\n" + bytes(900),
                    chance.randbytes(3000), b"PK\x03\x04" + chance.randbytes(99)):  # fmt: skip
        for arguments in uses("with shapes"):
            yield Input("result, something else", writing(content), arguments)
    yield Input("result, a folder", lambda folder: (folder / "r.nc").mkdir(), uses("")[0])
    yield Input("result, none", lambda folder: None, uses("")[0])


def saved(name: str) -> bytes:
    return bytes(results()[name].to_netcdf(engine="h5netcdf"))


def uses(name: str) -> list[tuple[str, ...]]:
    found = [("plot", "r.nc", "--out", "r.png"), ("export", "r.nc", "--out", "r.h5")]
    if name == "with shapes":
        found += [("animate", "r.nc", "--out", "r.html"), ("plot", "--profiles", "r.nc")]
    return found


def writing(content: bytes, change: Callable | None = None) -> Callable[[Path], None]:
    def make(folder: Path) -> None:
        (folder / "r.nc").write_bytes(content)
        if change is not None:
            with h5py.File(folder / "r.nc", "r+") as file:
                change(file)

    return make


def changes(name: str, chance: random.Random) -> Iterator[tuple[Callable, str]]:
    """Yield changes of a file that make it none of ours, or not a whole one."""
    result = results()[name]
    mode = result.attrs["mode"]
    needed = list(NEEDED[mode].variables)
    history = "time" in result.dims
    for each in (*needed, *(dim for dim in result.dims if dim in result.coords)):
        yield without(each), "a variable missing"
    for each in chance.sample(needed, min(3, len(needed))):
        units = chance.choice(["", "furlong", "days since 1900-01-01", "\n"])
        yield attribute(each, "units", units), "another unit"
        yield attribute(each, "long_name", 5.0), "a name that is no word"
        yield attribute(each, chance.choice(["scale_factor", "add_offset"]), 2.0), "packed"
        yield renamed(each), "a variable renamed"
        yield retyped(each, np.bytes_), "a variable of texts"
        yield retyped(each, [("a", float), ("b", int)]), "a variable of pairs"
        yield retyped(each, bool), "a variable of flags"
        numbers = [np.inf, -np.inf, 1e300] + [np.nan] * history
        yield numbered(each, chance, chance.choice(numbers)), "a number that cannot be"
        if history and result[each].dims == ("time",):
            yield overwritten(each, chance), "bytes of its values overwritten"
        yield flattened(each), "other dimensions"
    for other in {*NEEDED} - {mode}:
        yield attribute(None, "mode", other), "another mode"
    odd = ["", 5.0, "{", "[]", "null", "{}", "[" * 5000, json.dumps({"mode": mode})]
    for value in (*chance.sample(odd, 4), result.attrs["experiment"][: chance.randrange(1, 200)]):
        yield attribute(None, "experiment", value), "an experiment that is none"
    misfits = [("format", "softafm result 9"), ("format", 1.0), ("warnings", 2.0),
               ("check_differences", '{"force_max": []}'), ("failures", "{}"),
               ("regularised_range", "far"), ("mode", 1.0), ("mode", "tapping")]  # fmt: skip
    for key, value in chance.sample(misfits, 4):
        yield attribute(None, key, value), "an attribute that does not fit"
    yield from chance.sample(list(pointing()), 5)


def without(name: str) -> Callable:
    return lambda file: file.__delitem__(name)


def renamed(name: str) -> Callable:
    return lambda file: file.move(name, f"{name}_2")


def attribute(name: str | None, key: str, value: object) -> Callable:
    def change(file):
        (file if name is None else file[name]).attrs[key] = value

    return change


def replaced(name: str, values: Callable) -> Callable:
    """Put other values in the place of a variable, with its dimensions and attributes."""

    def change(file):
        old = file[name]
        scales = [dict(axis.items()) for axis in old.dims]
        kept = {key: old.attrs[key] for key in ("units", "long_name")}
        new = values(old)
        del file[name]
        made = file.create_dataset(name, data=new)
        made.attrs.update(kept)
        if made.shape == old.shape:
            for axis, found in zip(made.dims, scales, strict=True):
                for scale in found.values():
                    axis.attach_scale(scale)

    return change


def retyped(name: str, kind) -> Callable:
    return replaced(name, lambda old: np.zeros(old.shape, kind))


def flattened(name: str) -> Callable:
    return replaced(name, lambda old: np.zeros((2, 3, 5)))


def numbered(name: str, chance: random.Random, number: float) -> Callable:
    place = chance.random()

    def values(old):
        changed = np.array(old[()], float)
        if changed.size:
            changed.flat[int(place * changed.size)] = number
        else:  # there was no jump: make one that is impossible
            changed = np.full(1, number)
        return changed

    return replaced(name, values)


def overwritten(name: str, chance: random.Random) -> Callable:
    """Write ones into all bits of a number, which is then none; where it is, h5py tells."""
    place = chance.random()

    def change(file):
        start, size, path = file[name].id.get_offset(), file[name].size, file.filename
        file.close()
        with open(path, "r+b") as raw:
            raw.seek(start + 8 * int(place * size))
            raw.write(b"\xff" * 8)

    return change


def pointing() -> Iterator[tuple[Callable, str]]:
    """Yield additions that point elsewhere, or are of a kind that no result holds."""

    def external(file):
        file.create_dataset("more", (9,), float, external=[("secret.bin", 0, 72)])

    def virtual(file):
        layout = h5py.VirtualLayout((9,), float)
        layout[:] = h5py.VirtualSource("secret.h5", "force", (9,))
        file.create_virtual_dataset("more", layout)

    def huge(file):
        more = file.create_dataset("more", (2**40,), float, chunks=(1000,))
        more.make_scale("more")

    def circle(file):
        file["more"] = file["/"]

    yield external, "values in another file"
    yield virtual, "values of other files"
    yield huge, "terabytes"
    yield circle, "a group within itself"
    yield lambda file: file.create_group("more/deep"), "a group"
    for link in (h5py.ExternalLink("secret.h5", "/"), h5py.SoftLink("/force")):
        yield lambda file, link=link: file.__setitem__("more", link), "a link"
    yield lambda file: file.__setitem__("more", np.dtype("f8")), "a named type"
    yield lambda file: file.__setitem__("more", np.zeros(3)), "nameless dimensions"
