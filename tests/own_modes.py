"""Modes of a test's own, and their removal afterwards."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from unittest.mock import patch

from softafm.checks import suggestions
from softafm.modes import MODES
from softafm.results import content


@contextmanager
def modes_restored() -> Iterator[None]:
    """Forget at the end what is registered inside."""
    with ExitStack() as stack:
        for known in (MODES, content.NEEDED, content.VARIABLES, suggestions._OTHER_WORDS):
            stack.enter_context(patch.dict(known))
        yield
