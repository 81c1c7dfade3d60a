"""The same run gives the same bits, and loops over steps take no memory.

Also, however a run chooses its steps, it finds the same virial and dissipation where the surface
snaps off across a fold, which steps of fixed length cross by luck.
"""

import json
import os
import subprocess
import sys
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest

import softafm as sa
from softafm.solvers.energy import run as energy_run
from softafm.solvers.paper import kernel as explicit_kernel

VARIANTS = 26


def polyethylene(creep_time=1e-7):
    solid = sa.StandardLinearSolid(E0=2e9, E_inf=0.1e9, creep_time=creep_time, poisson=0.49)
    return sa.Contact(sa.Paraboloid(10e-9), solid, sa.LennardJones(1e-19, 0.25e-9))


def polystyrene():
    solid = sa.StandardLinearSolid(E0=4.25e9, E_inf=1.89e9, creep_time=1e-7, poisson=0.35)
    return sa.Contact(sa.Paraboloid(50e-9), solid, sa.LennardJones(2e-20, 0.15e-9))


LDPE_TAP = polyethylene(), 49.6e-9, 42.82e-9, 278e3
PS_TAP = polystyrene(), 12e-9, 11e-9, 278e3

RUNS = {
    "tap": lambda: sa.tapping_cycle(*LDPE_TAP, profiles=True),
    "fine tap": lambda: sa.tapping_cycle(*LDPE_TAP, tolerance=1e-3),
    "steady tap": lambda: sa.tapping_cycle(polyethylene(1e-5), *LDPE_TAP[1:]),
    "spectroscopy": lambda: sa.force_spectroscopy(
        polyethylene(1e-5), sa.Cantilever(2.0), sa.Triangle(2e-8, -5e-9, 2e-7)
    ),
    "setup E": lambda: sa.tapping_cycle(
        *LDPE_TAP, solver=sa.solvers.EnhancedAttard(domain=12e-9, steps=10_000)
    ),
}
ON_MANY_NODES = {"finest tap": lambda: sa.tapping_cycle(*LDPE_TAP, tolerance=1e-5)}
"""A run on meshes of more than 100 nodes."""


def digest(result) -> str:
    """Of all numbers of a dataset, to the last bit."""
    found = sha256()
    for name in sorted(map(str, result.variables)):
        values = result[name].values
        found.update(name.encode() + str(values.shape).encode())
        found.update(np.ascontiguousarray(values).tobytes())
    return found.hexdigest()


def print_digests(runs="RUNS"):
    print(json.dumps({name: digest(run()) for name, run in globals()[runs].items()}))


def print_digests_on_many_nodes():
    print_digests("ON_MANY_NODES")


def start(call, **environment):
    """Start a process that calls a function of this module."""
    command = [sys.executable, "-c", f"import test_reproducible as t; t.{call}()"]
    return subprocess.Popen(
        command, cwd=Path(__file__).parent, env={**os.environ, **environment},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def printed(process):
    out, errors = process.communicate(timeout=120)
    assert process.returncode == 0, errors
    return json.loads(out)


def test_processes_that_start_together_before_anything_is_compiled_give_the_same_bits(tmp_path):
    example = Path(sa.__file__).parent / "examples" / "ldpe-tapping.toml"

    def run(name):
        command = [sys.executable, "-m", "softafm.cli", "run", str(example), "--out", name]
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "compiled")}
        return subprocess.Popen(
            command, cwd=tmp_path, env=environment, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )  # fmt: skip

    first, second = run("first.nc"), run("second.nc")
    assert first.wait(400) == second.wait(400) == 0
    assert run("third.nc").wait(400) == 0  # of what both have kept
    results = [sa.load(tmp_path / f"{name}.nc") for name in ("first", "second", "third")]
    assert len(set(map(digest, results))) == 1


@pytest.mark.parametrize("name", RUNS)
def test_same_bits_in_one_process(name):
    assert digest(RUNS[name]()) == digest(RUNS[name]())


def with_one_thread_and_two(call):
    processes = [start(call, OPENBLAS_NUM_THREADS=n, NUMBA_NUM_THREADS=n) for n in "12"]
    return [printed(process) for process in processes]


def test_same_bits_with_one_thread_and_two():
    one, two = with_one_thread_and_two("print_digests")
    assert one == two
    assert one.keys() == RUNS.keys()


def test_same_bits_with_one_thread_and_two_on_many_nodes():
    one, two = with_one_thread_and_two("print_digests_on_many_nodes")
    assert one == two


def print_allocations():
    """By loop: the attempted steps and the allocations of each call."""
    from numba.core.runtime import rtsys

    found = {"advance": [], "march": []}

    class Watched(energy_run.Run):
        def _advance(self, stop):
            clock = self.surface.clock
            steps, before = clock["tries"], rtsys.get_allocation_stats().alloc
            outcome = super()._advance(stop)
            taken = rtsys.get_allocation_stats().alloc - before
            found["advance"].append((clock["tries"] - steps, taken))
            return outcome

    march = explicit_kernel.march

    def watched_march(*arguments):
        counters = arguments[-1]
        steps, before = counters[explicit_kernel.INSTANT], rtsys.get_allocation_stats().alloc
        outcome = march(*arguments)
        taken = rtsys.get_allocation_stats().alloc - before
        found["march"].append((int(counters[explicit_kernel.INSTANT] - steps), taken))
        return outcome

    energy_run.Run, explicit_kernel.march = Watched, watched_march
    sa.tapping_cycle(*LDPE_TAP)
    for steps in (5000, 5050):
        sa.tapping_cycle(*LDPE_TAP, solver=sa.solvers.EnhancedAttard(domain=12e-9, steps=steps))
    print(json.dumps(found))


def test_no_memory_is_taken_per_step():
    found = printed(start("print_allocations", NUMBA_NRT_STATS="1"))
    for loop, calls in found.items():
        steps, allocations = np.array(calls).T
        assert steps.max() > 20, loop
        assert allocations.min() == allocations.max(), loop
        assert allocations.max() < 100, loop


@pytest.mark.parametrize("tap", [LDPE_TAP, PS_TAP], ids=["LDPE", "PS"])
def test_first_and_longest_step_do_not_matter_across_a_fold(tap, monkeypatch):
    tolerance = 1e-2
    usual = sa.tapping_cycle(*tap, tolerance=tolerance)
    steps = set()
    for first, longest in zip(
        np.geomspace(1e-3, 3, VARIANTS), np.geomspace(1, 0.05, VARIANTS)[::-1], strict=True
    ):
        for share, part in ((first, 1.0), (1.0, longest)):

            class Varied(energy_run.Run):
                first, longest = share, part

                def _begin_piece(self, stop):
                    super()._begin_piece(stop)
                    self.surface.clock["step"] *= self.first

                def _advance(self, stop):
                    usual = self.controls
                    limit = self.longest * usual.longest_step
                    self.controls = usual._replace(longest_step=limit)
                    try:
                        return super()._advance(stop)
                    finally:
                        self.controls = usual

            with monkeypatch.context() as patch:
                patch.setattr(energy_run, "Run", Varied)
                varied = sa.tapping_cycle(*tap, tolerance=tolerance)
            steps.add(varied.attrs["solver_attempted_steps"])
            for name in ("virial", "dissipation"):
                assert float(varied[name]) == pytest.approx(float(usual[name]), rel=tolerance)
    assert len(steps) > VARIANTS // 2
    assert max(steps) > 2 * min(steps)
