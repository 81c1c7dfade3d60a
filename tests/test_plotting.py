"""Figures: what their axes, legends and lines say, drawn with all floating-point errors raised."""

import io
import json

import matplotlib
import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from softafm.draw.results import plot


@pytest.fixture(autouse=True)
def _strict_floating_point():
    with np.errstate(all="raise", under="ignore"):
        yield


def result(mode, time, tip_height, force, jump_time=()):
    """A dataset of the agreed form with a given history and made-up observables."""
    units = {"tip_height": "m", "force": "N", "jump_time": "s", "jump_energy": "J"}
    scalars = {
        "force_max": force.max(),
        "force_min": force.min(),
        "force_min_approach": force.min(),
        "loop_energy": 8.71e-17,
        "virial": -3.48e-17,
        "dissipation": 8.71e-17,
        "contact_time": 5e-7,
        "indentation": 3e-9,
    }
    data = {"tip_height": ("time", tip_height), "force": ("time", force)}
    data["jump_time"] = ("jump", np.array(jump_time, float))
    data["jump_energy"] = ("jump", np.full(len(jump_time), 3e-22))
    dataset = xr.Dataset({**data, **scalars}, coords={"time": time}, attrs={"mode": mode})
    for name in dataset.variables:
        dataset[name].attrs = {"units": units.get(name, ""), "long_name": name.replace("_", " ")}
    return dataset


def triangle(speed=5e-6, strength=1e-6, jump_time=()):
    time = np.linspace(0, 40e-9 / speed, 201)
    height = -10e-9 + speed * np.abs(time - time[100])
    force = strength * (np.exp(-height / 5e-9) - np.where(time > time[100], 1.5, 0))
    return result("force-distance", time, height, force, jump_time)


def spectroscopy(stiffness=4.0, jump_time=()):
    """A lever on a made-up repulsion; where it is softer than that, its tip rises on approach."""
    time = triangle().time.values
    base = triangle().tip_height.values
    force = 5e-9 * np.tanh(base / -2e-9)
    deflection = force / stiffness
    run = result("force-spectroscopy", time, base + deflection, force, jump_time)
    return run.assign(base_height=("time", base), deflection=("time", deflection))


def tap(cycles=1, strength=4e-9, jump_time=()):
    time = np.linspace(0, cycles * 3.6e-6, 400 * cycles + 1)
    height = 46e-9 + 49.6e-9 * np.cos(2 * np.pi * time / 3.6e-6)
    force = strength * (np.exp(-height / 2e-9) - 2 * np.exp(-height / 4e-9))
    return result("tapping-cycle", time, height, force, jump_time)


def sweep(free=15e-9, jump=True):
    """An approach curve that jumps between two straight branches at 9 nm down and at 11 nm up."""
    height, ratio = np.linspace(14e-9, 4e-9, 101), np.linspace(0.9, 0.3, 7)
    data = {}
    for direction, edge in (("approach", 9e-9), ("retract", 11e-9)):
        repulsive = height < (edge if jump else np.inf)
        data[f"{direction}_amplitude"] = height * free / 15e-9 + np.where(repulsive, 5e-10, 0)
        data[f"{direction}_phase"] = np.where(repulsive, 50, 120) + 1e9 * height
        data[f"{direction}_dissipation"] = np.where(repulsive, 4e-18, 1e-18)
        data[f"{direction}_virial"] = np.where(repulsive, -2e-18, 1e-18)
    data = {name: ("sweep_height", values) for name, values in data.items()}
    far, near = np.where(ratio > 0.5, ratio, np.nan), np.where(ratio < 0.85, ratio, np.nan)
    both = np.array([far, far + near - ratio, near])
    for name, value in (("mean_height", 1.4e-8), ("phase", 100), ("dissipation", 2e-18)):
        data[name] = (("branch", "amplitude_ratio"), value * both)
    data["virial"] = (("branch", "amplitude_ratio"), 1e-18 * both)
    coords = {
        "sweep_height": height,
        "amplitude_ratio": ratio,
        "branch": ["attractive", "unstable", "repulsive"],
    }
    experiment = json.dumps({"motion": {"free_amplitude": free}})
    return xr.Dataset(data, coords, {"mode": "approach-curve", "experiment": experiment})


def legend_texts(legend):
    return [text.get_text() for text in legend.get_texts()]


def settings():
    return {name: value for name, value in matplotlib.rcParams.items() if name != "backend"}


def curves(ax):
    """Lines of data: not the zero lines, which have two points, nor jump markers."""
    return [
        line for line in ax.lines if line.get_linestyle() != "None" and len(line.get_xdata()) > 2
    ]


def test_force_distance_axes_name_quantity_and_unit():
    (ax,) = plot(triangle()).axes
    assert ax.get_xlabel() == "Tip height (nm)"
    assert ax.get_ylabel() == "Force on the tip (µN)"


@pytest.mark.parametrize(
    ("strength", "unit"), [(1e-12, "pN"), (1e-9, "nN"), (1e-6, "µN"), (1e-3, "mN")]
)
def test_the_unit_of_force_suits_the_data(strength, unit):
    dataset = triangle(strength=strength)
    (ax,) = plot(dataset).axes
    assert ax.get_ylabel() == f"Force on the tip ({unit})"
    drawn = np.concatenate([line.get_ydata() for line in curves(ax)])
    assert drawn.max() == pytest.approx(float(dataset.force_max) / strength)


def test_approach_and_retract_are_told_apart_by_style_and_colour():
    (ax,) = plot(triangle()).axes
    approach, retract = curves(ax)
    assert legend_texts(ax.get_legend()) == ["approach", "retract"]
    assert approach.get_linestyle() == "-"
    assert retract.get_linestyle() == "--"
    assert approach.get_color() != retract.get_color()
    assert np.all(np.diff(approach.get_xdata()) < 0)
    assert np.all(np.diff(retract.get_xdata()) > 0)


def test_three_speeds_overlaid_have_a_colour_each():
    speeds = [5e-6, 2e-6, 1e-6]
    (ax,) = plot([triangle(speed) for speed in speeds], ["5 µm/s", "2 µm/s", "1 µm/s"]).axes
    texts = legend_texts(ax.get_legend())
    assert texts == ["5 µm/s", "2 µm/s", "1 µm/s", "approach", "retract"]
    colours = [to_hex(line.get_color()) for line in curves(ax)]
    assert len(colours) == 6
    assert len(set(colours)) == 3
    assert colours[::2] == colours[1::2]


def test_unnamed_runs_are_numbered():
    (ax,) = plot([triangle(), triangle(2e-6)]).axes
    assert legend_texts(ax.get_legend())[:2] == ["run 1", "run 2"]


def test_elastic_jumps_are_marked_on_the_curve():
    dataset = triangle(jump_time=[6.0e-3])
    (ax,) = plot(dataset).axes
    (marker,) = [line for line in ax.lines if line.get_marker() == "o"]
    at_jump = dataset.interp(time=6.0e-3)
    assert marker.get_xdata() == pytest.approx([float(at_jump.tip_height) * 1e9])
    assert marker.get_ydata() == pytest.approx([float(at_jump.force) * 1e6])
    assert "elastic jump" in legend_texts(ax.get_legend())


def test_spectroscopy_is_drawn_as_deflection_and_force_against_base_and_tip():
    dataset = spectroscopy(jump_time=[6.0e-3])
    figure = plot(dataset)
    axes = figure.axes
    assert [ax.get_xlabel() for ax in axes] == [
        "Time (ms)",
        "Base height (nm)",
        "Tip height (nm)",
    ]
    assert [ax.get_ylabel() for ax in axes] == ["Deflection (nm)", "Force on the tip (nN)", ""]
    drawn = ("time", "deflection"), ("base_height", "force"), ("tip_height", "force")
    at_jump = dataset.interp(time=6.0e-3)
    for ax, names in zip(axes, drawn, strict=True):
        scales = [1e3 if name == "time" else 1e9 for name in names]
        for get, name, scale in zip(("get_xdata", "get_ydata"), names, scales, strict=True):
            parts = [getattr(line, get)() for line in curves(ax)]
            whole = np.concatenate([parts[0][:-1], parts[1]])
            assert whole == pytest.approx(scale * dataset[name].values)
            (marker,) = [line for line in ax.lines if line.get_marker() == "o"]
            assert getattr(marker, get)() == pytest.approx([scale * float(at_jump[name])])
    assert legend_texts(figure.legends[0]) == ["approach", "retract", "elastic jump"]
    assert axes[1].get_xlim() == axes[2].get_xlim()
    assert axes[1].get_ylim() == axes[2].get_ylim()


def test_strokes_of_spectroscopy_are_those_of_the_base():
    soft = spectroscopy(stiffness=1.0)
    assert np.any(np.diff(soft.tip_height[:100]) > 0)
    for ax in plot(soft).axes:
        assert [line.get_linestyle() for line in curves(ax)] == ["-", "--"]


def test_levers_overlaid_have_a_colour_each():
    figure = plot([spectroscopy(1.0), spectroscopy(4.0)], ["soft", "stiff"])
    assert legend_texts(figure.legends[0]) == ["soft", "stiff", "approach", "retract"]
    for ax in figure.axes:
        colours = [to_hex(line.get_color()) for line in curves(ax)]
        assert (len(colours), len(set(colours))) == (4, 2)


def test_tapping_cycle_is_drawn_against_time_and_height_where_the_force_acts():
    dataset = tap()
    against_time, against_height = plot(dataset).axes
    assert against_time.get_xlabel() == "Time (µs)"
    assert against_time.get_ylabel() == "Force on the tip (nN)"
    assert against_height.get_xlabel() == "Tip height (nm)"
    felt = dataset.time.values[np.abs(dataset.force) >= 0.01 * np.abs(dataset.force).max()] * 1e6
    low, high = against_time.get_xlim()
    assert low < felt.min()
    assert felt.max() < high
    assert high - low < 0.5 * 3.6
    assert "3.6 µs" in against_time.get_title()


def test_tapping_cycle_states_virial_dissipation_and_peak_force():
    dataset = tap()
    dataset["force_max"] = 11.45e-9
    title = plot(dataset).axes[1].get_title()
    assert title == "virial −34.8 aJ, dissipation 87.1 aJ, peak force 11.45 nN"


def test_overlaid_taps_state_their_observables_in_the_legend():
    figure = plot([tap(), tap(strength=2e-9)], ["hard", "soft"])
    (legend,) = figure.legends
    assert [text.split(":")[0] for text in legend_texts(legend)] == ["hard", "soft"]
    assert all("virial" in text for text in legend_texts(legend))


def test_every_cycle_has_its_approach_and_retract():
    against_time, _ = plot(tap(cycles=3)).axes
    assert [line.get_linestyle() for line in curves(against_time)] == ["-", "--"] * 3


def test_noise_of_a_measured_trajectory_makes_no_strokes():
    dataset = triangle()
    rng = np.random.default_rng(1)
    noise = 0.05e-9 * rng.standard_normal(dataset.sizes["time"])
    dataset["tip_height"] = dataset.tip_height + noise
    (ax,) = plot(dataset).axes
    assert [line.get_linestyle() for line in curves(ax)] == ["-", "--"]


def test_a_run_without_any_force_is_drawn():
    figure = plot(tap(strength=0.0))
    assert figure.axes[0].get_ylabel() == "Force on the tip (N)"
    figure.savefig(io.BytesIO(), format="png")


def arrows(ax):
    """Tail and head of each arrow."""
    return [(note.xyann, note.xy) for note in ax.texts if note.arrow_patch is not None]


def test_approach_curve_has_the_papers_panels_and_the_depth_of_the_tip():
    figure = plot(sweep())
    assert [ax.get_xlabel() for ax in figure.axes] == [
        *["Amplitude ratio A/A₀"] * 3,
        "Mean height of the tip, Z (nm)",
    ]
    assert [ax.get_ylabel() for ax in figure.axes] == [
        "Phase lag (°)",
        "Dissipation in a cycle (aJ)",
        "Virial (aJ)",
        "Lowest height of the tip, Z − A (pm)",
    ]
    assert legend_texts(figure.legends[0]) == [
        *("approach", "retract", "stable solution", "unstable solution")
    ]
    phase = figure.axes[0]
    assert 90 in [line.get_ydata()[0] for line in phase.lines if len(line.get_xdata()) == 2]
    assert {"attractive", "repulsive"} <= {note.get_text() for note in phase.texts}


def test_sweeps_are_broken_where_they_jump_and_arrows_show_the_way():
    dataset = sweep()
    phase, _, _, depth = plot(dataset).axes
    down, up = [line for line in phase.lines if line.get_linestyle() in ("-", "--")][:2]
    for line, direction in ((down, "approach"), (up, "retract")):
        assert np.isnan(line.get_ydata()).sum() == 1
        drawn = line.get_xdata()[~np.isnan(line.get_xdata())]
        assert drawn == pytest.approx(dataset[f"{direction}_amplitude"].values / 15e-9)
    assert (down.get_linestyle(), up.get_linestyle()) == ("-", "--")
    (first, second) = arrows(phase)
    assert (first[0][1], first[1][1]) == pytest.approx((129, 58.9))
    assert (second[0][1], second[1][1]) == pytest.approx((60.9, 131))
    (first, second) = arrows(depth)
    assert (first[0], first[1]) == (pytest.approx((9.0, 0)), pytest.approx((8.9, -500)))
    assert (second[0], second[1]) == (pytest.approx((10.9, -500)), pytest.approx((11.0, 0)))


def test_solutions_are_dots_hollow_where_unstable():
    dataset = sweep()
    for ax in plot(dataset).axes[:3]:
        stable, unstable = [line for line in ax.lines if line.get_marker() == "o"]
        assert to_hex(unstable.get_markerfacecolor()) == "#ffffff"
        assert to_hex(stable.get_markerfacecolor()) != "#ffffff"
        assert np.isfinite(stable.get_ydata()).sum() == 4 + 6
        assert np.isfinite(unstable.get_ydata()).sum() == 3


def test_a_sweep_without_jumps_has_no_arrows():
    assert not any(arrows(ax) for ax in plot(sweep(jump=False)).axes)


def test_drives_overlaid_have_a_colour_each():
    figure = plot([sweep(), sweep(20e-9)], ["weak", "strong"])
    assert legend_texts(figure.legends[0])[:4] == ["weak", "strong", "approach", "retract"]
    for ax in figure.axes:
        lines = [line for line in ax.lines if len(line.get_xdata()) > 2]
        assert len({to_hex(line.get_color()) for line in lines}) == 2


def test_an_approach_curve_without_any_height_is_refused():
    with pytest.raises(ValueError, match="nothing to draw"):
        plot(sweep().isel(sweep_height=slice(0, 0)))


@pytest.mark.parametrize(
    "datasets",
    [
        [sweep()],
        [triangle(jump_time=[6e-3])] * 3,
        [tap(2, jump_time=[2e-6])],
        [spectroscopy(jump_time=[6e-3])] * 2,
    ],
)
@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_figures_are_saved_without_pyplot_or_change_of_settings(datasets, suffix):
    before = settings()
    figure = plot(datasets)
    assert isinstance(figure, Figure)
    picture = io.BytesIO()
    figure.savefig(picture, format=suffix)
    assert picture.tell() > 1000
    assert settings() == before


def test_nothing_to_draw_is_refused():
    with pytest.raises(ValueError, match="at least one"):
        plot([])


def test_a_wrong_number_of_labels_is_refused():
    with pytest.raises(ValueError, match="labels has 1 entries: must have one a dataset, 2"):
        plot([triangle(), triangle()], ["only one"])


@pytest.mark.parametrize(
    "datasets", [[triangle(), tap()], triangle().assign_attrs(mode="seismometer"), xr.Dataset()]
)
def test_modes_that_differ_or_have_no_figure_are_refused(datasets):
    with pytest.raises(ValueError, match=r"must be the same for all, one of force-distance, "):
        plot(datasets)
