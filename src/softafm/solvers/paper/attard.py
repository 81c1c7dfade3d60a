"""Attard's solver: the surface at equal nodes, its rates by iteration or by one linear solve."""

from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from softafm.bodies.half_space import refuse_other_bodies
from softafm.bodies.radial_functions import grid
from softafm.bodies.rings import ring_influence
from softafm.checks.validate import check_choice, check_positive, check_whole
from softafm.compiled.announce import announce_compilation
from softafm.instrument.motion import Motion
from softafm.progress import Progress
from softafm.solvers.history import History
from softafm.solvers.paper.stepping import ForwardEuler, Stepper, check_stepper
from softafm.units.quantities import LENGTH


@dataclass(frozen=True)
class Attard:
    """Equal segments of constant pressure and displacement: setups A and B of the paper's Table 2.

    Every step finds the rate of the surface from

        (I − J_g K P') u̇ = −R − ḣ0 J_g K p',

    where R is the creep (``softafm docs paper``). ``method="iterative"`` (setup A, Attard 2001)
    adjusts a guess, at first the rate of the step before, until both sides agree; ``"explicit"``
    (B, Rajabifar et al. 2021, equation 14) solves the linear system. The mode's ``tolerance`` has
    no influence: nodes and steps decide.

    Parameters
    ----------
    nodes
        Number of segments, 2 to 2000, each known at its middle.
    domain
        Radius rd beyond which the surface counts as flat, m; None derives it from contact and
        motion.
    method
        ``"iterative"`` or ``"explicit"``.
    steps
        Equal steps of the whole motion, shared out among its smooth pieces.
    stepper
        ``ForwardEuler()``, ``AdamsBashforth(order)`` or ``RungeKutta4()``.
    iteration_tolerance
        Miss of the rates at which an iteration ends, relative to the largest rate.
    relaxation
        Share ω of the miss by which a guess is adjusted, above 0 and at most 1; None takes
        2/(2 + ‖J_g K p'‖), the largest that is sure to converge where the contact is repulsive.
    most_iterations
        Iterations after which a step is given up.

    Raises
    ------
    ValueError
        If an option is out of range.
    """

    kind: ClassVar[str] = "attard"
    adaptive: ClassVar[bool] = False
    nodes: int = 70
    domain: Annotated[float, LENGTH] | None = None
    method: Literal["iterative", "explicit"] = "iterative"
    steps: int = 10_000
    stepper: Stepper = field(default_factory=ForwardEuler)
    iteration_tolerance: float = 1e-6
    relaxation: float | None = None
    most_iterations: int = 100_000

    def __post_init__(self) -> None:
        check_whole("nodes", self.nodes, 2, 2000)
        if self.domain is not None:
            object.__setattr__(self, "domain", check_positive("domain", self.domain, "m"))
        check_choice("method", self.method, ("iterative", "explicit"))
        check_whole("steps", self.steps, 1, 100_000_000)
        check_stepper(self.stepper)
        check_positive("iteration_tolerance", self.iteration_tolerance, "")
        if self.relaxation is not None and check_positive("relaxation", self.relaxation, "") > 1:
            raise ValueError(f"relaxation = {self.relaxation:g}: must be at most 1")
        check_whole("most_iterations", self.most_iterations, 1, 1_000_000_000)

    def solve(
        self,
        contact: Any,
        motion: Motion,
        *,
        stiffness: float | None = None,
        tolerance: float = 1e-2,
        profiles: bool = False,
        progress: Progress | None = None,
    ) -> History:
        """Carry the contact, flat and relaxed at first, through the motion.

        Parameters
        ----------
        contact, motion
            ``softafm.Contact`` and a motion, e.g. ``softafm.Triangle``.
        stiffness
            Stiffness of a lever that carries the tip and whose base moves so, N/m; None moves the
            tip itself.
        tolerance
            How close to periodic a steady motion has to be, in gaps of largest tension; otherwise
            without influence.
        profiles
            Keep the surface shapes.
        progress
            Callable of (fraction done, message), or None.

        Raises
        ------
        DivergedError
            If the surface blows up or an iteration does not converge.
        ValueError
            If the body is no half-space.
        """
        refuse_other_bodies(self, contact)
        with announce_compilation(self.kind):
            from softafm.solvers.paper import kernel as k
            from softafm.solvers.paper.run import (
                Discretisation,
                Iteration,
                choose_domain,
                list_beyond_domain,
                march,
            )

        domain = self.domain or choose_domain(contact, motion)
        segments = grid(self.nodes, "midpoint")
        radius = domain * segments.radius
        profile = contact.tip.profile(radius)
        far_rise, far_area = list_beyond_domain(contact.tip, domain, radius[-1])
        setup = k.Setup(
            kind=k.ITERATIVE if self.method == "iterative" else k.NODAL,
            carried=0.0,
            sign=1.0,
            influence=domain * ring_influence(segments.radius, segments.edges),
            shapes=np.zeros((self.nodes, 0)),
            unity=np.ones(self.nodes),
            profile=profile,
            profile_image=profile,
            radius=radius,
            area=2 * np.pi * domain * radius * segments.weight,
            far_rise=far_rise,
            far_area=far_area,
            axis=np.array([9 / 8, -1 / 8]),
        )
        iteration = Iteration(
            self.iteration_tolerance, self.relaxation or 0.0, self.most_iterations
        )
        return march(
            Discretisation(setup, np.zeros(self.nodes), domain), contact, motion, self,
            stiffness=stiffness, tolerance=tolerance, iteration=iteration, profiles=profiles,
            progress=progress,
        )  # fmt: skip

    def expected_seconds(self, contact: Any, motion: Motion) -> float:
        """Order of magnitude of a run, s on one core, as measured.

        How many iterations ``method="iterative"`` takes shows only in the run: 50 a rate are
        assumed, those of a tap on polyethylene; unstable contacts take many times more.
        """
        if self.method == "explicit":
            rate = 2e-6 + 1e-7 * self.nodes + 7e-11 * self.nodes**3
        else:
            rate = 2e-6 + 50 * (5e-8 + 1e-10 * self.nodes**2)
        return self.steps * self.stepper.rates_per_step * rate
