from .basins import Attractor, Basins, basins
from .driven import DrivenBody
from .follow import follow
from .result import Branch, Cycles, Special
from .rubbing import RimFamily, as_worn
from .shooting import Orbit, orbit
from .traced import Trace, traced

__all__ = [
    "Attractor",
    "Basins",
    "Branch",
    "Cycles",
    "DrivenBody",
    "Orbit",
    "RimFamily",
    "Special",
    "Trace",
    "as_worn",
    "basins",
    "follow",
    "orbit",
    "traced",
]
