from . import cycles
from .closed_contact import poles, rim_stability, stability
from .growth_map import StabilityMap
from .interaction_table import Interactions, interactions
from .of_run import of_run
from .on_springs import on_springs, slope_of
from .split_casing import perfect_mean

__all__ = [
    "Interactions",
    "StabilityMap",
    "cycles",
    "interactions",
    "of_run",
    "on_springs",
    "perfect_mean",
    "poles",
    "rim_stability",
    "slope_of",
    "stability",
]
