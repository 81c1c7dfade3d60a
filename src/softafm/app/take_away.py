"""What a user takes away from the page: files of a result, and what reproduces a run."""

import io
import shlex
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from softafm.app.links import from_query, to_query
from softafm.app.python_lines import python_lines
from softafm.modes import MODES

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = [
    "command_line",
    "csv_bytes",
    "file_name",
    "from_query",
    "netcdf_bytes",
    "picture",
    "python_lines",
    "to_query",
    "toml_text",
]


def toml_text(document: Mapping[str, Any]) -> str:
    """Return a document as an experiment file."""
    import tomli_w

    return tomli_w.dumps(document)


def file_name(document: Mapping[str, Any]) -> str:
    """Return the name under which the page offers a document's experiment file."""
    mode = str(document.get("mode"))
    return f"{mode if mode in MODES else 'experiment'}.toml"


def command_line(document: Mapping[str, Any]) -> str:
    """Return the shell line that runs the experiment file, downloaded as ``file_name``, again."""
    return shlex.join(["softafm", "run", file_name(document)])


def csv_bytes(result: "Dataset") -> bytes:
    """Return the curves of a result as ``softafm.export`` writes them to CSV."""
    from softafm.results.datasets import export

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "curves.csv"
        export(result, path)
        return path.read_bytes()


def netcdf_bytes(result: "Dataset") -> bytes:
    """Return a result as ``softafm.save`` writes it, for ``softafm.load``."""
    from softafm.results.datasets import save

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "result.nc"
        save(result, path)
        return path.read_bytes()


def picture(
    results: Sequence["Dataset"],
    kind: Literal["png", "svg"],
    labels: Sequence[str] | None = None,
) -> bytes:
    """Return the figure that ``softafm.draw.results.plot`` draws of results of one mode.

    Raises
    ------
    ValueError
        As ``plot``, among others if the modes differ.
    """
    from softafm.draw.results import plot

    content = io.BytesIO()
    plot(list(results), labels).savefig(content, format=kind)
    return content.getvalue()
