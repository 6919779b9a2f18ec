from .correlate import Correlation
from .expansion import Expansion, expand
from .mac import comac, ecomac, mac, subspace_mac
from .matches import Pairing
from .measured_shapes import MeasuredShapes, identified_shapes, read_shapes
from .pairing import pair

__all__ = [
    "Correlation",
    "Expansion",
    "MeasuredShapes",
    "Pairing",
    "comac",
    "ecomac",
    "expand",
    "identified_shapes",
    "mac",
    "pair",
    "read_shapes",
    "subspace_mac",
]
