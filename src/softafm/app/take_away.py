"""What a user takes away from the page: files of a result, and what reproduces a run."""

import io
import shlex
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from softafm.app.links import read_query, write_query
from softafm.app.python_lines import write_python
from softafm.modes import MODES

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = [
    "draw_picture",
    "name_file",
    "read_query",
    "write_command",
    "write_csv",
    "write_netcdf",
    "write_python",
    "write_query",
    "write_toml",
]


def write_toml(document: Mapping[str, Any]) -> str:
    """Return a document as an experiment file."""
    import tomli_w

    return tomli_w.dumps(document)


def name_file(document: Mapping[str, Any]) -> str:
    """Return the name under which the page offers a document's experiment file."""
    mode = str(document.get("mode"))
    return f"{mode if mode in MODES else 'experiment'}.toml"


def write_command(document: Mapping[str, Any]) -> str:
    """Return the shell line that runs the experiment file, downloaded as ``name_file``, again."""
    return shlex.join(["softafm", "run", name_file(document)])


def write_csv(result: "Dataset") -> bytes:
    """Return the curves of a result as ``softafm.export`` writes them to CSV."""
    from softafm.results.datasets import export

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "curves.csv"
        export(result, path)
        return path.read_bytes()


def write_netcdf(result: "Dataset") -> bytes:
    """Return a result as ``softafm.save`` writes it, for ``softafm.load``."""
    from softafm.results.datasets import save

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "result.nc"
        save(result, path)
        return path.read_bytes()


def draw_picture(
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
