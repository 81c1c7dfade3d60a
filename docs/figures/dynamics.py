"""Draw the figure of levers with inertia in docs/afm.md, and print every number quoted there.

python docs/figures/dynamics.py
"""

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

import softafm as sa

CONTACT = sa.Contact(
    sa.Paraboloid(50e-9),
    sa.StandardLinearSolid(E0=4.25e9, E_inf=1.89e9, creep_time=1e-7, poisson=0.35),
    sa.LennardJones(2e-20, 0.15e-9),
)
LEVER, DRIVE, HEIGHT = sa.Cantilever(28.1, 429.5, 278e3), sa.Drive(278e3, 15e-9), 8.491192e-9
OUT = Path(__file__).parents[1] / "images" / "transient.png"


def settle_after(amplitude, part):
    """Return the cycle after which an amplitude stays within a part of its last value."""
    return int(np.flatnonzero(np.abs(amplitude / amplitude[-1] - 1) > part)[-1]) + 1


def draw(runs):
    panels = ("amplitude", 1e9, "Amplitude (nm)"), ("phase", 1, "Phase (°)")
    panels = (*panels, ("force_max", 1e9, "Largest force (nN)"))
    figure, axes = plt.subplots(1, 3, figsize=(9.6, 3.2), dpi=150, layout="constrained")
    for (name, run), colour in zip(runs.items(), ("C0", "C1"), strict=True):
        for ax, (quantity, factor, _) in zip(axes, panels, strict=True):
            shown = factor * run[quantity].values.reshape(run.sizes["cycle"], -1)[:600, 0]
            ax.plot(np.arange(1, shown.size + 1), shown, color=colour, label=name)
    for ax, (*_, title) in zip(axes, panels, strict=True):
        ax.set(xlabel="Cycle", ylabel=title)
    axes[2].set_yscale("log")
    axes[2].set_ylim(1, 400)
    axes[0].legend(frameon=False)
    figure.savefig(OUT)


def draw_peak_force(swung):
    """The last period: force and deflection against time, apparent force against the base."""
    figure, axes = plt.subplots(1, 3, figsize=(9.6, 3.2), dpi=150, layout="constrained")
    last = swung.time.values > 2 / 2e3
    time, base = 1e6 * (swung.time.values[last] - 2 / 2e3), 1e9 * swung.base_height.values[last]
    force, bent = 1e9 * swung.force.values[last], 1e9 * swung.deflection.values[last]
    axes[0].plot(time, force)
    axes[1].plot(time, bent)
    axes[2].plot(base, 1e9 * swung.apparent_force.values[last], label="apparent")
    axes[2].plot(base, force, label="true")
    axes[0].set(xlabel="Time (µs)", ylabel="Force (nN)", xlim=(210, 300))
    axes[1].set(xlabel="Time (µs)", ylabel="Deflection (nm)", xlim=(210, 450))
    axes[2].set(xlabel="Base height (nm)", ylabel="Force (nN)", xlim=(-7, 15))
    axes[2].legend(frameon=False)
    figure.savefig(OUT.with_name("peak-force.png"))


def main():
    runs = {
        name: sa.tapping_transient(CONTACT, LEVER, DRIVE, HEIGHT, start=start)
        for name, start in (("from rest", "rest"), ("swinging", "swinging"))
    }
    for name, run in runs.items():
        amplitude = run.amplitude.values[:, 0]
        print(
            f"{name}: A/A0 {amplitude[-1] / 15e-9:.5f}, phase {float(run.phase[-1, 0]):.3f}°, "
            f"within 1 % after {settle_after(amplitude, 1e-2)} cycles and 0.1 % after "
            f"{settle_after(amplitude, 1e-3)}; largest force of all {run.force_max.max():.3g} N, "
            f"of the last {run.force_max[-1]:.3g} N; E {run.dissipation[-1]:.4g} J, "
            f"second harmonic {run.harmonic_amplitude[-1, 1]:.3g} m, "
            f"mean deflection {run.mean_deflection[-1]:.3g} m"
        )
    last = runs["from rest"].isel(cycle=-1)
    curve = sa.approach_curve(CONTACT, LEVER, 15e-9, [float(last.amplitude[0]) / 15e-9])
    sine = curve.sel(branch="repulsive").isel(amplitude_ratio=0)
    print(
        f"single sine at this amplitude: phase {float(sine.phase - last.phase[0]):.3f}° more, "
        f"E {float(sine.dissipation / last.dissipation) - 1:.2%} more, "
        f"Z {float(sine.mean_height) - HEIGHT:.3g} m more than the base"
    )
    taken = float(last.viscous_loss + last.jump_loss)
    print(f"E over what the sample takes: {float(last.dissipation) / taken - 1:.2%}")
    modes = [sa.Eigenmode(1124, 1.743e6, 600)]
    lever = sa.Cantilever(28.1, 429.5, 278e3, modes)
    two = [DRIVE, sa.Drive(1.743e6, 0.5e-9)]
    bimodal = sa.tapping_transient(CONTACT, lever, two, HEIGHT).isel(cycle=slice(-50, None))
    bimodal = bimodal.mean("cycle")
    print(
        f"bimodal: amplitudes {bimodal.amplitude.values} m, phases {bimodal.phase.values}°, "
        f"E {float(bimodal.dissipation):.4g} J, force_max {float(bimodal.force_max):.4g} N"
    )
    draw(runs)
    swung = sa.peak_force_tapping(
        CONTACT, sa.Cantilever(4.0, 100, 150e3), 100e-9, 2e3, peak_force=20e-9
    )
    draw_peak_force(swung)
    last = swung.isel(cycle=-1)
    after = swung.time.values > float(swung.time[-1]) - 0.22e-3
    print(
        f"peak force {float(last.force_max):.4g} N at Z = {float(swung.mean_height):.4g} m: base "
        f"{float(last.drive_work):.4g} J, contact {float(last.dissipation):.4g} J (sample "
        f"{float(last.viscous_loss + last.jump_loss):.4g} J), lever {float(last.damping):.4g} J, "
        f"rings by {np.abs(swung.deflection.values[after]).max():.3g} m"
    )


if __name__ == "__main__":
    main()
