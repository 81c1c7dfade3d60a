"""Colours of the page's pictures, on light and on dark ground."""

from typing import TYPE_CHECKING, Any, Literal, NamedTuple

if TYPE_CHECKING:
    from bokeh.models import LayoutDOM, Model

Theme = Literal["light", "dark"]

RUNS = ("#1787d4", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#808080")
"""Colours of runs: Okabe and Ito's, the darkest made lighter to be seen on dark ground, too."""


class Palette(NamedTuple):
    """What every part of a picture is coloured, by its role."""

    text: str
    axis: str
    grid: str
    level: str
    """Of lines at zero."""
    ground: str
    """Of the page, inside hollow points."""
    future: str
    """Of the part of a curve that a movie has not come to."""
    past: str
    now: str
    tip_body: str
    tip_line: str
    sample_body: str
    sample_line: str


PALETTES: dict[str, Palette] = {
    "light": Palette(
        text="#33373d", axis="#8a8f98", grid="#ecedf0", level="#b9bdc4", ground="#ffffff",
        future="#a9adb4", past="#1787d4", now="#d55e00",
        tip_body="#b3b3b3", tip_line="#4d4d4d", sample_body="#b5d7ee", sample_line="#0072b2",
    ),
    "dark": Palette(
        text="#d9dce1", axis="#7b818b", grid="#33373d", level="#5a606a", ground="#1c1e21",
        future="#5f656f", past="#56b4e9", now="#ff8c42",
        tip_body="#6d7178", tip_line="#c9ccd1", sample_body="#1f4e6e", sample_line="#56b4e9",
    ),
}  # fmt: skip


def in_role(model: "Model", theme: Theme, **roles: str) -> Any:
    """Colour properties of a model by their roles, remember them, and return the model."""
    model.tags = [*model.tags, roles]
    _fill_roles(model, PALETTES[theme])
    return model


def recolour(layout: "LayoutDOM", theme: Theme) -> None:
    """Give figures, and all that is in them, the colours of a theme, in place."""
    from bokeh.models import Axis, Grid, InlineStyleSheet, Legend, Plot, Widget

    palette = PALETTES[theme]
    for model in layout.references():
        if isinstance(model, Plot):
            model.background_fill_color = model.border_fill_color = None
            model.outline_line_color = palette.axis
        elif isinstance(model, Axis):
            model.axis_label_text_color = model.major_label_text_color = palette.text
            model.axis_line_color = model.major_tick_line_color = palette.axis
            model.minor_tick_line_color = None
        elif isinstance(model, Grid):
            model.grid_line_color = palette.grid
        elif isinstance(model, Legend):
            model.background_fill_color = model.border_line_color = None
            model.label_text_color = palette.text
        elif isinstance(model, Widget):
            model.stylesheets = [InlineStyleSheet(css=_widget_style(palette))]
        _fill_roles(model, palette)


def _widget_style(palette: Palette) -> str:
    """Return the style sheet of a player's button, slider and list."""
    text, axis, ground = palette.text, palette.axis, palette.ground
    return (
        f":host {{ color: {text}; }} .bk-slider-value {{ color: {text}; }}"
        ".bk-btn.bk-btn-default, .bk-input "
        f"{{ background-color: {ground}; color: {text}; border-color: {axis}; }}"
        f".noUi-target {{ background: {palette.grid}; border-color: {axis}; }}"
        f".noUi-connect {{ background: {palette.past}; }}"
    )


def _fill_roles(model: "Model", palette: Palette) -> None:
    for roles in model.tags:
        if isinstance(roles, dict):
            for name, role in roles.items():
                setattr(model, name, getattr(palette, role))
