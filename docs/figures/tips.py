"""The figure of docs/tips.md, and every number the page quotes.

Run as ``python docs/figures/tips.py``; it writes docs/images/tips-profiles.png.
"""

from math import radians
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from PIL import Image
from scipy.optimize import brentq

import softafm as sa
from softafm import indentation
from softafm.draw.style import COLOURS, tidy
from softafm.draw.tip import draw_profiles
from softafm.surfaces.repulsion import Repulsion
from softafm.tips import Cone, FlatPunch, Hyperboloid, Paraboloid, PowerLawTip, Sphere

R = 20e-9
MODULUS = 1e6
LIMITS = 0.01, 0.05, 0.1
PARABOLOID = Paraboloid(R)
TIPS = {
    "sphere": Sphere(R),
    "cone, 45°": Cone(radians(45), R),
    "hyperboloid, 45°": Hyperboloid(R, radians(45)),
    "flat punch, edge R/5": FlatPunch(R, 0.2 * R),
    "power law, n = 4": PowerLawTip(4.0, R / 2, R),
}
WIDEST_SPHERE = 0.985
IMAGE = Path(__file__).parents[1] / "images" / "tips-profiles.png"


def hertz_over(tip, contact_radius):
    """Force of the paraboloid of radius R over that of a tip, at the same depth."""
    depth = indentation.depth(tip, contact_radius)
    hertz = indentation.hertz_force(R, depth, MODULUS)
    return hertz / indentation.load(tip, contact_radius, MODULUS)


def print_limits(name, tip):
    """Print the contact radius and depth up to which the paraboloid is so far off."""
    for limit in LIMITS:

        def excess(ratio, limit=limit):
            return abs(hertz_over(tip, ratio * R) - 1) - limit

        ratios = np.linspace(0.05, 3, 300)
        first = next((x for x in ratios if excess(x) > 0), None)
        if first is None or (name == "sphere" and first > WIDEST_SPHERE):
            print(f"{name}: {100 * limit:.0f} % not reached")
            continue
        ratio = brentq(excess, max(first - 0.02, 1e-3), first)
        depth = float(indentation.depth(tip, ratio * R)) / R
        print(f"{name}: {100 * limit:.0f} % at a/R = {ratio:.3f}, depth/R = {depth:.3f}")


def print_solver(name, tip, depth):
    """Print the force of the solver over the closed form at the depth of the surface."""
    law = Repulsion(1e4 * MODULUS, depth / 500)
    contact = sa.Contact(tip, sa.Elastic(MODULUS, 0.0), law)
    curve = sa.force_distance(contact, sa.Triangle(0.05 * depth, -depth, 1e-6))
    at = int(curve.tip_height.values.argmin())
    deep = -float(curve.axis_deformation[at])
    closed = indentation.force(tip, deep, MODULUS)
    print(
        f"solver/closed form, {name}, depth/R {deep / R:.2f}: {curve.force.values[at] / closed:.4f}"
    )


def draw() -> Figure:
    """Profiles, force against depth, and that over the force of the paraboloid."""
    figure = Figure(figsize=(12.0, 4.3), dpi=120, layout="constrained")
    figure.get_layout_engine().set(wspace=0.05)
    profiles, forces, ratios = figure.subplots(1, 3)
    draw_profiles(profiles, list(TIPS.values()), 1.4 * R, list(TIPS))
    profiles.get_legend().remove()
    depth = R * np.geomspace(0.01, 3, 200)
    hertz = indentation.hertz_force(R, depth, MODULUS)
    dashed = {"color": "0.4", "dashes": (4, 2), "linewidth": 1}
    forces.plot(depth / R, hertz / (MODULUS * R**2), label="paraboloid, radius R", **dashed)
    ratios.axhline(1, **dashed)
    for colour, (name, tip) in zip(COLOURS, TIPS.items(), strict=False):
        force = indentation.force(tip, depth, MODULUS)
        if name == "sphere":
            force[indentation.contact_radius(tip, depth) > WIDEST_SPHERE * R] = np.nan
        forces.plot(depth / R, force / (MODULUS * R**2), color=colour, linewidth=1.5, label=name)
        ratios.plot(depth / R, force / hertz, color=colour, linewidth=1.5)
    forces.set_xlim(0, 1.5)
    forces.set_ylim(0, 3)
    forces.set_xlabel("Depth δ/R", fontsize=11)
    forces.set_ylabel("Force F/(E* R²)", fontsize=11)
    tidy(forces)
    ratios.set_xscale("log")
    ratios.set_xlim(0.01, 3)
    ratios.set_ylim(0.7, 1.4)
    ratios.set_xlabel("Depth δ/R", fontsize=11)
    ratios.set_ylabel("Force over that of the paraboloid", fontsize=11)
    ratios.tick_params(which="both", direction="in", top=True, right=True)
    ratios.xaxis.set_major_formatter("{x:g}")
    handles, _ = forces.get_legend_handles_labels()
    figure.legend(handles=handles, loc="outside lower center", ncols=6, frameon=False)
    return figure


def main():
    """Print the numbers and write the figure."""
    for name, tip in TIPS.items():
        if name in ("sphere", "cone, 45°", "hyperboloid, 45°"):
            print_limits(name, tip)
    for ratio in (0.1, 0.2, 0.3, 0.5, 0.7, 0.9):
        profile = float(Paraboloid(R).profile(ratio * R) / Sphere(R).profile(ratio * R)) - 1
        same_depth = hertz_over(TIPS["sphere"], ratio * R) - 1
        depth = float(indentation.depth(TIPS["sphere"], ratio * R)) / R
        print(
            f"sphere a/R {ratio}: depth/R {depth:.3f}, height {100 * profile:.2f} %, "
            f"force at the same depth {100 * same_depth:.2f} %"
        )
    for name, tip, depth in (
        ("sphere", TIPS["sphere"], 0.55 * R),
        ("cone, 45°", TIPS["cone, 45°"], R),
        ("hyperboloid, 45°", TIPS["hyperboloid, 45°"], R),
        ("flat punch", TIPS["flat punch, edge R/5"], 0.4 * R),
        ("power law", TIPS["power law, n = 4"], 0.4 * R),
    ):
        print_solver(name, tip, depth)
    figure = draw()
    figure.savefig(IMAGE)
    with Image.open(IMAGE) as picture:
        small = picture.convert("RGB").quantize(64)
    small.save(IMAGE, optimize=True)
    print(f"{IMAGE.name}: {IMAGE.stat().st_size // 1024} kB")


if __name__ == "__main__":
    main()
