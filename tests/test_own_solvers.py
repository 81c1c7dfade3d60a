"""What a solver of someone's own returns is refused in one line where it cannot be true."""

from dataclasses import replace

import numpy as np
import pytest

import softafm as sa

CONTACT = sa.Contact(
    sa.Paraboloid(10e-9),
    sa.StandardLinearSolid(E0=2e9, E_inf=0.5e9, creep_time=1e-6, poisson=0.4),
    sa.LennardJones(hamaker=1e-19, z0=0.3e-9),
)
RAMP = sa.Triangle(start=4e-9, turn=-2e-9, speed=1e-3)
TRIGGERED = replace(RAMP, setpoint_force=2e-9)
LEVER = sa.Cantilever(stiffness=2.0, quality_factor=100, frequency=100e3)


class Wrapper:
    """A solver without defaults that changes what another is asked for, or what it returns."""

    kind, adaptive = "wrapper", True

    def __init__(self, change=lambda history: {}, solver=None, **options):
        self.change, self.options = change, options
        self.solver = solver or sa.solvers.Energy()

    def solve(self, contact, motion, *, stiffness, tolerance, profiles, progress):
        options = {"stiffness": stiffness, "profiles": profiles} | self.options
        history = self.solver.solve(contact, motion, tolerance=tolerance, **options)
        return replace(history, **self.change(history))


@pytest.mark.parametrize(
    "solver",
    [
        sa.solvers.Energy(),
        sa.solvers.EnhancedAttard(steps=4000),
        sa.solvers.Attard(method="explicit", steps=4000),
    ],
    ids=lambda solver: solver.kind,
)
@pytest.mark.parametrize("motion", [RAMP, sa.Sine(2e-9, 3e-9, 20e3)], ids=lambda each: each.kind)
def test_what_the_solvers_of_the_package_return_is_not_refused(solver, motion):
    own = sa.force_distance(CONTACT, motion, solver=Wrapper(solver=solver), profiles=True)
    same = sa.force_distance(CONTACT, motion, solver=solver)
    np.testing.assert_array_equal(own["force"], same["force"])


@pytest.mark.filterwarnings("ignore:.*still in contact at the end:softafm.AccuracyWarning")
def test_neither_are_levers_triggers_jumps_and_steady_cycles():
    sticky = replace(CONTACT, surface=sa.LennardJones(hamaker=5e-19, z0=0.2e-9))
    soft = sa.Cantilever(stiffness=0.5, quality_factor=100, frequency=100e3)
    base = sa.Triangle(start=20e-9, turn=-10e-9, speed=1e-3, dwell=1e-6, setpoint_force=2e-9)
    jumping = sa.force_spectroscopy(sticky, soft, base, solver=Wrapper())
    assert jumping.sizes["jump"] > 0
    assert jumping.base_height.min() > -10e-9
    sa.tapping_cycle(CONTACT, amplitude=3e-9, mean_height=2e-9, frequency=20e3, solver=Wrapper())


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda h: {"time": h.time[::-1]}, "history.time = ["),
        (lambda h: {"time": h.time + 1e-3}, "s, as history.motion does"),
        (lambda h: {"time": list(h.time)}, "must be an array of floats, shape (n,)"),
        (lambda h: {"force": np.where(h.time > 5e-6, np.nan, h.force)}, "= nan: of the solver"),
        (lambda h: {"contact_radius": h.contact_radius[1:]}, "history.contact_radius = ["),
        (
            lambda h: {"viscous_power": None},
            "history.viscous_power = None: of the solver 'wrapper'",
        ),
        (lambda h: {"pieces": ()}, "history.pieces = (): of the solver 'wrapper' must be slices"),
        (lambda h: {"pieces": h.pieces[:1]}, "neighbours sharing one at most"),
        (lambda h: {"pieces": h.pieces[::-1]}, "neighbours sharing one at most"),
        (lambda h: {"jump_energy": np.zeros(3)}, "history.jump_energy = [0. 0. 0.]: of the solver"),
        (lambda h: {"warnings": "none"}, "must be a tuple of AccuracyWarnings"),
        (lambda h: {"tip_height": h.tip_height + 1e-10}, "must be that of history.motion there"),
        (lambda h: {"motion": None}, "history.motion = None: must be the motion as carried out"),
        (lambda h: {"profiles": None}, "history.profiles = None: of the solver 'wrapper' must be"),
    ],
)
def test_a_history_that_contradicts_itself_is_refused(change, said):
    with pytest.raises(ValueError, match=r"^history\.") as refused:
        sa.force_distance(CONTACT, RAMP, solver=Wrapper(change), profiles=True)
    assert said in str(refused.value)
    assert len(str(refused.value).splitlines()) == 1


def test_a_motion_that_is_not_the_turned_one_is_refused():
    forgotten = Wrapper(lambda history: {"motion": TRIGGERED})
    with pytest.raises(ValueError, match=r"^history\.time = .* s, as history\.motion does$"):
        sa.force_distance(CONTACT, TRIGGERED, solver=forgotten)


class Heedless(Wrapper):
    """A solver that carries out a motion of its own."""

    def __init__(self, motion):
        super().__init__()
        self.motion = motion

    def solve(self, contact, motion, **options):
        return super().solve(contact, self.motion, **options)


@pytest.mark.parametrize(
    ("motion", "said"),
    [
        (RAMP, r"^history\.motion = .* must be the motion turned by its setpoint_force, reached"),
        (TRIGGERED.turned_at(1e-6), r"^history\.motion = .* must be that asked for, from 0 to"),
    ],
)
def test_a_solver_that_does_not_do_what_it_is_asked_for_is_refused(motion, said):
    asked = TRIGGERED if motion is RAMP else RAMP
    with pytest.raises(ValueError, match=said):
        sa.force_distance(CONTACT, asked, solver=Heedless(motion))


def test_a_solver_that_forgets_the_lever_is_refused():
    said = r"^history\.tip_height = .* must be off the base by up to .* m, as stiffness = 2 N/m$"
    with pytest.raises(ValueError, match=said):
        sa.force_spectroscopy(CONTACT, LEVER, RAMP, solver=Wrapper(stiffness=None))


def test_the_taps_of_an_approach_curve_are_looked_at():
    spoiled = Wrapper(lambda history: {"pieces": ()})
    with pytest.raises(ValueError, match=r"^history\.pieces = \(\)"):
        sa.approach_curve(CONTACT, LEVER, 3e-9, [0.8], solver=spoiled)
    sample = sa.SampleMap(CONTACT, 1e-6, height=np.zeros((1, 2)))
    with pytest.raises(ValueError, match=r"^history\.pieces = \(\)"):
        sa.scan(sample, sa.AmplitudeModulation(LEVER, 3e-9, 0.8), solver=spoiled)


@pytest.mark.parametrize("tolerance", [0, float("nan"), 0.5])
@pytest.mark.parametrize(
    "solver", [sa.solvers.Energy(), sa.solvers.EnhancedAttard(steps=50)], ids=lambda each: each.kind
)
def test_a_solver_that_is_called_by_another_checks_the_tolerance(solver, tolerance):
    with pytest.raises(ValueError, match=r"^tolerance = "):
        solver.solve(CONTACT, RAMP, tolerance=tolerance)
