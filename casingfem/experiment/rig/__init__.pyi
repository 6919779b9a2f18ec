from .rig import Probe, Rig
from .structure import Place, rig_of

__all__ = [
    "Place",
    "Probe",
    "Rig",
    "rig_of",
]
