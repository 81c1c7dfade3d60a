"""Solvers: each takes a contact and a motion and returns a ``History``."""

from softafm.solvers.energy import Energy
from softafm.solvers.history import History, Profiles

__all__ = ["Energy", "History", "Profiles"]
