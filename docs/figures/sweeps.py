"""Pictures of two campaigns: pull-off against speed, phase and dissipation against a sample.

Prints how long they took and the numbers that docs/sweeps.md quotes.

python docs/figures/sweeps.py
"""

from pathlib import Path
from time import perf_counter

import numpy as np
from matplotlib.figure import Figure

import softafm as sa

ROOT = Path(__file__).parents[2]
CAMPAIGNS, IMAGES = ROOT / "examples" / "campaigns", ROOT / "docs" / "images"


def swept(name):
    """Run a campaign, and print how long that took."""
    started = perf_counter()
    found = sa.sweep(CAMPAIGNS / f"{name}.toml").load()
    failed = int((found["state"] == 2).sum())
    warned = int((found["warning"] != "").sum())
    seconds = perf_counter() - started
    print(f"{name}: {found['state'].size} runs, {failed} failed, {warned} warned, {seconds:.0f} s")
    return found


def pull_off():
    found = swept("pull-off-against-speed")
    speed, adhesion = found["speed"].values, -1e9 * found["force_min"].values
    figure = Figure(figsize=(6, 4), layout="constrained")
    ax = figure.subplots()
    ax.plot(1e6 * speed, adhesion, "o-", color="#0072b2", markersize=4)
    jkr = 1.5 * np.pi * 1e-6 * 0.05 * 1e9
    ax.axhline(jkr, color="0.6", linewidth=1)
    ax.text(1.2e-2, jkr, "JKR", va="bottom", color="0.4")
    ax.set(
        xscale="log", xlabel="Speed (µm/s)", ylabel="Pull-off force (nN)", ylim=(0, None)
    )  # fmt: skip
    figure.savefig(IMAGES / "sweep-pull-off.png", dpi=120)
    for index in (0, int(adhesion.argmax()), -1):
        print(f"  {1e6 * speed[index]:.3g} µm/s: {adhesion[index]:.0f} nN")


def heat_maps():
    found = swept("phase-and-dissipation").isel(amplitude_ratio=0)
    figure = Figure(figsize=(10, 4), layout="constrained")
    for ax, name, factor, title in zip(
        figure.subplots(1, 2), ("phase", "dissipation"), (1, 1e18),
        ("Phase lag (°)", "Dissipation (aJ a cycle)"), strict=True,
    ):  # fmt: skip
        repulsive, attractive = (found[name].sel(branch=b) for b in ("repulsive", "attractive"))
        values = factor * repulsive.fillna(attractive)
        drawn = ax.pcolormesh(
            1e6 * found["creep_time"], 1e-9 * found["E_inf"], values.T, shading="nearest"
        )
        figure.colorbar(drawn, ax=ax, label=title)
        ax.set(
            xscale="log", yscale="log", xlabel="Creep time (µs)", ylabel="Long-term modulus (GPa)"
        )  # fmt: skip
        print(f"  {name}: {float(values.min()):.3g} to {float(values.max()):.3g}")
    figure.savefig(IMAGES / "sweep-phase.png", dpi=120)


if __name__ == "__main__":
    pull_off()
    heat_maps()
