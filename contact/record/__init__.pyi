from .energy import EnergyBudget, Stored
from .record import Record

__all__ = [
    "EnergyBudget",
    "Record",
    "Stored",
]
