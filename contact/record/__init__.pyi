from .energy import EnergyBudget
from .record import Record

__all__ = [
    "EnergyBudget",
    "Record",
]
