"""Run the two bundled experiments, print their observables and draw their pictures.

python examples/demo.py [--out FOLDER]
"""

import argparse
import time
from importlib.resources import as_file, files
from pathlib import Path

import xarray as xr
from rich.console import Console
from rich.table import Table

from softafm.draw.results import plot
from softafm.experiment.config import load_experiment
from softafm.units.quantities import write_quantity

SPEEDS = ("5 um/s", "2 um/s", "1 um/s")
OBSERVABLES = ("force_max", "force_min", "loop_energy", "virial", "dissipation")


def run_example(name: str, *overrides: str) -> tuple[xr.Dataset, float]:
    """Run a bundled experiment; return its result and the seconds it took."""
    with as_file(files("softafm") / "examples" / f"{name}.toml") as path:
        experiment = load_experiment(path, overrides)
    start = time.perf_counter()
    result = experiment.run()
    return result, time.perf_counter() - start


def table_of(runs: dict[str, tuple[xr.Dataset, float]]) -> Table:
    """Observables of each run with units, its elastic jumps and the time it took."""
    table = Table("", title="What the instrument would report", title_justify="left")
    for name in runs:
        table.add_column(name, justify="right")
    for key in OBSERVABLES:
        cells = [
            write_quantity(float(run[key]), run[key].units) if key in run else "-"
            for run, _ in runs.values()
        ]
        table.add_row(key.replace("_", " "), *cells)
    table.add_row("elastic jumps", *(str(run.sizes["jump"]) for run, _ in runs.values()))
    table.add_row("time taken", *(write_quantity(seconds, "s") for _, seconds in runs.values()))
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description="Run the bundled experiments and draw them.")
    parser.add_argument("--out", type=Path, default=Path("demo-output"), help="folder of pictures")
    out: Path = parser.parse_args().out
    console = Console()

    run_example("ldpe-tapping")  # loads the compiled solver, so that the times below are its own
    triangles = {
        speed.replace("um", "µm"): run_example("attard-triangle", f"motion.speed={speed}")
        for speed in SPEEDS
    }
    tap = run_example("ldpe-tapping")
    named = {f"triangle\n{speed}": run for speed, run in triangles.items()}
    console.print(table_of({**named, "tap\non LDPE": tap}))

    pictures = {
        "attard-triangle.png": plot([result for result, _ in triangles.values()], [*triangles]),
        "ldpe-tapping.png": plot(tap[0]),
    }
    out.mkdir(parents=True, exist_ok=True)
    for name, figure in pictures.items():
        figure.savefig(out / name)
        console.print(f"Picture: {out / name}")


if __name__ == "__main__":
    main()
