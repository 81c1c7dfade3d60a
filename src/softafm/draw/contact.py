"""The figure of a contact: tip, surface law and sample side by side."""

from typing import TYPE_CHECKING

import numpy as np

from softafm.checks.kinds import refuse_other
from softafm.contact import Contact
from softafm.draw.law import draw_laws
from softafm.draw.sample import SAMPLES, choose_times, draw_moduli, draw_steps
from softafm.draw.tip import choose_extent, draw_profiles

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_HEIGHT = 1.75
"""Height to which the body of the tip is shown, in radii of its picture."""


def plot_contact(contact: Contact) -> "Figure":
    """Draw what touches: the tip, the surface law and the sample.

    Parameters
    ----------
    contact
        Tip, sample and surface law.

    Returns
    -------
    matplotlib.figure.Figure
        The profile of the tip, dashed the paraboloid of its apex; pressure and potential against
        the gap; relaxation modulus and creep compliance over time, storage and loss modulus over
        frequency. Save it with ``figure.savefig``.

    Raises
    ------
    ValueError
        If it is not a contact.
    """
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    refuse_other("contact", contact, Contact, "a softafm.Contact")
    tip, surface, sample = contact.tip, contact.surface, contact.rheology
    layout = ConstrainedLayoutEngine(wspace=0.07, hspace=0.05)
    figure = Figure(figsize=(12.6, 7.2), dpi=150, layout=layout)
    grid = figure.add_gridspec(2, 6)
    profile = figure.add_subplot(grid[0, :2], title=f"Tip: {tip.kind}")
    pressure = figure.add_subplot(grid[0, 2:4], title=f"Surface law: {surface.kind}")
    potential = figure.add_subplot(grid[0, 4:])
    steps = figure.add_subplot(grid[1, :3], title=f"Sample: {sample.kind}")
    moduli = figure.add_subplot(grid[1, 3:])
    draw_profiles(profile, [tip], choose_extent([tip]), [tip.kind])
    _fill(profile)
    draw_laws(pressure, potential, [surface], [surface.kind])
    time = np.geomspace(*choose_times(sample), SAMPLES)
    draw_steps(steps, sample, time)
    draw_moduli(moduli, sample, time)
    return figure


def _fill(ax: "Axes") -> None:
    """Let the tip fill its panel: a body, to scale, above the profile."""
    across = ax.get_xlim()[1]
    top = _HEIGHT * across
    radius, height = map(np.asarray, ax.get_lines()[0].get_data())
    ax.fill_between(radius, height, top, where=height < top, color="0.93", linewidth=0)
    ax.set_ylim(-0.1 * across, top)
