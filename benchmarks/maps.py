"""Time a pixel of maps, and what their pixels are off from approach curves of their own.

Tapping at a setpoint, every pixel with properties of its own, on one core; and a map of labels.

    python benchmarks/maps.py [PIXELS ALONG A SIDE]
"""

import sys
from time import perf_counter

import common
import numpy as np

import softafm as sa

TIP = sa.Paraboloid(10e-9)
PS = sa.Contact(TIP, sa.samples.polystyrene(), sa.LennardJones(2e-20, 0.15e-9))
LDPE = sa.Contact(TIP, sa.samples.ldpe(), sa.LennardJones(1e-19, 0.25e-9))
LEVER = sa.Cantilever(stiffness=28.1, quality_factor=429.5, frequency=278e3)
COMPARED = 12


def samples(side: int) -> dict[str, sa.SampleMap]:
    """A blend of every mixing ratio, four random fields, and two materials side by side."""
    random = np.random.default_rng(3)
    x = np.linspace(0, 2 * np.pi, side)
    waves = np.sin(2 * x)[:, None] * np.cos(3 * x) + 0.01 * random.random((side, side))

    def spread(value, by):
        return value * (1 + by * random.random((side, side)))

    fields = {
        "sample.E0": spread(4e9, 0.2),
        "sample.E_inf": spread(1.5e9, 0.5),
        "sample.creep_time": spread(1e-7, 1.0),
        "surface.hamaker": spread(2e-20, 1.0),
    }
    return {
        "blend": sa.SampleMap.mixed(1 / (1 + np.exp(-4 * waves)), PS, LDPE, 1e-6),
        "random fields": sa.SampleMap(PS, 1e-6, fields),
        "two labels": sa.SampleMap([PS, LDPE], 1e-6, labels=waves > 0),
    }


def misses(sample: sa.SampleMap, image, imaging) -> str:
    """Largest differences of some pixels from their approach curves, as text."""
    random, worst = np.random.default_rng(0), np.zeros(3)
    for _ in range(COMPARED):
        i, j = (int(random.integers(n)) for n in sample.shape)
        contact = sample.pixels.contacts[sample.pixels.number[i, j]]
        curve = sa.approach_curve(contact, LEVER, imaging.free_amplitude, [imaging.setpoint])
        pixel, curve = image.isel(y=i, x=j), curve.isel(amplitude_ratio=0)
        off = np.abs(curve["mean_height"].values - float(pixel["mean_height"]))
        found = curve.isel(branch=int(np.nanargmin(off)))
        worst = np.maximum(worst, [
            np.nanmin(off), abs(float(pixel["phase"] - found["phase"])),
            abs(float(pixel["dissipation"] / found["dissipation"]) - 1),
        ])  # fmt: skip
    return f"Z {1e12 * worst[0]:.1f} pm, phase {worst[1]:.2f}°, E {100 * worst[2]:.2f} %"


def rows(side: int):
    """One row a map."""
    for name, sample in samples(side).items():
        for free, setpoint in ((20e-9, 0.9), (20e-9, 0.5), (40e-9, 0.7)):
            imaging = sa.AmplitudeModulation(LEVER, free, setpoint)
            started = perf_counter()
            image = sa.scan(sample, imaging)
            milliseconds = 1e3 * (perf_counter() - started) / side**2
            yield (
                name, f"{1e9 * free:g} nm", f"{setpoint:g}", image.attrs["different_pixels"],
                f"{milliseconds:.2f}", f"{image.attrs['solver_taps'] / side**2:.2f}",
                misses(sample, image, imaging),
            )  # fmt: skip


def main():
    side = int(sys.argv[1]) if len(sys.argv) > 1 else 64
    common.timed(lambda: sa.approach_curve(PS, LEVER, 20e-9, [0.9]), at_least=0.0)
    headings = {
        "map": "left", "free": "right", "setpoint": "right", "different": "right",
        "ms a pixel": "right", "taps a pixel": "right", "largest difference": "left",
    }  # fmt: skip
    common.show(f"Maps of {side} x {side} pixels, tapping", headings, rows(side))


if __name__ == "__main__":
    main()
