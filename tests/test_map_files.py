"""Map files: what they mean, what the command line does with them, and how they are refused."""

import dataclasses
import re
import tomllib
from pathlib import Path

import gwyfile
import numpy as np
import pytest
from PIL import Image

import softafm as sa
from softafm.app.form import read_presets
from softafm.experiment import schema
from softafm.experiment.config import (
    ConfigError,
    list_examples,
    list_maps,
    load_experiment,
    read_example,
)
from softafm.maps.map_file import build_map, load_map
from softafm.maps.patterns import make_blend

SMALL = ("map.pixels=[8, 8]", "map.size=['100 nm', '50 nm']", "map.interphase=15 nm")
GREY = np.linspace(0, 255, 16).reshape(2, 8).astype(np.uint8)
RAMP = {"start": "5 nm", "turn": "-0.5 nm", "speed": "100 um/s"}
PS = {
    "sample": {"model": "polystyrene"},
    "surface": {"law": "lennard-jones", "hamaker": "2e-20 J", "z0": "0.15 nm"},
}
LDPE = {
    "sample": {"model": "ldpe"},
    "surface": {"law": "lennard-jones", "hamaker": "1e-19 J", "z0": "0.25 nm"},
}
STIFF = {"sample": {"model": "elastic", "E": "10 GPa", "poisson": 0.3}, "surface": PS["surface"]}
TIP = sa.Paraboloid(10e-9)


def volume(*materials, **table):
    """The document of a force volume."""
    tip = {"shape": "paraboloid", "radius": "10 nm"}
    table = {"size": ["80 nm", "20 nm"], "materials": list(materials), **table}
    return {"mode": "force-volume", "tip": tip, "motion": dict(RAMP), "map": table}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty current directory with the bundled map, an image and arrays in it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "blend.toml").write_text(read_example("blend"), encoding="utf-8")
    Image.fromarray(GREY).save("grey.png")
    Image.fromarray(np.where(GREY > 100, 200, 50).astype(np.uint8)).save("two.png")
    np.save("share.npy", GREY / 255)
    np.save("labels.npy", np.arange(16).reshape(2, 8) % 3)
    np.save("height.npy", 1e-9 * GREY)
    return tmp_path


@pytest.fixture
def softafm(softafm, monkeypatch):
    """The command line, on a terminal that is wide enough."""
    monkeypatch.setenv("COLUMNS", "200")
    return softafm


def small(*more):
    return [word for each in (*SMALL, *more) for word in ("--set", each)]


# What they mean


def test_the_bundled_blend_is_what_python_would_build():
    found = build_map(tomllib.loads(read_example("blend")), None)
    contacts = [
        sa.Contact(TIP, sa.samples.polystyrene(), sa.LennardJones(2e-20, 0.15e-9)),
        sa.Contact(TIP, sa.samples.ldpe(), sa.LennardJones(1e-19, 0.25e-9)),
    ]
    size = (600e-9, 600e-9)
    share = make_blend((128, 128), size, feature=45e-9, share=0.36, interphase=20e-9, seed=8)
    same = sa.SampleMap.mixed(share, *contacts, size)
    assert found.materials == ("polystyrene", "LDPE")
    assert found.sample.materials == same.materials
    assert found.sample.size == pytest.approx(size, rel=1e-15)
    assert found.sample.fields.keys() == same.fields.keys()
    for name, array in same.fields.items():
        np.testing.assert_allclose(found.sample.fields[name], array, rtol=1e-12)
    lever = sa.Cantilever(28.1, 429.5, 278e3)
    assert found.imaging == sa.AmplitudeModulation(lever, 20e-9, 0.9)


def test_a_run_is_the_scan(folder):
    found = load_map("blend.toml", [*SMALL, "run.tolerance=0.05"])
    assert found.sample.shape == (8, 8)
    assert found.sample.size == (100e-9, 50e-9)
    result, same = found.run(), sa.scan(found.sample, found.imaging, tolerance=0.05)
    np.testing.assert_array_equal(result["topography"], same["topography"])
    assert result.attrs["tolerance"] == 0.05


def test_labels_choose_among_any_materials(folder):
    document = volume({"name": "a b", **PS}, LDPE, STIFF, pattern="labels", file="labels.npy")
    found = build_map(document, folder)
    np.testing.assert_array_equal(found.sample.labels, np.arange(16).reshape(2, 8) % 3)
    assert [each.sample.kind for each in found.sample.materials][2] == "elastic"
    result = found.run()
    assert result["material"].attrs["flag_meanings"] == "a_b 1 2"
    document = volume(PS, STIFF, pattern="labels", file="two.png")
    np.testing.assert_array_equal(build_map(document, folder).sample.labels, GREY > 100)


def test_a_share_mixes_two_materials(folder):
    for file in ("grey.png", "share.npy"):
        document = volume(PS, LDPE, pattern="share", file=file)
        found = build_map(document, folder).sample.fields["sample.E_inf"]
        np.testing.assert_allclose(found, 1.89e9 ** (1 - GREY / 255) * 0.1e9 ** (GREY / 255))


def test_a_blend_without_interphase_is_of_any_two_materials():
    keys = {"pixels": [8, 4], "feature": "20 nm", "share": 0.5}
    found = build_map(volume(PS, STIFF, pattern="blend", **keys), None).sample
    assert found.shape == (4, 8)
    assert found.labels.mean() == 0.5


def test_fields_and_height_come_from_images_and_arrays(folder):
    ends = {"image": "grey.png", "from": "0.1 GPa", "to": "1 GPa"}
    table = {"fields": {"sample.E_inf": ends, "surface": {"z0": {"image": "height.npy"}}}}
    np.save("height.npy", 0.15e-9 + 1e-12 * GREY)
    table["height"] = {"image": "share.npy", "from": "5 nm", "to": "0 nm"}
    found = build_map(volume(PS, **table), folder).sample
    np.testing.assert_allclose(found.fields["sample.E_inf"], 0.1e9 + 0.9e9 * GREY / 255)
    np.testing.assert_array_equal(found.fields["surface.z0"], 0.15e-9 + 1e-12 * GREY)
    np.testing.assert_allclose(found.height, 5e-9 * (1 - GREY / 255), atol=1e-24)
    assert found.size == (80e-9, 20e-9)


def test_fields_go_over_those_of_a_blend(folder):
    table = {"pattern": "share", "file": "share.npy"}
    table["fields"] = {"sample.E0": {"image": "grey.png", "from": "3 GPa", "to": "4 GPa"}}
    fields = build_map(volume(PS, LDPE, **table), folder).sample.fields
    np.testing.assert_allclose(fields["sample.E0"], 3e9 + 1e9 * GREY / 255)
    assert np.ptp(fields["sample.E_inf"]) > 1e9


def test_every_number_of_samples_and_laws_has_a_unit():
    for table in ("sample", "surface"):
        for choice in schema.CHOICES[table][1].values():
            for make in getattr(choice, "constructors", ()):
                if dataclasses.is_dataclass(make):
                    numbers = {f.name for f in dataclasses.fields(make) if f.type in (float, int)}
                    assert numbers <= schema.KEYS.keys()


def test_the_documents_show_map_files(folder):
    page = (Path(__file__).parents[1] / "docs" / "maps.md").read_text(encoding="utf-8")
    whole, part = re.findall(r"```toml\n(.*?)```", page, re.S)
    found = build_map(tomllib.loads(whole), folder)
    assert isinstance(found.imaging, sa.ForceVolume)
    assert found.sample.shape == (64, 64)
    Image.fromarray(GREY).save("relief.png")
    document = volume(PS)
    document["map"] |= tomllib.loads(part)["map"]
    found = build_map(document, folder).sample
    assert (found.height.max(), found.fields["sample.E_inf"].min()) == (5e-9, 0.1e9)


# The pattern


def test_a_blend_has_its_share_and_does_not_depend_on_pixels():
    size = (400e-9, 200e-9)
    coarse = make_blend((32, 64), size, feature=60e-9, share=0.3, seed=4)
    fine = make_blend((96, 192), size, feature=60e-9, share=0.3, seed=4)
    assert set(np.unique(coarse)) == {0, 1}
    assert coarse.mean() == pytest.approx(0.3, abs=1 / coarse.size)
    centres = fine[1::3, 1::3]
    assert (coarse == centres).mean() > 0.97
    other = make_blend((32, 64), size, feature=60e-9, share=0.3, seed=5)
    assert (coarse == other).mean() < 0.8


def test_domains_are_as_wide_as_a_feature():
    size, pixels = 2e-6, 256
    for feature in (50e-9, 100e-9):
        phase = make_blend((pixels, pixels), (size, size), feature=feature, share=0.5, seed=1)
        crossings = np.abs(np.diff(phase, axis=1)).sum() / pixels
        assert size / crossings == pytest.approx(1.5 * feature, rel=0.25)


def test_an_interphase_is_as_wide_as_told():
    size, width = 1e-6, 60e-9
    share = make_blend(
        (200, 200), (size, size), feature=300e-9, share=0.5, interphase=width, seed=2
    )
    assert (share.min(), share.max()) == (0, 1)
    steepest = np.hypot(*np.gradient(share, size / 200)).max()
    assert 1 / steepest == pytest.approx(width, rel=0.5)


# The command line


def test_scan_plot_and_export(folder, softafm):
    code, out, err = softafm("scan", "blend.toml", *small(), "--workers", "1")
    assert (code, err) == (0, "")
    assert re.search(r"topography +1[78]\.\d+ nm +17\.\d+ nm to 18\.\d+ nm", out)
    assert re.search(r"pixels +8 × 8 +\d+ different", out)
    assert "saved blend.nc" in out
    result = sa.load("blend.nc")
    assert result["phase"].dims == ("y", "x")
    softafm("scan", "blend.toml", *small("motion.setpoint=0.5"), "--workers", "1", "--out", "b.nc")
    assert float(sa.load("b.nc")["topography"].mean()) < 10e-9
    assert softafm("plot", "blend.nc", "b.nc", "--out", "both.png")[0] == 0
    with Image.open("both.png") as both:
        assert both.width > 1000
    assert softafm("export", "blend.nc", "--out", "blend.gwy")[:2] == (0, "saved blend.gwy\n")
    channels = gwyfile.util.get_datafields(gwyfile.load("blend.gwy"))
    np.testing.assert_array_equal(channels["phase"].data, result["phase"])
    assert softafm("scan", "blend.toml", *small())[0] == 2  # blend.nc exists


def test_a_number_of_workers_is_refused(folder, softafm):
    code, _, err = softafm("scan", "blend.toml", "--workers", "0")
    assert code == 2
    assert err == "softafm: --workers = 0: must be a whole number from 1 to 1024\n"


def test_the_blend_is_an_example_but_no_experiment(folder, softafm):
    assert list_maps() == ["blend"]
    assert "blend" not in [*list_examples(), *read_presets()]
    assert re.search(r"^blend +Map of", softafm("example")[1], re.MULTILINE)
    _, out, _ = softafm("example", "blend", "--force")
    assert "softafm scan blend.toml" in out
    with pytest.raises(ConfigError, match="which 'softafm scan' takes"):
        load_experiment("blend.toml")


def test_a_curve_has_no_gwy(folder, softafm):
    softafm("example", "attard-triangle")
    assert softafm("run", "attard-triangle.toml", "--tolerance", "0.1")[0] == 0
    code, _, err = softafm("export", "attard-triangle.nc", "--out", "curve.gwy")
    assert code == 2
    assert "holds no maps" in err


# Refusals


@pytest.mark.parametrize(
    ("override", "line"),
    [
        ("mode=tapping", "mode = 'tapping': did you mean 'tapping-map'?"),
        ("sample.E=3 GPa", "sample: unknown key;"),
        ("map=3", "map = 3: must be a table, [map]"),
        ("map.colour=red", "map.colour: unknown key;"),
        ("map.pattern=blends", "map.pattern = 'blends': did you mean 'blend'?"),
        ("map.pattern=labels", "map.pixels: unknown key;"),
        ("map.size=100 nm", "map.size = '100 nm': must be two lengths, along x and y,"),
        ("map.size=['1 nm', '1 Pa']", "map.size[1] = '1 Pa': must be a length with its unit"),
        ("map.size=['1 nm', '-1 um']", "map.size[1] = '-1 um': must be greater than 0"),
        ("map.pixels=[8]", "map.pixels = [8]: must be two whole numbers from 1 to 4096"),
        ("map.pixels=[8, 1e9]", "map.pixels = [8, 1000000000.0]: must be two whole numbers"),
        ("map.feature=3 kPa", "map.feature = '3 kPa': must be a length"),
        ("map.feature=1 nm", "map.feature = '1 nm': must be at least a pixel"),
        ("map.interphase=1 um", "map.interphase = '1 um': must be at most the feature"),
        ("map.interphase=-1 nm", "map.interphase = '-1 nm': must be at least 0"),
        ("map.share=1", "map.share = 1: must be above 0 and below 1"),
        ("map.seed=-1", "map.seed = -1: must be a whole number of at least 0"),
        ("map.materials=[]", "map.materials = []: must be a list"),
        ("map.materials=[3]", "map.materials[0] = 3: must be a table, [[map.materials]]"),
        ("map.materials=[{}]", "map.materials[0].sample: missing; must be a table like [sample]"),
        ("map.height=3", "map.height = 3: must be a table with image, from and to"),
        ("map.height.image=none.png", "map.height: give from and to,"),
        ("map.height={image='a.png', from='0 m', to='1 Pa'}", "map.height.to = '1 Pa': must be a"),
        (
            "map.height={image='a.png', from='0 m', to='1 m'}",
            "map.height.image = 'a.png': No such file or directory",
        ),
        (
            "map.height={image='blend.toml', from='0 m', to='1 m'}",
            "map.height.image = 'blend.toml': is not an image that can be read",
        ),
        ("map.height.image=share.npy", "map.height = {'image': 'share.npy'}: has shape (2, 8):"),
        ("map.fields=3", "map.fields = 3: must be a table, [map.fields]"),
        (
            "map.fields.sample.F=3",
            "map.fields.\"sample.F\": the sample 'standard-linear-solid' has",
        ),
        ("map.fields.tip=3", 'map.fields."tip": must be sample.NAME or surface.NAME'),
        (
            "map.fields.sample.E0={image='grey.png', from='1 nm', to='1 GPa'}",
            "map.fields.\"sample.E0\".from = '1 nm': must be a modulus with its unit",
        ),
        ("motion.setpoint=1.2", "motion.setpoint = 1.2: must be above 0 and below 1"),
        ("motion.engaged=both", "motion.engaged = 'both': must be 'approach', 'attractive' or"),
        ("motion.free_amplitude=-1 nm", "motion.free_amplitude = '-1 nm': must be greater than 0"),
        ("cantilever.stiffness=3 N", "cantilever.stiffness = '3 N': must be a stiffness"),
        ("run.tolerance=3", "run.tolerance = 3: must be between"),
        ("run.profiles=true", "run.profiles: unknown key;"),
        ("tip.radius=-1 nm", "tip.radius = '-1 nm': must be greater than 0"),
    ],
)
def test_bad_files_are_refused_before_anything_starts(folder, softafm, override, line):
    code, out, err = softafm(
        "scan", "blend.toml", "--set", "map.pixels=[16, 16]", "--set", override
    )
    assert (code, out) == (2, "")
    assert any(each.startswith(f"softafm: {line}") for each in err.splitlines()), err
    assert not (folder / "blend.nc").exists()


@pytest.mark.parametrize(
    ("document", "line"),
    [
        (volume(PS), "map: give fields, height or a pattern, as nothing varies"),
        (volume(PS, LDPE), "map.materials: are 2; this pattern takes 1, the pattern 'labels' any"),
        (
            volume({**PS, "sample": {"model": "elastic", "E": "1 nm", "poisson": 0.3}}),
            "map.materials[0].sample.E = '1 nm': must be a modulus",
        ),
        (volume({**PS, "tip": 3}), "map.materials[0].tip: unknown key; must be 'name',"),
        (
            volume(PS, STIFF, pattern="share", file="share.npy"),
            "map.materials: sample: 'standard-linear-solid' and 'elastic' do not mix; both must be",
        ),
        (
            volume(PS, LDPE, STIFF, pattern="labels", file="two.png"),
            "map.file = 'two.png': has 2 greys, but there are 3 materials",
        ),
        (
            volume(PS, LDPE, pattern="labels", file="labels.npy"),
            "map: labels[0, 2] = 2: must be a whole number from 0 to 1",
        ),
        (
            volume(PS, LDPE, pattern="share", file="labels.npy"),
            "map.file = 'labels.npy': image[0, 2] = 2: must be from 0 to 1",
        ),
        (
            volume(PS, LDPE, pattern="share", file="broken.npy"),
            "map.file = 'broken.npy': is not an array that NumPy saved",
        ),
        (
            volume(PS, LDPE, pattern="share", file="missing.npy"),
            "map.file = 'missing.npy': No such file or directory",
        ),
        (
            volume(PS, fields={"surface.z0": {"image": "grey.png", "from": "0 nm", "to": "1 nm"}}),
            "map.fields.\"surface.z0\".from = '0 nm': must be greater than 0",
        ),
    ],
)
def test_bad_documents_are_refused(folder, document, line):
    (folder / "broken.npy").write_bytes(b"\x93NUMPY")
    with pytest.raises(ConfigError) as refused:
        build_map(document, folder)
    assert str(refused.value).startswith(line)
    assert "\n" not in str(refused.value)


def test_a_ramp_that_starts_inside_a_pixel_is_refused(folder):
    document = volume(PS, LDPE, pattern="labels", file="two.png")
    document["motion"]["start"] = "0.2 nm"
    with pytest.raises(ConfigError, match=r"^motion.start = '0.2 nm': .* at pixel \(0, 6\)$"):
        build_map(document, folder).run()


def test_a_sample_that_flows_is_not_tapped(folder):
    document = tomllib.loads(read_example("blend"))
    fluid = {"model": "maxwell", "E0": "1 GPa", "relaxation_time": "1 us", "poisson": 0.4}
    document["map"]["materials"][1]["sample"] = fluid
    document["map"]["interphase"] = "0 nm"
    with pytest.raises(ConfigError, match=r"^map.materials\[1\].sample: 'maxwell' flows, so"):
        build_map(document, folder)
