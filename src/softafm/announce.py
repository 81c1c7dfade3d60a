"""Word to the user when compiled code is not at hand yet."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Timer


@contextmanager
def announced_compilation(patience: float = 3.0) -> Iterator[None]:
    """Tell the user, on stderr, if what happens inside takes longer than ``patience`` seconds.

    Loading compiled code takes under a second; only a machine's first run waits for the compiler.
    """
    notice = Timer(
        patience,
        print,
        ["softafm: compiling for this machine, first use only (about 15 s) ..."],
        {"file": sys.stderr, "flush": True},
    )
    notice.daemon = True
    notice.start()
    try:
        yield
    finally:
        notice.cancel()
