"""What softafm warns of and raises besides ValueError."""

from typing import Any


class AccuracyWarning(UserWarning):
    """A run could not resolve what its tolerance asks for; the text says what, and the remedy.

    Attributes
    ----------
    severity
        How bad it is beside others of its kind, in any unit; 0 if that is not known.
    """

    def __init__(self, text: str = "", severity: float = 0.0):
        super().__init__(text)
        self.severity = severity


class DoubtfulValueWarning(UserWarning):
    """A value is of a size that hardly any experiment has; the text says what may be meant."""


class DivergedError(RuntimeError):
    """A run could not be continued.

    Attributes
    ----------
    history
        The ``softafm.solvers.History`` up to the last good instant.
    """

    def __init__(self, message: str, history: Any = None):
        super().__init__(message)
        self.history = history
