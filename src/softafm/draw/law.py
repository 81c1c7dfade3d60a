"""Figures of surface laws: pressure and potential against the gap."""

from collections.abc import Sequence
from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np

from softafm.checks.kinds import check_list
from softafm.surfaces import SurfaceLaw

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MARK: dict[str, Any] = {"linestyle": "none", "marker": "o", "color": "black", "zorder": 4}
_EXTENT = 3.0
"""How far beyond the largest tension a law is drawn, in ranges."""
_FADED = 0.01
"""Part of its pressure at 0.1 nm to which a law that only repels is drawn."""


def plot_surface(
    laws: SurfaceLaw | Sequence[SurfaceLaw],
    labels: Sequence[str] | None = None,
    *,
    largest_gap: float | None = None,
) -> "Figure":
    """Draw pressure and potential of a surface law against the gap, or of several over each other.

    A law that stands alone is marked where its pressure vanishes and where its tension is largest,
    with both gaps, the tension and the work of adhesion in numbers.

    Parameters
    ----------
    laws
        A surface law or a sequence of such.
    labels
        A name for each law, shown in the legend; its kind by default.
    largest_gap
        Where the axes end, m; by default three ranges beyond the largest tension.

    Returns
    -------
    matplotlib.figure.Figure
        Save it with ``figure.savefig``.

    Raises
    ------
    ValueError
        If there is nothing to draw or the number of labels is not that of the laws.
    """
    from matplotlib.figure import Figure

    from softafm.draw.style import choose_labels

    drawn = check_list("laws", laws, SurfaceLaw, "a surface law such as softafm.LennardJones")
    names = choose_labels("law", drawn, labels, (law.kind for law in drawn))
    figure = Figure(figsize=(9.6, 4.2), dpi=150, layout="constrained")
    axes = figure.subplots(1, 2, sharex=True)
    draw_laws(axes[0], axes[1], drawn, names, largest_gap)
    if len(drawn) > 1:
        entries = axes[0].get_legend_handles_labels()
        columns = ceil(len(drawn) / ceil(len(drawn) / 5))
        figure.legend(*entries, loc="outside lower center", ncols=columns, frameon=False)
    return figure


def draw_laws(
    pressure: "Axes",
    potential: "Axes",
    laws: Sequence[SurfaceLaw],
    names: Sequence[str],
    largest_gap: float | None = None,
) -> None:
    """Draw pressures and potentials on their axes; mark the well of a law that stands alone."""
    from softafm.draw.style import choose_factor

    start, end = _choose_window(laws)
    gap = np.linspace(start, end if largest_gap is None else largest_gap, 2001)
    wells = [law for law in laws if law.attracts]
    tensions = [law.largest_tension for law in wells]
    works = [law.work_of_adhesion for law in wells]
    _draw(pressure, gap, [law.pressure(gap) for law in laws], names, tensions, ("Pressure", "Pa"))
    potentials = [law.potential(gap) for law in laws]
    _draw(potential, gap, potentials, names, works, ("Potential", "J/m²"))
    if len(laws) == 1 and wells:
        _mark(pressure, potential, laws[0], choose_factor(gap))


def _choose_window(laws: Sequence[SurfaceLaw]) -> tuple[float, float]:
    """Return the gaps between which the laws differ from hard contact and from nothing."""
    wells = [law for law in laws if law.attracts]
    if wells:
        widths = [_measure_width(law) for law in wells]
        start = min(law.equilibrium_gap - 0.3 * w for law, w in zip(wells, widths, strict=True))
        end = max(
            law.gap_of_largest_tension + _EXTENT * w for law, w in zip(wells, widths, strict=True)
        )
        return max(start, 0.02 * end), end
    gap = np.geomspace(1e-10, 1e-6, 401)
    faded = [law.pressure(gap) < _FADED * law.pressure(gap[0]) for law in laws]
    end = max(gap[f.argmax() if f.any() else -1] for f in faded)
    return 0.02 * float(end), float(end)


def _measure_width(law: SurfaceLaw) -> float:
    """Return the width of a well, m: the range, if it takes work to leave it."""
    return law.range if law.work_of_adhesion > 0 else law.gap_of_largest_tension


def _draw(
    ax: "Axes",
    gap: np.ndarray,
    curves: list[Any],
    names: Sequence[str],
    depths: list[float],
    title: tuple[str, str],
) -> None:
    """Draw curves against the gap, down to the deepest well and up as far again."""
    from softafm.draw.style import choose_factor, choose_line, tidy, write_label

    highest = max(float(curve.max()) for curve in curves)
    depth = max(depths, default=0.0)
    y_scale = choose_factor(np.array([depth or highest]))
    x_scale = choose_factor(gap)
    ax.axhline(0, color="0.75", linewidth=0.8, zorder=0)
    for index, (curve, name) in enumerate(zip(curves, names, strict=True)):
        ax.plot(x_scale * gap, y_scale * curve, label=name, **choose_line(index))
    if depth > 0:
        ax.set_ylim(-1.35 * y_scale * depth, 0.75 * y_scale * depth)
    ax.set_xlim(x_scale * gap[0], x_scale * gap[-1])
    ax.set_xlabel(write_label("Gap", "m", x_scale), fontsize=11)
    ax.set_ylabel(write_label(*title, y_scale), fontsize=11)
    tidy(ax)


def _mark(pressure: "Axes", potential: "Axes", law: SurfaceLaw, x_scale: float) -> None:
    """Mark and name equilibrium gap, largest tension and work of adhesion."""
    from softafm.draw.style import choose_factor, typeset

    tension, work = law.largest_tension, law.work_of_adhesion
    rest, steepest = law.equilibrium_gap, law.gap_of_largest_tension
    for ax, gap, value, text in (
        (pressure, rest, 0.0, f"equilibrium gap {typeset(rest, 'm')}"),
        (
            pressure,
            steepest,
            -choose_factor(np.array([tension])) * tension,
            f"largest tension {typeset(tension, 'Pa')}\nat {typeset(steepest, 'm')}",
        ),
        (
            potential,
            rest,
            -choose_factor(np.array([work])) * work,
            f"work of adhesion {typeset(work, 'J/m²')}",
        ),
    ):
        ax.plot(x_scale * gap, value, **_MARK)
        ax.annotate(
            text,
            (x_scale * gap, value),
            xytext=(10, 5 if value == 0 else -5),
            textcoords="offset points",
            va="bottom" if value == 0 else "top",
            fontsize=9,
        )
