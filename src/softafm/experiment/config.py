"""Experiment files: TOML with units as text, read into the objects a Python user would build."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from softafm.checks.paths import explain_no_file
from softafm.checks.refusals import ConfigError, join_with_or, refuse_unknown, reword, show, suggest
from softafm.contact import Contact
from softafm.experiment import schema
from softafm.experiment.takers import refuse_result, refuse_unless
from softafm.experiment.toml_text import parse
from softafm.instrument.motion import is_steady
from softafm.modes import MODES, Inputs, Mode, Settings
from softafm.modes.check import plan_finer_run
from softafm.modes.perform import simulate
from softafm.modes.regularise import Regularise, is_beyond, regularise_contact
from softafm.modes.start import refuse_start_inside, refuse_unable
from softafm.solvers.solver import Solver

if TYPE_CHECKING:
    from xarray import Dataset

LARGEST_FILE = 1_000_000
_MOST_NAMES = 8
"""How many tables deep an override may go."""
_TABLES = ("tip", "sample", "surface", "motion")
_OPTIONAL_TABLES = ("solver", "run")


@dataclass(frozen=True)
class Experiment:
    """What an experiment file describes, ready to run.

    Parameters
    ----------
    mode
        Name of one of the ``softafm.modes.MODES``.
    contact, motion
        What touches, and what the mode takes besides: how the tip moves, or the base of its
        cantilever, or the parameters of such motions.
    cantilever
        What carries the tip, in a mode that needs one.
    solver
        An object from ``softafm.solvers``, or None for the default one.
    tolerance, profiles, check, regularise
        As in ``softafm.force_distance``.
    tables
        What the further tables of the mode describe, by name.
    document
        The file's tables as they were written, overrides included.
    """

    mode: str
    contact: Contact
    motion: Any
    cantilever: Any = None
    solver: Solver | None = None
    tolerance: float = 1e-2
    profiles: bool = False
    check: bool = False
    regularise: Regularise = "auto"
    tables: Mapping[str, Any] = field(default_factory=dict)
    document: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)

    @property
    def inputs(self) -> Inputs:
        """What the mode is applied to."""
        return Inputs(self.contact, self.motion, self.cantilever, self.tables)

    def run(self, progress: bool | Callable[[float, str], None] | None = None) -> "Dataset":
        """Call the mode's public function and return its dataset.

        Raises
        ------
        ConfigError
            If the mode refuses a value of the file.
        """
        mode = MODES[self.mode]
        options = {
            name: getattr(self, name) for name in ("solver", "tolerance", "check", "regularise")
        }
        if mode.takes_profiles:
            options["profiles"] = self.profiles
        lever = {"cantilever": self.cantilever} if mode.lever else {}
        with self._worded_as_written():
            return mode.function(
                self.contact, **lever, **mode.arguments(self.motion), **self.tables, **options,
                progress=progress,
            )  # fmt: skip

    def observables(self) -> dict[str, Any]:
        """Return what ``run`` observes by name, without its dataset: that takes a while of its own.

        Raises
        ------
        ConfigError
            As ``run``.
        """
        if self.check or is_beyond(self.contact, MODES[self.mode], self.motion):
            return {str(name): found.values for name, found in self.run().variables.items()}
        with self._worded_as_written():
            mode = MODES[self.mode]
            contact = regularise_contact(self.contact, self.regularise, mode, self.motion)
            settings = Settings(self.solver, self.tolerance)
            inputs = self.inputs._replace(contact=contact)
            found = simulate(mode, inputs, settings)
        return {name: values for name, (_, values) in found.data.items()}

    @contextmanager
    def _worded_as_written(self) -> Iterator[None]:
        """Reword what a mode refuses with what the file says."""
        try:
            yield
        except ValueError as error:
            for table in ("motion", "run"):
                line = reword(table, self.document.get(table, {}), error)
                if line is not None:
                    raise ConfigError([line]) from error
            raise


def load_experiment(path: str | Path, overrides: Sequence[str] = ()) -> Experiment:
    """Read a TOML experiment file, replacing values by overrides such as ``"sample.E0=3GPa"``.

    Raises
    ------
    ConfigError
        If the file cannot be read or describes no valid experiment; each line of the message names
        a field, the value given and what would be valid.
    """
    path = Path(path)
    document = load_document(path)
    set_values(document, overrides)
    return build_experiment(document, path.parent)


def list_examples() -> list[str]:
    """Return the names of the bundled experiment files."""
    return _list_bundled("examples")


def list_maps() -> list[str]:
    """Return the names of the bundled map files, which ``softafm scan`` takes."""
    return _list_bundled("examples", "maps")


def _list_bundled(*folders: str) -> list[str]:
    folder = resources.files("softafm").joinpath(*folders)
    return sorted(f.name[:-5] for f in folder.iterdir() if f.name.endswith(".toml"))


def read_example(name: str) -> str:
    """Return a bundled experiment or map file; ConfigError if there is none of that name."""
    known = [*list_examples(), *list_maps()]
    if name not in known:
        raise ConfigError([f"example {show(name)}: unknown; {suggest(name, known)}"])
    folders = ("examples", "maps") if name in list_maps() else ("examples",)
    file = resources.files("softafm").joinpath(*folders, f"{name}.toml")
    return file.read_text(encoding="utf-8")


def load_document(path: str | Path) -> dict[str, Any]:
    """Return the tables of a TOML file; ConfigError if it cannot be read."""
    path, name = Path(path), str(path)
    try:
        refuse_result(path)
        if not path.is_file():
            raise ConfigError([f"{name}: {explain_no_file(path)}"])
        size = path.stat().st_size
        if size > LARGEST_FILE:
            raise ConfigError(
                [f"{name}: is {size / 1e6:.1f} MB large; an experiment file has at most 1 MB"]
            )
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise ConfigError([f"{name}: {error.strerror or error}"]) from None
    except UnicodeDecodeError as error:
        _refuse_other_than_toml(path)
        raise ConfigError(
            [f"{name}: is not text in UTF-8 (byte {error.start}); save it as UTF-8"]
        ) from None
    try:
        return parse_document(text, name)
    except ConfigError:
        _refuse_other_than_toml(path)
        raise


def _refuse_other_than_toml(path: Path) -> None:
    """Of a file that cannot be read and is called otherwise, no line and column are of help."""
    if path.suffix.lower() not in ("", ".toml"):
        raise ConfigError(
            [f"{path}: is not a TOML file; experiments are described in one, such as 'tap.toml'"]
        ) from None


def parse_document(text: str, name: str) -> dict[str, Any]:
    """Return the tables of an experiment file's text; ``name`` is what a ConfigError calls it."""
    if not text.strip():
        raise ConfigError([f"{name}: is empty; 'softafm example' shows what it may hold"])
    try:
        return parse(text)
    except ValueError as error:
        raise ConfigError([f"{name}: {error}"]) from None


def set_values(document: dict[str, Any], overrides: Sequence[str]) -> None:
    """Set values of a document, in place, by a list of what ``set_value`` takes.

    Raises
    ------
    ConfigError
        As ``set_value``, and for one text that is not in a list.
    """
    if isinstance(overrides, str):
        raise ConfigError(
            [f"overrides = {show(overrides)}: must be a list of such texts, [{overrides!r}]"]
        )
    for override in overrides:
        set_value(document, override)


def set_value(document: dict[str, Any], override: str) -> None:
    """Set one value of a document by an override such as ``"sample.E0=3GPa"``, in place.

    Raises
    ------
    ConfigError
        If it is not of this form, or a value is where a table would be.
    """
    key, equals, text = override.partition("=")
    names = [name.strip() for name in key.split(".")]
    if not equals or not all(names) or len(names) > _MOST_NAMES:
        raise ConfigError([f"override {show(override)}: must be key=value, such as sample.E0=3GPa"])
    table = document
    for depth, name in enumerate(names[:-1], start=1):
        table = table.setdefault(name, {})
        if not isinstance(table, dict):
            parent = ".".join(names[:depth])
            raise ConfigError([f"override {show(override)}: {parent} is a value, not a table"])
    table[names[-1]] = parse_value(text.strip())


def parse_value(text: str) -> Any:
    """Read a number, flag or list as in TOML; anything else is text that needs no quotes."""
    try:
        parsed = parse(f"value = {text}")
    except ValueError:
        return text
    return parsed["value"] if len(parsed) == 1 else text


def build_experiment(
    document: Mapping[str, Any], folder: Path, build: Callable[..., Any] | None = None
) -> Experiment:
    """Build the experiment that a file's tables describe; other files are sought in ``folder``.

    ``build`` may take the place of ``build_table``.

    Raises
    ------
    ConfigError
        As ``load_experiment``.
    """
    refuse_unless(document, "run")
    problems: list[str] = []
    name = document.get("mode")
    mode = MODES.get(name) if isinstance(name, str) else None
    further = () if mode is None else tuple(mode.tables)
    known = ["mode", *_TABLES, "cantilever", *further, *_OPTIONAL_TABLES]
    problems += [refuse_unknown(key, known, key) for key in document if key not in known]
    if name is None:
        problems.append(f"mode: missing; must be {join_with_or(list(MODES))}")
    elif mode is None:
        problems.append(f"mode = {show(name)}: {suggest(name, list(MODES))}")

    tables = [*_TABLES, *further, *(each for each in _OPTIONAL_TABLES if each in document)]
    if mode is None:
        tables.remove("motion")
    elif mode.lever:
        tables.append("cantilever")
    elif "cantilever" in document:
        levers = [each.name for each in MODES.values() if each.lever]
        problems.append(
            f"cantilever: not used with mode = '{mode.name}'; leave it out, or use the mode "
            f"{join_with_or(levers)}"
        )
    built: dict[str, Any] = {}
    for table in tables:
        try:
            built[table] = (build or build_table)(table, document, mode, folder)
        except ConfigError as error:
            problems += str(error).splitlines()
    run, solver = built.get("run", schema.Run()), built.get("solver")
    problems += _list_unusable(run, solver, mode)
    if problems or mode is None:
        raise ConfigError(problems)
    contact = Contact(tip=built["tip"], sample=built["sample"], surface=built["surface"])
    _refuse_flow(contact, mode, built["motion"], document["motion"])
    _refuse_run(contact, solver, run, document, mode, built["motion"])
    if mode.simulate is None:
        used = regularise_contact(contact, run.regularise, mode, built["motion"])
        _refuse_motion(used, mode.find_path(built["motion"]), solver, document["motion"])
    return Experiment(
        mode=mode.name,
        contact=contact,
        motion=built["motion"],
        cantilever=built.get("cantilever"),
        solver=solver,
        tolerance=run.tolerance,
        profiles=run.profiles,
        check=run.check,
        regularise=run.regularise,
        tables={each: built[each] for each in further},
        document=document,
    )


def _list_unusable(run: schema.Run, solver: Solver | None, mode: Mode | None) -> Iterator[str]:
    """Yield a line for each option of a run that its solver or its mode cannot use."""
    if solver is not None and not solver.adaptive and "tolerance" in run.model_fields_set:
        yield (
            f"run.tolerance = {run.tolerance}: the solver '{solver.kind}' takes fixed steps, which "
            "no tolerance changes; leave it out and use solver.steps"
        )
    if run.profiles and mode is not None and not mode.takes_profiles:
        yield (
            f"run.profiles = True: not used with mode = '{mode.name}', which keeps observables "
            "and no shapes of the surface; leave it out"
        )


def _refuse_run(
    contact: Contact,
    solver: Solver | None,
    run: schema.Run,
    document: Mapping[str, Any],
    mode: Mode,
    motion: Any,
) -> None:
    """Raise ConfigError if the run cannot be checked, or the contact not be regularised."""
    written = document.get("run", {})
    try:
        plan_finer_run(run.check, solver, run.tolerance)
        regularise_contact(contact, run.regularise, mode, motion)
    except ValueError as error:
        key = "check" if str(error).startswith("check") else "regularise"
        reason = str(error).removeprefix("check = True: ")
        raise ConfigError([f"run.{key} = {show(written[key])}: {reason}"]) from None


def _refuse_flow(contact: Contact, mode: Mode, motion: Any, written: dict[str, Any]) -> None:
    """Raise ConfigError if cycles are to be steady on a sample that flows."""
    if contact.body.compliance.fluidity == 0:
        return
    if mode.steady:
        raise ConfigError(
            [
                f"mode = '{mode.name}': cannot be used, as the sample '{contact.sample.kind}' "
                "flows and the tip sinks deeper with every cycle"
            ]
        )
    if is_steady(motion):
        given = "'steady'" if "cycles" in written else "missing"
        raise ConfigError(
            [
                f"motion.cycles: {given}; must be a number, as the sample '{contact.sample.kind}' "
                "flows and the tip sinks deeper with every cycle"
            ]
        )


def _refuse_motion(
    contact: Contact, motion: Any, solver: Solver | None, written: dict[str, Any]
) -> None:
    """Raise ConfigError if the motion starts inside the surface or the solver cannot follow it."""
    try:
        refuse_start_inside(contact, motion)
    except ValueError as error:
        key = next((key for key in ("start", "mean_height", "file") if key in written), None)
        place = "motion" if key is None else f"motion.{key} = {show(written[key])}"
        raise ConfigError([f"{place}: {error}"]) from None
    try:
        refuse_unable(solver, motion)
    except ValueError as error:
        raise ConfigError([reword("motion", written, error) or str(error)]) from None


def build_table(name: str, document: Mapping[str, Any], mode: Mode | None, folder: Path) -> Any:
    """Return the object that a table describes, having made sure that solvers can use it.

    The mode matters for ``motion``, ``cantilever`` and its further tables alone.
    """
    if name not in document:
        raise ConfigError([f"{name}: missing; add a table [{name}]"])
    written = document[name]
    if not isinstance(written, dict):
        raise ConfigError([f"{name} = {show(written)}: must be a table, [{name}]"])
    if name == "run":
        return schema.build_kind(name, written, schema.Run, folder=folder)
    if name == "cantilever":
        table = schema.cantilever_of(mode) if mode is not None else None
        return schema.build_kind(name, written, table or schema.LeverTable, folder=folder)
    if mode is not None and name in mode.tables:
        return schema.build_kind(name, written, schema.table_of(mode.tables[name]), folder=folder)
    if name == "motion" and mode is not None:
        shapes = schema.motions_of(mode)
        default = next(iter(shapes))
        return schema.build_choice(name, written, "shape", shapes, default=default, folder=folder)
    thing = schema.build_choice(name, written, *schema.CHOICES[name], folder=folder)
    try:
        # Both are found when first asked for, and may not exist.
        if name == "sample":
            _ = thing.compliance
        elif name == "surface" and thing.attracts:
            _ = thing.equilibrium_gap
    except ValueError as error:
        key = "window" if name == "sample" else "law"
        reason = str(error).removeprefix(f"surface law '{thing.kind}': ")
        raise ConfigError([f"{name}.{key} = {show(written.get(key))}: {reason}"]) from error
    return thing
