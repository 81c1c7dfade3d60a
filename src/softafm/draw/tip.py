"""The figure of a tip: its profile, and the paraboloid that fits the apex."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from softafm.checks.kinds import check_list
from softafm.checks.validate import check_positive
from softafm.tips import Tip

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_POINTS = 600
_APEX = 1e-4
"""Radius, in extents, at which the curvature of the apex is judged."""
_LOWEST, _HIGHEST = 0.5, 1.2
"""Bounds of the height that is shown, in extents."""
_RADII = np.geomspace(1e-10, 1e-3, 1401)
_STEEP, _BEYOND = 0.9, 1.25
"""Slope to which a tip is drawn, in slopes of its far flank or of 45°, and how far beyond."""


def plot_tip(
    tips: Tip | Sequence[Tip],
    extent: float | None = None,
    labels: Sequence[str] | None = None,
) -> "Figure":
    """Draw the profile of a tip, or of several, and dashed the paraboloid that fits each apex.

    Parameters
    ----------
    tips
        A tip, or a sequence of tips drawn over each other.
    extent
        Radius to draw to, m; by default somewhat beyond the apex and all joints of the profiles.
    labels
        A name for each tip, shown in the legend; its ``kind`` by default.

    Returns
    -------
    matplotlib.figure.Figure
        Height over radius, in equal scales. Save it with ``figure.savefig``.

    Raises
    ------
    ValueError
        If there is no tip, the extent is not above zero or labels are not as many as tips.
    """
    from matplotlib.figure import Figure

    from softafm.draw.style import choose_labels

    drawn = check_list("tips", tips, Tip, "a tip such as softafm.Paraboloid")
    names = choose_labels("tip", drawn, labels, (tip.kind for tip in drawn))
    extent = choose_extent(drawn) if extent is None else check_positive("extent", extent, "m")
    figure = Figure(figsize=(6.4, 4.4), dpi=150, layout="constrained")
    draw_profiles(figure.add_subplot(), drawn, extent, names)
    return figure


def draw_profiles(ax: "Axes", tips: Sequence[Tip], extent: float, names: Sequence[str]) -> None:
    """Draw profiles out to a radius (m) and the paraboloids of their apices on ``ax``."""
    from softafm.draw.style import choose_factor, choose_line, tidy, write_label

    r = np.linspace(-extent, extent, 2 * _POINTS + 1)
    scale = choose_factor(r)
    fitted = set()
    top = _LOWEST * extent
    for index, (tip, name) in enumerate(zip(tips, names, strict=True)):
        height = tip.profile(np.abs(r))
        top = max(top, min(float(height[-1]), _HIGHEST * extent))
        ax.plot(scale * r, scale * height, label=name, **choose_line(index))
        radius = estimate_apex_radius(tip, extent)
        if radius is not None and float(f"{radius:.3g}") not in fitted:
            fitted.add(float(f"{radius:.3g}"))
            shown = "paraboloid of the apex" if len(fitted) == 1 else None
            fit = r**2 / (2 * radius)
            ax.plot(scale * r, scale * fit, color="0.4", dashes=(4, 2), linewidth=1, label=shown)
    ax.set_xlim(-scale * extent, scale * extent)
    ax.set_ylim(-0.05 * scale * top, 1.05 * scale * top)
    ax.set_aspect("equal")
    ax.set_xlabel(write_label("Radius", "m", scale), fontsize=11)
    ax.set_ylabel(write_label("Height", "m", scale), fontsize=11)
    tidy(ax)
    ax.legend(frameon=False, fontsize=9, loc="upper center")


def choose_extent(tips: Sequence[Tip]) -> float:
    """Radius, m, within which the apex of every tip lies, and all its joints."""
    extents = []
    for tip in tips:
        slope = tip.slope(_RADII)
        steep = np.argmax(slope >= _STEEP * min(1.0, slope[-1]))
        extents.append(_BEYOND * max([float(_RADII[steep]), *tip.joints]))
    return max(extents)


def estimate_apex_radius(tip: Tip, extent: float) -> float | None:
    """Radius of curvature at the apex, m, or None of one that is flat or too sharp to be seen."""
    r = _APEX * extent * np.array([1.0, 2.0])
    height = tip.profile(r)
    if height[0] <= 0 or abs(height[1] / height[0] - 4) > 0.01:
        return None
    radius = float(r[0] ** 2 / (2 * height[0]))
    return radius if radius < 1e3 * extent else None
