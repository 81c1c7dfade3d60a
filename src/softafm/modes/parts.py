"""What the record of a mode is made of."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from softafm.progress import Progress

if TYPE_CHECKING:
    from softafm.contact import Contact
    from softafm.instrument.motion import Motion
    from softafm.results.content import Labelled
    from softafm.solvers.solver import Solver


class Inputs(NamedTuple):
    """What a mode is applied to.

    Attributes
    ----------
    contact, motion, cantilever
        What touches, one of the mode's ``motions``, and the ``Cantilever`` if the mode needs one.
    tables
        What the further ``tables`` of the mode describe, by name.
    """

    contact: "Contact"
    motion: Any
    cantilever: Any = None
    tables: Mapping[str, Any] = MappingProxyType({})

    @property
    def parts(self) -> dict[str, Any]:
        """What takes part besides the contact, as results describe it."""
        lever = {} if self.cantilever is None else {"cantilever": self.cantilever}
        return {"motion": self.motion, **lever, **self.tables}


class Settings(NamedTuple):
    """How a run is to be carried out: the options of ``force_distance`` of these names."""

    solver: "Solver | None" = None
    tolerance: float = 1e-2
    profiles: bool = False
    progress: bool | Progress | None = None


class Outcome(NamedTuple):
    """What a run gave.

    ``parts`` are what took part besides the contact, by name, ``solver`` and ``tolerance`` those
    that were used, and ``data`` and ``coordinates`` variables of the result, as (dims, values).
    ``audit`` is what ``softafm.modes.audit`` found of its runs, JSON; "" if it was not asked.
    """

    parts: Mapping[str, Any]
    solver: "Solver"
    tolerance: float
    data: dict[str, "Labelled"]
    coordinates: dict[str, "Labelled"]
    warnings: tuple[Warning, ...] = ()
    diagnostics: Mapping[str, float] = MappingProxyType({})
    audit: str = ""


class Row(NamedTuple):
    """A line of ``softafm info``: a number with its unit, as text, and what it means."""

    name: str
    value: str
    words: str


class Foreseen(NamedTuple):
    """What a run will be like, estimated before it.

    Attributes
    ----------
    motion
        The motion that goes deepest, of the tip, or of the base of its lever.
    runs
        How many such motions a run is worth.
    noun
        What such a motion is called.
    depth
        Where its lowest height comes from; "" if it is known.
    rows
        What else is worth knowing.
    """

    motion: "Motion"
    runs: int = 1
    noun: str = "motion"
    depth: str = ""
    rows: tuple[Row, ...] = ()


class Axes(NamedTuple):
    """What the observables of a mode lie over, where a run gives arrays of them.

    Attributes
    ----------
    dims
        The dimensions.
    values
        Function of the motion that returns the coordinate along each of them.
    keys
        Keys of ``[motion]`` that make these coordinates, so that a sweep cannot vary them.
    """

    dims: tuple[str, ...] = ()
    values: Callable[[Any], tuple[Any, ...]] = lambda motion: ()
    keys: tuple[str, ...] = ()


class Layout(NamedTuple):
    """What is drawn of a result.

    Attributes
    ----------
    panels
        For each panel the variable along x, and the one along y.
    cropped
        Whether panels show only where there is a force.
    title
        Scalars shown above, each with a name for it.
    """

    panels: tuple[tuple[str, str], ...] = (("time", "force"), ("tip_height", "force"))
    cropped: bool = True
    title: tuple[tuple[str, str], ...] = ()
