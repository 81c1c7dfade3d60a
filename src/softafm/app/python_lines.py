"""The Python that runs what a document describes: the lines a user would have written."""

import textwrap
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from decimal import Decimal
from json import dumps
from pathlib import Path
from typing import Any

import softafm as sa
from softafm.experiment.config import Experiment, experiment_from
from softafm.samples import NAMED

_WIDTH = 88
_STEP = " " * 4
_VERBS = {
    "force-distance": "force_distance",
    "force-spectroscopy": "force_spectroscopy",
    "tapping-cycle": "tapping_cycle",
    "approach-curve": "approach_curve",
}
_OPTIONS = {"tolerance": 1e-2, "profiles": False, "check": False, "regularise": None}
"""What modes take besides a solver, at its default."""


def python_lines(document: Mapping[str, Any], folder: Path) -> str:
    """Return Python that runs a document, to the last bit, and calls the dataset ``result``.

    Files, which are sought in ``folder`` here, are named as in the document.

    Raises
    ------
    ConfigError
        If the document describes no experiment.
    """
    experiment = experiment_from(document, folder)
    contact = experiment.contact
    lines = [
        f"tip = {_tip(contact.tip, document['tip'])}",
        f"sample = {_sample(contact.sample, document['sample'])}",
        f"surface = {_surface(contact.surface, document['surface'])}",
        "contact = sa.Contact(tip=tip, sample=sample, surface=surface)",
    ]
    if experiment.cantilever is not None:
        lines.append(f"cantilever = {_source(experiment.cantilever)}")
    arguments = ["contact", *(["cantilever"] if experiment.cantilever is not None else [])]
    if experiment.mode in ("force-distance", "force-spectroscopy"):
        lever = experiment.cantilever is not None
        lines.append(f"motion = {_motion(experiment.motion, document['motion'], lever)}")
        arguments.append("motion")
    else:
        arguments += _oscillation(experiment, document["motion"])
    arguments += _options(experiment)
    lines.append(f"result = {_call(f'sa.{_VERBS[experiment.mode]}', arguments)}")
    body = "\n".join(lines) + "\n"
    imports = ["import softafm as sa"]
    if "np." in body:
        imports.insert(0, "import numpy as np\n")
    for name in ("read_path", "read_trajectory"):
        if f"{name}(" in body:
            imports.append(f"from softafm.files.measured import {name}")
    return "\n".join(imports) + "\n\n" + body


def _tip(tip: Any, written: Mapping[str, Any]) -> str:
    if "file" in written:
        return f"sa.read_tip_profile({_value(written['file'])})"
    return _source(tip)


def _sample(sample: Any, written: Mapping[str, Any]) -> str:
    model = written["model"]
    if model in NAMED:
        given = [f"{key}={_value(value)}" for key, value in written.items() if key != "model"]
        return _call(f"sa.samples.{NAMED[model].__name__}", given)
    if "file" in written:
        given = [
            f"{key}={_value(written[key])}" for key in ("poisson", "per_decade") if key in written
        ]
        read = [_value(written["file"]), f"poisson={_value(written['poisson'])}"]
        moduli = f"*{_call('sa.read_dma', read)}"
        return _call("sa.GeneralizedMaxwell.from_dma", [moduli, *given])
    return _source(sample)


def _surface(law: Any, written: Mapping[str, Any]) -> str:
    if "file" in written:
        return f"sa.read_law({_value(written['file'])})"
    if "parts" in written:
        parts = zip(law.parts, written["parts"], strict=True)
        listed = "".join(f"{_surface(part, table)},\n" for part, table in parts)
        return _call("sa.SumOfLaws", [f"[\n{textwrap.indent(listed, _STEP)}]"])
    return _source(law)


def _motion(motion: Any, written: Mapping[str, Any], lever: bool) -> str:
    if "file" not in written:
        return _source(motion)
    given = [_value(written["file"]), *(['moves="base"'] if lever else [])]
    samples = f"*{_call('read_path', given)}"
    if motion.smooth:
        return _call("sa.Trajectory", [samples, "smooth=True"])
    if motion.noise is not None:
        noise = [f"noise={_value(motion.noise)}"] if "noise" in written else []
        return _call("sa.Trajectory.from_measurement", [samples, *noise])
    return _call("read_trajectory", given)


def _oscillation(experiment: Experiment, written: Mapping[str, Any]) -> list[str]:
    """Return the arguments that say how the tip oscillates."""
    motion = experiment.motion
    if experiment.mode == "tapping-cycle":
        names = ("amplitude", "mean_height", "frequency", "cycles")
        return [f"{name}={_value(getattr(motion, name))}" for name in names]
    ratios = _value(motion.amplitude_ratio)
    if "points" in written:
        ends = (_value(written[key]) for key in ("first_ratio", "last_ratio", "points"))
        ratios = f"np.linspace({', '.join(ends)})"
    arguments = [f"free_amplitude={_value(motion.free_amplitude)}", f"amplitude_ratio={ratios}"]
    if motion.drive_frequency is not None:
        arguments.append(f"drive_frequency={_value(motion.drive_frequency)}")
    return arguments


def _options(experiment: Experiment) -> list[str]:
    solver = experiment.solver
    given = [] if solver is None else [f"solver={_source(solver)}"]
    for name, default in _OPTIONS.items():
        value = getattr(experiment, name)
        if value != default:
            given.append(f"{name}={_value(value)}")
    return given


def _source(thing: Any) -> str:
    """Return the call that makes a dataclass of ours."""
    name = type(thing).__name__
    home = "sa" if getattr(sa, name, None) is type(thing) else "sa.solvers"
    return _call(f"{home}.{name}", _arguments(thing))


def _arguments(thing: Any) -> list[str]:
    """Return what a dataclass is made of, without what is at its default."""
    return [
        f"{field.name}={_value(getattr(thing, field.name))}"
        for field in fields(thing)
        if field.default is MISSING or getattr(thing, field.name) != field.default
    ]


def _value(value: Any) -> str:
    if is_dataclass(value):
        return _source(value)
    if isinstance(value, tuple | list):
        entries = ", ".join(map(_value, value)) + ("," if len(value) == 1 else "")
        if len(entries) <= _WIDTH - 20:
            return f"({entries})"
        return f"(\n{textwrap.indent(textwrap.fill(entries, _WIDTH - 8), _STEP)},\n)"
    if isinstance(value, float):
        return _number(value)
    return dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)


def _number(value: float) -> str:
    """Write a number exactly, and as briefly as one would: 2e9, 4.96e-8, 0.49."""
    plain = repr(value)
    short = f"{Decimal(plain).normalize():e}".replace("e+", "e")
    return short if "e" in plain or len(plain) > len(short) + 1 else plain


def _call(name: str, arguments: list[str]) -> str:
    line = f"{name}({', '.join(arguments)})"
    if len(line) <= _WIDTH - 10 and "\n" not in line:
        return line
    listed = "".join(f"{argument},\n" for argument in arguments)
    return f"{name}(\n{textwrap.indent(listed, _STEP)})"
