from .correlate import Correlation
from .mac import mac, subspace_mac
from .matches import Pairing
from .measured_shapes import MeasuredShapes, identified_shapes, read_shapes
from .pairing import pair

__all__ = [
    "Correlation",
    "MeasuredShapes",
    "Pairing",
    "identified_shapes",
    "mac",
    "pair",
    "read_shapes",
    "subspace_mac",
]
