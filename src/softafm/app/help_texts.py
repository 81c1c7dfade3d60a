"""What the fields of the form mean: the docstrings of what the tables build, as plain text."""

import inspect
import re
from collections.abc import Callable
from functools import cache
from typing import Any

from softafm.experiment import schema
from softafm.files.measured import read_trajectory
from softafm.instrument.cantilever import Cantilever, Eigenmode
from softafm.instrument.motions import Sine, Trajectory, Triangle
from softafm.modes.approach import approach_curve
from softafm.modes.force_distance import force_distance
from softafm.rheology import GeneralizedMaxwell, StandardLinearSolid, read_dma
from softafm.surfaces import SumOfLaws, read_law
from softafm.tips import read_tip_profile

_TRAJECTORY = (
    read_trajectory,
    schema.TrajectoryMotion,
    Trajectory,
    Trajectory.from_measurement,
)
_STANDS_FOR: dict[Any, tuple[Callable, ...]] = {
    schema.StandardLinearSolidSample: (
        StandardLinearSolid,
        StandardLinearSolid.from_relaxation_time,
        StandardLinearSolid.from_shear,
    ),
    schema.TriangleMotion: (Triangle, Triangle.from_frequency),
    schema.SineMotion: (Sine,),
    schema.TapMotion: (Sine,),
    schema.TrajectoryMotion: _TRAJECTORY,
    schema.BaseTrajectoryMotion: _TRAJECTORY,
    schema.SweepMotion: (approach_curve, schema.SweepMotion),
    schema.EigenmodeTable: (Eigenmode,),
    schema.LeverTable: (Cantilever,),
    schema.ResonatorTable: (Cantilever,),
    schema.Run: (force_distance,),
    schema.SumSurface: (SumOfLaws,),
    schema.use_measured_tip: (read_tip_profile,),
    schema.fit_measured_moduli: (GeneralizedMaxwell.from_dma, GeneralizedMaxwell, read_dma),
    schema.use_tabulated_law: (read_law,),
}
"""What documents the keys of hand-written tables, and of functions that build."""

_PARAMETER = {"work_of_adhesion": "W", "file": "path"}
"""What a key is called where it is not called as in the table."""


def find_summary(table: type[schema.Table]) -> str:
    """Return in one sentence what a table describes."""
    return _strip_marks(_read_docstring(_find_documented(table)[0]).partition("\n\n")[0])


def find_help(table: type[schema.Table], key: str, constructor: Callable | None = None) -> str:
    """Return what a key of a table means, with its SI unit and bounds; "" if undocumented.

    ``constructor`` is the one of the table's that is to be called, if it matters.
    """
    first = (constructor,) if constructor else ()
    for documented in (*first, *_find_documented(table)):
        parameters = _read_parameters(documented)
        for name in (key, _PARAMETER.get(key, key)):
            if name in parameters:
                return parameters[name]
    return ""


def _find_documented(table: type[schema.Table]) -> tuple[Callable, ...]:
    """Return what builds a table's object, and so documents its keys."""
    if table in _STANDS_FOR:
        return _STANDS_FOR[table]
    if issubclass(table, schema.Solver):
        return (table.solver,)
    if issubclass(table, schema.FieldsTable):
        return (table.made,)
    if issubclass(table, schema.Thing):
        made = (_STANDS_FOR.get(make, (make,)) for make in table.constructors)
        return tuple(documented for several in made for documented in several)
    return (table,)


def _read_docstring(documented: Any) -> str:
    return inspect.getdoc(documented) or ""


@cache
def _read_parameters(documented: Any) -> dict[str, str]:
    """Return the texts of a docstring's section ``Parameters`` by name."""
    _, heading, section = _read_docstring(documented).partition("Parameters\n----------\n")
    section = re.split(r"\n\n\w[\w ]*\n-+\n", section)[0] if heading else ""
    found = {}
    for names, words in re.findall(r"^(\w[\w, ]*)\n((?:(?: .*)?(?:\n|$))+)", section, re.MULTILINE):
        found.update(dict.fromkeys(names.split(", "), _strip_marks(words)))
    return found


def _strip_marks(text: str) -> str:
    """Return text in one line, without marks for code and emphasis."""
    return re.sub(r"``|(?<!\w)\*(\w[^*]*)\*(?!\w)", r"\1", " ".join(text.split()))
