"""The page: a form, runs in processes of their own, and results that one can look into.

``Page`` is the same object in a notebook and behind ``softafm app``; it needs ``softafm[app]``.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from softafm.app.page import Page

__all__ = ["Page"]

_OURS = "softafm"


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        from softafm.app.page import Page
    except ModuleNotFoundError as error:
        missing = (error.name or "").partition(".")[0]
        if missing == _OURS:
            raise
        raise ModuleNotFoundError(
            f"the page needs the package {missing!r}: pip install 'softafm[app]'", name=error.name
        ) from None
    return Page
