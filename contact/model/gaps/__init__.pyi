from .bladed_disk import BladedDisk, pair_rim
from .body_force import BodyForce
from .gap import PointGap, RotatingRim, Side
from .modal_system import ModalSystem, point_system
from .permanent import HandPair, ModalPair, disk_contact, rim_contact
from .rod_modes import Cantilever, rod_modes
from .rub import ContactPoint, Rub, Start, Stiffening
from .rub_laws import Closing, RimProfile, Whirl
from .rub_system import settled

__all__ = [
    "BladedDisk",
    "BodyForce",
    "Cantilever",
    "Closing",
    "ContactPoint",
    "HandPair",
    "ModalPair",
    "ModalSystem",
    "PointGap",
    "RimProfile",
    "RotatingRim",
    "Rub",
    "Side",
    "Start",
    "Stiffening",
    "Whirl",
    "disk_contact",
    "pair_rim",
    "point_system",
    "rim_contact",
    "rod_modes",
    "settled",
]
