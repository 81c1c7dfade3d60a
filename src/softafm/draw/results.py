"""Static figures of results, one kind for each mode, drawn without pyplot or any global state."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from softafm.checks.kinds import check_list
from softafm.draw.approach import draw_approach_curve
from softafm.draw.panels import draw_panels
from softafm.draw.reference import NAME as REFERENCE
from softafm.draw.reference import draw_references, list_references
from softafm.draw.style import COLOURS, choose_labels
from softafm.indentation import Curve
from softafm.modes import MODES
from softafm.results.content import MAPS

Reference = str | Curve | tuple[ArrayLike, ArrayLike]
"""A known answer, by name or as it was computed, or tip heights and forces."""

__all__ = ["COLOURS", "plot"]


def plot(
    datasets: xr.Dataset | Sequence[xr.Dataset],
    labels: Sequence[str] | None = None,
    reference: xr.Dataset | Reference | Sequence[Reference] | None = None,
) -> Figure:
    """Draw one result, or several of the same mode over each other.

    Parameters
    ----------
    datasets
        What a mode returned, or a sequence of such.
    labels
        A name for each dataset, shown in the legend; "run 1", "run 2", ... by default.
    reference
        What to compare them with: one more result of the same mode; or, where force is drawn
        against tip height, a known answer of ``softafm.indentation``: by name, ``"hertz"``,
        ``"dmt"``, ``"jkr"``, ``"maugis"``, ``"lee-radok"`` or ``"ting"``, for the contact and the
        motion of each result; as a ``Curve``; or as a pair of heights (m) and forces (N). Several
        are given in a list. They are drawn within the range of the results. Answers by name are
        counted from where the surfaces rest on each other, at a gap of no pressure or, of a law
        that only repels, of the mean pressure; curves and pairs are drawn as they are.

    Returns
    -------
    matplotlib.figure.Figure
        Force-distance curves; deflection and force in spectroscopy against time, base and tip
        height; force of a tap against time and tip height; phase, dissipation and virial of an
        approach curve against amplitude ratio, and amplitude against height; of other modes what
        their ``figure`` names; maps as by ``plot_map``. Save it with ``figure.savefig``.

    Raises
    ------
    ValueError
        If there is nothing to draw, if the modes differ or have no figure, if the number of
        labels is not that of datasets, if the figure cannot show the reference, or if a known
        answer does not suit the contact.
    """
    runs = check_list("datasets", datasets, xr.Dataset, "a result of softafm, an xarray.Dataset")
    names = choose_labels("dataset", runs, labels, (f"run {i + 1}" for i in range(len(runs))))
    if isinstance(reference, xr.Dataset):
        figure = _plot([*runs, reference], [*names, REFERENCE])
        _tell_regularised(figure, [*runs, reference])
        return figure
    figure = _plot(runs, names)
    _tell_regularised(figure, runs)
    if reference is not None:
        mode = str(runs[0].attrs["mode"])
        draw_references(figure, mode, runs, list_references(reference))
    return figure


def _plot(runs: list[xr.Dataset], names: list[str]) -> Figure:
    """Draw results of one mode, each with its name."""
    modes = sorted({str(run.attrs.get("mode")) for run in runs})
    known = [*MODES, *MAPS]
    if len(modes) > 1 or modes[0] not in known:
        raise ValueError(
            f"mode = {', '.join(modes)}: must be the same for all, one of {', '.join(known)}"
        )
    if modes[0] in MAPS:
        return _draw_maps(runs, names)
    if "sweep_height" in runs[0].dims:
        return draw_approach_curve(runs, names)
    return draw_panels(runs, names, MODES[modes[0]].figure)


def _tell_regularised(figure: Figure, runs: list[xr.Dataset]) -> None:
    """Say below a figure that contacts were regularised by themselves, and how far it is off."""
    errors = [run.attrs["regularised_error"] for run in runs if "regularised_error" in run.attrs]
    if errors:
        worst = np.max(errors)
        off = "error not known" if np.isnan(worst) else f"estimated error {100 * worst:.2g} %"
        figure.supxlabel(f"too soft for their law, and regularised: {off}", fontsize=8)


def _draw_maps(runs: list[xr.Dataset], names: list[str]) -> Figure:
    from softafm.draw.maps import plot_map

    return plot_map(runs, labels=names if len(runs) > 1 else None)
