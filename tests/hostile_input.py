"""An input that the command line is given, and how it must end."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple


class Input(NamedTuple):
    """An input: ``make`` writes it into a folder, and the command line is to end with ``code``."""

    kind: str
    make: Callable[[Path], None]
    arguments: tuple[str, ...]
    code: int = 2


def raw_file(name: str, content: bytes) -> Callable[[Path], None]:
    """Return what writes a file into a folder."""

    def make(folder: Path) -> None:
        (folder / name).write_bytes(content)

    return make
