"""A mode of an AFM: one record, which files, sweeps, figures and the page look up."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property
from inspect import Parameter, signature
from typing import TYPE_CHECKING, Any, Literal

from softafm.checks.suggestions import call_also
from softafm.checks.validate import check_choice
from softafm.modes.parts import Axes, Foreseen, Inputs, Layout, Outcome, Settings
from softafm.modes.scales import Scales, force_scales
from softafm.results.content import HISTORY, Needed, Observable, declare, find_unit

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
        If neither or both of ``observe`` and ``simulate`` are given, there is no motion, the lever
        is none of these, or the function lacks an argument for a field of a motion.
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
        if (self.observe is None) == (self.simulate is None):
            raise ValueError(f"mode '{self.name}': must have either observe or simulate")
        check_choice(f"mode '{self.name}': lever", self.lever, ("", "stiffness", "resonator"))
        if not self.motions:
            raise ValueError(f"mode '{self.name}': motions is empty; must hold at least one")
        asked = () if self.takes_motion else self.motions.values()
        for name in dict.fromkeys(each.name for motion in asked for each in fields(motion)):
            if name not in self.parameters:
                raise ValueError(
                    f"mode '{self.name}': {self.function.__name__} has no argument {name}, which "
                    "is a field of its motion; must have one, or take motion"
                )

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

    def expect(self, inputs: Inputs) -> Foreseen:
        """Return what a run will be like."""
        return Foreseen(self.path(inputs.motion)) if self.foresee is None else self.foresee(inputs)


MODES: dict[str, Mode] = {}
"""Every mode by name."""


def register(mode: Mode) -> None:
    """Make a mode known to experiment files, sweeps, figures and the page of this process.

    One of the same name is replaced.

    Raises
    ------
    ValueError
        If the name of an observable means something else in results, or nothing says what a
        dimension of the axes is.
    """
    for name in mode.axes.dims:
        if name not in mode.observables and find_unit(name) is None:
            raise ValueError(
                f"mode '{mode.name}': the dimension {name} must be among the observables, as "
                f"Observable(unit, words, ('{name}',))"
            )
    variables = {name: each.dims for name, each in mode.observables.items()}
    if mode.observe is not None:
        variables = HISTORY | variables
    needed = Needed(variables, numbers=mode.diagnostics, inputs=mode.inputs, gaps=mode.gaps)
    declare(mode.name, needed, mode.observables)
    call_also(mode.name, mode.other_names)
    MODES[mode.name] = mode
