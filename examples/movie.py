"""Run the bundled tap that keeps the surface's shapes; write its movies and its twelve instants.

python examples/movie.py [--out FOLDER]
"""

import argparse
import shutil
from importlib.resources import as_file, files
from pathlib import Path

import softafm as sa
from softafm.experiment.config import load_experiment


def main() -> None:
    parser = argparse.ArgumentParser(description="Write movies of one tap on polyethylene.")
    parser.add_argument("--out", type=Path, default=Path("demo-output"), help="folder of pictures")
    out: Path = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)

    with as_file(files("softafm") / "examples" / "ldpe-movie.toml") as path:
        tap = load_experiment(path).run()
    figure = out / "ldpe-movie.png"
    sa.plot_profiles(tap).savefig(figure, dpi=110)
    print(f"Picture: {figure}")
    suffixes = ["html", "gif"] + (["mp4"] if shutil.which("ffmpeg") else [])
    for suffix in suffixes:
        movie = out / f"ldpe-movie.{suffix}"
        sa.animate(tap, movie, overwrite=True, progress=True)
        print(f"Movie: {movie}, {movie.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
