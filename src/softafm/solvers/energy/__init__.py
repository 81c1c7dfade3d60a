"""The default solver: implicit energy-minimising steps on a mesh that follows the contact edge."""

from softafm.solvers.energy.solver import Energy, cohesive_lengths_crossed

__all__ = ["Energy", "cohesive_lengths_crossed"]
