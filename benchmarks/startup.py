"""What a user waits for: import, the first run of a machine, the first run of a later process.

python benchmarks/startup.py
"""

import os
import subprocess
import sys
import tempfile
from time import perf_counter

TAP = """
import softafm as sa
contact = sa.Contact(sa.Paraboloid(10e-9), sa.StandardLinearSolid(2e9, 0.1e9, 1e-7, 0.49),
                     sa.LennardJones(1e-19, 0.25e-9))
sa.tapping_cycle(contact, 49.6e-9, 42.82e-9, 278e3)
"""


def seconds(command, **environment):
    started = perf_counter()
    subprocess.run(command, env={**os.environ, **environment}, check=True, capture_output=True)
    return perf_counter() - started


def main():
    python = [sys.executable, "-c"]
    with tempfile.TemporaryDirectory() as cache:
        first = seconds([*python, TAP], NUMBA_CACHE_DIR=cache)
        later = min(seconds([*python, TAP], NUMBA_CACHE_DIR=cache) for _ in range(5))
    bare = min(seconds([*python, "pass"]) for _ in range(5))
    arrays = min(seconds([*python, "import numpy"]) for _ in range(5))
    imported = min(seconds([*python, "import softafm"]) for _ in range(5))
    shown = min(seconds([sys.executable, "-m", "softafm", "--help"]) for _ in range(5))
    print(f"python alone                                   {bare:6.2f} s")
    print(f"import numpy, which softafm begins with         {arrays:6.2f} s")
    print(f"import softafm                                 {imported:6.2f} s")
    print(f"softafm --help                                 {shown:6.2f} s")
    print(f"one tap, first run of a machine (compiles)     {first:6.2f} s")
    print(f"one tap, later process, start to end           {later:6.2f} s")


if __name__ == "__main__":
    main()
