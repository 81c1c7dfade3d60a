"""What the compiled loops of the energy solver work on, and the types that numba knows it by.

Lengths in m, pressures in Pa, times in s. The surface is known on nodes r_i = a ξ_i of a unit mesh
(softafm.bodies.mesh) in a frame of radius a that follows the contact edge. Memory is carried as
displacements: q = K p and y_m = K w_m with τ_m ẏ_m = q − y_m, so that u = −(J_g q + Σ J_m y_m), and
a change of frame is an interpolation of smooth fields.
"""

from typing import NamedTuple

import numpy as np
from numba import float64, from_dtype, int64, types

from softafm.bodies.mesh import UnitMesh
from softafm.compiled.functions import CompiledFunction

VECTOR = float64[::1]
MATRIX = float64[:, ::1]
CONSTANT_VECTOR = types.Array(float64, 1, "C", readonly=True)
CONSTANT_MATRIX = types.Array(float64, 2, "C", readonly=True)

# Why `advance` came back.
FINISHED, FULL, REMESH, FALL, STUCK, TRIGGERED, TABULATE = range(7)

# Rows of `fields`: the last three shapes, the last three loads q, then one per element y_m.
DEFORMATION, EARLIER, EARLIEST, LOAD_EARLIEST, LOAD_EARLIER, LOAD, MEMORY = range(7)

# Entry of the law's parameters: where its gaps are counted from. The solver's gaps are above it.
ORIGIN = 0


def record(*names: str) -> np.dtype:
    """Return the type of a record of floats by their names."""
    return np.dtype([(name, float) for name in names], align=True)


CLOCK_FIELDS = record(
    "time",  # the instant, s
    "step",  # the step to try, s
    "taken", "taken_earlier",  # the last two steps, s
    "frame", "frame_earlier", "frame_earliest",  # radii of the frames of the last three shapes, m
    "edge", "edge_earlier",  # radius of the contact edge, m
    "felt", "felt_earlier",  # the same, or of the dent that a tip makes without contact, m
    "widest",  # the largest of these so far, m, in steady cycles of the last cycle
    "zone",  # width of the cohesive zone at the edge, m, 0 out of contact
    "axis_gap",  # gap on the axis, m
    "force", "force_earlier", "force_earliest",  # N
    "force_scale",  # the largest attraction so far, or a force to be felt, N
    "deflection", "deflection_earlier", "deflection_earliest",  # of the lever, m
    "history",  # number of past shapes fit for extrapolation
    "tries",  # attempted steps so far
    "newtons",  # iterations of Newton's method so far
    "wanted",  # radius of a frame whose stiffness is to be tabulated, m
    # How large a second correction of Newton's was for the square of the first; 0 if that is not
    # known, inf if it is no guide.
    "contraction",
    "rides",  # number of past shapes that Newton's method rode with: frame and edge are one
    "found",  # radius of the frame that it found, m
    "stability",  # s of the last shape found so: positive if it is stable, 0 at the fold
    "flown",  # time since which the fields are those of the start of a flight, s
    "grip",  # stiffness of the contact, in that of a swinging lever in the last step
    "bend",  # second derivative of the force at the last step of such a lever, N/s², or 0
)  # fmt: skip
"""State of a run besides its fields."""

RECORD_FIELDS = record(
    "time",  # s
    "height",  # of the tip, m
    "force",  # N
    "edge",  # radius of the contact edge, m
    "axis",  # displacement of the surface on the axis, m
    "loss",  # power dissipated in the sample, W
    "lost",  # energy dissipated in it during the step, J
    "coarseness",  # node spacing at the edge over the width of the cohesive zone
    "frame",  # radius of the frame, m
    "jump",  # energy released if an elastic jump led there, J, else 0
)
"""What is kept of every step."""


class Mesh(NamedTuple):
    """A ``softafm.bodies.mesh.UnitMesh`` as the kernels take it, with the stiffness on it."""

    nodes: np.ndarray
    masses: np.ndarray
    stiffness: np.ndarray
    edge_spacing: float
    growth: float
    far: np.ndarray
    far_masses: np.ndarray
    slopes: np.ndarray
    decay: float


def make_mesh(mesh: UnitMesh, stiffness: np.ndarray, decay: float) -> Mesh:
    """Return a mesh with the stiffness and the ``decay``, 1/m, of a body, for the kernels."""
    return Mesh(
        mesh.nodes, mesh.masses, stiffness, mesh.edge_spacing, mesh.growth, mesh.far,
        mesh.far_masses, mesh.slopes, decay,
    )  # fmt: skip


class Table(NamedTuple):
    """Stiffness of a body on a mesh in some frames, from which that of others is interpolated.

    ``entries`` (k, n, n) are those of the frames e^(``start`` + i ``step``), m. What is ``found``
    (n, n) is what the mesh has for its stiffness; of shape (0, 0) if all frames are alike.
    """

    entries: np.ndarray
    start: float
    step: float
    found: np.ndarray


class Functions(NamedTuple):
    """Compiled functions of one run: see ``softafm.compiled.functions``."""

    height: CompiledFunction
    profile: CompiledFunction
    pressure: CompiledFunction
    respond: CompiledFunction
    accept_force: CompiledFunction
    potential: CompiledFunction


class Parameters(NamedTuple):
    """Parameters of height, tip profile and surface law; J_g, J_1, ... in 1/Pa; τ_1, ... in s; and
    those of the lever."""

    height: np.ndarray
    tip: np.ndarray
    law: np.ndarray
    compliance: np.ndarray
    retardation: np.ndarray
    lever: np.ndarray


class Background(NamedTuple):
    """Memory from before ``since``, s, which only fades: y_m = values_m e^(−(t − since)/τ_m).

    ``values`` (elements, nodes), or none, live on a mesh of this edge spacing and growth that ends
    at ``end`` in a frame of radius ``frame``, m, and fall by the ``decay`` of the body beyond.
    On the ``nodes`` of that mesh the memory since then is gathered, too, as it is on the mesh that
    rides: the rows of ``gained`` (elements + 10, nodes), if there are values, are the load before
    and now, one y_m for each element, and 8 to work in.
    """

    values: np.ndarray
    frame: float
    end: float
    edge_spacing: float
    growth: float
    decay: float
    since: float
    nodes: np.ndarray
    gained: np.ndarray


class Controls(NamedTuple):
    """What steers ``advance``: times s, lengths m, speed m/s, the rest dimensionless.

    ``prediction``, ``memory`` and ``force`` are the errors allowed per step, ``newton`` that of an
    equilibrium; all relative to the gap, but ``force`` to the force itself, or where that is less
    to the largest attraction so far.
    ``slack`` is how far the edge moves, in edge spacings, while the frame catches up with it; the
    frame stays behind an edge where it is that its nodes lie closer than ``held`` times the zone.
    Nor does it close to less than ``cover`` of the widest edge so far, or below ``least_frame``, m.
    Remeshing is asked for when the coarseness of a record leaves ``finest`` to ``coarsest``.
    The step in which the force reaches ``trigger``, N, is the last. A contact whose edge is beyond
    ``ride_from``, m, is solved together with its edge.
    """

    end: float
    shortest_step: float
    longest_step: float
    top_speed: float
    open_frame: float
    edge_gap: float
    open_gap: float
    prediction: float
    memory: float
    force: float
    newton: float
    slack: float
    held: float
    cover: float
    least_frame: float
    finest: float
    coarsest: float
    most_tries: float
    trigger: float
    ride_from: float
    trace_from: float


class Swing(NamedTuple):
    """What is known of a tip that swings on a lever with inertia; no ``pull`` for other levers.

    ``pull`` (n,) is force times height squared, N m², at heights e^(``start`` + i ``spacing``), m,
    above a surface that does not deform. A tip farther than ``far``, m, flies. ``fading``, s, is
    the time in which the largest attraction is forgotten, down to the ``least`` force to be felt,
    N. A row of its strokes holds, of the step that leads to a record, the force at its start, N,
    the second derivative of the force in the step before, N/s², and of its end the deflection, then
    those of the modes, m, and their speeds, m/s.
    """

    pull: np.ndarray
    start: float
    spacing: float
    far: float
    fading: float
    least: float


class Room(NamedTuple):
    """Memory for the compiled loops to work in, for n nodes, f radii beyond and m elements."""

    rows: np.ndarray
    """(16, n + 1)."""
    fields: np.ndarray
    """(10 + 5m, n)."""
    hessian: np.ndarray
    """(n + 1, n + 1)."""
    far: np.ndarray
    """(4, f)."""
    weights: np.ndarray
    """(m + 1, 5)."""
    gain: np.ndarray
    """(n, n)."""
    system: np.ndarray
    """(n + 2, n + 2)."""
    change: np.ndarray
    """(1, n + 2)."""


MESH = types.NamedTuple(
    (
        CONSTANT_VECTOR, CONSTANT_VECTOR, CONSTANT_MATRIX, float64, float64,
        CONSTANT_VECTOR, CONSTANT_VECTOR, CONSTANT_MATRIX, float64,
    ),
    Mesh,
)  # fmt: skip
PARAMETERS = types.NamedUniTuple(VECTOR, len(Parameters._fields), Parameters)
TABLE = types.NamedTuple((float64[:, :, ::1], float64, float64, MATRIX), Table)
BACKGROUND = types.NamedTuple((MATRIX, *[float64] * 6, CONSTANT_VECTOR, MATRIX), Background)
CONTROLS = types.NamedUniTuple(float64, len(Controls._fields), Controls)
CLOCK = from_dtype(CLOCK_FIELDS)
SWING = types.NamedTuple((VECTOR, *[float64] * 5), Swing)
PIVOTS = int64[::1]
ROOM = types.NamedUniTuple(MATRIX, len(Room._fields), Room)
RECORDS = types.Array(from_dtype(RECORD_FIELDS), 1, "C")


def no_background() -> Background:
    """Return the background of a surface that has no past."""
    nodes = np.empty(0)
    nodes.setflags(write=False)
    return Background(np.empty((0, 0)), 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, nodes, np.empty((0, 0)))


def new_clock() -> np.void:
    """Return a clock of zeros."""
    return np.zeros(1, CLOCK_FIELDS)[0]


def new_room(nodes: int, far: int, elements: int) -> Room:
    """Return room for a mesh and a number of elements."""
    return Room(
        np.empty((16, nodes + 1)),
        np.empty((10 + 5 * elements, nodes)),
        np.empty((nodes + 1, nodes + 1)),
        np.empty((4, far)),
        np.empty((elements + 1, 5)),
        np.empty((nodes, nodes)),
        np.empty((nodes + 2, nodes + 2)),
        np.empty((1, nodes + 2)),
    )
