"""Tables in text files, as instruments and spreadsheets write them: a header, then rows of numbers.

What can be read in one way only is read: columns separated by commas, semicolons, tabs or blanks;
decimal commas where no comma separates columns; comments, which begin with #; quoted fields; units
in the header or in a row of their own below it. What could be read in two ways is refused.
"""

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

import numpy as np

from softafm.checks.paths import explain_no_file
from softafm.units.quantities import LARGEST, Kind, is_unit, read_quantity

LARGEST_FILE = 100_000_000
_LONGEST_SHOWN = 60
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_WITH_COMMA = re.compile(r"[+-]?(?:[0-9]+,[0-9]*|,[0-9]+)(?:[eE][+-]?[0-9]+)?")
_THOUSANDS = re.compile(r"[+-]?[1-9][0-9]{0,2},[0-9]{3}")
_NAME_AND_UNIT = re.compile(r"(.*?\S)\s*[(\[]([^()\[\]]*)[)\]]|([^/]+)/(.+)")
_TITLE_BETWEEN_BLANKS = re.compile(r"[^\s(\[]\S*(?:\s*[(\[][^)\]]{0,40}[)\]])?")
_DECLARED = re.compile(r'"?sep=([,;\t])"?[,;\s]*', re.IGNORECASE)
"""The line by which Excel is told what separates columns."""
_PRIMES = str.maketrans({"′": "'", "’": "'", "″": "''", '"': "''"})
_SEPARATORS = {",": "','", ";": "';'", "\t": "tabs", " ": "blanks"}


@dataclass(frozen=True)
class Column:
    """A column: its place, its title as written, and the title's name and unit, "" for none."""

    index: int
    title: str
    name: str
    unit: str


class Table:
    """The columns of a text file, found by name and read in SI.

    Parameters
    ----------
    path
        The file, at most 100 MB of text in UTF-8. Its header is the first line that is no comment,
        or the comment just above the numbers, as ``numpy.savetxt`` writes it.
    example
        A header as it should be, for messages.

    Raises
    ------
    ValueError
        If the file cannot be read, has no header, or has rows with more fields than the header, or
        fewer where blanks separate them. Lines are counted as an editor does.
    """

    def __init__(self, path: str | Path, example: str):
        self.example = example
        self._lines = _read_text(Path(path)).split("\n")
        declared = _DECLARED.fullmatch(self._lines[0])
        if declared:
            self._lines[0] = ""
        data = [
            number
            for number, line in enumerate(self._lines, start=1)
            if line.strip() and not line.lstrip().startswith("#")
        ]
        if not data:
            raise ValueError(f"is empty; its header must read, for example, '{example}'")
        self._header_line = _find_header(self._lines, data[0])
        if self._header_line == data[0]:
            del data[0]
        header = self._lines[self._header_line - 1].lstrip("# ")
        self.separator = declared[1] if declared else _find_separator(header)
        (titles,) = self._split([header], [self._header_line])
        while titles and not titles[-1]:
            del titles[-1]
        self._rows = list(zip(data, self._split(self._text_of(data), data), strict=True))
        for number, cells in self._rows:
            between_blanks = self.separator == " " and len(cells) != len(titles)
            if between_blanks or any(cells[len(titles) :]):
                raise ValueError(self._describe_width(number, cells, len(titles)))
        self.columns = self._name_columns(titles)

    def find(self, *names: str) -> Column | None:
        """Return the column that has one of several names, None if none has.

        Capitals, and blanks for underscores, make no difference.

        Raises
        ------
        ValueError
            If several columns have.
        """
        wanted = set(map(_simplify, names))
        found = [c for c in self.columns if {_simplify(c.title), _simplify(c.name)} & wanted]
        if len(found) > 1:
            titles = " and ".join(quote(column.title) for column in found)
            raise ValueError(f"has more than one column '{names[0]}': {titles}; leave one")
        return found[0] if found else None

    def column(self, *names: str) -> Column:
        """Return the column that has one of several names; ValueError if not just one has."""
        found = self.find(*names)
        if found is None:
            header = quote(self._lines[self._header_line - 1].strip())
            raise ValueError(
                f"has no column '{names[0]}'; its header, line {self._header_line}, reads "
                f"{header}, with columns separated by {_SEPARATORS[self.separator]}; it must "
                f"read, for example, '{self.example}'"
            )
        return found

    def in_si(self, column: Column, kind: Kind) -> np.ndarray:
        """Return the quantities of a column in SI; ValueError as ``numbers``, or for its unit."""
        if not column.unit:
            raise ValueError(
                f"column {quote(column.name)} has no unit: it must be that of {kind.noun}, as in "
                f"'{column.name} ({kind.example.split(maxsplit=1)[1]})'"
            )
        try:
            factor = read_quantity(f"1 {column.unit}", kind)
        except ValueError:
            raise ValueError(
                f"column {quote(column.title)} must name a unit of {kind.noun}, not "
                f"{quote(column.unit)}"
            ) from None
        return self.numbers(column) * factor

    def numbers(self, column: Column) -> np.ndarray:
        """Return the numbers of a column as written, whatever its unit.

        Raises
        ------
        ValueError
            If an entry is missing, is no finite number below 1e40, or might be read in two ways.
        """
        cells = [(n, cells[column.index] if column.index < len(cells) else "")
                 for n, cells in self._rows]  # fmt: skip
        if any("," in cell for _, cell in cells):
            self._require_decimal_commas(column)
            cells = [(n, cell.replace(",", ".") if _WITH_COMMA.fullmatch(cell) else cell)
                     for n, cell in cells]  # fmt: skip
        return np.array([self._number(n, cell, column) for n, cell in cells], float)

    def place(self, row: int) -> str:
        """Return which line of the file a row of numbers, counted from 0, is, and what it reads."""
        line = self._rows[row][0]
        return f"line {line} ({quote(self._lines[line - 1].strip())})"

    def _number(self, line: int, cell: str, column: Column) -> float:
        number = float(cell) if _NUMBER.fullmatch(cell) else None
        if number is not None and abs(number) < LARGEST:
            return number
        where = f"line {line} ({quote(self._lines[line - 1].strip())})"
        if not cell:
            others = [s for s in ",;\t" if s != self.separator and s in self._lines[line - 1]]
            hint = f"; columns are separated by {_SEPARATORS[self.separator]}" if others else ""
            raise ValueError(f"{where} has no {quote(column.name)}{hint}")
        finite = number is not None and isfinite(number)
        valid = f"a number below {LARGEST:g} in magnitude" if finite else "a finite number"
        raise ValueError(
            f"{where}: {quote(column.name)} must be {valid}, such as 0.5 or 5e-9; found "
            f"{quote(cell)}"
        )

    def _require_decimal_commas(self, column: Column):
        """Raise ValueError if commas within fields of a column need not be decimal ones."""
        every = [(n, i, cell) for n, cells in self._rows for i, cell in enumerate(cells)]
        commas = [entry for entry in every if _WITH_COMMA.fullmatch(entry[2])]
        points = [(n, cell) for n, _, cell in every if "." in cell and _NUMBER.fullmatch(cell)]
        if commas and points:
            raise ValueError(
                f"line {points[0][0]} has a decimal point, in {quote(points[0][1])}, and line "
                f"{commas[0][0]} a comma, in {quote(commas[0][2])}: write all decimals with points"
            )
        here = [(n, cell) for n, i, cell in commas if i == column.index]
        if here and all(_THOUSANDS.fullmatch(cell) for _, cell in here):
            line, cell = here[0]
            raise ValueError(
                f"line {line}: the comma of {cell} may be a decimal one or separate thousands, "
                f"{cell.replace(',', '.')} or {cell.replace(',', '')}, as everywhere in column "
                f"{quote(column.title)}: write decimals with points"
            )

    def _text_of(self, numbers: Sequence[int]) -> list[str]:
        lines = [self._lines[number - 1] for number in numbers]
        return ["\t".join(line.split()) for line in lines] if self.separator == " " else lines

    def _split(self, lines: Sequence[str], numbers: Sequence[int]) -> list[list[str]]:
        """Split lines, of these numbers in the file, into cells."""
        if self.separator == " " and numbers == [self._header_line]:
            return [_TITLE_BETWEEN_BLANKS.findall(lines[0])]
        delimiter = "\t" if self.separator == " " else self.separator
        reader = csv.reader(lines, delimiter=delimiter, skipinitialspace=True, strict=True)
        try:
            rows = [[cell.strip() for cell in row] for row in reader]
            if len(rows) == len(lines):
                return rows
        except csv.Error as error:
            line = numbers[reader.line_num - 1]
            raise ValueError(f"is not a CSV file: line {line}: {error}") from None
        raise ValueError("is not a CSV file: a quoted field goes over several lines")

    def _describe_width(self, line: int, cells: list[str], columns: int) -> str:
        reason = f"columns are separated by {_SEPARATORS[self.separator]}"
        if self.separator == ",":
            reason += ", so decimals need points"
        elif self.separator == " ":
            reason += ", so no field may be empty or hold a blank"
        return (
            f"line {line} ({quote(self._lines[line - 1].strip())}) has {len(cells)} fields, but "
            f"the header, line {self._header_line}, names {columns}: {reason}"
        )

    def _name_columns(self, titles: Sequence[str]) -> tuple[Column, ...]:
        """Return the columns, and take their units from the first row if it holds them."""
        named = [_split_title(title) for title in titles]
        below = [""] * len(titles)
        units = [unit for _, unit in named]
        if self._rows and _holds_units(self._rows[0][1], units):
            line, cells = self._rows.pop(0)
            below = [cell.strip("()[] ") for cell in cells] + below[len(cells) :]
            for (name, unit), other in zip(named, below, strict=False):
                if is_unit(unit) and other not in ("", unit):
                    raise ValueError(
                        f"column {quote(name)} has the unit {quote(unit)} in the header and "
                        f"{quote(other)} in line {line}"
                    )
        return tuple(
            Column(index, title, name, unit or below[index])
            for index, (title, (name, unit)) in enumerate(zip(titles, named, strict=True))
        )


def _read_text(path: Path) -> str:
    try:
        if not path.is_file():
            raise ValueError(explain_no_file(path))
        if path.stat().st_size > LARGEST_FILE:
            raise ValueError(f"is larger than {LARGEST_FILE // 1_000_000} MB")
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise ValueError(error.strerror or "cannot be read") from None
    except UnicodeDecodeError:
        raise ValueError("is not text in UTF-8; save it as UTF-8") from None


def _find_header(lines: Sequence[str], first: int) -> int:
    """Return the number of the header's line, where the ``first`` is no comment."""
    above = lines[first - 2].lstrip() if first > 1 else ""
    numbers = re.match(r'\s*"?[+-]?[.,]?[0-9]', lines[first - 1])
    return first - 1 if numbers and above.startswith("#") and above.strip("# \t") else first


def _find_separator(header: str) -> str:
    """Return what separates the columns of a header: quoted, it does not; a blank if none does."""
    bare = re.sub(r'(?:^|(?<=[,;\t]))\s*"[^"]*"', "", header)
    if ";" in bare and "\t" in bare:
        raise ValueError("has ';' and tabs in its header: columns may be separated by either")
    return next((separator for separator in ";\t," if separator in bare), " ")


def _split_title(title: str) -> tuple[str, str]:
    match = _NAME_AND_UNIT.fullmatch(title)
    if match is None:
        return title, ""
    name, unit = match[1] or match[3], match[2] or match[4] or ""
    return name.rstrip("/ "), unit.strip()


def _holds_units(cells: Sequence[str], above: Sequence[str]) -> bool:
    """Whether the row below titles with these units, "" for none, holds those that they lack.

    A row of numbers and words is one of data. "1" is the unit of a plain number beside other units.
    """
    known = [is_unit(unit) for unit in above]
    found = [cell.strip("()[] ") for cell in cells[: len(above)]]
    for cell, settled in zip(found, known, strict=False):
        if (cell and not is_unit(cell)) if settled else (_is_number(cell) and cell != "1"):
            return False
    return any(is_unit(cell) and not settled for cell, settled in zip(found, known, strict=False))


def _is_number(cell: str) -> bool:
    return bool(_NUMBER.fullmatch(cell) or _WITH_COMMA.fullmatch(cell))


def quote(text: str) -> str:
    """Return a text in quotes, cut to a legible length."""
    return repr(text if len(text) <= _LONGEST_SHOWN else f"{text[: _LONGEST_SHOWN - 3]}...")


def _simplify(name: str) -> str:
    return re.sub(r"[\s_]+", " ", name.translate(_PRIMES)).strip().casefold()
