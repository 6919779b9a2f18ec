from .correlate import Correlation
from .mac import mac, subspace_mac
from .matches import Pairing
from .measured_shapes import MeasuredShapes
from .pairing import pair
from .shape_files import identified_shapes, read_shapes

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
