"""Figure 5 of the paper: how many radial functions virial and dissipation need.

In the paper: virial V and dissipation E of a tap on polyethylene against n_b, the number of
functions less one, for setups C to G, and their errors against the "exact" solution of setup B
with 70 nodes. The errors stay below 1 % from n_b = 24 on in setup E; C and E need fewer functions
than D and F for V.

Here: the same, but errors are against the converged solution (default solver, tolerance 1e-4), so
that B has an error, too. As that tap crosses an elastic fold, which makes steps of fixed length
scatter, a second figure shows a tap on a stiffer sample without one. Runs that blow up are crosses
at the top.
"""

import common
import numpy as np

OBSERVABLES = {"virial": "virial V", "dissipation": "dissipation E"}
BASIS_SIZES = range(57)
NODES, STEPS = 70, 10_000
TAPS = {
    "fig5_functions": ("tap of the paper", "ldpe-tap-setpoint-0.8"),
    "fig5_functions_smooth": ("tap without a fold", "smooth-tap"),
}


def main(progress=None):
    """Run both studies."""
    jobs = [(name, "B", 0) for name in TAPS]
    jobs += [(name, letter, n_b) for name in TAPS for letter in "CDEFG" for n_b in BASIS_SIZES]
    cases = {name: common.tap_case(case) for name, (_, case) in TAPS.items()}
    converged = {n: common.converged_tap(c.contact, c.motion) for n, c in cases.items()}
    runs = {}
    for job in common.tracked(jobs, progress, lambda j: f"{TAPS[j[0]][0]}: setup {j[1]}"):
        name, letter, n_b = job
        size = {} if letter == "B" else {"functions": n_b + 1}
        solver = common.setup(letter, nodes=NODES, steps=STEPS, domain=common.DOMAIN, **size)
        runs[job] = common.tap(cases[name].contact, cases[name].motion, solver)
    for name, (title, _) in TAPS.items():
        report(
            name, title, {j[1:]: run for j, run in runs.items() if j[0] == name}, converged[name]
        )


def report(name, title, runs, converged):
    """Write, print and draw the study of one tap."""
    errors = {
        (letter, key): np.array([runs[letter, n].error(key, converged) for n in BASIS_SIZES])
        for letter in "CDEFG"
        for key in OBSERVABLES
    }
    common.write_csv(
        name,
        ("setup", "n_b", "virial_J", "dissipation_J", "virial_error_percent",
         "dissipation_error_percent", "ending", "warned"),
        ((letter, n_b, *(run.observables.get(key, np.nan) for key in OBSERVABLES),
          *(run.error(key, converged) for key in OBSERVABLES), run.ending, run.warned)
         for (letter, n_b), run in runs.items()),
    )  # fmt: skip
    exact = {key: runs["B", 0].error(key, converged) for key in OBSERVABLES}
    rows = [threshold_row(letter, limit, errors, exact) for letter in "CDEFG" for limit in (1, 2)]
    header = ("setup", "below", "V", "E", "both", "both*", "both, against B", "blown up at")
    common.report(
        f"{name}_thresholds",
        f"{title}: smallest n_b from which errors stay below a limit (* blow-ups left out); "
        f"B: {exact['virial']:+.2f} % in V, {exact['dissipation']:+.2f} % in E",
        header, rows,
    )  # fmt: skip
    common.save_figure(draw(title, runs, errors, exact, converged), name)


def threshold_row(letter, limit, errors, exact):
    """One row of the table of thresholds; a blow-up has an infinite error, or none if left out."""
    virial, dissipation = (np.abs(errors[letter, key]) for key in OBSERVABLES)
    worst = np.maximum(virial, dissipation)
    against_exact = np.maximum(*(np.abs(errors[letter, key] - exact[key]) for key in OBSERVABLES))
    lost = [n for n, error in zip(BASIS_SIZES, worst, strict=True) if np.isnan(error)]
    judged = [np.nan_to_num(e, nan=np.inf) for e in (virial, dissipation, worst)]
    judged += [np.nan_to_num(worst, nan=0.0), np.nan_to_num(against_exact, nan=np.inf)]
    return letter, f"{limit} %", *(settled(e, limit) for e in judged), " ".join(map(str, lost))


def settled(errors, limit):
    """Return the smallest n_b from which all errors are within the limit, or a dash."""
    outside = np.flatnonzero(errors > limit)
    first = outside[-1] + 1 if outside.size else 0
    return BASIS_SIZES[first] if first < len(BASIS_SIZES) else "-"


def draw(title, runs, errors, exact, converged):
    """Draw observables above and their errors below."""
    figure, axes = common.panels(2, 2, 6.8, sharex=True)
    figure.suptitle(f"{title[0].upper()}{title[1:]}: {NODES} nodes, {STEPS} steps", fontsize=11)
    for column, (key, label) in enumerate(OBSERVABLES.items()):
        limits = (0.85, 1.3) if key == "virial" else (0.6, 1.05)
        value, error = axes[column], axes[2 + column]
        for row, letter in enumerate("CDEFG"):
            values = [1e18 * runs[letter, n].observables.get(key, np.nan) for n in BASIS_SIZES]
            look = {"color": common.SETUP_COLOURS[letter], "linewidth": 1.2, "label": letter}
            value.plot(BASIS_SIZES, values, marker=".", markersize=4, **look)
            error.plot(BASIS_SIZES, np.abs(errors[letter, key]), marker=".", markersize=4, **look)
            lost = [n for n in BASIS_SIZES if not runs[letter, n].completed]
            error.plot(
                lost, [0.975 - 0.025 * row] * len(lost), "x", color=common.SETUP_COLOURS[letter],
                transform=error.get_xaxis_transform(),
            )  # fmt: skip
        value.axhline(1e18 * converged[key], color="black", linewidth=0.8)
        value.set_ylim(sorted(1e18 * converged[key] * part for part in limits))
        value.set_ylabel(f"{label} (aJ)")
        error.set_yscale("log")
        error.set_ylim(1e-3, 200)
        error.axhline(1, color="black", linestyle="--", linewidth=1)
        error.text(56, 1.1, "1 %", ha="right", va="bottom", fontsize=9)
        error.axhline(abs(exact[key]), color="black", linestyle=":", linewidth=1.2, label="B")
        error.set_ylabel(f"error of {label} (%)")
        error.set_xlabel("$n_b$ (functions less one)")
    axes[2].plot([], [], "x", color="0.4", markersize=4, label="blew up")
    axes[2].legend(ncols=3, frameon=False, fontsize=9)
    return figure


if __name__ == "__main__":
    main()
