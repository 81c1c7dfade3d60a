"""Sweeps from Python and from the command line."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
import xarray
from swept import XS, YS, calm

import softafm as sa
from softafm.experiment.config import read_example
from softafm.sweeps import sweep as sweeps
from softafm.sweeps.store import Store

TAP = tomllib.loads(read_example("ldpe-tapping"))
HEIGHTS = ["42 nm", "43 nm", "44 nm"]
GRID = {"x": XS, "y": YS}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty current directory with a campaign."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    text = read_example("ldpe-tapping") + f"[sweep.vary]\nmotion.mean_height = {HEIGHTS}\n"
    (tmp_path / "c.toml").write_text(text, encoding="utf-8")
    return tmp_path


def test_a_sweep_lies_over_what_varies(tmp_path):
    found = sa.sweep(
        TAP, {"sample.E_inf": ["0.05 GPa", 1e8], "motion.mean_height": HEIGHTS}, workers=0
    )
    assert found["dissipation"].dims == ("E_inf", "mean_height")
    assert found["dissipation"].attrs["units"] == "J"
    assert (found["state"] == 1).all()
    one = sa.tapping_cycle(
        sa.Contact(
            sa.Paraboloid(10e-9),
            sa.StandardLinearSolid(2e9, 1e8, 1e-7, 0.49),
            sa.LennardJones(1e-19, 0.25e-9),
        ),
        49.6e-9, 43e-9, 278e3, 1,
    )  # fmt: skip
    assert float(found["dissipation"].sel(E_inf=1e8)[1]) == float(one["dissipation"])
    sa.save(found, tmp_path / "found.nc")
    xarray.testing.assert_equal(
        xarray.load_dataset(tmp_path / "found.nc", engine="h5netcdf")[["virial", "state"]],
        found[["virial", "state"]],
    )


def test_numbers_depend_neither_on_blocks_nor_on_workers():
    vary = {"motion.mean_height": HEIGHTS, "sample.E_inf": ["0.05 GPa", "0.1 GPa"]}
    whole = sa.sweep(TAP, vary, workers=0, batch=6)
    single = sa.sweep(TAP, vary, workers=0, batch=1)
    others = sa.sweep(TAP, vary, workers=2, batch=2)
    for other in (single, others):
        for name in set(whole.data_vars) - {"reason", "warning"}:
            assert whole[name].values.tobytes() == other[name].values.tobytes()


def test_an_approach_curve_can_be_swept():
    def curve(document):
        return sa.sweep(document, {"sample.creep_time": ["1 us"]}, workers=0)

    document = tomllib.loads(read_example("ps-approach-curve"))
    document["motion"] = {"free_amplitude": "15 nm", "amplitude_ratio": [0.8]}
    document["run"] = {"tolerance": 0.05}
    found = curve(document)
    assert found["phase"].dims == ("creep_time", "branch", "amplitude_ratio")
    assert np.isfinite(found["phase"].sel(branch="repulsive")).all()


def test_a_store_is_opened_and_gone_on_with(tmp_path, monkeypatch):
    store, calls = tmp_path / "s.zarr", []

    def run(x, y):
        calls.append((x, y))
        return calm(x, y)

    found = sa.sweep(run, GRID, store=store, workers=0, batch=20)
    assert len(calls) == 1 + 140  # and one to know what it gives
    xarray.testing.assert_identical(found.load(), sa.load_sweep(store))
    Path(store, "sum/3.0").unlink()
    again = sa.sweep(run, GRID, store=store, workers=0, resume=True)
    assert len(calls) == 2 + 140 + 20
    xarray.testing.assert_identical(again.load(), found)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, "exists; choose another name, or add --resume to continue it, or --force"),
        ({"resume": True, "observables": ["sum"]}, "was begun by another campaign: observables is"),
        ({"resume": True, "vary": {"x": [1.0], "y": YS}}, "it had 7 of x × 20 of y, and now 1 of"),
        ({"resume": True, "vary": {"x": XS, "y": YS[::-1]}}, "the values of y were different"),
        ({"resume": True, "what": lambda x, y: calm(x, y)}, "another campaign: function is"),
    ],
)
def test_a_store_is_neither_overwritten_nor_mixed_up(tmp_path, options, words):
    store = tmp_path / "s.zarr"
    sa.sweep(calm, GRID, store=store, workers=0)
    before = {file: file.stat().st_mtime_ns for file in store.rglob("*") if file.is_file()}
    with pytest.raises(ValueError, match=words):
        sa.sweep(**{"what": calm, "vary": GRID, "store": store, "workers": 0, **options})
    assert before == {f: f.stat().st_mtime_ns for f in store.rglob("*") if f.is_file()}


def test_force_replaces_a_store_and_nothing_else(tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/letter").touch()
    with pytest.raises(ValueError, match="mine: is not the store of a sweep"):
        sa.sweep(calm, GRID, store=tmp_path / "mine", workers=0, force=True)
    assert (tmp_path / "mine/letter").exists()
    store = tmp_path / "s.zarr"
    sa.sweep(calm, GRID, store=store, workers=0)
    found = sa.sweep(calm, {"x": XS, "y": [1]}, store=store, workers=0, force=True)
    assert dict(found.sizes) == {"x": 7, "y": 1}


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"batch": 0}, "sweep.batch = 0: must be a whole number"),
        ({"workers": -1}, "workers = -1: must be a whole number"),
        ({"scheduler": "host"}, "scheduler = host: must be an address, such as tcp://host:8786"),
        ({"scheduler": "tcp://host:1", "workers": 3}, "workers = 3: those of tcp://host:1 are"),
        ({"observables": "sum"}, "sweep.observables = 'sum': must be a list"),
        ({"vary": None}, "sweep.vary: missing"),
        ({"vary": {"x": np.linspace(0, 1, 6000), "y": YS}}, "120000 runs .6000 of x × 20 of y., a"),
    ],
)
def test_bad_arguments_are_refused(options, words, tmp_path):
    store = tmp_path / "s.zarr"
    with pytest.raises(ValueError, match=words):
        sa.sweep(**{"what": calm, "vary": GRID, "store": store, **options})
    assert not store.exists()


def test_many_runs_or_days_need_a_yes(monkeypatch):
    slow = sweeps.make_campaign(calm, Path(), sweeps.Table({"x": XS, "y": YS}), from_file=False)
    object.__setattr__(slow, "seconds", 3000.0)
    with pytest.raises(ValueError, match=r"140 runs .*, about 2 days on 2 workers: .* add --yes"):
        sweeps.refuse_size(slow, None, 2, yes=False)
    sweeps.refuse_size(slow, None, 5, yes=False)
    sweeps.refuse_size(slow, None, 2, yes=True)


def test_a_batch_is_about_two_seconds_of_expected_work_and_leaves_some_for_all():
    def batch(seconds, runs):
        found = sweeps.make_campaign(
            lambda x: {"y": x}, Path(), sweeps.Table({"x": range(runs)}), from_file=False
        )
        object.__setattr__(found, "seconds", seconds)
        return sweeps._choose_batch(found)

    assert batch(20e-3, 10_000) == 100
    assert batch(1e-6, 10**5) == 1000
    assert batch(10.0, 1000) == 1
    assert batch(1e-6, 64) == 2


def test_progress_is_told(tmp_path):
    told = []
    sa.sweep(calm, GRID, workers=0, batch=80, progress=lambda *words: told.append(words))
    assert [fraction for fraction, _ in told] == pytest.approx([0, 4 / 7, 1])
    assert told[-1][1].startswith("140 of 140 runs, 0 s left")


# The command line


def test_a_campaign_file_is_run_and_its_status_told(folder, softafm):
    code, out, err = softafm("sweep", "c.toml", "--workers", "0", "--set", "tip.radius=9nm")
    assert (code, err) == (0, "")
    assert "3 of 3" in out
    assert out.endswith("saved c.zarr\n")
    found = sa.load_sweep("c.zarr")
    assert found["mean_height"].values == pytest.approx([42e-9, 43e-9, 44e-9])
    assert json.loads(Store(Path("c.zarr")).attributes["campaign"])["experiment"]["tip"] == {
        "shape": "paraboloid",
        "radius": "9nm",
    }
    code, out, err = softafm("sweep", "--status", "c.zarr")
    assert (code, err) == (0, "")
    assert "finished" in out
    assert "3 of 3" in out


def test_failed_runs_are_told_of(folder, softafm):
    code, _, err = softafm(
        "sweep", "c.toml", "--workers", "0", "--set", "sweep.vary.sample.E_inf=['1 GPa', '3 GPa']",
        "--set", "sweep.vary.sample.E0=['2 GPa', '4 GPa']",
    )  # fmt: skip
    assert code == 0
    assert err == (
        "softafm: warning: 3 of 12 runs failed: mean_height[0], E_inf[1], E0[0]: sample.E_inf = "
        "'3000000000.0 Pa': must be at most sample.E0 = '2000000000.0 Pa' (a solid softens as it "
        "relaxes)\n"
    )


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["none.toml"], "none.toml: no such file"),
        ([], "give a CAMPAIGN.toml, or --status and a store"),
        (["--status", "none.zarr"], "none.zarr: no such store"),
        (["c.toml", "--set", "sweep.vary.tip.radius=[]"], "'tip.radius' = []: is empty"),
        (["c.toml", "--set", "sweep.vary.tip.height=['1 nm']"], "'tip.height': unknown key"),
        (["c.toml", "--set", "sweep.vary.tip.radius=['1 GPa']"], "'GPa' does not measure a len"),
        (["c.toml", "--out", "nowhere/c.zarr"], "nowhere"),
        (["c.toml", "--workers", "-2"], "workers = -2"),
        (
            ["c.toml", "--set", "sweep.vary.tip.radius={from='1 nm', to='9 nm', points=100000}"],
            "300000 runs (3 of mean_height × 100000 of radius), about",
        ),
    ],
)
def test_a_bad_command_is_refused_before_anything_starts(folder, softafm, arguments, words):
    before = sorted(folder.iterdir())
    code, out, err = softafm("sweep", *arguments)
    assert (code, out) == (2, "")
    assert words in err
    assert err.count("\n") == 1
    assert sorted(folder.iterdir()) == before


def test_a_missing_package_is_named():
    code = (
        "import sys; sys.modules['numcodecs'] = None\n"
        "import importlib.util as u; find = u.find_spec\n"
        "u.find_spec = lambda name, *a: None if name == 'numcodecs' else find(name, *a)\n"
        "from softafm.cli import main; sys.exit(main(['sweep', '--status', 'x']))"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert said.returncode == 2
    assert said.stderr == (
        "softafm: sweeps need the package 'numcodecs': pip install 'softafm[sweep]'\n"
    )
