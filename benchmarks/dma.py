"""Fits of measured moduli: what they find of a known truth, what they cost and what is refused.

python benchmarks/dma.py
python benchmarks/dma.py FILE ...    # and fits files whose lines begin with ω (rad/s), G', G'' (Pa)
"""

import sys
import warnings
from pathlib import Path
from time import perf_counter

import numpy as np
from rich.console import Console
from rich.table import Table

import softafm as sa
from softafm.rheology import (
    FractionalStandardLinearSolid,
    GeneralizedMaxwell,
    Maxwell,
    measure_misfit,
)

SEEDS = range(20)
RUBBER = GeneralizedMaxwell(1e6, [1e6, 5e7, 1e9], [1e-2, 1e-4, 1e-6], 0.5)
CASES = {
    "plateau, one term": (GeneralizedMaxwell(1e6, [1e5], [1e-3], 0.5), (-2, 2)),
    "rubber, three terms": (RUBBER, (-2, 4)),
    "rubber, losses spread evenly": (
        GeneralizedMaxwell(1e6, [3e4] * 8, 10.0 ** np.arange(-4, 4), 0.5), (-2, 2)
    ),
    "glass": (GeneralizedMaxwell(1e9, [5e7] * 12, 10.0 ** np.arange(-6, 6), 0.35), (-1, 2)),
    "liquid, two terms": (GeneralizedMaxwell(0, [1e5, 1e6], [1.0, 0.01], 0.5), (-3, 2)),
    "liquid, one term": (Maxwell(1e6, 1.0, 0.5), (-2, 2)),
}  # fmt: skip
"""Samples, and the decades of frequency (Hz) in which they are measured."""


def moduli_of(sample, frequency: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return storage and loss modulus, Pa."""
    return sample.storage_modulus(frequency), sample.loss_modulus(frequency)


def noisy(moduli, noise: float, seed: int) -> tuple[np.ndarray, ...]:
    """Return moduli with relative, normally distributed noise."""
    rng = np.random.default_rng(seed)
    return tuple(each * np.exp(noise * rng.standard_normal(each.size)) for each in moduli)


def master_curve(seed: int) -> tuple[tuple, tuple]:
    """Return 206 points over 14 decades, and the truth: ten sweeps, not quite shifted onto it.

    Every other sweep is 3 % too high, the rest 3 % too low, as by clamping or temperature; all
    points have noise of 1 %.
    """
    sweeps = [np.geomspace(1, 100, 21) * 10.0**shift for shift in np.linspace(-7, 5, 10)]
    frequency = np.concatenate(sweeps)[:206]
    law = FractionalStandardLinearSolid(3e9, 2e6, 1.0, 0.35, (1e-12, 1e9), 0.45)
    modulus = 1 / law.exact_complex_compliance(frequency)
    factors = np.repeat(1 + 0.03 * (-1.0) ** np.arange(len(sweeps)), 21)[:206]
    data = noisy((factors * modulus.real, factors * modulus.imag), 0.01, seed)
    return (frequency, *data), (frequency, modulus.real, modulus.imag)


def largest_dip(data: tuple) -> float:
    """Return the largest share by which the storage lies below that of a lower frequency."""
    storage = data[1][np.argsort(data[0])]
    return float(np.max(1 - storage / np.maximum.accumulate(storage)))


def show_exact(console: Console) -> None:
    """Print what is found of one term without noise."""
    table = Table("E_inf/E0", "error of E_inf", "of the creep after ten of the longest periods")
    for ratio in (0.001, 0.5, 0.9):
        true = GeneralizedMaxwell(ratio * 1e9, [(1 - ratio) * 1e9], [0.0123], 0.4)
        frequency = np.logspace(-2, 2, 25) / (2 * np.pi * 0.0123)
        fit = GeneralizedMaxwell.from_dma(frequency, *moduli_of(true, frequency), 0.4)
        late = 10 / frequency[0]
        creep = fit.creep_compliance(late) / true.creep_compliance(late)
        table.add_row(f"{ratio:g}", f"{fit.E_inf / true.E_inf - 1:.0e}", f"{creep - 1:.0e}")
    console.print(table)


def show_noisy(console: Console) -> None:
    """Print what is found beneath noise of 2 %."""
    names = (
        "2 % of noise, 20 seeds",
        "terms",
        "E_inf",
        "largest misfit",
        "rms",
        "rms off the truth",
    )
    table = Table(*names)
    for name, (true, decades) in CASES.items():
        frequency = np.logspace(*decades, 10 * (decades[1] - decades[0]) + 1)
        truth = moduli_of(true, frequency)
        fits = [
            GeneralizedMaxwell.from_dma(frequency, *noisy(truth, 0.02, seed), 0.5) for seed in SEEDS
        ]
        table.add_row(name, *_found(fits, [(frequency, *truth)] * len(fits)))
    curves = [master_curve(seed) for seed in SEEDS]
    fits = [GeneralizedMaxwell.from_dma(*data, 0.45) for data, _ in curves]
    dips = [largest_dip(data) for data, _ in curves]
    name = f"206 points, dips of {100 * min(dips):.1f} to {100 * max(dips):.1f} %"
    table.add_row(name, *_found(fits, [truth for _, truth in curves]))
    console.print(table)


def _found(fits: list, truths: list) -> list[str]:
    counts, plateaus = [len(fit.moduli) for fit in fits], [fit.E_inf / 1e6 for fit in fits]
    largest, rms = np.array([fit.dma_misfit for fit in fits]).T
    off = [measure_misfit(fit, *truth)[1] for fit, truth in zip(fits, truths, strict=True)]
    return [
        f"{min(counts)} to {max(counts)}",
        f"{min(plateaus):.4g} to {max(plateaus):.4g} MPa",
        *(f"at most {100 * max(each):.2g} %" for each in (largest, rms, off)),
    ]


def refused(frequency, storage, loss) -> bool:
    """Return whether moduli are refused; whatever is warned of is not."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sa.AccuracyWarning)
        try:
            GeneralizedMaxwell.from_dma(frequency, storage, loss, 0.5)
        except ValueError:
            return True
    return False


def show_refused(console: Console) -> None:
    """Print how many of 20 are refused, of what no solid has and of what one has."""
    table = Table("refused of 20", "noise 0.1 %", "2 %", "5 %", "10 %", "20 %")
    frequency = np.geomspace(0.01, 100, 41)
    fall = np.clip(np.log10(frequency / 0.3), 0, 1)
    wide = np.geomspace(0.01, 1e4, 61)
    storage, loss = moduli_of(RUBBER, wide)
    kinds = {
        f"storage falls by {100 * (1 - low):.0f} % over a decade": (
            frequency, 1e6 * low**fall, np.full(41, 2e4)
        )
        for low in (0.9, 0.8, 0.7, 0.5)
    } | {
        "losses of a rubber times 2": (wide, storage, 2 * loss),
        "losses of a rubber times 0.4": (wide, storage, 0.4 * loss),
        "storage and loss exchanged": (wide, loss, storage),
    }  # fmt: skip
    kinds |= {
        f"{name}: none should be": (each, *moduli_of(true, each))
        for name, (true, decades) in CASES.items()
        for each in [np.logspace(*decades, 10 * (decades[1] - decades[0]) + 1)]
    }
    for name, (each, *moduli) in kinds.items():
        counts = [
            sum(refused(each, *noisy(moduli, noise, seed)) for seed in SEEDS)
            for noise in (0.001, 0.02, 0.05, 0.1, 0.2)
        ]
        table.add_row(name, *map(str, counts))
    console.print(table)


def show_files(console: Console, paths: list[Path]) -> None:
    """Print how measured master curves are fitted; lines of other than numbers are left out."""
    table = Table("file", "points", "decades", "dip", "terms", "largest misfit", "rms", "time")
    for path in paths:
        data = np.array(_numbers(path))
        data = data[(data > 0).all(axis=1)]
        moduli = data[:, 0] / (2 * np.pi), 3 * data[:, 1], 3 * data[:, 2]
        start = perf_counter()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", sa.AccuracyWarning)
            try:
                fit = GeneralizedMaxwell.from_dma(*moduli, 0.5)
            except ValueError as error:
                table.add_row(path.name, str(len(data)), "", "", "refused")
                console.print(f"{path.name}: {error}")
                continue
        table.add_row(
            path.name,
            str(len(data)),
            f"{np.log10(data[:, 0].max() / data[:, 0].min()):.1f}",
            f"{100 * largest_dip(moduli):.1f} %",
            str(len(fit.moduli)),
            *(f"{100 * each:.2g} %" for each in fit.dma_misfit),
            f"{perf_counter() - start:.2f} s",
        )
    console.print(table)


def _numbers(path: Path) -> list[list[float]]:
    rows = []
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        try:
            rows.append([float(word) for word in line.split()[:3]])
        except ValueError:
            continue
    return [row for row in rows if len(row) == 3]


def main(arguments: list[str] | None = None) -> None:
    console = Console(width=140)
    show_exact(console)
    show_noisy(console)
    show_refused(console)
    (data, _), start = master_curve(100), perf_counter()
    GeneralizedMaxwell.from_dma(*data, 0.45)
    console.print(f"time of a fit to 206 points: {perf_counter() - start:.2g} s")
    if paths := sys.argv[1:] if arguments is None else arguments:
        show_files(console, [Path(each) for each in paths])


if __name__ == "__main__":
    main()
