"""Indentation of linear viscoelastic samples without adhesion: Lee and Radok, and Ting.

A contact without adhesion is one of independent springs, by Abel transforms: at every radius ρ < a
one of modulus E*(t) is pressed from the time s(ρ) on at which the tip was as deep as δ_e(ρ), the
``depth`` of an elastic contact of this radius. Its load is q(ρ, t) = ∫ E*(t − s) dδ(s) from s(ρ) to
t, and the force F = 2∫ q dρ from 0 to a. With q(a, t) = 0 this is Lee and Radok's integral of
E*(t − s) dF_e(s) while the contact grows, and Ting's up to the time at which it was as wide before.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from softafm.indentation.curve import Curve
from softafm.indentation.dent import find_dent
from softafm.indentation.springs import Springs, integrate_modulus
from softafm.instrument.motion import Motion

if TYPE_CHECKING:
    from softafm.tips import Tip


def lee_radok(tip: "Tip", sample: Any, motion: Motion, time: ArrayLike | None = None) -> Curve:
    """Force on a tip that presses into a viscoelastic sample, without adhesion, up to its turn.

    Parameters
    ----------
    tip, sample, motion
        As for ``ting``. The motion may go on after its lowest height, or dwell there.
    time
        Instants, s, shape (n,), none after the dwell at the lowest height, when the contact shrinks
        and the formula no longer holds; by default some 100 between corners of the motion.

    Returns
    -------
    Curve
        As of ``ting``.

    Raises
    ------
    ValueError
        As ``ting``; or if a time is later than the motion turns back.

    References
    ----------
    F(t) = ∫ E*(t − s) dF_e(s), with F_e the elastic ``load`` at unit modulus: E. H. Lee and J. R.
    M. Radok, *J. Appl. Mech.* 27, 438 (1960).
    """
    springs = Springs(find_dent(motion), integrate_modulus(sample))
    back = float(springs.dent.time[springs.dent.back])
    times = springs.choose_times(back) if time is None else springs.check_times(time)
    if np.any(times > back):
        raise ValueError(
            f"time = {times.max():g} s: must not be after {back:g} s, when the motion turns back "
            "and the contact shrinks; ting goes on"
        )
    return springs.follow(tip, np.nextafter(back, np.inf), times)


def ting(tip: "Tip", sample: Any, motion: Motion, time: ArrayLike | None = None) -> Curve:
    """Force on a tip that presses into a viscoelastic sample and withdraws, without adhesion.

    The contact ends before the tip is back at the surface, which recovers more slowly.

    Parameters
    ----------
    tip
        E.g. ``softafm.Paraboloid``.
    sample
        Any linear viscoelastic sample, e.g. ``softafm.StandardLinearSolid``, of constant Poisson's
        ratio. A ``PowerLaw`` is the law itself, not the chain that stands for it in solvers.
    motion
        E.g. ``softafm.Triangle``, or a ``softafm.Trajectory`` of any heights: from above the
        surface at 0 m, which is flat and at rest, in once and out. It may dwell, and vary its
        speed. A curved one is taken as 400 straight pieces between its breaks and landmarks.
    time
        Instants, s, shape (n,); by default some 100 between corners of the motion, from the
        beginning of the contact to its end, both included.

    Returns
    -------
    Curve
        ``time``, s, ``depth`` and ``contact_radius``, m, and ``force``, N, all of shape (n,).

    Raises
    ------
    ValueError
        If the sample is a body other than a half-space, the motion is not as stated, or the
        surface comes back faster than it withdraws, or a time does not lie in it.

    References
    ----------
    T. C. T. Ting, *J. Appl. Mech.* 33, 845 (1966): F(t) = ∫ E*(t − s) dF_e(s) up to the time t1 at
    which the contact was as wide before, ∫ E*(t − s) dδ(s) = 0 from t1 to t.
    """
    springs = Springs(find_dent(motion), integrate_modulus(sample))
    over = springs.find_end()
    times = springs.choose_times(over) if time is None else springs.check_times(time)
    return springs.follow(tip, over, times)
