"""The enhanced Attard's model: the surface as a sum of radial functions."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np

from softafm.bodies import radial_functions as functions
from softafm.bodies.half_space import refuse_other_bodies
from softafm.bodies.rings import ring_influence
from softafm.checks.validate import check_choice, check_positive, check_whole
from softafm.compiled.announce import announce_compilation
from softafm.instrument.motion import Motion
from softafm.progress import Progress
from softafm.solvers.history import History
from softafm.solvers.paper.stepping import AdamsBashforth, Stepper, check_stepper
from softafm.units.quantities import LENGTH

if TYPE_CHECKING:
    from softafm.solvers.paper.run import Discretisation

# What is expanded: u = carried·(h0 + g) + sign·Σ a_i f_i.
_EXPANSIONS = {"deformation": (0.0, 1.0), "gap": (1.0, -1.0), "bounded-gap": (0.0, -1.0)}


@dataclass(frozen=True)
class EnhancedAttard:
    """Surface expanded in radial functions: setups C to G of the paper's Table 2.

    | setup | basis  | expand      | orthogonal |
    |-------|--------|-------------|------------|
    | C     | cosine | deformation | no         |
    | D     | cosine | gap         | no         |
    | E     | cosine | deformation | yes        |
    | F     | cosine | gap         | yes        |
    | G     | bessel | deformation | yes        |

    The rates of the coefficients follow from a linear system: with ``orthogonal`` its projection on
    the same functions (Rajabifar et al. 2021, equations 21 to 23), else the least squares of
    equation (16) over the nodes. The mode's ``tolerance`` has no influence: functions, nodes and
    steps decide.

    Parameters
    ----------
    functions
        Number of functions, n_b + 1 in the paper, at most the number of nodes.
    nodes
        Number of radial nodes for the integrals, 2 to 2000.
    basis
        ``"cosine"``, or ``"bessel"``: J0 with the zeros of J1, and the constant.
    expand
        ``"deformation"``, ``"gap"`` (h itself, equation 25) or ``"bounded-gap"`` (h less the height
        of the tip above the flat surface, which must give what ``"deformation"`` gives).
    orthogonal
        Project on the functions, or take least squares.
    domain
        Radius rd beyond which the surface counts as flat, m; None derives it from contact and
        motion.
    quadrature
        ``"trapezoid"``, as the paper says, or ``"midpoint"``, as its authors' program does.
    steps
        Equal steps of the whole motion, shared out among its smooth pieces.
    stepper
        ``AdamsBashforth(order)``, ``ForwardEuler()`` or ``RungeKutta4()``.

    Raises
    ------
    ValueError
        If an option is out of range.
    """

    kind: ClassVar[str] = "enhanced-attard"
    adaptive: ClassVar[bool] = False
    functions: int = 25
    nodes: int = 70
    basis: Literal["cosine", "bessel"] = "cosine"
    expand: Literal["deformation", "gap", "bounded-gap"] = "deformation"
    orthogonal: bool = True
    domain: Annotated[float, LENGTH] | None = None
    quadrature: Literal["trapezoid", "midpoint"] = "trapezoid"
    steps: int = 10_000
    stepper: Stepper = field(default_factory=AdamsBashforth)

    def __post_init__(self) -> None:
        check_whole("nodes", self.nodes, 2, 2000)
        check_whole("functions", self.functions, 1, self.nodes)
        check_choice("basis", self.basis, functions.BASES)
        check_choice("expand", self.expand, tuple(_EXPANSIONS))
        check_choice("orthogonal", self.orthogonal, (True, False))
        if self.domain is not None:
            object.__setattr__(self, "domain", check_positive("domain", self.domain, "m"))
        check_choice("quadrature", self.quadrature, functions.QUADRATURES)
        check_whole("steps", self.steps, 1, 100_000_000)
        check_stepper(self.stepper)

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
            If the surface blows up.
        ValueError
            If the body is no half-space.
        """
        refuse_other_bodies(self, contact)
        with announce_compilation(self.kind):
            from softafm.solvers.paper.run import choose_domain, march

        domain = self.domain or choose_domain(contact, motion)
        surface = self._discretise(contact.tip, domain, float(motion.height(motion.breaks[0])))
        return march(
            surface, contact, motion, self, stiffness=stiffness, tolerance=tolerance,
            profiles=profiles, progress=progress,
        )  # fmt: skip

    def expected_seconds(self, contact: Any, motion: Motion) -> float:
        """Order of magnitude of a run, s on one core, as measured."""
        rate = 2e-6 + 3e-8 * self.nodes + self.functions**2 * (8e-9 + 4e-11 * self.nodes)
        if not self.orthogonal:
            rate += 6e-11 * self.functions * self.nodes**2
        return self.steps * self.stepper.rates_per_step * rate

    def _discretise(self, tip: Any, domain: float, height: float) -> "Discretisation":
        from softafm.solvers.paper import kernel as k
        from softafm.solvers.paper.run import Discretisation, list_beyond_domain

        count, basis = self.functions, self.basis
        segments = functions.grid(self.nodes, self.quadrature)
        radius = domain * segments.radius
        profile = tip.profile(radius)
        profile_coefficients = functions.project(basis, count, lambda r: tip.profile(domain * r))
        constant = np.zeros(count)
        constant[0] = 1.0
        carried, sign = _EXPANSIONS[self.expand]
        if self.orthogonal:
            responses = functions.responses(basis, count, tuple(segments.radius.tolist()))
            influence = responses * segments.weight / functions.norms(basis, count)[:, None]
            unity, profile_image = constant, profile_coefficients
        else:
            influence = ring_influence(segments.radius, segments.edges)
            unity, profile_image = np.ones(self.nodes), profile
        far_rise, far_area = list_beyond_domain(tip, domain, radius[-1])
        setup = k.Setup(
            kind=k.ORTHOGONAL if self.orthogonal else k.LEAST_SQUARES,
            carried=carried,
            sign=sign,
            influence=domain * influence,
            shapes=np.ascontiguousarray(functions.evaluate(basis, count, segments.radius).T),
            unity=unity,
            profile=profile,
            profile_image=profile_image,
            radius=radius,
            area=2 * np.pi * domain * radius * segments.weight,
            far_rise=far_rise,
            far_area=far_area,
            axis=np.array([1.0, 0.0] if self.quadrature == "trapezoid" else [9 / 8, -1 / 8]),
        )
        flat = carried * (height * constant + profile_coefficients)
        return Discretisation(setup, flat, domain)
