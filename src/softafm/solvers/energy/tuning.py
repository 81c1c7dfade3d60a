"""Constants of the energy solver that no physics sets, each with what it is for and why it is so.

Where no other place is named, ``benchmarks/tuning.py`` measures one: it prints steps, iterations
and the largest error of the reference cases at half and at twice its value. They were chosen by
these and by random contacts (``benchmarks/accuracy.py``): change one, and run both again.
"""

# Newton's method.

CLOSEST = 0.1
"""Smallest gap of a sound surface, in gaps at the contact edge: below it a guess has pierced."""

FARTHEST_GUESS = 0.5
"""Largest relative change of a gap in a first iteration that still is a correction of the guess."""

MOST_ITERATIONS = 8
"""Iterations after which there is no stable shape near the guess; a good one takes 1 to 3."""

TRUSTED = 0.1
"""Second correction, in units of the accuracy, below which it is left out. Larger ones cost slack
contacts and steady cycles more than they save (``softafm docs performance``, "What did not
help")."""

FORGOTTEN = 1.2
"""Factor by which the stored contraction estimate grows each time a second iteration is left out
because of it, so that it is measured again from time to time."""

EQUILIBRIUM_ERROR = 1e-3
"""Error of an equilibrium, relative to the gap, at a tolerance of 1e-2: below those of a step, as a
slack contact follows its edge by the softest of its shapes (``softafm docs performance``)."""

FARTHEST_RIDING_GUESS = 5.0
"""Largest relative change of a gap in a first iteration that rides with the edge; between 0.7 and 5
it made no difference."""

LARGEST_LANDING, MOST_LANDING = 0.5, 40
"""Largest relative change of a gap in an iteration towards a contact guessed from afar, and how
many of them may be taken."""

RIDING_ERROR = 0.1
"""Error of an equilibrium that is solved with its edge, in units of the other ones'."""

MOST_REFRAMES = 4
"""How often memory is carried to the frame that such an equilibrium has found."""

OF_THE_EDGE = 30.0
"""Weight of the relative change of the frame beside that of the gaps where an iteration ends."""

# The descent in energy, used where no stable shape is near.

LARGEST_DESCENT = 0.4
"""Largest relative change of a gap in one step of the descent: a law is not quadratic beyond it."""

MOST_DESCENTS = 10_000
"""Steps of the descent after which there is no stable surface; those of a fall need tens."""

SUFFICIENT = 1e-4
"""Part of the energy that its slope promises which a step of the descent must gain (Armijo; the
usual value, Nocedal and Wright, Numerical Optimization, 2006, section 3.1)."""

# Memory.

AT_ONCE = 1e-5
"""Creep time, in times in which the edge crosses the reach of the surface forces, below which creep
counts as instantaneous: its losses are that part of force times reach, and of a jump count as its.
At 3e-3 a slow curve on polyethylene jumped that does not (tests/test_spectroscopy.py)."""

SHORT = 1e-2
"""Step over retardation time below which moments are series, as differences would cancel: both are
then exact to 1e-8 (tests/test_energy_kernel.py, ``test_memory_of_a_linear_load``)."""

STIFF = 4.5
"""Step over the relaxation time of a contact held rigidly above which the quadratic formula, like
Adams and Moulton's, comes near its bound of stability, 6, and the linear one serves
(tests/test_energy_kernel.py, ``test_memory_of_a_contact_held_rigidly_never_grows``)."""

RINGING = 0.7
"""Ratio of successive overshoots of the linear formula from which it is damped (same test)."""

DAMPING = 1.5
"""Part of the quadratic's correction that damps it, with the other sign (same test)."""

ARCHIVE_SPACING, ARCHIVE_GROWTH = 0.05, 0.2
"""The mesh of memory that a tip comes back to, as ``COARSEST_SPACING`` and ``GROWTH`` are: the
dissipation of second taps on fluids was 1 to 5 % off without (tests/test_repeated_taps.py). With
half the growth a fluid shows the errors of interpolation in its steps, not in its result."""

AS_WIDE = 0.95
"""Edge, in the widest so far, from which the memory has no old rim far outside it."""

TOO_SLOW = 10.0, 1e4
"""Retardation time, in times of the motion, beyond which the energy of an element is summed up as
it is; of the period in steady cycles, where the element gathers the mean of the load."""

# The frame that rides on the contact edge.

RIDE_FROM = 0.25
"""Radius of the edge, in radii of the open contact, beyond which a slack contact is solved together
with it."""

OPENING = 1.5
"""How much faster a frame closes on a contact that begins than its edge opens."""

FARTHEST_RIDE = 0.2
"""Largest move of the frame in a step, in contact radii: extrapolation is not trusted beyond."""

AT_REST = 0.2
"""Move of the edge in a step, in edge spacings, below which the frame stands still."""

LAG = 2.0
"""How far the edge moves, in edge spacings, while the frame catches up with it: at once, slack
contacts amplify the change of mesh (``softafm docs performance``, "What did not help")."""

HELD, HELD_IF_FAR_SOFTER = 1.3, 2.6
"""Spacing of the nodes, in that aimed at, up to which they resolve an edge that recedes over them,
so that the frame of a sample with memory stays; the second one if it gets ``FAR_SOFTER`` in the
motion, as a Kelvin-Voigt solid does, and parts from the tip evenly. Half of the first leaves such a
solid chasing an edge that is none, twice costs 2 % of the loop of a slow curve on polyethylene
(tests/test_slow_and_soft.py)."""

HARDLY_SOFTER, FAR_SOFTER = 1e-3, 1e3
"""Compliance gained in a motion, in instantaneous ones: there is no memory; it is all memory."""

COVER = 0.2
"""Smallest frame of a contact that only repels, in those of its widest edge: the mesh covers all of
the dent, in which the tip may lie closely where it parts (tests/test_bodies.py)."""

SMALLEST_FRAME = 0.5
"""Smallest frame, in frames of the shape before: interpolation needs the same nodes in both."""

TRACE_FROM = 0.2
"""Move of the edge in a step, in edge spacings, from which the memory rides with it."""

SLACKER = 7.0
"""Tabor number of the softened sample from which on that pays: such a step costs 15 others."""

FIRST_PANEL, NEXT_PANEL = 0.8, 2.2
"""Width of the last panel of a step, in the shortest retardation time, and the next one's ratio."""

FORGOTTEN_TIMES = 25.0
"""Longest retardation times after which nothing is left of a load, to 1e-11."""

STRAIGHTEST = 0.8
"""Largest bend of the edge's path in a step, relative to its rise: it must not turn back."""

# The mesh.

EXTENT = 8.0
"""Radius of every mesh, in contact radii; beyond it the surface counts as flat
(tests/test_half_space.py: smooth pressures are met to a few 1e-5)."""

COARSEST_SPACING = 0.3
"""Node spacing at the edge of the coarsest mesh, in contact radii; each finer one has half."""

SPACING = 0.2
"""Node spacing at the edge aimed at, in widths of the cohesive zone, at a tolerance of 1e-2."""

GROWTH = 0.3
"""Logarithmic growth of the spacing a node away from the edge (``softafm docs performance``, "What
did not help": 0.45 slips in slack contacts)."""

SOFTER, GROWTH_IF_SOFTER, SPACING_IF_FAR_SOFTER = 20.0, 0.2, 0.5
"""The same where a sample gains more compliance than the first, in instantaneous ones, and the part
of the spacing at the edge where it is all memory (``FAR_SOFTER``): the largest force of a slow tap
was 2.4 % off, the pull-off of a punch 3 %; ramps take fewer steps, as the edge catches on none."""

GROWTH_IF_SLACK = 0.22
"""The same where an edge rides and nothing creeps: the largest force of sticky taps, a fifth of the
pull-off, was 4 % off."""

GROWTH_IF_STEEP = 0.15
"""The same for slack contacts of punches: the rim bends the profile, wherever the edge is. What a
sample under one lost was 15 % off."""

APEX, FINEST_GROWTH = 2.5, 0.6
"""Radius of a round apex, in that of the contact, times the first is the part of that growth that
a tip sharper than a paraboloid gets, down to the second (the pull-off of a cone pressed to nine
times its apex was 4.8 % off)."""

SLACK = 4.0
"""Tabor number of the softened sample from which on the edge of a contact yields to small errors,
so that it is solved for together with the surface."""

FINER_THAN_NEEDED, COARSER_THAN_NEEDED = 0.35, 1.3
"""Spacing, in units of the one aimed at, at which the mesh is exchanged: more than a factor of two
apart, which is that between meshes, or it would be exchanged back at once."""

FINEST_TARGET = 0.02
"""Smallest spacing aimed at after slips of the edge, in widths of the cohesive zone."""

# Steps.

PREDICTION_ERROR = 0.03
"""Largest error of the extrapolated shape, relative to the gap, at a tolerance of 1e-2."""

STRICTER = 0.5
"""Part of that where memory rides with the edge: the same steps, and viscous losses that were 1 %
off are half as far."""

MEMORY_ERROR = 0.005
"""Largest error of the memory in a step, relative to the gap, at that tolerance."""

FORCE_ERROR = 0.0075
"""Largest error of the extrapolated force, relative to itself or to the largest attraction so far,
if that is more, at that tolerance. Where it has fallen again, the largest repulsion is no measure:
it may be a thousand times the pull-off."""

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
"""How near the force must come to the trigger, in units of the error allowed in a step
(tests/test_setpoint.py)."""

FEWEST_STEPS = 12
"""Steps between two stops at a tolerance of 1e-2, however little happens: curves need points."""

FIRST_STEP = 0.005
"""First step of a motion, in times to the first stop; tests/test_reproducible.py varies it from a
thousandth to three times that, and V and E change by 2e-4 at most."""

AFTER_A_BREAK, FIRST_PART_OF_GAP = 0.1, 0.03
"""First step after a break of the motion: in units of the last one before it, and, in contact, in
which the tip may move by a part of the gap at the edge, at a tolerance of 1e-2."""

SHORTEST_STEP = 1e-4
"""Shortest step before a fall, in retardation times or the time in which the tip crosses the gap of
the contact edge, whichever is less."""

SHORTER = 1e-3
"""The same for slack contacts, in units of the others': after a jump their edges run fast."""

# Levers with inertia (``benchmarks/dynamics.py``).

FLIES_FROM = 8.0
"""Gap on the axis, in gaps at the contact edge, from which the tip flies: the surface yields to it
by less than the next part of that gap."""

HARDLY_SAGS = 1e-3
"""Elastic displacement of the surface under the tip, in gaps, from which on no tip flies."""

STILL_FAR = 1.5
"""Gap, in those from which it flies, beyond which a tip that comes down still begins to."""

TAKEN_OVER = 0.5
"""Gap, in the same, below which no step of a flight may end: the next step solves for the surface.
"""

FLIGHT_ANGLE, FLIGHT_PART = 0.35, 0.2
"""Longest step of a flight, in radians of the fastest mode, and in times to the surface: exact but
for the change of a weak force."""

ALMOST = 1e-9
"""Change of the gap, relative to it, below which the force at the end of such a step is known."""

FAINT = 1e-4
"""Force, in the least to be felt, below which no higher harmonics of it are gathered."""

LANDED = 0.06
"""First step after a flight, in times to the surface."""

LATE = 0.015
"""Stiffness of the contact, in that of the lever in a step, up to which a lever is corrected for
the bend of the force: beyond, in long steps in contact, that pumps energy into the lever."""

REMEMBERED = 10.0
"""Periods in which the largest attraction, against which errors of the force count, is forgotten.
"""

# Falls.

STIFF_SHARE = 0.2
"""Largest share of the instantaneous compliance that is not delayed in a fall: with it alone the
contact is stable, and the less is delayed the fewer steps a fall takes."""

FALL_DECADES = 4
"""How many powers of ten faster than the shortest step the fictitious creep of a fall is."""

MOST_PATIENCE = 8
"""How often a fall that has not ended is given ten times as many of these creep times."""

ERROR_IN_A_FALL = 0.2
"""Errors of prediction and memory allowed in the steps of a fall, of which only the end counts."""

END_OF_FALL = 1e-4
"""How far the surface may be from its end, in gaps of the contact edge, where a fall ends."""

MOST_TRIES_IN_A_FALL = 5000.0
"""Steps after which a fall is left to the descent in energy; most take a hundred."""

SLIPS_AGAIN = 20
"""A fall within so many of its durations after another makes the next one pass twice as long."""

JUMP_OF_GAP, JUMP_OF_EDGE = 0.1, 0.05
"""Relative change of the gap on the axis or of the edge from which a fall is recorded as a jump; a
smaller one is a slip of the edge from node to node."""

# Steady cycles (tests/test_steady.py).

MOST_CYCLES = 150
"""Cycles after which a run that is not steady ends, with a warning; most take 4 to 20."""

STEADY = 1e-2
"""How far off the memory may start, in gaps of the contact edge, in a cycle that counts as steady,
at a tolerance of 1e-2: what the errors of a cycle leave."""

SURELY_STEADY = 1e-4
"""The same below which a first cycle is steady, with none before it to compare."""

MUCH_SLOWER = 4.0
"""Compliance that a steady cycle finds as it was left, in that which acts within the cycle, beyond
which the dent is sought by Newton's method."""

STAGNANT = 8
"""Cycles in which the start must become twice as good, or all that is left are errors."""

# Doubts.

SHARPEST = 3.2
"""Sharpness of a law beyond which an edge may catch on the nodes (``benchmarks/every_contact.py``:
Dugdale's law with less smoothing than 0.07 is up to 2 % off)."""

LEAST_ENERGY = 0.02
"""Energy that still counts, in largest forces times reaches of the surface law."""
