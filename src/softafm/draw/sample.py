"""The figure of a sample: creep and relaxation over time, storage and loss over frequency."""

from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from softafm.checks.kinds import refuse_other, refuse_sample
from softafm.rheology.check import check_sample
from softafm.rheology.dma import sort_moduli
from softafm.rheology.interconversion import chain_to_prony
from softafm.rheology.lists import check_window
from softafm.rheology.represented import Represented
from softafm.rheology.solid import Solid

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SAMPLES = 300
_DEEPEST = 1e8


def plot_rheology(
    sample: Solid,
    window: tuple[float, float] | None = None,
    data: tuple[ArrayLike, ArrayLike, ArrayLike] | None = None,
) -> "Figure":
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
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    refuse_sample("sample", sample)
    refuse_other("sample", sample, Solid, "a sample such as softafm.Elastic")
    check_sample("sample", sample)
    measured = None if data is None else sort_moduli(*data)
    shortest, longest = choose_times(sample, measured) if window is None else check_window(window)
    time = np.geomspace(shortest, longest, SAMPLES)
    figure = Figure(figsize=(10.4, 4.2), dpi=150, layout=ConstrainedLayoutEngine(wspace=0.06))
    against_time, against_frequency = figure.subplots(1, 2)
    draw_steps(against_time, sample, time)
    draw_moduli(against_frequency, sample, time, measured)
    return figure


def choose_times(sample: Solid, measured: tuple[Any, ...] | None = None) -> tuple[float, float]:
    """Return shortest and longest time, s, of the data, or else of the sample."""
    if measured:
        return 1 / (2 * pi * measured[0][-1]), 1 / (2 * pi * measured[0][0])
    if isinstance(sample, Represented):
        return sample.window
    compliance = sample.compliance
    relaxation_times = chain_to_prony(*compliance)[2]
    times = np.append(compliance.retardation_times, relaxation_times)
    if not times.size:
        return 1e-3, 1e3
    return float(times.min()) / 100, float(times.max()) * 100


def draw_steps(ax: "Axes", sample: Solid, time: np.ndarray) -> None:
    """Draw relaxation modulus and creep compliance at ``time`` (s), rising, with an axis each."""
    from softafm.draw.style import choose_factor, find_prefix, write_label

    against_compliance = ax.twinx()
    relaxation, creep = sample.relaxation_modulus(time), sample.creep_compliance(time)
    factor = choose_factor(relaxation)
    solid, dashed = _choose_styles()
    ax.plot(time, factor * relaxation, **solid)
    ax.set_ylabel(
        write_label("Relaxation modulus", "Pa", factor), fontsize=11, color=solid["color"]
    )
    factor = choose_factor(1 / creep)
    against_compliance.plot(time, creep / factor, **dashed)
    title = f"Creep compliance (1/{find_prefix(factor)}Pa)"
    against_compliance.set_ylabel(title, fontsize=11, color=dashed["color"])
    _set_logarithmic(ax, "Time", "s", right=False)
    _set_logarithmic(against_compliance, "Time", "s", right=True)


def draw_moduli(
    ax: "Axes", sample: Solid, time: np.ndarray, measured: tuple[Any, ...] | None = None
) -> None:
    """Draw storage and loss modulus at ω = 1/``time`` (s, rising), and measured ones as points."""
    from softafm.draw.style import HOLLOW, choose_factor, write_label

    frequency = 1 / (2 * pi * time[::-1])
    moduli = sample.storage_modulus(frequency), sample.loss_modulus(frequency)
    factor = choose_factor(*moduli, *(measured[1:] if measured else ()))
    for index, name in enumerate(("storage modulus E′", "loss modulus E″")):
        line = _choose_styles()[index]
        ax.plot(frequency, factor * moduli[index], label=name, **line)
        if measured:
            label = f"{name.split()[0]}, measured"
            points = factor * measured[1 + index]
            ax.plot(measured[0], points, color=line["color"], label=label, **HOLLOW)
    ax.set_ylabel(write_label("Modulus", "Pa", factor), fontsize=11)
    _set_logarithmic(ax, "Frequency", "Hz")
    ax.legend(frameon=False)


def _choose_styles() -> tuple[dict[str, Any], dict[str, Any]]:
    """Styles of what is stored and what is lost: by colour and by dashes."""
    from softafm.draw.style import RETRACT, choose_line

    return choose_line(0), {**choose_line(1), "linestyle": RETRACT}


def _set_logarithmic(ax: "Axes", title: str, unit: str, right: bool | None = None) -> None:
    """Set logarithmic axes, the abscissa labelled in prefixes; ``right`` if two share it."""
    from matplotlib.ticker import EngFormatter, LogLocator

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
