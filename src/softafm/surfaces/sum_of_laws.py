"""A sum of surface laws."""

from dataclasses import dataclass
from typing import ClassVar

from softafm.compiled.formulas import Term
from softafm.surfaces.law import SurfaceLaw


@dataclass(frozen=True)
class SumOfLaws(SurfaceLaw):
    """The sum of the pressures of several laws, also written ``one + another``.

    Parameters
    ----------
    parts
        The laws; sums among them are taken apart. A part alone may be purely attractive, their sum
        has to repel when the surfaces come close.

    Raises
    ------
    ValueError
        If a part is no surface law or there is none.
    """

    kind: ClassVar[str] = "sum"
    parts: tuple[SurfaceLaw, ...]

    def __post_init__(self):
        object.__setattr__(self, "parts", _check_laws(self.parts))

    @property
    def closest_gap(self) -> float:
        """The largest of those of the parts, m."""
        return max(part.closest_gap for part in self.parts)

    @property
    def terms(self) -> tuple[Term, ...]:
        """The terms of all parts."""
        return tuple(term for part in self.parts for term in part.terms)

    def _evaluate(self, gap):
        results = [part._evaluate(gap) for part in self.parts]
        return tuple(sum(parts) for parts in zip(*results, strict=True))


def _check_laws(given) -> tuple[SurfaceLaw, ...]:
    if isinstance(given, str | bytes | dict) or not hasattr(given, "__iter__"):
        raise ValueError(f"parts = {given!r}: must be a list of surface laws")
    flat: list[SurfaceLaw] = []
    for index, part in enumerate(given):
        if not isinstance(part, SurfaceLaw):
            raise ValueError(f"parts[{index}] = {part!r}: must be a surface law")
        flat += part.parts if isinstance(part, SumOfLaws) else (part,)
    if not flat:
        raise ValueError("parts is empty: must hold at least one surface law")
    return tuple(flat)
