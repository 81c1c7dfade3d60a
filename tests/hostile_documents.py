"""Experiment files, and the tables they name, that are damaged or ask for too much."""

import json
import random
from collections.abc import Iterator
from pathlib import Path

from hostile_input import Input, raw_file

from softafm.experiment.config import parse_document, read_example

# Experiments


def of_experiments(chance: random.Random) -> Iterator[Input]:
    text = read_example("ldpe-tapping")
    document = parse_document(text, "ldpe-tapping")
    yield experiment("sound", text, 0)
    yield experiment("cycles", text.replace("cycles = 1", "cycles = 3"), 0)
    odd = ("[]", "{}", "true", '""', '"\\u0000"', "1979-05-27", "nan", "-inf", "[[1]]",
           '"1e999 parsec"', '"' + "9" * 500 + '"', "0x" + "f" * 300)  # fmt: skip
    for table in ("tip", "sample", "surface", "motion"):
        for key in document[table]:
            for value in odd:
                yield experiment("an odd value", with_line(document, table, key, value))
            if key != "cycles":
                yield experiment("a key missing", with_line(document, table, key, None))
        yield experiment("an unknown key", with_line(document, table, "odd", "1"))
    for _ in range(25):
        cut = text[: chance.randrange(text.index("[motion]"))]
        yield experiment("cut off", cut)
    for content in TOO_MUCH:
        yield experiment("too much", content)
    for raw in (b"", b"\xff\xfe" + text.encode("utf-16-le"), b"\x00" * 500, chance.randbytes(900),
                text.encode() + b"\x80", b"\x89HDF\r\n\x1a\n" + bytes(90)):  # fmt: skip
        yield Input("experiment, no text", raw_file("e.toml", raw), ("info", "e.toml"))


TOO_MUCH = (
    "a." * 300_000 + "a = 1",
    "x = " + "[" * 900_000,
    "x = " + "{a = " * 100_000,
    "[" + "a." * 20_000 + "a]",
    "".join(f"k{i} = 1\n" for i in range(70_000)),
    "[[surface.parts]]\nlaw = 1\n" * 30_000,
    "x = '" + "x" * 900_000 + "'",
    "x" * 900_000,
    "#" * 1_100_000,
    "mode = 'tapping-cycle'\n[sample]\nmodel = 'generalized-maxwell'\nmoduli = ["
    + "'1 odd'," * 50_000
    + "]",
)


def experiment(kind: str, text: str, code: int = 2) -> Input:
    make = raw_file("e.toml", text.encode())
    return Input(f"experiment, {kind}", make, ("info", "e.toml"), code)


def with_line(document: dict, table: str, key: str, value: str | None) -> str:
    """Return a document as text with another value, as TOML writes it, or without the key."""
    lines = [f"mode = {json.dumps(document['mode'])}"]
    for name in ("tip", "sample", "surface", "motion"):
        written = {k: json.dumps(v) for k, v in document[name].items()}
        if name == table:
            written = {**written, key: value}
        lines += [f"[{name}]", *(f"{k} = {v}" for k, v in written.items() if v is not None)]
    return "\n".join(lines) + "\n"


# Tables


TABLES = {
    "tip": ("radius (nm)", "height (nm)", [(r, r * r / 20) for r in range(9)]),
    "surface": ("gap (nm)", "pressure (MPa)",
                [(g / 10, 1e5 / g**9 - 1e3 / g**3) for g in range(1, 60)]),
    "motion": ("time (us)", "height (nm)", [(t, abs(t - 10) + 1.0) for t in range(21)]),
}  # fmt: skip
_TABLE = {
    "tip": '[tip]\nshape = "measured"\nfile = "t.csv"\n',
    "surface": '[surface]\nlaw = "tabulated"\nfile = "t.csv"\n',
    "motion": '[motion]\nshape = "trajectory"\nfile = "t.csv"\n',
}


def of_tables(chance: random.Random) -> Iterator[Input]:
    for table, (first, second, rows) in TABLES.items():
        lines = [f"{x},{y}" for x, y in rows]
        whole = "\n".join([f"{first},{second}", *lines]) + "\n"
        yield csv_input(table, "sound", whole.encode(), 0)
        for entry in ("nan", "inf", "-inf", "1e400", "x", "--1", "0x5", "²", "1_0", "\x00"):
            spoiled = [*lines]
            at = chance.randrange(1, len(lines))
            spoiled[at] = f"{rows[at][0]},{entry}"
            text = "\n".join([f"{first},{second}", *spoiled])
            yield csv_input(table, "a number that is none", text.encode())
        commas = [f"{x},5,{y},5" for x, y in rows]
        text = "\n".join([f"{first},{second}", *commas])
        yield csv_input(table, "decimal commas", text.encode())
        at = chance.randrange(1, len(lines))
        long = [*lines[:at], f"{lines[at]},7", *lines[at + 1 :]]
        yield csv_input(table, "too many fields", "\n".join([f"{first},{second}", *long]).encode())
        short = [*lines[:at], str(rows[at][0]), *lines[at + 1 :]]
        yield csv_input(table, "too few fields", "\n".join([f"{first},{second}", *short]).encode())
        for header in (first, f"{first},other (nm)", f"{first},{second.split()[0]} (odd)",
                       f"{first.split()[0]},{second.split()[0]}", "", lines[0]):  # fmt: skip
            yield csv_input(table, "another header", "\n".join([header, *lines]).encode())
        yield csv_input(table, "no rows", f"{first},{second}\n".encode())
        yield csv_input(table, "one row", f"{first},{second}\n{lines[0]}\n".encode())
        turned = "\n".join([f"{first},{second}", *reversed(lines)])
        yield csv_input(table, "turned round", turned.encode())
        others = (b"", b"\n\n", b"," * 1_000_000, b"\x00" * 2000, chance.randbytes(2000))
        for raw in (*others, whole.encode("utf-16"), b'"' + b"x" * 200_000, b"\x89PNG\r\n\x1a\n"):
            yield csv_input(table, "something else", raw)
        yield csv_input(table, "none", None)


def csv_input(table: str, kind: str, content: bytes | None, code: int = 2) -> Input:
    document = parse_document(read_example("ldpe-tapping"), "")
    text = 'mode = "force-distance"\n' + _TABLE[table]
    written = with_line(document, "", "", None).partition("\n")[2]
    kept = [part for part in written.split("[") if part and not part.startswith(f"{table}]")]
    if table != "motion":
        kept = [part for part in kept if not part.startswith("motion]")]
        kept.append('motion]\nstart = "10 nm"\nturn = "2 nm"\nspeed = "5 um/s"\n')
    text += "".join(f"[{part}" for part in kept)

    def make(folder: Path) -> None:
        (folder / "e.toml").write_text(text)
        if content is not None:
            (folder / "t.csv").write_bytes(content)

    return Input(f"table, {kind}", make, ("info", "e.toml"), code)
