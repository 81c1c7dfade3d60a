"""Files from the browser, read in processes of their own while the page goes on."""

from collections.abc import Callable
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from threading import BoundedSemaphore, Event, Thread
from time import process_time
from typing import Any

from softafm.experiment.config import LARGEST_FILE
from softafm.files.guard import allow_seconds, read_apart

_AT_ONCE = BoundedSemaphore(4)
"""How many files are read at a time, of all users together; others wait."""
_MOST_AT_ONCE = 4
"""How many measured files of one user are read or wait."""
_MOST_WORK = 3.0
"""Time of a processor that a measured file may take to read and use, s: forms do so often."""


class Reading:
    """A file that is read while everything else goes on; ``read`` is called in a thread."""

    def __init__(self, read: Callable[[], Any]):
        self._read, self._over = read, Event()
        self._found: Any = None
        self._problem: str | None = None
        Thread(target=self._carry_out, name="softafm-reading", daemon=True).start()

    @property
    def over(self) -> bool:
        """Whether it was read, or refused."""
        return self._over.is_set()

    def result(self) -> Any:
        """Wait, and return what was found; ValueError, in one line, if it was refused."""
        self._over.wait()
        if self._problem is not None:
            raise ValueError(self._problem)
        return self._found

    def _carry_out(self) -> None:
        try:
            with _AT_ONCE:
                self._found = self._read()
        except ValueError as problem:
            self._problem = str(problem)
        except Exception as problem:
            self._problem = f"cannot be read ({problem!r})"
        finally:
            self._over.set()


def read_document(name: str, content: bytes) -> dict[str, Any]:
    """Return the tables of an experiment file, read in a process of its own.

    Raises
    ------
    ValueError
        If it is no experiment file.
    """
    if len(content) > LARGEST_FILE:
        raise ValueError(f"{name}: has more than {LARGEST_FILE / 1e6:g} MB")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{name}: neither a result (.nc) nor text") from None
    if not text.strip():
        raise ValueError(f"{name}: is empty")
    try:
        return read_apart("softafm.experiment.toml_text:parse_apart", text)[0]
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


class MeasuredFiles:
    """What the measured files of a form hold: each is read once, and apart before it is read here.

    So the form may use them again with every answer.
    """

    def __init__(self) -> None:
        self._readings: dict[tuple[Any, ...], Reading] = {}

    @property
    def busy(self) -> bool:
        """Whether one is being read."""
        return any(not reading.over for reading in self._readings.values())

    def read(self, read: Callable[[Path], Any], path: Path) -> Any:
        """Return what ``read`` returns; ValueError if it refuses, or while the file is being read.

        It stands in for calling ``read`` under ``softafm.experiment.entries.replace_reader``.
        """
        if not path.is_file():
            return read(path)  # which says so
        found = path.stat()
        key = (read.__module__, read.__name__, path, found.st_size, found.st_mtime_ns)
        reading = self._readings.get(key)
        if reading is None:
            if sum(not other.over for other in self._readings.values()) >= _MOST_AT_ONCE:
                raise ValueError("waits until other files are read")
            reading = self._readings[key] = Reading(partial(_read_twice, read, path))
        if not reading.over:
            raise ValueError("is being read ...")
        return reading.result()


def _read_twice(read: Callable[[Path], Any], path: Path) -> Any:
    """Read a file here once it is known that it can be read, and how long that takes."""
    reader = f"{read.__module__}:{read.__name__}"
    read_apart(f"{__name__}:try_out", reader, str(path), seconds=allow_seconds(path))
    return read(path)


def try_out(reader: str, path: str) -> tuple[None, list]:
    """Read a measured file as a form will, for ``softafm.files.guard``.

    Raises
    ------
    ValueError
        If the reader refuses it, or it takes too long.
    """
    from softafm.experiment.schema import fit_measured_moduli
    from softafm.rheology.dma_table import read_moduli

    module, _, name = reader.partition(":")
    read = getattr(import_module(module), name)
    started = process_time()
    found = read(Path(path))
    if read is read_moduli:
        with suppress(ValueError):  # which the form says at another field
            fit_measured_moduli(found, poisson=0.5)
    work = process_time() - started
    if work > _MOST_WORK:
        raise ValueError(
            f"takes {work:.1f} s to read: at most {_MOST_WORK:g} s; leave out points, or use the "
            "command line"
        )
    return None, []
