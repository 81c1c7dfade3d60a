"""Draw the figure of docs/soft.md and print every number that it quotes.

python docs/figures/soft.py [OUTPUT FOLDER]
"""

import json
import sys
import warnings
from math import nan, pi, sqrt
from pathlib import Path
from time import perf_counter

import numpy as np
from matplotlib import pyplot as plt
from scipy.integrate import quad

import softafm as sa

W, RADIUS, SPEED = 0.05, 5e-6, 1e-6
E_INF, STIFFER = 2e6, 10.0
NUMBERS = (1, 2, 3, 5, 8, 12, 20, 50, 100, 200, 402)
"""Tabor numbers; the last is that of the contact as it is."""
FEWER = NUMBERS[:7]
FIXED, SCALED = (0.003, 0.03, 0.3), (0.03, 7.6)
"""Speeds v τ/ℓ: those at a Tabor number of 8, and those kept at all numbers."""
RAMP = sa.Triangle(start=1.2e-6, turn=-0.3e-6, speed=SPEED)
ELASTIC = sa.Contact(
    sa.Paraboloid(RADIUS),
    sa.Elastic(E_INF, poisson=0.5),
    sa.LennardJones.from_work_of_adhesion(W, 0.3e-9),
)


def jkr_loop() -> float:
    """Work that a JKR contact costs which forms at h0 = 0 and parts at its last stable shape, J."""
    E = 1 / ELASTIC.body.compliance.relaxed

    def height(a):
        return sqrt(2 * pi * a * W / E) - a**2 / RADIUS

    def integrand(a):
        force = 4 * E * a**3 / (3 * RADIUS) - sqrt(8 * pi * W * E * a**3)
        return -force * (sqrt(pi * W / (2 * E * a)) - 2 * a / RADIUS)

    first, last = (2 * pi * W * RADIUS**2 / E) ** (1 / 3), (pi * W * RADIUS**2 / (8 * E)) ** (1 / 3)
    assert abs(height(first)) < 1e-12
    return quad(integrand, first, last)[0]


def pulled(contact, tabor: float) -> tuple[float, float, float]:
    """Pull-off over πRW and loop energy, J, of the regularised contact; seconds of the run."""
    started = perf_counter()
    curve = sa.force_distance(contact, RAMP, regularise=tabor, tolerance=3e-3)
    seconds = perf_counter() - started
    balanced = json.loads(curve.attrs["audit"])["passed"]
    loop = float(curve.loop_energy) if balanced else nan
    return -float(curve.force_min) / (pi * RADIUS * W), loop, seconds


def slow(creep_time: float):
    """The contact with a sample that starts ten times as stiff."""
    sample = sa.StandardLinearSolid(STIFFER * E_INF, E_INF, creep_time, poisson=0.5)
    return sa.Contact(ELASTIC.tip, sample, ELASTIC.surface)


def length(tabor: float) -> float:
    """Cohesive length of the relaxed contact of a Tabor number, m."""
    return ELASTIC.regularised(tabor).cohesive_length


def series(name: str, creep_time, numbers=NUMBERS) -> np.ndarray:
    """Pull-off and loop energy over the numbers; ``creep_time`` is a function of the number.

    A loop whose energy does not balance is left out.
    """
    rows = []
    for tabor in numbers:
        time = creep_time(tabor)
        contact = ELASTIC if time == 0 else slow(time)
        pull, loop, seconds = pulled(contact, tabor)
        rate = SPEED * time / length(tabor)
        print(
            f"{name:22s} μ {tabor:3d}  vτ/ℓ {rate:8.2g}  pull-off {pull:.4f} πRW  "
            f"loop {1e15 * loop:7.2f} fJ  {seconds:6.2f} s",
            flush=True,
        )
        rows.append((pull, loop))
    return np.array(rows).T


def draw(curves, folder: Path):
    """Draw pull-off and loop energy over the numbers."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained")
    colours = iter(plt.get_cmap("viridis")(np.linspace(0.1, 0.85, len(FIXED))))
    other = iter(("tab:red", "tab:orange"))
    for name, kind, (pull, loop) in curves:
        style = {
            "elastic": {"color": "black", "marker": "o"},
            "fixed": {"marker": "s"},
            "scaled": {"marker": "^", "linestyle": "--"},
        }[kind]
        if kind != "elastic":
            style["color"] = next(colours if kind == "fixed" else other)
        numbers = NUMBERS[: len(pull)]
        axes[0].plot(numbers, pull, label=name, markersize=4, **style)
        axes[1].plot(numbers, 1e15 * loop, label=name, markersize=4, **style)
    axes[0].axhline(1.5, color="grey", linestyle=":", label="JKR")
    axes[1].axhline(1e15 * jkr_loop(), color="grey", linestyle=":", label="JKR")
    axes[0].set(ylabel="pull-off force over πRW", ylim=(1, None))
    axes[1].set(ylabel="loop energy, fJ", yscale="log")
    for panel in axes:
        panel.set(xlabel="Tabor number of the regularised contact", xscale="log")
        panel.set_xticks(NUMBERS, [str(number) for number in NUMBERS])
        panel.minorticks_off()
    axes[0].legend(frameon=False, fontsize=8)
    figure.savefig(folder / "soft-limit.png", dpi=150)
    plt.close(figure)


def main():
    """Run all series, print them and draw them."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "images"
    warnings.simplefilter("ignore", sa.AccuracyWarning)  # what fails its audit is left out
    pulled(ELASTIC, 1)  # compiles
    print(f"Tabor number of the contact as it is: {ELASTIC.tabor_relaxed:.3g}")
    print(f"its range times {ELASTIC.tabor_relaxed / 8:.3g} at 8: {length(8):.3g} m long ℓ")
    print(f"JKR: pull-off 1.5 πRW, loop {1e15 * jkr_loop():.2f} fJ")
    curves = [("elastic", "elastic", series("elastic", lambda tabor: 0.0))]
    for rate in FIXED:
        time = rate * length(8) / SPEED
        name = f"τ = {1e3 * time:.3g} ms"
        curves.append((name, "fixed", series(name, lambda tabor, time=time: time)))
        print(f"  vτ/ℓ of the contact as it is: {SPEED * time / ELASTIC.cohesive_length:.3g}")
    for rate in SCALED:
        name = f"vτ/ℓ = {rate:g}"
        found = series(name, lambda tabor, rate=rate: rate * length(tabor) / SPEED, FEWER)
        curves.append((name, "scaled", found))
    draw(curves, folder)
    for tabor in (20, 100, 402):
        for tolerance in (1e-2, 1e-3):
            curve = sa.force_distance(ELASTIC, RAMP, regularise=tabor, tolerance=tolerance)
            loop, jumps = float(curve.loop_energy), float(curve.jump_energy.sum())
            pull = -float(curve.force_min) / (pi * RADIUS * W)
            print(
                f"elastic, μ {tabor}, tolerance {tolerance:g}: pull-off {pull:.5f} πRW, "
                f"loop {1e15 * loop:.2f} fJ, jumps {1e15 * jumps:.2f} fJ"
            )


if __name__ == "__main__":
    main()
