"""A mode of an AFM: one record, which files, sweeps, figures and the page look up."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from inspect import Parameter, signature
from typing import TYPE_CHECKING, Any, Literal

from softafm.checks.kinds import members, refuse_incomplete
from softafm.checks.suggestions import call_also
from softafm.instrument.motion import Motion
from softafm.modes.parts import Axes, Foreseen, Inputs, Layout, Outcome, Settings
from softafm.modes.refusals import refuse_record, refuse_unknown_names
from softafm.modes.scales import Scales, force_scales
from softafm.results.content import HISTORY, MAPS, Needed, Observable, declare

if TYPE_CHECKING:
    from xarray import Dataset

    from softafm.contact import Contact
    from softafm.solvers.history import History

Values = Mapping[str, Any]
"""Numbers and arrays by the names of a mode's observables."""


_NUMBERS, _HISTORY = Axes(), Layout()


def _keep(motion: Any) -> Any:
    return motion


@dataclass(frozen=True, eq=False)
class Mode:
    """All that the rest of the program needs to know of a mode.

    Parameters
    ----------
    name
        What it is called in experiment files and results, such as ``"force-distance"``.
    function
        What a Python user calls: with a contact, a ``Cantilever`` if the mode needs a lever, and
        either ``motion``, or arguments that are attributes of the motion. Its keyword arguments
        are those of ``force_distance``, ``profiles`` left out where no surface shapes are kept.
    motions
        What a ``[motion]`` table can describe, by its ``shape``, the default first: dataclasses
        with a ``kind`` whose fields are the keys of the table: ``float`` or ``tuple[float, ...]``,
        with a unit ``Annotated[float, LENGTH]`` by a ``Kind`` of ``softafm.units.quantities``,
        ``int``, ``bool`` or ``Literal``, or one of these or None. The help of a field is its text
        in the section ``Parameters`` of the docstring.
    observables
        What is observed, by name. A check compares, and a sweep keeps, those over ``axes.dims``.
    observe
        Function of contact, motion and ``History`` that returns the values of the observables, for
        a mode that carries a contact through one motion.
    simulate
        Function of ``Inputs`` and ``Settings`` that returns an ``Outcome``, for one that does
        more.
    path
        Function that turns what a ``[motion]`` describes into the motion of the tip, or of the
        base of its lever. By default it is that motion.
    lever
        ``"stiffness"`` or ``"resonator"``, with quality factor and frequency, if a lever carries
        the tip; else "".
    tables
        Further tables of an experiment file by name, each a dataclass like those of ``motions``.
        The function takes what they describe as arguments of these names.
    steady
        Whether it needs cycles that repeat, as there are none on a sample that flows.
    scales
        Function of ``Inputs`` and the result of a finer run that returns the ``Scales`` on which
        differences of observables count.
    foresee
        Function of ``Inputs`` that returns what a run will be like and cost; by default as the
        motion of ``path`` is and costs.
    axes
        What the observables lie over; by default they are single numbers.
    figure
        What is drawn of a result that has no figure of its own kind.
    diagnostics, inputs, gaps
        As ``numbers``, ``inputs`` and ``gaps`` of ``softafm.results.content.Needed``.
    other_names
        Other words for the mode, in small letters without hyphens, separated by spaces.

    Raises
    ------
    ValueError
        If neither or both of ``observe`` and ``simulate`` are given, something is not of the kind
        stated here, or the function lacks an argument for a field of a motion, for a table or for
        the lever.
    """

    name: str
    function: Callable[..., "Dataset"]
    motions: Mapping[str, type]
    observables: Mapping[str, Observable]
    observe: "Callable[[Contact, Any, History], Values] | None" = None
    simulate: "Callable[[Inputs, Settings], Outcome] | None" = None
    path: Callable[[Any], Any] = _keep
    lever: Literal["", "stiffness", "resonator"] = ""
    tables: Mapping[str, type] = field(default_factory=dict)
    steady: bool = False
    scales: "Callable[[Inputs, Dataset], Scales]" = force_scales
    foresee: Callable[[Inputs], Foreseen] | None = None
    axes: Axes = _NUMBERS
    figure: Layout = _HISTORY
    diagnostics: tuple[str, ...] = ()
    inputs: Mapping[str, str] = field(default_factory=dict)
    gaps: bool = False
    other_names: str = ""

    def __post_init__(self) -> None:
        refuse_record(self)

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        """Names of the arguments of the function."""
        return tuple(signature(self.function).parameters)

    @property
    def takes_motion(self) -> bool:
        """Whether the function takes a motion as one argument."""
        return "motion" in self.parameters

    @cached_property
    def takes_profiles(self) -> bool:
        """Whether surface shapes can be kept."""
        parameters = signature(self.function).parameters.values()
        return any(p.name == "profiles" or p.kind is Parameter.VAR_KEYWORD for p in parameters)

    @property
    def observed(self) -> tuple[str, ...]:
        """Names of the observables that a sweep keeps."""
        dims = self.axes.dims
        return tuple(n for n, o in self.observables.items() if o.dims == dims and n not in dims)

    def arguments(self, motion: Any) -> dict[str, Any]:
        """Return the arguments of the function that stand for a motion, by name."""
        if self.takes_motion:
            return {"motion": motion}
        return {name: getattr(motion, name) for name in self.parameters if hasattr(motion, name)}

    def find_path(self, motion: Any) -> Any:
        """Return the motion of the tip, or of the base of its lever; ValueError if it is none."""
        path = self.path(motion)
        wanted = "a motion such as softafm.Triangle, which the record's path is to make"
        refuse_incomplete(f"mode '{self.name}': path", path, members(Motion), wanted)
        return path

    def expect(self, inputs: Inputs) -> Foreseen:
        """Return what a run will be like."""
        if self.foresee is not None:
            return self.foresee(inputs)
        return Foreseen(self.find_path(inputs.motion))


MODES: dict[str, Mode] = {}
"""Every mode by name."""


def register(mode: Mode, *, replace: bool = False) -> None:
    """Make a mode known to experiment files, sweeps, figures and the page of this process.

    Parameters
    ----------
    mode
        Its record.
    replace
        Whether it takes the place of another record of this name, as when a notebook makes one
        anew.

    Raises
    ------
    ValueError
        If the name is taken, the name of an observable means something else in results, nothing
        says what a dimension is, or the figure shows what no result of the mode holds.
    """
    if mode.name in MAPS:
        raise ValueError(f"mode '{mode.name}': a kind of imaging has this name; take another")
    if not replace and MODES.get(mode.name, mode) is not mode:
        raise ValueError(
            f"mode '{mode.name}': another mode of this name is registered; take another name, or "
            "register(mode, replace=True)"
        )
    variables = {name: each.dims for name, each in mode.observables.items()}
    if mode.observe is not None:
        variables = HISTORY | variables
    refuse_unknown_names(mode, variables)
    needed = Needed(variables, numbers=mode.diagnostics, inputs=mode.inputs, gaps=mode.gaps)
    declare(mode.name, needed, mode.observables)
    call_also(mode.name, mode.other_names)
    MODES[mode.name] = mode
