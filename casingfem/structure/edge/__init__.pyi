from .bolts import Bolts
from .point_mass import EdgeMass
from .ring import Ring
from .section import Section
from .stiffener import Stiffener
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
