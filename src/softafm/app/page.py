"""One user's page: the form on the left, runs and what they found on the right."""

import base64
import binascii
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from importlib import resources
from pathlib import Path
from typing import Any

import panel as pn
import param

from softafm.app.colours import Theme, recolour
from softafm.app.documents import replace_value
from softafm.app.form import read_presets
from softafm.app.limits import Limits
from softafm.app.links import read_query, write_query
from softafm.app.notebook import FRAME, load_panel, share_runner
from softafm.app.readings import Reading, read_document
from softafm.app.rows import describe_time, make_row
from softafm.app.runs import Runner
from softafm.app.session import Entry, Session, refuse_large
from softafm.app.tables import make_regime_table
from softafm.app.views import make_views
from softafm.app.widgets import Form
from softafm.checks.refusals import ConfigError
from softafm.modes import MODES

FIRST = "ldpe-tapping"
_REGIME = "Regime"
_LINE = "1px solid var(--softafm-line)"
_BETWEEN_LOOKS = 150
"""Time between two looks at runs that go on, ms."""


def read_resource(name: str) -> str:
    """Return a text file of this package."""
    return (resources.files("softafm.app") / name).read_text(encoding="utf-8")


class Piece(pn.custom.JSComponent):
    """Header, run bar, list of runs or regime, as ``page.js`` draws them."""

    part = param.String()
    state = param.Dict(default={})
    _esm = read_resource("page.js")
    _stylesheets = (read_resource("page.css"),)

    def __init__(self, answer, **params):
        super().__init__(**params)
        self._answer = answer

    def _handle_msg(self, data: Any) -> None:
        self._answer(data)


class Page(pn.viewable.Viewer):
    """The page: an object to be shown in a notebook, or served.

    Parameters
    ----------
    runner
        What carries out the runs, by default one that all such pages of this process share.
    limits
        What the user may ask for.
    """

    def __init__(self, runner: Runner | None = None, limits: Limits | None = None, **params):
        super().__init__(**params)
        self.limits = limits or Limits()
        runner = runner or share_runner(self.limits)
        self._served = pn.state.curdoc is not None
        self._displayed = False
        self.theme: Theme = "light"
        self._movie, self._selected, self._notice = True, "", ""
        self._drawn: Any = None
        self._file: tuple[str, Reading, Callable[[Any], None]] | None = None
        self._looking: Any = None
        self.form = Form(read_presets()[FIRST], largest_upload=self.limits.upload_bytes // 4)
        self.session = Session(runner, self.form.folder, self.limits)
        self._header = Piece(self.answer, part="header", sizing_mode="stretch_width")
        self._header.state = {"largest": self.limits.upload_bytes}
        self._bar = Piece(self.answer, part="bar", sizing_mode="stretch_width")
        self._list = Piece(self.answer, part="list", sizing_mode="stretch_width")
        self._regime = Piece(self.answer, part="regime", sizing_mode="stretch_width")
        self._tabs = pn.Tabs(
            (_REGIME, pn.Column(self._regime, scroll=True, sizing_mode="stretch_both")),
            dynamic=True,
            sizing_mode="stretch_both",
            stylesheets=[read_resource("tabs.css")],
        )
        self._layout = self._lay_out()
        self.form.param.watch(self._follow_form, ["document", "outlook"])
        query = "" if self._location is None else self._location.search
        self._follow_form()
        self._read(query)
        self._refresh()

    def __panel__(self):
        return self._layout

    def _repr_mimebundle_(self, include=None, exclude=None):
        load_panel()
        self._displayed = True
        return super()._repr_mimebundle_(include, exclude)

    @property
    def results(self) -> dict[str, Any]:
        """What the runs in the list found, as datasets by label."""
        return {e.label: e.result for e in self.session.entries if e.state == "done"}

    def answer(self, message: Any) -> None:
        """Take what the browser sent; what is malformed or late is left aside."""
        with suppress(KeyError):
            match message:
                case {"run": True}:
                    self.run()
                case {"movie": bool(wanted)}:
                    self._movie = wanted
                case {"theme": "light" | "dark" as theme}:
                    self._take_theme(theme)
                case {"show": str(id), "shown": bool(shown)}:
                    self.session.show(id, shown)
                case {"rename": str(id), "label": str(label)}:
                    self.session.rename(id, label)
                case {"select": str(id)}:
                    self._selected = self.session[id].id
                case {"end": str(id)}:
                    self._end(id)
                case {"open": str(name), "content": str(content)}:
                    self._open(name, content)
        self._refresh()

    def run(self) -> Entry | None:
        """Run what the form describes; None if it cannot be."""
        if self.form.problems:
            return None
        document = self.form.document
        if self._movie and self._can_film:
            document = replace_value(document, "run.profiles", True)
        entry = self._try(
            lambda: self.session.run(document, self._name(), self.form.outlook.seconds)
        )
        if entry is not None:
            self._selected = entry.id
            self._look()
        return entry

    def close(self) -> None:
        """End all runs of this page, and forget its files."""
        if self._looking is not None:
            self._looking.stop()
        self.session.close()
        self.form.close()

    @property
    def _busy(self) -> bool:
        return self.session.busy or self.form.reading or self._file is not None

    @property
    def _can_film(self) -> bool:
        mode = MODES.get(str(self.form.document.get("mode")))
        return mode is None or mode.takes_profiles

    def _name(self) -> str:
        same = (name for name, found in read_presets().items() if found == self.form.document)
        return next(same, str(self.form.document.get("mode")))

    def _try(self, attempt):
        """Return what an attempt returns; None if it is refused, and let the page say why."""
        self._notice = ""
        try:
            return attempt()
        except ValueError as error:
            self._notice = "; ".join(str(error).splitlines())
            return None

    def _end(self, id: str) -> None:
        if self.session[id].over:
            self.session.remove(id)
        else:
            self.session.cancel(id)

    def _open(self, name: str, content: str) -> None:
        """Begin to read a file; ``_take_file`` goes on once it was read."""

        def attempt():
            if self._file is not None:
                raise ValueError(f"{name}: another file is being read; open it again in a moment")
            given = base64.b64decode(content, validate=True)
            refuse_large(given, self.limits)
            if Path(name).suffix.lower() == ".nc":
                return name, self.session.read(name, given), partial(self._list_upload, name)
            return name, Reading(partial(read_document, name, given)), self._fill_in

        with suppress(binascii.Error):
            self._file = self._try(attempt) or self._file
            self._look()

    def _take_file(self) -> None:
        """Take a file that was read meanwhile."""
        if self._file is None or not self._file[1].over:
            return
        (_, reading, take), self._file = self._file, None
        self._try(lambda: take(reading.result()))

    def _fill_in(self, document: dict[str, Any]) -> None:
        self.form.document = document

    def _list_upload(self, name: str, result: Any) -> None:
        """List a result from a file, if it can be drawn, and select it."""
        entry = self.session.add(name, result)
        try:
            make_views([entry], entry, self.form.folder, self.theme, self._address)
        except Exception as error:
            self.session.remove(entry.id)
            raise ValueError(f"{name}: a result that cannot be drawn ({error!r})") from error
        self._selected = entry.id

    def _take_theme(self, theme: Theme) -> None:
        self.theme = theme
        for pane in self._tabs:
            if isinstance(pane, pn.pane.Bokeh):
                recolour(pane.object, theme)
        if self._displayed:
            pn.io.push_notebook(self._layout)

    def _follow_form(self, *_: Any) -> None:
        found = self.form.outlook
        self._regime.state = make_regime_table(found.rows, self.form.problems)
        self._notice = ""
        self._write_address()
        self._look()
        self._refresh()

    def _look(self) -> None:
        """Look after runs and files that go on, if any do, from now on."""
        if self._busy and self._looking is None and (self._served or self._displayed):
            self._looking = pn.state.add_periodic_callback(self._refresh, _BETWEEN_LOOKS)

    def _refresh(self) -> None:
        """Bring bar, list and tabs up to date."""
        # Asked first: what ends from here on is not shown yet, and wants another look.
        busy = self._busy
        self._take_file()
        self.form.look()
        self._bar.state = self._bar_state()
        self._list.state = {
            "runs": [make_row(entry) for entry in self.session.entries],
            "selected": self._selected,
        }
        self._draw()
        if self._looking is not None and not busy:
            self._looking.stop()
            self._looking = None

    def _bar_state(self) -> dict[str, Any]:
        problems, seconds = self.form.problems, self.form.outlook.seconds
        words, bad = self._notice, bool(self._notice)
        if not words and self._file is not None:
            words = f"reading {self._file[0]} ..."
        if not words and problems:
            count = len(problems)
            words, bad = f"{count} value{'s' * (count > 1)} to correct before it can run", True
        elif not words and seconds is not None:
            words = f"expected to take {describe_time(seconds)}"
        return {
            "can_run": not problems,
            "words": words,
            "bad": bad,
            "movie": self._movie and self._can_film,
            "can_film": self._can_film,
        }

    def _draw(self) -> None:
        """Make the tabs anew if other results are to be shown."""
        done = [entry for entry in self.session.entries if entry.state == "done"]
        shown = [entry for entry in done if entry.shown]
        selected = next((entry for entry in done if entry.id == self._selected), None)
        selected = selected or (shown[-1] if shown else None)
        wanted = [(e.id, e.label) for e in shown], selected and (selected.id, selected.label)
        if wanted == self._drawn:
            return
        first, self._drawn = self._drawn in (None, ([], None)), wanted
        titles = list(self._tabs._names)
        title = titles[self._tabs.active] if titles else _REGIME
        with self.form.files_as_read():
            found = make_views(shown, selected, self.form.folder, self.theme, self._address)
        kept = self._tabs[0]
        self._tabs[:] = [(_REGIME, kept), *found.items()]
        titles = [_REGIME, *found]
        opened = next(iter(found), _REGIME) if first else title
        self._tabs.active = titles.index(opened) if opened in titles else min(1, len(found))

    def _address(self, document) -> str:
        """Return a link to this page with a document in its form."""
        try:
            query = write_query(document)
        except ConfigError as error:
            return f"none: {error}"
        location = self._location
        start = "" if location is None else f"{location.href}".split("?")[0].split("#")[0]
        return f"{start}?{query}"

    @property
    def _location(self) -> Any:
        """The address of the page; None in a notebook, whose address is not ours."""
        return pn.state.location if self._served else None

    def _write_address(self) -> None:
        if self._location is not None:
            with suppress(ConfigError):
                self._location.search = f"?{write_query(self.form.document)}"

    def _read(self, query: str) -> None:
        if query.strip("?"):

            def attempt():
                self.form.document = read_query(query)

            self._try(attempt)

    def _lay_out(self) -> pn.Column:
        left = pn.Column(
            pn.Column(self.form, scroll="y", sizing_mode="stretch_both", margin=(4, 0, 0, 0)),
            self._bar,
            width=400,
            sizing_mode="stretch_height",
            styles={"border-right": _LINE},
        )
        right = pn.Column(
            self._tabs,
            pn.Column(
                self._list,
                scroll="y",
                height=118,
                sizing_mode="stretch_width",
                styles={"border-top": _LINE, "padding-top": "4px"},
            ),
            sizing_mode="stretch_both",
            margin=(0, 12, 0, 12),
        )
        frame = {"sizing_mode": "stretch_both"} if self._served else FRAME
        return pn.Column(
            self._header,
            pn.Row(left, right, sizing_mode="stretch_both"),
            stylesheets=[] if self._served else [read_resource("frame.css")],
            **frame,
        )
