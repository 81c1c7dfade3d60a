"""Names that are going away: they work as before, with a warning that says what to use instead."""

import warnings
from typing import Any


def warn_of_removal(old: str, new: str, since: str, until: str) -> None:
    """Give a DeprecationWarning in the line that called the caller of this function.

    Parameters
    ----------
    old, new
        The name that goes, and what to use instead.
    since, until
        Version and date of the release that deprecates it, such as ``"0.2.0 of 2026-11-30"``, and
        the version that removes it.
    """
    message = f"{old} is deprecated since softafm {since} and removed in {until}: use {new}"
    warnings.warn(message, DeprecationWarning, stacklevel=3)


class Renamed:
    """An attribute or a method under its old name, which warns where it is used.

    In a class, ``mode_count = Renamed("element_count", "0.2.0 of 2026-11-30", "0.4.0")``.
    """

    def __init__(self, new: str, since: str, until: str):
        self._new, self._since, self._until = new, since, until

    def __set_name__(self, owner: type, name: str) -> None:
        self._owner, self._old = owner.__name__, name
        self.__doc__ = f"Deprecated since {self._since}: use ``{self._new}``."

    def __get__(self, instance: Any, owner: type) -> Any:
        old, new = (f"{self._owner}.{name}" for name in (self._old, self._new))
        warn_of_removal(old, new, self._since, self._until)
        return getattr(owner if instance is None else instance, self._new)
