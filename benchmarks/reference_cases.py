"""Time, memory and error of the default solver on the reference cases of tests/data.

Times are the least of several runs after a warm-up, on one core, from the call to the finished
dataset. Errors are in per cent of each observable's scale (largest |force|; for energies the larger
of the value and |force|·z0, or 2 % of |force|·amplitude for taps).

    python benchmarks/reference_cases.py [TOLERANCE]
"""

import resource
import sys

import common


def main():
    tolerance = float(sys.argv[1]) if len(sys.argv) > 1 else 1e-2
    rows = []
    for name, case in common.reference_cases().items():
        if case["kind"] == "force_spectroscopy":
            continue
        result, seconds = common.timed(lambda case=case: common.run(case, tolerance))
        found = common.errors(case, result, common.expected(case))
        where, error = max(found.items(), key=lambda pair: abs(pair[1]))
        steps, nodes = result.attrs["solver_steps"], result.attrs["solver_most_nodes"]
        jumps = result.sizes["jump"]
        rows.append((name, f"{1e3 * seconds:.1f}", steps, nodes, jumps, f"{error:+.3f}", where))
    headings = {"case": "left", "time, ms": "right", "steps": "right", "nodes": "right",
                "jumps": "right", "largest error, %": "right", "in": "left"}  # fmt: skip
    common.show(f"Reference cases at tolerance {tolerance:g}", headings, rows)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"peak memory of the process: {peak:.0f} MB")


if __name__ == "__main__":
    main()
