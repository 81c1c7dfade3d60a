"""The default solver: implicit energy-minimising steps on a mesh that follows the contact edge."""

from softafm.solvers.energy.solver import Energy, count_cohesive_lengths

__all__ = ["Energy", "count_cohesive_lengths"]
