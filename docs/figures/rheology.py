"""The figures of docs/samples.md, and every number that the page quotes."""

from pathlib import Path
from time import perf_counter

import numpy as np
from PIL import Image

from softafm.draw.sample import plot_rheology
from softafm.rheology import (
    FractionalStandardLinearSolid,
    GeneralizedMaxwell,
    PowerLaw,
    chain_to_prony,
    measure_misfit,
    prony_to_chain,
)

IMAGES = Path(__file__).parents[1] / "images"


def measured(noise: float = 0.02) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Synthetic moduli of a broad glass transition, with noise."""
    frequency = np.geomspace(1e-2, 1e4, 25)
    law = FractionalStandardLinearSolid(2e9, 1e6, 1.0, 0.6, (1e-5, 100), 0.49)
    modulus = 1 / law.exact_complex_compliance(frequency)
    rng = np.random.default_rng(7)
    storage, loss = (
        part * (1 + noise * rng.standard_normal(25)) for part in (modulus.real, modulus.imag)
    )
    return frequency, storage, loss


def interconversion() -> None:
    """Print how well series of 20 and 40 terms return, and how long a conversion takes."""
    rng = np.random.default_rng(0)
    for terms, decades in ((20, 12), (40, 12), (20, 1)):
        worst, fastest = 0.0, np.inf
        for _ in range(300):
            times = np.sort(10.0 ** rng.uniform(0, decades, terms))
            moduli = 10.0 ** rng.uniform(6, 9, terms)
            start = perf_counter()
            chain = prony_to_chain(1e6, moduli, times)
            fastest = min(fastest, perf_counter() - start)
            back = chain_to_prony(*chain)[1]
            worst = max(worst, float(np.max(np.abs(back / moduli - 1))))
        print(f"{terms} terms, {decades} decades: {worst:.1e}, {1e3 * fastest:.2f} ms")


def represented() -> None:
    """Print how many modes power laws and fractional solids take, and how close they are."""
    print("decades, error: modes of power laws with a = 0.1, 0.3, 0.5, 0.8 (achieved)")
    for decades in (3, 6, 9):
        for error in (0.05, 0.01, 0.001):
            laws = [
                PowerLaw(1e6, a, (10.0**-decades, 1), 0.5, error=error)
                for a in (0.1, 0.3, 0.5, 0.8)
            ]
            shown = (f"{law.element_count} ({law.represented_error:.2g})" for law in laws)
            print(f"{decades}, {error:g}:", ", ".join(shown))
    for a in (0.3, 0.5, 0.8):
        solid = FractionalStandardLinearSolid(1e9, 1e7, 1e-3, a, (1e-6, 1), 0.5)
        print(f"fractional solid, a = {a}: {solid.element_count} ({solid.represented_error:.2g})")
    for a in (0.3, 0.5, 0.8, 0.9):
        law = PowerLaw(1e6, a, (1e-6, 1), 0.5)
        time = np.geomspace(1e-5, 0.1, 400)
        off = np.max(np.abs(law.relaxation_modulus(time) * time**a / 1e6 - 1))
        print(f"relaxation modulus, a decade within the window, a = {a}: {100 * off:.2g} %")
    start = perf_counter()
    PowerLaw(1e6, 0.31, (1e-6, 1), 0.5).element_count  # noqa: B018
    print(f"time to represent: {perf_counter() - start:.2g} s")


def fit() -> None:
    """Print the misfit to synthetic data and draw it."""
    data = measured()
    sample = GeneralizedMaxwell.from_dma(*data, poisson=0.49)
    largest, rms = measure_misfit(sample, *data)
    print(f"fit: {len(sample.moduli)} terms, misfit {100 * largest:.2g} %, rms {100 * rms:.2g} %")
    print(f"off the noiseless moduli: rms {100 * measure_misfit(sample, *measured(0))[1]:.2g} %")
    path = IMAGES / "rheology-fit.png"
    plot_rheology(sample, data=data).savefig(path, dpi=120)
    Image.open(path).convert("RGB").quantize(64).save(path, optimize=True)
    print(path, path.stat().st_size // 1000, "kB")


if __name__ == "__main__":
    interconversion()
    represented()
    fit()
