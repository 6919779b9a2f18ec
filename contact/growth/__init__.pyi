from . import cycles
from .closed_contact import poles
from .growing import rim_stability, stability
from .growth_map import StabilityMap
from .of_run import of_run
from .on_springs import on_springs, slope_of
from .peaks import Peaks, peaks
from .rotor import rotor_stability
from .split_casing import perfect_mean

__all__ = [
    "Peaks",
    "StabilityMap",
    "cycles",
    "of_run",
    "on_springs",
    "peaks",
    "perfect_mean",
    "poles",
    "rim_stability",
    "rotor_stability",
    "slope_of",
    "stability",
]
