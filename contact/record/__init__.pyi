from .energy import EnergyBudget, Stored
from .growth import Cause, RunGrowth
from .record import Record

__all__ = [
    "Cause",
    "EnergyBudget",
    "Record",
    "RunGrowth",
    "Stored",
]
