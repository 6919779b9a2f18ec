from .closed_contact import poles, rim_stability, stability
from .growth_map import StabilityMap

__all__ = [
    "StabilityMap",
    "poles",
    "rim_stability",
    "stability",
]
