"""Where a motion may begin."""


def refuse_start_inside(contact, motion) -> None:
    """Raise ValueError if the tip starts below the equilibrium gap, inside the surface."""
    start = float(motion.height(motion.breaks[0]))
    gap = contact.surface.equilibrium_gap
    if start <= gap:
        raise ValueError(
            f"start height = {start:g} m: must be above the equilibrium gap, {gap:g} m "
            "(the tip would start inside the surface)"
        )
