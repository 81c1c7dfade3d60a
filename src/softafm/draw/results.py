"""Static figures of results, one kind for each mode, drawn without pyplot or any global state."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from softafm.checks.kinds import list_of
from softafm.draw.approach import approach_curve
from softafm.draw.histories import AXES, felt, moved, strokes
from softafm.draw.reference import NAME as REFERENCE
from softafm.draw.reference import draw_curve
from softafm.draw.style import (
    APPROACH,
    COLOURS,
    HOLLOW,
    RETRACT,
    colours,
    factor_of,
    label_of,
    labels_of,
    quantity,
    run_entries,
    stroke_entries,
    tidy,
)

__all__ = ["COLOURS", "plot"]


def plot(
    datasets: xr.Dataset | Sequence[xr.Dataset],
    labels: Sequence[str] | None = None,
    reference: xr.Dataset | tuple[ArrayLike, ArrayLike] | None = None,
) -> Figure:
    """Draw one result, or several of the same mode over each other.

    Parameters
    ----------
    datasets
        What a mode returned, or a sequence of such.
    labels
        A name for each dataset, shown in the legend; "run 1", "run 2", ... by default.
    reference
        What to compare them with: one more result of the same mode, or a closed form of force
        against tip height, as a pair of heights (m) and forces (N), such as
        ``(-indentation.depth(tip, a), indentation.load(tip, a, modulus))``. It is drawn as a dotted
        line, within the range of the results.

    Returns
    -------
    matplotlib.figure.Figure
        Force-distance curves; deflection and force in spectroscopy against time, base and tip
        height; force of a tap against time and tip height; phase, dissipation and virial of an
        approach curve against amplitude ratio, and amplitude against height; maps as by
        ``plot_map``. Save it with ``figure.savefig``.

    Raises
    ------
    ValueError
        If there is nothing to draw, if the modes differ or have no figure, if the number of
        labels is not that of datasets, or if the figure cannot show the reference.
    """
    runs = list_of("datasets", datasets, xr.Dataset, "a result of softafm, an xarray.Dataset")
    names = labels_of("dataset", runs, labels, (f"run {i + 1}" for i in range(len(runs))))
    if isinstance(reference, xr.Dataset):
        return _plot([*runs, reference], [*names, REFERENCE])
    figure = _plot(runs, names)
    if reference is not None:
        draw_curve(figure, str(runs[0].attrs["mode"]), runs, reference)
    return figure


def _plot(runs: list[xr.Dataset], names: list[str]) -> Figure:
    """Draw results of one mode, each with its name."""
    modes = sorted({str(run.attrs.get("mode")) for run in runs})
    figures = {
        "force-distance": _force_distance,
        "force-spectroscopy": _force_spectroscopy,
        "tapping-cycle": _tapping_cycle,
        "amplitude-modulation": _maps,
        "force-volume": _maps,
        "approach-curve": approach_curve,
    }
    if len(modes) == 1 and modes[0] in figures:
        return figures[modes[0]](runs, names)
    *others, last = figures
    raise ValueError(
        f"mode = {', '.join(modes)}: must be {', '.join(others)} or {last}, the same for all"
    )


def _maps(runs: list[xr.Dataset], names: list[str]) -> Figure:
    from softafm.draw.maps import plot_map

    return plot_map(runs, labels=names if len(runs) > 1 else None)


def _force_distance(runs: list[xr.Dataset], names: list[str]) -> Figure:
    figure = Figure(figsize=(6.4, 4.4), dpi=150, layout="constrained")
    ax = figure.add_subplot()
    _draw(ax, runs, "tip_height")
    ax.legend(handles=run_entries(names) + _stroke_entries(runs), frameon=False)
    return figure


def _force_spectroscopy(runs: list[xr.Dataset], names: list[str]) -> Figure:
    figure = Figure(figsize=(12.0, 4.2), dpi=150, layout="constrained")
    against_time, against_base, against_tip = figure.subplots(1, 3)
    against_tip.sharey(against_base)
    against_tip.sharex(against_base)
    _draw(against_time, runs, "time", "deflection")
    _draw(against_base, runs, "base_height")
    _draw(against_tip, runs, "tip_height")
    against_tip.set_ylabel("")
    against_tip.tick_params(labelleft=False)
    _crop(against_time, runs, "time")
    _crop(against_base, runs, "base_height", "tip_height")
    against_time.set_title(_duration(runs), size=10)
    entries = run_entries(names) + _stroke_entries(runs)
    columns = min(len(entries), 6)
    figure.legend(handles=entries, loc="outside lower center", ncols=columns, frameon=False)
    return figure


def _tapping_cycle(runs: list[xr.Dataset], names: list[str]) -> Figure:
    figure = Figure(figsize=(9.6, 4.2), dpi=150, layout="constrained")
    against_time, against_height = figure.subplots(1, 2, sharey=True)
    _draw(against_time, runs, "time")
    _draw(against_height, runs, "tip_height")
    against_height.set_ylabel("")
    _crop(against_time, runs, "time")
    _crop(against_height, runs, "tip_height")

    against_time.set_title(_duration(runs), size=10)
    against_time.legend(handles=_stroke_entries(runs), frameon=False)
    if len(runs) == 1:
        against_height.set_title(_summary(runs[0]), size=10)
    else:
        summaries = [f"{name}: {_summary(run)}" for name, run in zip(names, runs, strict=True)]
        figure.legend(handles=run_entries(summaries), loc="outside lower center", frameon=False)
    return figure


def _draw(ax: Axes, runs: list[xr.Dataset], abscissa: str, ordinate: str = "force") -> None:
    """Draw two variables in the prefixes that suit the data, and label the axes."""
    x_scale, y_scale = _scale(runs, abscissa), _scale(runs, ordinate)
    ax.axhline(0, color="0.75", linewidth=0.8, zorder=0)
    if abscissa != "time":
        ax.axvline(0, color="0.75", linewidth=0.8, zorder=0)
    for index, run in enumerate(runs):
        x, y = x_scale * run[abscissa].values, y_scale * run[ordinate].values
        approach_colour, retract_colour = colours(index, len(runs))
        for stroke, falling in strokes(run[moved(run)].values):
            ax.plot(
                x[stroke],
                y[stroke],
                color=approach_colour if falling else retract_colour,
                linestyle=APPROACH if falling else RETRACT,
                linewidth=1.5,
            )
        jumps = run["jump_time"].values
        ax.plot(
            np.interp(jumps, run["time"].values, x),
            np.interp(jumps, run["time"].values, y),
            color=approach_colour if len(runs) > 1 else "black",
            zorder=3,
            **HOLLOW,
        )
    ax.set_xlabel(label_of(*AXES[abscissa], x_scale), fontsize=11)
    ax.set_ylabel(label_of(*AXES[ordinate], y_scale), fontsize=11)
    tidy(ax)


def _stroke_entries(runs: list[xr.Dataset]) -> list[Line2D]:
    """Legend entries of strokes by line style, and of elastic jumps if there are any."""
    entries = stroke_entries(len(runs))
    if any(run["jump_time"].size for run in runs):
        entries.append(Line2D([], [], color="black", label="elastic jump", **HOLLOW))
    return entries


def _summary(run: xr.Dataset) -> str:
    """What a tap does to the oscillation, and how hard it hits."""
    return (
        f"virial {quantity(float(run['virial']), 'J')}, "
        f"dissipation {quantity(float(run['dissipation']), 'J')}, "
        f"peak force {quantity(float(run['force_max']), 'N')}"
    )


def _crop(ax: Axes, runs: list[xr.Dataset], *variables: str) -> None:
    """Show, with a margin, only where the force exceeds a hundredth of its largest."""
    low, high = felt(runs, *variables)
    scale = _scale(runs, variables[0])
    ax.set_xlim(scale * low, scale * high)


def _duration(runs: list[xr.Dataset]) -> str:
    duration = max(float(np.ptp(run["time"].values)) for run in runs)
    return f"Interaction only; the run lasts {quantity(duration, 's')}"


def _scale(runs: list[xr.Dataset], variable: str) -> float:
    """Factor from SI to the prefix that suits the largest value of all runs."""
    return factor_of(*(run[variable].values for run in runs))
