"""What the page shows of runs: figures, the surface movie, numbers, and what to take away."""

import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import panel as pn

from softafm.app import take_away
from softafm.app.colours import Theme
from softafm.app.curves import Shown, draw_figures
from softafm.app.movie import make_player
from softafm.app.session import Entry
from softafm.app.tables import STYLE, write_lines, write_numbers

SURFACE, NUMBERS, TAKE_AWAY = "Surface", "Numbers", "Take away"


def make_pane(text: str, **options: Any) -> pn.pane.HTML:
    """Return a pane of HTML with the page's style of tables."""
    return pn.pane.HTML(text, stylesheets=[STYLE], sizing_mode="stretch_width", **options)


def make_views(
    entries: list[Entry], selected: Entry | None, folder: Path, theme: Theme, address: Callable
) -> dict[str, Any]:
    """Return the tabs' contents by title.

    ``entries``, all done, are drawn over each other; of ``selected`` alone are movie and files.
    ``address`` makes a link to the page of a document.
    """
    drawn = [Shown(entry.label, entry.colour, entry.result) for entry in entries]
    found: dict[str, Any] = {
        title: pn.pane.Bokeh(layout, sizing_mode="stretch_both")
        for title, layout in draw_figures(drawn, theme).items()
    }
    if selected is not None:
        player = make_player(selected.result, theme)
        if player is not None:
            found[SURFACE] = pn.pane.Bokeh(player, sizing_mode="stretch_both")
        found[NUMBERS] = _show_numbers([*entries, *([] if selected in entries else [selected])])
        found[TAKE_AWAY] = _show_take_away(selected, entries, folder, address)
    return found


def _show_numbers(entries: list[Entry]) -> pn.Column:
    from softafm.draw.summary import list_observables

    tables = [write_numbers(e.label, list_observables(e.result), e.warnings) for e in entries]
    return pn.Column(*map(make_pane, tables), scroll=True, sizing_mode="stretch_both")


def _show_take_away(
    entry: Entry, entries: list[Entry], folder: Path, address: Callable[[Mapping], str]
) -> pn.Column:
    result, document = entry.result, entry.document
    same = [one for one in entries if one.result.attrs["mode"] == result.attrs["mode"]]
    same = same if entry in same else [entry]

    def picture(kind: Any) -> bytes:
        return take_away.draw_picture([e.result for e in same], kind, [e.label for e in same])

    files = {
        "result.nc": lambda: take_away.write_netcdf(result),
        "curves.csv": lambda: take_away.write_csv(result),
        "figure.png": lambda: picture("png"),
        "figure.svg": lambda: picture("svg"),
    }
    if document:
        files[take_away.name_file(document)] = lambda: take_away.write_toml(document).encode()
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
            f"To run it again: {take_away.name_file(document)} and this command": (
                take_away.write_command(document)
            ),
            "In Python": take_away.write_python(document, folder),
            "A link to this form": address(document),
        }
    title = make_pane(f"<h3>{_escape(entry.label)}: files</h3>")
    return pn.Column(
        title,
        pn.FlexBox(*buttons, gap="8px", sizing_mode="stretch_width"),
        make_pane(write_lines(texts)),
        scroll=True,
        sizing_mode="stretch_both",
    )


def _escape(text: str) -> str:
    from html import escape

    return escape(text)
