from .balance import Balanced, balance
from .balance_branch import balance_branch
from .balance_check import Agreement, balance_check
from .basins import Attractor, Basins, basins
from .driven import DrivenBody
from .follow import follow
from .result import Branch, Cycles, Special
from .rubbing import RimFamily, as_worn
from .shooting import Orbit, orbit
from .traced import Trace, traced

__all__ = [
    "Agreement",
    "Attractor",
    "Balanced",
    "Basins",
    "Branch",
    "Cycles",
    "DrivenBody",
    "Orbit",
    "RimFamily",
    "Special",
    "Trace",
    "as_worn",
    "balance",
    "balance_branch",
    "balance_check",
    "basins",
    "follow",
    "orbit",
    "traced",
]
