"""Files of Gwyddion, read back by gwyfile."""

import gwyfile
import numpy as np
import pytest

import softafm as sa

CONTACT = sa.Contact(
    sa.Paraboloid(10e-9), sa.samples.polystyrene(), sa.LennardJones(2e-20, 0.15e-9)
)
SAMPLE = sa.SampleMap(
    CONTACT, (40e-9, 20e-9), {"sample.E0": 4e9 + 1e8 * np.arange(8.0).reshape(2, 4)}
)


@pytest.fixture(scope="module")
def image():
    return sa.scan(SAMPLE, sa.ForceVolume(sa.Triangle(5e-9, -0.5e-9, 1e-4)))


def test_channels_are_the_maps(image, tmp_path):
    path = tmp_path / "map.gwy"
    sa.export_gwyddion(image, path)
    channels = gwyfile.util.get_datafields(gwyfile.load(str(path)))
    assert set(channels) == set(image.data_vars)
    for name, channel in channels.items():
        np.testing.assert_array_equal(channel.data, image[name].values)
        assert (channel.xreal, channel.yreal) == pytest.approx((40e-9, 20e-9), rel=1e-12)
        assert channel.si_unit_xy.unitstr == "m"
    units = {name: channel.si_unit_z.unitstr for name, channel in channels.items()}
    assert units["topography"] == "m"
    assert units["force_min"] == "N"
    assert units["loop_energy"] == "J"
    assert units["sample.E0"] == "Pa"


def test_the_first_channel_is_the_height_and_tells_where_it_comes_from(image, tmp_path):
    path = tmp_path / "map.gwy"
    sa.export_gwyddion(image, path)
    content = gwyfile.load(str(path))
    assert content["/0/data/title"] == "topography"
    assert content["/0/meta"]["experiment"] == image.attrs["experiment"]
    assert content["/0/meta"]["softafm_version"] == sa.__version__


def test_missing_pixels_are_masked(image, tmp_path):
    holed = image.copy(deep=True)
    holed["force_min"][1, 2] = np.nan
    path = tmp_path / "map.gwy"
    sa.export_gwyddion(holed, path)
    content = gwyfile.load(str(path))
    titles = {content[f"/{i}/data/title"]: i for i in range(len(image.data_vars))}
    number = titles["force_min"]
    mask = content[f"/{number}/mask"].data
    assert np.argwhere(mask).tolist() == [[1, 2]]
    assert np.isfinite(content[f"/{number}/data"].data).all()
    assert f"/{titles['force_max']}/mask" not in content


def test_phase_is_in_degrees(image, tmp_path):
    turned = image.assign(phase=(("y", "x"), np.ones((2, 4)), {"units": "degree"}))
    sa.export_gwyddion(turned, tmp_path / "map.gwy")
    channels = gwyfile.util.get_datafields(gwyfile.load(str(tmp_path / "map.gwy")))
    assert channels["phase"].si_unit_z.unitstr == "deg"


def test_what_exists_is_kept(image, tmp_path):
    path = tmp_path / "map.gwy"
    path.write_bytes(b"mine")
    with pytest.raises(FileExistsError, match="exists already"):
        sa.export_gwyddion(image, path)
    assert path.read_bytes() == b"mine"
    sa.export_gwyddion(image, path, overwrite=True)
    assert path.read_bytes().startswith(b"GWY")
    assert [each.name for each in tmp_path.iterdir()] == ["map.gwy"]


def test_bad_exports_are_refused(image, tmp_path):
    with pytest.raises(ValueError, match=r"suffix must be \.gwy"):
        sa.export_gwyddion(image, tmp_path / "map.png")
    with pytest.raises(ValueError, match="holds no maps"):
        sa.export_gwyddion(image.isel(x=0), tmp_path / "map.gwy")


def test_a_missing_package_is_named(image, tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "gwyfile.objects", None)
    with pytest.raises(ImportError, match=r"pip install 'softafm\[maps\]'"):
        sa.export_gwyddion(image, tmp_path / "map.gwy")
    assert not list(tmp_path.iterdir())
