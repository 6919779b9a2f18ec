from .blade import Blade, TwistedPlate
from .chart import Chart, Closed, ClosedOfRevolution, Cylinder, Frustum, Open, Panel, Plate, Surface
from .jet import cos, exp, jets, sin, sqrt, surface
from .pieces import Piece, PiecewiseMeridian
from .revolved import Arc, Meridian, Revolved, RevolvedPanel
from .rotation import Rotation
from .smooth import SmoothMeridian
from .stations import Taper
from .strip import Strip

__all__ = [
    "Arc",
    "Blade",
    "Chart",
    "Closed",
    "ClosedOfRevolution",
    "Cylinder",
    "Frustum",
    "Meridian",
    "Open",
    "Panel",
    "Piece",
    "PiecewiseMeridian",
    "Plate",
    "Revolved",
    "RevolvedPanel",
    "Rotation",
    "SmoothMeridian",
    "Strip",
    "Surface",
    "Taper",
    "TwistedPlate",
    "cos",
    "exp",
    "jets",
    "sin",
    "sqrt",
    "surface",
]
