"""Draw the figures of docs/known-answers.md and print the numbers that it quotes beside tables.

python docs/figures/known_answers.py [OUTPUT FOLDER]
"""

import json
import sys
from math import pi
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import softafm as sa
from softafm import indentation
from softafm.draw.style import COLOURS

KNOWN = Path(__file__).parents[2] / "tests" / "data" / "known_answers.json"


def draw_dents(folder: Path) -> None:
    """Draw dents at three speeds beside Ting."""
    contact = sa.Contact(
        tip=sa.Paraboloid(radius=1e-6),
        sample=sa.StandardLinearSolid(E0=10e6, E_inf=1e6, creep_time=10e-3, poisson=0.5),
        surface=sa.Repulsion(pressure_at_zero=1e9, decay=0.5e-9),
    )
    speeds = {"1 µm/s": 1e-6, "10 µm/s": 1e-5, "100 µm/s": 1e-4}
    runs = [sa.force_distance(contact, sa.Triangle(20e-9, -100e-9, v)) for v in speeds.values()]
    sa.plot(runs, labels=list(speeds), reference="ting").savefig(folder / "known-ting.png")


def draw_pull_off(folder: Path) -> None:
    """Draw pull-off against speed and against dwell, beside the independent solver."""
    rubber = json.loads(KNOWN.read_text(encoding="utf-8"))["rubber"]
    names = "E0", "E_inf", "creep_time", "poisson"
    sample = sa.StandardLinearSolid(*(rubber[name] for name in names))
    law = sa.LennardJones.from_work_of_adhesion(rubber["work_of_adhesion"], rubber["z0"])
    contact = sa.Contact(sa.Paraboloid(rubber["radius"]), sample, law)
    unit = pi * rubber["radius"] * rubber["work_of_adhesion"]

    def pull(speed: float, dwell: float = 0.0) -> float:
        motion = sa.Triangle(rubber["start"], rubber["turn"], speed, dwell=dwell)
        return -float(sa.force_distance(contact, motion).force_min) / unit

    figure = Figure(figsize=(9.6, 4.0), dpi=150, layout="constrained")
    left, right = figure.subplots(1, 2)
    speeds = np.geomspace(1e-8, 1, 65)
    left.semilogx(1e6 * speeds, [pull(v) for v in speeds], color=COLOURS[0], label="softafm")
    known = 1e6 * np.array(rubber["speed"]["value"]), rubber["speed"]["pull_off"]
    left.plot(*known, "ko", label="independent solver")
    dwells = np.geomspace(1e-5, 1, 41)
    right.semilogx(1e3 * dwells, [pull(1e-2, dwell) for dwell in dwells], color=COLOURS[0])
    shown = rubber["dwell"]["value"][1:], rubber["dwell"]["pull_off"][1:]
    right.plot(1e3 * np.array(shown[0]), shown[1], "ko")
    left.set(xlabel="Speed (µm/s)", ylabel="Pull-off force over πRW")
    right.set(xlabel="Dwell (ms), at 10 mm/s", ylabel="Pull-off force over πRW")
    for ax in (left, right):
        ax.axhline(1.5, color="0.6", linestyle=":", label="JKR")
        ax.tick_params(direction="in", which="both", top=True, right=True)
    left.legend(frameon=False)
    figure.savefig(folder / "known-pull-off.png")


def print_quoted() -> None:
    """Print what a page that quotes Ting, JKR and Maugis may quote."""
    solid = sa.PowerLaw(E1=1e6, exponent=0.2, window=(1e-6, 1.0), poisson=0.5)
    motion = sa.Triangle(1e-9, -100e-9, 1e-6)
    curve = indentation.ting(sa.Paraboloid(1e-6), solid, motion)
    print(f"power law of 0.2: contact ends at {curve.depth[-1] / 100e-9:.4f} of the depth")
    tip, modulus, W = sa.Paraboloid(1e-6), 1e6 / 0.75, 0.05
    for stiffness in (0.0, 0.1, 10.0, np.inf):
        parting = indentation.jkr_parting(tip, modulus, W, stiffness)
        print(f"JKR, {stiffness:g} N/m: parts at {parting.force / (pi * 1e-6 * W):.4f} πRW")


def main() -> None:
    """Draw and print all."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "images"
    draw_dents(folder)
    draw_pull_off(folder)
    print_quoted()


if __name__ == "__main__":
    main()
