"""The modes of an AFM, one a file; the table lists them in the order in which they are offered."""

from softafm.modes import approach, force_distance, peak_force, spectroscopy, tapping, transient
from softafm.modes.mode import MODES, Mode, register
from softafm.modes.parts import Axes, Foreseen, Inputs, Layout, Outcome, Row, Settings
from softafm.modes.perform import perform
from softafm.modes.scales import Scales
from softafm.results.content import Observable, observables

__all__ = [
    "MODES",
    "Axes",
    "Foreseen",
    "Inputs",
    "Layout",
    "Mode",
    "Observable",
    "Outcome",
    "Row",
    "Scales",
    "Settings",
    "observables",
    "perform",
    "register",
]

register(force_distance.MODE)
register(spectroscopy.MODE)
register(tapping.MODE)
register(approach.MODE)
register(transient.MODE)
register(peak_force.MODE)
