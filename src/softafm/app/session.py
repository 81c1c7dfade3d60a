"""The runs of one user: started, followed, named, shown over each other, and removed."""

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from softafm.app.colours import RUNS
from softafm.app.limits import Limits
from softafm.app.readings import Reading
from softafm.app.runs import Job, Runner, State

if TYPE_CHECKING:
    from xarray import Dataset

_LONGEST_LABEL = 60
_HDF5 = b"\x89HDF\r\n\x1a\n"
"""What files begin with that ``softafm.save`` writes."""


@dataclass(eq=False)
class Entry:
    """One run in the list, or a result that was uploaded: then it has no ``job``."""

    id: str
    label: str
    colour: str
    document: Mapping[str, Any]
    job: Job | None = None
    uploaded: "Dataset | None" = None
    shown: bool = True

    @property
    def state(self) -> State:
        """Where it stands, as of a job."""
        return "done" if self.job is None else self.job.state

    @property
    def over(self) -> bool:
        """Whether nothing more will happen to it."""
        return self.state not in ("waiting", "running")

    @property
    def result(self) -> "Dataset":
        """What it found; LookupError if its state is not ``"done"``."""
        result = self.uploaded if self.job is None else self.job.result
        if result is None:
            raise LookupError(f"{self.label} has no result")
        return result

    @property
    def size(self) -> int:
        """Memory that its result takes, bytes."""
        return self.result.nbytes if self.state == "done" else 0

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is doubtful about the result."""
        if self.uploaded is not None:
            return tuple(str(self.uploaded.attrs.get("warnings", "")).splitlines())
        return () if self.job is None else self.job.warnings


class Session:
    """The list of one user's runs.

    Parameters
    ----------
    runner
        What carries out all users' runs.
    folder
        Where the user's uploaded files are.
    limits
        How many runs may be listed, and how large and costly they may be.
    """

    def __init__(self, runner: Runner, folder: Path, limits: Limits):
        self.entries: list[Entry] = []
        self._runner, self._folder, self._limits = runner, folder, limits
        self._user = uuid4().hex
        self._count = 0

    def __getitem__(self, id: str) -> Entry:
        """Return the entry of an id; KeyError if there is none."""
        for entry in self.entries:
            if entry.id == id:
                return entry
        raise KeyError(id)

    @property
    def busy(self) -> bool:
        """Whether a run waits or goes on."""
        return any(not entry.over for entry in self.entries)

    def run(self, document: Mapping[str, Any], name: str, seconds: float | None) -> Entry:
        """Queue a run that is expected to take so many seconds, and list it.

        Raises
        ------
        ValueError
            If a limit does not allow it.
        """
        self._refuse_more()
        most = self._limits.run_seconds
        if seconds is not None and seconds > most:
            raise ValueError(f"this run may take {seconds:.0f} s, more than the {most:g} s allowed")
        document = deepcopy(dict(document))
        return self._add(
            name, document, job=self._runner.submit(document, self._folder, self._user)
        )

    def read(self, name: str, content: bytes) -> Reading:
        """Begin to read a result that ``softafm run`` or this page saved; its result is a dataset.

        Raises
        ------
        ValueError
            If it is none or too large, or too many are listed; more may be found as it is read.
        """
        self._refuse_more()
        refuse_large(content, self._limits)
        if not content.startswith(_HDF5):
            raise ValueError(f"{name}: not a NetCDF file that softafm wrote")
        return Reading(partial(_read_result, name, content, self._limits.kept_bytes))

    def add(self, name: str, result: "Dataset") -> Entry:
        """List a result from a file; ValueError if too many are listed."""
        self._refuse_more()
        return self._add(Path(name).stem, {}, uploaded=result)

    def rename(self, id: str, label: str) -> None:
        """Give an entry another label, if it is not empty."""
        label = " ".join(label.split())[:_LONGEST_LABEL]
        if label:
            self[id].label = label

    def show(self, id: str, shown: bool) -> None:
        """Draw an entry, or not."""
        self[id].shown = shown

    def cancel(self, id: str) -> None:
        """End a run that is not over."""
        job = self[id].job
        if job is not None:
            job.cancel()

    def remove(self, id: str) -> None:
        """Take an entry off the list, ended if need be."""
        self.cancel(id)
        self.entries.remove(self[id])

    def close(self) -> None:
        """End all runs."""
        for entry in list(self.entries):
            self.remove(entry.id)

    def _refuse_more(self) -> None:
        most = self._limits.listed
        if len(self.entries) >= most:
            raise ValueError(f"{most} runs are listed, the most allowed: remove some first")
        kept = sum(entry.size for entry in self.entries)
        if kept >= self._limits.kept_bytes:
            raise ValueError(
                f"the results listed take {kept / 1e6:.0f} MB of memory: remove some first"
            )

    def _add(self, name: str, document: Mapping[str, Any], **parts: Any) -> Entry:
        self._count += 1
        taken = [entry.colour for entry in self.entries]
        colour = min(RUNS, key=taken.count)
        label = f"{self._count} {name}"[:_LONGEST_LABEL]
        entry = Entry(uuid4().hex[:12], label, colour, document, **parts)
        self.entries.append(entry)
        return entry


def _read_result(name: str, content: bytes, most: int) -> "Dataset":
    """Read a result in a process of its own; ``most`` is its size in memory, bytes."""
    from softafm.results.datasets import load_apart

    with TemporaryDirectory(prefix="softafm-") as folder:
        path = Path(folder) / "result.nc"
        path.write_bytes(content)
        try:
            return load_apart(path, largest=most)
        except ValueError as error:
            raise ValueError(str(error).replace(str(path), name)) from None


def refuse_large(content: bytes, limits: Limits) -> None:
    """Raise ValueError if an uploaded file is larger than allowed."""
    if len(content) > limits.upload_bytes:
        raise ValueError(
            f"the file has {len(content) / 1e6:.1f} MB: at most {limits.upload_bytes / 1e6:g} MB"
        )
