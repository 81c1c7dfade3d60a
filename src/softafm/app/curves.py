"""Figures of results in the browser: the curves of ``softafm.draw.results``, to zoom into."""

from collections.abc import Iterator, Sequence
from math import inf, nan
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from bokeh.layouts import gridplot
from bokeh.models import (
    Arrow,
    ColumnDataSource,
    GlyphRenderer,
    HoverTool,
    LayoutDOM,
    Legend,
    LegendItem,
    NormalHead,
    Range1d,
    Span,
)
from bokeh.plotting import figure as new_figure

from softafm.app.colours import Theme, in_role, recolour
from softafm.app.curve_data import Parts, collect_parts, find_axis, find_panels
from softafm.draw import histories
from softafm.modes import MODES
from softafm.units.quantities import choose_prefix

if TYPE_CHECKING:
    from bokeh.plotting import figure as Figure
    from xarray import Dataset

__all__ = ["Shown", "draw_figures", "recolour"]

TABS: dict[str, tuple[str, tuple[str, ...]]] = {
    "Force–distance": ("tip_height", ("force",)),
    "F–Z": ("base_height", ("force", "deflection")),
    "Time": ("time", ("force", "tip_height", "deflection", "contact_radius")),
    "Amplitude and phase": ("height", ("ratio", "phase")),
    "Energies and force": ("height", ("dissipation", "virial", "force_max")),
}
"""For each tab what is drawn against what, one panel above another."""

_DASHES = {"approach": "solid", "retract": [6, 3], "curve": "solid"}
_LEVELS = {"phase": 90.0, **dict.fromkeys(("force", "deflection", "tip_height", "virial"), 0.0)}
_POINTS: dict[str, dict[str, Any]] = {
    "elastic jump": {"size": 7, "line_width": 1.5},
    "stable solution": {"size": 5, "line_alpha": 0.0, "fill_alpha": 0.55},
    "unstable solution": {"size": 5, "line_alpha": 0.7},
}
_TOOLS = "pan,box_zoom,wheel_zoom,reset,save"
_HAND = 12
"""Width, in pixels, within which a line feels the mouse."""
_LONGEST_LABEL = 40
_LEFT = 74
"""Room, in pixels, left of every panel, that their axes may stand in line."""


class Shown(NamedTuple):
    """A run to be drawn: what it is called, its colour, and what it found."""

    label: str
    colour: str
    result: "Dataset"


class _Drawn(NamedTuple):
    """A run with its numbers in the units of the axes."""

    label: str
    colour: str
    parts: Parts
    sources: dict[str, ColumnDataSource]
    jumps: dict[str, ColumnDataSource]


def draw_figures(shown: Sequence[Shown], theme: Theme) -> dict[str, LayoutDOM]:
    """Draw runs over each other.

    Parameters
    ----------
    shown
        The runs, of any modes.
    theme
        ``"light"`` or ``"dark"``; ``recolour`` changes it later.

    Returns
    -------
    dict
        For each title of a tab a figure, or a column of them with one abscissa; tabs
        without data are left out.
    """
    found = [(one, collect_parts(one.result)) for one in shown]
    drawable = [(one, parts) for one, parts in found if parts is not None]
    units = _choose_units([parts for _, parts in drawable])
    drawn = [(one.result, _scale(one, parts, units)) for one, parts in drawable]
    tabs = {}
    for title, (abscissa, ordinates) in _list_tabs([result for result, _ in drawn]).items():
        runs = [(result, run) for result, run in drawn if run.parts.holds(abscissa)]
        if runs:
            shape = _choose_window([result for result, _ in runs], abscissa)
            tabs[title] = _draw_tab(
                [run for _, run in runs], abscissa, ordinates, units, shape, theme
            )
    return tabs


def _list_tabs(results: Sequence["Dataset"]) -> dict[str, tuple[str, tuple[str, ...]]]:
    """Return the tabs, with what the figures of modes show beyond the usual."""
    found = dict(TABS)
    titles = {abscissa: title for title, (abscissa, _) in reversed(TABS.items())}
    for result in results:
        for abscissa, ordinate in find_panels(result):
            title = titles.setdefault(abscissa, find_axis(abscissa)[0])
            before = found.get(title, (abscissa, ()))[1]
            if ordinate not in before and {abscissa, ordinate} <= set(result.variables):
                found[title] = abscissa, (*before, ordinate)
    return found


def _choose_units(parts: Sequence[Parts]) -> dict[str, tuple[float, str]]:
    """Return for each quantity the factor from SI to the unit of its axis, and the unit."""
    units = {}
    for name in dict.fromkeys(name for one in parts for name in one.names):
        unit = find_axis(name)[1]
        held = [one.extent(name) for one in parts if one.holds(name)]
        largest = max((abs(end) for extent in held for end in extent if abs(end) < inf), default=0)
        units[name] = (1.0, "") if unit is None else choose_prefix(largest, unit)
    return units


def _scale(shown: Shown, parts: Parts, units: dict[str, tuple[float, str]]) -> _Drawn:
    def scaled(columns: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        return {name: units[name][0] * values for name, values in columns.items()}

    lines = {name: scaled(columns) for name, columns in parts.lines.items()}
    points = {name: scaled(columns) for name, columns in parts.points.items()}
    jumps = {}
    for direction, (before, after) in parts.jumps.items():
        ends = {f"{name}_after": values for name, values in scaled(after).items()}
        jumps[direction] = ColumnDataSource({**scaled(before), **ends})
    return _Drawn(
        shown.label[:_LONGEST_LABEL],
        shown.colour,
        Parts(lines, points, {}),
        {name: ColumnDataSource(columns) for name, columns in {**lines, **points}.items()},
        jumps,
    )


def _choose_window(results: Sequence["Dataset"], abscissa: str) -> tuple[float, float]:
    """Return the stretch of the abscissa to begin with, SI: all, or where there is a force."""
    known = [MODES.get(str(result.attrs.get("mode"))) for result in results]
    whole = any(mode is not None and not mode.figure.cropped for mode in known)
    if whole or abscissa not in histories.AXES:
        return -inf, inf
    return histories.find_force(results, abscissa)


def _draw_tab(
    runs: Sequence[_Drawn],
    abscissa: str,
    ordinates: Sequence[str],
    units: dict[str, tuple[float, str]],
    window: tuple[float, float],
    theme: Theme,
) -> LayoutDOM:
    low, high = (units[abscissa][0] * end for end in window)
    if low == -inf:
        low, high = _widen([run.parts.extent(abscissa) for run in runs], 0.03)
    held = [name for name in ordinates if any(run.parts.holds(name) for run in runs)]
    x_range = Range1d(low, high)
    panels: list[Figure] = []
    for name in held:
        having = [run for run in runs if run.parts.holds(name)]
        ends = [run.parts.extent(name, abscissa, (low, high)) for run in having]
        panel = new_figure(
            x_range=x_range,
            y_range=Range1d(*_widen(ends, 0.06)),
            tools=_TOOLS,
            toolbar_location="right",
            sizing_mode="stretch_both",
            min_height=150 if len(held) < 4 else 110,
            min_border_left=_LEFT,
        )
        panel.toolbar.logo = None
        panel.yaxis.axis_label = _write_label(name, units)
        panel.axis.axis_label_text_font_style = "normal"
        panel.yaxis.axis_label_text_font_size = "13px" if len(held) < 3 else "10.5px"
        panel.xaxis.major_label_text_font_size = "0pt" if name != held[-1] else "11px"
        panel.yaxis.ticker.desired_num_ticks = 6 if len(held) == 1 else 4
        _add_levels(panel, abscissa, name, theme)
        entries = _draw(panel, having, abscissa, name, units, theme)
        if not panels:
            panel.add_layout(_make_legend(entries), "above")
        panels.append(panel)
    panels[-1].xaxis.axis_label = _write_label(abscissa, units)
    tab: LayoutDOM = panels[0]
    if len(panels) > 1:
        tab = gridplot(
            [[panel] for panel in panels], sizing_mode="stretch_both", toolbar_location="right"
        )
        tab.toolbar.logo = None
    recolour(tab, theme)
    return tab


def _write_label(name: str, units: dict[str, tuple[float, str]]) -> str:
    title, unit = find_axis(name)[0], units[name][1]
    return f"{title} ({unit})" if unit else title


def _widen(extents: Sequence[tuple[float, float]], margin: float) -> tuple[float, float]:
    """Return the range of several, and a part more on both sides."""
    low, high = min(low for low, _ in extents), max(high for _, high in extents)
    if low > high:
        return 0.0, 1.0
    room = margin * (high - low) or 0.1 * abs(high) or 1.0
    return low - room, high + room


def _add_levels(panel: "Figure", abscissa: str, ordinate: str, theme: Theme) -> None:
    if ordinate in _LEVELS:
        level = Span(location=_LEVELS[ordinate], dimension="width", level="underlay")
        panel.add_layout(in_role(level, theme, line_color="level"))
    if abscissa in ("tip_height", "base_height"):
        level = Span(location=0.0, dimension="height", level="underlay")
        panel.add_layout(in_role(level, theme, line_color="level"))


def _draw(
    panel: "Figure",
    runs: Sequence[_Drawn],
    x: str,
    y: str,
    units: dict[str, tuple[float, str]],
    theme: Theme,
) -> list[tuple[str, list[GlyphRenderer]]]:
    """Draw all runs in a panel, and return the entries of its legend."""
    by_run: list[tuple[str, list[GlyphRenderer]]] = []
    felt: list[GlyphRenderer] = []
    strokes: dict[str, list[GlyphRenderer]] = {}
    for run in runs:
        of_run: list[GlyphRenderer] = []
        for kind, source in run.sources.items():
            name = f"{run.label}, {kind}"
            if kind in _DASHES:
                line = panel.line(
                    x, y, source=source, name=name, line_color=run.colour, line_width=2,
                    line_dash=_DASHES[kind],
                )  # fmt: skip
                hand = panel.line(x, y, source=source, name=name, line_alpha=0.0, line_width=_HAND)
                drawn = [line, hand]
                felt.append(hand)
            else:
                points = panel.scatter(
                    x, y, source=source, name=name, line_color=run.colour, fill_color=run.colour,
                    level="glyph" if kind == "elastic jump" else "underlay", **_POINTS[kind],
                )  # fmt: skip
                if kind != "stable solution":
                    in_role(points.glyph, theme, fill_color="ground")
                drawn = [points]
                felt.append(points)
            strokes.setdefault(kind, []).extend(drawn)
            of_run += drawn
        _add_arrows(panel, run, x, y)
        by_run.append((run.label, of_run))
    panel.add_tools(_make_hover(felt, x, y, units))
    if len(runs) == 1:
        return list(strokes.items())
    return by_run + list(_make_neutral_entries(panel, list(strokes), theme))


def _make_neutral_entries(
    panel: "Figure", kinds: Sequence[str], theme: Theme
) -> Iterator[tuple[str, list[GlyphRenderer]]]:
    """Yield legend entries of strokes and points for all runs."""
    for kind in kinds:
        if kind in _DASHES:
            sign = panel.line([nan], [nan], line_width=2, line_dash=_DASHES[kind])
            in_role(sign.glyph, theme, line_color="text")
        else:
            sign = panel.scatter([nan], [nan], **_POINTS[kind])
            fill = "text" if kind == "stable solution" else "ground"
            in_role(sign.glyph, theme, line_color="text", fill_color=fill)
        yield kind, [sign]


def _add_arrows(panel: "Figure", run: _Drawn, x: str, y: str) -> None:
    for direction, source in run.jumps.items():
        panel.add_layout(
            Arrow(
                source=source,
                x_start=x,
                y_start=y,
                x_end=f"{x}_after",
                y_end=f"{y}_after",
                line_color=run.colour,
                line_dash=_DASHES[direction],
                end=NormalHead(size=8, fill_color=run.colour, line_color=run.colour),
            )
        )


def _make_hover(
    renderers: list[GlyphRenderer], x: str, y: str, units: dict[str, tuple[float, str]]
) -> HoverTool:
    """Show the run and, in their units, what is drawn and when it was."""
    columns = set.intersection(*(set(renderer.data_source.data) for renderer in renderers))
    names = dict.fromkeys([x, y, *({"time"} & columns)])
    tips = [(find_axis(name)[0], f"@{name}{{%.4g}} {units[name][1]}".strip()) for name in names]
    return HoverTool(
        renderers=renderers,
        tooltips=[("Run", "$name"), *tips],
        formatters={f"@{name}": "printf" for name in names},
        point_policy="snap_to_data",
        line_policy="nearest",
        limit=3,
    )


def _make_legend(entries: list[tuple[str, list[GlyphRenderer]]]) -> Legend:
    return Legend(
        items=[LegendItem(label={"value": name}, renderers=drawn) for name, drawn in entries],
        orientation="horizontal",
        ncols=min(len(entries), 5),
        click_policy="hide",
        spacing=14,
        padding=2,
        margin=2,
    )
