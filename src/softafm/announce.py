"""When compiled code is not at hand yet: word to the user, and one process that compiles."""

import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from threading import Timer

from softafm import code_store

_loaded: set[str] = set()
_silent = False


def silence() -> None:
    """Announce nothing from now on: of many processes that work for one user, one speaks."""
    global _silent
    _silent = True


@contextmanager
def announced_compilation(solver: str, patience: float = 3.0) -> Iterator[None]:
    """Tell the user, on stderr, if what happens inside takes longer than ``patience`` seconds.

    Loading compiled code takes under a second; only a machine's first run waits for the compiler.
    Of several processes that start together one compiles and the others wait for what it made, as
    code compiled in part by one and in part by another would round differently. Nothing is watched
    once the code of a ``solver`` is there.
    """
    if solver in _loaded:
        yield
        return
    notice = Timer(
        patience,
        print,
        ["softafm: compiling for this machine, first use only (about 15 s) ..."],
        {"file": sys.stderr, "flush": True},
    )
    notice.daemon = True
    if not _silent:
        notice.start()
    try:
        with _in_turn():
            yield
        _loaded.add(solver)
    finally:
        notice.cancel()


@contextmanager
def _in_turn() -> Iterator[None]:
    """Let the first process of a user go ahead alone, all others after it; not on Windows.

    Nor where nothing can be kept, as each of them compiles everything then.
    """
    place = code_store.folder()
    try:
        import fcntl
    except ImportError:
        place = None
    if place is None:
        yield
        return
    with ExitStack() as held:
        with suppress(OSError):  # where there is no place for locks, everyone goes ahead
            lock = os.open(place / "lock", os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o600)
            held.callback(os.close, lock)
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                fcntl.flock(lock, fcntl.LOCK_SH)
        yield
