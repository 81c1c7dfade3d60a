"""The table ``[map]`` of a map file: what lies where."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field, ValidationInfo, create_model, field_validator

from softafm.checks.refusals import ConfigError, show
from softafm.contact import Contact
from softafm.experiment import schema
from softafm.experiment.config import build_table
from softafm.experiment.entries import Entries, Extent, Image, Length, Number, Pixels, Ratio, Whole
from softafm.experiment.schema import Table, build_kind
from softafm.maps.patterns import make_blend
from softafm.maps.sample_map import SampleMap, find_grey_values, refuse_unknown

_ENDS = ("from", "to")


class Material(Table):
    """``[[map.materials]]``: a sample and a surface law, as in an experiment file."""

    name: str = ""
    sample: Annotated[Any, Field(description="a table like [sample]")]
    surface: Annotated[Any, Field(description="a table like [surface]")]

    @field_validator("sample", "surface")
    @classmethod
    def _build(cls, written: Any, info: ValidationInfo) -> Any:
        name = str(info.field_name)
        return build_table(name, {name: written}, None, _find_folder(info))


class ImageTable(Table):
    """``{ image = "grey.png", from = ..., to = ... }``: values of black and of white."""

    image: Image

    def build(self) -> np.ndarray:
        low, high = (getattr(self, end) for end in _ENDS)
        raw = low is None and high is None and _is_array(self.image)
        if not raw and (low is None or high is None):
            raise ValueError("give from and to, the values of black and of white")
        try:
            values = _read_array(self.image) if raw else _read_grey(self.image)
        except ValueError as error:
            raise ValueError(f"image = {self.image.name}: {error}") from None
        return values if raw else low + (high - low) * values


@cache
def _make_image_table(kind: Any) -> type[Table]:
    """Return the table of an image whose values are written so."""
    keys: dict[str, Any] = dict.fromkeys(_ENDS, (kind | None, None))
    return create_model("ImageTable", __base__=ImageTable, **keys)


class MapTable(Table):
    """``[map]``, whatever its pattern."""

    materials_needed: ClassVar[int | None] = None
    size: Extent
    materials: Annotated[Entries, Field(description="tables [[map.materials]]")]
    fields: Any = None
    height: Any = None

    @field_validator("materials")
    @classmethod
    def _build_materials(cls, written: tuple[Any, ...], info: ValidationInfo) -> tuple[Any, ...]:
        found, problems = [], []
        for index, each in enumerate(written):
            name = f"materials[{index}]"
            if not isinstance(each, dict):
                raise ConfigError([f"{name} = {show(each)}: must be a table, [[map.materials]]"])
            try:
                found.append(build_kind(name, each, Material, folder=_find_folder(info)))
            except ConfigError as error:
                problems += str(error).splitlines()
        if problems:
            raise ConfigError(problems)
        needed = cls.materials_needed
        if needed is not None and len(found) != needed:
            raise ConfigError(
                [
                    f"materials: are {len(found)}; this pattern takes {needed}, the pattern "
                    "'labels' any number"
                ]
            )
        return tuple(found)

    @field_validator("fields")
    @classmethod
    def _build_fields(cls, written: Any, info: ValidationInfo) -> dict[str, np.ndarray]:
        if not isinstance(written, dict):
            raise ValueError("must be a table, [map.fields]")
        found, problems = {}, []
        for name, each in _flatten(written):
            path = f'fields."{name}"'
            try:
                for material in info.data.get("materials", ()):
                    _refuse_unknown(path, name, material)
                kind = schema.KEYS.get(name.partition(".")[2], Number)
                found[name] = _read_values(path, each, kind, info)
            except ConfigError as error:
                problems += str(error).splitlines()
        if problems:
            raise ConfigError(problems)
        return found

    @field_validator("height")
    @classmethod
    def _build_height(cls, written: Any, info: ValidationInfo) -> np.ndarray:
        return _read_values("height", written, Length, info)

    def sample_map(self, tip: Any) -> SampleMap:
        """Return the sample; ValueError if arrays do not fit each other or the materials."""
        contacts = [Contact(tip, each.sample, each.surface) for each in self.materials]
        return self._assign(contacts)

    def _assign(self, contacts: list[Contact], labels: Any = None) -> SampleMap:
        return SampleMap(contacts, self.size, self.fields or {}, labels, self.height)

    def _blend(self, share: np.ndarray, contacts: list[Contact]) -> SampleMap:
        one, other = contacts
        try:
            mixed = SampleMap.mixed(share, one, other, self.size)
        except ValueError as error:
            reason = str(error).replace("give labels", "use the pattern 'labels'")
            raise ConfigError([f"map.materials: {reason}"]) from None
        height = mixed.height if self.height is None else self.height
        return replace(mixed, fields={**mixed.fields, **(self.fields or {})}, height=height)


class UniformMap(MapTable):
    """``[map] pattern = "uniform"``: one material, of which fields or the height vary."""

    materials_needed: ClassVar[int | None] = 1

    def sample_map(self, tip: Any) -> SampleMap:
        if not self.fields and self.height is None:
            raise ValueError("give fields, height or a pattern, as nothing varies")
        return super().sample_map(tip)


class BlendMap(MapTable):
    """``[map] pattern = "blend"``: domains of the second material in the first."""

    materials_needed: ClassVar[int | None] = 2
    pixels: Pixels
    feature: Length
    share: Ratio
    interphase: Length = 0.0
    seed: Whole = 0

    def sample_map(self, tip: Any) -> SampleMap:
        if not 0 <= self.seed < 2**63:
            raise ValueError(f"seed = {self.seed}: must be a whole number of at least 0")
        share = make_blend(
            self.pixels[::-1], self.size, feature=self.feature, share=self.share,
            interphase=self.interphase, seed=self.seed,
        )  # fmt: skip
        contacts = [Contact(tip, each.sample, each.surface) for each in self.materials]
        return self._blend(share, contacts) if self.interphase else self._assign(contacts, share)


class ShareMap(MapTable):
    """``[map] pattern = "share"``: grey values are the share of the second material."""

    materials_needed: ClassVar[int | None] = 2
    file: Image

    def sample_map(self, tip: Any) -> SampleMap:
        contacts = [Contact(tip, each.sample, each.surface) for each in self.materials]
        return self._blend(_read(_read_grey, self.file), contacts)


class LabelMap(MapTable):
    """``[map] pattern = "labels"``: a grey for each material, or an array of their numbers."""

    file: Image

    def sample_map(self, tip: Any) -> SampleMap:
        contacts = [Contact(tip, each.sample, each.surface) for each in self.materials]
        if _is_array(self.file):
            return self._assign(contacts, _read(_read_array, self.file))
        grey = _read(_read_grey, self.file)
        levels, labels = np.unique(grey, return_inverse=True)
        if levels.size != len(contacts):
            raise ValueError(
                f"file = {self.file.name}: has {levels.size} greys, but there are {len(contacts)} "
                "materials; save it without compression losses and soft edges"
            )
        return self._assign(contacts, labels.reshape(grey.shape))


PATTERNS: dict[str, type[Table]] = {
    "uniform": UniformMap,
    "blend": BlendMap,
    "labels": LabelMap,
    "share": ShareMap,
}
"""What ``pattern`` in ``[map]`` can choose."""


def _find_folder(info: ValidationInfo) -> Path:
    return info.context["folder"] if info.context else Path()


def _flatten(written: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield fields by name; TOML makes tables within tables of keys without quotes."""
    for name, each in written.items():
        if name in ("sample", "surface") and isinstance(each, dict):
            yield from ((f"{name}.{key}", value) for key, value in each.items())
        else:
            yield name, each


def _refuse_unknown(path: str, name: str, material: Material) -> None:
    try:
        refuse_unknown(name, material)
    except ValueError as error:
        reason = str(error).removeprefix(f"field '{name}': ")
        raise ConfigError([f"{path}: {reason}"]) from None


def _read_values(path: str, written: Any, kind: Any, info: ValidationInfo) -> np.ndarray:
    """Return the array that an inline table of an image stands for."""
    if not isinstance(written, dict):
        raise ConfigError([f"{path} = {show(written)}: must be a table with image, from and to"])
    return build_kind(path, written, _make_image_table(kind), folder=_find_folder(info))


def _is_array(path: Path) -> bool:
    return path.suffix.lower() == ".npy"


def _read(read: Any, path: Path) -> np.ndarray:
    try:
        return read(path)
    except ValueError as error:
        raise ValueError(f"file = {path.name}: {error}") from None


def _read_grey(path: Path) -> np.ndarray:
    """Return the grey values of an image, or of an array from 0 to 1."""
    try:
        return find_grey_values(_read_array(path) if _is_array(path) else path)
    except ValueError as error:
        raise ValueError(str(error).removeprefix(f"{path}: ")) from None


def _read_array(path: Path) -> np.ndarray:
    """Return the array of an .npy file."""
    try:
        with path.open("rb") as file:
            return np.lib.format.read_array(file, allow_pickle=False)
    except OSError as error:
        raise ValueError(error.strerror or "cannot be read") from None
    except (ValueError, EOFError):
        raise ValueError("is not an array that NumPy saved") from None
