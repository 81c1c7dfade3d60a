"""Where compiled code is kept between processes, and what it belongs to.

All compiled code of one build stands in one folder of the user's, named after a hash of everything
that the code depends on: the sources of compiled functions and of what they call, the versions of
softafm, Python, numba and LLVM, the processor, and numba's options. What a folder holds can
therefore never belong to other sources; after any change the code is compiled anew.
"""

import os
import re
import shutil
import stat
import sys
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from hashlib import sha256
from pathlib import Path
from time import time

PACKAGE = Path(__file__).parents[1]
ROOMS = ("compiled", "bodies", "instrument", "solvers", "surfaces", "tips")
"""Folders of the package in which compiled functions, and what they call, may stand."""

_OPTIONS = (
    "BOUNDSCHECK", "CPU_FEATURES", "CPU_NAME", "DEBUGINFO_DEFAULT", "ENABLE_AVX", "LOOP_VECTORIZE",
    "OPT", "SLP_VECTORIZE",
)  # fmt: skip
"""The settings of numba that change the code it makes."""
_BUILD = re.compile("[0-9a-f]{64}")
_MAGIC = b"softafm compiled code 1\n"
_UNUSED = 30 * 24 * 3600.0
"""Time after which the code of another build is removed, s."""
_OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


def is_ours(file: str) -> bool:
    """Whether a source file is one of those that the build's name depends on."""
    path = Path(file)
    return path.is_relative_to(PACKAGE) and path.relative_to(PACKAGE).parts[0] in ROOMS


@cache
def name_build() -> str:
    """Return the name of this build: a hash of all that its compiled code depends on."""
    import llvmlite
    import numba
    from llvmlite import binding

    from softafm.version import __version__

    parts = [__version__, sys.version, numba.__version__, llvmlite.__version__]
    parts += [binding.get_process_triple(), binding.get_host_cpu_name()]
    parts += [binding.get_host_cpu_features().flatten()]
    parts += [f"{name}={getattr(numba.config, name, None)}" for name in _OPTIONS]
    found = sha256("\0".join(parts).encode())
    for path in _list_sources():
        found.update(f"\0{path.relative_to(PACKAGE).as_posix()}\0".encode())
        found.update(sha256(path.read_bytes()).digest())
    return found.hexdigest()


def _list_sources() -> list[Path]:
    return sorted(path for room in ROOMS for path in (PACKAGE / room).rglob("*.py"))


@cache
def find_folder() -> Path | None:
    """Return where this build's code is kept, None if there is no place that only we can write.

    It is in the folder that NUMBA_CACHE_DIR names, else among the user's caches, else, for homes
    that cannot be written, among temporary files.
    """
    for shelf in _list_shelves():
        try:
            _make_own(shelf)
            place = shelf / name_build()
            new = not place.exists()
            _make_own(place)
        except OSError:
            continue
        if new:
            _remove_unused(shelf)
        else:
            _mark_used(place)
        return place
    return None


def _list_shelves() -> Iterator[Path]:
    """Yield the folders in which builds may stand, best first."""
    user = f"softafm-{os.getuid()}" if hasattr(os, "getuid") else "softafm"
    if chosen := os.environ.get("NUMBA_CACHE_DIR"):
        yield Path(chosen).absolute() / user
    if sys.platform == "win32":
        caches = os.environ.get("LOCALAPPDATA", "")
    elif sys.platform == "darwin":
        caches = os.path.expanduser("~/Library/Caches")
    else:
        caches = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    if os.path.isabs(caches):  # there may be no home
        yield Path(caches) / "softafm"
    yield Path(tempfile.gettempdir()) / user


def _make_own(place: Path) -> None:
    """Make a folder if there is none; PermissionError if anyone else may write to it.

    What it holds is executed.
    """
    place.mkdir(mode=0o700, parents=True, exist_ok=True)
    if not hasattr(os, "getuid"):
        return
    found = place.lstat()
    ours = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid()
    if not ours or found.st_mode & _OTHERS_WRITE:
        raise PermissionError(f"{place} can be written by others")


def _mark_used(place: Path) -> None:
    try:
        os.utime(place)
    except OSError:  # on a file system that can only be read nothing grows old
        return


def _remove_unused(shelf: Path) -> None:
    """Remove the code of builds that no process has used for a month."""
    for place in shelf.iterdir():
        if _BUILD.fullmatch(place.name) and time() - place.lstat().st_mtime > _UNUSED:
            shutil.rmtree(place, ignore_errors=True)


@contextmanager
def take_turns() -> Iterator[None]:
    """Let one process of the user at a time compile for this build; not on Windows.

    Numba's code for the same sources differs in the order of operations from process to process. So
    a process that waited looks again, and all use what the first one kept.
    """
    place = find_folder()
    try:
        import fcntl
    except ImportError:
        place = None
    with ExitStack() as held:
        if place is not None:
            with suppress(OSError):  # where there is no place for locks, everyone goes ahead
                lock = os.open(place / "lock", os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o600)
                held.callback(os.close, lock)
                fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def read(name: str) -> bytes | None:
    """Return what is kept under a name, None if there is nothing whole."""
    place = find_folder()
    if place is None:
        return None
    try:
        kept = (place / name).read_bytes()
    except OSError:
        return None
    head, content = kept[: len(_MAGIC) + 32], kept[len(_MAGIC) + 32 :]
    return content if head == _MAGIC + sha256(content).digest() else None


def write(name: str, content: bytes) -> None:
    """Keep content under a name, whole or not at all.

    Raises
    ------
    OSError
        If there is no folder, or it cannot be written.
    """
    place = find_folder()
    if place is None:
        raise OSError("there is no folder that only you can write to")
    handle, part = tempfile.mkstemp(prefix=f".{name}.", dir=place)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(_MAGIC + sha256(content).digest() + content)
        os.replace(part, place / name)
    except BaseException:
        os.unlink(part)
        raise
