"""Paths that name no file."""

from pathlib import Path


def explain_no_file(path: Path) -> str:
    """Return in words why a path is not that of a regular file."""
    if path.is_dir():
        return "is a directory"
    return "is not a regular file" if path.exists() else "no such file"
