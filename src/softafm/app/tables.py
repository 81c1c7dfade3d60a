"""Tables and texts of the page as HTML; whatever comes from a user is escaped."""

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.table import Table

    from softafm.experiment.regime import Row

STYLE = """
:host { color: var(--softafm-text, inherit); font-size: 13px; line-height: 1.4; }
table { border-collapse: collapse; margin: 0 0 10px; }
caption { text-align: left; font-weight: 600; padding: 2px 0 4px; }
td { padding: 2px 18px 2px 0; vertical-align: top; }
td:nth-child(2) { white-space: nowrap; font-variant-numeric: tabular-nums; }
td:nth-child(3) { opacity: 0.75; }
p { margin: 0 0 8px; }
.problem { color: color-mix(in srgb, #f0453a 72%, currentColor); }
h3 { margin: 8px 0 3px; font-size: 13px; }
pre {
  margin: 0;
  padding: 7px 10px;
  overflow: auto;
  font-size: 12px;
  white-space: pre-wrap;
  overflow-wrap: anywhere;
  border: 1px solid color-mix(in srgb, currentColor 20%, transparent);
  border-radius: 4px;
  user-select: all;
}
"""


def make_regime_table(rows: Sequence["Row"], problems: Mapping[str, str]) -> dict[str, Any]:
    """Return what an experiment will be, or why it cannot run, for ``page.js`` to draw."""
    if problems:
        return {"caption": "Before it can run", "rows": list(problems.items()), "bad": True}
    return {"caption": "Before any run", "rows": [list(row) for row in rows], "bad": False}


def write_numbers(label: str, table: "Table", warnings: Iterable[str]) -> str:
    """Return the observables of a result, and what is doubtful about them."""
    cells = zip(*(list(column.cells) for column in table.columns), strict=True)
    doubts = "".join(f"<p class='problem'>{escape(text)}</p>" for text in warnings)
    return doubts + _write_table(label, cells)


def write_lines(parts: Mapping[str, str]) -> str:
    """Return texts to be copied, each under its heading."""
    return "".join(
        f"<h3>{escape(title)}</h3><pre tabindex='0'>{escape(text)}</pre>"
        for title, text in parts.items()
    )


def _write_table(caption: str, rows: Iterable[Sequence[Any]]) -> str:
    lines = "".join(
        "<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table><caption>{escape(caption)}</caption>{lines}</table>"
