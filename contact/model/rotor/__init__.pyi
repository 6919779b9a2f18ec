from .jeffcott import Jeffcott
from .rotor import Release, Rotor, Spin, Unbalance
from .rotor_rub import rigid_casing, rigid_tip, rotor_rub
from .shaft import Bearing, Disk, Piece, Shaft
from .whirl import RotorCampbell, UnbalanceResponse, campbell, critical_speeds, unbalance_response

__all__ = [
    "Bearing",
    "Disk",
    "Jeffcott",
    "Piece",
    "Release",
    "Rotor",
    "RotorCampbell",
    "Shaft",
    "Spin",
    "Unbalance",
    "UnbalanceResponse",
    "campbell",
    "critical_speeds",
    "rigid_casing",
    "rigid_tip",
    "rotor_rub",
    "unbalance_response",
]
