"""Static figures of results, one kind for each mode, drawn without pyplot or any global state."""

from collections.abc import Iterator, Sequence
from math import floor, log10
from typing import Any, Final

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import EngFormatter, MaxNLocator

from softafm.units import readable

# Okabe and Ito's palette: told apart under every common colour blindness, and in grey.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
APPROACH: Final = "-"
RETRACT: Final = (0, (4, 1.5))
PREFIXES = EngFormatter.ENG_PREFIXES
JUMP: dict[str, Any] = {
    "linestyle": "none",
    "marker": "o",
    "markersize": 4.5,
    "markerfacecolor": "white",
}


def plot(
    datasets: xr.Dataset | Sequence[xr.Dataset], labels: Sequence[str] | None = None
) -> Figure:
    """Draw one result, or several of the same mode over each other.

    Parameters
    ----------
    datasets
        What a mode returned, or a sequence of such.
    labels
        A name for each dataset, shown in the legend; "run 1", "run 2", ... by default.

    Returns
    -------
    matplotlib.figure.Figure
        Force-distance curves, or force of a tap against time and tip height; save it with
        ``figure.savefig``.

    Raises
    ------
    ValueError
        If there is nothing to draw, if the modes differ or have no figure, or if the number of
        labels is not that of datasets.
    """
    runs = [datasets] if isinstance(datasets, xr.Dataset) else list(datasets)
    if not runs:
        raise ValueError("datasets is empty: must hold at least one result")
    names = [f"run {i}" for i in range(1, len(runs) + 1)] if labels is None else list(labels)
    if len(names) != len(runs):
        raise ValueError(f"labels has {len(names)} entries: must have one a dataset, {len(runs)}")
    modes = sorted({str(run.attrs.get("mode")) for run in runs})
    if modes == ["force-distance"]:
        return _force_distance(runs, names)
    if modes == ["tapping-cycle"]:
        return _tapping_cycle(runs, names)
    raise ValueError(
        f"mode = {', '.join(modes)}: must be force-distance or tapping-cycle, the same for all"
    )


def _force_distance(runs: list[xr.Dataset], names: list[str]) -> Figure:
    figure = Figure(figsize=(6.4, 4.4), dpi=150, layout="constrained")
    ax = figure.add_subplot()
    _draw(ax, runs, "tip_height", "Tip height", "m")
    ax.legend(handles=_run_entries(names) + _stroke_entries(runs), frameon=False)
    return figure


def _tapping_cycle(runs: list[xr.Dataset], names: list[str]) -> Figure:
    figure = Figure(figsize=(9.6, 4.2), dpi=150, layout="constrained")
    against_time, against_height = figure.subplots(1, 2, sharey=True)
    _draw(against_time, runs, "time", "Time", "s")
    _draw(against_height, runs, "tip_height", "Tip height", "m")
    against_height.set_ylabel("")
    for ax, variable in ((against_time, "time"), (against_height, "tip_height")):
        ax.set_xlim(*(_scale(runs, variable) * limit for limit in _interaction(runs, variable)))

    duration = max(float(np.ptp(run["time"].values)) for run in runs)
    against_time.set_title(f"Interaction only; the run lasts {_quantity(duration, 's')}", size=10)
    against_time.legend(handles=_stroke_entries(runs), frameon=False)
    if len(runs) == 1:
        against_height.set_title(_summary(runs[0]), size=10)
    else:
        summaries = [f"{name}: {_summary(run)}" for name, run in zip(names, runs, strict=True)]
        figure.legend(handles=_run_entries(summaries), loc="outside lower center", frameon=False)
    return figure


def _draw(ax: Axes, runs: list[xr.Dataset], abscissa: str, title: str, unit: str) -> None:
    """Draw force against a variable in the prefixes that suit the data, and label the axes."""
    x_scale, y_scale = _scale(runs, abscissa), _scale(runs, "force")
    ax.axhline(0, color="0.75", linewidth=0.8, zorder=0)
    if abscissa == "tip_height":
        ax.axvline(0, color="0.75", linewidth=0.8, zorder=0)
    for index, run in enumerate(runs):
        x, force = x_scale * run[abscissa].values, y_scale * run["force"].values
        approach_colour, retract_colour = _colours(index, len(runs))
        for stroke, falling in _strokes(run["tip_height"].values):
            ax.plot(
                x[stroke],
                force[stroke],
                color=approach_colour if falling else retract_colour,
                linestyle=APPROACH if falling else RETRACT,
                linewidth=1.5,
            )
        jumps = run["jump_time"].values
        ax.plot(
            np.interp(jumps, run["time"].values, x),
            np.interp(jumps, run["time"].values, force),
            color=approach_colour if len(runs) > 1 else "black",
            zorder=3,
            **JUMP,
        )
    ax.set_xlabel(f"{title} ({_prefixed(unit, x_scale)})", fontsize=11)
    ax.set_ylabel(f"Force on the tip ({_prefixed('N', y_scale)})", fontsize=11)
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator("auto", steps=[1, 2, 5, 10]))
    ax.tick_params(direction="in", top=True, right=True)


def _run_entries(names: list[str]) -> list[Line2D]:
    """Legend entries of runs by colour; none for a run that stands alone."""
    if len(names) == 1:
        return []
    colours = [_colours(index, len(names))[0] for index in range(len(names))]
    return [
        Line2D([], [], color=colour, linewidth=2.5, label=name)
        for colour, name in zip(colours, names, strict=True)
    ]


def _stroke_entries(runs: list[xr.Dataset]) -> list[Line2D]:
    """Legend entries of strokes by line style, and of elastic jumps if there are any."""
    approach_colour, retract_colour = _colours(0, 1) if len(runs) == 1 else ("black", "black")
    entries = [
        Line2D([], [], color=approach_colour, linestyle=APPROACH, label="approach"),
        Line2D([], [], color=retract_colour, linestyle=RETRACT, label="retract"),
    ]
    if any(run["jump_time"].size for run in runs):
        entries.append(Line2D([], [], color="black", label="elastic jump", **JUMP))
    return entries


def _summary(run: xr.Dataset) -> str:
    """What a tap does to the oscillation, and how hard it hits."""
    return (
        f"virial {_quantity(float(run['virial']), 'J')}, "
        f"dissipation {_quantity(float(run['dissipation']), 'J')}, "
        f"peak force {_quantity(float(run['force_max']), 'N')}"
    )


def _colours(index: int, count: int) -> tuple[str, str]:
    """Colours of approach and retract: one a run, but two for a run that stands alone."""
    if count == 1:
        return COLOURS[0], COLOURS[1]
    return COLOURS[index % len(COLOURS)], COLOURS[index % len(COLOURS)]


def _strokes(height: np.ndarray) -> Iterator[tuple[slice, bool]]:
    """Yield the strokes of a motion as (samples, whether the tip falls).

    A stroke ends at its extreme height once the motion has reversed by a fiftieth of its range:
    the noise of a measured trajectory makes none.
    """
    reversal = np.ptp(height) / 50
    away = np.flatnonzero(np.abs(height - height[0]) > reversal)
    falling = bool(away.size == 0 or height[away[0]] < height[0])
    start = extreme = 0
    for i, now in enumerate(height):
        onward = height[extreme] - now if falling else now - height[extreme]
        if onward >= 0:
            extreme = i
        elif -onward > reversal:
            yield slice(start, extreme + 1), falling
            start, extreme, falling = extreme, i, not falling
    yield slice(start, height.size), falling


def _interaction(runs: list[xr.Dataset], variable: str) -> tuple[float, float]:
    """Range of a variable where the force exceeds a hundredth of its largest, with a margin."""
    felt = []
    for run in runs:
        strength = np.abs(run["force"].values)
        felt.append(run[variable].values[strength >= 0.01 * strength.max()])
    low, high = float(np.min(np.concatenate(felt))), float(np.max(np.concatenate(felt)))
    margin = 0.1 * (high - low) or 0.1 * (abs(high) or 1.0)
    return low - margin, high + margin


def _scale(runs: list[xr.Dataset], variable: str) -> float:
    """Factor from SI to the prefix that suits the largest value of all runs."""
    return _factor(max(float(np.max(np.abs(run[variable].values))) for run in runs))


def _factor(largest: float) -> float:
    exponent = 3 * floor(log10(largest) / 3) if largest > 0 else 0
    return 10.0 ** -min(max(exponent, min(PREFIXES)), max(PREFIXES))


def _prefixed(unit: str, factor: float) -> str:
    return PREFIXES[-round(log10(factor))] + unit


def _quantity(value: float, unit: str) -> str:
    return readable(value, unit).replace("-", "−")
