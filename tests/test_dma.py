"""Measured storage and loss moduli: what is read, what the fit finds, and what is refused."""

import json
import pickle
import re
from importlib.util import module_from_spec, spec_from_file_location
from math import nan, pi
from operator import attrgetter
from pathlib import Path

import numpy as np
import pytest

import softafm as sa
from softafm.app.python_lines import write_python
from softafm.draw.sample import plot_rheology
from softafm.experiment.config import load_experiment, parse_document
from softafm.rheology import (
    FractionalStandardLinearSolid,
    GeneralizedMaxwell,
    KelvinVoigt,
    Maxwell,
    measure_misfit,
    read_dma,
)

BENCHMARK = Path(__file__).parents[1] / "benchmarks" / "dma.py"
SEEDS = range(20)


def benchmark():
    """Load the benchmark, which makes up the data."""
    spec = spec_from_file_location("dma_benchmark", BENCHMARK)
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


moduli_of, noisy, master_curve, largest_dip = attrgetter(
    "moduli_of", "noisy", "master_curve", "largest_dip"
)(benchmark())


def broad(frequency):
    """Storage and loss modulus of a broad transition from 2 GPa to 1 MPa."""
    law = FractionalStandardLinearSolid(2e9, 1e6, 1.0, 0.6, (1e-5, 100), 0.49)
    modulus = 1 / law.exact_complex_compliance(frequency)
    return modulus.real, modulus.imag


def measured(noise=0.0):
    """Return that transition over six decades."""
    frequency = np.geomspace(1e-2, 1e4, 25)
    return frequency, *noisy(broad(frequency), noise, 7)


# The fit


@pytest.mark.parametrize("ratio", [0.001, 0.5, 0.9])
@pytest.mark.parametrize("ends", [(-2, 2), (-0.5, 2), (-2, 0.5)])
def test_one_exact_term_is_found_with_its_long_term_modulus(ratio, ends):
    true = GeneralizedMaxwell(ratio * 1e9, [(1 - ratio) * 1e9], [0.0123], 0.4)
    frequency = np.logspace(*ends, 25) / (2 * pi * 0.0123)
    fit = GeneralizedMaxwell.from_dma(frequency, *moduli_of(true, frequency), 0.4)
    assert pytest.approx(true.E_inf, rel=1e-6) == fit.E_inf
    assert fit.moduli == pytest.approx(true.moduli, rel=1e-6)
    assert fit.relaxation_times == pytest.approx(true.relaxation_times, rel=1e-6)
    # At ten times the longest period that was measured: a liquid would creep on.
    late = 10 / frequency[0]
    creep = fit.creep_compliance(late)
    assert creep == pytest.approx(true.creep_compliance(late), rel=1e-6)
    assert fit.dma_misfit == pytest.approx((0, 0), abs=1e-6)


def test_terms_without_noise_are_found_one_by_one():
    true = GeneralizedMaxwell(1e6, [1e6, 5e7, 1e9], [1e-2, 1e-4, 1e-6], 0.5)
    frequency = np.geomspace(0.01, 1e7, 91)
    fit = GeneralizedMaxwell.from_dma(frequency, *moduli_of(true, frequency), 0.5)
    assert pytest.approx(1e6, rel=1e-4) == fit.E_inf
    assert fit.moduli == pytest.approx((1e9, 5e7, 1e6), rel=1e-3)
    assert fit.relaxation_times == pytest.approx((1e-6, 1e-4, 1e-2), rel=1e-3)


@pytest.mark.parametrize(("noise", "largest", "rms"), [(0.0, 0.01, 0.003), (0.02, 0.06, 0.025)])
def test_fit_of_a_broad_transition(noise, largest, rms):
    data = measured(noise)
    sample = GeneralizedMaxwell.from_dma(*data, 0.49)
    misfit = measure_misfit(sample, *data)
    assert misfit == sample.dma_misfit
    assert misfit[0] < largest
    assert misfit[1] < rms
    assert min(sample.moduli) > 0
    # The truth, not the noise, is what the fit should have found.
    assert measure_misfit(sample, *measured())[1] < max(rms, noise)


def test_fit_recovers_a_series_of_its_own_times():
    times = np.geomspace(0.1 / (2 * pi * 100), 10 / (2 * pi * 0.01), 13)
    moduli = np.where(np.arange(13) % 3, 1e6, 0)
    true = GeneralizedMaxwell(2e5, moduli, times, 0.4)
    frequency = np.geomspace(0.01, 100, 30)
    data = frequency, *moduli_of(true, frequency)
    fit = GeneralizedMaxwell.from_dma(*data, 0.4)
    assert measure_misfit(fit, *data)[0] < 2e-3


@pytest.mark.parametrize("seed", range(5))
def test_master_curves_whose_storage_dips_are_fitted(seed):
    data, truth = master_curve(seed)
    assert data[0].size == 206
    assert largest_dip(data) > 0.066
    fit = GeneralizedMaxwell.from_dma(*data, 0.45)
    assert fit.dma_misfit[0] < 0.1
    assert fit.dma_misfit[1] < np.hypot(0.03, 0.01)
    assert measure_misfit(fit, *truth)[1] < 0.025
    assert 10 < len(fit.moduli) < 2 * 14
    # Slow terms are nearer to the truth than its moduli were to the plateau.
    assert pytest.approx(2e6, rel=0.05) == fit.E_inf


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(
    ("moduli", "times", "decades"),
    [
        ([1e5], [1e-3], (-2, 2)),
        ([1e6, 5e7, 1e9], [1e-2, 1e-4, 1e-6], (-2, 4)),
        ([3e4] * 8, [10.0**k for k in range(-4, 4)], (-2, 2)),
    ],
    ids=["one term", "a rubber", "even losses"],
)
def test_plateaus_with_noise_have_a_long_term_modulus(moduli, times, decades, seed):
    true = GeneralizedMaxwell(1e6, moduli, times, 0.5)
    frequency = np.logspace(*decades, 10 * (decades[1] - decades[0]) + 1)
    truth = moduli_of(true, frequency)
    fit = GeneralizedMaxwell.from_dma(frequency, *noisy(truth, 0.02, seed), 0.5)
    # What relaxes later than 1/ω of the lowest frequency is part of the plateau.
    plateau = 1e6 + sum(m for m, t in zip(moduli, times, strict=True) if t > 1 / (2 * pi * 0.01))
    assert pytest.approx(plateau, rel=0.04) == fit.E_inf
    assert len(fit.moduli) <= min(len(moduli) + 1, 6)
    assert measure_misfit(fit, frequency, *truth)[1] < 0.015


@pytest.mark.parametrize("seed", SEEDS)
def test_a_liquid_stays_one(seed):
    true = GeneralizedMaxwell(0, [1e5, 1e6], [1.0, 0.01], 0.5)
    frequency = np.geomspace(1e-3, 1e2, 51)
    fit = GeneralizedMaxwell.from_dma(
        frequency, *noisy(moduli_of(true, frequency), 0.02, seed), 0.5
    )
    assert fit.E_inf == 0
    assert len(fit.moduli) == 2
    # φ = 1/η
    assert fit.compliance.fluidity == pytest.approx(true.compliance.fluidity, rel=0.02)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_glass_with_small_losses(seed):
    true = GeneralizedMaxwell(1e9, [5e7] * 12, 10.0 ** np.arange(-6, 6), 0.35)
    frequency = np.geomspace(0.1, 1e2, 31)
    truth = moduli_of(true, frequency)
    fit = GeneralizedMaxwell.from_dma(frequency, *noisy(truth, 0.02, seed), 0.35)
    assert measure_misfit(fit, frequency, *truth)[1] < 0.02
    assert fit.E_inf > 1e9
    # No fast term stiffens the glass beyond what its losses tell.
    assert fit.E_inf + sum(fit.moduli) < 1.2 * truth[0][-1]


def test_a_gel_in_a_liquid_that_resists_ever_more():
    # E' constant, E'' = ηω up to 600 E': the dashpot stands alone beside the spring.
    gel = KelvinVoigt(1e3, 1e-2, 0.5)
    frequency = np.geomspace(0.1, 1e4, 31)
    fit = GeneralizedMaxwell.from_dma(frequency, 1e3 * np.ones(31), 2 * pi * 10 * frequency, 0.5)
    assert fit.dma_misfit[0] < 0.05
    assert pytest.approx(1e3, rel=0.02) == fit.E_inf
    time = np.geomspace(1e-3, 1, 9)
    assert fit.creep_compliance(time) == pytest.approx(gel.creep_compliance(time), rel=0.02)


def test_more_terms_to_choose_from_never_fit_worse():
    data = measured(0.005)
    with pytest.warns(sa.AccuracyWarning, match="^the sample differs from the measured moduli"):
        least = GeneralizedMaxwell.from_dma(*data, 0.49, 0.5)
    one, two, ten = (GeneralizedMaxwell.from_dma(*data, 0.49, count) for count in (1, 2, 10))
    assert len(least.moduli) < len(one.moduli) < len(two.moduli) <= len(ten.moduli)
    assert least.dma_misfit[1] > 2 * one.dma_misfit[1] > 2 * ten.dma_misfit[1]
    assert ten.dma_misfit[1] < 1.1 * two.dma_misfit[1]


def test_order_does_not_matter_and_repeats_count_twice():
    frequency, storage, loss = measured(0.01)
    fit = GeneralizedMaxwell.from_dma(frequency, storage, loss, 0.49)
    falling = GeneralizedMaxwell.from_dma(frequency[::-1], storage[::-1], loss[::-1], 0.49)
    assert falling == fit
    assert falling.dma_misfit == fit.dma_misfit
    twice = [np.concatenate([each, each[::-1]]) for each in (frequency, storage, loss)]
    assert measure_misfit(fit, *twice) == pytest.approx(fit.dma_misfit, rel=1e-12)
    again = GeneralizedMaxwell.from_dma(*twice, 0.49)
    assert again.storage_modulus(frequency) == pytest.approx(
        fit.storage_modulus(frequency), rel=0.02
    )


# How well it fits


@pytest.fixture
def poor():
    """Data of which one point is wrong by 30 %, and none is systematically so."""
    frequency, storage, loss = measured(0.03)
    storage[12] *= 0.7
    return frequency, storage, loss


def test_a_poor_fit_warns_where_and_by_how_much(poor):
    with pytest.warns(
        sa.AccuracyWarning, match=r"^the sample differs from .* in the storage of "
    ) as told:
        sample = GeneralizedMaxwell.from_dma(*poor, 0.49)
    text = str(told[0].message)
    assert told[0].filename == __file__
    assert f"at {poor[0][12]:.4g} Hz" in text
    assert f"by up to {100 * sample.dma_misfit[0]:.2g} %" in text
    assert 0.2 < sample.dma_misfit[0] < 0.5


def test_the_misfit_stays_with_the_sample():
    sample = GeneralizedMaxwell.from_dma(*measured(0.02), 0.49)
    assert pickle.loads(pickle.dumps(sample)).dma_misfit == sample.dma_misfit
    assert sample.dma_misfit[0] > sample.dma_misfit[1] > 0.01
    stated = GeneralizedMaxwell(sample.E_inf, sample.moduli, sample.relaxation_times, 0.49)
    assert stated == sample
    assert stated.dma_misfit is None


TABLE = "frequency (Hz),storage (MPa),loss (MPa)\n" + "\n".join(
    f"{f:.9g},{s / 1e6:.9g},{x / 1e6:.9g}" for f, s, x in zip(*measured(0.02), strict=True)
)
EXPERIMENT = """mode = "force-distance"

[tip]
shape = "paraboloid"
radius = "1 um"

[sample]
model = "measured-moduli"
file = "dma.csv"
poisson = 0.49

[surface]
law = "repulsion"
pressure_at_zero = "1 MPa"
decay = "1 nm"

[motion]
start = "10 nm"
turn = "-5 nm"
speed = "1 um/s"
"""


@pytest.fixture
def experiment(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "250")
    (tmp_path / "dma.csv").write_text(TABLE)
    (tmp_path / "rubber.toml").write_text(EXPERIMENT)
    return tmp_path


def test_info_run_and_result_state_the_misfit(experiment, softafm):
    sample = GeneralizedMaxwell.from_dma(*read_dma("dma.csv"), 0.49)
    largest, rms = sample.dma_misfit
    row = re.compile(
        rf"fit off by +{100 * largest:.2g} % .*at most; {100 * rms:.2g} % root mean square"
    )
    for command in ("info", "run"):
        code, out, err = softafm(command, "rubber.toml")
        assert (code, err) == (0, "")
        assert row.search(out)
    result = sa.load("rubber.nc")
    assert result.attrs["dma_misfit_largest"] == pytest.approx(largest, rel=1e-9)
    assert result.attrs["dma_misfit_rms"] == pytest.approx(rms, rel=1e-9)
    assert json.loads(result.attrs["experiment"])["sample"]["E_inf"] == sample.E_inf


def test_the_command_line_warns_of_a_poor_fit_in_one_line(experiment, softafm, poor):
    rows = (f"{f:.9g},{s:.9g},{x:.9g}" for f, s, x in zip(*poor, strict=True))
    (experiment / "dma.csv").write_text(
        "frequency (Hz),storage (Pa),loss (Pa)\n" + "\n".join(rows) + "\n"
    )
    for command in ("info", "run"):
        code, _, err = softafm(command, "rubber.toml")
        assert code == 0
        assert err.count("\n") == 1
        assert err.startswith("softafm: warning: the sample differs from the measured moduli by ")


def test_every_run_of_a_sweep_tells_of_a_poor_fit(experiment, poor):
    frequency, storage, loss = poor
    rows = (f"{f:.9g},{s:.9g},{x:.9g}" for f, s, x in zip(frequency, storage, loss, strict=True))
    (experiment / "dma.csv").write_text(
        "frequency (Hz),storage (Pa),loss (Pa)\n" + "\n".join(rows) + "\n"
    )
    with pytest.warns(sa.AccuracyWarning, match="^the sample differs from the measured moduli "):
        found = sa.sweep("rubber.toml", {"motion.speed": ["1 um/s", "2 um/s", "3 um/s"]}, workers=0)
    told = [str(text) for text in found["warning"].values]
    assert len(told) == 3
    assert all("differs from the measured moduli" in text for text in told)


def test_maps_state_the_misfit_of_each_material():
    fitted = GeneralizedMaxwell.from_dma(*measured(0.02), 0.49)
    law = sa.Repulsion(pressure_at_zero=1e6, decay=1e-9)
    contacts = [
        sa.Contact(sa.Paraboloid(1e-6), sample, law) for sample in (fitted, sa.Elastic(1e9, 0.3))
    ]
    ramp = sa.Triangle(start=10e-9, turn=-1e-9, speed=1e-6)
    image = sa.scan(sa.SampleMap(contacts, 20e-9, labels=[[0, 1]]), sa.ForceVolume(ramp))
    assert "dma_misfit_rms" not in image.attrs
    first, second = json.loads(image.attrs["experiment"])["materials"].values()
    assert (first["dma_misfit_largest"], first["dma_misfit_rms"]) == fitted.dma_misfit
    assert "dma_misfit_rms" not in second


def test_files_with_ratios_that_leave_no_modulus_are_warned_of(experiment, softafm):
    text = (experiment / "rubber.toml").read_text()
    table = 'model = "generalized-maxwell"\nE0 = "1 GPa"\nratios = [0.4, 0.6]\n'
    table += 'relaxation_times = ["1 ms", "1 s"]'
    text = text.replace('model = "measured-moduli"\nfile = "dma.csv"', table)
    (experiment / "ratios.toml").write_text(text)
    code, out, err = softafm("info", "ratios.toml")
    assert code == 0
    assert "flow without end" in out
    assert err.startswith(
        "softafm: warning: ratios add up to 1, which leaves E_inf = 0 Pa, a liquid"
    )
    assert err.count("\n") == 1


# Refusals


def changed(column, index, value):
    data = [list(map(float, values)) for values in measured()]
    data[column][index] = value
    return data


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (changed(0, 3, -1.0), r"^frequency\[3\] = -1 Hz: must be finite and greater than 0$"),
        (changed(1, 0, 0.0), r"^storage\[0\] = 0 Pa: must be finite and greater than 0$"),
        (changed(2, 5, nan), r"^loss\[5\] = nan Pa: must be finite and greater than 0$"),
        (changed(2, 5, -3e5), r"^loss\[5\] = -300000 Pa: must be finite and greater than 0$"),
        (
            changed(0, 12, 1e-2),
            r"^storage is 1\.112e\+06 and 8\.067e\+06 Pa at one frequency, 0\.01 Hz: must be ",
        ),
        (
            changed(1, 24, 1e8),
            r"^storage = .* Pa at .* Hz: no linear passive solid has this beside the other moduli, "
            r"the closest has .*: the storage falls by 70 % from 5623 to 1e\+04 Hz, but can only ",
        ),
        ([[1, 2], [1, 2], [1]], "^loss has 1 entries: must have as many as frequency, 2$"),
        ([[1, 2], "soft", [1, 2]], "^storage = 'soft': must be numbers in Pa$"),
        ([[3, 3], [1, 1], [1, 1]], "^frequency is from 3 to 3 Hz: must vary, and over at most 30 "),
        ([[1e-9, 1e22], [1, 2], [1, 1]], r"^frequency is from 1e-09 to 1e\+22 Hz: must vary, and "),
        ([[3], [1], [1]], r"^frequency has shape \(1,\): must be a list of 2 to 2000 numbers$"),
    ],
)
def test_data_that_are_no_moduli_are_refused(data, message):
    with pytest.raises(ValueError, match=message) as refused:
        GeneralizedMaxwell.from_dma(*data, 0.4)
    assert "\n" not in str(refused.value)


def test_terms_a_decade_are_limited():
    with pytest.raises(ValueError, match=r"^per_decade = 0 times: must be between 0\.5 and 10$"):
        GeneralizedMaxwell.from_dma(*measured(), 0.5, 0)


@pytest.mark.parametrize("noise", [0.001, 0.02, 0.05])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_storage_that_falls_over_a_decade_is_refused(noise, seed):
    frequency = np.geomspace(0.01, 100, 41)
    share = np.clip(np.log10(frequency / 0.3), 0, 1)
    data = noisy((1e6 * 0.75**share, 2e4 * np.ones(41)), noise, seed)
    with pytest.raises(
        ValueError, match=r"no linear passive solid .*: the storage falls by "
    ) as no:
        GeneralizedMaxwell.from_dma(frequency, *data, 0.5)
    first, last = map(float, re.findall(r"from (\S+) to (\S+) Hz, but", str(no.value))[0])
    assert first < 1 < last


@pytest.mark.parametrize("factor", [0.4, 2.5, 1000])
@pytest.mark.parametrize("seed", SEEDS)
def test_losses_that_do_not_follow_from_the_storage_are_refused(factor, seed):
    true = GeneralizedMaxwell(1e6, [1e6, 5e7, 1e9], [1e-2, 1e-4, 1e-6], 0.5)
    frequency = np.geomspace(0.01, 1e4, 61)
    storage, loss = noisy(moduli_of(true, frequency), 0.02, seed)
    with pytest.raises(ValueError, match=r"no linear passive solid has .* \(Kramers and Kronig\)$"):
        GeneralizedMaxwell.from_dma(frequency, storage, factor * loss, 0.5)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(
    "true",
    [
        GeneralizedMaxwell(1e6, [1e5], [1e-3], 0.5),
        GeneralizedMaxwell(1e6, [1e6, 5e7, 1e9], [1e-2, 1e-4, 1e-6], 0.5),
        GeneralizedMaxwell(1e9, [5e7] * 12, 10.0 ** np.arange(-6, 6), 0.35),
        Maxwell(1e6, 1.0, 0.5),
    ],
    ids=["plateau", "rubber", "glass", "liquid"],
)
def test_noise_alone_is_never_refused(true, seed):
    frequency = np.geomspace(0.01, 1e3, 31)
    data = noisy(moduli_of(true, frequency), 0.1, seed)
    with pytest.warns(sa.AccuracyWarning, match="^the sample differs from the measured moduli"):
        fit = GeneralizedMaxwell.from_dma(frequency, *data, 0.5)
    assert fit.dma_misfit[1] < 0.14
    assert measure_misfit(fit, frequency, *moduli_of(true, frequency))[1] < 0.12


# Files


def test_moduli_from_a_file(tmp_path):
    frequency, storage, loss = measured()
    rows = zip(frequency, storage / 1e6, loss / 1e3, strict=True)
    lines = ["temperature (C), Frequency (Hz),storage (MPa),loss (kPa)"]
    lines += [f"25,{f:.17g},{s:.17g},{x:.17g}" for f, s, x in rows]
    path = tmp_path / "dma.csv"
    path.write_text("\n".join([*lines, "", ""]))
    for read, written in zip(read_dma(path), (frequency, storage, loss), strict=True):
        assert read == pytest.approx(written, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty; its header must read, for example, 'frequency "),
        ("frequency,storage (MPa),loss (MPa)\n", "column 'frequency' has no unit"),
        ("frequency (Hz),storage (nm),loss (MPa)\n", "must name a unit of a modulus"),
        ("frequency (Hz),storage (Pa),loss (Pa)\n1,2\n", "line 2 .* has no 'loss'"),
        (
            "frequency (Hz),storage (Pa),loss (Pa)\n1,2,x\n",
            "line 2 .* 'loss' must be a finite number",
        ),
        ("frequency (Hz),storage (Pa),loss (Pa)\n1,2,3\n", "must be a list of 2 to 2000 "),
        ("frequency (Hz),storage (Pa),loss (Pa)\n1,2,3\n2,2,-3\n", r"^loss\[1\] = -3 Pa: must be"),
    ],
)
def test_bad_files_are_refused(tmp_path, text, message):
    path = tmp_path / "dma.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=message) as refused:
        read_dma(path)
    assert "\n" not in str(refused.value)


def test_figure_of_a_fit_shows_the_data():
    data = measured(0.02)
    figure = plot_rheology(GeneralizedMaxwell.from_dma(*data, 0.49), data=data)
    points = [line for line in figure.axes[1].lines if line.get_linestyle() == "None"]
    assert [line.get_xdata().size for line in points] == [25, 25]
    assert points[0].get_ydata() == pytest.approx(data[1] / 1e6)


# Tables as instruments and papers give them

RUBBER = GeneralizedMaxwell(1e6, [1e6, 5e6], [1e-2, 1e-4], 0.4)
HERTZ = np.geomspace(0.1, 1e3, 21)
STORAGE, LOSS = moduli_of(RUBBER, HERTZ)
RADIANS, MEGA, TANGENT = 2 * pi * HERTZ, 1e-6, LOSS / STORAGE
MAGNITUDE, PHASE = np.hypot(STORAGE, LOSS), np.arctan2(LOSS, STORAGE)
SHEAR = 1 / (2 * 1.4)


def table(header, *columns, separator=","):
    rows = zip(*columns, strict=True)
    lines = (separator.join(f"{number:.12g}" for number in row) for row in rows)
    return "\n".join([header, *lines, ""])


@pytest.mark.parametrize(
    "text",
    [
        table("Frequency (Hz),Storage modulus (MPa),Loss modulus (MPa)", HERTZ, STORAGE * MEGA,
              LOSS * MEGA),
        table("f (Hz),E' (Pa),E'' (Pa)", HERTZ, STORAGE, LOSS),
        table("f [kHz];E′ [MPa];E″ [kPa]", HERTZ / 1e3, STORAGE * MEGA, LOSS / 1e3, separator=";"),
        table('f / Hz\tE\' / Pa\tE" / Pa', HERTZ, STORAGE, LOSS, separator="\t"),
        table("freq,storage,loss\nHz,MPa,MPa", HERTZ, STORAGE * MEGA, LOSS * MEGA),
        table("frequency (rad/s),storage (Pa),loss (Pa)", RADIANS, STORAGE, LOSS),
        table("Angular frequency (rad/s),E' (Pa),E'' (Pa)", RADIANS, STORAGE, LOSS),
        table("omega (1/s),E' (Pa),E'' (Pa)", RADIANS, STORAGE, LOSS),
        table("ω,E',tan δ\nrad/s,Pa,1", RADIANS, STORAGE, TANGENT),
        table("f (Hz),E'' (Pa),tan(delta)", HERTZ, LOSS, TANGENT),
        table("f (Hz),Loss factor (-),|E*| (Pa)", HERTZ, TANGENT, MAGNITUDE),
        table("f (Hz),Complex modulus (Pa),Phase angle (deg)", HERTZ, MAGNITUDE, np.degrees(PHASE)),
        table("f (Hz),|E*| (Pa),δ (rad)", HERTZ, MAGNITUDE, PHASE),
        table("f (Hz),E* (Pa),delta (°)", HERTZ, MAGNITUDE, np.degrees(PHASE)),
        table("f (Hz),omega (rad/s),E' (Pa),E'' (Pa),|eta*| (Pa s)", HERTZ, RADIANS, STORAGE, LOSS,
              MAGNITUDE / RADIANS),
        table("f (Hz),E' (Pa),E'' (Pa)", HERTZ[::-1], STORAGE[::-1], LOSS[::-1]),
    ],
)  # fmt: skip
def test_tables_that_mean_one_thing_are_read(tmp_path, text):
    path = tmp_path / "dma.csv"
    path.write_text(text, encoding="utf-8")
    for read, true in zip(read_dma(path), (HERTZ, STORAGE, LOSS), strict=True):
        np.testing.assert_allclose(read, true, rtol=1e-10)


@pytest.mark.parametrize(
    "text",
    [
        table("f (Hz),G' (Pa),G'' (Pa)", HERTZ, SHEAR * STORAGE, SHEAR * LOSS),
        table("f (Hz),Shear storage modulus (Pa),Shear loss modulus (Pa)", HERTZ, SHEAR * STORAGE,
              SHEAR * LOSS),
        table("f (Hz),|G*| (Pa),δ (deg)", HERTZ, SHEAR * MAGNITUDE, np.degrees(PHASE)),
        table("f (Hz),G' (Pa),Loss modulus (Pa)", HERTZ, SHEAR * STORAGE, SHEAR * LOSS),
        # The complex modulus of a table in shear is not Young's.
        table("f (Hz),G' (Pa),G'' (Pa),Complex modulus (Pa),tan δ", HERTZ, SHEAR * STORAGE,
              SHEAR * LOSS, SHEAR * MAGNITUDE, TANGENT),
    ],
)  # fmt: skip
def test_shear_moduli_need_poissons_ratio(tmp_path, text):
    path = tmp_path / "dma.csv"
    path.write_text(text, encoding="utf-8")
    for read, true in zip(read_dma(path, poisson=0.4), (HERTZ, STORAGE, LOSS), strict=True):
        np.testing.assert_allclose(read, true, rtol=1e-10)
    with pytest.raises(ValueError, match=r"^holds shear moduli: needs poisson, Poisson's ratio"):
        read_dma(path)
    with pytest.raises(ValueError, match=r"^poisson = 0\.6: must be above -1 and at most 0\.5$"):
        read_dma(path, poisson=0.6)


def test_poissons_ratio_is_that_of_the_sample_in_files(experiment, softafm):
    text = table("f (Hz),G' (Pa),G'' (Pa)", HERTZ, SHEAR * STORAGE, SHEAR * LOSS)
    (experiment / "dma.csv").write_text(text)
    sample = load_experiment("rubber.toml", ["sample.poisson=0.4"]).contact.sample
    assert sample.storage_modulus(HERTZ) == pytest.approx(STORAGE, rel=1e-6)
    lines = write_python(
        parse_document((experiment / "rubber.toml").read_text(), "rubber.toml"), experiment
    )
    assert "*sa.read_dma('dma.csv', poisson=0.49)" in lines.replace('"', "'")


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (table("frequency (1/s),E' (Pa),E'' (Pa)", HERTZ, STORAGE, LOSS),
         "column 'frequency (1/s)' may be in Hz or in rad/s: write which of them"),
        (table("omega (Hz),E' (Pa),E'' (Pa)", HERTZ, STORAGE, LOSS),
         "column 'omega (Hz)' must name a unit of an angular frequency, not 'Hz'"),
        (table("f,E' (Pa),E'' (Pa)", HERTZ, STORAGE, LOSS), "column 'f' has no unit"),
        (table("T (K),E' (Pa),E'' (Pa)", HERTZ, STORAGE, LOSS), "has no column 'frequency'"),
        (table("f (Hz),E' (Pa),G'' (Pa)", HERTZ, STORAGE, LOSS),
         "has not two columns that belong together: it needs E' and E'', or G' and G'', or one"),
        (table("f (Hz),E' (Pa)", HERTZ, STORAGE), "has not two columns that belong together"),
        (table("f (Hz),tan δ", HERTZ, TANGENT), "has no column 'storage'"),
        (table("f (Hz),E' (Pa),δ", HERTZ, STORAGE, PHASE), "column 'δ' has no unit"),
        (table("f (Hz),E' (Pa),tan δ (%)", HERTZ, STORAGE, TANGENT),
         "column 'tan δ (%)' must have no unit, not '%'"),
        (table("f (Hz),|E*| (Pa),δ (rad)", HERTZ, STORAGE, np.degrees(PHASE)),
         "line 6 ('0.63095734448,1001569.98369,2.37635787134'): δ = 136.155 deg: must be above 0"),
        (table("f (Hz),E' (Pa),E'' (Pa),E\" (Pa)", HERTZ, STORAGE, LOSS, LOSS),
         "has more than one column 'E''"),
        # Two temperatures in one table.
        (table("T (C),f (Hz),E' (Pa),E'' (Pa)", [25] * 21 + [60] * 21, np.tile(HERTZ, 2),
               np.append(STORAGE, STORAGE / 2), np.append(LOSS, LOSS / 2)),
         "storage is "),
    ],
)  # fmt: skip
def test_tables_that_mean_two_things_are_refused(tmp_path, text, reason):
    path = tmp_path / "dma.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=f"^{re.escape(reason)}") as refused:
        read_dma(path, poisson=0.4)
    assert "\n" not in str(refused.value)
