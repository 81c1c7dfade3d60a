"""What the page shows of runs: figures, the surface movie, numbers, and what to take away."""

import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import panel as pn

from softafm.app import take_away
from softafm.app.colours import Theme
from softafm.app.curves import Shown, figures
from softafm.app.movie import movie
from softafm.app.session import Entry
from softafm.app.tables import STYLE, lines_html, numbers_html

SURFACE, NUMBERS, TAKE_AWAY = "Surface", "Numbers", "Take away"


def html(text: str, **options: Any) -> pn.pane.HTML:
    """Return a pane of HTML with the page's style of tables."""
    return pn.pane.HTML(text, stylesheets=[STYLE], sizing_mode="stretch_width", **options)


def views(
    entries: list[Entry], selected: Entry | None, folder: Path, theme: Theme, address: Callable
) -> dict[str, Any]:
    """Return the tabs' contents by title.

    ``entries``, all done, are drawn over each other; of ``selected`` alone are movie and files.
    ``address`` makes a link to the page of a document.
    """
    drawn = [Shown(entry.label, entry.colour, entry.result) for entry in entries]
    found: dict[str, Any] = {
        title: pn.pane.Bokeh(layout, sizing_mode="stretch_both")
        for title, layout in figures(drawn, theme).items()
    }
    if selected is not None:
        player = movie(selected.result, theme)
        if player is not None:
            found[SURFACE] = pn.pane.Bokeh(player, sizing_mode="stretch_both")
        found[NUMBERS] = _numbers([*entries, *([] if selected in entries else [selected])])
        found[TAKE_AWAY] = _take_away(selected, entries, folder, address)
    return found


def _numbers(entries: list[Entry]) -> pn.Column:
    from softafm.draw.summary import observables

    tables = [numbers_html(e.label, observables(e.result), e.warnings) for e in entries]
    return pn.Column(*map(html, tables), scroll=True, sizing_mode="stretch_both")


def _take_away(
    entry: Entry, entries: list[Entry], folder: Path, address: Callable[[Mapping], str]
) -> pn.Column:
    result, document = entry.result, entry.document
    same = [one for one in entries if one.result.attrs["mode"] == result.attrs["mode"]]
    same = same if entry in same else [entry]

    def picture(kind: Any) -> bytes:
        return take_away.picture([e.result for e in same], kind, [e.label for e in same])

    files = {
        "result.nc": lambda: take_away.netcdf_bytes(result),
        "curves.csv": lambda: take_away.csv_bytes(result),
        "figure.png": lambda: picture("png"),
        "figure.svg": lambda: picture("svg"),
    }
    if document:
        files[take_away.file_name(document)] = lambda: take_away.toml_text(document).encode()
    buttons = [
        pn.widgets.FileDownload(
            callback=lambda write=write: io.BytesIO(write()),
            filename=name,
            label=name,
            icon=None,
            css_classes=[f"download-{Path(name).suffix[1:]}"],
            width=130 if len(name) < 12 else 190,
            height=32,
        )
        for name, write in files.items()
    ]
    texts = {}
    if document:
        texts = {
            f"To run it again: {take_away.file_name(document)} and this command": (
                take_away.command_line(document)
            ),
            "In Python": take_away.python_lines(document, folder),
            "A link to this form": address(document),
        }
    title = html(f"<h3>{_escaped(entry.label)}: files</h3>")
    return pn.Column(
        title,
        pn.FlexBox(*buttons, gap="8px", sizing_mode="stretch_width"),
        html(lines_html(texts)),
        scroll=True,
        sizing_mode="stretch_both",
    )


def _escaped(text: str) -> str:
    from html import escape

    return escape(text)
