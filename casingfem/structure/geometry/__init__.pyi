from .blade import Blade
from .chart import Chart, Cylinder, Frustum, Panel, Plate
from .pieces import Piece, PiecewiseMeridian
from .revolved import Arc, Meridian, Revolved, RevolvedPanel
from .rotation import Rotation
from .strip import Strip
from .taper import Taper
from .twisted import TwistedPlate

__all__ = [
    "Arc",
    "Blade",
    "Chart",
    "Cylinder",
    "Frustum",
    "Meridian",
    "Panel",
    "Piece",
    "PiecewiseMeridian",
    "Plate",
    "Revolved",
    "RevolvedPanel",
    "Rotation",
    "Strip",
    "Taper",
    "TwistedPlate",
]
