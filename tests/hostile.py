"""Damaged and hostile inputs, made from a seed, and what the command line makes of them.

    python tests/hostile.py [SEED]

runs them all, each result in a process of its own as users run it, and prints the counts by kind.
Nothing here can harm a library: files are cut off, replaced, or changed through h5py, never in
HDF5's own bytes.
"""

import os
import random
import sys
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory

from hostile_documents import of_experiments, of_tables
from hostile_input import Input
from hostile_results import of_results
from hostile_stores import of_stores

from softafm.cli import main

SEED = 20
LONGEST = 10.0
"""Time that any input may take, s."""
FAMILIES = (of_results, of_experiments, of_tables, of_stores)


def inputs(seed: int = SEED) -> Iterator[Input]:
    """Yield all inputs that a seed makes."""
    chance = random.Random(seed)
    for family in FAMILIES:
        yield from family(chance)


def complaint(one: Input, folder: Path) -> str | None:
    """Make an input in an empty folder, run it, and say what is wrong with the outcome, if any."""
    one.make(folder)
    before, said, told = contents(folder), StringIO(), StringIO()
    here, started = Path.cwd(), time.monotonic()
    os.chdir(folder)
    try:
        with redirect_stdout(told), redirect_stderr(said):
            code = main(list(one.arguments))
    except BaseException as error:
        return f"ended with {error!r}"
    finally:
        os.chdir(here)
    seconds = time.monotonic() - started
    lines = said.getvalue().splitlines()
    if seconds > LONGEST:
        return f"took {seconds:.1f} s"
    if code != one.code:
        return f"exit code {code}, not {one.code}: {told.getvalue()}{said.getvalue()}"
    if code and not (lines and all(line.startswith("softafm: ") for line in lines)):
        return f"is told as {said.getvalue()!r}"
    if code and contents(folder) != before:
        return "a file was touched or left behind"
    return None


def contents(folder: Path) -> dict[str, object]:
    """Return everything in a folder, by name."""
    return {
        str(path.relative_to(folder)): (
            os.readlink(path) if path.is_symlink() else path.is_file() and path.read_bytes()
        )
        for path in folder.rglob("*")
        if path.name != ".lock"
    }


def run_all(seed: int) -> int:
    """Run all inputs of a seed, print how many there are of each kind, and what goes wrong."""
    counts: Counter[str] = Counter()
    wrong, longest = 0, 0.0
    for one in inputs(seed):
        with TemporaryDirectory() as folder:
            started = time.monotonic()
            found = complaint(one, Path(folder))
            longest = max(longest, time.monotonic() - started)
        counts[one.kind] += 1
        if found is not None:
            wrong += 1
            print(f"WRONG: {one.kind}, {' '.join(one.arguments)}: {found}", flush=True)
    for kind, count in counts.items():
        print(f"{count:5} {kind}")
    print(f"{sum(counts.values()):5} in all, {wrong} wrong, the longest took {longest:.1f} s")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(run_all(int(sys.argv[1]) if len(sys.argv) > 1 else SEED))
