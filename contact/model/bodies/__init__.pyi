from .beam import BeamInCircle, HingedBeam
from .body import PointMass, Rod, Wall
from .channels import rim_channels
from .from_matrices import body_of
from .linear import Forcing, LinearBody, Part
from .matrices import Matrices
from .matrix_report import MatrixReport
from .modal_body import ModalBody
from .patch import Patch
from .ring_modes import ThinRing, ring_elements, ring_modes

__all__ = [
    "BeamInCircle",
    "Forcing",
    "HingedBeam",
    "LinearBody",
    "Matrices",
    "MatrixReport",
    "ModalBody",
    "Part",
    "Patch",
    "PointMass",
    "Rod",
    "ThinRing",
    "Wall",
    "body_of",
    "rim_channels",
    "ring_elements",
    "ring_modes",
]
