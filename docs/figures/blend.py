"""Draw the blend of docs/maps.md, tapped at two setpoints, and print the numbers quoted there.

python docs/figures/blend.py [FOLDER] [--pixels N] [--workers N]
"""

import argparse
from pathlib import Path
from time import perf_counter

from PIL import Image

import softafm as sa
from softafm.maps.map_file import load_map

IMAGES = Path(__file__).parents[1] / "images"
BLEND = Path(sa.__file__).parent / "examples" / "maps" / "blend.toml"
SETPOINTS = (0.9, 0.5)


def main():
    """Scan, print, draw."""
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", nargs="?", type=Path, default=IMAGES)
    parser.add_argument("--pixels", type=int, default=128)
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    pixels = f"map.pixels=[{given.pixels}, {given.pixels}]"
    started = perf_counter()
    maps = [load_map(BLEND, [pixels, f"motion.setpoint={each}"]) for each in SETPOINTS]
    images = [each.run(given.workers) for each in maps]
    seconds = perf_counter() - started
    different = images[0].attrs["different_pixels"]
    print(f"{given.pixels}² pixels, {different} different, two setpoints: {seconds:.0f} s")
    modulus = maps[0].sample.fields["sample.E_inf"]
    for setpoint, image in zip(SETPOINTS, images, strict=True):
        for name, where in (("PS", modulus == modulus.max()), ("LDPE", modulus == modulus.min())):
            means = {key: float(image[key].values[where].mean()) for key in
                    ("topography", "phase", "dissipation", "force_max", "indentation")}  # fmt: skip
            print(
                f"{setpoint:g} {name:5s} height {1e9 * means['topography']:.2f} nm, "
                f"phase {means['phase']:.1f}°, dissipation {1e18 * means['dissipation']:.2f} aJ, "
                f"force {1e9 * means['force_max']:.2f} nN, "
                f"indentation {1e9 * means['indentation']:.2f} nm, "
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
