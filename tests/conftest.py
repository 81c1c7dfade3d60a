"""Compile before the first test, so that no test sees the compiler at work."""

import pytest


@pytest.fixture(scope="session", autouse=True)
def compiled_solver():
    import softafm.solvers.energy_run

    return softafm.solvers.energy_run
