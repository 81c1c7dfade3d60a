"""Compile before the first test, so that no test sees the compiler at work."""

import json
from pathlib import Path

import pytest


@pytest.fixture(scope="session", autouse=True)
def compiled_solvers():
    import softafm.solvers.energy_run
    import softafm.solvers.explicit_run

    return softafm.solvers


@pytest.fixture(scope="session")
def reference_cases():
    """Converged results of independent solvers by name (see data/README.md)."""
    cases = json.loads((Path(__file__).parent / "data" / "cases.json").read_text())
    return {case["name"]: case for case in cases}
