"""The figure of the named samples in docs/samples.md, and every number quoted of them."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

from softafm import samples
from softafm.draw.style import COLOURS

IMAGE = Path(__file__).parents[1] / "images" / "named-samples.png"
TIMES = 1e-9, 1e-6, 1e-3, 1.0


def three_digits(pascal: float) -> str:
    """Write a modulus with a prefix."""
    for unit, name in ((1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa")):
        if pascal >= unit:
            return f"{pascal / unit:.3g} {name}"
    return f"{pascal:.3g} Pa"


def main():
    """Print moduli at some times and draw all relaxation moduli."""
    figure = Figure(figsize=(7.2, 3.9), dpi=120, layout="constrained")
    ax = figure.subplots()
    time = np.geomspace(1e-11, 1e6, 500)
    for colour, (name, build) in zip(COLOURS, samples.NAMED.items(), strict=False):
        sample = build()
        moduli = [three_digits(float(sample.relaxation_modulus(t))) for t in TIMES]
        print(f"| `{name}` | " + " | ".join(moduli) + f" | {sample.poisson:g} |")
        ax.loglog(time, sample.relaxation_modulus(time), color=colour, linewidth=1.8, label=name)
    ax.set_xlim(time[0], time[-1])
    ax.set_ylim(1e4, 1e10)
    ax.set_xlabel("Time (s)", fontsize=11)
    ax.set_ylabel("Relaxation modulus E(t) (Pa)", fontsize=11)
    ax.tick_params(which="both", direction="in", top=True, right=True)
    ax.legend(frameon=False, fontsize=9)
    figure.savefig(IMAGE)
    with Image.open(IMAGE) as picture:
        small = picture.convert("RGB").quantize(64)
    small.save(IMAGE, optimize=True)
    print(IMAGE.name, IMAGE.stat().st_size // 1000, "kB")


if __name__ == "__main__":
    main()
