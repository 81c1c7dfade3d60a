"""The movie of tip and surface in the browser, linked to markers on the force curve.

All shapes are sent once, as whole numbers; ``movie.js`` plays them.
"""

from importlib import resources
from typing import TYPE_CHECKING, Any

from bokeh.layouts import column, row
from bokeh.models import (
    Button,
    ColumnDataSource,
    CustomJS,
    CustomJSTickFormatter,
    Label,
    LayoutDOM,
    Range1d,
    Select,
    Slider,
    Span,
)
from bokeh.plotting import figure as new_figure

from softafm.app.colours import Theme, in_role, recolour
from softafm.app.movie_data import CURVES, Movie, make_movie
from softafm.draw.scenes import require_shapes

if TYPE_CHECKING:
    from bokeh.plotting import figure as Figure
    from xarray import Dataset

FRAMES = 240
SECONDS = 6.0
"""Duration of the movie at speed ×1, s."""
_SPEEDS = {"0.1": "×0.1", "0.25": "×0.25", "0.5": "×0.5", "1": "×1", "2": "×2"}
_LEFT = 70


def make_player(result: "Dataset", theme: Theme) -> LayoutDOM | None:
    """Return a player of tip and surface while force acts and the surface returns.

    It counts the frames it draws in the browser's ``window.softafm_movie_frames``.

    Parameters
    ----------
    result
        What a mode returned with ``profiles=True``.
    theme
        ``"light"`` or ``"dark"``; ``colours.recolour`` changes it later.

    Returns
    -------
    LayoutDOM or None
        None if the result holds no shapes.
    """
    try:
        require_shapes(result)
    except ValueError:
        return None
    shown = make_movie(result, FRAMES)
    moving: dict[str, Any] = {
        "tip": _make_source(x=shown.x, y=shown.outline(shown.rise + shown.apex[0], shown.ends[1])),
        "sample": _make_source(x=shown.x, y=shown.outline(shown.surface[0], shown.ends[0])),
        "past": _make_source(**{name: shown.frames[name][:1] for name in CURVES}),
        "now": _make_source(**{name: shown.frames[name][:1] for name in CURVES}),
        "reading": Label(x=12, y=10, x_units="screen", y_units="screen"),
        "slider": _make_slider(shown.moments),
    }
    readings = [f"{t}   {f}" for t, f in zip(shown.moments, shown.strengths, strict=True)]
    moving["reading"].text = readings[0]
    stage = _draw_stage(shown, moving, theme)
    curve = _make_source(**shown.curve)
    graphs = [_draw_graph(shown, curve, moving, abscissa, theme) for abscissa in ("time", "height")]
    button = Button(label="▶", width=48)
    speed = Select(value="1", options=list(_SPEEDS.items()), width=76)
    player = CustomJS(
        args={
            **moving,
            "stage": stage,
            "button": button,
            "speed": speed,
            "frames": _make_source(**shown.frames, apex=shown.apex),
            "rise": _make_source(rise=shown.rise),
            "surface": _make_source(surface=shown.surface.ravel()),
            "curve": curve,
            "readings": readings,
            "quantum": shown.quantum,
            "ends": shown.ends,
            "view": shown.view,
            "seconds": SECONDS,
        },
        code=resources.files("softafm.app").joinpath("movie.js").read_text(encoding="utf-8"),
    )
    button.js_on_event("button_click", player)
    moving["slider"].js_on_change("value", player)
    for size in ("inner_width", "inner_height"):
        stage.js_on_change(size, player)
    for model in (*moving.values(), stage.x_range, stage.y_range):
        model.syncable = False
    layout = column(
        stage,
        row(*graphs, sizing_mode="stretch_width", height=180),
        row(button, moving["slider"], speed, sizing_mode="stretch_width"),
        sizing_mode="stretch_both",
    )
    recolour(layout, theme)
    return layout


def _make_source(**columns: Any) -> ColumnDataSource:
    return ColumnDataSource(columns)


def _make_slider(moments: list[str]) -> Slider:
    written = CustomJSTickFormatter(args={"moments": moments}, code="return moments[tick]")
    return Slider(
        start=0,
        end=len(moments) - 1,
        step=1,
        value=0,
        title="Time",
        format=written,
        sizing_mode="stretch_width",
    )


def _draw_stage(shown: Movie, moving: dict[str, Any], theme: Theme) -> "Figure":
    """Draw tip and sample."""
    stage = new_figure(
        x_range=Range1d(-shown.view["half_width"], shown.view["half_width"]),
        y_range=Range1d(shown.view["bottom"], shown.view["top"]),
        tools="pan,wheel_zoom,reset,save",
        sizing_mode="stretch_both",
        min_height=200,
        min_border_left=_LEFT,
    )
    for thing, width in (("sample", 1.6), ("tip", 1.3)):
        patch = stage.patch("x", "y", source=moving[thing], line_width=width)
        in_role(patch.glyph, theme, fill_color=f"{thing}_body", line_color=f"{thing}_line")
    flat = Span(location=0.0, dimension="width", line_dash=[5, 4])
    stage.add_layout(in_role(flat, theme, line_color="level"))
    stage.add_layout(in_role(moving["reading"], theme, text_color="text"))
    stage.xaxis.axis_label, stage.yaxis.axis_label = shown.titles
    stage.grid.visible = False
    return _strip_tools(stage)


def _draw_graph(
    shown: Movie, curve: ColumnDataSource, moving: dict[str, Any], abscissa: str, theme: Theme
) -> "Figure":
    """Draw the force curve, what of it is past, and the marker."""
    graph = new_figure(
        tools="pan,wheel_zoom,reset",
        toolbar_location=None,
        sizing_mode="stretch_both",
        min_border_left=_LEFT if abscissa == "time" else 40,
    )
    flat = Span(location=0.0, dimension="width")
    graph.add_layout(in_role(flat, theme, line_color="level"))
    for source, role, width in ((curve, "future", 1.5), (moving["past"], "past", 2)):
        line = graph.line(abscissa, "force", source=source, line_width=width)
        in_role(line.glyph, theme, line_color=role)
    marker = graph.scatter(abscissa, "force", source=moving["now"], size=10)
    in_role(marker.glyph, theme, fill_color="now", line_color="now")
    if abscissa == "height":
        graph.x_range = Range1d(*shown.near)
    graph.xaxis.axis_label = shown.labels[abscissa]
    if abscissa == "time":
        graph.yaxis.axis_label = shown.labels["force"]
    graph.yaxis.ticker.desired_num_ticks = 4
    return _strip_tools(graph)


def _strip_tools(figure: "Figure") -> "Figure":
    figure.toolbar.logo = None
    figure.axis.axis_label_text_font_style = "normal"
    figure.axis.axis_label_text_font_size = "12px"
    return figure
