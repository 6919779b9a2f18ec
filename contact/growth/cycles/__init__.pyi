from .driven import DrivenBody
from .follow import follow
from .result import Branch, Cycles, Special
from .shooting import Orbit, orbit

__all__ = [
    "Branch",
    "Cycles",
    "DrivenBody",
    "Orbit",
    "Special",
    "follow",
    "orbit",
]
