"""Files given to a command that does not take them: the one that does is named."""

import pytest

from softafm.experiment.config import read_example

SWEPT = '\n[sweep.vary]\n"sample.E0" = ["1 GPa", "2 GPa"]\n'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tap.toml").write_text(read_example("ldpe-tapping"), encoding="utf-8")
    (tmp_path / "map.toml").write_text(read_example("blend"), encoding="utf-8")
    (tmp_path / "campaign.toml").write_text(read_example("ldpe-tapping") + SWEPT, encoding="utf-8")
    half = read_example("blend").replace("[map", "[amp")
    (tmp_path / "half-a-map.toml").write_text(half, encoding="utf-8")
    (tmp_path / "tap.nc").write_bytes(b"\x89HDF\r\n\x1a\n")
    (tmp_path / "campaign.zarr").mkdir()
    return tmp_path


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ("scan tap.toml", "mode: the file describes an experiment, which 'softafm run' takes"),
        ("scan campaign.toml", "sweep: the file describes a sweep, which 'softafm sweep' takes"),
        ("run map.toml", "map: the file describes a map, which 'softafm scan' takes"),
        ("run half-a-map.toml", "mode: the file describes a map, which 'softafm scan' takes"),
        ("run campaign.toml", "sweep: the file describes a sweep, which 'softafm sweep' takes"),
        ("info map.toml", "map: the file describes a map, which 'softafm scan' takes"),
        ("info campaign.toml", "sweep: the file describes a sweep, which 'softafm sweep' takes"),
        ("show campaign.toml", "sweep: the file describes a sweep, which 'softafm sweep' takes"),
        ("sweep map.toml", "map: the file describes a map, which 'softafm scan' takes"),
        ("sweep tap.toml", "('softafm run' runs an experiment without it)"),
        ("run tap.nc", "tap.nc: is a result, which 'softafm plot' and 'softafm export' take"),
        ("info tap.nc", "tap.nc: is a result, which 'softafm plot' and 'softafm export' take"),
        ("scan tap.nc", "tap.nc: is a result, which 'softafm plot' and 'softafm export' take"),
        ("sweep tap.nc", "tap.nc: is a result, which 'softafm plot' and 'softafm export' take"),
        ("run campaign.zarr", "campaign.zarr: is the store of a sweep; 'softafm sweep --status'"),
        ("plot campaign.zarr", "campaign.zarr: is the store of a sweep, not the result of a run;"),
        ("plot tap.toml", "tap.toml: is a file to be run, not a result; 'softafm run', 'scan' or"),
        ("animate tap.toml --out a.gif", "tap.toml: is a file to be run, not a result;"),
        ("export map.toml --out a.csv", "map.toml: is a file to be run, not a result;"),
    ],
)
def test_the_right_command_is_named(softafm, folder, arguments, said):
    before = sorted(folder.iterdir())
    code, out, err = softafm(*arguments.split())
    assert (code, out) == (2, "")
    assert said in err
    assert len(err.splitlines()) == 1
    assert sorted(folder.iterdir()) == before
