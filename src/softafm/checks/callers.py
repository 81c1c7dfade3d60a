"""Warnings on behalf of the code that called softafm, however deep inside they arise."""

import sys
import warnings


def warn_caller(warning: Warning) -> None:
    """Warn at the line outside of the package that led here."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_globals.get("__name__", "").startswith("softafm."):
        frame, level = frame.f_back, level + 1
    warnings.warn(warning, stacklevel=level)
