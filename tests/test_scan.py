"""Maps: what is where, how it is imaged, and that nothing depends on the number of workers."""

import json
import subprocess
import sys
import warnings
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

import softafm as sa
from softafm.solvers import Energy

TIP = sa.Paraboloid(10e-9)
PS = sa.Contact(TIP, sa.samples.polystyrene(), sa.LennardJones(2e-20, 0.15e-9))
LDPE = sa.Contact(TIP, sa.samples.ldpe(), sa.LennardJones(1e-19, 0.25e-9))
LEVER = sa.Cantilever(stiffness=28.1, quality_factor=429.5, frequency=278e3)
TAPPING = sa.AmplitudeModulation(LEVER, free_amplitude=20e-9, setpoint=0.9)
RAMP = sa.Triangle(start=5e-9, turn=-1e-9, speed=1e-4)
SHARE = np.clip(np.linspace(-0.3, 1.3, 9)[None, :] + np.array([[0.0], [0.07], [-0.05]]), 0, 1)
BLEND = sa.SampleMap.mixed(SHARE, PS, LDPE, size=90e-9, height=1e-9 * SHARE)


def contact_at(sample, i, j):
    return sample.pixels.contacts[sample.pixels.number[i, j]]


@pytest.fixture(scope="module")
def tapped():
    return sa.scan(BLEND, TAPPING)


@pytest.fixture(scope="module")
def curves():
    return sa.scan(BLEND, sa.ForceVolume(RAMP))


def test_pixels_are_those_of_approach_curves(tapped):
    for i, j in np.ndindex(SHARE.shape):
        if (i + j) % 3:
            continue
        curve = sa.approach_curve(contact_at(BLEND, i, j), LEVER, 20e-9, [0.9])
        pixel = tapped.isel(y=i, x=j)
        branch = int(np.nanargmin(np.abs(curve["mean_height"] - pixel["mean_height"]).values))
        assert curve["branch"][branch] in ("attractive", "repulsive")
        found = curve.isel(branch=branch, amplitude_ratio=0)
        assert float(pixel["mean_height"]) == pytest.approx(float(found["mean_height"]), abs=5e-12)
        assert float(pixel["phase"]) == pytest.approx(float(found["phase"]), abs=0.3)
        for name in ("dissipation", "virial"):
            assert float(pixel[name]) == pytest.approx(float(found[name]), rel=1e-2, abs=2e-20)
        for name in ("force_max", "force_min"):
            assert float(pixel[name]) == pytest.approx(float(found[name]), rel=1e-2, abs=2e-11)


def test_phase_and_branch_tell_the_materials_apart(tapped):
    ends = tapped.isel(x=[0, -1])
    np.testing.assert_array_equal(ends["branch"].values, [[1, 0]] * 3)
    assert (ends["phase"].values[:, 0] < 80).all()
    assert (ends["phase"].values[:, 1] > 100).all()


def test_topography_is_mean_height_and_surface(tapped):
    np.testing.assert_array_equal(tapped["sample_height"], 1e-9 * SHARE)
    np.testing.assert_array_equal(
        tapped["topography"], tapped["mean_height"] + tapped["sample_height"]
    )


def test_pixels_are_force_curves_exactly(curves):
    for i, j in ((0, 0), (1, 4), (2, 8)):
        curve = sa.force_distance(contact_at(BLEND, i, j), RAMP)
        pixel = curves.isel(y=i, x=j)
        for name in ("force_max", "force_min", "force_min_approach", "loop_energy"):
            assert float(pixel[name]) == float(curve[name])
        assert float(pixel["indentation"]) == -float(curve["axis_deformation"].min())
    assert (curves["lowest_height"] == RAMP.turn).all()


def test_a_trigger_force_traces_the_height():
    labels = sa.SampleMap([PS, LDPE], 20e-9, labels=[[0, 1, 0]], height=[[0.0, 0.0, 2e-9]])
    ramp = sa.Triangle(start=5e-9, turn=-50e-9, speed=1e-4, setpoint_force=2e-9)
    lever = sa.Cantilever(2.0)
    image = sa.scan(labels, sa.ForceVolume(ramp, lever))
    np.testing.assert_allclose(image["force_max"], 2e-9, rtol=1e-3)
    first, soft, high = image["topography"].values[0]
    assert high - first == pytest.approx(2e-9, rel=1e-12)
    assert soft < first - 0.5e-9  # it is pressed in
    alone = sa.force_spectroscopy(PS, lever, ramp)
    assert float(image["force_min"][0, 0]) == float(alone["force_min"])
    assert first == float(alone["base_height"].min())
    assert image.attrs["solver_curves"] == 2  # pixels alike are computed once


@pytest.mark.parametrize("imaging", [TAPPING, sa.ForceVolume(RAMP)])
def test_workers_change_no_bit(imaging):
    rows = np.sin(np.arange(10.0))[:, None] ** 2 * np.linspace(0, 1, 5)
    sample = sa.SampleMap.mixed(rows, PS, LDPE, 1e-6)
    one, several = (sa.scan(sample, imaging, workers=workers) for workers in (1, 2))
    assert set(several.data_vars) == set(one.data_vars)
    for name in one.data_vars:
        np.testing.assert_array_equal(several[name], one[name])


def test_the_branch_is_kept_where_two_exist():
    # Fig. 9 of Rajabifar et al. 2021: both exist from 0.71 to 0.93; which one is taken is history.
    contact = replace(PS, tip=sa.Paraboloid(50e-9))
    sample = sa.SampleMap(contact, 30e-9, {"sample.E_inf": 1.89e9 * np.array([[1, 1.02, 1.05]])})
    for engaged, branch in (("approach", 0), ("attractive", 0), ("repulsive", 1)):
        imaging = sa.AmplitudeModulation(LEVER, 15e-9, 0.8, engaged=engaged)
        image = sa.scan(sample, imaging)
        assert (image["branch"] == branch).all()


def test_pixels_alike_cost_no_more():
    labels = np.zeros((6, 40), int)
    labels[:, 20:] = 1
    image = sa.scan(sa.SampleMap([PS, LDPE], 1e-6, labels=labels), TAPPING)
    few = sa.scan(sa.SampleMap([PS, LDPE], 1e-6, labels=labels[:, 18:22]), TAPPING)
    assert image.attrs["solver_taps"] == few.attrs["solver_taps"]
    assert image.attrs["different_pixels"] == 2
    assert np.ptp(image["phase"].values[:, :20]) == 0


def test_the_result_tells_what_it_is(tapped, tmp_path):
    assert tapped["phase"].dims == ("y", "x")
    np.testing.assert_allclose(tapped["x"], 10e-9 * (np.arange(9) + 0.5))
    np.testing.assert_allclose(tapped["y"], 10e-9 * (np.arange(3) + 0.5))
    assert all({"units", "long_name"} <= set(each.attrs) for each in tapped.variables.values())
    assert tapped["sample.E_inf"].attrs["units"] == "Pa"
    np.testing.assert_array_equal(tapped["sample.E_inf"], BLEND.fields["sample.E_inf"])
    experiment = json.loads(tapped.attrs["experiment"])
    assert experiment["imaging"]["setpoint"] == 0.9
    assert experiment["imaging"]["cantilever"]["quality_factor"] == 429.5
    assert "tabor_relaxed" not in tapped.attrs  # there is not one of them
    sa.save(tapped, tmp_path / "map.nc")
    loaded = sa.load(tmp_path / "map.nc")
    np.testing.assert_array_equal(loaded["dissipation"], tapped["dissipation"])
    with pytest.raises(ValueError, match="maps have no CSV"):
        sa.export(tapped, tmp_path / "map.csv")


def test_importing_the_package_imports_no_maps():
    code = "import softafm, sys; print([m for m in sys.modules if 'campaigns' in m or 'gwy' in m])"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "[]"


def test_progress_is_told():
    told = []
    sa.scan(BLEND, sa.ForceVolume(RAMP), progress=lambda *each: told.append(each))
    assert told[-1][0] == 1.0
    assert [fraction for fraction, _ in told] == sorted(fraction for fraction, _ in told)


class Failing(Energy):
    """Gives up on soft samples."""

    def solve(self, contact, motion, **options):
        if contact.sample.E_inf < 0.5e9:
            raise sa.DivergedError("stopped at t = 0 s")
        return super().solve(contact, motion, **options)


@pytest.mark.parametrize("imaging", [TAPPING, sa.ForceVolume(RAMP)])
def test_a_pixel_without_a_result_is_nan_and_says_why(imaging):
    labels = sa.SampleMap([PS, LDPE], 20e-9, labels=[[0, 0], [0, 1]])
    with pytest.warns(sa.AccuracyWarning, match=r"1 of 4 pixels .* \(1, 1\): stopped at t = 0 s"):
        image = sa.scan(labels, imaging, solver=Failing())
    assert json.loads(image.attrs["failures"]) == [[1, 1, "stopped at t = 0 s"]]
    np.testing.assert_array_equal(np.isnan(image["force_max"]), [[False, False], [False, True]])


def test_warnings_of_solvers_are_told_once():
    rough = Energy(finest_spacing=0.3)
    sharp = sa.Contact(
        sa.Paraboloid(1e-6), sa.Elastic(1e8, 0.5), sa.LennardJones.from_work_of_adhesion(0.05, 1e-9)
    )
    ramp = sa.ForceVolume(sa.Triangle(1e-6, -0.1e-6, 1e-6))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        image = sa.scan(sa.SampleMap(sharp, 1e-6, height=np.zeros((2, 2))), ramp, solver=rough)
    assert len(caught) == len({str(each.message) for each in caught}) >= 1
    assert "finest_spacing" in image.attrs["warnings"]


def test_regularised_pixels_are_regularised_contacts():
    soft = replace(LDPE, sample=sa.Elastic(5e6, 0.5))
    sample = sa.SampleMap(soft, 1e-6, height=np.zeros((1, 2)))
    motion = sa.Triangle(100e-9, -5e-9, 1e-5)
    image = sa.scan(sample, sa.ForceVolume(motion), regularise=3)
    alone = sa.force_distance(soft, motion, regularise=3)
    assert float(image["force_min"][0, 0]) == float(alone["force_min"])
    assert image.attrs["regularised_tabor"] == 3


def test_pixels_too_soft_for_their_law_are_regularised_and_their_error_told():
    law = sa.LennardJones.from_work_of_adhesion(0.05, 0.3e-9)
    gel = sa.Contact(sa.Paraboloid(5e-6), sa.Elastic(2e4, 0.5), law)
    stiffer = np.array([[2e4, 2e6]])
    sample = sa.SampleMap(gel, 1e-6, fields={"sample.E": stiffer})
    motion = sa.Triangle(6e-6, -1e-6, 1e-6)
    with pytest.warns(
        sa.AccuracyWarning, match=r"^1 of 2 .* pixel \(0, 0\): regularised by itself"
    ):
        image = sa.scan(sample, sa.ForceVolume(motion))
    with pytest.warns(sa.AccuracyWarning, match=r"^regularised by itself") as told:
        alone = sa.force_distance(gel, motion)
    stiff = sa.force_distance(replace(gel, sample=sa.Elastic(2e6, 0.5)), motion)
    found = [float(each["force_min"]) for each in (alone, stiff)]
    assert image["force_min"].values[0].tolist() == found
    assert image.attrs["regularised_tabor"] == 500
    assert image.attrs["warnings"].endswith(str(told[0].message))


def test_a_map_of_real_laws_says_that_they_are_too_short():
    law = sa.LennardJones.from_work_of_adhesion(0.05, 0.3e-9)
    gel = sa.Contact(sa.Paraboloid(5e-6), sa.Elastic(2e5, 0.5), law)
    sample = sa.SampleMap(gel, 1e-6, height=np.zeros((1, 1)))
    motion = sa.Triangle(3e-6, 2.5e-6, 1e-6)  # never near
    with pytest.warns(sa.AccuracyWarning, match="is taken as it is at a Tabor number of 1.87e"):
        image = sa.scan(sample, sa.ForceVolume(motion), regularise=None)
    assert "regularised_tabor" not in image.attrs


# What is where


def test_a_blend_goes_geometrically_from_one_to_the_other():
    blend = sa.SampleMap.mixed([[0.0, 0.5, 1.0]], PS, LDPE, 1e-6)
    first, middle, last = (contact_at(blend, 0, j) for j in range(3))
    assert (first.sample.E_inf, last.sample.E_inf) == (1.89e9, 0.1e9)
    assert middle.surface.hamaker == pytest.approx(np.sqrt(2e-20 * 1e-19))
    assert blend.size == pytest.approx((1e-6, 1e-6 / 3))
    assert "sample.creep_time" not in blend.fields  # both have the same


def test_work_of_adhesion_may_vary():
    sample = sa.SampleMap(PS, 1e-6, {"surface.work_of_adhesion": [[0.01, 0.03]]})
    for j, work in enumerate((0.01, 0.03)):
        law = contact_at(sample, 0, j).surface
        assert law.work_of_adhesion == pytest.approx(work)
        assert law.z0 == PS.surface.z0


@pytest.mark.parametrize(("mode", "scale"), [("uint8", 255), ("uint16", 65535)])
def test_grey_values_are_mapped_linearly(tmp_path, mode, scale):
    path = tmp_path / "map.png"
    grey = np.array([[0, scale // 2, scale]], mode)
    Image.fromarray(grey).save(path)
    ranges = {"sample.E_inf": (0.1e9, 1.9e9), "height": (0.0, 5e-9)}
    sample = sa.SampleMap.from_image(path, PS, 3e-7, ranges)
    np.testing.assert_allclose(
        sample.fields["sample.E_inf"], 0.1e9 + 1.8e9 * grey.astype(float) / scale
    )
    np.testing.assert_allclose(sample.height, 5e-9 * grey.astype(float) / scale)


def test_greys_are_labels(tmp_path):
    path = tmp_path / "labels.png"
    Image.fromarray(np.array([[9, 200], [200, 9]], "uint8")).save(path)
    sample = sa.SampleMap.from_labelled_image(path, [PS, LDPE], 1e-6)
    np.testing.assert_array_equal(sample.labels, [[0, 1], [1, 0]])
    assert contact_at(sample, 0, 1) == LDPE
    with pytest.raises(ValueError, match=r"image: has 2 greys, but there are 1 materials"):
        sa.SampleMap.from_labelled_image(path, [PS], 1e-6)


OK = np.ones((2, 3))
BAD = np.array([[1.0, 1, 1], [1, 1, np.nan]])
E0 = 4e9 * OK


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: sa.SampleMap(PS, 1e-6), r"fields = {}: must hold an array"),
        (lambda: sa.SampleMap([PS, LDPE], 1e-6), "labels: missing"),
        (lambda: sa.SampleMap([], 1e-6, height=OK), "materials = .*must be a softafm.Contact"),
        (
            lambda: sa.SampleMap([PS, replace(LDPE, tip=sa.Paraboloid(2e-8))], 1e-6, labels=0 * OK),
            "materials: must all have the same tip",
        ),
        (
            lambda: sa.SampleMap(PS, 1e-6, {"sample.E0": E0}, height=OK[:1]),
            r"height has shape \(1, 3\): must have that of sample.E0, \(2, 3\)",
        ),
        (lambda: sa.SampleMap(PS, 1e-6, height=BAD), r"height\[1, 2\] = nan: must be a finite"),
        (lambda: sa.SampleMap(PS, 1e-6, height=[1.0]), r"height has shape \(1,\)"),
        (lambda: sa.SampleMap(PS, 1e-6, height="high"), "height: must be an array of numbers"),
        (lambda: sa.SampleMap(PS, -1.0, height=OK), "size = -1 m: must be greater than 0"),
        (lambda: sa.SampleMap(PS, (1, 1, 1), height=OK), r"size = \(1, 1, 1\): must be a length"),
        (lambda: sa.SampleMap(PS, 1e-6, {"tip.radius": OK}), "field 'tip.radius': must be sample."),
        (
            lambda: sa.SampleMap(PS, 1e-6, {"sample.E": OK}),
            "field 'sample.E': the sample .* those that may vary: sample.E0, sample.E_inf",
        ),
        (
            lambda: sa.SampleMap([PS, LDPE], 1e-6, labels=2 * OK),
            r"labels\[0, 0\] = 2: must be a whole number from 0 to 1",
        ),
        (
            lambda: sa.SampleMap(PS, 1e-6, {"sample.E0": E0 * [1, -1, 1]}).pixels,
            r"pixel \(0, 1\): sample.E0 = -4e\+09 Pa: must be greater than 0",
        ),
        (lambda: sa.SampleMap.mixed(2 * OK, PS, LDPE, 1e-6), r"share\[0, 0\] = 2: must be from 0"),
        (lambda: sa.SampleMap.mixed(OK, PS, PS, 1e-6), "one, other: are the same"),
        (
            lambda: sa.SampleMap.mixed(OK, PS, replace(PS, sample=sa.Elastic(1e9, 0.3)), 1e-6),
            "sample: 'standard-linear-solid' and 'elastic' do not mix",
        ),
        (
            lambda: sa.SampleMap.from_image("none.png", PS, 1e-6, {"height": (0, 1)}),
            "none.png: No such file",
        ),
        (
            lambda: sa.SampleMap.from_image(OK, PS, 1e-6, {"height": 3}),
            r"ranges\['height'\] = 3: must be two numbers",
        ),
        (lambda: sa.SampleMap.from_image(3 * OK, PS, 1e-6, {}), r"image\[0, 0\] = 3: must be from"),
        (lambda: sa.scan(PS, TAPPING), "sample = Contact.*must be a softafm.SampleMap"),
        (lambda: sa.scan(BLEND, LEVER), "imaging = .*must be an AmplitudeModulation"),
        (lambda: sa.scan(BLEND, TAPPING, workers=0), "workers = 0: must be a whole number"),
        (lambda: sa.scan(BLEND, TAPPING, tolerance=1), "tolerance = 1"),
        (lambda: sa.ForceVolume(LEVER), "motion = .*must be a Triangle"),
        (
            lambda: sa.scan(BLEND, sa.ForceVolume(sa.Triangle(0.2e-9, -1e-9, 1e-6))),
            r"pixel \(0, \d\): start height = 2e-10 m: must be above the equilibrium gap",
        ),
        (
            lambda: sa.scan(
                sa.SampleMap(replace(PS, sample=sa.Maxwell(1e9, 1e3, 0.4)), 1e-6, height=OK),
                TAPPING,
            ),
            r"pixel \(0, 0\): no height goes with an amplitude: the sample 'maxwell' flows",
        ),
    ],
)
def test_bad_input_is_refused_in_one_line(make, told):
    with pytest.raises(ValueError, match=told) as refusal:
        make()
    assert "\n" not in str(refusal.value)


# Drawing


def test_maps_are_drawn_with_physical_axes_and_prefixes(tapped):
    figure = sa.plot_map([tapped, tapped], labels=["one", "two"])
    images = [ax for ax in figure.axes if ax.images]
    assert len(images) == 6
    assert images[0].get_title() == "Height (nm)"
    assert images[1].get_title() == "Phase lag (°)"
    assert images[2].get_title() == "Dissipation in a cycle (aJ)"
    assert images[0].get_xlabel() == "x (nm)"
    assert images[0].images[0].get_extent() == pytest.approx([0, 90, 30, 0])
    shown = images[0].images[0].get_array()
    topography = 1e9 * tapped["topography"].values
    np.testing.assert_allclose(shown, topography - topography.min())
    np.testing.assert_allclose(images[1].images[0].get_array(), tapped["phase"])
    assert images[0].images[0].get_cmap().name == "afmhot"
    figure.canvas.draw()


def test_what_is_drawn_can_be_chosen(curves):
    figure = sa.plot_map(curves, ["force_min", "sample.E_inf"])
    titles = [ax.get_title() for ax in figure.axes if ax.images]
    assert titles == ["Smallest force (nN)", "sample.E_inf of the sample map (GPa)"]


@pytest.mark.parametrize(
    ("names", "labels", "told"),
    [
        (["height"], None, "names: 'height' is no map; those of the dataset"),
        ([], None, r"names = \[\]: must hold at least one"),
        (None, ["a", "b"], "labels has 2 entries"),
    ],
)
def test_bad_figures_are_refused(tapped, names, labels, told):
    with pytest.raises(ValueError, match=told):
        sa.plot_map(tapped, names, labels)
    with pytest.raises(ValueError, match="datasets is empty"):
        sa.plot_map([])
