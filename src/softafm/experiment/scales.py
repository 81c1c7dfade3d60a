"""The scales of an experiment before it runs, as numbers and as a table for people."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from rich.console import Console
from rich.table import Table

from softafm.contact import Contact
from softafm.draw.summary import make_table
from softafm.modes import Row

_WIDTH = 200
"""Columns of the table as text, enough for every row to stay in one line."""


@dataclass(frozen=True)
class Regime:
    """The numbers that say how a contact will behave and what a run of it will cost.

    ``print`` shows them as a table with what each means; so does a notebook.

    Parameters
    ----------
    mode
        Mode of the experiment.
    contact
        What touches, as it is computed: with the longer range of ``regularise``, if that is given.
        Its properties are scales as well, such as ``contact.edge_gap``.
    lowest_height
        Lowest height of the tip, or of the base of its lever, m; of an approach curve that of its
        deepest tap.
    contact_radius
        Radius of the relaxed contact expected there, m; 0 if none is expected to last.
    duration
        Time of the motion, or of one tap of an approach curve, s.
    expected_seconds
        Order of magnitude of the time that a run takes on one core, s.
    rows
        Name, value and meaning of every line of the table, as text.
    """

    mode: str
    contact: Contact
    lowest_height: float
    contact_radius: float
    duration: float
    expected_seconds: float
    rows: Sequence[Row]

    @property
    def tabor_instantaneous(self) -> float:
        """Tabor number of sudden loading; 0 without adhesion."""
        return self.contact.tabor_instantaneous

    @property
    def tabor_relaxed(self) -> float:
        """Tabor number of slow loading; 0 without adhesion, infinite for a sample that flows."""
        return self.contact.tabor_relaxed

    @property
    def cohesive_length_instantaneous(self) -> float:
        """Width of the tension zone in sudden loading, m; infinite without adhesion."""
        return self.contact.cohesive_length_instantaneous

    @property
    def cohesive_length(self) -> float:
        """Width of the tension zone in slow loading, m; infinite without adhesion."""
        return self.contact.cohesive_length

    @property
    def effective_radius(self) -> float:
        """Radius of the paraboloid that rises as high as the tip within reach of the forces, m."""
        return self.contact.effective_radius

    def __str__(self) -> str:
        console = Console(width=_WIDTH, color_system=None)
        with console.capture() as capture:
            console.print(self.__rich__())
        return "\n".join(line.rstrip() for line in capture.get().rstrip().splitlines())

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        """Show the table where IPython and Jupyter would show the fields."""
        printer.text(str(self))

    def __rich__(self) -> Table:
        table = make_table(f"{self.mode}, before any run")
        for row in self.rows:
            table.add_row(*row)
        return table
