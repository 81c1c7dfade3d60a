"""What lies under the tip: half-spaces, and bodies of layers."""

from softafm.bodies.body import Body
from softafm.bodies.half_space import HalfSpace
from softafm.bodies.layered import Layered

__all__ = ["Body", "HalfSpace", "Layered"]
