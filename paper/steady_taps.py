"""How many cycles it takes to a steady tap, for creep times from far below to far above a period.

Not in the paper: a tap on its polyethylene (A = 49.6 nm, Z = 46 nm) with other creep times. The
first cycle, on a flat surface, is told beside the steady one.
"""

from dataclasses import replace

import common

import softafm as sa

TAP = sa.Sine(mean_height=46e-9, amplitude=49.6e-9, frequency=278e3, cycles=1)
CREEP_TIMES = 0.0278, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0, 1000.0
"""In periods; the first is that of the paper."""


def main(progress=None):
    """Run the first and the steady cycle at each creep time."""
    common.warm_up()
    rows = []
    for periods in common.tracked(CREEP_TIMES, progress, lambda p: f"creep time {p:g} periods"):
        sample = replace(common.LDPE.sample, creep_time=periods / TAP.frequency)
        contact = replace(common.LDPE, sample=sample)
        first, steady = (
            common.tap(contact, replace(TAP, cycles=cycles)) for cycles in (1, "steady")
        )
        ratios = [
            steady.observables[name] / first.observables[name]
            for name in ("virial", "dissipation", "force_max")
        ]
        rows.append([periods, int(steady.observables["cycles_run"]), 1e3 * steady.seconds, *ratios])
    header = ("creep_time_periods", "cycles_run", "ms", "virial", "dissipation", "force_max")
    common.report("steady_taps", "Steady taps; ratios are steady over first", header, rows)


if __name__ == "__main__":
    common.run(main)
