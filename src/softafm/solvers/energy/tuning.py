"""Constants of the energy solver that no physics sets, each with what it is for.

They were chosen by the time and the largest error of the reference cases and the random contacts
(``benchmarks/reference_cases.py``, ``accuracy.py``): change one, and run both again.
"""

# Newton's method.

CLOSEST = 0.1
"""Smallest gap of a sound surface, in gaps at the contact edge: below it a guess has pierced."""

FARTHEST_GUESS = 0.5
"""Largest relative change of a gap in a first iteration that still is a correction of the guess."""

MOST_ITERATIONS = 8
"""Iterations after which there is no stable shape near the guess; a good one takes 1 to 3."""

TRUSTED = 0.1
"""Second correction, in units of the accuracy, below which it is left out."""

FORGOTTEN = 1.2
"""Factor by which the stored contraction estimate grows each time a second iteration is left out
because of it, so that it is measured again from time to time."""

# The descent in energy, used where no stable shape is near.

LARGEST_DESCENT = 0.4
"""Largest relative change of a gap in one step of the descent: a law is not quadratic beyond it."""

MOST_DESCENTS = 10_000

SUFFICIENT = 1e-4
"""Part of the energy that its slope promises which a step of the descent must gain (Armijo)."""

# Memory.

SHORT = 1e-2
"""Step over retardation time below which moments are series, as differences would cancel."""

STIFF = 4.5
"""Step over the relaxation time of a contact held rigidly above which the quadratic formula, like
Adams and Moulton's, comes near its bound of stability, 6, and the linear one serves."""

RINGING = 0.7
"""Ratio of successive overshoots of the linear formula from which it is damped."""

DAMPING = 1.5
"""Part of the quadratic's correction that damps it, with the other sign."""

# The frame that rides on the contact edge.

OPENING = 1.5
"""How much faster a frame closes on a contact that begins than its edge opens."""

FARTHEST_RIDE = 0.2
"""Largest move of the frame in a step, in contact radii."""

AT_REST = 0.2
"""Move of the edge in a step, in edge spacings, below which the frame stands still."""

SMALLEST_FRAME = 0.5
"""Smallest frame, in frames of the shape before: interpolation needs the same nodes in both."""

# Steps.

APPROACH = 0.3
"""Part of the gap that an approaching tip may cross in a step before it feels the surface."""

FELT = 3.0
"""Gap on the axis, in gaps at the contact edge, beyond which a contact has not been felt yet."""

RETRIED = 0.2
"""Part of a step that is tried next where no stable shape was found."""

SAFETY = 0.85
"""Part of the step that the error would just allow."""

REFUSED = 1.5
"""Error, in units of the one aimed at, from which a step is taken again."""

LEAST_RETRY, LEAST_GROWTH, MOST_GROWTH = 0.25, 0.3, 2.5
"""Bounds of the next step, in units of the last one: taken again; after success."""

AT_TRIGGER = 0.1
"""How near the force must come to the trigger, in units of the error allowed in a step."""
