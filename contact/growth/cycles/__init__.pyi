from .branch import branch
from .driven import DrivenBody
from .result import Branch, Cycles, Special
from .shooting import Orbit, orbit

__all__ = [
    "Branch",
    "Cycles",
    "DrivenBody",
    "Orbit",
    "Special",
    "branch",
    "orbit",
]
