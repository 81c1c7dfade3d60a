"""Rigid axisymmetric tips."""

from softafm.tips.cone import Cone
from softafm.tips.custom import CustomTip
from softafm.tips.flat_punch import FlatPunch
from softafm.tips.hyperboloid import Hyperboloid
from softafm.tips.measured import MeasuredTip
from softafm.tips.paraboloid import Paraboloid
from softafm.tips.power_law import PowerLawTip
from softafm.tips.reading import read_tip_profile
from softafm.tips.sphere import Sphere
from softafm.tips.tip import Tip

__all__ = [
    "Cone",
    "CustomTip",
    "FlatPunch",
    "Hyperboloid",
    "MeasuredTip",
    "Paraboloid",
    "PowerLawTip",
    "Sphere",
    "Tip",
    "read_tip_profile",
]
