"""Images of maps: physical axes, colour bars in SI prefixes, the usual colours of AFM."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from softafm.checks.kinds import check_list
from softafm.draw.style import choose_factor, choose_labels, find_prefix, write_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset

_COLOURS = {
    "topography": "afmhot", "mean_height": "afmhot", "lowest_height": "afmhot",
    "sample_height": "afmhot", "phase": "cividis", "dissipation": "inferno",
    "loop_energy": "inferno", "viscous_loss": "inferno",
}  # fmt: skip
_USUAL_COLOURS = "viridis"
_USUAL = {
    "amplitude-modulation": ("topography", "phase", "dissipation"),
    "force-volume": ("force_min", "loop_energy", "indentation"),
}
_TITLES = {
    "topography": "Height", "mean_height": "Mean height of the tip", "phase": "Phase lag",
    "lowest_height": "Lowest height", "sample_height": "Height of the sample",
    "dissipation": "Dissipation in a cycle", "virial": "Virial", "force_max": "Largest force",
    "force_min": "Smallest force", "force_mean": "Mean force", "contact_time": "Contact time",
    "force_min_approach": "Smallest force, approach", "indentation": "Indentation",
    "loop_energy": "Loop energy", "viscous_loss": "Viscous loss", "branch": "Branch",
    "material": "Material",
}  # fmt: skip
_NO_PREFIX = {"degree": "°", "1": "", "": ""}


def plot_map(
    maps: "Dataset | Sequence[Dataset]",
    names: Sequence[str] | None = None,
    labels: Sequence[str] | None = None,
) -> Figure:
    """Draw maps as images, a column for each variable and a row for each dataset.

    Parameters
    ----------
    maps
        What ``scan`` returned, or a sequence of such.
    names
        Variables over (y, x); height, phase and dissipation by default, or of a force volume
        pull-off force, loop energy and indentation.
    labels
        A name for each dataset, shown beside its row.

    Returns
    -------
    matplotlib.figure.Figure
        Heights from 0 at the lowest pixel of each image; pixels without a result are light blue.

    Raises
    ------
    ValueError
        If there is nothing to draw, a variable is no map, or the number of labels is not that of
        datasets.
    """
    from xarray import Dataset

    runs = check_list("maps", maps, Dataset, "a result of softafm, an xarray.Dataset")
    titles = choose_labels("dataset", runs, labels, ("" for _ in runs))
    if names is None:
        names = _USUAL.get(str(runs[0].attrs.get("mode")))
        if names is None:
            raise ValueError("names: missing; must be variables over (y, x)")
    names = [names] if isinstance(names, str) else list(names)
    if not names:
        raise ValueError("names = []: must hold at least one variable over (y, x)")
    for run in runs:
        known = [str(name) for name, each in run.data_vars.items() if each.dims == ("y", "x")]
        for name in names:
            if name not in known:
                raise ValueError(f"names: '{name}' is no map; those of the dataset: {known}")
    tall = max(_measure_depth(run) / _measure_width(run) for run in runs)
    panel = 3.3
    size = (len(names) * (panel + 0.9), len(runs) * (panel * min(max(tall, 0.3), 3) + 0.6))
    figure = Figure(figsize=size, dpi=150, layout="constrained")
    axes = figure.subplots(len(runs), len(names), squeeze=False)
    for row, (run, title) in enumerate(zip(runs, titles, strict=True)):
        for column, name in enumerate(names):
            _draw(figure, axes[row, column], run, name)
        if title:
            axes[row, 0].annotate(
                title, (-0.28, 0.5), xycoords="axes fraction", rotation=90, ha="right",
                va="center", fontsize=12, fontweight="bold",
            )  # fmt: skip
    return figure


def _draw(figure: "Figure", ax: "Axes", run: "Dataset", name: str) -> None:
    """Draw one image with its colour bar."""
    variable = run[name]
    values, unit = variable.values, variable.attrs.get("units", "")
    if name in ("topography", "mean_height", "lowest_height", "sample_height"):
        values = values - np.nanmin(values) if np.isfinite(values).any() else values
    factor = 1.0 if unit in _NO_PREFIX else choose_factor(values)
    along = choose_factor(np.array([_measure_width(run), _measure_depth(run)]))
    extent = (0, along * _measure_width(run), along * _measure_depth(run), 0)
    colours = _COLOURS.get(name, _USUAL_COLOURS)
    ax.set_facecolor("lightsteelblue")
    image = ax.imshow(
        np.ma.masked_invalid(factor * values), cmap=colours, extent=extent, interpolation="nearest"
    )
    title = _TITLES.get(name, variable.attrs.get("long_name", name))
    shown = _NO_PREFIX[unit] if unit in _NO_PREFIX else f"{find_prefix(factor)}{unit}"
    ax.set_title(f"{title} ({shown})" if shown else title, fontsize=11)
    ax.set_xlabel(write_label("x", "m", along))
    ax.set_ylabel(write_label("y", "m", along))
    ax.tick_params(direction="out")
    figure.colorbar(image, ax=ax, shrink=0.85, pad=0.02)


def _measure_width(run: "Dataset") -> float:
    return _measure_extent(run["x"].values)


def _measure_depth(run: "Dataset") -> float:
    return _measure_extent(run["y"].values)


def _measure_extent(centres: np.ndarray) -> float:
    """Extent of pixels of which these are the centres, the first half a pixel from 0."""
    return float(centres[0] + centres[-1])
