from .bolts import Bolts
from .point_mass import EdgeMass
from .ring import Ring
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
    "Symmetry",
]
