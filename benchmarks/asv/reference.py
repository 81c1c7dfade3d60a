"""Time and error of typical runs, for asv: ``asv run`` keeps them commit by commit.

Needs nothing of the repository but the package itself, so that old commits can be measured too.
Converged values are those of tests/data, by independent solvers.
"""

import numpy as np

import softafm as sa


def polyethylene(creep_time):
    """The paper's polyethylene."""
    solid = sa.StandardLinearSolid(2e9, 0.1e9, creep_time, 0.49)
    return sa.Contact(sa.Paraboloid(10e-9), solid, sa.LennardJones(1e-19, 0.25e-9))


class Tap:
    """One tap with a jump, ldpe-tap-setpoint-0.8."""

    params = (1e-2, 1e-3)
    param_names = ("tolerance",)
    virial, dissipation = -3.4805e-17, 8.7097e-17

    def setup(self, tolerance):
        self.contact = polyethylene(1e-7)
        self.time_tap(tolerance)

    def time_tap(self, tolerance):
        return sa.tapping_cycle(self.contact, 49.6e-9, 42.82e-9, 278e3, tolerance=tolerance)

    def track_virial_error(self, tolerance):
        return 100 * abs(float(self.time_tap(tolerance)["virial"]) / self.virial - 1)

    def track_dissipation_error(self, tolerance):
        return 100 * abs(float(self.time_tap(tolerance)["dissipation"]) / self.dissipation - 1)

    def track_steps(self, tolerance):
        return self.time_tap(tolerance).attrs["solver_steps"]

    track_virial_error.unit = track_dissipation_error.unit = "%"
    track_steps.unit = "steps"


class Spectroscopy:
    """A force curve with a lever, ldpe-spectroscopy-k28.1."""

    loop_energy = 1.07619e-18

    def setup(self):
        self.contact, self.lever = polyethylene(1e-5), sa.Cantilever(28.1)
        self.motion = sa.Triangle(2e-8, -5e-9, 2e-7)
        self.time_curve()

    def time_curve(self):
        return sa.force_spectroscopy(self.contact, self.lever, self.motion)

    def track_loop_energy_error(self):
        return 100 * abs(float(self.time_curve()["loop_energy"]) / self.loop_energy - 1)

    track_loop_energy_error.unit = "%"


class Approach:
    """The approach curve on polystyrene with all its branches, Fig. 9 of the paper."""

    timeout = 120

    def setup(self):
        solid = sa.StandardLinearSolid(4.25e9, 1.89e9, 1e-7, 0.35)
        law = sa.LennardJones(2e-20, 0.15e-9)
        self.contact = sa.Contact(sa.Paraboloid(50e-9), solid, law)
        self.lever = sa.Cantilever(28.1, quality_factor=429.5, frequency=278e3)
        self.time_curve()

    def time_curve(self):
        ratios = np.linspace(0.2, 0.95, 31)
        return sa.approach_curve(self.contact, self.lever, 15e-9, ratios)

    def track_taps(self):
        return self.time_curve().attrs["solver_taps"]

    track_taps.unit = "taps"


class SoftContact:
    """A very adhesive viscoelastic contact, soft-tabor-10."""

    loop_energy = 1.22653e-16

    def setup(self):
        solid = sa.StandardLinearSolid(1924500897.2987528, 96225044.86493763, 3e-5, 0.0)
        law = sa.LennardJones(2.261946710584651e-19, 3e-10)
        self.contact = sa.Contact(sa.Paraboloid(100e-9), solid, law)
        self.motion = sa.Triangle(3.18824981790019e-09, -5.846665634581141e-09, 1e-6)
        self.time_curve()

    def time_curve(self):
        return sa.force_distance(self.contact, self.motion)

    def peakmem_curve(self):
        self.time_curve()

    def track_loop_energy_error(self):
        return 100 * abs(float(self.time_curve()["loop_energy"]) / self.loop_energy - 1)

    track_loop_energy_error.unit = "%"


def timeraw_import():
    """A fresh interpreter that imports the package."""
    return "import softafm"
