"""The rooms of the house stand on floors: what a module imports lies below it, never above."""

import ast
from collections import defaultdict
from pathlib import Path

import softafm

PACKAGE = Path(softafm.__file__).parent
FLOORS = (
    {"errors", "progress", "units", "version"},
    {"checks"},
    {"compiled"},
    {"bodies", "instrument"},
    {"files", "solvers"},
    {"results", "rheology", "surfaces", "tips"},
    {"contact", "indentation", "samples"},
    {"modes"},
    {"draw"},
    {"experiment"},
    {"maps", "sweeps"},
    {"app"},
    {"cli"},
    {"__main__"},
)
"""From the ground up; rooms on one floor do not import each other."""


def test_imports_only_ever_point_down():
    floors = {room: number for number, rooms in enumerate(FLOORS) for room in rooms}
    found = imports()
    assert set(found) == set(floors)
    for room, imported in found.items():
        above = {other for other in imported if floors[other] >= floors[room]}
        assert above == set(), f"{room} imports from {above}"


def imports() -> dict[str, set[str]]:
    """Return the other rooms that each room imports from, at the top of a file or later."""
    rooms = {path.stem for path in PACKAGE.iterdir() if path.suffix in ("", ".py")}
    rooms -= {"__init__", "__pycache__", "examples"}
    found: dict[str, set[str]] = defaultdict(set)
    for path in PACKAGE.rglob("*.py"):
        room = path.relative_to(PACKAGE).parts[0].removesuffix(".py")
        if room == "__init__":
            continue
        found[room] |= set()
        for line in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(line, ast.ImportFrom) or line.module is None:
                continue
            first, _, rest = line.module.partition(".")
            if first != "softafm":
                continue
            names = {rest.split(".")[0]} if rest else {alias.name for alias in line.names}
            found[room] |= names & rooms - {room}
    return found
