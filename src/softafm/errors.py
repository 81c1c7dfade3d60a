"""What softafm warns of and raises besides ValueError."""


class AccuracyWarning(UserWarning):
    """A run could not resolve what its tolerance asks for; the text says what, and the remedy."""


class DivergedError(RuntimeError):
    """A run could not be continued.

    Attributes
    ----------
    history
        The ``softafm.solvers.History`` up to the last good instant.
    """

    def __init__(self, message: str, history=None):
        super().__init__(message)
        self.history = history
