"""Files of results: read as xarray reads them, and refused where they are not ours or not whole."""

import csv
import json
import os

import h5py
import numpy as np
import pytest
import xarray as xr
from result_samples import NAMES, results

import softafm as sa
from softafm.draw.summary import list_observables
from softafm.files.measured import read_path
from softafm.results import files as result_files
from softafm.results.content import NEEDED, PROFILES


@pytest.fixture
def path(tmp_path):
    return tmp_path / "result.nc"


def saved(path, name="force-distance"):
    sa.save(results()[name], path, overwrite=True)
    return path


def refusal(path, **options):
    before = path.read_bytes()
    with pytest.raises(ValueError, match=path.name) as caught:
        sa.load(path, **options)
    assert path.read_bytes() == before
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    assert len(text.splitlines()) == 1
    return text.removeprefix(f"{path}: ")


# Read as by xarray


@pytest.mark.parametrize("name", NAMES)
def test_every_mode_is_read_as_xarray_reads_it(path, name):
    saved(path, name)
    ours, theirs = sa.load(path), xr.load_dataset(path, engine="h5netcdf")
    xr.testing.assert_identical(ours, theirs)
    for part in ("data_vars", "coords", "attrs"):
        assert list(getattr(ours, part)) == list(getattr(theirs, part))
    assert [v.dtype for v in ours.data_vars.values()] == [
        v.dtype for v in theirs.data_vars.values()
    ]
    assert {k: type(v) for k, v in ours.attrs.items()} == {
        k: type(v) for k, v in theirs.attrs.items()
    }


def test_a_name_with_a_comma_is_one_column_of_an_export(path, tmp_path):
    result = results()["force-distance"].copy()
    for name, units in (('force, "raw"', "V"), ("drift", 'a, "b"')):
        result[name] = ("time", np.arange(result.sizes["time"]) * 1.0, {"units": units})
    sa.save(result, path)
    sa.export(sa.load(path), tmp_path / "c.csv")
    with open(tmp_path / "c.csv", newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(line for line in file if not line.startswith("#"))
    assert header[-2:] == ['force, "raw" (V)', 'drift (a, "b")']
    assert {len(row) for row in rows} == {len(header)}
    heights = read_path(tmp_path / "c.csv")[1]
    np.testing.assert_array_equal(heights, result["tip_height"])


def test_what_a_user_adds_is_read_as_xarray_reads_it(path):
    more = results()["tapping-cycle"].assign_coords(operator="Ada", batch=("jump", [])).assign(
        count=("cycle", np.array([3, 4], np.int32)), words=("cycle", ["odd", "µ"])
    )  # fmt: skip
    more = more.assign_attrs(note="one\ntwo", places=[1.0, 2.0], names=["a", "b"], none="")
    more["force"].encoding = {"zlib": True, "shuffle": True, "fletcher32": True}
    sa.save(more, path)
    xr.testing.assert_identical(sa.load(path), xr.load_dataset(path, engine="h5netcdf"))
    assert set(sa.load(path).coords) == {"time", "operator", "batch"}


# What lies outside, or is not ours


def outside(tmp_path):
    """A file whose content must not be read."""
    secret = tmp_path / "secret.bin"
    secret.write_bytes(np.arange(1000.0).tobytes())
    with h5py.File(tmp_path / "secret.h5", "w") as other:
        other["force"] = np.arange(1000.0)
    return secret


def external(file, size, secret):
    file.create_dataset("more", (size,), float, external=[(str(secret), 0, 8 * size)])


def virtual(file, size, secret):
    layout = h5py.VirtualLayout((size,), float)
    layout[:] = h5py.VirtualSource(secret.with_suffix(".h5"), "force", (1000,))[:size]
    file.create_virtual_dataset("more", layout)


def group(file, size, secret):
    file.create_group("more/deep")["force"] = 1.0


def named_type(file, size, secret):
    file["more"] = np.dtype("f8")


def compound(file, size, secret):
    file["more"] = np.zeros(3, [("a", float), ("b", int)])


def reference(file, size, secret):
    file.create_dataset("more", (1,), h5py.ref_dtype)[0] = file["time"].ref


def filtered(file, size, secret):
    file.create_dataset("more", (size,), float, chunks=(size,), compression="lzf")


def nowhere(file, size, secret):
    file["more"] = h5py.Empty("f8")


def numbered(file, size, secret):
    for number in range(1001):
        file[f"more{number}"] = 1.0


ODD = {
    "external storage": (external, "variable 'more' keeps its values in another file"),
    "virtual": (virtual, "variable 'more' is put together from other files"),
    "external link": (
        lambda file, size, secret: file.__setitem__(
            "more", h5py.ExternalLink(secret.with_suffix(".h5"), "force")
        ),
        "'more' is a link to elsewhere",
    ),
    "soft link": (
        lambda file, size, secret: file.__setitem__("more", h5py.SoftLink("/force")),
        "'more' is a link to elsewhere",
    ),
    "group": (group, "'more' is a group"),
    "named type": (named_type, "'more' is a named type"),
    "compound": (compound, "variable 'more' is of a type that softafm does not write"),
    "reference": (reference, "variable 'more' is of a type that softafm does not write"),
    "filter": (filtered, "variable 'more' is packed in a way that softafm does not write"),
    "empty": (nowhere, "variable 'more' has no values"),
    "many": (numbered, "entries: at most 1000"),
    "no dimensions": (
        lambda file, size, secret: file.__setitem__("more", np.zeros(3)),
        "variable 'more' has dimensions without a name",
    ),
    "packed": (
        lambda file, size, secret: file["force"].attrs.__setitem__("scale_factor", 2.0),
        "attribute 'scale_factor' of variable 'force': softafm does not write such values",
    ),
    "fill": (
        lambda file, size, secret: file["force"].attrs.__setitem__("_FillValue", 0.0),
        "attribute '_FillValue' of variable 'force' = 0.0: must be NaN",
    ),
    "odd attribute": (
        lambda file, size, secret: file["force"].attrs.__setitem__("more", file["time"].ref),
        "attribute 'more' of variable 'force' is of a type that softafm does not write",
    ),
}


@pytest.mark.parametrize("kind", ODD)
def test_what_softafm_never_writes_is_refused_before_anything_is_read(
    path, tmp_path, kind, monkeypatch
):
    saved(path)
    secret = outside(tmp_path)
    spoil, words = ODD[kind]
    with h5py.File(path, "r+") as file:
        spoil(file, file["time"].size, secret)

    def read(*_):
        raise AssertionError("a value was read")

    monkeypatch.setattr(result_files, "_read_values", read)
    assert words in refusal(path)


def test_values_of_another_file_are_not_even_looked_for(path, tmp_path):
    """The files named do not exist, and that is not what is said."""
    saved(path)
    with h5py.File(path, "r+") as file:
        external(file, 3, tmp_path / "no" / "such")
    assert "keeps its values in another file" in refusal(path)
    with h5py.File(path, "r+") as file:
        del file["more"]
        file["more"] = h5py.ExternalLink(str(tmp_path / "none.h5"), "/")
    assert "is a link to elsewhere" in refusal(path)


def test_a_small_file_that_stands_for_gigabytes_is_not_unpacked(path):
    saved(path)
    with h5py.File(path, "r+") as file:
        more = file.create_dataset("more", (400_000_000,), float, chunks=(1000,))
        more.make_scale("more")
    assert os.path.getsize(path) < 100_000
    assert refusal(path) == "has 3200 MB unpacked: at most 2000 MB"
    assert refusal(path, largest=5000).endswith("MB unpacked: at most 0.005 MB")
    assert sa.load(saved(path), largest=100_000).sizes["time"] > 2


def test_a_result_that_is_too_large_for_the_limit_is_not_read(path):
    saved(path, "with shapes")
    size = sum(v.nbytes for v in results()["with shapes"].variables.values())
    assert sa.load(path, largest=size).nbytes == results()["with shapes"].nbytes
    assert "unpacked: at most" in refusal(path, largest=size - 1)


# What is not whole


def spoiled(path, change, name="force-distance"):
    changed = change(results()[name].copy(deep=True))
    sa.save(changed, path, overwrite=True)
    return refusal(path)


@pytest.mark.parametrize(
    ("name", "variable"),
    [
        ("force-distance", "tip_height"),
        ("force-distance", "jump_time"),
        ("force-distance", "time"),
        ("force-spectroscopy", "base_height"),
        ("force-distance", "loop_energy"),
        ("force-spectroscopy", "force_min"),
        ("tapping-cycle", "virial"),
        ("tapping-cycle", "cycle_dissipation"),
        ("with shapes", "gap"),
        ("with shapes", "r"),
        ("approach-curve", "retract_phase"),
        ("approach-curve", "sweep_height"),
        ("amplitude-modulation", "topography"),
        ("force-volume", "y"),
    ],
)
def test_a_variable_that_is_missing_is_named(path, name, variable):
    said = spoiled(path, lambda result: result.drop_vars(variable), name)
    mode = results()[name].attrs["mode"]
    assert said == f"variable '{variable}' is missing, which a result of mode '{mode}' holds"


@pytest.mark.parametrize("name", NAMES)
def test_what_a_mode_needs_is_all_that_is_used(path, name, softafm):
    """Without any of it a result is refused; without all else it is drawn and written."""
    result = results()[name]
    needed = {*NEEDED[result.attrs["mode"]].variables, *result.dims} & set(result.variables)
    needed |= set(PROFILES) & set(result.variables)
    for variable in sorted(needed):
        sa.save(result.drop_vars(variable), path, overwrite=True)
        assert f"variable '{variable}' is missing" in refusal(path)
    sa.save(result.drop_vars(set(result.variables) - needed), path, overwrite=True)
    wanted = [("plot", ".png"), ("export", ".gwy" if "x" in result.dims else ".csv")]
    for command, suffix in wanted + [("animate", ".html")] * ("r" in result.dims):
        answer = softafm(command, path, "--out", path.with_suffix(suffix))
        assert answer == (0, f"saved {path.with_suffix(suffix)}\n", "")
    assert list_observables(sa.load(path)).row_count > 0


@pytest.mark.parametrize(
    ("attributes", "words"),
    [
        ({"mode": "force-spectroscopy"}, "attribute experiment: is one of mode 'force-distance', "
         "but the result says mode = 'force-spectroscopy'"),
        ({"mode": "tapping"}, "attribute mode = 'tapping': did you mean 'tapping-cycle'?"),
        ({"mode": 3.0}, "attribute mode = 3.0: must be 'force-distance', "),
        ({"experiment": None}, "attribute experiment: missing"),
        ({"experiment": "{"}, "attribute experiment = '{': cannot be read as JSON"),
        ({"experiment": "[" * 50_000}, "cannot be read as JSON"),
        ({"experiment": "[]"}, "attribute experiment: must be a table"),
        ({"experiment": 5.0}, "attribute experiment = 5.0: must be text"),
        ({"experiment": json.dumps({"mode": "force-distance"})},
         "attribute experiment: does not describe the tip"),
        ({"warnings": 1.0}, "attribute warnings = 1.0: must be text"),
        ({"check_largest": "much"}, "attribute check_largest = 'much': must be a number"),
        ({"check_differences": '{"force_max": "large"}'}, "check_differences: must hold numbers"),
        ({"regularised_range": 1e-9}, "attribute given_tabor = None: must be a number"),
        ({"format": "softafm result 0"}, "not a result of softafm"),
    ],
)  # fmt: skip
def test_attributes_that_do_not_fit_are_named(path, attributes, words):
    def change(result):
        result.attrs |= attributes
        result.attrs = {k: v for k, v in result.attrs.items() if v is not None}
        return result

    assert words in spoiled(path, change)


def value(name, index, number):
    def change(result):
        result[name].values[index] = number
        return result

    return change


def unit(name, units):
    def change(result):
        result[name].attrs["units"] = units
        return result

    return change


@pytest.mark.parametrize(
    ("name", "change", "words"),
    [
        ("force-distance", unit("time", "ms"), "variable 'time' has the unit 'ms': must be 's'"),
        ("force-distance", unit("time", "days since 1900-01-01"), "variable 'time' has the unit"),
        ("force-distance", unit("force", 3.0), "its units = 3.0: must be a word"),
        ("force-distance", value("force", 3, np.nan), "variable 'force' holds nan N"),
        ("force-distance", value("force", 3, -np.inf), "variable 'force' holds -inf N"),
        ("tapping-cycle", value("virial", (), 1e300), "variable 'virial' holds 1e+300 J"),
        ("force-distance", value("loop_energy", (), np.inf), "'loop_energy' holds inf J"),
        ("force-distance", value("loop_energy", (), np.nan), "'loop_energy' holds nan J"),
        ("force-distance", lambda r: r.assign(loop_energy=((), "abc\n1,2,3",
         r["loop_energy"].attrs)), "variable 'loop_energy' holds 'str"),
        ("force-distance", lambda r: r.assign(loop_energy=r["force"].assign_attrs(units="J")),
         "variable 'loop_energy' is over (time): must be over ()"),
        ("tapping-cycle", value("cycle_virial", 0, np.inf), "'cycle_virial' holds inf J"),
        ("approach-curve", value("force_mean", (0, 0), np.inf), "'force_mean' holds inf N"),
        ("amplitude-modulation", value("branch", (0, 0), np.inf), "'branch' holds inf 1"),
        ("force-volume", value("viscous_loss", (0, 0), np.nan), None),
        ("force-distance", lambda r: r.assign(virial=((), np.inf, {"units": "J"})),
         "variable 'virial' holds inf J"),
        ("force-volume", lambda r: r.assign(material=(("y", "x"), np.full((2, 2), "a"),
         {"units": "1"})), "variable 'material' holds 'str"),
        ("force-distance", value("jump_time", slice(0), 0), None),
        ("approach-curve", value("phase", (0, 0), 400.0), "'phase' holds 400 degree"),
        ("approach-curve", value("phase", (0, 0), np.nan), None),
        ("force-distance", lambda r: r.assign_coords(time=("time", -r["time"].values,
         r["time"].attrs)), "variable 'time' must rise"),
        ("with shapes", lambda r: r.interp(r=np.linspace(0, 1e-9, 20_001)).assign_coords(
         r=("r", np.linspace(0, 1e-9, 20_001), r["r"].attrs)), "must have 2 to 20000"),
        ("force-distance", lambda r: r.isel(time=slice(1)), "'time' has 1 values: must have 2 to"),
        ("force-distance", lambda r: r.assign(force=r["force"].mean(keep_attrs=True)),
         "variable 'force' is over (): must be over (time)"),
        ("force-distance", lambda r: r.assign(force=("time", np.full(r.sizes["time"], "1"),
         r["force"].attrs)), "variable 'force' holds 'str"),
        ("approach-curve", lambda r: r.assign_coords(branch=("branch", ["a", "b", "c"],
         r["branch"].attrs)), "variable 'branch' must hold 'attractive', 'unstable' or"),
    ],
)  # fmt: skip
def test_values_that_cannot_be_are_named(path, name, change, words):
    if words is None:
        sa.save(change(results()[name].copy(deep=True)), path)
        xr.testing.assert_identical(sa.load(path), xr.load_dataset(path, engine="h5netcdf"))
    else:
        assert words in spoiled(path, change, name)


def test_a_variable_of_another_length_than_its_dimension_is_named(path):
    saved(path)
    with h5py.File(path, "r+") as file:
        shorter = file.create_dataset("time2", data=file["time"][:-1])
        shorter.make_scale("time2")
        file["force"].dims[0].detach_scale(file["time"])
        file["force"].dims[0].attach_scale(file["time2"])
    assert refusal(path).startswith("variable 'force' has dimensions without a name, or of another")
