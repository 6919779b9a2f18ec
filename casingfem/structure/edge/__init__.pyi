from .bolts import Bolts
from .ring import EdgeMass, Ring, Stiffener
from .section import Section
from .support import Clamped, ElasticEdge, ShearDiaphragm, Symmetry

__all__ = [
    "Bolts",
    "Clamped",
    "EdgeMass",
    "ElasticEdge",
    "Ring",
    "Section",
    "ShearDiaphragm",
    "Stiffener",
    "Symmetry",
]
