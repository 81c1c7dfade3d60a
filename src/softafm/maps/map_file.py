"""Map files: TOML that states what lies where on a sample, and how it is imaged."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from softafm.checks.refusals import ConfigError, join_with_or, refuse_unknown, reword, show, suggest
from softafm.experiment.config import build_table, load_document, set_value
from softafm.experiment.entries import Frequency, Length, Ratio, Regularised, Tolerance, make_choice
from softafm.experiment.schema import Table, build_choice, build_kind
from softafm.experiment.takers import MAP_MODES, refuse_unless
from softafm.maps.imaging import AmplitudeModulation, ForceVolume
from softafm.maps.map_tables import PATTERNS
from softafm.maps.sample_map import SampleMap
from softafm.maps.scan import scan
from softafm.modes import MODES, Mode, approach, force_distance, spectroscopy
from softafm.modes.regularise import Regularise
from softafm.progress import Progress

if TYPE_CHECKING:
    from xarray import Dataset

_BRANCHES = ("approach", "attractive", "repulsive")


class SetpointMotion(Table):
    """``[motion]`` of a tapping map."""

    free_amplitude: Length
    setpoint: Ratio
    drive_frequency: Frequency | None = None
    engaged: make_choice({name: name for name in _BRANCHES}) = "approach"  # type: ignore[valid-type]


class MapRun(Table):
    """``[run]`` of a map."""

    tolerance: Tolerance = 1e-2
    regularise: Regularised = "auto"


@dataclass(frozen=True, eq=False)
class MapExperiment:
    """What a map file describes, ready to be scanned.

    Parameters
    ----------
    sample, imaging, tolerance, regularise
        What ``softafm.scan`` takes.
    materials
        Names of the sample's materials.
    document
        The file's tables as they were written, overrides included.
    """

    sample: SampleMap
    imaging: AmplitudeModulation | ForceVolume
    materials: tuple[str, ...]
    tolerance: float
    regularise: Regularise
    document: Mapping[str, Any]

    def run(self, workers: int = 1, progress: bool | Progress | None = None) -> "Dataset":
        """Scan the sample; ConfigError if ``scan`` refuses a value of the file."""
        try:
            result = scan(
                self.sample, self.imaging, tolerance=self.tolerance, regularise=self.regularise,
                workers=workers, progress=progress,
            )  # fmt: skip
        except ValueError as error:
            raise ConfigError([_reword(self.document, error)]) from error
        if "material" in result:
            result["material"].attrs |= {
                "flag_values": [float(i) for i in range(len(self.materials))],
                "flag_meanings": " ".join(name.replace(" ", "_") for name in self.materials),
            }
        return result


def load_map(path: str | Path, overrides: Sequence[str] = ()) -> MapExperiment:
    """Read a TOML map file, replacing values by overrides such as ``"motion.setpoint=0.5"``.

    Raises
    ------
    ConfigError
        If the file cannot be read or describes no map; each line of the message names a field, the
        value given and what would be valid.
    """
    path = Path(path)
    document = load_document(path)
    for override in overrides:
        set_value(document, override)
    return build_map(document, path.parent)


def build_map(document: Mapping[str, Any], folder: Path) -> MapExperiment:
    """Build the map that a file's tables describe; its images are in ``folder``.

    Raises
    ------
    ConfigError
        As ``load_map``.
    """
    mode = document.get("mode")
    if isinstance(mode, str) and mode in MODES:
        refuse_unless(document, "scan")
    if mode is None:
        raise ConfigError([f"mode: missing; must be {join_with_or(MAP_MODES)}"])
    if mode not in MAP_MODES:
        raise ConfigError([f"mode = {show(mode)}: {suggest(mode, MAP_MODES)}"])
    known = ["mode", "tip", "cantilever", "motion", "map", "run"]
    problems = [refuse_unknown(key, known, key) for key in document if key not in known]

    def read(name: str, build: Callable[[dict[str, Any]], Any]) -> Any:
        try:
            if name not in document:
                raise ConfigError([f"{name}: missing; add a table [{name}]"])
            if not isinstance(document[name], dict):
                raise ConfigError([f"{name} = {show(document[name])}: must be a table, [{name}]"])
            return build(document[name])
        except ConfigError as error:
            problems.extend(str(error).splitlines())

    def as_of(mode: Mode, name: str) -> Any:
        """Read a table as experiments of a mode do."""
        return read(name, lambda written: build_table(name, document, mode, folder))

    tip = as_of(force_distance.MODE, "tip")
    if mode == "tapping-map":
        lever = as_of(approach.MODE, "cantilever")
        motion = read("motion", lambda t: build_kind("motion", t, SetpointMotion, folder=folder))
    else:
        lever = as_of(spectroscopy.MODE, "cantilever") if "cantilever" in document else None
        motion = as_of(force_distance.MODE, "motion")
    table = read(
        "map",
        lambda t: build_choice("map", t, "pattern", PATTERNS, default="uniform", folder=folder),
    )
    run = MapRun()
    if "run" in document:
        run = read("run", lambda t: build_kind("run", t, MapRun, folder=folder))
    if problems:
        raise ConfigError(problems)
    _refuse_flow(mode, table.materials)
    imaging: AmplitudeModulation | ForceVolume
    try:
        if mode == "tapping-map":
            imaging = AmplitudeModulation(lever, **dict(motion))
        else:
            imaging = ForceVolume(motion, lever)
    except ValueError as error:
        raise ConfigError([reword("motion", document["motion"], error) or str(error)]) from None
    try:
        sample = table.sample_map(tip)
        _ = sample.pixels
    except ConfigError:
        raise
    except ValueError as error:
        raise ConfigError([reword("map", document["map"], error) or f"map: {error}"]) from error
    names = tuple(each.name or str(i) for i, each in enumerate(table.materials))
    return MapExperiment(sample, imaging, names, run.tolerance, run.regularise, document)


def _refuse_flow(mode: str, materials: Sequence[Any]) -> None:
    """Raise ConfigError if a material that flows is to be tapped."""
    for index, each in enumerate(materials):
        if mode == "tapping-map" and each.sample.compliance.fluidity > 0:
            raise ConfigError(
                [
                    f"map.materials[{index}].sample: '{each.sample.kind}' flows, so that the tip "
                    "sinks deeper with every tap; use mode = 'force-volume', or another sample"
                ]
            )


def _reword(document: Mapping[str, Any], error: ValueError) -> str:
    """Word what a scan refuses by what the user wrote."""
    written = document["motion"]
    match = re.fullmatch(r"(pixel \(\d+, \d+\)): start height = \S+ m: (.*)", str(error))
    key = next((key for key in ("start", "mean_height", "file") if key in written), None)
    if match is None or key is None:
        return f"map: {error}"
    return f"motion.{key} = {show(written[key])}: {match[2]} at {match[1]}"
