"""Word to the user when compiled code is not at hand yet."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Timer

_loaded: set[str] = set()
_silent = False


def silence() -> None:
    """Announce nothing from now on: of many processes that work for one user, one speaks."""
    global _silent
    _silent = True


@contextmanager
def announce_compilation(solver: str, patience: float = 3.0) -> Iterator[None]:
    """Tell the user, on stderr, if what happens inside takes longer than ``patience`` seconds.

    Loading compiled code takes under a second; only a machine's first run waits for the compiler.
    Nothing is watched once the code of a ``solver`` is there.
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
        yield
        _loaded.add(solver)
    finally:
        notice.cancel()
