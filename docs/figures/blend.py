"""Draw the blend of docs/maps.md, tapped at two setpoints, and print the numbers quoted there.

python docs/figures/blend.py [FOLDER] [--pixels N] [--workers N]
"""

import argparse
from pathlib import Path
from time import perf_counter

import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter

import softafm as sa

IMAGES = Path(__file__).parents[1] / "images"
SETPOINTS = (0.9, 0.5)
SIZE, DOMAIN, INTERPHASE = 600e-9, 45e-9, 20e-9
TIP = sa.Paraboloid(10e-9)
POLYSTYRENE = sa.Contact(TIP, sa.samples.polystyrene(), sa.LennardJones(2e-20, 0.15e-9))
LDPE = sa.Contact(TIP, sa.samples.ldpe(), sa.LennardJones(1e-19, 0.25e-9))
LEVER = sa.Cantilever(stiffness=28.1, quality_factor=429.5, frequency=278e3)
FREE_AMPLITUDE = 20e-9


def share_of_ldpe(pixels: int) -> np.ndarray:
    """Share of polyethylene: domains cut from waves of random directions, with an interphase."""
    pixel = SIZE / pixels
    # A sum of waves, so that domains are the same however fine the pixels are.
    random, field = np.random.default_rng(8), np.zeros((pixels, pixels))
    x = (np.arange(pixels) + 0.5) * pixel
    for _ in range(200):
        angle, phase = 2 * np.pi * random.random(2)
        k = np.pi / DOMAIN * random.uniform(0.5, 1.3)
        field += np.cos(k * (np.cos(angle) * x + np.sin(angle) * x[:, None]) + phase)
    domains = (field > 0.35 * field.std()).astype(float)
    share = gaussian_filter(domains, INTERPHASE / 4 / pixel, mode="nearest")
    return np.clip(1.1 * share - 0.05, 0, 1)


def scanned(pixels: int, workers: int):
    """Images of the flat blend at both setpoints."""
    blend = sa.SampleMap.mixed(share_of_ldpe(pixels), POLYSTYRENE, LDPE, SIZE)
    return blend, [
        sa.scan(blend, sa.AmplitudeModulation(LEVER, FREE_AMPLITUDE, setpoint), workers=workers)
        for setpoint in SETPOINTS
    ]


def main():
    """Scan, print, draw."""
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", nargs="?", type=Path, default=IMAGES)
    parser.add_argument("--pixels", type=int, default=128)
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    started = perf_counter()
    blend, images = scanned(given.pixels, given.workers)
    seconds = perf_counter() - started
    different = len(blend.pixels.contacts)
    print(f"{given.pixels}² pixels, {different} different, two setpoints: {seconds:.0f} s")
    polyethylene = blend.fields["sample.E_inf"] == LDPE.sample.E_inf
    polystyrene = blend.fields["sample.E_inf"] == POLYSTYRENE.sample.E_inf
    for setpoint, image in zip(SETPOINTS, images, strict=True):
        for name, where in (("PS", polystyrene), ("LDPE", polyethylene)):
            told = {key: float(image[key].values[where].mean()) for key in
                    ("topography", "phase", "dissipation", "force_max", "indentation")}  # fmt: skip
            print(
                f"{setpoint:g} {name:5s} height {1e9 * told['topography']:.2f} nm, "
                f"phase {told['phase']:.1f}°, dissipation {1e18 * told['dissipation']:.2f} aJ, "
                f"force {1e9 * told['force_max']:.2f} nN, "
                f"indentation {1e9 * told['indentation']:.2f} nm, "
                f"repulsive {float(image['branch'].values[where].mean()):.2f}"
            )
        print(f"{setpoint:g} taps {image.attrs['solver_taps']}", image.attrs["warnings"])
    figure = sa.plot_map(images, labels=[f"setpoint {each:g}" for each in SETPOINTS])
    target = given.folder / "blend.png"
    figure.savefig(target)
    with Image.open(target) as picture:
        small = picture.convert("RGB").quantize(256)
    small.save(target, optimize=True)
    print(target.name, target.stat().st_size // 1000, "kB")


if __name__ == "__main__":
    main()
