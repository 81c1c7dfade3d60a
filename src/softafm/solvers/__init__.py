"""Solvers: each takes a contact and a motion and returns a ``History``."""

from softafm.solvers.energy import Energy
from softafm.solvers.history import History, Profiles
from softafm.solvers.paper.attard import Attard
from softafm.solvers.paper.enhanced import EnhancedAttard
from softafm.solvers.paper.stepping import AdamsBashforth, ForwardEuler, RungeKutta4

__all__ = [
    "AdamsBashforth",
    "Attard",
    "Energy",
    "EnhancedAttard",
    "ForwardEuler",
    "History",
    "Profiles",
    "RungeKutta4",
]
