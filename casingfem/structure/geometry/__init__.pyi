from .blade import Blade, TwistedPlate
from .chart import Chart, Cylinder, Frustum, Panel, Plate
from .pieces import Piece, PiecewiseMeridian
from .revolved import Arc, Meridian, Revolved, RevolvedPanel
from .rotation import Rotation
from .stations import Taper
from .strip import Strip

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
