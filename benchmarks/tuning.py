"""What the constants of the default solver do: each doubled and halved, on the reference cases.

Steps, Newton iterations and the largest error (but of the indicative ldpe-tap-z0-0.1nm) of the
prescribed cases of tests/data, with every constant of ``softafm.solvers.energy.tuning`` as it is,
at half and at twice its value. Each runs in a process of its own. Those that stand in compiled code
come last: they are compiled anew, for some twenty seconds, into a folder that is removed.

    python benchmarks/tuning.py [NAME...]
"""

import json
import os
import subprocess
import sys
from tempfile import TemporaryDirectory

FACTORS = 0.5, 2.0


def measure(name: str, factor: float) -> dict[str, float | str]:
    """Run the cases with a constant at a multiple of its value, before anything is compiled."""
    from softafm.solvers.energy import tuning

    value = getattr(tuning, name)
    setattr(tuning, name, type(value)(value * factor))
    import common

    import softafm as sa

    found: dict[str, float | str] = {
        "steps": 0,
        "iterations": 0,
        "error": 0.0,
        "of": "",
        "failed": "",
    }
    for case_name, case in common.reference_cases().items():
        if case["kind"] == "force_spectroscopy":
            continue
        try:
            result = common.run(case)
        except (ValueError, sa.DivergedError):
            found["failed"] += f" {case_name}"
            continue
        found["steps"] += result.attrs["solver_attempted_steps"]
        found["iterations"] += result.attrs["solver_newton_iterations"]
        errors = common.errors(case, result, common.expected(case))
        if common.worst(errors) > abs(found["error"]) and case_name != "ldpe-tap-z0-0.1nm":
            found["error"], found["of"] = common.worst(errors), case_name
    return found


def measure_apart(name: str, factor: float, shared: str) -> dict:
    """``measure`` in a process that keeps its compiled code to itself if the constant is in it."""
    with TemporaryDirectory() as own:
        command = [sys.executable, __file__, "--measure", name, str(factor)]
        folder = own if is_compiled(name) and factor != 1 else shared
        environment = os.environ | {"NUMBA_CACHE_DIR": folder}
        done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True)
        return json.loads(done.stdout)


def is_compiled(name: str) -> bool:
    """Whether a constant stands in compiled loops, so that they have to be compiled anew."""
    from softafm.solvers.energy import descent, equilibrium, frame, memory, proposal, step

    rooms = descent, equilibrium, frame, memory, proposal, step
    return any(hasattr(room, name) for room in rooms)


def main():
    with TemporaryDirectory() as shared:
        print_table(shared)


def print_table(shared: str) -> None:
    if sys.argv[1:2] == ["--measure"]:
        print(json.dumps(measure(sys.argv[2], float(sys.argv[3]))))
        return
    from softafm.solvers.energy import tuning

    chosen = sys.argv[1:] or [name for name in vars(tuning) if name.isupper()]
    chosen.sort(key=is_compiled)
    before = measure_apart(chosen[0], 1.0, shared)
    print("| constant | value | at | attempted steps | iterations | largest error, % | of |")
    print("|---|---:|---:|---:|---:|---:|---|")
    print(f"| all as they are | | | {before['steps']} | {before['iterations']} "
          f"| {before['error']:.2f} | {before['of']} |")  # fmt: skip
    for name in chosen:
        for factor in FACTORS:
            now = measure_apart(name, factor, shared)
            steps, iterations = (now[k] / before[k] - 1 for k in ("steps", "iterations"))
            worst = now["of"] + (", fails:" + now["failed"] if now["failed"] else "")
            print(f"| `{name}` | {getattr(tuning, name):g} | × {factor:g} | {steps:+.0%} "
                  f"| {iterations:+.0%} | {now['error']:.2f} | {worst} |", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
