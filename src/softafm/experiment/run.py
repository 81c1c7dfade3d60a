"""Run an experiment that is given as a file, as tables or as an object."""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from typing import TYPE_CHECKING, Any

from softafm.checks.kinds import refuse_other
from softafm.contact import Contact
from softafm.experiment.config import Experiment, build_experiment, load_experiment, set_values
from softafm.progress import Progress

if TYPE_CHECKING:
    from xarray import Dataset

Source = str | Path | Mapping[str, Any] | Experiment
"""What describes an experiment: the path of a TOML file, its tables, or what was read of them."""


def run(
    experiment: Source,
    overrides: Sequence[str] = (),
    progress: bool | Progress | None = None,
) -> "Dataset":
    """Run an experiment and return its result, as ``softafm run`` does.

    Parameters
    ----------
    experiment
        Path of a TOML file; or its tables as a dict, with units as text, such as
        ``{"mode": "tapping-cycle", "tip": {"shape": "paraboloid", "radius": "10 nm"}, ...}``, whose
        files are sought in the working folder; or what ``load_experiment`` returned.
    overrides
        Values that replace those of a file or a dict, such as ``["sample.E0=3GPa"]``.
    progress
        None, True for a bar, or a function that is called with a fraction and a message.

    Returns
    -------
    xarray.Dataset
        What the function of the experiment's mode returns, such as ``force_distance``.

    Raises
    ------
    ConfigError
        A ``ValueError``, before anything is computed, if the file cannot be read or describes no
        valid experiment; each line names a field, the value given and what would be valid.
    """
    return make_experiment(experiment, overrides).run(progress)


def make_experiment(source: Source, overrides: Sequence[str] = ()) -> Experiment:
    """Return the experiment that a file or its tables describe; the errors are those of ``run``."""
    if isinstance(source, Experiment):
        if overrides:
            raise ValueError(
                f"overrides = {list(overrides)}: must be empty for an Experiment, whose values are "
                "set; give them to load_experiment"
            )
        return source
    if isinstance(source, str | Path):
        return load_experiment(source, overrides)
    if isinstance(source, Contact):
        raise ValueError(
            f"experiment = {type(source).__name__}: must say how the tip moves, too; a contact "
            "itself has scales such as contact.tabor_relaxed, and the modes take it, such as "
            "force_distance"
        )
    wanted = "the path of a TOML file, a dict of its tables or what load_experiment returned"
    refuse_other("experiment", source, Mapping, wanted)
    document = {key: deepcopy(value) for key, value in source.items()}
    for key in document:
        refuse_other("key of an experiment", key, str, "the name of a table, such as 'tip'")
    set_values(document, overrides)
    return build_experiment(document, Path())
