"""Which command takes a file that another one was given."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from softafm.checks.refusals import ConfigError

MAP_MODES = ("tapping-map", "force-volume")
_RESULTS = (".nc", ".h5")
_STORE = "'softafm sweep --status' says how far it is, softafm.load_sweep reads it in Python"


def refuse_unless(document: Mapping[str, Any], command: str) -> None:
    """Raise ConfigError if a file's tables are for another command: run, scan or sweep."""
    if "map" in document or document.get("mode") in MAP_MODES:
        key, what, taker = ("map" if "map" in document else "mode"), "a map", "scan"
    elif "sweep" in document:
        key, what, taker = "sweep", "a sweep", "sweep"
    else:
        key, what, taker = "mode", "an experiment", "run"
    if taker != command:
        raise ConfigError([f"{key}: the file describes {what}, which 'softafm {taker}' takes"])


def refuse_result(path: Path) -> None:
    """Raise ConfigError if what should be a TOML file is called as a result is."""
    if path.suffix.lower() in _RESULTS:
        raise ConfigError([f"{path}: is a result, which 'softafm plot' and 'softafm export' take"])
    if path.suffix.lower() == ".zarr":
        raise ConfigError([f"{path}: is the store of a sweep; {_STORE}"])


def refuse_other_than_result(path: Path) -> None:
    """Raise ValueError if what should be a result is called as a TOML file or a store is."""
    if path.suffix.lower() == ".toml":
        raise ValueError(
            f"{path}: is a file to be run, not a result; 'softafm run', 'scan' or 'sweep' takes it"
        )
    if path.suffix.lower() == ".zarr":
        raise ValueError(f"{path}: is the store of a sweep, not the result of a run; {_STORE}")
