"""The figure of docs/surfaces.md, and every number that the page quotes."""

from pathlib import Path

from PIL import Image

import softafm as sa
from softafm import surfaces
from softafm.draw.law import plot_surface

IMAGES = Path(__file__).parents[1] / "images"
W, z0 = 0.05, 0.3e-9
CONTACT = sa.Paraboloid(radius=20e-9), sa.Elastic(E=1e9, poisson=0.3)


def laws() -> dict[str, surfaces.SurfaceLaw]:
    """One law of each kind, all with the same work of adhesion and equilibrium gap."""
    lennard_jones = surfaces.LennardJones.from_work_of_adhesion(W, z0)
    return {
        "LennardJones": lennard_jones,
        "VanDerWaals, n = 15": surfaces.VanDerWaals.from_work_of_adhesion(W, z0, exponent=15),
        "DMT": surfaces.DMT.from_work_of_adhesion(W, z0),
        "Exponential": surfaces.Exponential(W, z0, decay=0.3e-9, core=0.05e-9),
        "Morse": surfaces.Morse(W, z0, decay=0.15e-9),
        "Dugdale": surfaces.Dugdale(W, z0, tension=100e6),
    }


def main() -> None:
    """Print the table and the accuracy of a sampled law; draw."""
    for name, law in laws().items():
        contact = sa.Contact(*CONTACT, law)
        columns = (
            name,
            f"{1e-6 * law.largest_tension:.0f}",
            f"{1e9 * law.gap_of_largest_tension:.3f}",
            f"{1e9 * law.range:.3f}",
            f"{law.sharpness:.2f}",
            f"{contact.tabor_relaxed:.2f}",
            f"{1e9 * contact.cohesive_length:.1f}",
        )
        print("| " + " | ".join(columns) + " |")
    exact = laws()["LennardJones"]
    for points in (50, 100, 400, 1600):
        table = surfaces.Tabulated.from_function(exact.pressure, 0.15e-9, 10e-9, points)
        print(
            f"Tabulated, {points} points: W off by "
            f"{table.work_of_adhesion / exact.work_of_adhesion - 1:.1e}, range by "
            f"{table.range / exact.range - 1:.1e}"
        )
    figure = plot_surface(list(laws().values()), list(laws()), largest_gap=1.3e-9)
    path = IMAGES / "surfaces-laws.png"
    figure.savefig(path)
    Image.open(path).convert("RGB").quantize(64).save(path, optimize=True)
    print(path, path.stat().st_size // 1000, "kB")


if __name__ == "__main__":
    main()
