"""A sample that is not the same everywhere: contacts over the pixels of an image."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.kinds import check_list, refuse_other
from softafm.checks.validate import check_positive, refuse_masked
from softafm.contact import Contact

_PARTS = ("sample", "surface")
_MOST_PIXELS = 4096 * 4096


class Pixels(NamedTuple):
    """The different contacts of a map and where they are."""

    contacts: list[Contact]
    number: np.ndarray
    """Which of them a pixel has, shape (ny, nx)."""
    place: np.ndarray
    """Where they stand among all contacts, each field from 0 to 1; shape (contacts, fields)."""
    label: np.ndarray
    """Which material they are made from, shape (contacts,)."""


@dataclass(frozen=True, eq=False)
class SampleMap:
    """A sample whose materials, moduli, creep time, adhesion or height vary over x and y.

    Every pixel is a flat half-space of its own with the properties of that pixel: nothing couples
    neighbours, and slopes of the topography do not count. So features should be wider than the
    contact. Rows of arrays run along y, downwards as in an image.

    Parameters
    ----------
    materials
        A ``Contact``, or several with one tip, among which ``labels`` choose.
    size
        Extent along x and y, m; a single number is that along x, of square pixels.
    fields
        Arrays (ny, nx) in SI of numeric fields of the sample or the surface law, such as
        ``"sample.E_inf"`` or ``"surface.hamaker"``, in the place of the materials' own.
        ``"surface.work_of_adhesion"`` sets that of a law at its own range.
    labels
        Number of the material of every pixel, (ny, nx); needed with several materials.
    height
        Height of the surface, m, (ny, nx); 0 by default. It shifts the topography and no more.

    Raises
    ------
    ValueError
        If shapes differ, an entry is not a finite number or a label, a field does not exist, or
        the properties of a pixel are refused by its sample or law; the message names the pixel.
    """

    materials: Any
    size: Any
    fields: Mapping[str, Any] = field(default_factory=dict)
    labels: Any = None
    height: Any = None

    def __post_init__(self) -> None:
        materials = tuple(check_list("materials", self.materials, Contact, "a softafm.Contact"))
        if not materials:
            raise ValueError("materials = []: must be a softafm.Contact, or several in a list")
        if any(each.tip != materials[0].tip for each in materials):
            raise ValueError("materials: must all have the same tip, as one tip scans them")
        if self.labels is None and len(materials) > 1:
            raise ValueError(f"labels: missing; must say which of {len(materials)} materials")
        arrays = {name: _check_image(name, values) for name, values in dict(self.fields).items()}
        if self.labels is not None:
            arrays["labels"] = _check_image("labels", self.labels)
        if self.height is not None:
            arrays["height"] = _check_image("height", self.height)
        if not arrays:
            raise ValueError("fields = {}: must hold an array; or give labels or height")
        first, shape = next((name, array.shape) for name, array in arrays.items())
        for name, array in arrays.items():
            if array.shape != shape:
                raise ValueError(
                    f"{name} has shape {array.shape}: must have that of {first}, {shape}"
                )
        labels = arrays.pop("labels", np.zeros(shape))
        wrong = np.argwhere((labels != np.rint(labels)) | (labels < 0) | (labels >= len(materials)))
        if wrong.size:
            i, j = wrong[0]
            raise ValueError(
                f"labels[{i}, {j}] = {labels[i, j]:g}: must be a whole number from 0 to "
                f"{len(materials) - 1}, that of a material"
            )
        height = arrays.pop("height", np.zeros(shape))
        for name in arrays:
            for material in materials:
                refuse_unknown(name, material)
        for name, value in (
            ("materials", materials), ("size", _check_size(self.size, shape)), ("fields", arrays),
            ("labels", labels.astype(int)), ("height", height),
        ):  # fmt: skip
            object.__setattr__(self, name, value)

    @classmethod
    def mixed(
        cls,
        share: ArrayLike,
        one: Contact,
        other: Contact,
        size: ArrayLike,
        height: ArrayLike | None = None,
    ) -> "SampleMap":
        """Build a blend whose numbers go geometrically from ``one`` to ``other``.

        Parameters
        ----------
        share
            Share of ``other``, 0 to 1, shape (ny, nx).
        one, other
            Contacts whose samples, and laws, are of the same kind.
        size, height
            As for ``SampleMap``.
        """
        refuse_other("one", one, Contact, "a softafm.Contact")
        refuse_other("other", other, Contact, "a softafm.Contact")
        share = _check_image("share", share)
        wrong = np.argwhere((share < 0) | (share > 1))
        if wrong.size:
            i, j = wrong[0]
            raise ValueError(f"share[{i}, {j}] = {share[i, j]:g}: must be from 0 to 1")
        if one.tip != other.tip:
            raise ValueError("one, other: must have the same tip, as one tip scans both")
        arrays = {}
        for part in _PARTS:
            a, b = getattr(one, part), getattr(other, part)
            if type(a) is not type(b):
                raise ValueError(
                    f"{part}: '{a.kind}' and '{b.kind}' do not mix; both must be of one kind, or "
                    "give labels"
                )
            for entry in fields(a):
                low, high = getattr(a, entry.name), getattr(b, entry.name)
                if low == high:
                    continue
                if not all(isinstance(each, float) and each > 0 for each in (low, high)):
                    raise ValueError(
                        f"{part}.{entry.name}: {low!r} and {high!r} do not mix; give labels"
                    )
                arrays[f"{part}.{entry.name}"] = low ** (1 - share) * high**share
        if not arrays:
            raise ValueError("one, other: are the same; there is nothing to mix")
        return cls(one, size, arrays, height=height)

    @classmethod
    def from_image(
        cls,
        image: ArrayLike | str | Path,
        material: Contact,
        size: ArrayLike,
        ranges: Mapping[str, Any],
    ) -> "SampleMap":
        """Build a map from the grey values of an image, black the first and white the second value.

        Parameters
        ----------
        image
            File of an image, or an array (ny, nx) from 0 to 1.
        material
            Contact that gives all that does not vary.
        size
            As for ``SampleMap``.
        ranges
            Pairs of values in SI by field, such as ``{"sample.E_inf": (0.1e9, 1.9e9), "height": (0,
            5e-9)}``.
        """
        grey = find_grey_values(image)
        arrays = {}
        for name, ends in ranges.items():
            try:
                low, high = map(float, ends)
            except (TypeError, ValueError):
                raise ValueError(f"ranges[{name!r}] = {ends!r}: must be two numbers") from None
            arrays[name] = low + (high - low) * grey
        height = arrays.pop("height", None)
        return cls(material, size, arrays, height=height)

    @classmethod
    def from_labelled_image(
        cls,
        image: ArrayLike | str | Path,
        materials: Sequence[Contact],
        size: ArrayLike,
        height: ArrayLike | None = None,
    ) -> "SampleMap":
        """Build a map from an image with one grey for each material, the darkest for the first."""
        grey = find_grey_values(image)
        levels, labels = np.unique(grey, return_inverse=True)
        if levels.size != len(materials):
            raise ValueError(
                f"image: has {levels.size} greys, but there are {len(materials)} materials; save "
                "it without compression losses and soft edges"
            )
        return cls(materials, size, labels=labels.reshape(grey.shape), height=height)

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of pixels along y and x."""
        return self.height.shape

    @cached_property
    def pixels(self) -> Pixels:
        """The different contacts, in the order in which they first occur."""
        columns = [self.labels.ravel(), *(array.ravel() for array in self.fields.values())]
        table = np.column_stack(columns).astype(float)
        _, first, inverse = np.unique(table, axis=0, return_index=True, return_inverse=True)
        order = np.argsort(first)
        rank = np.empty_like(order)
        rank[order] = np.arange(order.size)
        first = first[order]
        contacts = [self._contact(int(flat), table[flat]) for flat in first]
        place = table[first, 1:]
        if place.size:
            positive_only = (place > 0).all(axis=0)
            place = np.where(positive_only, np.log(np.where(positive_only, place, 1.0)), place)
            span = np.ptp(place, axis=0)
            place = (place - place.min(axis=0)) / np.where(span > 0, span, 1.0)
        number = rank[inverse.ravel()].reshape(self.shape)
        return Pixels(contacts, number, place, table[first, 0].astype(int))

    def _contact(self, flat: int, row: np.ndarray) -> Contact:
        """Contact of a pixel, from its row of label and fields."""
        material = self.materials[int(row[0])]
        values = dict(zip(self.fields, row[1:].tolist(), strict=True))
        parts = {}
        for part in _PARTS:
            thing = getattr(material, part)
            own = {name: value for (kind, name), value in _split(values) if kind == part}
            work = (
                None
                if _has_number(thing, "work_of_adhesion")
                else own.pop("work_of_adhesion", None)
            )
            try:
                thing = replace(thing, **own)
                if work is not None:
                    thing = type(thing).from_work_of_adhesion(work, thing.z0)
            except ValueError as error:
                i, j = divmod(flat, self.shape[1])
                raise ValueError(f"pixel ({i}, {j}): {part}.{error}") from None
            parts[part] = thing
        return replace(material, **parts) if values else material


def find_grey_values(image: ArrayLike | str | Path) -> np.ndarray:
    """Return an image's grey values from 0, black, to 1, white; arrays must be so already."""
    if isinstance(image, str | Path):
        from PIL import Image, UnidentifiedImageError

        try:
            with Image.open(image) as picture:
                deep = picture.mode.startswith("I")
                grey = np.asarray(picture if deep else picture.convert("L"), float)
        except UnidentifiedImageError:
            raise ValueError(f"{image}: is not an image that can be read") from None
        except OSError as error:
            raise ValueError(f"{image}: {error.strerror or 'cannot be read'}") from None
        return grey / (65535.0 if deep else 255.0)
    grey = _check_image("image", image)
    wrong = np.argwhere((grey < 0) | (grey > 1))
    if wrong.size:
        i, j = wrong[0]
        raise ValueError(f"image[{i}, {j}] = {grey[i, j]:g}: must be from 0 to 1")
    return grey


def _check_image(name: str, values: Any) -> np.ndarray:
    """Return the values of all pixels as floats, or raise ValueError naming the one that is not."""
    refuse_masked(name, values)
    try:
        array = np.array(values, float)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: must be an array of numbers, (ny, nx)") from None
    if array.ndim != 2 or array.size == 0:
        raise ValueError(f"{name} has shape {array.shape}: must be an array (ny, nx)")
    if array.size > _MOST_PIXELS:
        raise ValueError(f"{name} has {array.size} pixels: must have at most {_MOST_PIXELS}")
    wrong = np.argwhere(~np.isfinite(array))
    if wrong.size:
        i, j = wrong[0]
        raise ValueError(f"{name}[{i}, {j}] = {array[i, j]}: must be a finite number")
    array.flags.writeable = False
    return array


def _check_size(size: Any, shape: tuple[int, int]) -> tuple[float, float]:
    if np.ndim(size) == 0:
        width = check_positive("size", size, "m")
        return width, width * shape[0] / shape[1]
    if len(size) != 2:
        raise ValueError(f"size = {size!r}: must be a length, or those along x and y, in m")
    return check_positive("size[0]", size[0], "m"), check_positive("size[1]", size[1], "m")


def _split(values: Mapping[str, float]) -> list[tuple[tuple[str, ...], float]]:
    return [(tuple(name.split(".", 1)), value) for name, value in values.items()]


def _has_number(thing: Any, name: str) -> bool:
    return any(entry.name == name for entry in fields(thing))


def refuse_unknown(name: str, material: Any) -> None:
    """Raise ValueError unless a contact has a number of this name that may vary."""
    part, _, entry = name.partition(".")
    if part not in _PARTS:
        raise ValueError(f"field '{name}': must be sample.NAME or surface.NAME")
    thing = getattr(material, part)
    known = [f.name for f in fields(thing) if isinstance(getattr(thing, f.name), int | float)]
    if hasattr(thing, "from_work_of_adhesion") and "work_of_adhesion" not in known:
        known.append("work_of_adhesion")
    if entry not in known:
        listed = ", ".join(f"{part}.{each}" for each in known) or "none"
        raise ValueError(
            f"field '{name}': the {part} '{thing.kind}' has no such number; those that may vary: "
            f"{listed}"
        )
