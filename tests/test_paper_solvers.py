"""The paper's solvers, setups A to G, against plain twins written from its equations."""

import dataclasses
import warnings
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipkm1, j0, jn_zeros

import softafm as sa
from softafm import solvers
from softafm.solvers.paper.stepping import AdamsBashforth, ForwardEuler, RungeKutta4

R, DOMAIN = 10e-9, 8e-9
NODES, FUNCTIONS, STEPS = 12, 5, 200
E0, E_INF, TAU = 2e9, 0.5e9, 1e-4
TIP = sa.Paraboloid(R)
LAW = sa.LennardJones(1e-19, 0.3e-9)
SOLID = sa.StandardLinearSolid(E0, E_INF, TAU, 0.3)
CONTACT = sa.Contact(TIP, SOLID, LAW)
RAMP = sa.Triangle(start=1.5e-9, turn=-0.6e-9, speed=1e-5)
SMOOTH_TAP = sa.Contact(
    sa.Paraboloid(12e-9),
    sa.StandardLinearSolid(2.5e9, 0.3e9, 1.2e-7, 0.45),
    sa.LennardJones(1e-19, 0.3e-9),
)
SMOOTH = (40e-9, 36e-9, 250e3)
"""A tap that crosses no elastic fold: amplitude, mean height and frequency."""

J_G, J_RELAXED = (1 - 0.3**2) / E0, (1 - 0.3**2) / E_INF


def kernel(r, s):
    larger, smaller = max(r, s), min(r, s)
    return 4 / (np.pi * larger) * ellipkm1((larger - smaller) * (larger + smaller) / larger**2)


def integral_of_kernel(weight, s, low, high):
    """∫ weight(r) k(r, s) dr; QUADPACK copes with a logarithm at the end of an interval."""
    ends = [low, s, high] if low < s < high else [low, high]
    return sum(
        quad(lambda x: weight(x * R) * kernel(x, s / R), a / R, b / R, epsabs=0, epsrel=1e-10)[0]
        for a, b in pairwise(ends)
    )


def slope(gap):
    return 1e-19 / (6 * np.pi * gap**4) * (3 - 9 * (0.3e-9 / gap) ** 6)


MIDPOINTS = (np.arange(NODES) + 0.5) * DOMAIN / NODES
RINGS = np.array(
    [
        [
            integral_of_kernel(lambda s: s, r, j * DOMAIN / NODES, (j + 1) * DOMAIN / NODES)
            for j in range(NODES)
        ]
        for r in MIDPOINTS
    ]
)


TRAPEZOID = np.linspace(0, DOMAIN, NODES)
WAVES = {
    "cosine": np.pi * np.arange(FUNCTIONS) / DOMAIN,
    "bessel": np.concatenate([[0], jn_zeros(1, FUNCTIONS - 1)]) / DOMAIN,
}


def shape(basis, j, r):
    return np.cos(WAVES[basis][j] * r) if basis == "cosine" else j0(WAVES[basis][j] * r)


class Nodal:
    """Equation (14), its right side with the missing 1/τ, at midpoints: setup B."""

    nodes, weights = MIDPOINTS, np.full(NODES, DOMAIN / NODES)

    def start(self, height):
        return np.zeros(NODES)

    def deformation(self, state, height):
        return state

    def rates(self, u, height, speed):
        gap = height + self.nodes**2 / (2 * R) - u
        u_inf = -J_RELAXED * RINGS @ LAW.pressure(gap)
        left = J_G * RINGS * slope(gap) - np.eye(NODES)
        return np.linalg.solve(left, (u - u_inf) / TAU + speed * J_G * RINGS @ slope(gap))


class LeastSquares:
    """Equation (16) at midpoints, as well as the functions can: setups C and D.

    With the gap expanded, u̇ = ḣ0 − Σ ȧ_i f_i in equation (14).
    """

    nodes, weights = MIDPOINTS, np.full(NODES, DOMAIN / NODES)

    def __init__(self, basis="cosine", expand="deformation"):
        self.gap_expanded = expand == "gap"
        self.f = np.column_stack([shape(basis, j, self.nodes) for j in range(FUNCTIONS)])
        self.flat = flat_gap(basis, 0) if self.gap_expanded else np.zeros(FUNCTIONS)

    def start(self, height):
        return self.flat + self.gap_expanded * height * np.eye(FUNCTIONS)[0]

    def deformation(self, a, height):
        tip = height + self.nodes**2 / (2 * R)
        return tip - self.f @ a if self.gap_expanded else self.f @ a

    def rates(self, a, height, speed):
        u = self.deformation(a, height)
        gap = height + self.nodes**2 / (2 * R) - u
        relaxing = (u + J_RELAXED * RINGS @ LAW.pressure(gap)) / TAU
        left = J_G * RINGS @ (slope(gap)[:, None] * self.f) - self.f
        pulled = (
            -speed - relaxing
            if self.gap_expanded
            else (relaxing + speed * J_G * RINGS @ slope(gap))
        )
        return np.linalg.lstsq(left, pulled)[0]


class Orthogonal:
    """Equations (21) to (23), corrected, by the trapezoidal rule: setups E, F and G."""

    nodes = TRAPEZOID
    weights = np.array([0.5, *[1.0] * (NODES - 2), 0.5]) * DOMAIN / (NODES - 1)

    def __init__(self, basis="cosine", expand="deformation"):
        self.gap_expanded = expand == "gap"
        self.f = np.column_stack([shape(basis, j, self.nodes) for j in range(FUNCTIONS)])
        along = (lambda r: r) if basis == "bessel" else (lambda r: 1.0)
        self.zeta = [
            quad(lambda r, j=j: shape(basis, j, r) ** 2 * along(r), 0, DOMAIN)[0]
            for j in range(FUNCTIONS)
        ]
        self.s_rho = np.zeros((FUNCTIONS, NODES))
        for j in range(FUNCTIONS):
            for i, s in enumerate(self.nodes[1:], start=1):  # s ρ_j(s) vanishes on the axis
                self.s_rho[j, i] = s * integral_of_kernel(
                    lambda r, j=j: shape(basis, j, r) * along(r), s, 0, DOMAIN
                )
        self.flat = flat_gap(basis, 0) if self.gap_expanded else np.zeros(FUNCTIONS)

    start, deformation = LeastSquares.start, LeastSquares.deformation

    def rates(self, a, height, speed):
        gap = height + self.nodes**2 / (2 * R) - self.deformation(a, height)
        p, dp = self.weights * LAW.pressure(gap), self.weights * slope(gap)
        left, right = np.empty((FUNCTIONS, FUNCTIONS)), np.empty(FUNCTIONS)
        for j in range(FUNCTIONS):
            for i in range(FUNCTIONS):
                left[j, i] = J_G * np.sum(dp * self.f[:, i] * self.s_rho[j])
            left[j, j] -= self.zeta[j]
            load = J_RELAXED * np.sum(p * self.s_rho[j])
            if self.gap_expanded:  # c_j = ∫f_j dr, g_j = ∫r² f_j dr as in a_j ζ_j − h0 c_j − g_j/2R
                c = self.zeta[0] if j == 0 else 0.0
                right[j] = -speed * c - load / TAU
                right[j] += (a[j] * self.zeta[j] - height * c - self.flat[j] * self.zeta[j]) / TAU
            else:
                right[j] = (a[j] * self.zeta[j] + load) / TAU
                right[j] += speed * J_G * np.sum(dp * self.s_rho[j])
        return np.linalg.solve(left, right)


def flat_gap(basis, height):
    """Coefficients of the gap over a flat surface."""
    along = (lambda r: r) if basis == "bessel" else (lambda r: 1.0)
    return np.array(
        [
            quad(lambda r, j=j: r**2 / (2 * R) * shape(basis, j, r) * along(r), 0, DOMAIN)[0]
            / quad(lambda r, j=j: shape(basis, j, r) ** 2 * along(r), 0, DOMAIN)[0]
            for j in range(FUNCTIONS)
        ]
    )


def euler(twin, motion, steps):
    """Forces of forward Euler steps, equation (26), and the tail beyond the domain."""
    step = motion.breaks[-1] / steps
    state, forces = twin.start(motion.start), []
    for n in range(steps + 1):
        height = motion.height(n * step)
        u = twin.deformation(state, height)
        gap = height + twin.nodes**2 / (2 * R) - u
        force = 2 * np.pi * np.sum(twin.weights * LAW.pressure(gap) * twin.nodes)
        rim = height + DOMAIN**2 / (2 * R) - u[-1]
        forces.append(force + 2 * np.pi * R * LAW.potential(rim))
        speed = -motion.speed if n < steps // 2 else motion.speed
        state = state + step * twin.rates(state, height, speed)
    return np.array(forces)


SETUPS = {
    "A": (
        Nodal(),
        solvers.Attard(NODES, DOMAIN, "iterative", STEPS, iteration_tolerance=1e-13),
    ),
    "B": (Nodal(), solvers.Attard(NODES, DOMAIN, "explicit", STEPS)),
}
for letter, (basis, expand, orthogonal) in {
    "C": ("cosine", "deformation", False),
    "D": ("cosine", "gap", False),
    "E": ("cosine", "deformation", True),
    "F": ("cosine", "gap", True),
    "G": ("bessel", "deformation", True),
    "G with the gap": ("bessel", "gap", True),
}.items():
    SETUPS[letter] = (
        (Orthogonal if orthogonal else LeastSquares)(basis, expand),
        solvers.EnhancedAttard(
            FUNCTIONS, NODES, basis, expand, orthogonal, DOMAIN,
            "trapezoid" if orthogonal else "midpoint", STEPS, ForwardEuler(),
        ),
    )  # fmt: skip


@pytest.mark.parametrize("name", SETUPS)
def test_steps_are_those_of_the_plain_twin(name):
    twin, solver = SETUPS[name]
    expected = euler(twin, RAMP, STEPS)
    found = solver.solve(CONTACT, RAMP).force
    scale = np.abs(expected).max()
    assert scale > 1e-9
    assert np.abs(found - expected).max() < 1e-8 * scale


# Steppers


@pytest.mark.parametrize(
    ("order", "weights"),
    [
        (1, [1]),
        (2, [3 / 2, -1 / 2]),
        (3, [23 / 12, -16 / 12, 5 / 12]),
        (4, [55 / 24, -59 / 24, 37 / 24, -9 / 24]),
        (5, [1901 / 720, -2774 / 720, 2616 / 720, -1274 / 720, 251 / 720]),
    ],
)
def test_weights_of_adams_and_bashforth(order, weights):
    """Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, table III.1.1."""
    assert np.allclose(AdamsBashforth(order).weights, weights, rtol=0, atol=1e-13)


def test_adams_bashforth_of_first_order_is_euler():
    a = small(stepper=AdamsBashforth(1)).solve(CONTACT, RAMP).force
    b = small(stepper=ForwardEuler()).solve(CONTACT, RAMP).force
    assert np.array_equal(a, b)


def small(**options):
    return solvers.EnhancedAttard(FUNCTIONS, 20, domain=DOMAIN, **options)


@pytest.mark.parametrize(
    ("stepper", "order"),
    [(ForwardEuler(), 1), (RungeKutta4(), 4)] + [(AdamsBashforth(n), n) for n in (2, 3, 4, 5)],
)
def test_order_of_convergence(stepper, order):
    """Forces at equal instants against many more steps, over a ramp with a corner."""
    steps = np.array([500, 1000, 2000])
    exact = small(stepper=RungeKutta4(), steps=16000).solve(CONTACT, RAMP).force
    errors = []
    for count in steps:
        force = small(stepper=stepper, steps=int(count)).solve(CONTACT, RAMP).force
        errors.append(np.abs(force - exact[:: 16000 // count]).max())
    found = np.log2(errors[-2] / errors[-1])
    assert order - 0.4 < found < order + 1


# Setups among each other


def test_iteration_agrees_with_the_linear_solve_to_its_tolerance():
    exact = solvers.Attard(20, DOMAIN, "explicit", 400).solve(CONTACT, RAMP).force
    scale = np.abs(exact).max()
    misses = []
    for tolerance in (1e-3, 1e-6, 1e-9):
        solver = solvers.Attard(20, DOMAIN, "iterative", 400, iteration_tolerance=tolerance)
        misses.append(np.abs(solver.solve(CONTACT, RAMP).force - exact).max() / scale)
    assert misses[0] < 1e-2
    assert misses[1] < 1e-5
    assert misses[2] < 1e-8


def test_a_fixed_relaxation_finds_the_same_rates():
    automatic = solvers.Attard(20, DOMAIN, steps=400, iteration_tolerance=1e-9)
    fixed = solvers.Attard(20, DOMAIN, steps=400, iteration_tolerance=1e-9, relaxation=0.05)
    a, b = automatic.solve(CONTACT, RAMP), fixed.solve(CONTACT, RAMP)
    assert np.allclose(a.force, b.force, rtol=0, atol=1e-8 * np.abs(a.force).max())
    assert b.diagnostics["iterations"] > a.diagnostics["iterations"]


@pytest.mark.parametrize("basis", ["cosine", "bessel"])
@pytest.mark.parametrize("orthogonal", [True, False])
def test_the_bounded_gap_gives_what_the_deformation_gives(basis, orthogonal):
    options = {"basis": basis, "orthogonal": orthogonal, "steps": 400}
    a = small(**options).solve(CONTACT, RAMP).force
    b = small(**options, expand="bounded-gap").solve(CONTACT, RAMP).force
    assert np.allclose(a, b, rtol=0, atol=1e-11 * np.abs(a).max())


@pytest.mark.parametrize("expand", ["deformation", "gap"])
def test_as_many_functions_as_nodes_make_the_nodal_solver(expand):
    """Then cosines span every surface over the midpoints, the tip included: C = D = B."""
    nodal = solvers.Attard(12, DOMAIN, "explicit", 400).solve(CONTACT, RAMP).force
    options = {"domain": DOMAIN, "quadrature": "midpoint", "stepper": ForwardEuler(), "steps": 400}
    complete = solvers.EnhancedAttard(12, 12, expand=expand, orthogonal=False, **options)
    difference = np.abs(complete.solve(CONTACT, RAMP).force - nodal).max()
    bound = 1e-9 if expand == "deformation" else 1e-2  # whose start is a truncated series
    assert difference < bound * np.abs(nodal).max()


# Samples and motions beyond the paper's

FIXED_STEPS = [
    solvers.Attard(30, steps=2000, stepper=AdamsBashforth(2)),
    solvers.Attard(30, steps=2000, method="explicit", stepper=AdamsBashforth(2)),
    solvers.EnhancedAttard(12, 30, steps=2000, orthogonal=False),
    solvers.EnhancedAttard(12, 30, steps=2000),
    solvers.EnhancedAttard(12, 30, "bessel", steps=2000),
]


@pytest.mark.parametrize("solver", FIXED_STEPS)
def test_one_kelvin_voigt_mode_is_the_standard_linear_solid(solver):
    chain = sa.GeneralizedKelvinVoigt(E0, [1 / E_INF - 1 / E0], [TAU], 0.3)
    a = solver.solve(CONTACT, RAMP).force
    b = solver.solve(sa.Contact(TIP, chain, LAW), RAMP).force
    assert np.allclose(a, b, rtol=0, atol=1e-10 * np.abs(a).max())


@pytest.mark.parametrize("solver", FIXED_STEPS)
def test_a_split_mode_changes_nothing(solver):
    """Two modes of one retardation time are one mode, though the memory is carried otherwise."""
    whole = 1 / E_INF - 1 / E0
    halves = sa.GeneralizedKelvinVoigt(E0, [0.3 * whole, 0.7 * whole], [TAU, TAU], 0.3)
    a = solver.solve(CONTACT, RAMP)
    b = solver.solve(sa.Contact(TIP, halves, LAW), RAMP)
    # Least squares keep what the functions cannot show of one mode, and drop it of the other.
    close = 2e-2 if not getattr(solver, "orthogonal", True) else 1e-6
    assert np.abs(a.force - b.force).max() < close * np.abs(a.force).max()
    assert np.abs(a.viscous_power - b.viscous_power).max() < close * a.viscous_power.max()


@pytest.mark.parametrize("solver", FIXED_STEPS)
def test_two_creep_times_agree_with_the_default_solver(solver):
    chain = sa.GeneralizedKelvinVoigt(E0, [1e-9, 0.7e-9], [3e-5, 4e-4], 0.3)
    contact = sa.Contact(TIP, chain, LAW)
    found = sa.force_distance(contact, RAMP, solver=solver)
    expected = sa.force_distance(contact, RAMP, tolerance=1e-3)
    scale = float(expected.force_max - expected.force_min)
    for name in ("force_max", "force_min"):
        assert float(found[name]) == pytest.approx(float(expected[name]), abs=0.02 * scale)
    for name in ("loop_energy", "viscous_loss"):
        assert float(found[name]) == pytest.approx(float(expected[name]), rel=0.03)


@pytest.mark.parametrize("solver", FIXED_STEPS)
def test_a_stiff_elastic_sample_feels_the_rigid_force(solver):
    """Derjaguin: F = 2πR Φ(h0) (here with Lennard-Jones)."""
    contact = sa.Contact(TIP, sa.Elastic(1e15, 0.3), LAW)
    motion = sa.Triangle(start=2e-9, turn=0.28e-9, speed=1e-5)
    found = solver.solve(contact, motion)
    exact = 2 * np.pi * R * LAW.potential(found.tip_height)
    assert np.abs(found.force - exact).max() < 5e-3 * np.abs(exact).max()
    assert not found.viscous_power.any()


def test_any_trajectory_can_be_followed():
    time = np.linspace(0, RAMP.breaks[-1], 41)
    sampled = sa.Trajectory(time, RAMP.height(time))
    a = sa.force_distance(CONTACT, RAMP, solver=FIXED_STEPS[3])
    b = sa.force_distance(CONTACT, sampled, solver=FIXED_STEPS[3])
    assert float(b.force_min) == pytest.approx(float(a.force_min), rel=0.02)


def test_steps_are_shared_out_by_duration():
    time = np.array([0, 1, 4]) * 1e-4
    motion = sa.Trajectory(time, [1.5e-9, -0.3e-9, 1.5e-9])
    found = solvers.EnhancedAttard(8, 20, steps=400).solve(CONTACT, motion)
    assert np.allclose(np.diff(found.time), 1e-6, rtol=1e-9)
    assert np.count_nonzero(found.time == 1e-4) == 1
    assert [(p.start, p.stop) for p in found.pieces] == [(0, 101), (100, 401)]


def test_later_cycles_start_from_the_memory_of_earlier_ones():
    found = sa.tapping_cycle(
        SMOOTH_TAP, *SMOOTH, cycles=2, solver=solvers.EnhancedAttard(12, 40, steps=6000)
    )
    first, second = found.cycle_dissipation.values
    assert second == pytest.approx(first, rel=1e-4)


def test_shapes_are_kept_at_the_nodes():
    solver = solvers.EnhancedAttard(8, 20, steps=100)
    found = sa.force_distance(CONTACT, RAMP, solver=solver, profiles=True)
    assert found.deformation.shape == (101, 20)
    mass = 2 * np.pi * np.gradient(found.r.values) * found.r.values
    mass[-1] /= 2
    force = (found.pressure.values * mass).sum(axis=1)
    assert np.allclose(force, found.force.values, rtol=0, atol=0.03 * np.abs(force).max())


def test_progress_and_its_absence_give_the_same():
    fractions = []
    a = FIXED_STEPS[3].solve(CONTACT, RAMP, progress=lambda f, _: fractions.append(f))
    b = FIXED_STEPS[3].solve(CONTACT, RAMP)
    assert np.array_equal(a.force, b.force)
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1
    assert len(fractions) > 3


def test_dissipation_is_what_the_dashpots_take():
    motion = sa.Triangle(start=12e-9, turn=-0.6e-9, speed=1e-5)
    found = sa.force_distance(CONTACT, motion, solver=FIXED_STEPS[3])
    assert float(found.viscous_loss) == pytest.approx(float(found.loop_energy), rel=0.01)


# The smooth tap of the reference cases, and one that crosses a fold


def error_of(found, case, name):
    expected = {key: entry["value"] for key, entry in case["expected"].items()}
    return float(found[name]) / expected[name] - 1


@pytest.mark.parametrize("letter", "BCDEFG")
def test_every_setup_converges_on_the_smooth_tap(letter, reference_cases):
    options = {"domain": 14e-9, "steps": 5000, "stepper": AdamsBashforth(3)}
    solver = (
        solvers.Attard(80, method="explicit", **options)
        if letter == "B"
        else solvers.EnhancedAttard(
            30,
            80,
            basis="bessel" if letter == "G" else "cosine",
            expand="gap" if letter in "DF" else "deformation",
            orthogonal=letter in "EFG",
            **options,
        )
    )
    found = sa.tapping_cycle(SMOOTH_TAP, *SMOOTH, solver=solver)
    case = reference_cases["smooth-tap"]
    for name in ("virial", "dissipation", "force_max", "force_min"):
        assert abs(error_of(found, case, name)) < 2e-3, name


def test_setup_e_on_the_deep_tap(reference_cases):
    """25 functions, 70 nodes, 12 nm and 10 000 steps: 0.5 % in the virial, 1 % in the loss."""
    case = reference_cases["ldpe-tap-setpoint-0.8"]
    contact = sa.Contact(
        sa.Paraboloid(10e-9),
        sa.StandardLinearSolid(2e9, 0.1e9, 1e-7, 0.49),
        sa.LennardJones(1e-19, 0.25e-9),
    )
    solver = solvers.EnhancedAttard(domain=12e-9)
    found = sa.tapping_cycle(contact, 49.6e-9, 42.82e-9, 278e3, solver=solver)
    assert abs(error_of(found, case, "virial")) < 5e-3
    assert abs(error_of(found, case, "dissipation")) < 1e-2


# What goes wrong

STICKY = sa.Contact(TIP, SOLID, sa.LennardJones(1e-19, 0.12e-9))


@pytest.mark.parametrize("solver", FIXED_STEPS)
def test_a_blow_up_is_told_with_the_history_before(solver):
    with pytest.raises(sa.DivergedError, match=r"at t = .* s \(step \d+ of 2000") as caught:
        solver.solve(STICKY, RAMP)
    past = caught.value.history
    assert 100 < past.time.size < 2000
    assert past.force.size == past.tip_height.size == past.time.size
    assert np.all(np.isfinite(past.force))
    assert past.diagnostics["steps"] == past.time.size - 1


def test_one_function_bears_the_force_of_a_rigid_surface():
    found = solvers.EnhancedAttard(1, 30, steps=4000).solve(CONTACT, RAMP)
    assert np.ptp(found.axis_deformation) > 0
    assert found.force.max() > 2e-9


def test_a_gap_that_is_the_same_everywhere_is_in_contact_up_to_the_rim():
    solver = solvers.EnhancedAttard(1, 30, expand="gap", domain=1.5e-9, steps=4000)
    with pytest.warns(sa.AccuracyWarning, match="choose a larger domain"):
        found = solver.solve(CONTACT, RAMP)
    assert found.contact_radius.max() == 1.5e-9


def test_an_iteration_that_does_not_converge_says_so():
    for solver in (
        solvers.Attard(20, DOMAIN, steps=400, relaxation=1.0),
        solvers.Attard(20, DOMAIN, steps=400, most_iterations=3),
    ):
        with pytest.raises(sa.DivergedError, match="did not converge within most_iterations"):
            solver.solve(CONTACT, RAMP)


def test_a_crossed_fold_is_warned_of():
    """The elastic contact jumps at this Tabor number; rates follow a branch that is unstable."""
    contact = sa.Contact(TIP, sa.Elastic(0.4e9, 0.3), LAW)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            sa.force_distance(contact, RAMP, solver=FIXED_STEPS[1])
            told = [str(w.message) for w in caught]
        except sa.DivergedError as error:
            told = list(map(str, error.history.warnings))
    assert any("beyond an elastic instability" in text for text in told)


def test_a_contact_that_fills_the_domain_is_warned_of():
    with pytest.warns(sa.AccuracyWarning, match="choose a larger domain"):
        solvers.EnhancedAttard(4, 20, domain=1.5e-9, steps=2000).solve(CONTACT, RAMP)


@pytest.mark.parametrize(
    ("make", "line"),
    [
        (lambda: solvers.Attard(nodes=1), "nodes = 1: must be a whole number from 2 to 2000"),
        (lambda: solvers.Attard(nodes=70.0), "nodes = 70.0: must be a whole number from 2 to 2000"),
        (lambda: solvers.Attard(domain=-1e-9), "domain = -1e-09 m: must be greater than 0"),
        (
            lambda: solvers.Attard(method="implicit"),
            "method = 'implicit': must be 'iterative' or 'explicit'",
        ),
        (lambda: solvers.Attard(steps=True), "steps = True: must be a whole number"),
        (lambda: solvers.Attard(stepper="euler"), "stepper = 'euler': must be solvers.Forward"),
        (lambda: solvers.Attard(relaxation=1.5), "relaxation = 1.5: must be at most 1"),
        (lambda: solvers.Attard(relaxation=0), "relaxation = 0: must be greater than 0"),
        (lambda: solvers.Attard(iteration_tolerance=0), "iteration_tolerance = 0: must be"),
        (lambda: solvers.EnhancedAttard(71), "functions = 71: must be a whole number from 1 to 70"),
        (lambda: solvers.EnhancedAttard(basis="sine"), "basis = 'sine': must be 'cosine' or"),
        (lambda: solvers.EnhancedAttard(expand="h"), "expand = 'h': must be 'deformation' or"),
        (lambda: solvers.EnhancedAttard(orthogonal=1), "orthogonal = 1: must be True or False"),
        (lambda: solvers.EnhancedAttard(quadrature="gauss"), "quadrature = 'gauss': must be"),
        (lambda: AdamsBashforth(6), "order = 6: must be a whole number from 1 to 5"),
    ],
)
def test_bad_options_are_refused_in_one_line(make, line):
    with pytest.raises(ValueError, match="^" + line.replace("(", r"\(")) as caught:
        make()
    assert "\n" not in str(caught.value)


# Levers and steady cycles


@pytest.mark.parametrize("solver", FIXED_STEPS)
def test_a_lever_bends_as_with_the_default_solver(solver):
    """A stiff lever, so that nothing snaps: the two have no step, mesh or iteration in common."""
    contact = sa.Contact(
        SMOOTH_TAP.tip, sa.StandardLinearSolid(2.5e9, 0.3e9, 1e-5, 0.45), SMOOTH_TAP.surface
    )
    motion, lever = sa.Triangle(10e-9, -4e-9, 1e-3), sa.Cantilever(100.0)
    finer = {"functions": 25} if isinstance(solver, solvers.EnhancedAttard) else {}
    longer = dataclasses.replace(solver, steps=8000, nodes=60, domain=16e-9, **finer)
    found = sa.force_spectroscopy(contact, lever, motion, solver=longer)
    expected = sa.force_spectroscopy(contact, lever, motion, tolerance=1e-3)
    for name in ("force_max", "force_min", "force_min_approach", "loop_energy"):
        assert float(found[name]) == pytest.approx(float(expected[name]), rel=5e-3), name
    unbalanced = lever.stiffness * found.deflection - found.force
    assert float(np.abs(unbalanced).max()) < 2e-3 * float(found.force_max)


def test_a_very_stiff_lever_is_none():
    solver = FIXED_STEPS[3]
    bent = sa.force_spectroscopy(CONTACT, sa.Cantilever(1e6), RAMP, solver=solver)
    still = sa.force_distance(CONTACT, RAMP, solver=solver)
    scale = float(np.abs(still.force).max())
    assert np.allclose(bent.force, still.force, rtol=0, atol=2e-3 * scale)


@pytest.mark.parametrize("solver", FIXED_STEPS[1:])
def test_steady_cycles_agree_with_the_default_solver(solver):
    slow = sa.StandardLinearSolid(2.5e9, 0.3e9, 4e-6, 0.45)
    contact = sa.Contact(SMOOTH_TAP.tip, slow, SMOOTH_TAP.surface)
    solver = dataclasses.replace(solver, steps=4000, nodes=50, domain=20e-9)
    found = sa.tapping_cycle(contact, *SMOOTH, "steady", solver=solver)
    expected = sa.tapping_cycle(contact, *SMOOTH, "steady", tolerance=1e-3)
    assert 2 < int(found.cycles_run) < 20
    for name in ("virial", "dissipation", "force_max", "force_min"):
        assert float(found[name]) == pytest.approx(float(expected[name]), rel=0.03), name


# A cycle that does not settle gives energy back.
@pytest.mark.filterwarnings("ignore:audit. viscous_power:softafm.AccuracyWarning")
def test_cycles_that_do_not_settle_are_warned_of():
    slow = sa.StandardLinearSolid(2.5e9, 0.3e9, 4e-3, 0.45)
    contact = sa.Contact(SMOOTH_TAP.tip, slow, SMOOTH_TAP.surface)
    solver = solvers.EnhancedAttard(6, 16, steps=1500)
    with pytest.warns(sa.AccuracyWarning, match="no steady cycle after 100"):
        sa.tapping_cycle(contact, *SMOOTH, solver=solver)


def test_a_force_trigger_is_refused():
    motion = sa.Triangle(1.5e-9, -0.6e-9, 1e-5, setpoint_force=1e-9)
    with pytest.raises(ValueError, match=r"^setpoint_force = 1e-09 N: the solver 'attard' must"):
        sa.force_distance(CONTACT, motion, solver=solvers.Attard())
