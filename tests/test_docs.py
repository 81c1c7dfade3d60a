"""Examples of the documents are run, so that they cannot rot."""

import importlib.util
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import softafm as sa
from softafm.config import example_text, load_experiment

DOCS = Path(__file__).parents[1] / "docs"


def example_module(page, folder):
    """Import the Python blocks of a page as one module (a file: compiled code is cached by it)."""
    blocks = re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.S)
    path = folder / f"{Path(page).stem}_example.py"
    path.write_text("\n".join(blocks), encoding="utf-8")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_surface_law_of_the_extending_page_is_consistent(tmp_path):
    example = example_module("extending.md", tmp_path)
    law = example.DoubleExponential(repulsion=1e9, attraction=1e8, core=0.1e-9, decay=0.4e-9)
    gap = np.linspace(0.1e-9, 3e-9, 60)
    compiled_pressure, compiled_potential, parameters = law.compiled_pressure
    pressure, slope, potential = np.empty((3, gap.size))
    compiled_pressure(gap, parameters, pressure, slope, gap.size)
    compiled_potential(gap, parameters, potential, gap.size)

    assert pressure == pytest.approx(law.pressure(gap), rel=1e-12)
    assert potential == pytest.approx(law.potential(gap), rel=1e-12)
    step = 1e-14
    rise = (law.pressure(gap + step) - law.pressure(gap - step)) / (2 * step)
    assert slope == pytest.approx(rise, rel=1e-5, abs=1e-6 * np.abs(slope).max())
    fall = (law.potential(gap - step) - law.potential(gap + step)) / (2 * step)
    assert pressure == pytest.approx(fall, rel=1e-5, abs=1e-6 * np.abs(pressure).max())
    assert law.pressure(law.equilibrium_gap) == pytest.approx(0, abs=1e-3)
    tensions = law.pressure(law.gap_of_largest_tension * np.array([0.99, 1, 1.01]))
    assert tensions.argmin() == 1

    stiff = sa.Contact(sa.Paraboloid(1e-7), sa.Elastic(1e12, poisson=0.3), law)
    curve = sa.force_distance(stiff, sa.Triangle(start=3e-9, turn=0.28e-9, speed=1e-6))
    derjaguin = -2 * np.pi * stiff.tip.radius * law.work_of_adhesion
    assert float(curve.force_min) == pytest.approx(derjaguin, rel=0.01)


def test_the_tap_of_the_first_page_runs(tmp_path):
    tap = example_module("index.md", tmp_path).tap
    assert float(tap.dissipation) == pytest.approx(4.00e-17, rel=0.02)


def test_the_solver_tables_of_the_command_line_page_hold_the_defaults(tmp_path):
    page = (DOCS / "command-line.md").read_text(encoding="utf-8")
    path = tmp_path / "experiment.toml"
    solvers = []
    for table in re.findall(r"```toml\n(\[solver\]\n.*?)```", page, re.S):
        path.write_text(f"{example_text('ldpe-tapping')}\n{table}", encoding="utf-8")
        solvers.append(load_experiment(path).solver)
    segments, functions = solvers
    assert replace(segments, domain=None, relaxation=None) == sa.solvers.Attard()
    assert replace(functions, domain=None) == sa.solvers.EnhancedAttard()
