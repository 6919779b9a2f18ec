from .correlate import Correlation
from .correlation import pair
from .mac import mac, subspace_mac
from .measured_shapes import MeasuredShapes
from .pairing import Pairing
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
