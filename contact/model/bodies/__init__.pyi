from .beam import BeamInCircle, HingedBeam
from .body import PointMass, Rod, Wall
from .linear import Forcing, LinearBody, Part
from .modal_body import ModalBody
from .patch import Patch
from .ring_modes import ThinRing, ring_elements, ring_modes

__all__ = [
    "BeamInCircle",
    "Forcing",
    "HingedBeam",
    "LinearBody",
    "ModalBody",
    "Part",
    "Patch",
    "PointMass",
    "Rod",
    "ThinRing",
    "Wall",
    "ring_elements",
    "ring_modes",
]
