from .augmented import AugmentedLagrangian
from .force_law import ForceLaw, ForceTable, Hertz, Response

__all__ = [
    "AugmentedLagrangian",
    "ForceLaw",
    "ForceTable",
    "Hertz",
    "Response",
]
