"""What a run of the energy solver doubts about its own result, and advises."""

from math import sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from softafm.errors import AccuracyWarning
from softafm.solvers.energy.tuning import COARSER_THAN_NEEDED, LEAST_ENERGY, MOST_CYCLES, SHARPEST

if TYPE_CHECKING:
    from softafm.solvers.energy.run import Run


def list_doubts(run: "Run") -> tuple[AccuracyWarning, ...]:
    """Return the warnings that a finished run deserves."""
    return (
        *_doubt_steadiness(run),
        *_doubt_coarseness(run),
        *_doubt_sharpness(run),
        *_doubt_width(run),
        *_doubt_jumps(run),
    )


def suggest_longer_range(contact: Any) -> str:
    """Return advice, for the end of a line, where the contact is too soft for its own range."""
    tabor = contact.tabor_softened
    if tabor <= contact.largest_tabor:
        return ""
    return f"; its Tabor number is {tabor:.3g}: try regularise={contact.largest_tabor / 2:g}"


def _doubt_steadiness(run: "Run") -> tuple[AccuracyWarning, ...]:
    if run.unsteady <= run.steadiness.allowed:
        return ()
    # Cycles that begin a little differently are no matter if all come to the same.
    if run.cycle < MOST_CYCLES and run.steadiness.spread <= 1e-2 * run.strictness:
        return ()
    text = (
        f"no steady cycle after {run.cycle}: the surface starts the last ones off by up to "
        f"{run.unsteady:.2g} gaps of largest tension from where they would end. Choose a "
        "number of cycles instead"
    )
    return (AccuracyWarning(text, run.unsteady),)


def _doubt_coarseness(run: "Run") -> tuple[AccuracyWarning, ...]:
    coarseness, edge = run.coarsest
    if coarseness <= COARSER_THAN_NEEDED * run.target:
        return ()
    spacing = run.surface.mesh.edge_spacing * edge
    law, remedy = run.contact.surface, ""
    if run.contact.adhesive:
        # Seen through coarse nodes the zone looks wide; the softened cohesive length bounds it.
        length = run.contact.softened_modulus * law.range**2 / law.work_of_adhesion
        wide = max(coarseness, 2 * spacing / length) / run.target
        remedy = (
            ", or enlarge the range of the attraction at fixed work of adhesion, regularise="
            f"{run.contact.tabor_softened / sqrt(wide):.2g}"
        )
    text = (
        f"the cohesive zone at the contact edge, {spacing / coarseness:.2g} m wide, is "
        f"resolved by nodes {spacing:.2g} m apart (finest_spacing = "
        f"{run.solver.finest_spacing:g} contact radii) where "
        f"{run.target * spacing / coarseness:.2g} m is needed: forces and above all the loop "
        f"energy may be wrong. Lower solvers.Energy(finest_spacing=...){remedy}"
    )
    return (AccuracyWarning(text, coarseness / run.target),)


def _doubt_sharpness(run: "Run") -> tuple[AccuracyWarning, ...]:
    law = run.contact.surface
    if not run.contact.adhesive or law.sharpness <= SHARPEST:
        return ()
    text = (
        f"the tension of the surface law '{law.kind}' ends {law.sharpness:.2g} times as sharply"
        f" as that of a Lennard-Jones law of its range; beyond {SHARPEST:g} times the contact "
        "edge may catch on the nodes, and forces be off by several per cent. Smooth the law"
    )
    return (AccuracyWarning(text, law.sharpness),)


def _doubt_width(run: "Run") -> tuple[AccuracyWarning, ...]:
    body = run.contact.body
    widest = float(run.records["frame"][: run.count].max(initial=0.0))
    if widest <= body.widest:
        return ()
    text = (
        f"the contact and what acts around it reach to {widest:.3g} m, and on the body "
        f"'{body.kind}' the mesh is good for contacts of up to {body.widest:.3g} m: forces and "
        "energies may be wrong. Indent less, or take a sharper tip"
    )
    return (AccuracyWarning(text, widest / body.widest),)


def _doubt_jumps(run: "Run") -> tuple[AccuracyWarning, ...]:
    if not run.gained:
        return ()
    records = run.records[: run.count]
    seen = records["jump"].sum() + records["lost"].sum()
    felt = LEAST_ENERGY * np.abs(records["force"]).max(initial=0.0) * run.contact.reach
    part = run.gained / max(seen, felt)
    if part <= 1e-2 * run.strictness:
        return ()
    text = (
        f"jumps of the surface seem to gain {run.gained:.2g} J where they can only lose energy, "
        f"and count as 0: {part:.2g} of what was dissipated. jump_energy and the loop energy may "
        "be off by as much; lower the tolerance"
    )
    return (AccuracyWarning(text, part),)
