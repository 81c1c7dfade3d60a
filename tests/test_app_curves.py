"""Figures in the browser: what they hold, in which units, and for whom."""

import numpy as np
import pytest

pytest.importorskip("bokeh")

from bokeh.document import Document
from bokeh.models import Arrow, Axis, GlyphRenderer, HoverTool, Legend, Plot
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import softafm as sa
from softafm.app.colours import PALETTES, RUNS
from softafm.app.curve_data import thin
from softafm.app.curves import Shown, draw_figures, recolour
from softafm.experiment import config


@pytest.fixture(scope="module")
def results():
    return {
        name: sa.run(config.parse_document(config.read_example(name), name))
        for name in config.list_examples()
    }  # fmt: skip


def shown(results, *names):
    return [Shown(name, RUNS[k], results[name]) for k, name in enumerate(names)]


def panels(tab):
    return sorted(tab.select({"type": Plot}), key=lambda panel: int(panel.id.strip("p")))


def lines(panel, words):
    """The data of what is drawn under a name, without the invisible lines that feel the mouse."""
    found = [r for r in panel.select({"type": GlyphRenderer}) if words in (r.name or "")]
    return [r for r in found if getattr(r.glyph, "line_alpha", 1) != 0]


def drawn(renderer):
    columns = renderer.data_source.data
    return columns[renderer.glyph.x], columns[renderer.glyph.y]


@pytest.mark.parametrize(
    ("name", "titles"),
    [
        ("attard-triangle", ["Force–distance", "Time"]),
        ("ldpe-tapping", ["Force–distance", "Time"]),
        ("ldpe-spectroscopy", ["Force–distance", "F–Z", "Time"]),
        ("ps-approach-curve", ["Amplitude and phase", "Energies and force"]),
    ],
)
def test_a_mode_has_its_tabs_and_they_can_be_sent(results, name, titles):
    tabs = draw_figures(shown(results, name), "light")
    assert list(tabs) == titles
    document = Document()
    for tab in tabs.values():
        document.add_root(tab)
    assert len(document.to_json().content["roots"]) == len(titles)


def test_curves_are_those_of_the_result_in_units_one_reads(results):
    result = results["ldpe-tapping"]
    (panel,) = panels(draw_figures(shown(results, "ldpe-tapping"), "light")["Force–distance"])
    assert panel.xaxis[0].axis_label == "Tip height (nm)"
    assert panel.yaxis[0].axis_label == "Force on the tip (nN)"
    ((x, y), (x_back, y_back)) = (
        drawn(lines(panel, stroke)[0]) for stroke in ("approach", "retract")
    )
    np.testing.assert_allclose(np.append(x, x_back[1:]), 1e9 * result.tip_height, rtol=1e-12)
    np.testing.assert_allclose(np.append(y, y_back[1:]), 1e9 * result.force, rtol=1e-12)
    assert np.all(np.diff(x) < 0)
    dashes = [lines(panel, stroke)[0].glyph.line_dash for stroke in ("approach", "retract")]
    assert dashes[0] != dashes[1]


def test_elastic_jumps_are_marked_where_they_happened(results):
    result = results["pdms-sphere"]
    (panel,) = panels(draw_figures(shown(results, "pdms-sphere"), "light")["Force–distance"])
    (jumps,) = lines(panel, "elastic jump")
    after = result.sel(time=result.jump_time.values, method="nearest")
    x, y = drawn(jumps)
    np.testing.assert_allclose(x, 1e9 * after.tip_height, rtol=1e-6)
    np.testing.assert_allclose(y, 1e6 * after.force, rtol=1e-6)


def test_the_time_tab_shows_what_a_lever_does_on_one_axis(results):
    tab = draw_figures(shown(results, "ldpe-spectroscopy"), "light")["Time"]
    labels = [panel.yaxis[0].axis_label for panel in panels(tab)]
    assert labels == [
        "Force on the tip (nN)", "Tip height (nm)", "Deflection (pm)", "Contact radius (nm)"
    ]  # fmt: skip
    assert len({panel.x_range.id for panel in panels(tab)}) == 1


def test_a_sweep_shows_its_jumps_and_all_solutions(results):
    result = results["ps-approach-curve"]
    tabs = draw_figures(shown(results, "ps-approach-curve"), "light")
    amplitude, phase = panels(tabs["Amplitude and phase"])
    assert phase.xaxis[0].axis_label == "Mean height of the tip, Z (nm)"
    x, y = drawn(lines(phase, ", approach")[0])
    assert np.count_nonzero(np.isnan(y)) == 1  # where it jumps
    np.testing.assert_allclose(x[~np.isnan(x)], 1e9 * result.sweep_height, rtol=1e-12)
    np.testing.assert_allclose(y[~np.isnan(y)], result.approach_phase, rtol=1e-12)
    assert len(phase.select({"type": Arrow})) == 2
    _, ratio = drawn(lines(amplitude, ", unstable solution")[0])
    unstable = result.mean_height.sel(branch="unstable").notnull()
    assert set(result.amplitude_ratio.values[unstable]) <= set(ratio)
    labels = [panel.yaxis[0].axis_label for panel in panels(tabs["Energies and force"])]
    assert labels == ["Dissipation in a cycle (aJ)", "Virial (aJ)", "Peak force (nN)"]


def test_hover_tells_run_values_and_units(results):
    (panel,) = panels(draw_figures(shown(results, "ldpe-tapping"), "light")["Force–distance"])
    (hover,) = panel.select({"type": HoverTool})
    assert hover.tooltips == [
        ("Run", "$name"),
        ("Tip height", "@tip_height{%.4g} nm"),
        ("Force on the tip", "@force{%.4g} nN"),
        ("Time", "@time{%.4g} µs"),
    ]


def test_runs_overlay_in_their_colours_and_common_units(results):
    both = shown(results, "ldpe-tapping", "attard-triangle")
    tabs = draw_figures([*both, *shown(results, "ps-approach-curve")], "light")
    assert len(tabs) == 4
    (panel,) = panels(tabs["Force–distance"])
    assert panel.yaxis[0].axis_label == "Force on the tip (µN)"
    for run in both:
        for line in lines(panel, f"{run.label}, "):
            assert line.glyph.line_color == run.colour
            assert line.data_source.data["force"].max() < 10
    (legend,) = panel.select({"type": Legend})
    written = [item.label["value"] for item in legend.items]
    assert written == ["ldpe-tapping", "attard-triangle", "approach", "retract", "elastic jump"]


def test_a_label_is_text_wherever_it_stands(results):
    label = "<img src=x onerror=alert(1)> @force{safe} $$x$$"
    run = Shown(label, RUNS[0], results["ldpe-tapping"])
    (panel,) = panels(draw_figures([run], "light")["Force–distance"])
    (hover,) = panel.select({"type": HoverTool})
    assert "img" not in str(hover.tooltips)
    assert any("img" in (renderer.name or "") for renderer in hover.renderers)


def test_a_theme_can_be_changed(results):
    tab = draw_figures(shown(results, "ldpe-tapping", "ldpe-movie"), "light")["Time"]
    recolour(tab, "dark")
    for axis in tab.select({"type": Axis}):
        assert axis.major_label_text_color == PALETTES["dark"].text
    for panel in panels(tab):
        assert panel.background_fill_color is None
    text = str(Document().add_root(tab) or tab.document.to_json().content)
    light = set(PALETTES["light"]) - set(PALETTES["dark"]) - set(RUNS)
    assert not [colour for colour in light if colour in text]


def test_nothing_to_draw_makes_no_tabs(results):
    empty = results["ps-approach-curve"].isel(sweep_height=slice(0))
    assert draw_figures([Shown("empty", RUNS[0], empty)], "light") == {}
    assert draw_figures([], "dark") == {}


def test_a_long_history_is_thinned_to_what_can_be_seen(results):
    result = results["ldpe-tapping"]
    fine = np.linspace(0, float(result.time[-1]), 200_000)
    long = result.interp(time=fine)
    (panel,) = panels(draw_figures([Shown("long", RUNS[0], long)], "light")["Force–distance"])
    kept = [drawn(lines(panel, stroke)[0]) for stroke in ("approach", "retract")]
    assert sum(x.size for x, _ in kept) <= 20_002
    force = np.concatenate([y for _, y in kept])
    assert np.nanmax(force) == 1e9 * float(long.force.max())
    assert np.nanmin(force) == 1e9 * float(long.force.min())


def test_thinning_keeps_the_shape_of_many_cycles():
    time = np.linspace(0, 60, 12_001)
    phase = np.pi * (1 + np.sin(0.3 + 2 * np.pi * time))
    height, force = np.cos(phase) + 0.1 * np.sin(3 * phase), np.exp(np.sin(phase))
    kept = thin(time, [time, height, force], 6000)
    assert kept.size <= 6000
    for values in (height, force):
        again = np.interp(time, time[kept], values[kept])
        assert np.abs(again - values).max() < 5e-3 * np.ptp(values)


@given(arrays(float, st.tuples(st.just(2), st.integers(1, 3000)), elements=st.floats(-1e3, 1e3)))
def test_thinning_keeps_ends_and_extremes(columns):
    kept = thin(np.arange(columns.shape[1]) // 2, list(columns), 100)
    assert kept.size <= 100
    assert (kept[0], kept[-1]) == (0, columns.shape[1] - 1)
    assert np.all(np.diff(kept) > 0)
    for values in columns:
        assert values[kept].max() == values.max()
        assert values[kept].min() == values.min()
