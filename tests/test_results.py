"""Results: units, provenance, and files that are whole or not there."""

import csv
import json
import shutil
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

import softafm as sa
from softafm.results.datasets import load_apart

CONTACT = sa.Contact(
    tip=sa.Paraboloid(10e-9),
    sample=sa.StandardLinearSolid(2e9, 0.5e9, 1e-7, 0.49),
    surface=sa.LennardJones(1e-19, 0.3e-9),
)
RAMP = sa.Triangle(4e-9, -0.5e-9, 1e-3)
SOLVER = sa.solvers.Energy(finest_spacing=1e-4)


def ramp(**options):
    return sa.force_distance(CONTACT, RAMP, solver=SOLVER, tolerance=2e-2, **options)


LEVER = sa.Cantilever(5.0, quality_factor=100, frequency=5e4)


def spectroscopy(**options):
    motion = sa.Triangle(4e-9, -2e-9, 1e-3, dwell=1e-6, setpoint_force=2e-9)
    return sa.force_spectroscopy(CONTACT, LEVER, motion, tolerance=2e-2, **options)


def tap(**options):
    return sa.tapping_cycle(CONTACT, 10e-9, 10.5e-9, 278e3, 2, tolerance=2e-2, **options)


def approach(**options):
    lever = sa.Cantilever(28.1, quality_factor=430, frequency=278e3)
    return sa.approach_curve(CONTACT, lever, 15e-9, [0.9, 0.5], tolerance=0.1, **options)


def stepped(**options):
    solver = sa.solvers.EnhancedAttard(8, 30, steps=300, stepper=sa.solvers.AdamsBashforth(3))
    motion = sa.Triangle(4e-9, 1e-9, 1e-3)
    return sa.force_distance(CONTACT, motion, solver=solver, **options)


def sampled(**options):
    time = np.linspace(0, 1, 20)
    motion = sa.Trajectory(1e-4 * time, 1e-9 * (1.2 + np.cos(2 * np.pi * time)))
    return sa.force_distance(CONTACT, motion, tolerance=0.1, **options)


@pytest.fixture(scope="module")
def results():
    return {
        "ramp": ramp(),
        "ramp, profiles": ramp(profiles=True),
        "tap": tap(),
        "tap, profiles": tap(profiles=True),
        "sampled": sampled(),
        "stepped": stepped(),
        "spectroscopy": spectroscopy(),
        "approach": approach(),
    }


HISTORIES = ["ramp", "ramp, profiles", "tap", "tap, profiles", "sampled", "stepped", "spectroscopy"]
ALL = [*HISTORIES, "approach"]


@pytest.fixture
def result(results):
    return results["ramp"]


def left_in(folder):
    return sorted(path.name for path in folder.iterdir())


def one_line(error):
    return len(str(error.value).splitlines()) == 1


# What a result holds


@pytest.mark.parametrize("name", ALL)
def test_everything_has_a_unit_and_a_name(results, name):
    for variable in results[name].variables.values():
        assert variable.attrs["units"]
        assert variable.attrs["long_name"]
        if name in HISTORIES:
            assert variable.dtype == np.float64
            assert np.all(np.isfinite(variable.values))


def test_what_the_modes_promise(results):
    curves = {"tip_height", "force", "contact_radius", "axis_deformation", "viscous_power"}
    of_ramp = {"force_max", "force_min", "force_min_approach", "loop_energy", "viscous_loss"}
    of_tap = {"virial", "dissipation", "force_max", "force_min", "force_min_approach"}
    of_tap |= {"contact_time", "indentation"}
    of_mode = {"ramp": of_ramp, "tap": of_tap, "sampled": of_ramp, "spectroscopy": of_ramp}
    for name, scalars in of_mode.items():
        found = results[name]
        assert all(found[c].dims == ("time",) for c in curves)
        assert all(found[s].dims == () for s in scalars)
        assert found["jump_time"].dims == found["jump_energy"].dims == ("jump",)
        assert np.all(np.diff(found["time"]) > 0)
        assert "r" not in found.variables
    assert results["tap"]["cycle_virial"].dims == ("cycle",)
    bent = results["spectroscopy"]
    assert bent["base_height"].dims == bent["deflection"].dims == ("time",)
    assert (bent["base_height"] + bent["deflection"]).values == pytest.approx(bent["tip_height"])
    shapes = results["ramp, profiles"]
    for field in ("deformation", "gap", "pressure"):
        assert shapes[field].dims == ("time", "r")
    assert np.all(np.diff(shapes["r"]) > 0)


def test_what_an_approach_curve_promises(results):
    found = results["approach"]
    assert found["branch"].values.tolist() == ["attractive", "unstable", "repulsive"]
    observables = {"phase", "virial", "dissipation", "force_mean", "force_max", "force_min"}
    observables |= {"contact_time", "indentation"}
    assert found["mean_height"].dims == ("branch", "amplitude_ratio")
    for name in observables:
        assert found[name].dims == ("branch", "amplitude_ratio")
        for direction in ("approach", "retract"):
            assert found[f"{direction}_{name}"].dims == ("sweep_height",)
    missing = np.isnan(found["mean_height"])
    assert 0 < missing.sum() < missing.size
    assert all(np.array_equal(np.isnan(found[name]), missing) for name in observables)
    assert found["retract_phase"].units == "degree"


KINDS = {
    kind.kind: kind
    for kind in (
        sa.Cantilever,
        sa.Paraboloid,
        sa.StandardLinearSolid,
        sa.Elastic,
        sa.GeneralizedKelvinVoigt,
        sa.LennardJones,
        sa.Triangle,
        sa.Sine,
        sa.Trajectory,
        sa.solvers.Energy,
        sa.solvers.EnhancedAttard,
        sa.solvers.AdamsBashforth,
    )
}


def rebuilt(description):
    values = {k: rebuilt(v) if isinstance(v, dict) else v for k, v in description.items()}
    return KINDS[values.pop("kind")](**values)


def as_in_attributes(sample):
    contact = sa.Contact(CONTACT.tip, sample, CONTACT.surface)
    found = sa.force_distance(contact, sa.Triangle(4e-9, 3e-9, 1e-3), tolerance=0.1)
    return rebuilt(json.loads(found.attrs["experiment"])["sample"])


def test_provenance_rebuilds_the_experiment(results):
    for name, mode in (("ramp", "force-distance"), ("tap", "tapping-cycle")):
        experiment = json.loads(results[name].attrs["experiment"])
        assert experiment["mode"] == results[name].attrs["mode"] == mode
        assert rebuilt(experiment["tip"]) == CONTACT.tip
        assert rebuilt(experiment["sample"]) == CONTACT.sample
        assert rebuilt(experiment["surface"]) == CONTACT.surface
    assert rebuilt(json.loads(results["ramp"].attrs["experiment"])["motion"]) == RAMP
    tapped = rebuilt(json.loads(results["tap"].attrs["experiment"])["motion"])
    assert tapped == sa.Sine(10.5e-9, 10e-9, 278e3, 2)
    assert rebuilt(json.loads(results["ramp"].attrs["solver"])) == SOLVER
    assert rebuilt(json.loads(results["tap"].attrs["solver"])) == sa.solvers.Energy()
    attributes = results["ramp"].attrs
    assert attributes["tolerance"] == 2e-2
    assert attributes["softafm_version"] == sa.__version__
    assert attributes["tabor_relaxed"] == pytest.approx(CONTACT.tabor_relaxed)
    assert attributes["warnings"] == ""


def test_fixed_steps_are_recorded_with_their_stepper_and_no_tolerance(results):
    attributes = results["stepped"].attrs
    solver = json.loads(attributes["solver"])
    assert (solver["kind"], solver["steps"]) == ("enhanced-attard", 300)
    assert solver["stepper"] == {"kind": "adams-bashforth", "order": 3}
    assert "tolerance" not in attributes


def test_a_replayed_result_is_the_same(results):
    for name in ("ramp", "sampled", "stepped"):
        found = results[name]
        experiment = json.loads(found.attrs["experiment"])
        contact = sa.Contact(*(rebuilt(experiment[k]) for k in ("tip", "sample", "surface")))
        again = sa.force_distance(
            contact,
            rebuilt(experiment["motion"]),
            solver=rebuilt(json.loads(found.attrs["solver"])),
            tolerance=found.attrs.get("tolerance", 1e-2),
        )
        xr.testing.assert_equal(again, found)


def test_a_replayed_spectroscopy_is_the_same(results):
    found = results["spectroscopy"]
    experiment = json.loads(found.attrs["experiment"])
    lever, motion = (rebuilt(experiment[k]) for k in ("cantilever", "motion"))
    assert lever == LEVER
    assert (motion.dwell, motion.setpoint_force) == (1e-6, 2e-9)
    contact = sa.Contact(*(rebuilt(experiment[k]) for k in ("tip", "sample", "surface")))
    again = sa.force_spectroscopy(contact, lever, motion, tolerance=found.attrs["tolerance"])
    xr.testing.assert_equal(again, found)


def test_a_replayed_approach_curve_is_the_same(results):
    found = results["approach"]
    experiment = json.loads(found.attrs["experiment"])
    contact = sa.Contact(*(rebuilt(experiment[k]) for k in ("tip", "sample", "surface")))
    motion = experiment["motion"]
    assert motion.pop("kind") == "approach-curve"
    lever = rebuilt(experiment["cantilever"])
    again = sa.approach_curve(contact, lever, **motion, tolerance=found.attrs["tolerance"])
    xr.testing.assert_equal(again, found)


@pytest.mark.parametrize(
    "sample",
    [sa.Elastic(1e9, 0.3), sa.GeneralizedKelvinVoigt(2e9, (1e-9, 2e-9), (1e-6, 1e-4), 0.3)],
)
def test_provenance_of_every_sample(sample):
    assert as_in_attributes(sample) == sample


# Saving and loading


@pytest.mark.parametrize("name", ALL)
def test_saved_and_loaded_unchanged(results, name, tmp_path):
    path = tmp_path / "result.nc"
    sa.save(results[name], path)
    loaded = sa.load(path)
    xr.testing.assert_identical(loaded, results[name])
    assert set(loaded.coords) == set(results[name].coords)
    assert left_in(tmp_path) == ["result.nc"]
    sa.save(loaded, tmp_path / "again.nc")
    xr.testing.assert_identical(sa.load(tmp_path / "again.nc"), results[name])


@pytest.mark.parametrize("name", ["ramp, profiles", "tap", "approach"])
def test_saved_files_are_as_xarray_writes_them(results, name, tmp_path):
    sa.save(results[name], tmp_path / "ours.nc")
    results[name].to_netcdf(tmp_path / "theirs.nc", engine="h5netcdf")
    ours, theirs = (
        xr.load_dataset(tmp_path / f"{whose}.nc", engine="h5netcdf") for whose in ("ours", "theirs")
    )
    xr.testing.assert_identical(ours, theirs)
    assert list(ours.variables) == list(theirs.variables)
    for variable, other in zip(ours.variables.values(), theirs.variables.values(), strict=True):
        ignored = {"source": None}
        assert str(variable.encoding | ignored) == str(other.encoding | ignored)


def test_what_a_user_adds_is_saved(result, tmp_path):
    added = result.assign(
        count=("time", np.arange(result.sizes["time"])),
        seen=("time", result["force"].values > 0),
        offset=result["force"].astype("f4"),
    ).assign_coords(stage=("time", np.linspace(0, 1, result.sizes["time"])), place=3.0)
    sa.save(added, tmp_path / "added.nc")
    xr.testing.assert_equal(sa.load(tmp_path / "added.nc"), added)
    apart = load_apart(tmp_path / "added.nc")
    xr.testing.assert_equal(apart, added)
    assert {apart[name].dtype.kind for name in ("count", "seen", "offset")} == set("ibf")
    assert set(sa.load(tmp_path / "added.nc").coords) == {"time", "stage", "place"}


def test_a_result_with_warnings_and_odd_names_survives(result, tmp_path):
    odd = result.assign_attrs(warnings="one\ntwo µm ≥ 3", note="ünïcode")
    path = tmp_path / "a result, with spaces & ümläuts.nc"
    sa.save(odd, str(path))
    xr.testing.assert_identical(sa.load(str(path)), odd)


def test_loading_leaves_the_file_free(result, tmp_path):
    path = tmp_path / "result.nc"
    sa.save(result, path)
    loaded = sa.load(path)
    sa.save(loaded.assign_attrs(note="second"), path, overwrite=True)
    assert sa.load(path).attrs["note"] == "second"
    path.unlink()
    assert loaded["force"].values.size == result["force"].size


def test_saved_files_are_readable_by_others(result, tmp_path):
    sa.save(result, tmp_path / "result.nc")
    other = tmp_path / "other"
    other.touch()
    assert (tmp_path / "result.nc").stat().st_mode == other.stat().st_mode


@pytest.mark.parametrize("name", ["result.nc", "curve.csv", "all.h5"])
def test_existing_files_are_kept_unless_told_otherwise(result, tmp_path, name):
    path = tmp_path / name
    path.write_bytes(b"precious")
    write = sa.save if name.endswith(".nc") else sa.export
    with pytest.raises(FileExistsError, match=name) as caught:
        write(result, path)
    assert one_line(caught)
    assert path.read_bytes() == b"precious"
    assert left_in(tmp_path) == [name]
    write(result, path, overwrite=True)
    assert path.read_bytes() != b"precious"
    assert left_in(tmp_path) == [name]


@pytest.mark.parametrize("name", ["result.nc", "all.h5"])
def test_a_result_that_cannot_be_written_leaves_the_old_file(result, tmp_path, name):
    path = tmp_path / name
    write = sa.save if name.endswith(".nc") else sa.export
    write(result, path)
    before = path.read_bytes()
    # NetCDF has no dictionaries among its attributes.
    unwritable = result.assign_attrs(nested={"a": {"b": 1}})
    with pytest.raises((TypeError, ValueError)):
        write(unwritable, path, overwrite=True)
    assert path.read_bytes() == before
    assert left_in(tmp_path) == [name]


def test_a_csv_that_cannot_be_written_leaves_nothing(result, tmp_path):
    with pytest.raises(AttributeError):
        sa.export(result.drop_attrs().assign_attrs(result.attrs), tmp_path / "curve.csv")
    with pytest.raises(ValueError, match="the dataset is not a result of softafm"):
        sa.export(result.drop_attrs(), tmp_path / "curve.csv")
    assert left_in(tmp_path) == []


FULL_DISK = """
import resource, signal, sys
import softafm as sa
source, path = sys.argv[1:]
result = sa.load(source)
write = sa.save if path.endswith(".nc") else sa.export
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (2000, -1))
try:
    write(result, path, overwrite=True)
except OSError as error:
    print(error)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="limits file sizes as POSIX does")
@pytest.mark.parametrize("name", ["result.nc", "curve.csv", "all.h5"])
def test_a_full_disk_leaves_the_old_file(result, tmp_path, name):
    # In a process of its own, as HDF5 has been seen to crash when it cannot write.
    folder = tmp_path / "folder"
    folder.mkdir()
    path = folder / name
    path.write_bytes(b"precious")
    sa.save(result, tmp_path / "source.nc")
    command = [sys.executable, "-c", FULL_DISK, str(tmp_path / "source.nc"), str(path)]
    outcome = subprocess.run(command, capture_output=True, text=True, check=False)
    assert path.read_bytes() == b"precious"
    assert left_in(folder) == [name]
    assert outcome.returncode == 0, outcome.stderr
    assert "File too large" in outcome.stdout
    assert outcome.stderr == ""


@pytest.mark.parametrize("name", ["result.nc", "curve.csv", "all.h5"])
def test_folders_that_are_no_folders(result, tmp_path, name):
    write = sa.save if name.endswith(".nc") else sa.export
    gone = tmp_path / "gone"
    gone.mkdir()
    shutil.rmtree(gone)
    with pytest.raises(OSError, match="gone"):
        write(result, gone / name)
    file = tmp_path / "file"
    file.write_text("x")
    with pytest.raises(OSError, match="file"):
        write(result, file / name)
    (tmp_path / name).mkdir()
    with pytest.raises(OSError, match=name):
        write(result, tmp_path / name, overwrite=True)
    assert left_in(tmp_path) == sorted(["file", name])


# What is no result


def test_no_such_file(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"missing\.nc") as caught:
        sa.load(tmp_path / "missing.nc")
    assert one_line(caught)
    with pytest.raises(FileNotFoundError):
        sa.load(tmp_path)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"time,force\n0,1\n",
        b"\x89HDF\r\n\x1a\n",
        b"\x89HDF\r\n\x1a\n" + bytes(500),
        b"CDF\x01",
    ],
)
def test_files_that_are_no_results(tmp_path, content):
    path = tmp_path / "thing.nc"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=r"thing\.nc") as caught:
        sa.load(path)
    assert one_line(caught)
    assert path.read_bytes() == content


def test_half_a_result_is_no_result(result, tmp_path):
    path = tmp_path / "half.nc"
    sa.save(result, path)
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    with pytest.raises(ValueError, match=r"half\.nc") as caught:
        sa.load(path)
    assert one_line(caught)


@pytest.mark.parametrize("attributes", [{}, {"format": "something else"}, {"format": 3}])
def test_netcdf_of_others_is_no_result(tmp_path, attributes):
    path = tmp_path / "other.nc"
    xr.Dataset({"force": ("time", [1.0, 2.0])}, attrs=attributes).to_netcdf(path, engine="h5netcdf")
    with pytest.raises(ValueError, match=r"other.nc: not a result of softafm") as caught:
        sa.load(path)
    assert one_line(caught)


# Export


@pytest.mark.parametrize("name", ["ramp", "tap", "tap, profiles", "spectroscopy"])
def test_csv_holds_the_curves(results, tmp_path, name):
    result, path = results[name], tmp_path / "curve.CSV"
    sa.export(result, path)
    lines = path.read_text(encoding="utf-8").splitlines()
    comments = [line for line in lines if line.startswith("#")]
    header, *rows = csv.reader(line for line in lines if not line.startswith("#"))
    curves = ["tip_height", "force", "contact_radius", "axis_deformation", "viscous_power"]
    curves += ["base_height", "deflection"] if name == "spectroscopy" else []
    assert header[0] == "time (s)"
    assert sorted(header[1:]) == sorted(f"{c} ({result[c].units})" for c in curves)
    table = np.array(rows, float)
    assert table.shape == (result["time"].size, len(header))
    for column, title in zip(table.T, header, strict=True):
        values = result[title.split(" ")[0]].values
        assert column == pytest.approx(values, rel=1e-8, abs=1e-300)
    assert json.loads(comments[-1].split("=", 1)[1]) == json.loads(result.attrs["experiment"])
    scalars = {c[2:].split(" = ")[0]: c.split(" = ")[1].split() for c in comments[:-1]}
    assert set(scalars) == {n for n, v in result.data_vars.items() if v.dims == ()}
    for scalar, (value, unit) in scalars.items():
        assert float(value) == pytest.approx(float(result[scalar]), rel=1e-8)
        assert unit == result[scalar].units


def test_csv_of_an_approach_curve_holds_the_sweep(results, tmp_path):
    result, path = results["approach"], tmp_path / "sweep.csv"
    sa.export(result, path)
    comment, *lines = path.read_text(encoding="utf-8").splitlines()
    assert json.loads(comment.removeprefix("# experiment = "))["mode"] == "approach-curve"
    header, *rows = csv.reader(lines)
    assert header[:2] == ["sweep_height (m)", "approach_amplitude (m)"]
    swept = [n for n, v in result.data_vars.items() if v.dims == ("sweep_height",)]
    assert header[1:] == [f"{name} ({result[name].units})" for name in swept]
    table = np.array(rows, float)
    assert table.shape == (result.sizes["sweep_height"], len(header))
    for column, name in zip(table.T, ["sweep_height", *swept], strict=True):
        assert column == pytest.approx(result[name].values, rel=1e-8, nan_ok=True)


def test_csv_keeps_neighbouring_times_apart(results, tmp_path):
    for number, name in enumerate(HISTORIES):
        result = results[name]
        path = tmp_path / f"{number}.csv"
        sa.export(result, path)
        table = np.genfromtxt(path, delimiter=",", skip_header=0, comments="#", names=None)
        assert np.all(np.diff(table[1:, 0]) > 0)


@pytest.mark.parametrize("name", ["tap", "ramp, profiles", "approach"])
def test_hdf5_holds_everything(results, tmp_path, name):
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "all.h5"
    sa.export(results[name], path)
    with h5py.File(path) as file:
        for variable in results[name].variables:
            held = file[variable]
            found = held.asstr()[...] if held.dtype.kind == "O" else held[...]
            np.testing.assert_array_equal(found, results[name][variable].values)
            assert file[variable].attrs["units"] == results[name][variable].units
        assert json.loads(file.attrs["experiment"])["tip"]["radius"] == CONTACT.tip.radius
    xr.testing.assert_identical(sa.load(path), results[name])


@pytest.mark.parametrize("name", ["curve.txt", "curve", "curve.nc", ".csv"])
def test_unknown_suffixes_are_refused(result, tmp_path, name):
    with pytest.raises(ValueError, match="suffix") as caught:
        sa.export(result, tmp_path / name)
    assert one_line(caught)
    assert left_in(tmp_path) == []
