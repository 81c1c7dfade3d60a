"""Files from the browser, kept under plain names."""

import re
from pathlib import Path

_LONGEST_NAME = 80
_ALL = 4
"""What all files together may have, in largest files."""


def keep(folder: Path, name: str, content: bytes, largest: int) -> str:
    """Keep a file in a folder, and return the name it has there: plain, and never one taken.

    Raises
    ------
    ValueError
        If it is larger than ``largest`` bytes, or all together than four times that.
    """
    if len(content) > largest:
        raise ValueError(f"is too large: must have at most {largest / 1e6:g} MB")
    kept = [path for path in folder.iterdir() if path.is_file()]
    same = [path.name for path in kept if path.read_bytes() == content]
    plain = re.sub(r"[^\w.-]+", "_", re.split(r"[/\\]", name)[-1]).lstrip(".")[-_LONGEST_NAME:]
    plain = plain or "file.csv"
    if plain in same:
        return plain
    if sum(path.stat().st_size for path in kept) + len(content) > _ALL * largest:
        raise ValueError(
            f"exceeds the total: all files may have {_ALL * largest / 1e6:g} MB together"
        )
    taken = {path.name for path in kept}
    numbered = (f"{number}-{plain}" for number in range(2, len(taken) + 3))
    plain = next(new for new in (plain, *numbered) if new not in taken)
    (folder / plain).write_bytes(content)
    return plain
