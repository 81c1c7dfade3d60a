"""What is written nearly right in a file or on the command line: one line says what is right."""

import os

import pytest

from softafm.experiment.config import ConfigError, load_experiment, read_example
from softafm.units.quantities import ENERGY, LENGTH, read_quantity


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "tap.toml"
    path.write_text(read_example("ldpe-tapping"))
    return path


@pytest.mark.parametrize(
    ("override", "said"),
    [
        (
            "sample.poisson=0,49",
            "sample.poisson = '0,49': must be a plain number; did you mean 0.49?",
        ),
        ("sample.poisson=.5", "sample.poisson = '.5': must be a plain number; did you mean 0.5?"),
        (
            "sample.poisson=-.5",
            "sample.poisson = '-.5': must be a plain number; did you mean -0.5?",
        ),
        ("sample.poisson='0.4'", "'0.4': must be a plain number, without quotes or unit"),
        ("sample.poisson=0.4 Pa", "'0.4 Pa': must be a plain number, without quotes or unit"),
        ("surface.hamaker=10 kT", "did you mean '4.114e-20 J', that at 298 K?"),
        ("surface.hamaker=10 nm", "'nm' does not measure an energy"),
        ("tip.radius=1 000 nm", "did you mean '1000 nm'?"),
        (
            "surface.law=JKR",
            "surface.law = 'JKR': JKR is not a law but the limit of a law with adhesion",
        ),
        ("surface.law=DMT-JKR", "its closed form is in softafm.indentation; "),
        (
            "surface.law=hertz",
            "Hertz is not a law but the limit of a law without adhesion, 'repulsion'",
        ),
    ],
)
def test_what_may_have_been_meant(file, override, said):
    with pytest.raises(ConfigError) as refused:
        load_experiment(file, [override])
    assert said in str(refused.value)
    assert len(str(refused.value).splitlines()) == 1


@pytest.mark.parametrize("written", ["10 kT", "10kBT", "1e1 k_B T", "10 kbT"])
def test_the_thermal_energy_is_told_in_joules(written):
    # The Boltzmann constant is exact in the SI: 10 · 1.380649e-23 J/K · 298 K.
    with pytest.raises(ValueError, match=r"did you mean '4\.114e-20 J', that at 298 K\?"):
        read_quantity(written, ENERGY)


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("1 000 nm", "'1000 nm'"),
        ("12\u202f000\u202fnm", "'12000 nm'"),
        ("1 000 000 pm", "'1000000 pm'"),
        ("1 000.5 nm", "'1000.5 nm'"),
    ],
)
def test_thousands_in_groups_are_closed_up(written, meant):
    with pytest.raises(ValueError, match=f"did you mean {meant}"):
        read_quantity(written, LENGTH)


@pytest.mark.parametrize("command", ["run", "info", "show", "scan"])
@pytest.mark.parametrize(("name", "content"), [("x.csv", b"a,b\n1,2\n"), ("x.png", b"\x89PNG\r\n")])
def test_a_file_that_is_no_experiment_is_called_so(
    softafm, tmp_path, monkeypatch, command, name, content
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / name).write_bytes(content)
    code, out, err = softafm(command, name)
    assert (code, out) == (2, "")
    assert err.startswith(f"softafm: {name}: is not a TOML file; ")
    assert len(err.splitlines()) == 1


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no pipes")
@pytest.mark.parametrize("command", [("run",), ("plot",), ("export", "--out", "a.csv")])
def test_a_pipe_is_not_called_missing(softafm, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    os.mkfifo("pipe")
    code, _, err = softafm(*command, "pipe")
    assert (code, err) == (2, "softafm: pipe: is not a regular file\n")
