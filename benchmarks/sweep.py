"""What a sweep costs beside its runs: rates against a bare loop's, overhead, memory.

    python benchmarks/sweep.py [--taps 10000] [--short 20000] [--many 100000 1000000] [--workers 2]

A bare loop calls ``sa.tapping_cycle`` with one contact, in as many processes as the sweep has
workers. Rates are taken from the first quarter of the runs on, when all processes are warm;
processor time, of all processes, from what a sweep takes more than one of a quarter of the runs: a
machine that others use too slows the clock, and hardly that.
"""

import argparse
import multiprocessing
import resource
import shutil
import tempfile
from functools import partial
from pathlib import Path
from time import perf_counter, process_time, sleep

import common
import numpy as np

import softafm as sa
from softafm.experiment.config import parse_document, read_example

HEIGHTS = 42e-9, 46e-9


def taps(heights) -> None:
    """The bare loop."""
    contact = sa.Contact(
        sa.Paraboloid(10e-9),
        sa.StandardLinearSolid(2e9, 0.1e9, 0.1e-6, 0.49),
        sa.LennardJones(1e-19, 0.25e-9),
    )
    for height in heights:
        sa.tapping_cycle(contact, 49.6e-9, float(height), 278e3, 1)


def timed_taps(heights, barrier, answers) -> None:
    """Time a loop that is warm: by the clock, and of the processor."""
    taps(heights[:20])
    barrier.wait()
    started, used = perf_counter(), process_time()
    taps(heights)
    answers.put((perf_counter() - started, process_time() - used))


def bare_rate(heights, workers: int) -> tuple[float, float]:
    """Runs a second of bare loops side by side, and processor time of a run, s."""
    context = multiprocessing.get_context("spawn")
    barrier, answers = context.Barrier(workers), context.Queue()
    processes = [
        context.Process(target=timed_taps, args=(heights[k::workers], barrier, answers))
        for k in range(workers)
    ]
    for process in processes:
        process.start()
    found = [answers.get() for _ in processes]
    for process in processes:
        process.join()
    return len(heights) / max(clock for clock, _ in found), sum(u for _, u in found) / len(heights)


class Swept:
    """A sweep with its times: start, rate when warm (1/s), processor time (s)."""

    def __init__(self, what, vary, workers: int, **options):
        marks: list[tuple[float, float]] = []
        folder = Path(tempfile.mkdtemp(prefix="softafm-bench-"))
        started, used = perf_counter(), _used()
        try:
            found = sa.sweep(
                what, vary, workers=workers, store=folder / "s.zarr", yes=True,
                progress=lambda done, _: marks.append((perf_counter() - started, done)), **options,
            )  # fmt: skip
            runs = found["state"].size
            self.all_done = bool((found["state"] != 0).all())
        finally:
            shutil.rmtree(folder)
        self.whole = perf_counter() - started
        self.start = marks[1][0]
        warm = [(clock, done) for clock, done in marks if done >= 0.25]
        self.rate = runs * (warm[-1][1] - warm[0][1]) / (warm[-1][0] - warm[0][0])
        self.runs, self.used = runs, _used() - used


def _used() -> float:
    """Processor time of this process and its ended children, s."""
    kinds = resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN
    return sum(u.ru_utime + u.ru_stime for u in map(resource.getrusage, kinds))


def asleep(x, seconds):
    """A run that takes its time, and none of the processor's."""
    sleep(seconds)
    return {"y": 2 * x}


def nothing(x, y):
    """A run that takes no time."""
    return {"sum": x + y, "product": x * y}


def _peak(runs: int, workers: int, pipe) -> None:
    kept = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    side = round(runs**0.5)
    done = Swept(nothing, {"x": np.linspace(0, 1, side), "y": range(runs // side)}, workers)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    children = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    pipe.put((kept / 1024, peak / 1024, children / 1024, done.whole, done.all_done))


def memory(runs: int, workers: int):
    """Memory before and at most, of the client and of the largest worker, MB; and time, s."""
    context = multiprocessing.get_context("spawn")
    pipe = context.Queue()
    process = context.Process(target=_peak, args=(runs, workers, pipe))
    process.start()
    found = pipe.get()
    process.join()
    return found


def main() -> None:
    """Measure all and print tables."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--taps", type=int, default=10_000)
    options.add_argument("--short", type=int, default=20_000)
    options.add_argument("--many", type=int, nargs="*", default=[100_000, 1_000_000])
    options.add_argument("--workers", type=int, default=2)
    given = options.parse_args()

    heights = np.linspace(*HEIGHTS, given.taps)
    document = parse_document(read_example("ldpe-tapping"), "ldpe-tapping")
    half = heights[::2]
    before, processor = bare_rate(half, given.workers)
    swept = Swept(document, {"motion.mean_height": heights}, given.workers)
    part = Swept(document, {"motion.mean_height": heights[::4]}, given.workers)
    each = (swept.used - part.used) / (swept.runs - part.runs)
    begin = swept.used - each * swept.runs
    after, again = bare_rate(half, given.workers)
    bare, processor = (before + after) / 2, (processor + again) / 2
    common.show(
        f"{given.taps} LDPE taps, {given.workers} workers",
        {"": "left", "runs a second": "right", "processor, ms a run": "right"},
        [
            ("bare loops before", f"{before:.0f}", f"{1e3 * processor:.2f}"),
            ("sweep", f"{swept.rate:.0f}", f"{1e3 * each:.2f}, and {begin:.1f} s to begin"),
            ("bare loops after", f"{after:.0f}", ""),
            ("sweep of bare", f"{swept.rate / bare:.1%}", f"{processor / each:.1%}"),
            ("first block after", f"{swept.start:.1f} s", f"whole: {swept.whole:.1f} s"),
        ],
    )

    wait = 2e-3
    alone = perf_counter()
    for x in range(500):
        asleep(x, wait)
    alone = (perf_counter() - alone) / 500
    short = Swept(partial(asleep, seconds=wait), {"x": range(given.short)}, given.workers)
    ideal = given.workers / alone
    common.show(
        f"{given.short} runs of {1e3 * alone:.2f} ms",
        {"runs a second": "right", "of a loop": "right", "overhead": "right"},
        [(f"{short.rate:.0f}", f"{ideal:.0f}", f"{ideal / short.rate - 1:.1%}")],
    )

    rows = []
    for runs in given.many:
        kept, peak, children, seconds, done = memory(runs, given.workers)
        note = "" if done else "NOT ALL DONE"
        rows.append(
            (runs, f"{kept:.0f}", f"{peak:.0f}", f"{children:.0f}", f"{seconds:.0f} {note}")
        )
    common.show(
        "Memory of runs that do nothing, MB",
        dict.fromkeys(
            ("runs", "client before", "client at most", "a worker at most", "s"), "right"
        ),
        rows,
    )


if __name__ == "__main__":
    main()
