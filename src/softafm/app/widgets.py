"""The form as a Panel component: a document on one side, fields in the browser on the other."""

import base64
import binascii
import shutil
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, suppress
from copy import deepcopy
from importlib import resources
from pathlib import Path
from tempfile import mkdtemp
from typing import Any
from weakref import finalize

import panel as pn
import param

from softafm.app.answers import add_part, change_mode, choose, take_way
from softafm.app.documents import arrange, find_value, read_text, remove, replace_value, write_text
from softafm.app.form import read_presets
from softafm.app.marks import add_missing, place
from softafm.app.outlook import Outlook, foresee
from softafm.app.plan import Shown, list_sections, make_plan
from softafm.app.readings import MeasuredFiles
from softafm.app.uploads import keep
from softafm.experiment.entries import replace_reader
from softafm.modes import MODES

_LONGEST_TEXT = 20_000


def _read_resource(name: str) -> str:
    return (resources.files("softafm.app") / name).read_text(encoding="utf-8")


class Fields(pn.custom.JSComponent):
    """What the browser draws: ``plan`` says which fields there are, ``state`` what they hold.

    Bokeh does not tell browsers of classes whose names begin with an underscore.
    """

    plan = param.Dict(default={})
    state = param.Dict(default={})
    _esm = _read_resource("form.js")
    _stylesheets = (_read_resource("form.css"),)

    def __init__(self, form: "Form", **params):
        super().__init__(**params)
        self._form = form

    def _handle_msg(self, data: Any) -> None:
        self._form.answer(data)


class Form(pn.viewable.Viewer):
    """A form for an experiment.

    ``outlook`` follows the document, and so does ``problems``: reasons by path, such as
    ``"sample.E0"``, why it cannot run. They are shown at their fields if ``show_problems``.

    Parameters
    ----------
    document
        The experiment as the tables of its file; setting it fills the form, and an answer in the
        form sets it to another one. It is never changed in place.
    folder
        Where uploaded files are kept, which the document names; a temporary one by default.
    largest_upload
        Size above which a file is refused, bytes; all together may have four times that.
    """

    document = param.Dict(default={}, doc="The tables of an experiment file.")
    problems = param.Dict(default={}, doc="Why the document cannot run, by path.")
    outlook = param.ClassSelector(class_=Outlook, default=Outlook(), doc="Its regime and cost.")
    show_problems = param.Boolean(default=True)

    def __init__(
        self,
        document: Mapping[str, Any] | None = None,
        folder: Path | None = None,
        largest_upload: int = 5_000_000,
        **params,
    ):
        self._own: finalize | None = None
        if folder is None:
            folder = Path(mkdtemp(prefix="softafm-"))
            self._own = finalize(self, shutil.rmtree, folder, ignore_errors=True)
        self.folder, self.largest_upload = folder, largest_upload
        self._measured, self._reading = MeasuredFiles(), False
        self._presets = read_presets()
        self._typed: dict[str, str] = {}
        self._memory: dict[str, Any] = {}
        self._ways: dict[tuple[str, int], int] = {}
        self._refused: dict[str, str] = {}
        self._shown: list[Shown] = []
        self._elsewhere: list[tuple[str, str]] = []
        self._answering = False
        super().__init__(document=deepcopy(dict(document or {})), **params)
        self._fields = Fields(self, sizing_mode="stretch_width", min_width=240)
        self._follow()

    def __panel__(self):
        return self._fields

    def close(self) -> None:
        """Forget uploaded files, unless they are in a folder that was given."""
        if self._own is not None:
            self._own()

    def edit(self, path: str, text: str) -> None:
        """Write a text into a field, "" to empty it; KeyError if there is no such field."""
        field = self._inputs[path]
        self._typed[path] = text
        self._refused.pop(path, None)
        value = read_text(text, field)
        if field.kind == "flag":
            value = text == "true"
        if field.kind in ("flag", "choice") and text == field.default:
            value = None
        self._answer(replace_value(self.document, path, value))

    def choose(self, path: str, choice: str) -> None:
        """Choose the shape, model, law or name of the section at a path, such as ``"tip"``.

        What fields of both choices hold is kept, and all else remembered for a way back.
        """
        self._answer(choose(self.document, self._section(path), choice, self._memory))

    def choose_mode(self, mode: str) -> None:
        """Choose the mode; the motion keeps what it can, and a lever is there if it is needed."""
        if mode not in MODES:
            raise KeyError(mode)
        self._answer(change_mode(self.document, mode, self._memory))

    def choose_way(self, path: str, alternatives: int, way: int) -> None:
        """Choose in which way a section's alternatives, counted from 0, are given."""
        section = self._section(path)
        self._ways[path, alternatives] = way
        entry = list(section.ways)[alternatives]
        self._answer(take_way(self.document, path, entry, way, self._memory))

    def use_preset(self, name: str) -> None:
        """Fill the form with a bundled experiment."""
        self.document = deepcopy(self._presets[name])

    def add_part(self) -> None:
        """Add a law to a sum."""
        self._answer(add_part(self.document))

    def remove(self, path: str) -> None:
        """Remove what stands at a path: a part of a sum, or a key that does not belong."""
        self._typed.clear()
        self._answer(remove(self.document, path))

    def upload(self, path: str, name: str, content: bytes) -> None:
        """Keep a file and name it in a field; one that is refused is a problem of that field.

        KeyError if there is no such field, or it takes no file.
        """
        if self._inputs[path].kind != "file":
            raise KeyError(path)
        try:
            kept = keep(self.folder, name, content, self.largest_upload)
        except ValueError as error:
            self._refused[path] = str(error)
            self._answer(self.document)
        else:
            self.edit(path, kept)

    @property
    def reading(self) -> bool:
        """Whether a file that the document names is being read; ``look`` notices when it was."""
        return self._reading

    def look(self) -> None:
        """Let problems and outlook follow files that were read meanwhile."""
        if self._reading and not self._measured.busy:
            with self._answers():
                self._follow()

    def files_as_read(self) -> AbstractContextManager[None]:
        """Have files of the document not read again inside."""
        return replace_reader(self._measured.read)

    def answer(self, message: Any) -> None:
        """Take what the browser sent; what is malformed or late is left aside."""
        with suppress(LookupError, binascii.Error):
            match message:
                case {"edit": str(path), "text": str(text)} if len(text) <= _LONGEST_TEXT:
                    self.edit(path, text)
                case {"choose": "mode", "choice": str(mode)}:
                    self.choose_mode(mode)
                case {"choose": "preset", "choice": str(name)}:
                    self.use_preset(name)
                case {"choose": str(path), "choice": str(choice)}:
                    self.choose(path, choice)
                case {"alternatives": int(index), "of": str(path), "way": int(way)}:
                    self.choose_way(path, index, way)
                case {"add": "surface.parts"}:
                    self.add_part()
                case {"remove": str(path)}:
                    self.remove(path)
                case {"upload": str(path), "name": str(name), "content": str(content)}:
                    self.upload(path, name, base64.b64decode(content, validate=True))

    @property
    def _inputs(self):
        return {path: field for one in self._shown for path, field in one.inputs.items()}

    def _section(self, path: str) -> Shown:
        return {one.path: one for one in self._shown}[path]

    @contextmanager
    def _answers(self) -> Iterator[None]:
        self._answering = True
        try:
            yield
        finally:
            self._answering = False

    def _answer(self, document: dict[str, Any]) -> None:
        with self._answers():
            document = arrange(document)
            if document == self.document:
                self._follow()
            else:
                self.document = document

    @param.depends("document", "show_problems", watch=True)
    def _follow(self) -> None:
        """Let problems, outlook and fields follow the document."""
        if not self._answering:
            for memory in (self._typed, self._memory, self._ways, self._refused):
                memory.clear()
        self._shown = list_sections(self.document, self._ways)
        with self.files_as_read():
            found = foresee(self.document, self.folder)
        self._reading = self._measured.busy
        problems = add_missing(found.problems, self._shown, self.document) | self._refused
        found = Outlook(problems) if problems else found
        self.param.update(outlook=found, problems=found.problems)
        self._fields.param.update(
            plan=make_plan(self._shown, self.largest_upload), state=self._state()
        )

    def _state(self) -> dict[str, Any]:
        """Return what the fields hold, and what is wrong with it."""
        at, self._elsewhere = place(self.problems, self._shown)
        mode = self.document.get("mode")
        return {
            "mode": mode if mode in list(MODES) else "",
            "preset": next((n for n, d in self._presets.items() if d == self.document), ""),
            "texts": {path: self._text(path) for path in self._inputs},
            "problems": at if self.show_problems else {},
            "elsewhere": self._elsewhere,
        }

    def _text(self, path: str) -> str:
        """Return what a field holds: as it was typed, if that is what the document says."""
        value, typed = find_value(self.document, path), self._typed.get(path)
        if typed is not None and read_text(typed, self._inputs[path]) == value:
            return typed
        return write_text(value)
