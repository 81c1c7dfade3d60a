"""The figure of a sample: creep and relaxation over time, storage and loss over frequency."""

from math import log10, pi
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.ticker import EngFormatter, LogLocator

from softafm.drawing import COLOURS, PREFIXES, RETRACT, factor_of
from softafm.rheology.dma import checked
from softafm.rheology.interconversion import chain_to_prony
from softafm.rheology.lists import window_of
from softafm.rheology.represented import Represented
from softafm.rheology.solid import Solid

_SAMPLES = 300
_DEEPEST = 1e8
_POINTS: dict[str, Any] = {
    "linestyle": "none",
    "marker": "o",
    "markersize": 4.5,
    "markerfacecolor": "white",
}


def plot_rheology(
    sample: Solid,
    window: tuple[float, float] | None = None,
    data: tuple | None = None,
) -> Figure:
    """Draw a sample's creep compliance, relaxation modulus, storage and loss modulus.

    Parameters
    ----------
    sample
        Any sample of ``softafm.rheology``.
    window
        Shortest and longest time, s, and of the inverse frequencies ω; by default the sample's own,
        or that of the data, or two decades around its retardation and relaxation times.
    data
        Measured frequency (Hz), storage and loss modulus (Pa), drawn as points.

    Returns
    -------
    matplotlib.figure.Figure
        Save it with ``figure.savefig``.

    Raises
    ------
    ValueError
        If the window or the data are not such.
    """
    measured = None if data is None else checked(*data)
    shortest, longest = _window(sample, measured) if window is None else window_of(window)
    time = np.geomspace(shortest, longest, _SAMPLES)
    frequency = 1 / (2 * pi * time[::-1])

    figure = Figure(figsize=(10.4, 4.2), dpi=150, layout=ConstrainedLayoutEngine(wspace=0.06))
    against_time, against_frequency = figure.subplots(1, 2)
    against_compliance = against_time.twinx()
    relaxation, creep = sample.relaxation_modulus(time), sample.creep_compliance(time)
    prefix, factor = _prefix(relaxation)
    against_time.plot(time, factor * relaxation, color=COLOURS[0])
    against_time.set_ylabel(f"Relaxation modulus ({prefix}Pa)", fontsize=11, color=COLOURS[0])
    prefix, factor = _prefix(1 / creep)
    against_compliance.plot(time, creep / factor, color=COLOURS[1], linestyle=RETRACT)
    against_compliance.set_ylabel(f"Creep compliance (1/{prefix}Pa)", fontsize=11, color=COLOURS[1])
    _logarithmic(against_time, "Time", "s", right=False)
    _logarithmic(against_compliance, "Time", "s", right=True)

    moduli = sample.storage_modulus(frequency), sample.loss_modulus(frequency)
    prefix, factor = _prefix(*moduli, *(measured[1:] if measured else ()))
    for index, name in enumerate(("storage modulus E′", "loss modulus E″")):
        colour, line = COLOURS[index], ("-", RETRACT)[index]
        against_frequency.plot(
            frequency, factor * moduli[index], color=colour, linestyle=line, label=name
        )
        if measured:
            points = factor * measured[1 + index]
            label = f"{name.split()[0]}, measured"
            against_frequency.plot(measured[0], points, color=colour, label=label, **_POINTS)
    against_frequency.set_ylabel(f"Modulus ({prefix}Pa)", fontsize=11)
    _logarithmic(against_frequency, "Frequency", "Hz")
    against_frequency.legend(frameon=False)
    return figure


def _window(sample: Solid, measured) -> tuple[float, float]:
    """Return the times of the data, or of the sample."""
    if measured:
        return 1 / (2 * pi * measured[0][-1]), 1 / (2 * pi * measured[0][0])
    if isinstance(sample, Represented):
        return sample.window
    compliance = sample.reduced_compliance
    relaxation_times = chain_to_prony(*compliance)[2]
    times = np.append(compliance.retardation_times, relaxation_times)
    if not times.size:
        return 1e-3, 1e3
    return float(times.min()) / 100, float(times.max()) * 100


def _prefix(*moduli: np.ndarray) -> tuple[str, float]:
    """Return the prefix that suits the largest modulus, and the factor from SI to it."""
    factor = factor_of(*moduli)
    return PREFIXES[-round(log10(factor))], factor


def _logarithmic(ax: Axes, title: str, unit: str, right: bool | None = None) -> None:
    """Set logarithmic axes, the abscissa labelled in prefixes; ``right`` if two share it."""
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel(f"{title} ({unit})", fontsize=11)
    ax.xaxis.set_major_locator(LogLocator(numticks=8))
    ax.xaxis.set_major_formatter(EngFormatter())
    ax.margins(x=0)
    left, right = right is not True, right is not False
    ax.tick_params(direction="in", which="both", top=True, left=left, right=right)
    low, high = ax.get_ylim()
    middle = (low * high) ** 0.5
    # A constant is shown as one, not as its round-off; an exponential decay not to its end.
    ax.set_ylim(max(min(low, middle / 2), high / _DEEPEST), max(high, 2 * middle))
