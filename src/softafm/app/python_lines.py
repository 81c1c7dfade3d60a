"""The Python that runs what a document describes: the lines a user would have written."""

import textwrap
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from decimal import Decimal
from json import dumps
from pathlib import Path
from typing import Any

import softafm as sa
from softafm.experiment.config import Experiment, build_experiment
from softafm.modes import MODES
from softafm.samples import NAMED

_WIDTH = 88
_STEP = " " * 4
_OPTIONS = {"tolerance": 1e-2, "profiles": False, "check": False, "regularise": "auto"}
"""What modes take besides a solver, at its default."""


def write_python(document: Mapping[str, Any], folder: Path) -> str:
    """Return Python that runs a document, to the last bit, and calls the dataset ``result``.

    Files, which are sought in ``folder`` here, are named as in the document.

    Raises
    ------
    ConfigError
        If the document describes no experiment.
    """
    experiment = build_experiment(document, folder)
    contact = experiment.contact
    lines = [
        f"tip = {_write_tip(contact.tip, document['tip'])}",
        f"sample = {_write_sample(contact.sample, document['sample'])}",
        f"surface = {_write_surface(contact.surface, document['surface'])}",
        "contact = sa.Contact(tip=tip, sample=sample, surface=surface)",
    ]
    arguments = ["contact"]
    mode, written = MODES[experiment.mode], document["motion"]
    if mode.lever:
        lines.append(f"cantilever = {_write_call_of(experiment.cantilever)}")
        arguments.append("cantilever")
    if mode.takes_motion:
        lines.append(f"motion = {_write_motion(experiment.motion, written, bool(mode.lever))}")
        arguments.append("motion")
    else:
        given = mode.arguments(experiment.motion).items()
        arguments += [_argument(*each, written) for each in given if each[1] is not None]
    arguments += [f"{name}={_write_call_of(made)}" for name, made in experiment.tables.items()]
    arguments += _write_options(experiment)
    lines.append(f"result = {_write_call(_name(mode.function), arguments)}")
    body = "\n".join(lines) + "\n"
    made = (experiment.motion, *experiment.tables.values())
    return "\n".join(_imports(body, mode.function, *map(type, made))) + "\n\n" + body


def _imports(body: str, *used: Any) -> list[str]:
    """Return the lines that import what the body uses; ``used`` may be of a module of its own."""
    lines = ["import softafm as sa"]
    if "np." in body:
        lines.insert(0, "import numpy as np\n")
    for name in ("read_path", "read_trajectory"):
        if f"{name}(" in body:
            lines.append(f"from softafm.files.measured import {name}")
    for thing in used:
        if _name(thing) == thing.__name__ and f"{thing.__name__}(" in body:
            lines.append(f"from {thing.__module__} import {thing.__name__}")
    return lines


def _write_tip(tip: Any, written: Mapping[str, Any]) -> str:
    if "file" in written:
        return f"sa.read_tip_profile({_write_value(written['file'])})"
    return _write_call_of(tip)


def _write_sample(sample: Any, written: Mapping[str, Any]) -> str:
    model = written["model"]
    if model in NAMED:
        given = [f"{key}={_write_value(value)}" for key, value in written.items() if key != "model"]
        return _write_call(f"sa.samples.{NAMED[model].__name__}", given)
    if "file" in written:
        given = [
            f"{key}={_write_value(written[key])}"
            for key in ("poisson", "per_decade")
            if key in written
        ]
        read = [_write_value(written["file"]), f"poisson={_write_value(written['poisson'])}"]
        moduli = f"*{_write_call('sa.read_dma', read)}"
        return _write_call("sa.GeneralizedMaxwell.from_dma", [moduli, *given])
    return _write_call_of(sample)


def _write_surface(law: Any, written: Mapping[str, Any]) -> str:
    if "file" in written:
        return f"sa.read_law({_write_value(written['file'])})"
    if "parts" in written:
        parts = zip(law.parts, written["parts"], strict=True)
        listed = "".join(f"{_write_surface(part, table)},\n" for part, table in parts)
        return _write_call("sa.SumOfLaws", [f"[\n{textwrap.indent(listed, _STEP)}]"])
    return _write_call_of(law)


def _write_motion(motion: Any, written: Mapping[str, Any], lever: bool) -> str:
    if "file" not in written:
        return _write_call_of(motion)
    given = [_write_value(written["file"]), *(['moves="base"'] if lever else [])]
    samples = f"*{_write_call('read_path', given)}"
    if motion.smooth:
        return _write_call("sa.Trajectory", [samples, "smooth=True"])
    if motion.noise is not None:
        noise = [f"noise={_write_value(motion.noise)}"] if "noise" in written else []
        return _write_call("sa.Trajectory.from_measurement", [samples, *noise])
    return _write_call("read_trajectory", given)


def _argument(name: str, value: Any, written: Mapping[str, Any]) -> str:
    """Return an argument of a mode; evenly spaced ones as they were written."""
    if name == "amplitude_ratio" and "points" in written:
        ends = (_write_value(written[key]) for key in ("first_ratio", "last_ratio", "points"))
        return f"{name}=np.linspace({', '.join(ends)})"
    return f"{name}={_write_value(value)}"


def _write_options(experiment: Experiment) -> list[str]:
    solver = experiment.solver
    given = [] if solver is None else [f"solver={_write_call_of(solver)}"]
    for name, default in _OPTIONS.items():
        value = getattr(experiment, name)
        if value != default:
            given.append(f"{name}={_write_value(value)}")
    return given


def _write_call_of(thing: Any) -> str:
    """Return the call that makes a dataclass of ours."""
    return _write_call(_name(type(thing)), _list_arguments(thing))


def _name(thing: Any) -> str:
    """Return what a class or function is called, by a name of ``softafm`` if it has one."""
    name = thing.__name__
    homes = {"sa": sa, "sa.solvers": sa.solvers}
    own = (f"{short}.{name}" for short, home in homes.items() if getattr(home, name, None) is thing)
    return next(own, name)


def _list_arguments(thing: Any) -> list[str]:
    """Return what a dataclass is made of, without what is at its default."""
    return [
        f"{field.name}={_write_value(getattr(thing, field.name))}"
        for field in fields(thing)
        if field.default is MISSING or getattr(thing, field.name) != field.default
    ]


def _write_value(value: Any) -> str:
    if is_dataclass(value):
        return _write_call_of(value)
    if isinstance(value, tuple | list):
        entries = ", ".join(map(_write_value, value)) + ("," if len(value) == 1 else "")
        if len(entries) <= _WIDTH - 20:
            return f"({entries})"
        return f"(\n{textwrap.indent(textwrap.fill(entries, _WIDTH - 8), _STEP)},\n)"
    if isinstance(value, float):
        return _write_number(value)
    return dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)


def _write_number(value: float) -> str:
    """Write a number exactly, and as briefly as one would: 2e9, 4.96e-8, 0.49."""
    plain = repr(value)
    short = f"{Decimal(plain).normalize():e}".replace("e+", "e")
    return short if "e" in plain or len(plain) > len(short) + 1 else plain


def _write_call(name: str, arguments: list[str]) -> str:
    line = f"{name}({', '.join(arguments)})"
    if len(line) <= _WIDTH - 10 and "\n" not in line:
        return line
    listed = "".join(f"{argument},\n" for argument in arguments)
    return f"{name}(\n{textwrap.indent(listed, _STEP)})"
